//! Puts this board's linker scripts where the linker looks: the memory map, and the device's vectors.

include!("../linker.rs");

fn main() -> std::io::Result<()> {
    let out = link("memory.x", "Cortex-M55", Some("mps3-an547"))?;
    // The vector table names its handlers itself, with `strainwave_mps::vectors!`: there is nothing to provide.
    std::fs::write(out.join("device.x"), "")
}
