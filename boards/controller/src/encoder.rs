//! The motor encoder, read in the joint's resolution.
//!
//! For another one put its driver for [`Part`]; a board's bus has to have a clock that it follows. One with fewer bits than the
//! joint's gear file asks for does not compile.

use core::sync::atomic::{AtomicBool, Ordering};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiBus;
use embedded_hal_bus::spi::ExclusiveDevice;
use strainwave_app::motor_encoder_bits;
use strainwave_drivers::{Encoder, Mt6835, Scaled};

use crate::{Chip, CycleDelay};

/// The encoder on an SPI bus of a chip, with its select.
pub type Part<C, B, S> = Mt6835<ExclusiveDevice<B, S, CycleDelay<C>>, CycleDelay<C>>;

/// Those of the joint.
const BITS: u32 = motor_encoder_bits();

/// Readings in a row after which the compensator has given the angle up: 2 ms.
const PATIENCE: u32 = 20;

static LOST: AtomicBool = AtomicBool::new(false);

/// The encoder failed for longer than the control can do without it. Stays so until the next reset.
pub fn lost() -> bool {
    LOST.load(Ordering::Relaxed)
}

/// The encoder in the joint's resolution.
pub struct MotorEncoder<E> {
    encoder: Scaled<E, BITS>,
    missed: u32,
}

impl<C: Chip, B: SpiBus, S: OutputPin> MotorEncoder<Part<C, B, S>> {
    /// The encoder on a bus, if it answers and its magnet is where it should be; else says what is wrong.
    pub fn on(bus: B, select: S) -> Option<Self> {
        let device = ExclusiveDevice::new(bus, select, CycleDelay::new()).ok()?;
        Self::checked(Mt6835::new(device, CycleDelay::new()))
    }
}

impl<E: Encoder> MotorEncoder<E> {
    /// The encoder, if it answers and its magnet is where it should be; else says what is wrong.
    // Not inlined: its stack is not the idle loop's.
    #[inline(never)]
    fn checked(encoder: E) -> Option<Self> {
        let mut encoder = Scaled::new(encoder);
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
