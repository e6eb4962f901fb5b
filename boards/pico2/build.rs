//! Puts this board's memory map where the linker looks; the vectors come with the device crate.

include!("../linker.rs");

fn main() -> std::io::Result<()> {
    link("memory.x", "Cortex-M33", None).map(|_| ())
}
