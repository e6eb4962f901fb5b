//! Builds the counting plugin for the QEMU that is installed.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::Error;

/// The plugin crate.
const PACKAGE: &str = "strainwave-emulator-plugin";

/// The plugin interface of a QEMU: 1 up to 8.2.3, 2 or later from then on. A QEMU that has dropped an
/// interface refuses the plugin and says so.
pub fn interface(version: (u32, u32, u32)) -> u32 {
    if version < (8, 2, 4) { 1 } else { 2 }
}

/// `QEMU emulator version 7.2.22 (Debian ...)`.
fn parse(line: &str) -> Option<(u32, u32, u32)> {
    let word = line.split_once("version ")?.1.split_whitespace().next()?;
    let mut parts = word.split('.').map(|part| part.parse::<u32>());
    Some((parts.next()?.ok()?, parts.next()?.ok()?, parts.next().and_then(Result::ok).unwrap_or(0)))
}

/// Builds the plugin for the emulator that calls itself `version`, and gives the library's path.
pub fn build(version: &str) -> Result<PathBuf, Error> {
    let number = parse(version).ok_or_else(|| Error::Version { said: version.to_owned() })?;
    let interface = interface(number);
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    // Not the caller's target directory, which the caller's own build may hold locked.
    let target = workspace.join("target").join(format!("plugin-{interface}"));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["build", "--quiet", "--release", "--package", PACKAGE, "--target-dir"])
        .arg(&target)
        .current_dir(workspace)
        .env("STRAINWAVE_QEMU_PLUGIN_API", interface.to_string())
        // Flags meant for the caller's build are not the plugin's.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_BUILD_TARGET")
        .output()
        .map_err(|error| Error::PluginBuild { line: format!("cargo: {error}") })?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let line = text.lines().find(|l| l.starts_with("error")).unwrap_or("no message").to_owned();
        return Err(Error::PluginBuild { line });
    }
    let name = format!(
        "{}{}{}",
        std::env::consts::DLL_PREFIX,
        PACKAGE.replace('-', "_"),
        std::env::consts::DLL_SUFFIX
    );
    Ok(target.join("release").join(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interface_follows_from_the_version() {
        let of = |line| interface(parse(line).unwrap());
        assert_eq!(of("QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7+deb12u18)"), 1);
        assert_eq!(of("QEMU emulator version 8.2.2 (Debian 1:8.2.2+ds-0ubuntu1)"), 1);
        assert_eq!(of("QEMU emulator version 9.0.0"), 2);
        assert_eq!(of("QEMU emulator version 10.1 (v10.1)"), 2);
        assert_eq!(parse("something else"), None);
    }
}
