//! The set-up's decisions on simulated hosts.

mod simulated_host;

use super::*;
use simulated_host::{QEMU, REFUSED, SimulatedHost};
use std::collections::HashMap;
use std::fs;
use std::path::Path;

const TARGET: &str = "thumbv7em-none-eabihf";
const TARGET_FOLDER: &str = "/rustup/lib/rustlib/thumbv7em-none-eabihf/lib";

/// An error is one line that contains every one of `words`.
fn assert_line(error: &Error, words: &[&str]) {
    let line = error.to_string();
    assert!(!line.contains('\n'), "{line}");
    for word in words {
        assert!(line.contains(word), "{word:?} is missing: {line}");
    }
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn a_target_in_the_sysroot_needs_plain_cargo() {
    let host = SimulatedHost::new().rustup().debian_compiler().has(TARGET_FOLDER);
    let found = compiler(&host, TARGET).unwrap();
    assert_eq!((text(&found.cargo), found.build_core, &found.linker), ("cargo", false, &None));
    assert_eq!(found.version, "rustc 1.95.0 (59807616e 2026-04-14)");
    assert!(host.log().is_empty());
}

#[test]
fn sources_in_the_sysroot_come_before_debians() {
    let host = SimulatedHost::new()
        .rustup()
        .debian_compiler()
        .has("/rustup/lib/rustlib/src/rust/library/Cargo.lock");
    let found = compiler(&host, TARGET).unwrap();
    assert_eq!((text(&found.cargo), found.build_core, &found.linker), ("cargo", true, &None));
}

#[test]
fn debians_sources_come_before_rustup_is_asked() {
    let host = SimulatedHost::new().rustup().debian_compiler();
    let found = compiler(&host, TARGET).unwrap();
    assert_eq!((text(&found.rustc), found.build_core), ("/usr/bin/rustc", true));
    assert_eq!(found.linker, Some("/usr/bin/ld.lld".into()));
    assert!(host.log().is_empty());
}

#[test]
fn rustup_adds_the_target_after_saying_so() {
    let host = SimulatedHost::new().rustup().rustup_adds(TARGET_FOLDER);
    assert!(!compiler(&host, TARGET).unwrap().build_core);
    let log = host.log();
    assert!(log[0].starts_with("say adding thumbv7em-none-eabihf with rustup: "), "{log:?}");
    assert_eq!(log[1], format!("run rustup target add {TARGET}"));
}

#[test]
fn debians_packages_are_the_last_resort_and_change_nothing_of_the_system() {
    let host = SimulatedHost::new().rustup().debian();
    let found = compiler(&host, TARGET).unwrap();
    assert_eq!(found.rustc, host.packages().join("compiler/bin/rustc"));
    assert!(found.build_core);
    // The linker of the user's own compiler serves.
    assert_eq!(found.linker, Some("/rustup/lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld".into()));
    let packages = "rustc-web cargo-web rust-web-src rust-web-clippy";
    let commands = host.commands();
    let expected = [
        "rustup target add thumbv7em-none-eabihf".to_owned(),
        "apt-get update".to_owned(),
        format!("apt-get install --simulate {packages}"),
        format!("apt-get install --download-only {packages}"),
    ];
    assert_eq!(commands[..4], expected);
    assert!(commands[4..].iter().all(|command| command.starts_with("dpkg-deb --extract ")), "{commands:?}");
}

#[test]
fn a_bare_machine_gets_a_linker_too() {
    let host = SimulatedHost::new().debian();
    let found = compiler(&host, TARGET).unwrap();
    assert_eq!(found.linker, Some(host.packages().join("linker/bin/ld.lld")));
}

/// As a user without rights or as root without sudo: apt and dpkg-deb alone are run, and write to the cache alone.
#[test]
fn no_rights_are_needed_but_to_write_the_cache() {
    let host = SimulatedHost::new().debian();
    assert!(compiler(&host, TARGET).is_ok() && emulator(&host).is_ok());
    let programs = ["apt-get ", "dpkg-deb "];
    let commands = host.commands();
    assert!(commands.iter().all(|command| programs.iter().any(|program| command.starts_with(program))));
    let written = host.written.borrow();
    assert!(
        !written.is_empty() && written.iter().all(|folder| folder.starts_with(&host.cache)),
        "{written:?}"
    );
}

#[test]
fn a_system_with_a_recent_compiler_of_its_own_serves() {
    let mut host = SimulatedHost::new().debian();
    host.offered.retain(|package, _| ["lld", "qemu-system-arm"].contains(package));
    let host = host
        .offers("rustc", "1.92.0+dfsg1-2", &["bin/rustc"])
        .offers("cargo", "1.92.0+dfsg1-2", &["bin/cargo"])
        .offers("rust-src", "1.92.0+dfsg1-2", &["lib/rustlib/src/rust/library/Cargo.lock"])
        .offers("rust-clippy", "1.92.0+dfsg1-2", &["bin/cargo-clippy"]);
    assert!(compiler(&host, TARGET).is_ok());
    let host = host.offers("rustc", "1.63.0+dfsg1-2", &["bin/rustc"]);
    fs::remove_dir_all(&host.cache).unwrap();
    assert_line(&compiler(&host, TARGET).unwrap_err(), &["Rust 1.89 or newer", "rustc 1.63.0+dfsg1-2 only"]);
}

#[test]
fn an_old_compiler_does_not_count() {
    let old = "rustc 1.63.0 (4b91a6ea7 2022-08-08)\nhost: x86_64-unknown-linux-gnu\n";
    let host = SimulatedHost::new().debian_compiler().answers("/usr/bin/rustc -vV", old);
    assert_line(&compiler(&host, TARGET).unwrap_err(), &["no Rust 1.89 or newer", TARGET]);
}

#[test]
fn a_machine_without_apt_is_told_what_to_install() {
    let host = SimulatedHost::new();
    let managers = ["dnf install", "pacman -S", "brew install", "zypper install"];
    assert_line(&compiler(&host, TARGET).unwrap_err(), &managers);
    assert_line(&compiler(&host, TARGET).unwrap_err(), &["rustup target add", TARGET]);
    assert_line(&emulator(&host).unwrap_err(), &managers);
    assert_line(&emulator(&host).unwrap_err(), &["no qemu-system-arm 7.2 or newer on PATH"]);
    assert!(!host.cache.exists());
}

#[test]
fn a_present_emulator_is_used() {
    let host = SimulatedHost::new().debian().answers("qemu-system-arm --version", QEMU);
    let found = emulator(&host).unwrap();
    assert_eq!((text(&found.program), found.version.as_str()), (EMULATOR, QEMU));
    assert!(host.log().is_empty() && !host.cache.exists());
}

#[test]
fn an_old_emulator_is_left_alone_and_a_private_one_fetched() {
    let host =
        SimulatedHost::new().debian().answers("qemu-system-arm --version", "QEMU emulator version 6.2.0");
    let found = emulator(&host).unwrap();
    assert_eq!(found.program, host.packages().join("emulator/bin/qemu-system-arm"));
    let log = host.log();
    let announced = log.iter().position(|line| line.starts_with("say fetching qemu-system-arm 1:7.2+dfsg-7"));
    let fetched = log.iter().position(|line| line.starts_with("run apt-get install --download-only"));
    assert!(announced.unwrap() < fetched.unwrap(), "{log:?}");
    let announcement = &log[announced.unwrap()];
    assert!(announcement.contains("1 MB") && announcement.contains(text(&host.packages())), "{announcement}");
}

#[test]
fn a_second_run_finds_it() {
    let host = SimulatedHost::new().debian();
    let first = emulator(&host).unwrap();
    let commands = host.log().len();
    assert_eq!(emulator(&host), Ok(first));
    assert_eq!(host.log().len(), commands);
    let left = fs::read_dir(host.packages().join("apt/archives")).unwrap();
    assert!(left.flatten().all(|entry| entry.path().is_dir()), "the archives have gone");
}

/// Whatever is installed, in whatever version, apt resolves as on a machine that has a C library and a compiler only.
#[test]
fn nothing_that_is_installed_is_in_conflict() {
    let host = SimulatedHost::new()
        .debian()
        .answers("dpkg-query --show --showformat=${Version} qemu-utils:amd64", "1:10.0");
    assert!(emulator(&host).is_ok());
    let status = fs::read_to_string(host.packages().join("apt/status")).unwrap();
    assert!(status.contains("Provides: gcc, ") && status.contains(", libc6 (= 2.36-9)"), "{status}");
    assert_eq!(status.matches("Package: ").count(), 1, "{status}");
}

#[test]
fn a_refused_network_is_one_line() {
    let host = SimulatedHost::new().rustup().debian().refuses(REFUSED);
    assert_line(
        &emulator(&host).unwrap_err(),
        &["apt-get cannot fetch qemu-system-arm", "Connection refused"],
    );
    assert_line(&compiler(&host, TARGET).unwrap_err(), &["Connection refused"]);
    assert!(!host.packages().join("emulator").exists());
}

/// A folder that nobody may write, root included.
#[test]
fn a_cache_that_cannot_be_written_is_one_line() {
    let mut host = SimulatedHost::new().debian();
    host.variables.insert("STRAINWAVE_CACHE", "/proc/strainwave".into());
    let words = ["cache folder /proc/strainwave/packages", "cannot be written", "STRAINWAVE_CACHE"];
    assert_line(&emulator(&host).unwrap_err(), &words);
    assert!(host.commands().is_empty());
}

#[test]
fn the_cache_is_where_the_environment_says() {
    let mut host = SimulatedHost::new().debian();
    let folder = host.variables.remove("STRAINWAVE_CACHE").unwrap();
    host.variables.insert("HOME", folder.join("home"));
    assert!(text(&emulator(&host).unwrap().program).contains("/home/.cache/strainwave/packages/debian-12-"));
    host.variables.insert("XDG_CACHE_HOME", folder.join("xdg"));
    assert!(text(&emulator(&host).unwrap().program).contains("/xdg/strainwave/packages/"));
    host.variables = HashMap::from([("HOME", "relative".into())]);
    assert_line(&emulator(&host).unwrap_err(), &["STRAINWAVE_CACHE", "HOME"]);
}

#[test]
fn what_an_interrupted_run_has_left_is_not_used() {
    let host = SimulatedHost::new().debian();
    let archives = host.packages().join("apt/archives");
    fs::create_dir_all(archives.join("partial")).unwrap();
    fs::write(archives.join("qemu-system-arm_1%3a7.1_amd64.deb"), "half").unwrap();
    fs::create_dir_all(host.packages().join("emulator.new/usr/bin")).unwrap();
    fs::write(host.packages().join("emulator.new/usr/bin/half"), "").unwrap();
    assert!(emulator(&host).is_ok());
    assert!(!host.packages().join("emulator/usr/bin/half").exists());
    assert!(!host.packages().join("emulator.new").exists());
}

#[test]
fn an_archive_that_does_not_unpack_leaves_no_folder() {
    let host = SimulatedHost::new().debian().offers("qemu-system-arm", "1:7.2", &[]);
    assert_line(&emulator(&host).unwrap_err(), &["qemu-system-arm was fetched but does not run"]);
    let mut broken = SimulatedHost::with_cache(&host.cache).debian();
    fs::remove_dir_all(&host.cache).unwrap();
    broken.offered.remove("rust-web-clippy");
    assert!(compiler(&broken, TARGET).is_err());
    assert!(!broken.packages().join("compiler").exists());
}

#[test]
fn a_newer_c_library_than_the_machines_is_refused() {
    let mut host = SimulatedHost::new().debian();
    host.needs = Some("libc6");
    let host = host.offers("libc6", "2.41-1", &[]);
    assert_line(&emulator(&host).unwrap_err(), &["newer C library"]);
    assert!(!host.commands().iter().any(|command| command.contains("--download-only")));
}

#[test]
fn two_runs_at_once_fetch_once() {
    let folder = tempfile::tempdir().unwrap();
    let run = || {
        let host = SimulatedHost::with_cache(folder.path()).debian();
        assert!(emulator(&host).is_ok());
        host.commands().iter().filter(|command| command.contains("--download-only")).count()
    };
    let fetched: usize = std::thread::scope(|scope| {
        let runs: Vec<_> = (0..4).map(|_| scope.spawn(run)).collect();
        runs.into_iter().map(|run| run.join().unwrap()).sum()
    });
    assert_eq!(fetched, 1);
}

#[test]
fn the_build_command_carries_what_the_compiler_needs() {
    let command = compiler(&SimulatedHost::new().debian_compiler(), TARGET).unwrap().build_command();
    let arguments: Vec<_> = command.get_args().map(|a| a.to_string_lossy().into_owned()).collect();
    assert_eq!(arguments, ["build", "--release", "--target", TARGET]);
    let set: HashMap<_, _> = command.get_envs().collect();
    let of = |name: &str| set.get(std::ffi::OsStr::new(name)).copied().flatten().and_then(|v| v.to_str());
    assert_eq!(of("CARGO_UNSTABLE_BUILD_STD"), Some("core"));
    assert_eq!(of("RUSTC_BOOTSTRAP"), Some("1"));
    assert_eq!(of("RUSTC"), Some("/usr/bin/rustc"));
    assert_eq!(of("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER"), Some("/usr/bin/ld.lld"));
}

#[test]
fn a_shell_gets_the_same_compiler() {
    let lines = compiler(&SimulatedHost::new().debian_compiler(), TARGET).unwrap().shell_lines();
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines[0], "export PATH='/usr/bin':\"$PATH\"");
    assert_eq!(lines[1], "export RUSTC='/usr/bin/rustc'");
    assert_eq!(lines.len(), 5);
    let users = compiler(&SimulatedHost::new().rustup().has(TARGET_FOLDER), TARGET).unwrap().shell_lines();
    assert_eq!(users, "export RUSTC='rustc'\n");
}
