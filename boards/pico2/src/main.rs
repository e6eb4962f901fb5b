//! The joint controller on a Raspberry Pi Pico 2, an RP2350 with one of its two Cortex-M33 at 150 MHz. Wiring only.
//!
//! | pin | on the board | function |
//! | --- | --- | --- |
//! | GP18, GP16, GP19, GP17 | 24, 21, 25, 22 | motor encoder MT6835: SPI0 clock, MISO, MOSI, select |
//! | GP15 | 20 | torque command to the motor's drive: PWM of 36.6 kHz for a low-pass filter; its mean is 0..3.3 V, 1.65 V is none, the rails are the peak torque |
//! | GP14 | 19 | drive enable, high while the joint is controlled; pull it down outside |
//! | GP0, GP1 | 1, 2 | UART0, 921600 Bd: telemetry (defmt) out, operator's keys in |
//!
//! The encoder's count has to grow with a positive torque command. The drive has a current loop of
//! its own, so the motor's torque is taken to be the last command. The joint holds the position in which it
//! starts; `+` and `-` on the UART move its target by 10 mrad at the output, `0` moves it back.
#![no_std]
#![no_main]

mod board;
mod boot;
mod chip;
mod clock;
mod drive;
mod encoder;
mod keys;
mod pins;
mod serial;
mod spi;
mod timer;
mod watchdog;

use cortex_m_rt::exception;
use rp235x_pac::{Interrupt, interrupt};

strainwave_controller::controller!(
    chip::Rp2350,
    board::Board,
    board::start,
    exception SysTick,
    UART0_IRQ,
    keys::receive,
    serial::send
);
