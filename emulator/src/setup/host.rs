//! What the set-up asks of a machine.

use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// How often a running installer is looked at.
const GLANCE: Duration = Duration::from_millis(100);

/// How much of a failed installer's output is passed on.
const LAST_LINES: usize = 5;

/// The machine that is being made ready.
pub trait Host {
    /// Runs a command quietly: its standard output when it succeeds.
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String>;
    /// Runs an installer: whether it succeeds, within its patience if it has one.
    fn succeeds(&self, program: &str, arguments: &[&str], patience: Option<Duration>) -> bool;
    /// Whether there is such a file or folder.
    fn exists(&self, path: &Path) -> bool;
    /// Tells the user what is about to be done.
    fn announce(&self, line: &str);
}

/// The machine that this runs on.
pub struct ThisHost;

impl Host for ThisHost {
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String> {
        let output = Command::new(program).args(arguments).stdin(Stdio::null()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    }

    fn succeeds(&self, program: &str, arguments: &[&str], patience: Option<Duration>) -> bool {
        match run(program, arguments, patience) {
            Ok(()) => true,
            Err(error) => {
                self.announce(&format!("{program} {}: {error}", arguments.join(" ")));
                false
            }
        }
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn announce(&self, line: &str) {
        eprintln!("{line}");
    }
}

/// Runs an installer; its hundreds of lines are of interest only when it fails.
fn run(program: &str, arguments: &[&str], patience: Option<Duration>) -> io::Result<()> {
    let mut said = tempfile::tempfile()?;
    let mut command = Command::new(program);
    command.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
    command.stdin(Stdio::null()).stdout(said.try_clone()?).stderr(said.try_clone()?);
    let mut child = command.spawn()?;
    let started = Instant::now();
    loop {
        match child.try_wait()? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => return Err(io::Error::other(format!("{status}: {}", last_lines(&mut said)))),
            None => std::thread::sleep(GLANCE),
        }
        if let Some(patience) = patience.filter(|patience| started.elapsed() > *patience) {
            child.kill()?;
            child.wait()?;
            return Err(io::Error::other(format!("no end after {} s", patience.as_secs())));
        }
    }
}

/// The end of what was said, in one line.
fn last_lines(said: &mut File) -> String {
    let mut bytes = Vec::new();
    // What cannot be read is not told: the status already is.
    let _ = said.rewind().and_then(|()| said.read_to_end(&mut bytes));
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    lines[lines.len().saturating_sub(LAST_LINES)..].join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_installer_is_quoted_in_one_line() {
        assert!(run("sh", &["-c", "echo fetched"], None).is_ok());
        let error = run("sh", &["-c", "echo fetched; echo E: no such package >&2; exit 100"], None);
        let line = error.unwrap_err().to_string();
        assert!(line.contains("100") && line.ends_with("fetched; E: no such package"), "{line}");
    }

    #[test]
    fn an_installer_that_stalls_is_ended() {
        let started = Instant::now();
        let error = run("sleep", &["600"], Some(Duration::from_millis(200))).unwrap_err().to_string();
        assert!(error.starts_with("no end after"), "{error}");
        assert!(started.elapsed() < Duration::from_secs(60));
    }
}
