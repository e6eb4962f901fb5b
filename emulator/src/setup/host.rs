//! Interface of the set-up to a machine.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::download::Download;
use crate::process::tied_to_us;

/// Longest interval between checks of a running command; a short one is checked more often.
const GLANCE: Duration = Duration::from_millis(100);

/// Lines of a failed command's output that are passed on.
const LAST_LINES: usize = 5;

/// The machine that is being made ready. Its files below the cache folder are read and written directly.
pub trait Host {
    /// Runs a command quietly: its standard output when it succeeds.
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String>;
    /// Runs a command that may take long: nothing, or the last lines of what it said, in one line.
    fn run(&self, job: &Job<'_>) -> Result<(), String>;
    /// Whether there is such a file or folder.
    fn exists(&self, path: &Path) -> bool;
    /// The content of a text file of the system.
    fn text(&self, path: &str) -> Option<String>;
    /// A variable of the environment.
    fn variable(&self, name: &str) -> Option<OsString>;
    /// Tells the user what is about to be done.
    fn announce(&self, line: &str);
}

/// A command that may take long.
#[derive(Clone, Debug, Default)]
pub struct Job<'a> {
    /// Program to run.
    pub program: &'a str,
    /// Its arguments.
    pub arguments: &'a [&'a str],
    /// Longest time; without limit when `None`.
    pub patience: Option<Duration>,
    /// Download to be shown while it runs.
    pub download: Option<Download>,
}

/// The machine that this runs on.
pub struct ThisHost;

impl Host for ThisHost {
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String> {
        let output =
            Command::new(program).args(arguments).env("LC_ALL", "C").stdin(Stdio::null()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    }

    fn run(&self, job: &Job<'_>) -> Result<(), String> {
        run(job).map_err(|error| error.to_string())
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn text(&self, path: &str) -> Option<String> {
        std::fs::read_to_string(path).ok()
    }

    fn variable(&self, name: &str) -> Option<OsString> {
        std::env::var_os(name)
    }

    fn announce(&self, line: &str) {
        eprintln!("{line}");
    }
}

/// Runs a command; its hundreds of lines are of interest only when it fails.
fn run(job: &Job<'_>) -> io::Result<()> {
    let mut said = tempfile::tempfile()?;
    // An installer that outlives us would hold the locks of the next run.
    let mut command = tied_to_us(job.program);
    command.args(job.arguments).env("DEBIAN_FRONTEND", "noninteractive").env("LC_ALL", "C");
    command.stdin(Stdio::null()).stdout(said.try_clone()?).stderr(said.try_clone()?);
    let mut child = command.spawn()?;
    let started = Instant::now();
    let mut progress = job.download.as_ref().map(Download::show);
    loop {
        match child.try_wait()? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => return Err(io::Error::other(failure(status, &mut said))),
            None => std::thread::sleep(started.elapsed().clamp(Duration::from_millis(1), GLANCE)),
        }
        if let Some(progress) = &mut progress {
            progress.update();
        }
        if let Some(patience) = job.patience.filter(|patience| started.elapsed() > *patience) {
            child.kill()?;
            child.wait()?;
            return Err(io::Error::other(format!("no end after {} s", patience.as_secs())));
        }
    }
}

/// Why a command failed, in one line: its first error as apt marks it with `E:`, else its status and last lines.
fn failure(status: ExitStatus, said: &mut File) -> String {
    let mut bytes = Vec::new();
    // What cannot be read is not told: the status already is.
    let _ = said.rewind().and_then(|()| said.read_to_end(&mut bytes));
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    if let Some(error) = lines.iter().find_map(|line| line.strip_prefix("E: ")) {
        return error.to_owned();
    }
    format!("{status}: {}", lines[lines.len().saturating_sub(LAST_LINES)..].join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell<'a>(arguments: &'a [&'a str]) -> Job<'a> {
        Job { program: "sh", arguments, ..Job::default() }
    }

    #[test]
    fn a_failed_command_is_quoted_in_one_line() {
        assert!(run(&shell(&["-c", "echo fetched"])).is_ok());
        let error = run(&shell(&["-c", "echo fetched; echo no such package >&2; exit 100"]));
        let line = error.unwrap_err().to_string();
        assert!(line.contains("100") && line.ends_with("fetched; no such package"), "{line}");
    }

    #[test]
    fn the_first_error_of_apt_is_enough() {
        let error = run(&shell(&["-c", "echo fetched; echo E: refused; echo E: all ignored; exit 100"]));
        let line = error.unwrap_err().to_string();
        assert_eq!(line, "refused");
    }

    #[test]
    fn a_command_that_stalls_is_ended() {
        let started = Instant::now();
        let patience = Some(Duration::from_millis(200));
        let job = Job { program: "sleep", arguments: &["600"], patience, download: None };
        let error = run(&job).unwrap_err().to_string();
        assert!(error.starts_with("no end after"), "{error}");
        assert!(started.elapsed() < Duration::from_secs(60));
    }
}
