//! Chooses the joint whose constants are built in: the file that `STRAINWAVE_JOINT` names, else `src/joint.rs`; its number on CAN:
//! `STRAINWAVE_NODE`, 1 to 127, else 1; and that of its drive, where that is an ODrive: `STRAINWAVE_ODRIVE`, 0 to 62, else 0.

use std::ops::RangeInclusive;
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
    number("STRAINWAVE_NODE", 1, 1..=127);
    number("STRAINWAVE_ODRIVE", 0, 0..=62);
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

/// Hands a number on a bus to the crate: that of a variable, or else another.
fn number(variable: &str, otherwise: u8, allowed: RangeInclusive<u8>) {
    println!("cargo:rerun-if-env-changed={variable}");
    let number = env::var(variable).map_or(otherwise, |text| {
        text.parse().ok().filter(|number| allowed.contains(number)).unwrap_or_else(|| {
            eprintln!("{variable} {text}: allowed: {} to {}", allowed.start(), allowed.end());
            process::exit(2)
        })
    });
    println!("cargo:rustc-env={variable}_NUMBER={number}");
}
