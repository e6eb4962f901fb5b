//! Why an image cannot be judged.

use std::path::PathBuf;

/// An image that cannot be judged, in one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The image.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file is not what it should be.
    #[error("{}: {what}, allowed: a linked 32-bit ARM ELF file with its symbols", path.display())]
    NotAnImage {
        /// The image.
        path: PathBuf,
        /// Its fault.
        what: String,
    },
    /// Bytes marked as code are not an instruction.
    #[error("no instruction at {address:#x}:{}", bytes.iter().map(|b| format!(" {b:02x}")).collect::<String>())]
    NotDecoded {
        /// Its address.
        address: u32,
        /// Bytes at that address.
        bytes: Vec<u8>,
    },
    /// The disassembler failed.
    #[error("disassembler: {0}")]
    Disassembler(#[from] capstone::Error),
    /// Control leaves a function to no known place.
    #[error(
        "{function} at {address:#x}: `{text}` goes where the image does not tell, allowed: a target named under [[indirect_call]] in the budget"
    )]
    Indirect {
        /// The function.
        function: String,
        /// The instruction.
        address: u32,
        /// The instruction, written out.
        text: String,
    },
    /// The stack pointer is changed by an amount that is not fixed.
    #[error(
        "{function} at {address:#x}: `{text}` moves the stack pointer by an unknown amount, allowed: a constant"
    )]
    StackPointer {
        /// The function.
        function: String,
        /// The instruction.
        address: u32,
        /// The instruction, written out.
        text: String,
    },
    /// Functions call each other in a circle.
    #[error("recursion: {}, allowed: none", path.join(" -> "))]
    Recursion {
        /// The circle.
        path: Vec<String>,
    },
    /// No function has this name.
    #[error("no function {pattern} in the image (inlined, renamed or not linked), nearest: {nearest}")]
    NoFunction {
        /// Searched pattern.
        pattern: String,
        /// The function whose last segment agrees, if any.
        nearest: String,
    },
    /// An exception vector points to no function.
    #[error("vector {number} points to {address:#x}, allowed: the start of a function")]
    Vector {
        /// Its number; 1 is the reset vector.
        number: usize,
        /// Address that it points to.
        address: u32,
    },
}
