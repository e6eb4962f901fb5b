//! The files that a command names, checked before its work begins.

use std::path::{Path, PathBuf};

use strainwave_desktop::{BadInput, file};

/// Refuses two names for one file, of which the one written later would replace the other.
pub fn require_distinct(named: &[(&str, Option<&Path>)]) -> Result<(), BadInput> {
    let present: Vec<_> =
        named.iter().filter_map(|(name, path)| Some((name, same(path.as_ref()?)))).collect();
    for (index, (name, path)) in present.iter().enumerate() {
        if let Some((other, _)) = present[..index].iter().find(|(_, earlier)| earlier == path) {
            return Err(BadInput::new(path, format_args!("{name} and {other} are the same file")));
        }
    }
    Ok(())
}

/// The file itself, or where it would be.
fn same(path: &Path) -> PathBuf {
    let made = || {
        let folder = file::folder_of(path);
        Some(folder.canonicalize().ok()?.join(path.file_name()?))
    };
    path.canonicalize().ok().or_else(made).unwrap_or_else(|| path.to_path_buf())
}

/// Refuses a file that could not be written at the end.
pub fn require_writable(path: Option<&Path>) -> Result<(), BadInput> {
    path.map_or(Ok(()), file::require_writable)
}

/// Makes a folder that results go to, unless it is there.
pub fn require_folder(path: &Path) -> Result<(), BadInput> {
    std::fs::create_dir_all(path)
        .map_err(|error| BadInput::new(path, format_args!("cannot be made: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_by_two_names_is_refused() {
        let (a, b, c) = (Path::new("src/main.rs"), Path::new("src/../src/main.rs"), Path::new("none.csv"));
        assert!(require_distinct(&[("--input", Some(a)), ("--output", Some(c)), ("--json", None)]).is_ok());
        let line = require_distinct(&[("--input", Some(a)), ("--output", Some(b))]).unwrap_err().to_string();
        assert!(line.ends_with("main.rs: --output and --input are the same file"), "{line}");
        assert!(
            require_distinct(&[("--output", Some(c)), ("--json", Some(Path::new("./none.csv")))]).is_err()
        );
    }
}
