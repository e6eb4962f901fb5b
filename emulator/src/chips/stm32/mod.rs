//! What emulated STM32s have that rsemu lacks, as far as the firmware of their boards touches it.
//!
//! | file | what is in it |
//! | --- | --- |
//! | `BOARD.machine` | the chip and what is wired to it |
//! | [`halfwords`] | accesses that rsemu's peripherals do not take |
//! | [`f4_dma`] | the DMA of an STM32F4's USART1 |
//! | [`g4_fdcan`] | FDCAN of an STM32G4, with the bus at it |
//! | [`h7_flash`] | flash of an STM32H7 |
//! | [`h7_rcc`], [`h7_pwr`] | clock and power control of an STM32H7 |
//! | [`h7_spi`] | its SPI |

pub mod f4_dma;
pub mod g4_fdcan;
pub mod h7_flash;
pub mod h7_pwr;
pub mod h7_rcc;
pub mod h7_spi;
pub mod halfwords;
