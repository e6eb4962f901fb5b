//! The motor encoder on SPI1, read in the joint's resolution.
//!
//! For another one put its driver for [`Part`], with a divider that its largest clock allows. One with fewer bits than the joint's
//! gear file asks for does not compile.

use core::sync::atomic::{AtomicBool, Ordering};
use embedded_hal::delay::DelayNs;
use embedded_hal_bus::spi::ExclusiveDevice;
use stm32f4xx_hal::gpio::{Output, PA5, PA6, PA7, PB6, Speed};
use stm32f4xx_hal::pac::SPI1;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::spi::Spi;
use stm32f4xx_hal::time::Hertz;
use strainwave_app::motor_encoder_bits;
use strainwave_drivers::{Encoder, Mt6835, Scaled, SpiEncoder};

use crate::clock::{FULL, INTERNAL, PERIPHERAL_DIVISOR};

/// SPI1's clock divider: 84 MHz / 8 = 10.5 MHz, 6 us for an angle with its pauses.
const DIVIDER: u32 = 8;
const _: () = assert!(FULL / PERIPHERAL_DIVISOR / DIVIDER <= Part::FASTEST);

/// Those of the joint.
const BITS: u32 = motor_encoder_bits();

/// Readings in a row after which the compensator has given the angle up: 2 ms.
const PATIENCE: u32 = 20;

static LOST: AtomicBool = AtomicBool::new(false);

/// The encoder failed for longer than the control can do without it. Stays so until the next reset.
pub fn lost() -> bool {
    LOST.load(Ordering::Relaxed)
}

type Device = ExclusiveDevice<Spi<SPI1>, PB6<Output>, CycleDelay>;

/// The encoder on the board.
type Part = Mt6835<Device, CycleDelay>;

/// The encoder in the joint's resolution.
pub struct MotorEncoder {
    encoder: Scaled<Part, BITS>,
    missed: u32,
}

impl MotorEncoder {
    /// The encoder, if it answers and its magnet is where it should be; else says what is wrong.
    pub fn new(spi: SPI1, pins: (PA5, PA6, PA7), select: PB6, rcc: &mut Rcc) -> Option<Self> {
        let select = select.into_push_pull_output_in_state(stm32f4xx_hal::gpio::PinState::High);
        let (clock, miso, mosi) = pins;
        let clock = clock.into_alternate().speed(Speed::High);
        // A line that nobody drives reads as ones, not as an angle of zero.
        let miso = miso.into_alternate().internal_pull_up(true);
        // The HAL assumes 16 MHz: this gives the right divider.
        let frequency = Hertz::from_raw(INTERNAL / DIVIDER);
        let bus = Spi::new(spi, (Some(clock), Some(miso), Some(mosi)), Part::MODE, frequency, rcc);
        let device = ExclusiveDevice::new(bus, select, CycleDelay).ok()?;
        Self::checked(Scaled::new(Part::new(device, CycleDelay)))
    }

    // Not inlined: its stack is not the idle loop's.
    #[inline(never)]
    fn checked(mut encoder: Scaled<Part, BITS>) -> Option<Self> {
        match encoder.check() {
            Ok(()) => Some(Self { encoder, missed: 0 }),
            Err(error) => {
                defmt::error!("motor encoder: {=str}", error.reason());
                None
            }
        }
    }

    /// The count within the revolution; `None` when there is no valid reading.
    pub fn count(&mut self) -> Option<u32> {
        let count = self.encoder.count().ok();
        self.missed = if count.is_some() { 0 } else { self.missed.saturating_add(1) };
        if self.missed >= PATIENCE {
            LOST.store(true, Ordering::Relaxed);
        }
        count
    }
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
