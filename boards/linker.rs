// What every board's build script tells the linker; included by each.

/// Puts the board's memory map where the linker looks, and names the linker scripts. The image names its core and, where the
/// emulator has the board, the emulator's machine: symbols, which take no room in it, with `_` for `-`.
fn link(memory: &str, core: &str, machine: Option<&str>) -> std::io::Result<std::path::PathBuf> {
    for (what, name) in [("core", Some(core)), ("machine", machine)] {
        if let Some(name) = name {
            println!("cargo:rustc-link-arg-bins=--defsym=strainwave_{what}_{}=0", name.replace('-', "_"));
        }
    }
    let out = std::path::PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    std::fs::copy(memory, out.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    if std::env::var_os("RUSTC_LINKER").is_some() {
        // A linker that is not rustc's own. Those before LLVM 15 or so keep whatever a script names, used or not:
        // here defmt's own panic, which the application replaces, and with it `core::panic!`.
        println!("cargo:rustc-link-arg-bins=--defsym=__defmt_default_panic=0");
    }
    println!("cargo:rerun-if-changed={memory}");
    println!("cargo:rerun-if-changed=../linker.rs");
    println!("cargo:rerun-if-changed=build.rs");
    Ok(out)
}
