//! Imports between the files of each crate: none goes in a circle, and the rooms of the desktop build on each other in one
//! direction.
//!
//! A file imports the files that define what its `use`s and the paths in its code name, through re-exports. Left out are
//! tests, comments, and what a file takes from the `mod.rs` of a folder that it lies in: that is there for its files to share.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Source folders of the crates, but for those of the boards.
const CRATES: [&str; 7] =
    ["src", "desktop/src", "emulator/src", "emulator/plugin/src", "cli/src", "drivers/src", "service/src"];

/// Path of a module in its crate, the crate's root empty.
type Module = Vec<String>;
type Graph = BTreeMap<Module, BTreeSet<Module>>;

/// A crate's code, file by file, without comments and tests.
#[derive(Default)]
struct Crate(BTreeMap<Module, String>);

/// A path in a `use`, and the name that it has there.
struct Used {
    path: Vec<String>,
    name: String,
    exported: bool,
}

impl Crate {
    fn read(folder: &str) -> Self {
        let mut read = Self::default();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
        read.add(&root, &Module::new());
        assert!(!read.0.is_empty(), "{folder} has no source");
        read
    }

    fn add(&mut self, folder: &Path, module: &Module) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let inner = || module.iter().cloned().chain([stem.clone()]).collect();
            if path.is_dir() {
                self.add(&path, &inner());
            } else if path.extension().is_some_and(|extension| extension == "rs") && stem != "tests" {
                let module = if ["mod", "lib", "main"].contains(&&*stem) { module.clone() } else { inner() };
                self.0.insert(module, code(&fs::read_to_string(&path).unwrap()));
            }
        }
    }

    /// The files of each file's imports.
    fn graph(&self) -> Graph {
        let imports = |(module, code): (&Module, &String)| {
            let (uses, body) = uses(code);
            let mut found: BTreeSet<_> =
                uses.iter().filter_map(|used| self.defining(module, &used.path, 0)).collect();
            for path in paths(&body) {
                let imported = uses.iter().find(|used| used.name == path[0]);
                let full = imported.map_or(path.clone(), |used| [&used.path, &path[1..]].concat());
                found.extend(self.defining(module, &full, 0));
            }
            // Re-exports import nothing, unless the file uses them itself.
            for used in uses.iter().filter(|used| used.exported && !mentions(&body, &used.name)) {
                self.defining(module, &used.path, 0).map(|file| found.remove(&file));
            }
            found.retain(|other| !module.starts_with(other));
            (module.clone(), found)
        };
        self.0.iter().map(imports).collect()
    }

    /// The file that defines what a path in `module` names; none outside of the crate.
    fn defining(&self, module: &Module, path: &[String], depth: usize) -> Option<Module> {
        let ups = path.iter().take_while(|segment| *segment == "super").count();
        let (mut at, mut rest) = match path.first()?.as_str() {
            "crate" => (Module::new(), &path[1..]),
            "self" => (module.clone(), &path[1..]),
            "super" => (module[..module.len().checked_sub(ups)?].to_vec(), &path[ups..]),
            first if self.0.contains_key(&[module.as_slice(), &[first.to_owned()]].concat()) => {
                (module.clone(), path)
            }
            _ => return None,
        };
        while let [first, others @ ..] = rest
            && let inner = [at.as_slice(), std::slice::from_ref(first)].concat()
            && self.0.contains_key(&inner)
        {
            (at, rest) = (inner, others);
        }
        let (uses, _) = uses(self.0.get(&at)?);
        let mut seen = uses.iter().filter(|used| used.exported || module.starts_with(&at));
        let named = seen.find(|used| rest.first() == Some(&used.name) && depth < 8);
        let through = |used: &Used| self.defining(&at, &[&used.path, &rest[1..]].concat(), depth + 1);
        named.map_or(Some(at.clone()), through)
    }
}

/// Code without comments and tests; by convention a file's tests are its end.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let text = text.split("#[cfg(test)]\npub(crate) mod tests {").next().unwrap_or_default();
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.map(|line| line.split(" // ").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The `use`s of some code, and what is left of it.
fn uses(code: &str) -> (Vec<Used>, String) {
    let (mut uses, mut body, mut rest) = (Vec::new(), String::new(), code);
    while let Some(place) = find_use(rest) {
        let (before, from) = rest.split_at(place);
        let line = &before[before.rfind('\n').map_or(0, |end| end + 1)..];
        let (tree, after) = from["use ".len()..].split_once(';').unwrap_or_default();
        body += before;
        branches(tree, &[], line.trim_start().starts_with("pub"), &mut uses);
        rest = after;
    }
    (uses, body + rest)
}

/// Place of the next `use`, at the start of a line or after its visibility.
fn find_use(code: &str) -> Option<usize> {
    code.match_indices("use ").map(|(place, _)| place).find(|place| {
        let line = &code[code[..*place].rfind('\n').map_or(0, |end| end + 1)..*place];
        let line = line.trim();
        line.is_empty() || line == "pub" || (line.starts_with("pub(") && line.ends_with(')'))
    })
}

/// Every path of the tree of a `use`.
fn branches(tree: &str, before: &[String], exported: bool, found: &mut Vec<Used>) {
    if let Some((start, inner)) = tree.split_once('{') {
        let before = [before, &segments(start)].concat();
        let inner = &inner[..inner.rfind('}').unwrap_or(inner.len())];
        let mut depth = 0;
        let parts = inner.split(|c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            c == ',' && depth == 0
        });
        parts
            .filter(|part| !part.trim().is_empty())
            .for_each(|part| branches(part, &before, exported, found));
        return;
    }
    let (path, other) = tree.split_once(" as ").map_or((tree, None), |(path, name)| (path, Some(name)));
    let mut path = [before, &segments(path)].concat();
    path.pop_if(|last| last == "self" || last == "*");
    let name = other.map(|name| name.trim().to_owned()).or(path.last().cloned()).unwrap_or_default();
    found.push(Used { path, name, exported });
}

