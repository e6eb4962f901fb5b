//! An incremental encoder with two channels, counted by a timer of the chip.
//!
//! ```text
//! position = (position + (n - n_last)) mod COUNTS          n the timer's count, 16 or 32 bits, which wraps
//! count    = floor(position * 2^BITS/COUNTS),   BITS = floor(log2(COUNTS))
//! ```
//!
//! COUNTS is the number of edges of both channels in a revolution, four times the lines: 10 000 of an encoder of 2500 lines, which
//! serve a joint of 13 bits. A timer that counts the edges in its encoder mode needs no bus and no DMA: reading its register
//! takes nanoseconds, and the count is that of the moment, but for the input filter. More than a revolution, or half of what a timer of 16 bits
//! holds, between two readings cannot be told from less: the former is refused.
//!
//! The position begins where the timer is at the first reading, and is 0 where [`Quadrature::index`] was first called: with what the
//! timer has latched at the index pulse. From then on every index has to be at 0, or counts were lost or gained; the phase of the stored
//! kinematic error is as good as that zero is the one of its identification. [`Encoder::check`] asks for the index: turn the motor once.
//!
//! The division is a multiplication by 2^(42+BITS)/COUNTS, rounded up: exact for every count up to 2^20, for 2*20 < 42.

use core::convert::Infallible;

use crate::encoder::Encoder;
use crate::fault::{Error, Fault};

/// The register of a timer.
pub trait TimerCount: Copy {
    /// Counts since an earlier value, the shorter way round.
    fn since(self, earlier: Self) -> i32;
}

impl TimerCount for u16 {
    fn since(self, earlier: Self) -> i32 {
        self.wrapping_sub(earlier).cast_signed().into()
    }
}

impl TimerCount for u32 {
    fn since(self, earlier: Self) -> i32 {
        self.wrapping_sub(earlier).cast_signed()
    }
}

/// An encoder of `COUNTS` counts a revolution, on a timer that `read` reads.
#[derive(Debug)]
pub struct Quadrature<F, T, const COUNTS: u32> {
    read: F,
    last: T,
    /// 0 to COUNTS - 1.
    position: u32,
    /// The index was passed.
    referenced: bool,
}

impl<F: FnMut() -> T, T: TimerCount, const COUNTS: u32> Quadrature<F, T, COUNTS> {
    const BITS: u32 = {
        assert!(COUNTS >= 1 << 10 && COUNTS <= 1 << 20, "quadrature: 2^10 to 2^20 counts a revolution");
        COUNTS.ilog2()
    };
    const SHIFT: u32 = 42;
    const FACTOR: u64 = (1_u64 << (Self::SHIFT + Self::BITS)).div_ceil(COUNTS as u64);

    /// The encoder, at 0 where it is now.
    pub fn new(mut read: F) -> Self {
        let last = read();
        Self { read, last, position: 0, referenced: false }
    }

    /// At an index pulse, with what the timer held then: the first is the zero, every other one has to be there.
    ///
    /// # Errors
    /// [`Fault::LostCounts`]: this index is somewhere else; it becomes the zero. [`Fault::Overspeed`].
    pub fn index(&mut self, latched: T) -> Result<(), Fault> {
        let at_index = self.moved(latched.since(self.last))?;
        self.position = difference(self.position, at_index, COUNTS);
        let expected = !self.referenced || at_index == 0;
        self.referenced = true;
        if expected { Ok(()) } else { Err(Fault::LostCounts) }
    }

    /// The position after this many counts.
    fn moved(&self, counts: i32) -> Result<u32, Fault> {
        let distance = counts.unsigned_abs();
        if distance >= COUNTS {
            return Err(Fault::Overspeed);
        }
        let forwards = if counts < 0 { COUNTS - distance } else { distance };
        let backwards = if forwards == 0 { 0 } else { COUNTS - forwards };
        Ok(difference(self.position, backwards, COUNTS))
    }
}

/// (a - b) mod `counts`, for a and b below it.
const fn difference(a: u32, b: u32, counts: u32) -> u32 {
    if a >= b { a - b } else { a + (counts - b) }
}

