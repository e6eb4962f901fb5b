//! What the set-up asks of a machine.

use std::path::Path;
use std::process::{Command, Stdio};

/// The machine that is being made ready.
pub trait Host {
    /// Runs a command quietly: its standard output when it succeeds.
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String>;
    /// Runs a command in view of the user: whether it succeeds.
    fn succeeds(&self, program: &str, arguments: &[&str]) -> bool;
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

    fn succeeds(&self, program: &str, arguments: &[&str]) -> bool {
        // Standard output belongs to the figures of whoever called: installers write to standard error.
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::null()).stdout(std::io::stderr());
        command.env("DEBIAN_FRONTEND", "noninteractive");
        command.status().is_ok_and(|status| status.success())
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn announce(&self, line: &str) {
        eprintln!("{line}");
    }
}
