//! What an encoder is to a board: a count within the revolution, or the reason why there is none.
//!
//! ```text
//! count = floor(angle * 2^BITS/(2*pi)),   0 <= count < 2^BITS
//! age of a count when it is used = LATENCY + time from the start of the reading on
//! ```
//!
//! [`Encoder::count`] waits for its bus. [`OneFrame`] is for readings that consist of one transfer: a board's DMA sends
//! [`OneFrame::START`] while something else is computed, and [`OneFrame::take`] judges what has come back. An encoder that needs two
//! selects for a reading has none: embedded-hal 1.0 has no DMA, and two transfers with a pause between them need a timer or an interrupt
//! of the board.
//!
//! [`Scaled`] brings a count to the resolution of the joint's gear file. There is no way up: shifted to more bits than it
//! has, an encoder's count steps by 2^n, which the observer's gains take for motion (14 bits read as 19 make the torque five times
//! noisier). Such a board does not compile.

use core::fmt;

use embedded_hal::spi::Mode;

use crate::fault::{Error, Fault};

/// An encoder.
pub trait Encoder {
    /// Resolution: 2^BITS counts a revolution, no more than its noise leaves.
    const BITS: u32;
    /// Age of the angle at the start of its reading, at constant speed (s): the larger value where the datasheet names a range.
    const LATENCY: f32;
    /// Error of the bus.
    type Bus: fmt::Debug;

    /// Once, before the drive is enabled: the encoder answers, is configured as assumed, and reports no fault.
    ///
    /// # Errors
    /// [`Error`], with what is wrong.
    fn check(&mut self) -> Result<(), Error<Self::Bus>>;

    /// The count within the revolution, 0 to 2^BITS - 1.
    ///
    /// # Errors
    /// [`Error`]; the next call starts afresh.
    fn count(&mut self) -> Result<u32, Error<Self::Bus>>;
}

/// An encoder on SPI.
pub trait SpiEncoder: Encoder {
    /// The bus mode that it needs.
    const MODE: Mode;
    /// The largest clock that it follows (Hz).
    const FASTEST: u32;
    /// Time of [`Encoder::count`] at that clock (s): bits and prescribed pauses, without the processor's own time.
    const READING_TIME: f32;
}

/// An encoder whose reading is one transfer, which a board's DMA can do.
pub trait OneFrame: SpiEncoder {
    /// The bytes of a transfer.
    type Frame: AsMut<[u8]> + Copy;
    /// What is sent.
    const START: Self::Frame;

    /// The count in what came back.
    ///
    /// # Errors
    /// [`Fault`].
    fn take(received: &Self::Frame) -> Result<u32, Fault>;
}

/// An encoder read in 2^BITS counts, the resolution of the joint's gear file.
///
/// ```
/// use strainwave_drivers::{Mt6835, Scaled};
/// # struct Device; struct Delay;
/// # impl embedded_hal::spi::ErrorType for Device { type Error = core::convert::Infallible; }
/// # impl embedded_hal::spi::SpiDevice for Device {
/// #     fn transaction(&mut self, _: &mut [embedded_hal::spi::Operation<'_, u8>]) -> Result<(), Self::Error> { Ok(()) }
/// # }
/// # impl embedded_hal::delay::DelayNs for Delay { fn delay_ns(&mut self, _: u32) {} }
/// let encoder = Scaled::<_, 19>::new(Mt6835::new(Device, Delay)); // 21 bits serve a joint of 19
/// ```
///
/// An encoder of fewer bits does not compile:
///
/// ```compile_fail,E0080
/// use strainwave_drivers::{As5047p, Scaled};
/// # struct Device; struct Delay;
/// # impl embedded_hal::spi::ErrorType for Device { type Error = core::convert::Infallible; }
/// # impl embedded_hal::spi::SpiDevice for Device {
/// #     fn transaction(&mut self, _: &mut [embedded_hal::spi::Operation<'_, u8>]) -> Result<(), Self::Error> { Ok(()) }
/// # }
/// # impl embedded_hal::delay::DelayNs for Delay { fn delay_ns(&mut self, _: u32) {} }
/// let encoder = Scaled::<_, 19>::new(As5047p::new(Device, Delay)); // 14 bits do not
/// ```
#[derive(Debug)]
pub struct Scaled<E, const BITS: u32> {
    encoder: E,
}

impl<E: Encoder, const BITS: u32> Scaled<E, BITS> {
    /// From this encoder's counts to one of 2^BITS.
    const SHIFT: u32 = {
        assert!(
            BITS <= E::BITS,
            "sensors.motor_encoder_bits of the joint's gear file is more than the board's encoder has"
        );
        E::BITS - BITS
    };

    /// The encoder; it has at least `BITS` bits, or this does not compile.
    pub const fn new(encoder: E) -> Self {
        let _ = Self::SHIFT;
        Self { encoder }
    }

    /// The encoder, given back.
    pub fn release(self) -> E {
        self.encoder
    }
}

impl<E: Encoder, const BITS: u32> Encoder for Scaled<E, BITS> {
    const BITS: u32 = BITS;
    const LATENCY: f32 = E::LATENCY;
    type Bus = E::Bus;

    fn check(&mut self) -> Result<(), Error<Self::Bus>> {
        self.encoder.check()
    }

    fn count(&mut self) -> Result<u32, Error<Self::Bus>> {
        Ok(self.encoder.count()? >> Self::SHIFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::convert::Infallible;

    struct Fixed(u32);

    impl Encoder for Fixed {
        const BITS: u32 = 21;
        const LATENCY: f32 = 10e-6;
        type Bus = Infallible;

        fn check(&mut self) -> Result<(), Error<Infallible>> {
            Err(Fault::NotReady.into())
        }

        fn count(&mut self) -> Result<u32, Error<Infallible>> {
            Ok(self.0)
        }
    }

    #[test]
    fn a_finer_encoder_is_rounded_down() {
        for (count, expected) in [(0, 0), (3, 0), (4, 1), (0x1f_ffff, 0x7_ffff), (0x10_0003, 0x4_0000)] {
            assert_eq!(Scaled::<_, 19>::new(Fixed(count)).count(), Ok(expected));
        }
        assert_eq!(Scaled::<_, 21>::new(Fixed(0x1f_ffff)).count(), Ok(0x1f_ffff));
    }

    #[test]
    fn what_the_encoder_says_is_passed_on() {
        let mut scaled = Scaled::<_, 19>::new(Fixed(0));
        assert_eq!(scaled.check(), Err(Error::Fault(Fault::NotReady)));
        assert_eq!(<Scaled<Fixed, 19> as Encoder>::LATENCY, 10e-6);
        assert_eq!(scaled.release().0, 0);
    }
}
