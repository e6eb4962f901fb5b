//! Requirements: the oldest compiler and the oldest emulator.

/// Oldest compiler that knows the language of this code: `rust-version` of the workspace.
pub const OLDEST_COMPILER: (u32, u32) = (1, 89);

/// Oldest QEMU that the lockstep was tried with.
pub const OLDEST_EMULATOR: (u32, u32) = (7, 2);

/// The emulator's program.
pub const EMULATOR: &str = "qemu-system-arm";
