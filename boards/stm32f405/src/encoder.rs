//! The motor encoder on SPI1: scaled to the joint's resolution, with a memory for missed readings.

use core::sync::atomic::{AtomicBool, Ordering};
use embedded_hal::delay::DelayNs;
use embedded_hal_bus::spi::ExclusiveDevice;
use stm32f4xx_hal::gpio::{Output, PA5, PA6, PA7, PB6, Speed};
use stm32f4xx_hal::pac::SPI1;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use stm32f4xx_hal::time::Hertz;
use strainwave_drivers::as5047p::{As5047p, BITS, FASTEST, MODE};

use crate::clock::{FULL, INTERNAL, PERIPHERAL_DIVISOR};

/// SPI1's clock divider: 84 MHz / 16 = 5.25 MHz, 6 us for an angle.
const DIVIDER: u32 = 16;
const _: () = assert!(FULL / PERIPHERAL_DIVISOR / DIVIDER <= FASTEST);

/// Readings in a row that may fail while the last good one is used: 0.5 ms.
const PATIENCE: u32 = 5;

static LOST: AtomicBool = AtomicBool::new(false);

/// The encoder failed for longer than the control can do without it. Stays so until the next reset.
pub fn lost() -> bool {
    LOST.load(Ordering::Relaxed)
}

type Device = ExclusiveDevice<Spi<SPI1>, PB6<Output>, CycleDelay>;

/// The encoder and its last good reading.
pub struct MotorEncoder {
    encoder: As5047p<Device, CycleDelay>,
    /// Resolution that the control expects, 2^bits counts a revolution.
    bits: u32,
    count: u32,
    missed: u32,
}

impl MotorEncoder {
    /// The encoder, read in 2^bits counts a revolution, if it answers and its magnet is where it should be; else says what is
    /// wrong.
    pub fn new(spi: SPI1, pins: (PA5, PA6, PA7), select: PB6, bits: u32, rcc: &mut Rcc) -> Option<Self> {
        let select = select.into_push_pull_output_in_state(stm32f4xx_hal::gpio::PinState::High);
        let (clock, miso, mosi) = pins;
        let clock = clock.into_alternate().speed(Speed::High);
        // A line that nobody drives reads as an error, not as an angle of zero.
        let miso = miso.into_alternate().internal_pull_up(true);
        // The HAL assumes 16 MHz: this gives the right divider.
        let frequency = Hertz::from_raw(INTERNAL / DIVIDER);
        let bus = Spi::new(spi, (Some(clock), Some(miso), Some(mosi)), MODE, frequency, rcc);
        let device = ExclusiveDevice::new(bus, select, CycleDelay).ok()?;
        let mut encoder = As5047p::new(device, CycleDelay);
        match encoder.diagnosis() {
            Ok(diagnosis) if diagnosis.sound() => {
                let count = scaled(encoder.angle().ok()?, bits);
                return Some(Self { encoder, bits, count, missed: 0 });
            }
            Ok(diagnosis) => defmt::error!(
                "motor encoder: no sound angle (ready {=bool}, overflow {=bool}, field too high {=bool}, too low {=bool})",
                diagnosis.ready,
                diagnosis.overflow,
                diagnosis.field_too_high,
                diagnosis.field_too_low
            ),
            Err(_) => defmt::error!("motor encoder: no valid reply"),
        }
        None
    }

    /// The raw count within the revolution in the joint's resolution; `None` once the encoder is lost.
    pub fn count(&mut self) -> Option<u32> {
        if lost() {
            return None;
        }
        match self.encoder.angle() {
            Ok(angle) => {
                self.missed = 0;
                self.count = scaled(angle, self.bits);
            }
            Err(_) => self.missed += 1,
        }
        if self.missed > PATIENCE {
            LOST.store(true, Ordering::Relaxed);
            return None;
        }
        Some(self.count)
    }
}

/// From this encoder's resolution to one of 2^bits counts.
fn scaled(angle: u16, bits: u32) -> u32 {
    if bits >= BITS { u32::from(angle) << (bits - BITS) } else { u32::from(angle) >> (BITS - bits) }
}

/// Waits by counting cycles of the core at its full clock.
pub struct CycleDelay;

impl DelayNs for CycleDelay {
    fn delay_ns(&mut self, time: u32) {
        // Rounded up; a microsecond at a time, so that nothing overflows.
        const PER_MICROSECOND: u32 = FULL / 1_000_000;
        for _ in 0..time / 1000 {
            cortex_m::asm::delay(PER_MICROSECOND);
        }
        cortex_m::asm::delay(time % 1000 * PER_MICROSECOND / 1000 + 1);
    }
}
