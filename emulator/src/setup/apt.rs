//! apt with a state of its own: resolves, downloads and checks packages without touching the system.
//!
//! apt takes its sources, keys and proxies from the system and everything else from the cache folder: the
//! package lists, the archives and the list of installed packages. The last names only what every machine
//! that builds Rust programs has (the C library, a C compiler), so that apt resolves every other shared
//! library, and nothing that the user has installed is in conflict with ours. It checks the lists'
//! signatures and the archives' hashes, and continues an archive that an interrupted run has left.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::download::{Download, size};
use super::host::{Host, Job};

/// Libraries that a program must share with the system's loader; each satisfies the version that the system has.
const SHARED_LIBRARIES: [&str; 3] = ["libc6", "libgcc-s1", "libstdc++6"];

/// Packages that a machine which builds Rust programs has in some form, and such as only installing needs.
const PRESENT: &str =
    "gcc, c-compiler, libc-dev, binutils (= 9999), adduser, debconf (= 9999), passwd (= 9999), iso-codes";

/// Only the lists of packages; and nothing of what the system does after updating or installing.
const CONFIGURATION: &str = r#"#clear APT::Update;
#clear DPkg;
#clear Acquire::IndexTargets;
Acquire::IndexTargets::deb::Packages {
  MetaKey "$(COMPONENT)/binary-$(ARCHITECTURE)/Packages";
  flatMetaKey "Packages";
  ShortDescription "Packages";
  Description "$(RELEASE)/$(COMPONENT) $(ARCHITECTURE) Packages";
  flatDescription "$(RELEASE) Packages";
};
Acquire::Languages "none";
Acquire::GzipIndexes "true";
Acquire::Retries "1";
Acquire::http::Timeout "20";
Acquire::https::Timeout "20";
APT::Get::Assume-Yes "true";
APT::Install-Recommends "false";
APT::Update::Error-Mode "any";
Dir::Cache::pkgcache "";
Dir::Cache::srcpkgcache "";
"#;

/// apt on a machine, with its state in a folder.
pub struct Apt<'a> {
    host: &'a dyn Host,
    folder: PathBuf,
}

/// Packages that apt would fetch.
#[derive(Debug, PartialEq, Eq)]
pub struct Plan {
    /// Name and version of each package, dependencies included.
    pub packages: Vec<(String, String)>,
    /// Size of the archives that are still to be downloaded (bytes).
    pub bytes: u64,
    /// Archives of a repository on disk, which apt checks and leaves where they are.
    pub local: Vec<PathBuf>,
}

impl Plan {
    /// The version of a package.
    pub fn version(&self, package: &str) -> Option<&str> {
        let found = self.packages.iter().find(|(name, _)| name == package)?;
        Some(&found.1)
    }
}

impl<'a> Apt<'a> {
    /// apt with its state in `folder`.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn new(host: &'a dyn Host, folder: &Path) -> io::Result<Self> {
        for sub in ["lists/partial", "archives/partial"] {
            fs::create_dir_all(folder.join(sub))?;
        }
        let apt = Self { host, folder: folder.to_owned() };
        fs::write(apt.path("status"), status(host))?;
        fs::write(apt.path("apt.conf"), CONFIGURATION)?;
        Ok(apt)
    }

    /// Whether the machine has apt.
    pub fn present(host: &dyn Host) -> bool {
        let runs = |program| host.output(program, &["--version"]).is_some();
        runs("apt-get") && runs("dpkg-deb")
    }

    /// Brings the package lists up to date.
    ///
    /// # Errors
    /// The output of apt.
    pub fn update(&self) -> Result<(), String> {
        self.run(&["update"], None)
    }

    /// Plan for `packages` and their dependencies.
    ///
    /// # Errors
    /// The output of apt.
    pub fn plan(&self, packages: &[&str]) -> Result<Plan, String> {
        // Once for the message: the output of a failed command is not passed on.
        self.run(&[&["install", "--simulate"], packages].concat(), None)?;
        let simulated = self.output(&[&["--quiet=2", "install", "--simulate"], packages].concat());
        let addresses = self.output(&[&["--quiet=2", "install", "--print-uris"], packages].concat());
        Ok(Plan {
            packages: simulated.lines().filter_map(simulated_package).collect(),
            bytes: addresses.lines().filter_map(address_size).sum(),
            local: addresses.lines().filter_map(local_archive).collect(),
        })
    }

    /// Downloads and checks `packages` and what they need.
    ///
    /// # Errors
    /// The output of apt.
    pub fn download(&self, packages: &[&str], plan: &Plan) -> Result<(), String> {
        let folder = self.path("archives");
        let total = plan.bytes + size(&folder);
        self.run(&[&["install", "--download-only"], packages].concat(), Some(Download { folder, total }))
    }

    /// The archives of a downloaded plan: apt moves one here when it is complete and its hash is right.
    ///
    /// # Errors
    /// When one is missing.
    pub fn archives(&self, plan: &Plan) -> Result<Vec<PathBuf>, String> {
        let starts =
            plan.packages.iter().map(|(name, version)| format!("{name}_{}_", version.replace(':', "%3a")));
        let starts: Vec<String> = starts.collect();
        let expected = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.ends_with(".deb") && starts.iter().any(|start| name.starts_with(start))
        };
        let mut archives: Vec<PathBuf> = self.files().into_iter().filter(expected).collect();
        archives.extend_from_slice(&plan.local);
        archives.sort();
        if archives.len() < plan.packages.len() {
            return Err(format!("{} archives for {} packages", archives.len(), plan.packages.len()));
        }
        Ok(archives)
    }

    /// Removes every archive.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn clean(&self) -> io::Result<()> {
        let archive = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "deb");
        self.files().into_iter().filter(archive).try_for_each(fs::remove_file)
    }

    fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path("archives")).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn run(&self, arguments: &[&str], download: Option<Download>) -> Result<(), String> {
        let options = self.options();
        let arguments: Vec<&str> =
            options.iter().map(String::as_str).chain(arguments.iter().copied()).collect();
        self.host.run(&Job { program: "apt-get", arguments: &arguments, patience: None, download })
    }

    fn output(&self, arguments: &[&str]) -> String {
        let options = self.options();
        let arguments: Vec<&str> =
            options.iter().map(String::as_str).chain(arguments.iter().copied()).collect();
        self.host.output("apt-get", &arguments).unwrap_or_default()
    }

    /// Everything that apt writes goes to our folder; as root it stays root, whom alone the folder may let in.
    fn options(&self) -> Vec<String> {
        let of = |key: &str, name: &str| format!("{key}={}", self.path(name).display());
        let set = [
            of("Dir::State", ""),
            of("Dir::State::lists", "lists/"),
            of("Dir::State::status", "status"),
            of("Dir::State::extended_states", "extended_states"),
            of("Dir::Cache", ""),
            of("Dir::Cache::archives", "archives/"),
            of("Dir::Log", "log/"),
            "APT::Sandbox::User=root".to_owned(),
        ];
        let file = ["--config-file".to_owned(), self.path("apt.conf").display().to_string()];
        let options = set.into_iter().flat_map(|option| ["--option".to_owned(), option]);
        file.into_iter().chain(options).collect()
    }
}

