//! Properties of the firmware image: its size, its stack, and proofs of absent symbols.
//!
//! Everything here is read from the linked ELF file, so it holds for the image that is flashed and needs
//! no run. [`image`] reads the file and [`disassembly`] its code; [`flow`] follows every function's stack
//! pointer and calls; on the resulting [`call_graph`] stand the [`stack`] bound and the [`proofs`].

pub mod call_graph;
pub mod disassembly;
pub mod error;
pub mod flow;
pub mod image;
pub mod proofs;
pub mod sizes;
pub mod stack;
pub mod symbol;

/// Symbol of the control step in every image, and its name among a budget's blocks.
pub const CONTROL_STEP: &str = "control_step";

pub use call_graph::CallGraph;
pub use error::Error;
pub use flow::IndirectCall;
pub use image::Image;
pub use proofs::Violation;
pub use sizes::Sizes;
pub use stack::StackBound;
