//! A debug probe and its program, probe-rs.
//!
//! The image is written and read back, then the chip starts it. With several probes `PROBE_RS_PROBE` names one, as probe-rs
//! has it; nothing is asked on a terminal.

use std::env;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

use super::{Error, PROGRAM};

/// Part of its message when no probe is connected.
const NO_PROBE: &str = "No connected probes were found";

/// A probe in front of a chip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Probe {
    chip: String,
}

impl Probe {
    /// In front of the chip of this name.
    pub fn of(chip: String) -> Self {
        Self { chip }
    }

    /// The chip's name.
    pub fn chip(&self) -> &str {
        &self.chip
    }

    /// What flashes an image and starts it, program first.
    pub fn commands(&self, elf: &Path) -> [Vec<String>; 2] {
        let elf = elf.display().to_string();
        [
            vec![PROGRAM, "download", "--chip", &self.chip, "--verify", &elf],
            vec![PROGRAM, "reset", "--chip", &self.chip],
        ]
        .map(|words| words.into_iter().map(str::to_owned).collect())
    }

    /// The program is there. Starts nothing.
    ///
    /// # Errors
    /// [`Error::NoProgram`].
    pub fn require_program(&self) -> Result<(), Error> {
        let path = env::var_os("PATH").unwrap_or_default();
        let found = env::split_paths(&path).any(|folder| folder.join(PROGRAM).is_file());
        if found { Ok(()) } else { Err(Error::NoProgram) }
    }

    /// Flashes an image and starts it.
    ///
    /// # Errors
    /// [`Error::NoProgram`], [`Error::NoProbe`], or [`Error::Refused`] with the program's message.
    pub fn flash(&self, elf: &Path) -> Result<(), Error> {
        self.commands(elf).iter().try_for_each(|command| run(command))
    }
}

fn run(words: &[String]) -> Result<(), Error> {
    let [program, command, ..] = words else { return Ok(()) };
    let output = Command::new(program)
        .args(&words[1..])
        .env("PROBE_RS_NON_INTERACTIVE", "true")
        .stdin(Stdio::null())
        .output()
        .map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => Error::NoProgram,
            _ => Error::Io(error),
        })?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].concat();
    let said = message(&String::from_utf8_lossy(&said)).unwrap_or_else(|| output.status.to_string());
    if said.contains(NO_PROBE) {
        return Err(Error::NoProbe { said });
    }
    Err(Error::Refused { command: command.clone(), said })
}

/// The error with its causes in one line, without what was logged before it; else the last line.
fn message(said: &str) -> Option<String> {
    let lines: Vec<&str> = said.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let first = lines.iter().position(|line| line.starts_with("Error: ") || line.starts_with("error: "));
    let lines = &lines[first.unwrap_or(lines.len().checked_sub(1)?)..];
    let text = lines.join(" ");
    Some(
        text.split_once("rror: ")
            .filter(|_| first.is_some())
            .map_or(text.as_str(), |(_, rest)| rest)
            .to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a program that is this script answers.
    fn answer(script: &str) -> Result<(), Error> {
        run(&["sh", "-c", script].map(str::to_owned))
    }

    #[test]
    fn the_image_is_written_and_then_started() {
        let probe = Probe::of("STM32F405RG".to_owned());
        let commands = probe.commands(Path::new("/images/a b.elf")).map(|words| words.join(" "));
        assert_eq!(
            commands,
            [
                "probe-rs download --chip STM32F405RG --verify /images/a b.elf",
                "probe-rs reset --chip STM32F405RG"
            ]
        );
    }

    #[test]
    fn a_failure_is_one_line() {
        assert!(answer("echo finished").is_ok());
        let line =
            answer("echo 'Error: No connected probes were found.' >&2; exit 1").unwrap_err().to_string();
        assert_eq!(
            line,
            "no debug probe is connected (No connected probes were found.); connect the board's: `probe-rs list` shows it"
        );
        let other = "printf ' WARN probe: slow\\nError: Connecting to the chip was unsuccessful.\\n\\nCaused by:\\n    \
                     0: An ARM specific error occurred.\\n    1: Unexpected part.\\n' >&2; exit 1";
        let line = answer(other).unwrap_err().to_string();
        assert_eq!(
            line,
            "`probe-rs -c` failed: Connecting to the chip was unsuccessful. Caused by: 0: An ARM specific error occurred. 1: \
             Unexpected part."
        );
        let line = answer("echo one; echo two; exit 3").unwrap_err().to_string();
        assert_eq!(line, "`probe-rs -c` failed: two");
        let line = answer("exit 3").unwrap_err().to_string();
        assert!(line.ends_with("failed: exit status: 3"), "{line}");
    }

    #[test]
    fn a_missing_program_is_told_with_its_installation() {
        let line = run(&["/nowhere/probe-rs".to_owned(), "reset".to_owned()]).unwrap_err().to_string();
        assert_eq!(
            line,
            "no probe-rs on PATH, which flashes this board's chip; install it: `cargo install probe-rs-tools --locked`"
        );
    }
}
