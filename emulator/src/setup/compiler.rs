//! A Rust compiler for a board's target.
//!
//! The order: the target in the compiler's sysroot, then plain cargo; the library's sources in the sysroot
//! of the user's compiler, the system's or the one in the cache folder, then `-Z build-std`;
//! `rustup target add`; Debian's packages, into the cache folder.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use super::error::{Error, INSTALL_COMPILER, Unfetched};
use super::host::{Host, Job};
use super::needed::OLDEST_COMPILER;
use super::package_set::PackageSet;
use super::unpack::quoted;
use super::version::{first_line, version_in};

/// Longest time of rustup: 13 MB at a little over 1 Mbit/s. A server that accepts and then sends nothing
/// would hold it for ever.
const RUSTUP_PATIENCE: Duration = Duration::from_secs(90);

/// Stable Debian keeps a recent compiler for its browsers, under names of its own.
const PACKAGES: PackageSet = PackageSet {
    name: "compiler",
    choices: &[
        &["rustc-web", "cargo-web", "rust-web-src", "rust-web-clippy"],
        &["rustc", "cargo", "rust-src", "rust-clippy"],
    ],
    oldest: OLDEST_COMPILER,
    program: "rustc",
    purpose: "the boards' firmware is compiled with it",
    elsewhere: INSTALL_COMPILER,
};

/// Debian's compiler brings no linker for the boards along.
const LINKER_PACKAGES: PackageSet = PackageSet {
    name: "linker",
    choices: &[&["lld"]],
    oldest: (14, 0),
    program: "ld.lld",
    purpose: "the boards' firmware is linked with it",
    elsewhere: INSTALL_COMPILER,
};

/// A compiler that can build the images of the boards with one target.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compiler {
    /// Target triple.
    pub target: String,
    /// The cargo to run.
    pub cargo: PathBuf,
    /// The rustc that it is to use.
    pub rustc: PathBuf,
    /// Version line of that rustc.
    pub version: String,
    /// The core library has to be built from its sources.
    pub build_core: bool,
    /// A linker other than the one that rustc brings along.
    pub linker: Option<PathBuf>,
}

impl Compiler {
    /// `cargo build` for the target, without what the caller's environment sets for the host.
    pub fn build_command(&self) -> Command {
        let mut command = Command::new(&self.cargo);
        command.args(["build", "--release", "--target", &self.target]);
        command.envs(self.environment());
        command
    }

    /// Environment by which any cargo command in `boards/` uses this compiler, as lines for a POSIX shell.
    pub fn shell_lines(&self) -> String {
        let mut lines = String::new();
        if let Some(folder) = self.cargo.parent().filter(|folder| folder.is_absolute()) {
            lines += &format!("export PATH={}:\"$PATH\"\n", quoted(folder));
        }
        for (name, value) in self.environment() {
            lines += &format!("export {name}={}\n", quoted(&value));
        }
        lines
    }

    fn environment(&self) -> Vec<(String, PathBuf)> {
        let mut variables = vec![("RUSTC".to_owned(), self.rustc.clone())];
        if self.build_core {
            // The one switch that the stable compiler lacks; nothing else of the nightly language is used.
            variables.push(("CARGO_UNSTABLE_BUILD_STD".into(), "core".into()));
            variables.push(("RUSTC_BOOTSTRAP".into(), "1".into()));
        }
        if let Some(linker) = &self.linker {
            variables.push((linker_variable(&self.target), linker.clone()));
        }
        variables
    }
}

fn linker_variable(target: &str) -> String {
    format!("CARGO_TARGET_{}_LINKER", target.to_uppercase().replace(['-', '.'], "_"))
}

/// A compiler for a target, fetched if need be.
///
/// # Errors
/// [`Error::NoCompiler`].
pub fn compiler(host: &dyn Host, target: &str) -> Result<Compiler, Error> {
    let there = present_compiler(host, target).or_else(|| add_target(host, target));
    let none = |why| Error::NoCompiler { target: target.to_owned(), why };
    there.map_or_else(|| fetch(host, target).map_err(none), Ok)
}

/// A compiler for a target, if it is there. Fetches nothing.
pub fn present_compiler(host: &dyn Host, target: &str) -> Option<Compiler> {
    let pairs = pairs(host);
    let with_target = pairs.iter().find_map(|pair| with_target(host, pair, target));
    with_target.or_else(|| pairs.iter().find_map(|pair| with_sources(host, pair, target)))
}

