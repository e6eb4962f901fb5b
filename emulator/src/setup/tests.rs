//! The set-up's decisions on machines that are played.

use super::*;
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

/// A machine: what its commands answer, what files it has, what its package lists offer. Its cache is a real folder.
struct Played {
    answers: RefCell<HashMap<String, String>>,
    files: RefCell<HashSet<PathBuf>>,
    variables: HashMap<&'static str, PathBuf>,
    cache: PathBuf,
    /// Kept for its end, when this machine made it.
    _folder: Option<TempDir>,
    /// Package -> version and the programs in it.
    offered: HashMap<&'static str, (&'static str, &'static [&'static str])>,
    /// Dependency of every package.
    needs: Option<&'static str>,
    /// Why every download fails.
    refusal: Option<&'static str>,
    /// Result when rustup adds the target.
    rustup_adds: Option<&'static str>,
    log: RefCell<Vec<String>>,
    /// Folders that apt and dpkg-deb were told to write to.
    written: RefCell<Vec<PathBuf>>,
}

impl Played {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let cache = folder.path().join("cache");
        Self { _folder: Some(folder), ..Self::with_cache(&cache) }
    }

    fn with_cache(cache: &Path) -> Self {
        Self {
            answers: RefCell::default(),
            files: RefCell::default(),
            variables: HashMap::from([("STRAINWAVE_CACHE", cache.to_owned())]),
            cache: cache.to_owned(),
            _folder: None,
            offered: HashMap::new(),
            needs: None,
            refusal: None,
            rustup_adds: None,
            log: RefCell::default(),
            written: RefCell::default(),
        }
    }

    fn answers(self, command: &str, answer: &str) -> Self {
        self.answers.borrow_mut().insert(command.into(), answer.into());
        self
    }

    fn has(self, path: &str) -> Self {
        self.files.borrow_mut().insert(path.into());
        self
    }

    fn offers(
        mut self,
        package: &'static str,
        version: &'static str,
        programs: &'static [&'static str],
    ) -> Self {
        self.offered.insert(package, (version, programs));
        self
    }

    fn rustup(self) -> Self {
        self.answers("cargo --version", "cargo 1.95.0")
            .answers("rustc -vV", "rustc 1.95.0 (59807616e 2026-04-14)\nhost: x86_64-unknown-linux-gnu\n")
            .answers("rustc --print sysroot", "/rustup\n")
            .answers("rustup --version", "rustup 1.29.0")
            .has("/rustup/lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld")
    }

    /// Debian's compiler is installed.
    fn debian_compiler(self) -> Self {
        self.answers("/usr/bin/cargo --version", "cargo 1.96.0")
            .answers("/usr/bin/rustc -vV", DEBIAN_COMPILER)
            .answers("/usr/bin/rustc --print sysroot", "/usr\n")
            .has("/usr/lib/rustlib/src/rust/library/Cargo.lock")
            .has("/usr/bin/ld.lld")
    }

    /// A Debian whose lists offer everything.
    fn debian(self) -> Self {
        let cache = self.cache.display().to_string();
        let sysroot = format!("{cache}/packages/debian-12-{}/compiler/usr", std::env::consts::ARCH);
        self.answers("apt-get --version", "apt 2.6.1")
            .answers("dpkg-deb --version", "1.21.22")
            .answers("dpkg --print-architecture", "amd64\n")
            .answers("dpkg-query --show --showformat=${Version} libc6:amd64", "2.36-9")
            .answers("private cargo --version", "cargo 1.96.0")
            .answers("private rustc --version", "rustc 1.96.0")
            .answers("private rustc -vV", DEBIAN_COMPILER)
            .answers("private rustc --print sysroot", &sysroot)
            .answers("private ld.lld --version", "Debian LLD 14.0.6")
            .answers("private qemu-system-arm --version", QEMU)
            .offers("qemu-system-arm", "1:7.2+dfsg-7+deb12u18+b3", &["bin/qemu-system-arm"])
            .offers("rustc-web", "1.96.0+dfsg1-1", &["bin/rustc"])
            .offers("cargo-web", "1.96.0+dfsg1-1", &["bin/cargo"])
            .offers("rust-web-src", "1.96.0+dfsg1-1", &["lib/rustlib/src/rust/library/Cargo.lock"])
            .offers("rust-web-clippy", "1.96.0+dfsg1-1", &["bin/cargo-clippy"])
            .offers("lld", "1:14.0-55.7", &["bin/ld.lld"])
    }

    fn refuses(mut self, reason: &'static str) -> Self {
        self.refusal = Some(reason);
        self
    }

    fn packages(&self) -> PathBuf {
        self.cache.join("packages").join(format!("debian-12-{}", std::env::consts::ARCH))
    }

    fn log(&self) -> Vec<String> {
        self.log.borrow().clone()
    }

    /// The commands that were run, without what was said and without apt's options.
    fn commands(&self) -> Vec<String> {
        self.log().iter().filter_map(|line| line.strip_prefix("run ")).map(str::to_owned).collect()
    }

    /// Arguments of apt-get without the options that place its state.
    fn apt(&self, arguments: &[&str]) -> Result<String, String> {
        let written = arguments.iter().filter_map(|word| word.strip_prefix("Dir::")?.split_once('='));
        self.written.borrow_mut().extend(written.map(|(_, folder)| PathBuf::from(folder)));
        let request = request(arguments);
        let (packages, switches): (Vec<&str>, Vec<&str>) =
            request.iter().partition(|word| !word.starts_with("--"));
        if packages[0] == "update" {
            return self.refusal.map_or(Ok(String::new()), |reason| Err(reason.into()));
        }
        let mut lines = String::new();
        for name in packages[1..].iter().chain(&self.needs) {
            let missing = || format!("exit status: 100: Unable to locate package {name}");
            let (version, _) =
                self.offered.get(name).filter(|_| self.refusal.is_none()).ok_or_else(missing)?;
            if switches.contains(&"--print-uris") {
                lines += &format!("'http://deb/{name}.deb' {name}.deb 1000000 MD5Sum:0\n");
            } else {
                lines += &format!("Inst {name} ({version} Debian:12 [amd64])\n");
            }
            if switches.contains(&"--download-only") {
                let file = format!("{name}_{}_amd64.deb", version.replace(':', "%3a"));
                fs::write(archives(arguments).join(file), name).unwrap();
            }
        }
        Ok(lines)
    }

    fn extract(&self, archive: &Path, folder: &Path) -> Result<(), String> {
        self.written.borrow_mut().push(folder.to_owned());
        let package = fs::read_to_string(archive).unwrap();
        let (_, files) = self.offered.get(package.as_str()).ok_or("unexpected end of file")?;
        for file in *files {
            let path = folder.join("usr").join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        Ok(())
    }
}

