//! The joint controller on a Nucleo-G474RE, an STM32G474RE at 170 MHz. Wiring only.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | PA5, PA6, PA7, PB6 | D13, D12, D11, D10 | motor encoder MT6835: SPI1 clock, MISO, MOSI, select |
//! | PA4 | A2 | torque command to the motor's drive: 0..3.3 V, 1.65 V is none, the rails are the peak torque |
//! | PB0 | A3 | drive enable, high while the joint is controlled; pull it down outside |
//! | PA2, PA3 | serial port of the ST-LINK | USART2, 921600 Bd: telemetry (defmt) out, operator's keys in |
//! | PF0, PF1 | X3 | 24 MHz crystal |
//!
//! The encoder's count has to grow with a positive torque command. The drive has a current loop of
//! its own, so the motor's torque is taken to be the last command. The joint holds the position in which it
//! starts; `+` and `-` on the serial port move its target by 10 mrad at the output, `0` moves it back. The board's green LED is on the
//! encoder's clock.
#![no_std]
#![no_main]

mod board;
mod clock;
mod drive;
mod encoder;
mod serial;
mod spi;

use stm32g4xx_hal::pac::{Interrupt, interrupt};
use strainwave_stm32::usart;

strainwave_controller::controller!(clock::G474, board::Board, board::start, interrupt TIM2, USART2, usart::receive::<serial::Serial>, usart::send::<serial::Serial>);
