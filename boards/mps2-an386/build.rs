//! Puts this board's linker scripts where the linker looks: the memory map, and the device's vectors.

include!("../linker.rs");

fn main() -> std::io::Result<()> {
    // This is the default board: its memory map is the one at the root of the repository.
    let out = link("../../memory.x", "Cortex-M4F", Some("mps2-an386"))?;
    // The vector table names its handlers itself, with `strainwave_mps::vectors!`: there is nothing to provide.
    std::fs::write(out.join("device.x"), "")
}
