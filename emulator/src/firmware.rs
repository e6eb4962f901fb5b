//! Builds a board's firmware.

use crate::setup::{self, Compiler};
use crate::sources;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use strainwave_desktop::design::export;

/// Why there is no image.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is no such board.
    #[error("board {board}: unknown, the boards are {}", boards.join(", "))]
    UnknownBoard {
        /// Requested board.
        board: String,
        /// Existing boards.
        boards: Vec<String>,
    },
    /// The joint's file cannot be read.
    #[error("joint file {path}: {error}")]
    Joint {
        /// The file.
        path: String,
        /// Error of reading it.
        error: io::Error,
    },
    /// The board's cargo configuration names no target.
    #[error("{}: {what}", file.display())]
    Target {
        /// The file.
        file: PathBuf,
        /// Its fault.
        what: String,
    },
    /// There is no compiler.
    #[error(transparent)]
    Setup(#[from] setup::Error),
    /// The compiler or the linker refused.
    #[error("board {board} does not build with {compiler}: {said}")]
    Build {
        /// The board.
        board: String,
        /// The compiler.
        compiler: String,
        /// Its first error.
        said: String,
    },
    /// The host's side failed.
    #[error("boards: {0}")]
    Io(#[from] io::Error),
}

/// A linked image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Firmware {
    /// The ELF file.
    pub elf: PathBuf,
    /// The compiler that built it, version and all: sizes and counts hold for this one.
    pub compiler: String,
}

/// Where images are kept, in cargo's folder of what is built.
const IMAGES: &str = "images";

/// Variables of the build: the joint's number on CAN, and that of its drive.
const NODE: &str = "STRAINWAVE_NODE";
const ODRIVE: &str = "STRAINWAVE_ODRIVE";

/// A program of a board that controls the joint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Program {
    /// By itself: an operator moves it.
    #[default]
    Control,
    /// With the tuning link on its serial port, and a store.
    Served,
    /// As a node on CAN, which a controller commands.
    Commanded {
        /// Its number there, 1 to 127.
        node: u8,
    },
    /// The same whose drive is an ODrive on a second bus.
    BeforeOdrive {
        /// The joint's number, 1 to 127.
        node: u8,
        /// The drive's number on its bus, 0 to 62.
        drive: u8,
    },
}

impl Program {
    /// The node that a joint is if nothing else is said.
    pub const COMMANDED: Self = Self::Commanded { node: 1 };
    /// The same, with the drive that it then has.
    pub const BEFORE_ODRIVE: Self = Self::BeforeOdrive { node: 1, drive: 0 };

    /// What its figures and its budget have in front of their names.
    pub const fn prefix(self) -> &'static str {
        match self {
            Self::Control => "",
            Self::Served => "served_",
            Self::Commanded { .. } => "can_",
            Self::BeforeOdrive { .. } => "odrive_",
        }
    }

    fn binary(self, board: &str) -> String {
        let board = control(board);
        self.feature().map_or_else(|| board.clone(), |feature| format!("{board}-{feature}"))
    }

    /// The feature of the board's package that it takes; its binary is called so, too.
    const fn feature(self) -> Option<&'static str> {
        match self {
            Self::Control => None,
            Self::Served => Some("served"),
            Self::Commanded { .. } => Some("can"),
            Self::BeforeOdrive { .. } => Some("odrive"),
        }
    }

    /// Numbers on its buses, each with the variable that the build reads it from.
    fn numbers(self) -> Vec<(&'static str, u8)> {
        match self {
            Self::Control | Self::Served => Vec::new(),
            Self::Commanded { node } => vec![(NODE, node)],
            Self::BeforeOdrive { node, drive } => vec![(NODE, node), (ODRIVE, drive)],
        }
    }
}

/// The folder of the boards.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("boards")
}

