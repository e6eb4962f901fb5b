//! Makes a bare machine ready: a compiler for the boards' target, and QEMU.
//!
//! What is there is used; what is missing is installed, and announced before it is. The order, for
//! the compiler: the target in the compiler's sysroot, then plain cargo; the library's sources in
//! the sysroot, or Debian's, then `-Z build-std`; `rustup target add`; Debian's packages. The
//! decisions ask a [`Host`], so that the tests can play any machine.

mod host;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

pub use host::{Host, ThisHost};

/// What the boards are compiled for.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Oldest compiler that knows the language of this code: `rust-version` of the workspace.
pub const OLDEST_COMPILER: (u32, u32) = (1, 89);

/// Oldest QEMU that the lockstep was tried with.
pub const OLDEST_EMULATOR: (u32, u32) = (7, 2);

/// The emulator's program.
pub const EMULATOR: &str = "qemu-system-arm";

/// How long rustup may take: 13 MB at a little over 1 Mbit/s. A server that accepts and then says nothing
/// would hold it for ever.
const RUSTUP_PATIENCE: Duration = Duration::from_secs(90);

const COMPILER_PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "lld"];

/// What could not be made ready.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// Neither present nor installable.
    #[error(
        "no Rust {}.{} or newer for {TARGET} and no way to install it: run `rustup target add {TARGET}`",
        OLDEST_COMPILER.0,
        OLDEST_COMPILER.1
    )]
    NoCompiler,
    /// Neither present nor installable.
    #[error(
        "emulator missing with no way to install it: {EMULATOR} {}.{} or newer is needed on PATH",
        OLDEST_EMULATOR.0,
        OLDEST_EMULATOR.1
    )]
    NoEmulator,
}

/// A compiler that can build the boards' images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compiler {
    /// The cargo to run.
    pub cargo: &'static str,
    /// The rustc that it is to use.
    pub rustc: &'static str,
    /// What that rustc says of its version, one line.
    pub version: String,
    /// The core library has to be built from its sources.
    pub build_core: bool,
    /// A linker other than the one that rustc brings along.
    pub linker: Option<PathBuf>,
}

impl Compiler {
    /// `cargo build` for the boards' target, without what the caller's environment sets for the host.
    pub fn build_command(&self) -> Command {
        let mut command = Command::new(self.cargo);
        command.args(["build", "--release", "--target", TARGET]).env("RUSTC", self.rustc);
        if self.build_core {
            // The one switch that the stable compiler lacks; nothing else of the nightly language is used.
            command.args(["-Z", "build-std=core"]).env("RUSTC_BOOTSTRAP", "1");
        }
        if let Some(linker) = &self.linker {
            command.env(linker_variable(), linker);
        }
        command
    }
}

fn linker_variable() -> String {
    format!("CARGO_TARGET_{}_LINKER", TARGET.to_uppercase().replace('-', "_"))
}

/// A compiler for the boards, installed if need be.
///
/// # Errors
/// [`Error::NoCompiler`].
pub fn compiler(host: &dyn Host) -> Result<Compiler, Error> {
    present_compiler(host)
        .or_else(|| add_target(host))
        .or_else(|| install_compiler(host))
        .ok_or(Error::NoCompiler)
}

/// QEMU's version, installed if need be.
///
/// # Errors
/// [`Error::NoEmulator`].
pub fn emulator(host: &dyn Host) -> Result<String, Error> {
    present_emulator(host).or_else(|| install_emulator(host)).ok_or(Error::NoEmulator)
}

/// QEMU's version, if it is there and new enough. Installs nothing.
pub fn present_emulator(host: &dyn Host) -> Option<String> {
    let said = host.output(EMULATOR, &["--version"])?;
    let version = first_line(&said);
    (version_in(&version)? >= OLDEST_EMULATOR).then_some(version)
}

/// Pairs of cargo and rustc, in order of preference: the user's, then Debian's.
const PAIRS: [(&str, &str); 2] = [("cargo", "rustc"), ("/usr/bin/cargo", "/usr/bin/rustc")];

/// A compiler for the boards, if it is there. Installs nothing.
pub fn present_compiler(host: &dyn Host) -> Option<Compiler> {
    let with_target = PAIRS.iter().find_map(|pair| with_target(host, *pair));
    with_target.or_else(|| PAIRS.iter().find_map(|pair| with_sources(host, *pair)))
}

