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
    link(board, &control(board), &[], joint.map(Joint::read).transpose()?.as_ref())
}

/// Builds the firmware of `board` that serves the tuning link too, for the joint in a file of `strainwave export`.
///
/// # Errors
/// As [`build`].
pub fn build_served(board: &str, joint: &Path) -> Result<Firmware, Error> {
    link(board, &served(board), &["served"], Some(&Joint::read(joint)?))
}

/// The program of a board that controls the joint.
pub fn control(board: &str) -> String {
    format!("strainwave-{board}")
}

/// Builds one of the programs of `board` that control no joint.
///
/// # Errors
/// As [`build`].
pub fn build_program(board: &str, program: &str) -> Result<Firmware, Error> {
    link(board, program, &[], None)
}

/// The program of a board that serves the tuning link beside the control.
fn served(board: &str) -> String {
    format!("strainwave-{board}-served")
}

fn link(board: &str, program: &str, features: &[&str], joint: Option<&Joint>) -> Result<Firmware, Error> {
    let compiler = setup::compiler(&setup::ThisHost, &target(board)?)?;
    let output = folder().join("target");
    let images = output.join("images");
    fs::create_dir_all(&images)?;
    let image = Image {
        elf: images.join(match joint {
            Some(joint) => format!("{program}-{:016x}.elf", joint.digest),
            None => format!("{program}.elf"),
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
        let joint_file = joint.map(|joint| joint.keep(&images)).transpose()?;
        let belt = joint.filter(|joint| joint.has_belt()).map(|_| "belt");
        let features: Vec<_> = features.iter().copied().chain(belt).collect();
        run(&compiler, board, (program, &features), joint_file, &output)?;
        image.keep(&output.join(&compiler.target).join("release").join(program))?;
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
    (program, features): (&str, &[&str]),
    joint: Option<PathBuf>,
    target: &Path,
) -> Result<(), Error> {
    let mut command = compiler.build_command();
    without_host_settings(&mut command);
    command.current_dir(folder()).stdin(Stdio::null());
    command
        .args(["--quiet", "--locked", "--package", &control(board), "--bin", program, "--target-dir"])
        .arg(target);
    command.args(features.iter().map(|feature| format!("--features={feature}")));
    if let Some(joint) = joint {
        command.env("STRAINWAVE_JOINT", joint);
    }
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
            || ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "DEFMT_LOG", "STRAINWAVE_JOINT"].contains(&name)
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
