//! A simulated host: what its commands answer, what files it has, what its package lists offer.

use super::super::*;
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

/// A machine: what its commands answer, what files it has, what its package lists offer. Its cache is a real folder.
pub(super) struct SimulatedHost {
    answers: RefCell<HashMap<String, String>>,
    files: RefCell<HashSet<PathBuf>>,
    pub variables: HashMap<&'static str, PathBuf>,
    pub cache: PathBuf,
    /// Kept for its end, when this machine made it.
    _folder: Option<TempDir>,
    /// Package -> version and the programs in it.
    pub offered: HashMap<&'static str, (&'static str, &'static [&'static str])>,
    /// Dependency of every package.
    pub needs: Option<&'static str>,
    /// Why every download fails.
    refusal: Option<&'static str>,
    /// Result when rustup adds the target.
    rustup_adds: Option<&'static str>,
    log: RefCell<Vec<String>>,
    /// Folders that apt and dpkg-deb were told to write to.
    pub written: RefCell<Vec<PathBuf>>,
}

impl SimulatedHost {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let cache = folder.path().join("cache");
        Self { _folder: Some(folder), ..Self::with_cache(&cache) }
    }

    pub fn with_cache(cache: &Path) -> Self {
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

    pub fn answers(self, command: &str, answer: &str) -> Self {
        self.answers.borrow_mut().insert(command.into(), answer.into());
        self
    }

    pub fn has(self, path: &str) -> Self {
        self.files.borrow_mut().insert(path.into());
        self
    }

    pub fn offers(
        mut self,
        package: &'static str,
        version: &'static str,
        programs: &'static [&'static str],
    ) -> Self {
        self.offered.insert(package, (version, programs));
        self
    }

    pub fn rustup(self) -> Self {
        self.answers("cargo --version", "cargo 1.95.0")
            .answers("rustc -vV", "rustc 1.95.0 (59807616e 2026-04-14)\nhost: x86_64-unknown-linux-gnu\n")
            .answers("rustc --print sysroot", "/rustup\n")
            .answers("rustup --version", "rustup 1.29.0")
            .has("/rustup/lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld")
    }

    /// Rustup can add the target whose folder this is.
    pub fn rustup_adds(self, folder: &'static str) -> Self {
        Self { rustup_adds: Some(folder), ..self }
    }

    /// Debian's compiler is installed.
    pub fn debian_compiler(self) -> Self {
        self.answers("/usr/bin/cargo --version", "cargo 1.96.0")
            .answers("/usr/bin/rustc -vV", DEBIAN_COMPILER)
            .answers("/usr/bin/rustc --print sysroot", "/usr\n")
            .has("/usr/lib/rustlib/src/rust/library/Cargo.lock")
            .has("/usr/bin/ld.lld")
    }

    /// A Debian whose lists offer everything.
    pub fn debian(self) -> Self {
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

    pub fn refuses(mut self, reason: &'static str) -> Self {
        self.refusal = Some(reason);
        self
    }

    pub fn packages(&self) -> PathBuf {
        self.cache.join("packages").join(format!("debian-12-{}", std::env::consts::ARCH))
    }

    pub fn log(&self) -> Vec<String> {
        self.log.borrow().clone()
    }

    /// The commands that were run, without what was said and without apt's options.
    pub fn commands(&self) -> Vec<String> {
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

pub(super) const QEMU: &str = "QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7+deb12u18+b3)";
pub(super) const DEBIAN_COMPILER: &str =
    "rustc 1.96.0 (ac68faa20 2026-05-25)\nhost: x86_64-unknown-linux-gnu\n";
pub(super) const REFUSED: &str = "exit status: 100: Failed to fetch http://deb/InRelease  Connection refused";

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

impl Host for SimulatedHost {
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
