//! What an emulated RP2350 has that rsemu lacks: as far as the firmware of `pico2` touches it, of one core.
//!
//! | file | what is in it |
//! | --- | --- |
//! | `pico2.machine` | the chip and what is wired to it |
//! | [`blocks`] | registers with rules: resets, clocks, crystal, PLL; pins and pulse widths as their registers alone |
//! | [`sio`] | the outputs that the core switches |
//! | [`spi`] | SPI |
//! | [`watchdog`] | watchdog, its ticks, and what it resets |

pub mod blocks;
pub mod sio;
pub mod spi;
pub mod watchdog;
