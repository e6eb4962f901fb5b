//! A set of Debian packages that is fetched together and unpacked privately.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use super::apt::{Apt, Plan};
use super::cache;
use super::download::megabytes;
use super::error::Unfetched;
use super::host::Host;
use super::unpack::unpack;
use super::version::package_version;

/// Packages that are unpacked into one folder.
pub struct PackageSet {
    /// The folder's name.
    pub name: &'static str,
    /// Lists of packages, of which the first that the machine's package lists offer is fetched. The first package
    /// of each decides whether it is new enough.
    pub choices: &'static [&'static [&'static str]],
    /// Oldest version of the first package.
    pub oldest: (u32, u32),
    /// The program that tells whether the set is there.
    pub program: &'static str,
    /// Its purpose.
    pub purpose: &'static str,
    /// Installation on systems without apt.
    pub elsewhere: &'static str,
}

impl PackageSet {
    /// A program of the set, whether it is there or not.
    pub fn program(&self, host: &dyn Host, name: &str) -> Option<PathBuf> {
        Some(self.home(host).ok()?.join("bin").join(name))
    }

    /// Fetches the set, unless it is there. Two runs at once take turns.
    ///
    /// # Errors
    /// [`Unfetched`].
    pub fn fetch(&self, host: &dyn Host) -> Result<(), Unfetched> {
        if !Apt::present(host) {
            return Err(Unfetched::NoApt(self.elsewhere));
        }
        let folder = cache::folder(host)?;
        let unwritable = |error: io::Error| unwritable(&folder, &error);
        fs::create_dir_all(&folder).map_err(unwritable)?;
        let _lock = lock(host, &folder).map_err(unwritable)?;
        if self.runs(host) {
            return Ok(());
        }
        let apt = Apt::new(host, &folder.join("apt")).map_err(unwritable)?;
        let (packages, plan) = self.plan(host, &apt)?;
        self.announce(host, packages[0], &plan, &folder);
        apt.download(packages, &plan).map_err(|reason| failed(packages, reason))?;
        let archives = apt.archives(&plan).map_err(|reason| failed(packages, reason))?;
        self.unpack(host, &archives, packages, &folder)?;
        apt.clean().map_err(unwritable)
    }

    /// The error when a set that is there is of no use.
    pub fn does_not_run(&self) -> Unfetched {
        Unfetched::DoesNotRun { program: self.program.into() }
    }

    /// Folder of the set, once it is there.
    fn home(&self, host: &dyn Host) -> Result<PathBuf, Unfetched> {
        Ok(cache::folder(host)?.join(self.name))
    }

    fn runs(&self, host: &dyn Host) -> bool {
        let program = self.program(host, self.program);
        program.is_some_and(|program| host.output(&program.display().to_string(), &["--version"]).is_some())
    }

    /// The first choice that can be had.
    fn plan(&self, host: &dyn Host, apt: &Apt<'_>) -> Result<(&'static [&'static str], Plan), Unfetched> {
        host.announce("reading the package lists");
        let updated = apt.update();
        let mut refused = Unfetched::NoApt(self.elsewhere);
        for packages in self.choices {
            refused = match apt.plan(packages) {
                Ok(plan) => match self.check(packages, &plan) {
                    Ok(()) => return Ok((packages, plan)),
                    Err(error) => error,
                },
                // Lists that could not be updated are the reason why they offer nothing.
                Err(reason) => match &updated {
                    Err(update) => failed(self.choices[0], update.clone()),
                    Ok(()) => failed(packages, reason),
                },
            };
        }
        Err(refused)
    }

    fn check(&self, packages: &[&str], plan: &Plan) -> Result<(), Unfetched> {
        let version = plan.version(packages[0]).unwrap_or_default();
        if plan.version("libc6").is_some() {
            return Err(Unfetched::CLibrary { packages: packages.join(" ") });
        }
        if package_version(version) < Some(self.oldest) {
            return Err(Unfetched::Old { package: packages[0].into(), version: version.into() });
        }
        Ok(())
    }

    fn announce(&self, host: &dyn Host, package: &str, plan: &Plan, folder: &Path) {
        host.announce(&format!(
            "fetching {package} {} ({} packages, {} to download) into {}: {}",
            plan.version(package).unwrap_or_default(),
            plan.packages.len(),
            megabytes(plan.bytes),
            folder.join(self.name).display(),
            self.purpose
        ));
    }

    /// Unpacks beside the set's folder and renames: a folder with the set's name is complete.
    fn unpack(
        &self,
        host: &dyn Host,
        archives: &[PathBuf],
        packages: &[&str],
        folder: &Path,
    ) -> Result<(), Unfetched> {
        let unwritable = |error: io::Error| unwritable(folder, &error);
        let home = folder.join(self.name);
        let fresh = folder.join(format!("{}.new", self.name));
        remove(&fresh).map_err(unwritable)?;
        fs::create_dir(&fresh).map_err(unwritable)?;
        unpack(host, archives, &fresh, &home).map_err(|reason| failed(packages, reason))?;
        remove(&home).map_err(unwritable)?;
        fs::rename(&fresh, &home).map_err(unwritable)
    }
}

/// The only run that fetches, until the lock is dropped.
fn lock(host: &dyn Host, folder: &Path) -> io::Result<File> {
    let file = File::create(folder.join("lock"))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            host.announce("waiting for another run, which is fetching packages");
            file.lock()?;
        }
        Err(TryLockError::Error(error)) => return Err(error),
    }
    Ok(file)
}

fn remove(folder: &Path) -> io::Result<()> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn failed(packages: &[&str], reason: String) -> Unfetched {
    Unfetched::Apt { packages: packages.join(" "), reason }
}

fn unwritable(folder: &Path, error: &io::Error) -> Unfetched {
    Unfetched::Cache { folder: folder.display().to_string(), reason: error.to_string() }
}
