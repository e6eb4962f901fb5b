//! Chooses the joint whose constants are built in: the file that `STRAINWAVE_JOINT` names, else `src/joint.rs`; and its number on CAN:
//! `STRAINWAVE_NODE`, 1 to 127, else 1.

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
    println!("cargo:rerun-if-env-changed=STRAINWAVE_NODE");
    let node = env::var("STRAINWAVE_NODE").map_or(1, |number| node(&number));
    println!("cargo:rustc-env=STRAINWAVE_NODE_NUMBER={node}");
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

/// The number of a node.
fn node(number: &str) -> u8 {
    number.parse().ok().filter(|number| (1..=127).contains(number)).unwrap_or_else(|| {
        eprintln!("STRAINWAVE_NODE {number}: allowed: 1 to 127");
        process::exit(2)
    })
}
