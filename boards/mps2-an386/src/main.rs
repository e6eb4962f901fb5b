//! The joint controller on Arm's MPS2+ AN386 (Cortex-M4F), emulated by QEMU. Wiring only.
#![no_std]
#![no_main]

mod machine;

strainwave_mps::controller!(machine::An386);
