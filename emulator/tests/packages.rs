//! The set-up with the machine's own apt and a small repository on disk: no network, no root.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use strainwave_emulator::setup::{self, EMULATOR, Host, Job, ThisHost};
use tempfile::TempDir;

/// This machine, with apt's sources and the cache folder replaced and no emulator on PATH.
struct Redirected {
    folder: TempDir,
}

impl Redirected {
    /// `None` on a machine without apt.
    fn new() -> Option<Self> {
        for program in ["apt-get", "dpkg-deb"] {
            if ThisHost.output(program, &["--version"]).is_none() {
                println!("skipped: no {program}");
                return None;
            }
        }
        let host = Self { folder: tempfile::tempdir().expect("a folder") };
        fs::create_dir(host.repository()).expect("is created");
        let sources = format!("deb [trusted=yes] file:{} ./\n", host.repository().display());
        fs::write(host.path("sources.list"), sources).expect("is written");
        let options = format!(
            "Dir::Etc::sourcelist \"{}\";\nDir::Etc::sourceparts \"/dev/null\";\n",
            host.path("sources.list").display()
        );
        fs::write(host.path("apt.conf"), options).expect("is written");
        Some(host)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn repository(&self) -> PathBuf {
        self.path("repository")
    }

    /// A package with these files, and the entry of the package list, dependencies included.
    fn package(&self, name: &str, fields: &str, files: &[(&str, &str)]) -> String {
        let root = self.path(name);
        fs::create_dir_all(root.join("DEBIAN")).expect("is created");
        let architecture = ThisHost.output("dpkg", &["--print-architecture"]).expect("dpkg runs");
        let control = format!(
            "Package: {name}\nVersion: 1:7.3-1\nArchitecture: {}\nMaintainer: none\nDescription: a test\n{fields}",
            architecture.trim()
        );
        fs::write(root.join("DEBIAN/control"), &control).expect("is written");
        for (path, content) in files {
            let path = root.join(path);
            fs::create_dir_all(path.parent().expect("is in a folder")).expect("is created");
            fs::write(&path, content).expect("is written");
            assert!(Command::new("chmod").arg("755").arg(path).status().expect("chmod runs").success());
        }
        let archive = self.repository().join(format!("{name}.deb"));
        let arguments = ["--build", "--root-owner-group", text(&root), text(&archive)];
        ThisHost.output("dpkg-deb", &arguments).expect("the archive is built");
        let sum = ThisHost.output("sha256sum", &[text(&archive)]).expect("sha256sum runs");
        let sum = sum.split_whitespace().next().expect("a sum");
        let size = fs::metadata(&archive).expect("is there").len();
        format!("{control}Filename: ./{name}.deb\nSize: {size}\nSHA256: {sum}\n\n")
    }

    /// An emulator that needs a shared library and a program of another package, in conflict with something that
    /// every Debian has installed.
    fn offer_emulator(&self) {
        let program = "#!/bin/sh\necho \"QEMU emulator version 7.3.0 ($(cat \"${0%/*}/../share/words\"))\"\n";
        let fields = "Depends: strainwave-words (>= 1:7), libc6\nConflicts: dpkg\n";
        let entries = [
            self.package(EMULATOR, fields, &[("usr/bin/qemu-system-arm", program)]),
            self.package("strainwave-words", "", &[("usr/share/words", "unpacked")]),
        ];
        fs::write(self.repository().join("Packages"), entries.concat()).expect("is written");
    }
}

fn text(path: &Path) -> &str {
    path.to_str().expect("is text")
}

impl Host for Redirected {
    fn output(&self, program: &str, arguments: &[&str]) -> Option<String> {
        match program {
            EMULATOR => None,
            "apt-get" => {
                let set = format!("APT_CONFIG={}", self.path("apt.conf").display());
                ThisHost.output("env", &[&[set.as_str(), program], arguments].concat())
            }
            _ => ThisHost.output(program, arguments),
        }
    }

    fn run(&self, job: &Job<'_>) -> Result<(), String> {
        if job.program != "apt-get" {
            return ThisHost.run(job);
        }
        let set = format!("APT_CONFIG={}", self.path("apt.conf").display());
        let arguments = [&[set.as_str(), job.program], job.arguments].concat();
        ThisHost.run(&Job { program: "env", arguments: &arguments, ..job.clone() })
    }

    fn exists(&self, path: &Path) -> bool {
        ThisHost.exists(path)
    }

    fn text(&self, path: &str) -> Option<String> {
        ThisHost.text(path)
    }

    fn variable(&self, name: &str) -> Option<OsString> {
        (name == "STRAINWAVE_CACHE").then(|| self.path("it's a cache").into())
    }

    fn announce(&self, line: &str) {
        println!("{line}");
    }
}

#[test]
fn packages_with_dependencies_and_conflicts_run_from_the_cache() {
    let Some(host) = Redirected::new() else { return };
    host.offer_emulator();
    let found = setup::emulator(&host).expect("is fetched");
    assert!(found.program.starts_with(host.path("it's a cache")), "{found:?}");
    assert_eq!(found.version, "QEMU emulator version 7.3.0 (unpacked)");
    // A second run needs no repository.
    fs::remove_dir_all(host.repository()).expect("is removed");
    assert_eq!(setup::emulator(&host), Ok(found));
}

#[test]
fn an_archive_with_another_hash_is_refused() {
    let Some(host) = Redirected::new() else { return };
    host.offer_emulator();
    let list = host.repository().join("Packages");
    let listed = fs::read_to_string(&list).expect("is read");
    let (start, _) = listed.split_once("SHA256: ").expect("has a hash");
    let rest = listed.split_once("\n\n").expect("has two entries").1;
    fs::write(&list, format!("{start}SHA256: {}\n\n{rest}", "0".repeat(64))).expect("is written");
    let line = setup::emulator(&host).expect_err("is refused").to_string();
    assert!(line.contains("Hash Sum mismatch") && !line.contains('\n'), "{line}");
}

#[test]
fn a_repository_that_has_gone_is_one_line() {
    let Some(host) = Redirected::new() else { return };
    let line = setup::emulator(&host).expect_err("offers nothing").to_string();
    assert!(line.starts_with("no qemu-system-arm 7.2 or newer on PATH: apt-get cannot fetch"), "{line}");
    assert!(!line.contains('\n'), "{line}");
}
