//! The folder in which fetched programs are kept.

use std::path::PathBuf;

use super::error::Unfetched;
use super::host::Host;

/// The variable that names the cache folder.
pub const VARIABLE: &str = "STRAINWAVE_CACHE";

/// Folder of this machine's unpacked packages: `CACHE/packages/debian-12-x86_64`, so that
/// machines which share a home folder do not share programs.
///
/// # Errors
/// [`Unfetched::NoCache`].
pub fn folder(host: &dyn Host) -> Result<PathBuf, Unfetched> {
    Ok(root(host)?.join("packages").join(system(host)))
}

/// `$STRAINWAVE_CACHE`, `$XDG_CACHE_HOME/strainwave` or `$HOME/.cache/strainwave`.
fn root(host: &dyn Host) -> Result<PathBuf, Unfetched> {
    let named = |name: &str, below: &str| {
        let folder = PathBuf::from(host.variable(name)?);
        // apt and the programs' own scripts are given the path as text.
        (folder.is_absolute() && folder.to_str().is_some()).then(|| folder.join(below))
    };
    named(VARIABLE, "")
        .or_else(|| named("XDG_CACHE_HOME", "strainwave"))
        .or_else(|| named("HOME", ".cache/strainwave"))
        .ok_or(Unfetched::NoCache)
}

/// The system's name, release and processor.
fn system(host: &dyn Host) -> String {
    let release = host.text("/etc/os-release").unwrap_or_default();
    let value = |key: &str| {
        let line = release.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='))?;
        let plain = |c: &char| c.is_ascii_alphanumeric() || ['.', '_'].contains(c);
        Some(line.chars().filter(plain).collect::<String>())
    };
    let parts = [value("ID"), value("VERSION_ID"), Some(std::env::consts::ARCH.to_owned())];
    parts.into_iter().flatten().collect::<Vec<_>>().join("-")
}
