//! Cross-build, set-up, QEMU, lockstep, counting and proofs on the firmware image.

pub mod artifact;
pub mod counting;
