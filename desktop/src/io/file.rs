//! Whole files: read with a limit, written complete or not at all. The path `-` stands for the standard streams.

use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

/// Why a file was refused, as one line without control characters: `file: what`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadInput {
    line: String,
}

impl BadInput {
    /// `file` is refused because of `what`.
    pub fn new(file: &Path, what: impl fmt::Display) -> Self {
        Self::message(format!("{}: {what}", file.display()))
    }

    /// A refusal that is not about one file.
    pub fn message(what: impl fmt::Display) -> Self {
        Self { line: one_line(&what.to_string()) }
    }
}

impl fmt::Display for BadInput {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.line)
    }
}

impl std::error::Error for BadInput {}

/// Control characters are escaped: a file name or a cell can hold a line feed or a terminal's escape.
fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_control() {
            line.extend(character.escape_default());
        } else {
            line.push(character);
        }
    }
    line
}

/// `path` stands for standard input or standard output.
pub fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// The bytes of `path`, of which there may be at most `limit`; of standard input for `-`.
///
/// # Errors
/// The file cannot be opened or read, or is longer than `limit`.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, BadInput> {
    let mut bytes = Vec::new();
    let source: Box<dyn Read> =
        if is_stream(path) { Box::new(io::stdin().lock()) } else { Box::new(open(path)?) };
    // A device has no length of its own: the limit is kept while reading.
    source.take(limit + 1).read_to_end(&mut bytes).map_err(|error| unreadable(path, &error))?;
    if bytes.len() as u64 > limit {
        return Err(BadInput::new(path, format_args!("longer than {limit} bytes, the most allowed")));
    }
    Ok(bytes)
}

/// `path` opened for reading; a folder is refused here.
///
/// # Errors
/// The file cannot be opened.
pub fn open(path: &Path) -> Result<File, BadInput> {
    if path.is_dir() {
        return Err(BadInput::new(path, "cannot be read: it is a folder"));
    }
    File::open(path).map_err(|error| unreadable(path, &error))
}

pub(crate) fn unreadable(path: &Path, error: &io::Error) -> BadInput {
    BadInput::new(path, format_args!("cannot be read: {error}"))
}

fn unwritable(path: &Path, error: &io::Error) -> BadInput {
    BadInput::new(path, format_args!("cannot be written: {error}"))
}

/// Refuses a `path` that [`write()`] could not write, before the work whose result goes there.
///
/// # Errors
/// The folder is missing or closed, or `path` is a folder.
pub fn require_writable(path: &Path) -> Result<(), BadInput> {
    if is_stream(path) {
        return Ok(());
    }
    if path.is_dir() {
        return Err(BadInput::new(path, "cannot be written: it is a folder"));
    }
    let target = resolve(path);
    let folder = folder_of(&target);
    if !folder.is_dir() {
        return Err(BadInput::new(
            path,
            format_args!("cannot be written: there is no folder {}", folder.display()),
        ));
    }
    let tried =
        if is_special(&target) { open_special(&target).map(drop) } else { temporary(&target).map(drop) };
    tried.map_err(|error| unwritable(path, &error))
}

/// Writes `path` complete or not at all: `fill` writes a temporary file in the same folder, which
/// then takes the name. A link is followed; a device or pipe, which cannot be replaced, is written to. To standard output,
/// `-`, goes what is complete, too.
///
/// # Errors
/// The file cannot be written, or `fill` refuses.
pub fn write<F>(path: &Path, fill: F) -> Result<(), BadInput>
where
    F: FnOnce(&mut dyn Write) -> Result<(), WriteError>,
{
    require_writable(path)?;
    let target = resolve(path);
    let written = if is_stream(path) {
        write_stream(fill)
    } else if is_special(&target) {
        write_special(&target, fill)
    } else {
        write_regular(&target, fill)
    };
    written.map_err(|error| match error {
        WriteError::Io(error) => unwritable(path, &error),
        WriteError::Refused(why) => BadInput::new(path, format_args!("not written: {why}")),
    })
}

/// Why a file was not written.
#[derive(Debug)]
pub enum WriteError {
    /// The system refused.
    Io(io::Error),
    /// The content is not fit to be written.
    Refused(String),
}

impl From<io::Error> for WriteError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

fn write_regular<F>(target: &Path, fill: F) -> Result<(), WriteError>
where
    F: FnOnce(&mut dyn Write) -> Result<(), WriteError>,
{
    let file = temporary(target)?;
    fill_buffered(file.as_file(), fill)?;
    file.persist(target).map_err(|error| error.error)?;
    Ok(())
}

fn write_special<F>(target: &Path, fill: F) -> Result<(), WriteError>
where
    F: FnOnce(&mut dyn Write) -> Result<(), WriteError>,
{
    fill_buffered(&open_special(target)?, fill)
}

fn write_stream<F>(fill: F) -> Result<(), WriteError>
where
    F: FnOnce(&mut dyn Write) -> Result<(), WriteError>,
{
    let mut whole = Vec::new();
    fill(&mut whole)?;
    let mut output = io::stdout().lock();
    match output.write_all(&whole).and_then(|()| output.flush()) {
        // A reader that has seen enough has closed the pipe.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

fn fill_buffered<F>(file: &File, fill: F) -> Result<(), WriteError>
where
    F: FnOnce(&mut dyn Write) -> Result<(), WriteError>,
{
    let mut buffered = BufWriter::new(file);
    fill(&mut buffered)?;
    Ok(buffered.flush()?)
}

fn open_special(target: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).open(target)
}

/// Target of a link; a path that does not exist yet is itself.
fn resolve(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}

fn is_special(target: &Path) -> bool {
    target.metadata().is_ok_and(|metadata| !metadata.is_file())
}

/// A new file beside `target`, with the permissions that a plain `File::create` would give.
fn temporary(target: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".strainwave-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // The library's own error names the temporary file, which is none of the reader's business.
    builder.tempfile_in(folder_of(target)).map_err(|error| error.kind().into())
}

/// The folder that a file stands in.
pub fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.csv");
        write(&path, |out| Ok(out.write_all(b"old")?)).unwrap();
        let refused = write(&path, |out| {
            out.write_all(b"half a fi")?;
            Err(WriteError::Refused("bad".into()))
        });
        assert!(refused.unwrap_err().to_string().ends_with("out.csv: not written: bad"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_refused_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let error = require_writable(&folder.path().join("none/out.csv")).unwrap_err().to_string();
        assert!(error.contains("none/out.csv: cannot be written: there is no folder "), "{error}");
        assert!(require_writable(folder.path()).unwrap_err().to_string().contains("it is a folder"));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_are_ordinary() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (real, link, plain) =
            (folder.path().join("real"), folder.path().join("link"), folder.path().join("plain"));
        File::create(&plain).unwrap();
        std::fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write(&link, |out| Ok(out.write_all(b"new")?)).unwrap();
        assert_eq!(std::fs::read(&real).unwrap(), b"new");
        assert!(link.symlink_metadata().unwrap().is_symlink());
        let mode = |path: &Path| path.metadata().unwrap().permissions().mode();
        assert_eq!(mode(&real), mode(&plain));
    }

    #[test]
    fn an_error_is_one_line_without_control_characters() {
        let error = BadInput::new(Path::new("a\nb"), "c\u{1b}[31m\rd").to_string();
        assert_eq!(error, "a\\nb: c\\u{1b}[31m\\rd");
    }
}