impl<F: FnMut() -> T, T: TimerCount, const COUNTS: u32> Encoder for Quadrature<F, T, COUNTS> {
    const BITS: u32 = Self::BITS;
    const LATENCY: f32 = 0.0;
    type Bus = Infallible;

    fn check(&mut self) -> Result<(), Error<Infallible>> {
        self.count()?;
        if self.referenced { Ok(()) } else { Err(Fault::NotReady.into()) }
    }

    fn count(&mut self) -> Result<u32, Error<Infallible>> {
        let now = (self.read)();
        let moved = self.moved(now.since(self.last));
        self.last = now;
        self.position = moved?;
        Ok(((u64::from(self.position) * Self::FACTOR) >> Self::SHIFT) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::Cell;
    use proptest::prelude::*;

    fn scaled<const COUNTS: u32>() {
        let timer = Cell::new(0_u32);
        let mut encoder = Quadrature::<_, _, COUNTS>::new(|| timer.get());
        for position in 0..COUNTS {
            timer.set(position);
            let exact = (u64::from(position) << COUNTS.ilog2()) / u64::from(COUNTS);
            assert_eq!(encoder.count(), Ok(exact as u32), "{position} of {COUNTS}");
        }
    }

    #[test]
    fn every_count_is_scaled_exactly() {
        scaled::<1024>();
        scaled::<10_000>();
        scaled::<16_383>();
        scaled::<65_536>();
        scaled::<1_000_000>();
        scaled::<1_048_575>();
        scaled::<1_048_576>();
    }

    #[test]
    fn a_timer_of_16_bits_wraps_unnoticed_in_both_directions() {
        let timer = Cell::new(65_000_u16);
        let mut encoder = Quadrature::<_, _, 10_000>::new(|| timer.get());
        let mut position = 0_i32;
        for step in [900, 900, -2500, -30, 9999, -9999, 1] {
            timer.set(timer.get().wrapping_add_signed(step));
            position = (position + i32::from(step)).rem_euclid(10_000);
            assert_eq!(encoder.count(), Ok((position as u32 * 8192) / 10_000));
        }
    }

    #[test]
    fn more_than_a_revolution_between_readings_is_refused() {
        let timer = Cell::new(0_u32);
        let mut encoder = Quadrature::<_, _, 10_000>::new(|| timer.get());
        timer.set(10_000);
        assert_eq!(encoder.count(), Err(Error::Fault(Fault::Overspeed)));
        assert_eq!(encoder.count(), Ok(0));
    }

    #[test]
    fn the_index_is_the_zero_and_tells_lost_counts() {
        let timer = Cell::new(500_u32);
        let mut encoder = Quadrature::<_, _, 8192>::new(|| timer.get());
        assert_eq!(encoder.check(), Err(Error::Fault(Fault::NotReady)));
        timer.set(800);
        assert_eq!(encoder.count(), Ok(300));
        assert_eq!(encoder.index(790), Ok(()));
        assert_eq!(encoder.count(), Ok(10));
        assert_eq!(encoder.check(), Ok(()));
        // A revolution on, and one back.
        timer.set(790 + 8191);
        assert_eq!(encoder.count(), Ok(8191));
        assert_eq!(encoder.index(790 + 8192), Ok(()));
        assert_eq!(encoder.index(790 + 8192 - 3), Err(Fault::LostCounts));
        assert_eq!(encoder.index(790 + 8192 - 3), Ok(()));
        assert_eq!(encoder.count(), Ok(2));
        assert_eq!(encoder.index(790 + 3 * 8192), Err(Fault::Overspeed));
    }

    proptest! {
        #[test]
        fn any_counts_are_a_position_or_refused(steps: [u32; 8], latched: u32) {
            let timer = Cell::new(0_u32);
            let mut encoder = Quadrature::<_, _, 10_000>::new(|| timer.get());
            for step in steps {
                timer.set(step);
                prop_assert!(encoder.count().map_or(true, |count| count < 1 << 13));
                let _ = encoder.index(latched);
            }
        }
    }
}
