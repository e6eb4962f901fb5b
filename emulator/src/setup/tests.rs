//! The set-up's decisions on machines that are played.

use super::*;
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};

/// A machine: what its commands answer, what files it has, what happens when something is installed.
#[derive(Default)]
struct Played {
    answers: RefCell<HashMap<String, String>>,
    files: RefCell<HashSet<PathBuf>>,
    /// Command -> answers and files that appear once it has run.
    effects: HashMap<String, Vec<Effect>>,
    log: RefCell<Vec<String>>,
}

#[derive(Clone)]
enum Effect {
    Answer(&'static str, &'static str),
    File(&'static str),
}

impl Played {
    fn answers(self, command: &str, answer: &str) -> Self {
        self.answers.borrow_mut().insert(command.into(), answer.into());
        self
    }

    fn has(self, path: &str) -> Self {
        self.files.borrow_mut().insert(path.into());
        self
    }

    fn installs(mut self, command: &str, effects: &[Effect]) -> Self {
        self.effects.insert(command.into(), effects.to_vec());
        self
    }

    fn rustup(self) -> Self {
        self.answers("cargo --version", "cargo 1.95.0")
            .answers("rustc -vV", "rustc 1.95.0 (59807616e 2026-04-14)\nhost: x86_64-unknown-linux-gnu\n")
            .answers("rustc --print sysroot", "/rustup\n")
            .answers("rustup --version", "rustup 1.29.0")
            .has("/rustup/lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld")
    }

    fn debian(self) -> Self {
        let mut played = self;
        for effect in DEBIAN {
            played.apply(&effect);
        }
        played
    }

    fn root(self) -> Self {
        self.answers("id -u", "0\n").answers("apt-get --version", "apt 2.6.1")
    }

    fn apply(&mut self, effect: &Effect) {
        apply(&self.answers, &self.files, effect);
    }

    fn log(&self) -> Vec<String> {
        self.log.borrow().clone()
    }
}

fn apply(answers: &RefCell<HashMap<String, String>>, files: &RefCell<HashSet<PathBuf>>, effect: &Effect) {
    match effect {
        Effect::Answer(command, answer) => {
            answers.borrow_mut().insert((*command).into(), (*answer).into());
        }
        Effect::File(path) => {
            files.borrow_mut().insert((*path).into());
        }
    }
}

const DEBIAN: [Effect; 5] = [
    Effect::Answer("/usr/bin/cargo --version", "cargo 1.96.0"),
    Effect::Answer(
        "/usr/bin/rustc -vV",
        "rustc 1.96.0 (ac68faa20 2026-05-25)\nhost: x86_64-unknown-linux-gnu\n",
    ),
    Effect::Answer("/usr/bin/rustc --print sysroot", "/usr\n"),
    Effect::File("/usr/lib/rustlib/src/rust/library/Cargo.lock"),
    Effect::File("/usr/bin/ld.lld"),
];

impl Host for Played {
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String> {
        self.answers.borrow().get(&[&[program], arguments].concat().join(" ")).cloned()
    }

    fn succeeds(&self, program: &str, arguments: &[&str], _: Option<Duration>) -> bool {
        let command = [&[program], arguments].concat().join(" ");
        self.log.borrow_mut().push(format!("run {command}"));
        let Some(effects) = self.effects.get(&command) else { return false };
        for effect in effects {
            apply(&self.answers, &self.files, effect);
        }
        true
    }

    fn exists(&self, path: &Path) -> bool {
        self.files.borrow().contains(path)
    }