fn segments(path: &str) -> Vec<String> {
    path.split("::").map(|part| part.trim().to_owned()).filter(|part| !part.is_empty()).collect()
}

/// Every path of two segments or more.
fn paths(code: &str) -> impl Iterator<Item = Vec<String>> {
    let words = code.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
    words.map(segments).filter(|path| path.len() > 1)
}

fn mentions(code: &str, name: &str) -> bool {
    code.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name)
}

/// A circle in a graph, from a module back to it.
fn circle(graph: &Graph) -> Option<Vec<String>> {
    graph.keys().find_map(|start| {
        let mut reached = BTreeMap::new();
        let mut open = vec![start];
        while let Some(at) = open.pop() {
            for next in graph.get(at).into_iter().flatten() {
                if reached.contains_key(next) {
                    continue;
                }
                reached.insert(next, at);
                open.push(next);
            }
        }
        let mut back = vec![start.join("::")];
        let mut at = *reached.get(start)?;
        while at != start {
            back.push(at.join("::"));
            at = reached[at];
        }
        back.push(start.join("::"));
        back.reverse();
        Some(back)
    })
}

/// Rooms of the desktop in the order in which they build on each other, from the table that opens the crate.
fn rooms() -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../desktop/src/lib.rs");
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().filter_map(|line| line.strip_prefix("//! | [`")?.split_once('`'));
    rows.map(|(room, _)| room.trim_start_matches("mod@").to_owned()).collect()
}

/// Source folders of the boards, and of what every board runs.
fn boards() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../boards");
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let crates = names.filter(|entry| entry.path().join("src").is_dir());
    crates.map(|entry| format!("boards/{}/src", entry.file_name().display())).collect()
}

#[test]
fn no_imports_go_in_a_circle() {
    let boards = boards();
    assert!(boards.len() >= 3, "{boards:?}");
    for folder in CRATES.into_iter().chain(boards.iter().map(String::as_str)) {
        let found = circle(&Crate::read(folder).graph());
        assert_eq!(found, None, "{folder}: imports in a circle");
    }
}

#[test]
fn a_room_imports_only_from_rooms_before_it() {
    let rooms = rooms();
    let place = |module: &Module| rooms.iter().position(|room| Some(room) == module.first());
    let graph = Crate::read("desktop/src").graph();
    let known: BTreeSet<_> = graph.keys().filter_map(|module| module.first()).collect();
    assert_eq!(rooms.iter().collect::<BTreeSet<_>>(), known, "rooms of the table and folders");
    let (mut pairs, mut across) = (graph.iter().flat_map(|(a, all)| all.iter().map(move |b| (a, b))), 0);
    let wrong = pairs.find(|(from, to)| {
        across += usize::from(from.first() != to.first());
        place(from) < place(to)
    });
    assert_eq!(wrong, None, "an import from a later room");
    assert!(across > 300, "{across}");
}

/// Imports of a crate of these files.
fn imported(files: &[(&str, &str)]) -> Graph {
    let files = files.iter().map(|(path, text)| (segments(path), code(text)));
    Crate(files.collect()).graph()
}

#[test]
fn a_circle_is_found_however_it_is_written() {
    for back in [
        "use crate::a::A;",
        "use super::a::{self, A as B};",
        "use crate::{\n    c::C,\n    a::inner::{D, E},\n};",
        "pub use crate::a::A;\nstruct B(A);",
        "fn b() -> crate::a::A {}",
        "fn b() -> Option<super::a::A> {}",
        "use crate::A;",
        "use crate::c::A;",
    ] {
        let files = [
            ("", "pub mod a;\npub use a::A;"),
            ("a", "use crate::b::B;\nstruct A;"),
            ("b", back),
            ("c", "pub use crate::a::A;\nstruct C;"),
        ];
        assert_eq!(circle(&imported(&files)), Some(vec!["a".into(), "b".into(), "a".into()]), "{back}");
    }
}

#[test]
fn what_is_no_import_closes_no_circle() {
    for back in [
        "//! [`crate::a::A`]\n/// `use crate::a::A;`",
        "struct B; // as crate::a::A",
        "struct B;\n\n#[cfg(test)]\nmod tests {\n    use crate::a::A;\n}",
        "pub use crate::a::A;",
        "use other::a::A;",
    ] {
        let files = [("", ""), ("a", "use crate::b::B;"), ("b", back)];
        assert_eq!(circle(&imported(&files)), None, "{back}");
    }
    // What a folder's files have in common.
    let shared = [("", ""), ("a", "pub mod b;\nuse b::B;\nstruct A;"), ("a::b", "use super::A;")];
    assert_eq!(circle(&imported(&shared)), None);
}