const QEMU: &str = "QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7+deb12u18+b3)";
const DEBIAN_COMPILER: &str = "rustc 1.96.0 (ac68faa20 2026-05-25)\nhost: x86_64-unknown-linux-gnu\n";
const REFUSED: &str = "exit status: 100: Failed to fetch http://deb/InRelease  Connection refused";

/// The folder that apt is given for archives.
fn archives(arguments: &[&str]) -> PathBuf {
    arguments.iter().find_map(|word| word.strip_prefix("Dir::Cache::archives=")).unwrap().into()
}

/// The words after apt's options.
fn request<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    let mut words = arguments.iter().copied();
    let mut request = Vec::new();
    while let Some(word) = words.next() {
        match word {
            "--config-file" | "--option" => _ = words.next(),
            word => request.push(word),
        }
    }
    request
}

impl Host for Played {
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String> {
        if program == "apt-get" && arguments.len() > 1 {
            return self.apt(arguments).ok();
        }
        let private = Path::new(program).starts_with(&self.cache);
        if private && !Path::new(program).exists() {
            return None;
        }
        let name = Path::new(program).file_name()?.to_str()?;
        let program = if private { format!("private {name}") } else { program.to_owned() };
        self.answers.borrow().get(&format!("{program} {}", arguments.join(" "))).cloned()
    }

    fn run(&self, job: &Job<'_>) -> Result<(), String> {
        let request = request(job.arguments);
        self.log.borrow_mut().push(format!("run {} {}", job.program, request.join(" ")));
        match job.program {
            "apt-get" => self.apt(job.arguments).map(drop),
            "dpkg-deb" => self.extract(request[1].as_ref(), request[2].as_ref()),
            "rustup" => {
                let added = self.rustup_adds.ok_or("exit status: 1: could not download file")?;
                self.files.borrow_mut().insert(added.into());
                Ok(())
            }
            program => panic!("{program} is no command of the set-up"),
        }
    }

