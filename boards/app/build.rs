//! Chooses the joint whose constants are built in: the file that `STRAINWAVE_JOINT` names, else `src/joint.rs`.

use std::path::{Path, PathBuf};
use std::{env, process};

fn main() {
    println!("cargo:rerun-if-env-changed=STRAINWAVE_JOINT");
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let joint = match env::var_os("STRAINWAVE_JOINT") {
        Some(path) => checked(Path::new(&path)),
        None => root.join("src/joint.rs"),
    };
    println!("cargo:rerun-if-changed={}", joint.display());
    println!("cargo:rustc-env=STRAINWAVE_JOINT_FILE={}", joint.display());
}

/// The absolute path: `include!` would take a relative one from this crate's folder.
fn checked(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|error| {
        eprintln!(
            "STRAINWAVE_JOINT {}: {error}, a file of `strainwave export --rust` is needed",
            path.display()
        );
        process::exit(2)
    })
}
