//! The firmware of real boards, executed: a chip with its board in an emulator, a plant at its encoder and drive.
//!
//! QEMU has no clock control, SPI, timer or watchdog of these chips that answer as they do. rsemu has them of STM32 chips, in Rust, but for
//! clock and power control and the SPI of an STM32H7, which are here; those of an RP2350 are in [`crate::rp2350`]. So the image runs as it
//! is flashed, from its reset vector on. The core interprets one instruction after the other; its cycles are no measure here, QEMU counts
//! them. What is added is the encoder, the drive, the plant, and a host's build of the same control.
//!
//! | file | what is in it |
//! | --- | --- |
//! | `BOARD.machine` | the chip and what is wired to it |
//! | [`model`] | each chip: its description, its memory, the drive's registers |
//! | [`chip`] | boots an image, lets it run, looks at its pins |
//! | [`encoder`] | the motor encoder |
//! | [`halfwords`] | accesses that rsemu's peripherals do not take |
//! | [`registers`] | a peripheral of registers with rules: [`h7_rcc`] clocks, [`h7_pwr`] power |
//! | [`h7_spi`] | SPI of an STM32H7 |
//! | [`control`] | a second of control, beside the host's |
//! | [`verify`] | its figures |

pub mod chip;
pub mod control;
pub mod encoder;
pub mod h7_pwr;
pub mod h7_rcc;
pub mod h7_spi;
pub mod halfwords;
pub mod model;
pub mod registers;
pub mod verify;

pub use chip::{Chip, Error};
pub use model::{MODELS, Model};
