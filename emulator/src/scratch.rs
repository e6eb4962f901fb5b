//! Private folders of one run. Each is gone when it is dropped, and when the program is interrupted.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once};

use tempfile::{Builder, TempDir};

use crate::interrupt;
use crate::lock::locked;

/// A folder among the system's temporary ones.
#[derive(Debug)]
pub struct Scratch(TempDir);

static LIVE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

impl Scratch {
    /// A new folder whose name tells what it is for.
    pub fn new(purpose: &str) -> io::Result<Self> {
        static REMOVED: Once = Once::new();
        REMOVED.call_once(|| interrupt::clean_up_with(remove_all));
        let mut live = locked(&LIVE);
        let folder = Builder::new().prefix(&format!("strainwave-{purpose}-")).tempdir()?;
        live.push(folder.path().to_owned());
        Ok(Self(folder))
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        locked(&LIVE).retain(|path| path != self.0.path());
    }
}

/// Removes every folder, for a program that ends here.
fn remove_all() {
    for path in locked(&LIVE).drain(..) {
        // One that is gone already is as wanted.
        let _ = fs::remove_dir_all(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_goes_with_its_owner() {
        let scratch = Scratch::new("test").unwrap();
        let path = scratch.path().to_owned();
        fs::write(path.join("file"), "content").unwrap();
        assert!(locked(&LIVE).contains(&path));
        drop(scratch);
        assert!(!path.exists() && !locked(&LIVE).contains(&path));
    }
}
