//! QEMU: the one on PATH, else Debian's in the cache folder.

use std::path::PathBuf;
use std::sync::OnceLock;

use super::error::{Error, INSTALL_EMULATOR, Unfetched};
use super::host::{Host, ThisHost};
use super::needed::{EMULATOR, OLDEST_EMULATOR};
use super::package_set::PackageSet;
use super::version::{first_line, version_in};

const PACKAGES: PackageSet = PackageSet {
    name: "emulator",
    choices: &[&[EMULATOR]],
    oldest: OLDEST_EMULATOR,
    program: EMULATOR,
    purpose: "the boards' firmware runs in it",
    elsewhere: INSTALL_EMULATOR,
};

/// A QEMU that can run the boards' images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Emulator {
    /// Program: a name on PATH, or a file in the cache folder.
    pub program: PathBuf,
    /// Its version line.
    pub version: String,
}

/// QEMU, fetched if need be.
///
/// # Errors
/// [`Error::NoEmulator`].
pub fn emulator(host: &dyn Host) -> Result<Emulator, Error> {
    present_emulator(host).map_or_else(|| fetch(host).map_err(|why| Error::NoEmulator { why }), Ok)
}

/// This machine's QEMU, fetched if need be; once found it is not looked for again, for a boot is as short as to ask it for its version.
///
/// # Errors
/// As [`emulator`].
pub fn this_emulator() -> Result<&'static Emulator, Error> {
    static FOUND: OnceLock<Emulator> = OnceLock::new();
    match FOUND.get() {
        Some(found) => Ok(found),
        None => emulator(&ThisHost).map(|found| FOUND.get_or_init(|| found)),
    }
}

/// QEMU, if it is there and new enough. Fetches nothing.
pub fn present_emulator(host: &dyn Host) -> Option<Emulator> {
    let programs = [Some(PathBuf::from(EMULATOR)), PACKAGES.program(host, EMULATOR)];
    programs.into_iter().flatten().find_map(|program| usable(host, program))
}

fn usable(host: &dyn Host, program: PathBuf) -> Option<Emulator> {
    let version = first_line(&host.output(program.to_str()?, &["--version"])?);
    (version_in(&version)? >= OLDEST_EMULATOR).then_some(Emulator { program, version })
}

fn fetch(host: &dyn Host) -> Result<Emulator, Unfetched> {
    PACKAGES.fetch(host)?;
    present_emulator(host).ok_or_else(|| PACKAGES.does_not_run())
}
