//! Digest of everything that a firmware image is built from: an image whose sources have not changed is not built again.
//!
//! Cargo has one output for a program, whatever the joint: of two joints that take turns it would compile and link each anew.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::Path;

/// What the boards' workspace builds from, below the repository's root: folders whole, but for what is built, and files.
const SOURCES: [&str; 8] =
    ["boards", "derive", "drivers", "service", "src", "Cargo.lock", "Cargo.toml", "memory.x"];
/// Folders of what is built, or of what no build reads.
const LEFT_OUT: [&str; 2] = ["target", ".git"];

/// Of the sources below `root`, by `compiler`, version and all.
///
/// # Errors
/// A source that cannot be read.
pub(crate) fn digest(root: &Path, compiler: &str) -> io::Result<u64> {
    let mut hasher = DefaultHasher::new();
    compiler.hash(&mut hasher);
    for source in SOURCES {
        add(&root.join(source), &mut hasher)?;
    }
    Ok(hasher.finish())
}

/// Names and contents, in the order of the names.
fn add(path: &Path, hasher: &mut DefaultHasher) -> io::Result<()> {
    path.file_name().hash(hasher);
    if !path.is_dir() {
        fs::read(path)?.hash(hasher);
        return Ok(());
    }
    let entries = fs::read_dir(path)?.map(|entry| Ok(entry?.path()));
    let mut entries = entries.collect::<io::Result<Vec<_>>>()?;
    entries.retain(|entry| LEFT_OUT.iter().all(|name| !entry.ends_with(name)));
    entries.sort();
    entries.len().hash(hasher);
    entries.iter().try_for_each(|entry| add(entry, hasher))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::Scratch;

    #[test]
    fn any_source_changes_the_digest_and_what_is_built_does_not() {
        let folder = Scratch::new("sources").unwrap();
        let root = folder.path();
        for source in SOURCES {
            if source.contains('.') {
                fs::write(root.join(source), "a").unwrap();
            } else {
                fs::create_dir_all(root.join(source).join("inner/.cargo")).unwrap();
            }
        }
        let of = || digest(root, "rustc 1.0").unwrap();
        let mut seen = vec![of(), digest(root, "rustc 1.1").unwrap()];
        for (name, content) in [
            ("src/inner/a.rs", "a"),
            ("src/inner/a.rs", "b"),
            ("src/inner/b.rs", ""),
            ("boards/inner/.cargo/config.toml", ""),
            ("memory.x", "b"),
        ] {
            fs::write(root.join(name), content).unwrap();
            assert!(!seen.contains(&of()), "{name}");
            seen.push(of());
        }
        let before = of();
        fs::create_dir(root.join("boards/target")).unwrap();
        fs::write(root.join("boards/target/image.elf"), "a").unwrap();
        assert_eq!(of(), before);
        fs::remove_file(root.join("memory.x")).unwrap();
        assert!(digest(root, "rustc 1.0").is_err());
    }
}
