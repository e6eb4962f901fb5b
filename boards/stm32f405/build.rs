//! Puts this board's memory map where the linker looks; the vectors come with the device crate.

include!("../linker.rs");

fn main() -> std::io::Result<()> {
    // The one with a store leaves sectors of the flash free.
    let memory = if cfg!(feature = "served") { "memory-served.x" } else { "memory.x" };
    link(memory, "Cortex-M4F", None).map(|_| ())
}
