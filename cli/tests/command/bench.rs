//! The built command in a folder of its own.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Command, Output};

use strainwave_emulator::setup::{self, ThisHost};
use tempfile::TempDir;

/// The default gear file.
pub const GEAR: &str = include_str!("../../../gears/hd25-100.toml");
/// A short open-loop input.
pub const INPUT: &str = "t_s,theta_wg_rad,tau_load_nm\n0,0,0\n0.001,0.1,-50\n0.002,0.2,-50\n";

/// A short measured log of a joint that stands, moves there and back, and stands.
pub const LOG: &str = "t_s,theta_motor_rad,tau_motor_nm,theta_out_rad\n\
    0,0.0,0.0,0.0\n0.004,0.0,0.0,0.0\n0.008,0.0,0.0,0.0\n\
    0.012,0.01,0.05,-0.0001\n\
    0.016,0.02,0.05,-0.0002\n\
    0.020,0.03,0.05,-0.0003\n\
    0.024,0.04,0.05,-0.0004\n\
    0.028,0.05,0.05,-0.0005\n\
    0.032,0.06,0.05,-0.0006\n\
    0.036,0.07,0.05,-0.0007\n\
    0.040,0.08,0.05,-0.0008\n\
    0.044,0.09,0.05,-0.0009\n\
    0.048,0.1,0.05,-0.001\n\
    0.052,0.1,0.05,-0.001\n\
    0.056,0.09,0.05,-0.0009\n\
    0.060,0.08,0.05,-0.0008\n\
    0.064,0.07,0.05,-0.0007\n\
    0.068,0.06,0.05,-0.0006\n\
    0.072,0.05,0.05,-0.0005\n\
    0.076,0.04,0.05,-0.0004\n\
    0.080,0.03,0.05,-0.0003\n\
    0.084,0.02,0.05,-0.0002\n\
    0.088,0.01,0.05,-0.0001\n\
    0.092,0.0,0.05,-0\n\
    ";

/// A folder with files, in which the command runs.
pub struct Bench {
    folder: TempDir,
}

/// Answer of a run.
pub struct Answer {
    /// Exit code; none when a signal ended it.
    pub code: Option<i32>,
    /// Standard output.
    pub output: String,
    /// Error stream.
    pub error: String,
}

impl Bench {
    /// A folder with a good gear file `g.toml` and a good input `in.csv`.
    pub fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        bench.write("g.toml", GEAR);
        bench.write("in.csv", INPUT);
        bench
    }

    /// Puts a file into the folder.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// The path of a name in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The figures that a run has written to a file of the folder.
    pub fn figures(&self, name: &str) -> Vec<serde_json::Value> {
        let text = std::fs::read_to_string(self.path(name)).unwrap();
        let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
        json["figures"].as_array_mut().map(std::mem::take).unwrap()
    }

    /// Every file and its content; folders without.
    pub fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        entries
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.clone(), std::fs::read(path).unwrap_or_default()))
            .collect()
    }

    /// The command with words separated by spaces, a backtrace being asked for.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_strainwave"));
        command.args(words.split_whitespace()).current_dir(self.folder.path()).env("RUST_BACKTRACE", "full");
        command
    }

    /// Runs the command.
    pub fn run(&self, words: &str) -> Answer {
        Self::answer(&mut self.command(words))
    }

    /// Runs a command of [`Self::command`] that was changed.
    pub fn answer(command: &mut Command) -> Answer {
        let Output { status, stdout, stderr } = command.output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Answer { code: status.code(), output: text(stdout), error: text(stderr) }
    }

    /// Runs the command, which must refuse with one line and leave the folder as it was.
    pub fn refused(&self, words: &str) -> String {
        self.refuses(words, &mut self.command(words))
    }

    /// The same of a command in an environment of its own, called `words` when it does not refuse.
    pub fn refuses(&self, words: &str, command: &mut Command) -> String {
        let before = self.files();
        let answer = Self::answer(command);
        assert_eq!(answer.code, Some(2), "{words}: {}", answer.error);
        assert_eq!(answer.output, "", "{words}");
        let line = answer.error.strip_suffix('\n').expect("a line ends");
        assert!(line.starts_with("error: ") && !line.chars().any(char::is_control), "{words}: {line:?}");
        assert!(self.files() == before, "{words} left something behind");
        line.to_owned()
    }
}

/// Whether there is no emulator, which is said: what needs it is skipped.
pub fn lacks_emulator() -> bool {
    let lacks = setup::present_emulator(&ThisHost).is_none();
    if lacks {
        println!("skipped: no emulator");
    }
    lacks
}