/// The boards: the folders that hold a budget.
///
/// # Errors
/// When the folder of the boards cannot be read.
pub fn boards() -> io::Result<Vec<String>> {
    let mut boards = Vec::new();
    for entry in fs::read_dir(folder())? {
        let entry = entry?;
        if entry.path().join("budget.toml").is_file() {
            boards.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    boards.sort();
    Ok(boards)
}

/// Target triple of a board: what cargo takes in its folder, from the configuration there or else from that of all boards.
///
/// # Errors
/// [`Error::UnknownBoard`], [`Error::Target`].
pub fn target(board: &str) -> Result<String, Error> {
    require_known(board)?;
    let files = [folder().join(board), folder()].map(|folder| folder.join(".cargo/config.toml"));
    for file in &files {
        let Ok(text) = fs::read_to_string(file) else { continue };
        let bad = |what: &str| Error::Target { file: file.clone(), what: what.to_owned() };
        let config: toml::Table = toml::from_str(&text).map_err(|error| bad(error.message()))?;
        if let Some(target) = config.get("build").and_then(|build| build.get("target")) {
            return Ok(target.as_str().ok_or_else(|| bad("build.target is no target triple"))?.to_owned());
        }
    }
    let [_, file] = files;
    Err(Error::Target { file, what: "build.target is missing, allowed: a target triple".to_owned() })
}

/// The targets of all boards, each once.
///
/// # Errors
/// As [`target`], and when the folder of the boards cannot be read.
pub fn targets() -> Result<Vec<String>, Error> {
    let targets: BTreeSet<_> = boards()?.iter().map(|board| target(board)).collect::<Result<_, _>>()?;
    Ok(targets.into_iter().collect())
}

/// Builds the firmware of `board` for the default joint, or for the one in a file of `strainwave export`.
///
/// # Errors
/// [`Error::UnknownBoard`], [`Error::Joint`], [`Error::Setup`], or [`Error::Build`].
pub fn build(board: &str, joint: Option<&Path>) -> Result<Firmware, Error> {
    link(board, Program::Control, joint.map(Joint::read).transpose()?.as_ref())
}

/// Builds a program of `board` that controls the joint in a file of `strainwave export`.
///
/// # Errors
/// As [`build`].
pub fn build_as(program: Program, board: &str, joint: &Path) -> Result<Firmware, Error> {
    link(board, program, Some(&Joint::read(joint)?))
}

/// The program of a board that controls the joint by itself; its package, too.
pub fn control(board: &str) -> String {
    format!("strainwave-{board}")
}

/// Builds one of the programs of `board` that control no joint.
///
/// # Errors
/// As [`build`].
pub fn build_program(board: &str, program: &str) -> Result<Firmware, Error> {
    image(board, Parts { binary: program, name: program, feature: None, numbers: Vec::new() }, None)
}

fn link(board: &str, program: Program, joint: Option<&Joint>) -> Result<Firmware, Error> {
    let (binary, numbers) = (program.binary(board), program.numbers());
    let name = numbers.iter().fold(binary.clone(), |name, (_, number)| format!("{name}-{number}"));
    image(board, Parts { binary: &binary, name: &name, feature: program.feature(), numbers }, joint)
}

/// What a program of a board is built from, but for its joint.
struct Parts<'a> {
    binary: &'a str,
    /// What its image is called.
    name: &'a str,
    feature: Option<&'a str>,
    /// Its numbers on CAN, by variable.
    numbers: Vec<(&'static str, u8)>,
}

fn image(board: &str, parts: Parts, joint: Option<&Joint>) -> Result<Firmware, Error> {
    let compiler = setup::compiler(&setup::ThisHost, &target(board)?)?;
    let output = folder().join("target");
    let images = output.join(IMAGES);
    fs::create_dir_all(&images)?;
    let image = Image {
        elf: images.join(match joint {
            Some(joint) => format!("{}-{:016x}.elf", parts.name, joint.digest),
            None => format!("{}.elf", parts.name),
        }),
        sources: sources::digest(&folder().join(".."), &compiler.version)?,
    };
    let made = || Firmware { elf: image.elf.clone(), compiler: compiler.version.clone() };
    if image.is_fresh() {
        return Ok(made());
    }
    // Two joints share one cargo output: it is locked from the build until the image is out of its way.
    let lock = File::create(images.join("lock"))?;
    lock.lock()?;
    // Whoever had the lock may have built it.
    if !image.is_fresh() {
        run(&compiler, board, &parts, joint, &output)?;
        image.keep(&output.join(&compiler.target).join("release").join(parts.binary))?;
    }
    Ok(made())
}

/// Where an image is kept, and the digest of what it is built from.
struct Image {
    elf: PathBuf,
    sources: u64,
}

impl Image {
    /// File beside the image that holds the digest of its sources.
    fn stamp(&self) -> PathBuf {
        self.elf.with_extension("sources")
    }

    /// The image is there, and is of these sources.
    fn is_fresh(&self) -> bool {
        let stamped = fs::read_to_string(self.stamp());
        self.elf.is_file() && stamped.is_ok_and(|stamp| stamp == self.sources.to_string())
    }

    /// Takes what cargo has built. Image and stamp are renamed into place: a machine that runs the old image keeps it. The stamp
    /// comes last: an image without its stamp is built again.
    fn keep(&self, built: &Path) -> io::Result<()> {
        let (fresh, stamp) = (self.elf.with_extension("new"), self.stamp());
        let _ = fs::remove_file(&stamp);
        fs::copy(built, &fresh)?;
        fs::rename(&fresh, &self.elf)?;
        fs::write(&fresh, self.sources.to_string())?;
        fs::rename(&fresh, stamp)
    }
}

/// Refuses a name that no board has.
///
/// # Errors
/// [`Error::UnknownBoard`].
pub fn require_known(board: &str) -> Result<(), Error> {
    let boards = boards()?;
    if boards.iter().any(|known| known == board) {
        Ok(())
    } else {
        Err(Error::UnknownBoard { board: board.into(), boards })
    }
}

/// The generated file of a joint.
struct Joint {
    source: Vec<u8>,
    digest: u64,
}

impl Joint {
    fn read(path: &Path) -> Result<Self, Error> {
        let source =
            fs::read(path).map_err(|error| Error::Joint { path: path.display().to_string(), error })?;
        let mut hasher = DefaultHasher::new();
        source.hash(&mut hasher);
        Ok(Self { source, digest: hasher.finish() })
    }

    /// Its control step needs code for a belt.
    fn has_belt(&self) -> bool {
        String::from_utf8_lossy(&self.source).contains(export::WITH_BELT)
    }

    /// Puts the file where the same joint is found again: cargo then has nothing to do the second time.
    fn keep(&self, folder: &Path) -> io::Result<PathBuf> {
        let path = folder.join(format!("joint-{:016x}.rs", self.digest));
        if fs::read(&path).ok().as_ref() != Some(&self.source) {
            fs::write(&path, &self.source)?;
        }
        Ok(path)
    }
}

fn run(
    compiler: &Compiler,
    board: &str,
    parts: &Parts,
    joint: Option<&Joint>,
    target: &Path,
) -> Result<(), Error> {
    let mut command = compiler.build_command();
    without_host_settings(&mut command);
    command.current_dir(folder()).stdin(Stdio::null());
    command
        .args(["--quiet", "--locked", "--package", &control(board), "--bin", parts.binary, "--target-dir"])
        .arg(target);
    let belt = joint.filter(|joint| joint.has_belt()).map(|_| "belt");
    command.args(parts.feature.iter().chain(&belt).map(|feature| format!("--features={feature}")));
    if let Some(joint) = joint {
        command.env("STRAINWAVE_JOINT", joint.keep(&target.join(IMAGES))?);
    }
    command.envs(parts.numbers.iter().map(|(variable, number)| (variable, number.to_string())));
    let output = command.output()?;
    if output.status.success() {
        return Ok(());
    }
    let said = first_error(&String::from_utf8_lossy(&output.stderr));
    Err(Error::Build { board: board.into(), compiler: compiler.version.clone(), said })
}

/// Flags and profiles that the caller set for the host would change the image, or break it.
fn without_host_settings(command: &mut Command) {
    let ours = |name: &str| {
        name.starts_with("CARGO_PROFILE_")
            || name.starts_with("CARGO_BUILD_")
            || ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "DEFMT_LOG", "STRAINWAVE_JOINT", NODE, ODRIVE]
                .contains(&name)
    };
    for (name, _) in std::env::vars_os() {
        if name.to_str().is_some_and(ours) {
            command.env_remove(&name);
        }
    }
}

/// The line that matters in a compiler's or linker's output.
fn first_error(said: &str) -> String {
    let linker = said.lines().find_map(|line| line.split_once("lld: error: ").map(|(_, error)| error));
    let compiler = || said.lines().find(|line| line.starts_with("error"));
    linker
        .or_else(compiler)
        .or_else(|| said.lines().next_back())
        .unwrap_or("no reason given")
        .trim()
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::Scratch;

    #[test]
    fn an_unknown_board_is_answered_with_the_known_ones() {
        let error = build("mps2-an999", None).unwrap_err().to_string();
        assert!(error.starts_with("board mps2-an999: unknown"), "{error}");
        assert!(error.contains("mps2-an386") && error.contains("stm32f405"), "{error}");
        assert!(!error.contains("app"), "{error}");
    }

    #[test]
    fn a_board_has_the_target_of_its_own_configuration_before_that_of_all() {
        assert_eq!(target("mps2-an386").unwrap(), "thumbv7em-none-eabihf");
        assert_eq!(target("stm32f405").unwrap(), "thumbv7em-none-eabihf");
        assert_eq!(target("mps2-an505").unwrap(), "thumbv8m.main-none-eabihf");
        assert_eq!(targets().unwrap(), ["thumbv7em-none-eabihf", "thumbv8m.main-none-eabihf"]);
    }

    #[test]
    fn a_missing_joint_is_named() {
        let error = build("mps2-an386", Some(Path::new("nowhere/joint.rs"))).unwrap_err().to_string();
        assert!(error.starts_with("joint file nowhere/joint.rs: "), "{error}");
    }

    #[test]
    fn an_image_is_fresh_as_long_as_its_sources_are() {
        let folder = Scratch::new("image").unwrap();
        let image = |sources| Image { elf: folder.path().join("a.elf"), sources };
        let built = folder.path().join("built");
        fs::write(&built, "one").unwrap();
        assert!(!image(1).is_fresh());
        image(1).keep(&built).unwrap();
        assert!(image(1).is_fresh() && !image(2).is_fresh());
        fs::write(&built, "two").unwrap();
        image(2).keep(&built).unwrap();
        assert!(image(2).is_fresh() && !image(1).is_fresh());
        assert_eq!(fs::read_to_string(image(2).elf).unwrap(), "two");
        fs::remove_file(image(2).elf).unwrap();
        assert!(!image(2).is_fresh());
    }

    #[test]
    fn the_linkers_error_comes_before_the_compilers_summary() {
        let said = "error: linking with `rust-lld` failed\n  = note: rust-lld: error: undefined symbol: x\n";
        assert_eq!(first_error(said), "undefined symbol: x");
        assert_eq!(first_error("warning: a\nerror[E0425]: b\n"), "error[E0425]: b");
    }
}
