//! Unpacks Debian archives into a private folder and makes their programs run from there.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};

use super::host::{Host, Job};

/// Folders that no program of ours reads: half of the unpacked files.
const UNREAD: [&str; 4] = ["usr/share/doc", "usr/share/man", "usr/share/info", "usr/share/locale"];

/// Folders of the compiler's sources beside the standard library.
const UNREAD_SOURCES: [&str; 3] = ["compiler", "src", "debian"];

/// Unpacks archives into `folder`, whose programs will be run from `home`.
///
/// # Errors
/// The failure, in one line.
pub fn unpack(host: &dyn Host, archives: &[PathBuf], folder: &Path, home: &Path) -> Result<(), String> {
    for archive in archives {
        let (from, to) = (archive.display().to_string(), folder.display().to_string());
        let arguments = ["--extract", &from, &to];
        host.run(&Job { program: "dpkg-deb", arguments: &arguments, ..Job::default() })?;
    }
    finish(folder, home).map_err(|error| error.to_string())
}

fn finish(folder: &Path, home: &Path) -> io::Result<()> {
    remove_unread(folder)?;
    redirect_links(folder, folder)?;
    write_starters(folder, home)
}

fn remove_unread(folder: &Path) -> io::Result<()> {
    let sources = entries(&folder.join("usr/src"))?;
    let sources = sources.iter().flat_map(|source| UNREAD_SOURCES.map(|name| source.join(name)));
    for path in UNREAD.iter().map(|name| folder.join(name)).chain(sources) {
        if path.symlink_metadata().is_ok_and(|metadata| metadata.is_dir()) {
            fs::remove_dir_all(path)?;
        }
    }
    Ok(())
}

/// A link to `/usr/...` means a file of the package, not of the system.
fn redirect_links(root: &Path, folder: &Path) -> io::Result<()> {
    for path in entries(folder)? {
        let metadata = path.symlink_metadata()?;
        if metadata.is_dir() {
            redirect_links(root, &path)?;
        } else if metadata.is_symlink()
            && let Ok(below) = fs::read_link(&path)?.strip_prefix("/")
            && root.join(below).exists()
        {
            let up =
                path.strip_prefix(root).map_or(0, |inside| inside.components().count().saturating_sub(1));
            let relative: PathBuf = std::iter::repeat_n(Path::new(".."), up).collect();
            fs::remove_file(&path)?;
            symlink(relative.join(below), &path)?;
        }
    }
    Ok(())
}

/// A script in `bin` for each program: it starts the program with the libraries of the folder.
fn write_starters(folder: &Path, home: &Path) -> io::Result<()> {
    let mut libraries = BTreeSet::new();
    library_folders(folder, &mut libraries)?;
    let libraries: Vec<String> = libraries
        .iter()
        .filter_map(|path| path.strip_prefix(folder).ok())
        .map(|path| quoted(&home.join(path)))
        .collect();
    let bin = folder.join("bin");
    fs::create_dir_all(&bin)?;
    for program in entries(&folder.join("usr/bin"))? {
        let Some(name) = program.file_name() else { continue };
        let script = format!(
            "#!/bin/sh\nLD_LIBRARY_PATH={}${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}\nexport LD_LIBRARY_PATH\n\
             exec {} \"$@\"\n",
            libraries.join(":"),
            quoted(&home.join("usr/bin").join(name))
        );
        let path = bin.join(name);
        fs::write(&path, script)?;
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755))?;
    }
    Ok(())
}

/// Every folder that holds a shared library.
fn library_folders(folder: &Path, found: &mut BTreeSet<PathBuf>) -> io::Result<()> {
    for path in entries(folder)? {
        if path.symlink_metadata()?.is_dir() {
            library_folders(&path, found)?;
        } else if is_library(&path) {
            found.insert(folder.to_owned());
        }
    }
    Ok(())
}

/// `libfdt.so.1`, not a module that its program finds by itself.
fn is_library(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with("lib") && (name.ends_with(".so") || name.contains(".so."))
}

/// The files and folders in a folder, in order; none when there is no such folder.
fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

/// A path as one word of a shell.
pub fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}
