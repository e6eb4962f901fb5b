//! The joint controller on a Nucleo-H743ZI2, an STM32H743ZI at 400 MHz. Wiring only.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | PA5, PA6, PB5, PD14 | D13, D12, D11, D10 | motor encoder MT6835: SPI1 clock, MISO, MOSI, select |
//! | PA4 | D24 | torque command to the motor's drive: 0..3.3 V, 1.65 V is none, the rails are the peak torque |
//! | PB1 | A3 | drive enable, high while the joint is controlled; pull it down outside |
//! | PD8, PD9 | serial port of the ST-LINK | USART3, 921600 Bd: telemetry (defmt) out, operator's keys in |
//! | PH0 | clock of the ST-LINK, which has to have power | 8 MHz |
//!
//! The encoder's count has to grow with a positive torque command. The drive has a current loop of
//! its own, so the motor's torque is taken to be the last command. The joint holds the position in which it
//! starts; `+` and `-` on the serial port move its target by 10 mrad at the output, `0` moves it back.
#![no_std]
#![no_main]

mod board;
mod clock;
mod drive;
mod encoder;
mod pins;
mod serial;
mod spi;

use stm32h7::stm32h743v::{Interrupt, interrupt};
use strainwave_stm32::usart;

strainwave_controller::controller!(clock::H743, board::Board, board::start, interrupt TIM2, USART3, usart::receive::<serial::Serial>, usart::send::<serial::Serial>);
