//! README and book name only what exists: commands, options, files, links; and the page of figures has the rows that the
//! table of bounds has.
//!
//! After a change of the table of bounds: `STRAINWAVE_OVERWRITE=1 cargo test -p strainwave-cli documentation`
//! gives the page its rows again, with the values that it has; `strainwave verify --markdown docs/src/figures.md` measures.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use strainwave_desktop::report::figures_page;

/// Words that the README may have.
const README_WORDS: usize = 900;
/// The page that `strainwave verify --markdown` renews.
const FIGURES: &str = "docs/src/figures.md";
/// Folders whose files are named in text.
const FOLDERS: [&str; 12] = [
    ".ci",
    "boards",
    "cli",
    "desktop",
    "docs",
    "drivers",
    "emulator",
    "examples",
    "gears",
    "host-tests",
    "service",
    "src",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// README, changelog and the chapters of the book, by their path from the root.
fn pages() -> Vec<(String, String)> {
    let chapters = fs::read_dir(root().join("docs/src")).unwrap().map(|entry| entry.unwrap().file_name());
    let chapters = chapters.filter_map(|name| name.into_string().ok()).filter(|name| name.ends_with(".md"));
    let paths = chapters.map(|name| format!("docs/src/{name}")).chain(["README.md".into()]);
    let mut pages: Vec<_> = paths.map(|path| (path.clone(), read(&path))).collect();
    pages.sort();
    pages
}

/// Code of a page: the lines of its blocks, and what stands between single backticks elsewhere.
fn code(page: &str) -> Vec<String> {
    let (mut found, mut in_block) = (Vec::new(), false);
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
        } else if in_block {
            found.push(line.to_owned());
        } else {
            found.extend(line.split('`').skip(1).step_by(2).map(str::to_owned));
        }
    }
    found
}

/// The words behind `strainwave`, or behind what it stands for, up to a comment.
fn command(code: &str) -> Option<Vec<&str>> {
    let words = ["strainwave ", "cargo run --release -- "]
        .iter()
        .find_map(|start| code.trim().strip_prefix(start))?;
    Some(words.split(" #").next().unwrap_or(words).split_whitespace().collect())
}

/// Output of `strainwave WORDS`.
fn answer(words: &[&str]) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_strainwave")).args(words).output().unwrap();
    assert!(run.status.success(), "{words:?}: {}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).unwrap()
}

#[test]
fn the_readme_is_short() {
    let words = read("README.md").split_whitespace().count();
    assert!(words <= README_WORDS, "README.md has {words} words; {README_WORDS} are enough");
}

#[test]
fn every_command_and_option_exists() {
    let mut help: HashMap<String, String> = HashMap::new();
    let mut seen = 0;
    for (path, text) in pages() {
        for code in code(&text) {
            let Some(words) = command(&code) else { continue };
            let [subcommand, rest @ ..] = words.as_slice() else { continue };
            let help =
                help.entry((*subcommand).to_owned()).or_insert_with(|| answer(&[subcommand, "--help"]));
            for option in rest.iter().filter(|word| word.starts_with("--")) {
                let known = help.split_whitespace().any(|word| word.trim_end_matches(',') == *option);
                assert!(known, "{path}: `{code}`: {subcommand} has no option {option}");
            }
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen} commands are not what README and book show");
    let all = answer(&["--help"]);
    let listed = all.split("Commands:").nth(1).and_then(|rest| rest.split("Options:").next()).unwrap();
    let first_words =
        listed.lines().filter_map(|line| line.strip_prefix("  ").filter(|line| !line.starts_with(' ')));
    for subcommand in
        first_words.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help")
    {
        assert!(help.contains_key(subcommand), "{subcommand} is shown nowhere");
    }
}

/// Targets of links, without the anchor; not those of other sites.
fn links(page: &str) -> impl Iterator<Item = &str> {
    page.split("](").skip(1).filter_map(|rest| rest.split(')').next()).filter_map(|target| {
        let file = target.split('#').next().unwrap_or_default();
        (!file.is_empty() && !file.contains("://")).then_some(file)
    })
}

#[test]
fn every_link_leads_to_a_file() {
    for (path, text) in pages() {
        let folder = root().join(&path).parent().unwrap().to_owned();
        for link in links(&text) {
            assert!(folder.join(link).exists(), "{path}: {link} does not exist");
        }
    }
}

#[test]
fn every_named_file_exists() {
    let mut seen = 0;
    for (path, text) in pages() {
        let code = code(&text);
        let words = code
            .iter()
            .flat_map(|code| code.split_whitespace())
            .map(|word| word.trim_matches(['`', ',', ':', ';']));
        for word in
            words.filter(|word| word.split_once('/').is_some_and(|(folder, _)| FOLDERS.contains(&folder)))
        {
            assert!(root().join(word).exists(), "{path}: {word} does not exist");
            seen += 1;
        }
        for name in code.iter().filter_map(|code| code.split("--example ").nth(1)) {
            let name = name.split_whitespace().next().unwrap();
            let exists =
                |folder: &str| root().join(folder).join("examples").join(format!("{name}.rs")).exists();
            assert!(["", "service"].into_iter().any(exists), "{path}: there is no example {name}");
        }
    }
    assert!(seen > 30, "{seen} files are not what README and book name");
}

#[test]
fn every_chapter_is_in_the_summary() {
    let summary = read("docs/src/SUMMARY.md");
    for (path, _) in pages() {
        let Some(chapter) = path.strip_prefix("docs/src/").filter(|name| *name != "SUMMARY.md") else {
            continue;
        };
        assert!(summary.contains(&format!("({chapter})")), "{chapter} is not in the summary");
    }
}

#[test]
fn the_page_of_figures_has_the_rows_of_today() {
    let page = read(FIGURES);
    let renewed = figures_page::renewed(&page, &[]).unwrap();
    if std::env::var_os("STRAINWAVE_OVERWRITE").is_some() {
        fs::write(root().join(FIGURES), &renewed).unwrap();
        return;
    }
    let differing = page.lines().zip(renewed.lines()).find(|(kept, now)| kept != now);
    assert!(page == renewed, "{FIGURES} is not what the table of bounds gives: {differing:?}");
}