    fn exists(&self, path: &Path) -> bool {
        if path.starts_with(&self.cache) { path.exists() } else { self.files.borrow().contains(path) }
    }

    fn text(&self, path: &str) -> Option<String> {
        (path == "/etc/os-release").then(|| "NAME=\"Debian\"\nVERSION_ID=\"12\"\nID=debian\n".to_owned())
    }

    fn variable(&self, name: &str) -> Option<OsString> {
        self.variables.get(name).map(|path| path.clone().into_os_string())
    }

    fn announce(&self, line: &str) {
        self.log.borrow_mut().push(format!("say {line}"));
    }
}

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
    let host = Played::new().rustup().debian_compiler().has(TARGET_FOLDER);
    let found = compiler(&host).unwrap();
    assert_eq!((text(&found.cargo), found.build_core, &found.linker), ("cargo", false, &None));
    assert_eq!(found.version, "rustc 1.95.0 (59807616e 2026-04-14)");
    assert!(host.log().is_empty());
}

#[test]
fn sources_in_the_sysroot_come_before_debians() {
    let host =
        Played::new().rustup().debian_compiler().has("/rustup/lib/rustlib/src/rust/library/Cargo.lock");
    let found = compiler(&host).unwrap();
    assert_eq!((text(&found.cargo), found.build_core, &found.linker), ("cargo", true, &None));
}

#[test]
fn debians_sources_come_before_rustup_is_asked() {
    let host = Played::new().rustup().debian_compiler();
    let found = compiler(&host).unwrap();
    assert_eq!((text(&found.rustc), found.build_core), ("/usr/bin/rustc", true));
    assert_eq!(found.linker, Some("/usr/bin/ld.lld".into()));
    assert!(host.log().is_empty());
}

#[test]
fn rustup_adds_the_target_after_saying_so() {
    let host = Played { rustup_adds: Some(TARGET_FOLDER), ..Played::new().rustup() };
    assert!(!compiler(&host).unwrap().build_core);
    let log = host.log();
    assert!(log[0].starts_with("say adding thumbv7em-none-eabihf with rustup: "), "{log:?}");
    assert_eq!(log[1], format!("run rustup target add {TARGET}"));
}

#[test]
fn debians_packages_are_the_last_resort_and_change_nothing_of_the_system() {
    let host = Played::new().rustup().debian();
    let found = compiler(&host).unwrap();
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
    let host = Played::new().debian();
    let found = compiler(&host).unwrap();
    assert_eq!(found.linker, Some(host.packages().join("linker/bin/ld.lld")));
}

/// As a user without rights or as root without sudo: apt and dpkg-deb alone are run, and write to the cache alone.
#[test]
fn no_rights_are_needed_but_to_write_the_cache() {
    let host = Played::new().debian();
    assert!(compiler(&host).is_ok() && emulator(&host).is_ok());
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
    let mut host = Played::new().debian();
    host.offered.retain(|package, _| ["lld", "qemu-system-arm"].contains(package));
    let host = host
        .offers("rustc", "1.92.0+dfsg1-2", &["bin/rustc"])
        .offers("cargo", "1.92.0+dfsg1-2", &["bin/cargo"])
        .offers("rust-src", "1.92.0+dfsg1-2", &["lib/rustlib/src/rust/library/Cargo.lock"])
        .offers("rust-clippy", "1.92.0+dfsg1-2", &["bin/cargo-clippy"]);
    assert!(compiler(&host).is_ok());
    let host = host.offers("rustc", "1.63.0+dfsg1-2", &["bin/rustc"]);
    fs::remove_dir_all(&host.cache).unwrap();
    assert_line(&compiler(&host).unwrap_err(), &["Rust 1.89 or newer", "rustc 1.63.0+dfsg1-2 only"]);
}

#[test]
fn an_old_compiler_does_not_count() {
    let old = "rustc 1.63.0 (4b91a6ea7 2022-08-08)\nhost: x86_64-unknown-linux-gnu\n";
    let host = Played::new().debian_compiler().answers("/usr/bin/rustc -vV", old);
    assert_line(&compiler(&host).unwrap_err(), &["no Rust 1.89 or newer", TARGET]);
}