fn with_target(host: &dyn Host, pair: (&'static str, &'static str)) -> Option<Compiler> {
    let found = usable(host, pair)?;
    host.exists(&found.rustlib.join(TARGET).join("lib")).then_some(found.compiler)
}

fn with_sources(host: &dyn Host, pair: (&'static str, &'static str)) -> Option<Compiler> {
    let found = usable(host, pair)?;
    let sources = found.rustlib.join("src/rust/library/Cargo.lock");
    host.exists(&sources).then_some(Compiler { build_core: true, ..found.compiler })
}

/// A compiler that is new enough and has a linker, and its `lib/rustlib`.
struct Usable {
    compiler: Compiler,
    rustlib: PathBuf,
}

fn usable(host: &dyn Host, (cargo, rustc): (&'static str, &'static str)) -> Option<Usable> {
    host.output(cargo, &["--version"])?;
    let said = host.output(rustc, &["-vV"])?;
    let version = first_line(&said);
    if version_in(&version)? < OLDEST_COMPILER {
        return None;
    }
    let triple = said.lines().find_map(|line| line.strip_prefix("host: "))?;
    let sysroot = host.output(rustc, &["--print", "sysroot"])?;
    let rustlib = Path::new(sysroot.trim()).join("lib/rustlib");
    let linker = if host.exists(&rustlib.join(triple).join("bin/rust-lld")) {
        None
    } else {
        Some(
            ["/usr/bin/ld.lld", "/usr/local/bin/ld.lld"]
                .map(PathBuf::from)
                .into_iter()
                .find(|path| host.exists(path))?,
        )
    };
    let compiler = Compiler { cargo, rustc, version, build_core: false, linker };
    Some(Usable { compiler, rustlib })
}

fn add_target(host: &dyn Host) -> Option<Compiler> {
    host.output("rustup", &["--version"])?;
    host.announce(&format!("installing {TARGET} with rustup: the boards' firmware is compiled for it"));
    host.succeeds("rustup", &["target", "add", TARGET], Some(RUSTUP_PATIENCE))
        .then(|| with_target(host, PAIRS[0]))
        .flatten()
}

fn install_compiler(host: &dyn Host) -> Option<Compiler> {
    install(host, &COMPILER_PACKAGES, &format!("the boards' firmware is compiled for {TARGET}"))
        .then(|| present_compiler(host))
        .flatten()
}

fn install_emulator(host: &dyn Host) -> Option<String> {
    install(host, &[EMULATOR], "the boards' firmware runs in it").then(|| present_emulator(host)).flatten()
}

/// Installs Debian packages, as root or through sudo; false when that is not possible.
fn install(host: &dyn Host, packages: &[&str], why: &str) -> bool {
    let Some(prefix) = privilege(host) else { return false };
    if host.output("apt-get", &["--version"]).is_none() {
        return false;
    }
    host.announce(&format!("installing {} with apt-get: {why}", packages.join(" ")));
    // Nothing that the user has installed makes way for ours.
    let install = [&["install", "--yes", "--no-install-recommends", "--no-remove"], packages].concat();
    // Outdated lists are no reason not to try.
    privileged(host, prefix, &["update"]);
    privileged(host, prefix, &install)
}

fn privileged(host: &dyn Host, prefix: &[&str], arguments: &[&str]) -> bool {
    let command = [prefix, &["apt-get"], arguments].concat();
    // No limit: apt has its own for each server, and must not be stopped half-way through a package.
    host.succeeds(command[0], &command[1..], None)
}

/// What to put before a command that only root may run; `None` when we may not.
fn privilege(host: &dyn Host) -> Option<&'static [&'static str]> {
    if host.output("id", &["-u"])?.trim() == "0" {
        return Some(&[]);
    }
    // Not a password prompt amid a run.
    host.output("sudo", &["--non-interactive", "true"]).map(|_| ["sudo", "--non-interactive"].as_slice())
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().trim().to_owned()
}

/// The first `major.minor` in a text.
fn version_in(text: &str) -> Option<(u32, u32)> {
    text.split([' ', '-', '(']).find_map(|word| {
        let mut numbers = word.split('.');
        Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
    })
}

#[cfg(test)]
mod tests;