/// The list of installed packages that apt is shown.
fn status(host: &dyn Host) -> String {
    let architecture = host.output("dpkg", &["--print-architecture"]).unwrap_or_default();
    let architecture = architecture.trim();
    let library = |name: &&str| {
        let package = format!("{name}:{architecture}");
        let version = host.output("dpkg-query", &["--show", "--showformat=${Version}", &package])?;
        (!version.trim().is_empty()).then(|| format!("{name} (= {})", version.trim()))
    };
    let libraries: Vec<String> = SHARED_LIBRARIES.iter().filter_map(library).collect();
    format!(
        "Package: strainwave-present\nStatus: install ok installed\nVersion: 1\nArchitecture: {architecture}\n\
         Maintainer: strainwave\nDescription: what the machine has\nProvides: {PRESENT}, {}\n",
        libraries.join(", ")
    )
}

/// `Inst libfdt1 (1.6.1-4+b1 Debian:12/stable [amd64])`.
fn simulated_package(line: &str) -> Option<(String, String)> {
    let mut words = line.strip_prefix("Inst ")?.split(' ');
    let name = words.next()?;
    let version = words.find_map(|word| word.strip_prefix('('))?;
    Some((name.to_owned(), version.to_owned()))
}

/// `'http://.../libfdt1.deb' libfdt1.deb 20552 MD5Sum:...`.
fn address_size(line: &str) -> Option<u64> {
    line.strip_prefix('\'')?.split(' ').nth(2)?.parse().ok()
}

/// `'file:/srv/debian/libfdt1.deb' libfdt1.deb 20552 MD5Sum:...`.
fn local_archive(line: &str) -> Option<PathBuf> {
    let (path, _) = line.strip_prefix("'file:")?.split_once('\'')?;
    Some(Path::new("/").join(path.trim_start_matches('/')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_apt_prints_is_understood() {
        let line = "Inst qemu-system-arm (1:7.2+dfsg-7+deb12u18+b3 Debian:12.12/oldstable [amd64]) []";
        let expected = ("qemu-system-arm".to_owned(), "1:7.2+dfsg-7+deb12u18+b3".to_owned());
        assert_eq!(simulated_package(line), Some(expected));
        assert_eq!(simulated_package("Conf libfdt1 (1.6.1-4+b1 Debian:12 [amd64])"), None);
        let line = "'http://deb.debian.org/debian/pool/libfdt1_1.6.1-4+b1_amd64.deb' libfdt1_1.6.1.deb 20552 MD5Sum:1";
        assert_eq!(address_size(line), Some(20552));
        assert_eq!(local_archive(line), None);
        assert_eq!(local_archive("'file:///srv/a.deb' a.deb 1 MD5Sum:1"), Some("/srv/a.deb".into()));
        assert_eq!(address_size("E: Unable to locate package"), None);
    }
}
