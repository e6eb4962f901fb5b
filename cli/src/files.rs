//! The files that a command names, checked before its work begins.

use std::path::{Path, PathBuf};

use strainwave_desktop::BadInput;
use strainwave_desktop::io::file;

/// Refuses two names for one file, of which the one written later would replace the other. Standard input and output, `-`, are
/// two.
pub fn require_distinct(named: &[(&str, Option<&Path>)]) -> Result<(), BadInput> {
    let files = named.iter().filter(|(_, path)| path.is_some_and(|path| !file::is_stream(path)));
    let present: Vec<_> = files.filter_map(|(name, path)| Some((name, same(path.as_ref()?)))).collect();
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

/// Refuses a folder for results in which none could be written. Makes nothing yet.
pub fn require_folder(path: &Path) -> Result<(), BadInput> {
    let to_be_made = |part: &&Path| !part.as_os_str().is_empty() && !part.exists();
    match path.ancestors().take_while(to_be_made).last() {
        Some(missing) => file::require_writable(missing),
        None if path.is_dir() => file::require_writable(&path.join("result")),
        None => Err(BadInput::new(path, "is a file; a folder is needed")),
    }
}

/// Refuses a page that could not be written at the end; its folder may be missing. Makes nothing yet.
pub fn require_page(path: &Path) -> Result<(), BadInput> {
    let folder = file::folder_of(path);
    require_folder(folder)?;
    if folder.is_dir() { file::require_writable(path) } else { Ok(()) }
}

/// Writes a page complete or not at all, its folder made when missing.
pub fn write_page(path: &Path, text: &str) -> Result<(), BadInput> {
    make_folder(file::folder_of(path))?;
    file::write(path, |out| Ok(out.write_all(text.as_bytes())?))
}

/// Makes a folder that results go to, unless it is there.
pub fn make_folder(path: &Path) -> Result<(), BadInput> {
    std::fs::create_dir_all(path)
        .map_err(|error| BadInput::new(path, format_args!("cannot be made: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_checked_before_it_is_made() {
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join("file"), "").unwrap();
        let check = |name: &str| require_folder(&root.path().join(name)).map_err(|error| error.to_string());
        assert!(check("").is_ok() && check("new").is_ok() && check("new/below").is_ok());
        assert!(!root.path().join("new").exists());
        assert!(check("file").unwrap_err().ends_with("file: is a file; a folder is needed"));
        assert!(
            check("file/below").unwrap_err().contains("file/below: cannot be written: there is no folder")
        );
        make_folder(&root.path().join("new/below")).unwrap();
        assert!(check("new/below").is_ok());
    }

    #[test]
    fn a_page_is_checked_and_written_with_its_folder() {
        let root = tempfile::tempdir().unwrap();
        let page = root.path().join("new/below/page.html");
        require_page(&page).unwrap();
        assert!(!root.path().join("new").exists());
        write_page(&page, "text").unwrap();
        assert!(require_page(&page).is_ok() && std::fs::read_to_string(&page).unwrap() == "text");
        let line = require_page(&root.path().join("new/below")).unwrap_err().to_string();
        assert!(line.ends_with("below: cannot be written: it is a folder"), "{line}");
    }

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