/// A cargo and the rustc that belongs to it.
struct Pair {
    cargo: PathBuf,
    rustc: PathBuf,
}

impl Pair {
    /// The user's.
    fn on_path() -> Self {
        Self { cargo: "cargo".into(), rustc: "rustc".into() }
    }
}

/// In order of preference: the user's, the system's, the one in the cache folder.
fn pairs(host: &dyn Host) -> Vec<Pair> {
    let system = Pair { cargo: "/usr/bin/cargo".into(), rustc: "/usr/bin/rustc".into() };
    let program = |name| PACKAGES.program(host, name);
    let private = program("cargo").zip(program("rustc")).map(|(cargo, rustc)| Pair { cargo, rustc });
    [Pair::on_path(), system].into_iter().chain(private).collect()
}

fn with_target(host: &dyn Host, pair: &Pair, target: &str) -> Option<Compiler> {
    let found = usable(host, pair, target)?;
    host.exists(&found.rustlib.join(target).join("lib")).then_some(found.compiler)
}

fn with_sources(host: &dyn Host, pair: &Pair, target: &str) -> Option<Compiler> {
    let found = usable(host, pair, target)?;
    let sources = found.rustlib.join("src/rust/library/Cargo.lock");
    host.exists(&sources).then_some(Compiler { build_core: true, ..found.compiler })
}

/// A compiler that is new enough and has a linker, and its `lib/rustlib`.
struct Usable {
    compiler: Compiler,
    rustlib: PathBuf,
}

fn usable(host: &dyn Host, pair: &Pair, target: &str) -> Option<Usable> {
    let (cargo, rustc) = (pair.cargo.to_str()?, pair.rustc.to_str()?);
    host.output(cargo, &["--version"])?;
    let version = first_line(&host.output(rustc, &["-vV"])?);
    if version_in(&version)? < OLDEST_COMPILER {
        return None;
    }
    let rustlib = rustlib(host, rustc)?;
    let linker = match own_linker(host, rustc) {
        Some(_) => None,
        None => Some(other_linker(host)?),
    };
    let (target, cargo, rustc) = (target.to_owned(), pair.cargo.clone(), pair.rustc.clone());
    Some(Usable { compiler: Compiler { target, cargo, rustc, version, build_core: false, linker }, rustlib })
}

fn rustlib(host: &dyn Host, rustc: &str) -> Option<PathBuf> {
    let sysroot = host.output(rustc, &["--print", "sysroot"])?;
    Some(Path::new(sysroot.trim()).join("lib/rustlib"))
}

/// The linker that a rustc brings along.
fn own_linker(host: &dyn Host, rustc: &str) -> Option<PathBuf> {
    let said = host.output(rustc, &["-vV"])?;
    let triple = said.lines().find_map(|line| line.strip_prefix("host: "))?;
    let linker = rustlib(host, rustc)?.join(triple).join("bin/rust-lld");
    host.exists(&linker).then_some(linker)
}

/// A linker for a rustc that brings none along: the system's, that of the user's rustc, the one in the cache folder.
fn other_linker(host: &dyn Host) -> Option<PathBuf> {
    let system = ["/usr/bin/ld.lld", "/usr/local/bin/ld.lld"].map(PathBuf::from);
    let private = || LINKER_PACKAGES.program(host, LINKER_PACKAGES.program).filter(|path| host.exists(path));
    system.into_iter().find(|path| host.exists(path)).or_else(|| own_linker(host, "rustc")).or_else(private)
}

fn add_target(host: &dyn Host, target: &str) -> Option<Compiler> {
    host.output("rustup", &["--version"])?;
    host.announce(&format!("adding {target} with rustup: the boards' firmware is compiled for it"));
    let arguments = ["target", "add", target];
    let job =
        Job { program: "rustup", arguments: &arguments, patience: Some(RUSTUP_PATIENCE), download: None };
    match host.run(&job) {
        Ok(()) => with_target(host, &Pair::on_path(), target),
        Err(reason) => {
            host.announce(&format!("rustup cannot add it ({reason}): trying Debian's packages"));
            None
        }
    }
}

fn fetch(host: &dyn Host, target: &str) -> Result<Compiler, Unfetched> {
    PACKAGES.fetch(host)?;
    if other_linker(host).is_none() {
        LINKER_PACKAGES.fetch(host)?;
    }
    present_compiler(host, target).ok_or_else(|| PACKAGES.does_not_run())
}