    fn announce(&self, line: &str) {
        self.log.borrow_mut().push(format!("say {line}"));
    }
}

const TARGET_FOLDER: &str = "/rustup/lib/rustlib/thumbv7em-none-eabihf/lib";
const APT_COMPILER: &str =
    "apt-get install --yes --no-install-recommends --no-remove rustc-web cargo-web rust-web-src lld";
const APT_EMULATOR: &str = "apt-get install --yes --no-install-recommends --no-remove qemu-system-arm";

#[test]
fn a_target_in_the_sysroot_needs_plain_cargo() {
    let host = Played::default().rustup().debian().has(TARGET_FOLDER);
    let found = compiler(&host).unwrap();
    assert_eq!((found.cargo, found.build_core, &found.linker), ("cargo", false, &None));
    assert_eq!(found.version, "rustc 1.95.0 (59807616e 2026-04-14)");
    assert!(host.log().is_empty());
}

#[test]
fn sources_in_the_sysroot_come_before_debians() {
    let host = Played::default().rustup().debian().has("/rustup/lib/rustlib/src/rust/library/Cargo.lock");
    let found = compiler(&host).unwrap();
    assert_eq!((found.cargo, found.build_core, &found.linker), ("cargo", true, &None));
}

#[test]
fn debians_sources_come_before_rustup_is_asked() {
    let host = Played::default().rustup().debian();
    let found = compiler(&host).unwrap();
    assert_eq!((found.rustc, found.build_core), ("/usr/bin/rustc", true));
    assert_eq!(found.linker, Some("/usr/bin/ld.lld".into()));
    assert!(host.log().is_empty());
}

#[test]
fn rustup_adds_the_target_after_saying_so() {
    let add = format!("rustup target add {TARGET}");
    let host = Played::default().rustup().installs(&add, &[Effect::File(TARGET_FOLDER)]);
    assert!(!compiler(&host).unwrap().build_core);
    let log = host.log();
    assert!(log[0].starts_with("say installing thumbv7em-none-eabihf with rustup: "), "{log:?}");
    assert_eq!(log[1], format!("run {add}"));
}

#[test]
fn debians_packages_are_the_last_resort() {
    let host = Played::default().rustup().root().installs(APT_COMPILER, &DEBIAN);
    let found = compiler(&host).unwrap();
    assert_eq!(found.rustc, "/usr/bin/rustc");
    let log = host.log();
    let order =
        ["run rustup target add", "say installing rustc-web", "run apt-get update", "run apt-get install"];
    let mut last = 0;
    for start in order {
        let at =
            log.iter().position(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{start}: {log:?}"));
        assert!(at >= last, "{log:?}");
        last = at;
    }
}

#[test]
fn an_old_compiler_does_not_count() {
    let host = Played::default().debian().answers(
        "/usr/bin/rustc -vV",
        "rustc 1.63.0 (4b91a6ea7 2022-08-08)\nhost: x86_64-unknown-linux-gnu\n",
    );
    assert_eq!(compiler(&host), Err(Error::NoCompiler));
}

#[test]
fn a_machine_without_anything_gets_one_clear_line() {
    let host = Played::default();
    let compiler = compiler(&host).unwrap_err().to_string();
    let emulator = emulator(&host).unwrap_err().to_string();
    assert!(compiler.contains("Rust 1.89 or newer") && compiler.contains(TARGET), "{compiler}");
    assert!(emulator.starts_with("emulator missing with no way to install it"), "{emulator}");
    assert!(!compiler.contains('\n') && !emulator.contains('\n'));
}

#[test]
fn a_present_emulator_is_used_and_an_old_one_replaced() {
    let new = "QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7+deb12u18+b3)";
    let host = Played::default().answers("qemu-system-arm --version", new);
    assert_eq!(emulator(&host).as_deref(), Ok(new));
    assert!(host.log().is_empty());

    let host = Played::default()
        .root()
        .answers("qemu-system-arm --version", "QEMU emulator version 6.2.0")
        .installs(
            APT_EMULATOR,
            &[Effect::Answer("qemu-system-arm --version", "QEMU emulator version 8.1.0")],
        );
    assert_eq!(emulator(&host).as_deref(), Ok("QEMU emulator version 8.1.0"));
    assert!(host.log()[0].starts_with("say installing qemu-system-arm with apt-get: "));
}

#[test]
fn sudo_serves_a_user_who_is_not_root() {
    let install = format!("sudo --non-interactive {APT_EMULATOR}");
    let host = Played::default()
        .answers("id -u", "1000\n")
        .answers("apt-get --version", "apt 2.6.1")
        .answers("sudo --non-interactive true", "")
        .installs(&install, &[Effect::Answer("qemu-system-arm --version", "QEMU emulator version 7.2.0")]);
    assert!(emulator(&host).is_ok());
}

#[test]
fn a_user_without_rights_is_not_asked_for_a_password() {
    let host = Played::default().answers("id -u", "1000\n").answers("apt-get --version", "apt 2.6.1");
    assert_eq!(emulator(&host), Err(Error::NoEmulator));
    assert!(host.log().is_empty());
}

#[test]
fn the_build_command_carries_what_the_compiler_needs() {
    let command = compiler(&Played::default().debian()).unwrap().build_command();
    let arguments: Vec<_> = command.get_args().map(|a| a.to_string_lossy().into_owned()).collect();
    assert_eq!(arguments, ["build", "--release", "--target", TARGET, "-Z", "build-std=core"]);
    let set: HashMap<_, _> = command.get_envs().collect();
    let of = |name: &str| set.get(std::ffi::OsStr::new(name)).copied().flatten().and_then(|v| v.to_str());
    assert_eq!(of("RUSTC_BOOTSTRAP"), Some("1"));
    assert_eq!(of("RUSTC"), Some("/usr/bin/rustc"));
    assert_eq!(of("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER"), Some("/usr/bin/ld.lld"));
}
