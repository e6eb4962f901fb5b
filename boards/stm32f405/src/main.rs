//! The joint controller on an STM32F405RG at 168 MHz. Wiring only.
//!
//! | pin | function |
//! | --- | --- |
//! | PA5, PA6, PA7, PB6 | motor encoder MT6835: SPI1 clock, MISO, MOSI, select |
//! | PA4 | torque command to the motor's drive: 0..3.3 V, 1.65 V is none, the rails are the peak torque |
//! | PB0 | drive enable, high while the joint is controlled; pull it down outside |
//! | PA9, PA10 | USART1, 921600 Bd: telemetry (defmt) out, operator's keys in |
//! | PH0, PH1 | 8 MHz crystal |
//!
//! The encoder's count has to grow with a positive torque command. The drive has a current loop of
//! its own, so the motor's torque is taken to be the last command. The joint holds the position in which it
//! starts; `+` and `-` on the USART move its target by 10 mrad at the output, `0` moves it back.
#![no_std]
#![no_main]

mod board;
mod clock;
mod drive;
mod encoder;
mod keys;
mod serial;

use stm32f4xx_hal::pac::{Interrupt, interrupt};

strainwave_controller::controller!(clock::F405, board::Board, board::start, interrupt TIM2, USART1, keys::receive, serial::send);