#[test]
fn a_machine_without_apt_is_told_what_to_install() {
    let host = Played::new();
    let managers = ["dnf install", "pacman -S", "brew install", "zypper install"];
    assert_line(&compiler(&host).unwrap_err(), &managers);
    assert_line(&compiler(&host).unwrap_err(), &["rustup target add thumbv7em-none-eabihf"]);
    assert_line(&emulator(&host).unwrap_err(), &managers);
    assert_line(&emulator(&host).unwrap_err(), &["no qemu-system-arm 7.2 or newer on PATH"]);
    assert!(!host.cache.exists());
}

#[test]
fn a_present_emulator_is_used() {
    let host = Played::new().debian().answers("qemu-system-arm --version", QEMU);
    let found = emulator(&host).unwrap();
    assert_eq!((text(&found.program), found.version.as_str()), (EMULATOR, QEMU));
    assert!(host.log().is_empty() && !host.cache.exists());
}

#[test]
fn an_old_emulator_is_left_alone_and_a_private_one_fetched() {
    let host = Played::new().debian().answers("qemu-system-arm --version", "QEMU emulator version 6.2.0");
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
    let host = Played::new().debian();
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
    let host = Played::new()
        .debian()
        .answers("dpkg-query --show --showformat=${Version} qemu-utils:amd64", "1:10.0");
    assert!(emulator(&host).is_ok());
    let status = fs::read_to_string(host.packages().join("apt/status")).unwrap();
    assert!(status.contains("Provides: gcc, ") && status.contains(", libc6 (= 2.36-9)"), "{status}");
    assert_eq!(status.matches("Package: ").count(), 1, "{status}");
}

#[test]
fn a_refused_network_is_one_line() {
    let host = Played::new().rustup().debian().refuses(REFUSED);
    assert_line(
        &emulator(&host).unwrap_err(),
        &["apt-get cannot fetch qemu-system-arm", "Connection refused"],
    );
    assert_line(&compiler(&host).unwrap_err(), &["Connection refused"]);
    assert!(!host.packages().join("emulator").exists());
}

/// A folder that nobody may write, root included.
#[test]
fn a_cache_that_cannot_be_written_is_one_line() {
    let mut host = Played::new().debian();
    host.variables.insert("STRAINWAVE_CACHE", "/proc/strainwave".into());
    let words = ["cache folder /proc/strainwave/packages", "cannot be written", "STRAINWAVE_CACHE"];
    assert_line(&emulator(&host).unwrap_err(), &words);
    assert!(host.commands().is_empty());
}

#[test]
fn the_cache_is_where_the_environment_says() {
    let mut host = Played::new().debian();
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
    let host = Played::new().debian();
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
    let host = Played::new().debian().offers("qemu-system-arm", "1:7.2", &[]);
    assert_line(&emulator(&host).unwrap_err(), &["qemu-system-arm was fetched but does not run"]);
    let mut broken = Played::with_cache(&host.cache).debian();
    fs::remove_dir_all(&host.cache).unwrap();
    broken.offered.remove("rust-web-clippy");
    assert!(compiler(&broken).is_err());
    assert!(!broken.packages().join("compiler").exists());
}

#[test]
fn a_newer_c_library_than_the_machines_is_refused() {
    let mut host = Played::new().debian();
    host.needs = Some("libc6");
    let host = host.offers("libc6", "2.41-1", &[]);
    assert_line(&emulator(&host).unwrap_err(), &["newer C library"]);
    assert!(!host.commands().iter().any(|command| command.contains("--download-only")));
}

#[test]
fn two_runs_at_once_fetch_once() {
    let folder = tempfile::tempdir().unwrap();
    let run = || {
        let host = Played::with_cache(folder.path()).debian();
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
    let command = compiler(&Played::new().debian_compiler()).unwrap().build_command();
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
    let lines = compiler(&Played::new().debian_compiler()).unwrap().shell_lines();
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines[0], "export PATH='/usr/bin':\"$PATH\"");
    assert_eq!(lines[1], "export RUSTC='/usr/bin/rustc'");
    assert_eq!(lines.len(), 5);
    let users = compiler(&Played::new().rustup().has(TARGET_FOLDER)).unwrap().shell_lines();
    assert_eq!(users, "export RUSTC='rustc'\n");
}
