//! Puts this board's linker scripts where the linker looks: the memory map, and the device's vectors.

use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    // This is the default board: its memory map is the one at the root of the repository.
    fs::copy("../../memory.x", out.join("memory.x"))?;
    // The vector table names its handlers itself, in src/vectors.rs: there is nothing to provide.
    fs::write(out.join("device.x"), "")?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    println!("cargo:rerun-if-changed=../../memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    Ok(())
}
