//! Puts this board's linker scripts where the linker looks: the memory map, and the device's vectors.

include!("../linker.rs");

fn main() -> std::io::Result<()> {
    // The same memory map as the default board's, the one at the root of the repository.
    let out = link("../../memory.x", "Cortex-M7", Some("mps2-an500"))?;
    // The vector table names its handlers itself, with `strainwave_mps::vectors!`: there is nothing to provide.
    std::fs::write(out.join("device.x"), "")
}
