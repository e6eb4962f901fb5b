//! Puts this board's linker scripts where the linker looks: the memory map, and the device's vectors.

include!("../linker.rs");

fn main() -> std::io::Result<()> {
    let out = link("memory.x", "Cortex-M33", Some("mps2-an505"))?;
    // The vector table names its handlers itself, with `strainwave_mps::vectors!`: there is nothing to provide.
    std::fs::write(out.join("device.x"), "")
}
