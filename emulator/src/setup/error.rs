//! Why the compiler or the emulator could not be made ready, each in one line.

use super::needed::{EMULATOR, OLDEST_COMPILER, OLDEST_EMULATOR};

/// Failure of the set-up.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// No compiler for the boards, and none could be fetched.
    #[error("no Rust {} or newer for {target}: {why}", number(OLDEST_COMPILER))]
    NoCompiler {
        /// Target triple.
        target: String,
        /// Why.
        why: Unfetched,
    },
    /// No emulator, and none could be fetched.
    #[error("no {EMULATOR} {} or newer on PATH: {why}", number(OLDEST_EMULATOR))]
    NoEmulator {
        /// Why.
        why: Unfetched,
    },
}

fn number((major, minor): (u32, u32)) -> String {
    format!("{major}.{minor}")
}

/// Why packages could not be fetched.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfetched {
    /// The machine has no apt.
    #[error("there is no apt-get to fetch it with; {0}")]
    NoApt(&'static str),
    /// None of the variables names a cache folder.
    #[error("no folder to keep it in: set STRAINWAVE_CACHE, XDG_CACHE_HOME or HOME to an absolute path")]
    NoCache,
    /// The cache folder cannot be written.
    #[error("the cache folder {folder} cannot be written ({reason}): STRAINWAVE_CACHE can name another one")]
    Cache {
        /// The folder.
        folder: String,
        /// Error of writing it.
        reason: String,
    },
    /// apt failed.
    #[error("apt-get cannot fetch {packages}: {reason}")]
    Apt {
        /// Requested packages.
        packages: String,
        /// Its last lines.
        reason: String,
    },
    /// The package lists offer a version that is too old.
    #[error("the package lists offer {package} {version} only: put a newer one on PATH")]
    Old {
        /// The package.
        package: String,
        /// Its version.
        version: String,
    },
    /// The packages are built for a newer system.
    #[error(
        "{packages} of the package lists needs a newer C library than this machine's: upgrade the system"
    )]
    CLibrary {
        /// Requested packages.
        packages: String,
    },
    /// A fetched program does not run.
    #[error("{program} was fetched but does not run")]
    DoesNotRun {
        /// The program.
        program: String,
    },
}

/// Installation of the emulator on other systems.
pub const INSTALL_EMULATOR: &str = "install it: `dnf install qemu-system-arm`, `pacman -S qemu-system-arm`, \
     `brew install qemu` or `zypper install qemu-arm`";

/// Installation of a compiler with the target on other systems.
pub const INSTALL_COMPILER: &str = "install rustup (`dnf install rustup`, `pacman -S rustup`, `brew install rustup` or \
     `zypper install rustup`), then `rustup target add` with this target";
