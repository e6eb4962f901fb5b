//! The firmware of real boards, executed: a chip with its board in an emulator, a plant at its encoder and drive.
//!
//! QEMU has no clock control, SPI, timer or watchdog of these chips that answer as they do. rsemu, in Rust, has them of STM32 chips but for some
//! of an STM32H7; what it lacks is here. So the image runs as it is flashed, from its reset vector on. The core interprets
//! one instruction after the other; its cycles are no measure here, QEMU counts them. What is added is the encoder, the drive, the
//! plant, and a host's build of the same control.
//!
//! | file or folder | what is in it |
//! | --- | --- |
//! | [`stm32`], [`rp2350`] | descriptions of these chips with what is wired to them, peripherals that rsemu lacks |
//! | [`cpu`] | the core, around a fault of the emulator |
//! | [`registers`] | a peripheral of registers with rules |
//! | [`spi_master`] | an SPI by the registers of its controller |
//! | [`system_reset`] | the reset of a whole chip |
//! | [`time`] | time of a peripheral between two accesses |
//! | [`encoder`] | the motor encoder |
//! | [`can`] | a frame of a CAN bus |
//! | [`model`] | each chip: its description, its memory, the drive's registers |
//! | [`chip`] | boots an image, lets it run, looks at its pins |
//! | [`run_error`] | why a run of a chip with its plant ended |
//! | [`host`] | the firmware's control on the host |
//! | [`host_bus`], [`can`] | a bus of a node on the host, frames there |
//! | [`odrive`] | an ODrive on a bus |
//! | [`drive_end`] | the drive of a joint that is commanded over CAN |
//! | [`flash_image`] | what a chip has stored, on the host |
//! | [`program`] | a program of the host beside a chip with its plant |
//! | [`host_program`] | what a host does at the tuning link |
//! | [`control`] | a second of control, beside the host's |
//! | [`mod@line`] | a host's program beside the emulation, period by period |
//! | [`served`] | a control that serves its tuning link, with a host at it |
//! | [`bus_program`] | what a master does on the bus |
//! | [`commanded`] | a joint that is commanded over CAN, with a master on its bus |
//! | [`verify`] | the figures of all |

pub mod bus_program;
pub mod can;
pub mod chip;
pub mod commanded;
pub mod control;
pub mod cpu;
pub mod drive_end;
pub mod encoder;
pub mod flash_image;
pub mod host;
pub mod host_bus;
pub mod host_program;
pub mod line;
pub mod model;
pub mod odrive;
pub mod program;
pub mod registers;
pub mod rp2350;
pub mod run_error;
pub mod served;
pub mod spi_master;
pub mod stm32;
pub mod system_reset;
pub mod time;
pub mod verify;

pub use chip::{Chip, Error};
pub use model::{MODELS, Model};
