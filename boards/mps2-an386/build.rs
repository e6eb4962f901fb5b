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
    if env::var_os("RUSTC_LINKER").is_some() {
        // A linker that is not rustc's own. Those before LLVM 15 or so keep whatever a script names, used or not:
        // here defmt's own panic, which the application replaces, and with it `core::panic!`.
        println!("cargo:rustc-link-arg-bins=--defsym=__defmt_default_panic=0");
    }
    println!("cargo:rerun-if-changed=../../memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    Ok(())
}
