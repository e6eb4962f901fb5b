//! MagnTek MT6835: absolute magnetic encoder, 21 bits a revolution, on SPI.
//!
//! ```text
//! sent      1010 0000 0000 0011  0 .. 0                                  burst read from register 0x003
//! received  (16 bits, undefined) a20 .. a0  under weak over  c7 .. c0    angle a, status, CRC c
//! ```
//!
//! 48 bits a frame, most significant first, SPI mode 3 (CPOL 1, CPHA 1), 16 MHz at most: 4.1 us for an angle, of which 1.1 us are
//! the pauses of the select. One transfer, which a DMA can do ([`crate::OneFrame`]).
//!
//! The CRC is that of x^8 + x^2 + x + 1, start value 0, over the 24 bits of angle and status. Status: supply too
//! low, field too weak, overspeed; any of them refuses the reading.
//!
//! A frame of zeros has the right CRC: a line stuck low would read as angle 0. The bandwidth register tells the two apart, which
//! [`Encoder::check`] has found to be neither all zeros nor all ones; a reading of exactly 0 takes a second frame of 24 bits.
//! [`crate::OneFrame::take`] cannot ask and refuses it: at 21 bits a moving motor meets it once in two million readings, and
//! one that rests on it is served by [`Encoder::count`].
//!
//! Reference: MagnTek MT6835 datasheet Rev. 1.3, sections "SPI interface" and "Register map"; delay 2 to 10 us at constant
//! speed. What noise leaves of the 21 bits depends on the bandwidth register and the magnet.

use crc::{CRC_8_SMBUS, Crc};
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{MODE_3, Mode, SpiDevice};

use crate::bus::{Bus, Pauses};
use crate::encoder::{Encoder, OneFrame, SpiEncoder};
use crate::fault::{Error, Fault};

/// Between two frames, and from select to the first clock edge.
const PAUSES: Pauses = Pauses { idle: 1000, setup: 100 };

/// x^8 + x^2 + x + 1 from 0, not reflected: the CRC-8 of the SMBus.
const CHECKSUM: Crc<u8> = Crc::<u8>::new(&CRC_8_SMBUS);

/// Reads the register whose lowest bits are the bandwidth, 0x011.
const READ_BANDWIDTH: [u8; 3] = [0x30, 0x11, 0x00];

/// The encoder on its bus.
#[derive(Debug)]
pub struct Mt6835<S, D>(Bus<S, D>);

impl<S: SpiDevice, D: DelayNs> Mt6835<S, D> {
    /// The encoder on a bus in its mode, no faster than its largest clock.
    pub const fn new(spi: S, delay: D) -> Self {
        Self(Bus::new(spi, delay))
    }

    /// The bus and the delay, given back.
    pub fn release(self) -> (S, D) {
        self.0.release()
    }

    /// Somebody drives the data line.
    fn answers(&mut self) -> Result<(), Error<S::Error>> {
        let mut frame = READ_BANDWIDTH;
        self.0.exchange(PAUSES, &mut frame)?;
        let [_, _, register] = frame;
        match register {
            0x00 => Err(Fault::StuckLow.into()),
            0xff => Err(Fault::StuckHigh.into()),
            _ => Ok(()),
        }
    }
}

impl<S: SpiDevice, D: DelayNs> Encoder for Mt6835<S, D> {
    const BITS: u32 = 21;
    /// At constant speed, 2 to 10 us.
    const LATENCY: f32 = 10e-6;
    type Bus = S::Error;

    fn check(&mut self) -> Result<(), Error<S::Error>> {
        self.answers()?;
        self.count().map(|_| ())
    }

    fn count(&mut self) -> Result<u32, Error<S::Error>> {
        let mut frame = Self::START;
        self.0.exchange(PAUSES, &mut frame)?;
        match Self::take(&frame) {
            Err(Fault::StuckLow) => self.answers().map(|()| 0),
            read => Ok(read?),
        }
    }
}

impl<S: SpiDevice, D: DelayNs> SpiEncoder for Mt6835<S, D> {
    const MODE: Mode = MODE_3;
    const FASTEST: u32 = 16_000_000;
    const READING_TIME: f32 = PAUSES.time(1, 48, Self::FASTEST);
}

impl<S: SpiDevice, D: DelayNs> OneFrame for Mt6835<S, D> {
    type Frame = [u8; 6];
    const START: [u8; 6] = [0xa0, 0x03, 0, 0, 0, 0];

    fn take(received: &[u8; 6]) -> Result<u32, Fault> {
        let [_, _, high, middle, low, checksum] = *received;
        match [high, middle, low, checksum] {
            [0, 0, 0, 0] => return Err(Fault::StuckLow),
            [0xff, 0xff, 0xff, 0xff] => return Err(Fault::StuckHigh),
            _ => {}
        }
        if CHECKSUM.checksum(&[high, middle, low]) != checksum {
            return Err(Fault::Checksum);
        }
        match low & 0b111 {
            0 => Ok(u32::from_be_bytes([0, high, middle, low]) >> 3),
            status if status & 0b100 != 0 => Err(Fault::Undervoltage),
            status if status & 0b010 != 0 => Err(Fault::FieldTooWeak),
            _ => Err(Fault::Overspeed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DeadBus, Delay, Echo, Spi, bus, done, flipped};
    use embedded_hal::spi::ErrorKind;
    use proptest::prelude::*;

    type Encoder21 = Mt6835<Spi, Delay>;

    fn take(received: [u8; 6]) -> Result<u32, Fault> {
        Encoder21::take(&received)
    }

    /// The frame of an angle with its status.
    fn frame(angle: u32, status: u32) -> [u8; 6] {
        let [_, high, middle, low] = (angle << 3 | status).to_be_bytes();
        // By division, bit by bit, as the datasheet draws it.
        let mut rest = (angle << 3 | status) << 8;
        for bit in (8..32).rev() {
            rest ^= if rest >> bit & 1 == 1 { 0x107 << (bit - 8) } else { 0 };
        }
        [0xff, 0xff, high, middle, low, rest as u8]
    }

    fn encoder(frames: &[(&[u8], &[u8])]) -> Encoder21 {
        let (spi, delay) = bus(PAUSES, frames);
        Mt6835::new(spi, delay)
    }

    const SENT: &[u8] = &[0xa0, 0x03, 0, 0, 0, 0];

    #[test]
    fn the_checksum_has_its_catalogued_check_value() {
        assert_eq!(CHECKSUM.checksum(b"123456789"), 0xf4);
    }

    #[test]
    fn an_angle_is_checked_and_unpacked() {
        assert_eq!(frame(0x12_3456, 0), [0xff, 0xff, 0x91, 0xa2, 0xb0, 0xe9]);
        let received = frame(0x12_3456, 0);
        let mut encoder = encoder(&[(SENT, &received)]);
        assert_eq!(encoder.count(), Ok(0x12_3456));
        done(encoder.release());
        for angle in [1, 0x1f_ffff, 0x10_0000] {
            assert_eq!(take(frame(angle, 0)), Ok(angle));
        }
    }

    #[test]
    fn each_status_bit_is_named() {
        for (status, fault) in
            [(0b001, Fault::Overspeed), (0b010, Fault::FieldTooWeak), (0b100, Fault::Undervoltage)]
        {
            assert_eq!(take(frame(77, status)), Err(fault));
        }
        assert_eq!(take(frame(77, 0b111)), Err(Fault::Undervoltage));
    }

    #[test]
    fn every_single_bit_error_is_caught() {
        for angle in (0..1 << 21).step_by(4099).chain([0, 1, 0x1f_ffff]) {
            for (bit, received) in flipped(frame(angle, 0)).enumerate() {
                // The first 16 bits are received while the command is sent: they mean nothing.
                if bit >= 16 {
                    assert_eq!(take(received), Err(Fault::Checksum), "angle {angle}, bit {bit}");
                }
            }
        }
    }

    #[test]
    fn a_line_that_is_stuck_is_no_angle() {
        assert_eq!(take([0; 6]), Err(Fault::StuckLow));
        assert_eq!(take([0xff; 6]), Err(Fault::StuckHigh));
        let mut low = encoder(&[(SENT, &[0; 6]), (&READ_BANDWIDTH, &[0; 3])]);
        assert_eq!(low.count(), Err(Error::Fault(Fault::StuckLow)));
        done(low.release());
        let mut zero = encoder(&[(SENT, &[0; 6]), (&READ_BANDWIDTH, &[0, 0, 0x05])]);
        assert_eq!(zero.count(), Ok(0));
        done(zero.release());
    }

    #[test]
    fn it_is_checked_before_it_is_used() {
        let received = frame(5, 0);
        let mut good = encoder(&[(&READ_BANDWIDTH, &[0xff, 0xff, 0x05]), (SENT, &received)]);
        assert_eq!(good.check(), Ok(()));
        done(good.release());
        let mut open = encoder(&[(&READ_BANDWIDTH, &[0xff; 3])]);
        assert_eq!(open.check(), Err(Error::Fault(Fault::StuckHigh)));
        done(open.release());
        assert_eq!(Mt6835::new(DeadBus, Delay::new()).check(), Err(Error::Bus(ErrorKind::Overrun)));
    }

    proptest! {
        #[test]
        fn any_bits_are_an_angle_or_refused(received: [u8; 6]) {
            let mut encoder = Mt6835::new(Echo(&received), Delay::new());
            prop_assert!(encoder.count().map_or(true, |count| count < 1 << 21));
            prop_assert!(take(received).map_or(true, |count| count < 1 << 21));
            let _ = encoder.check();
        }

        #[test]
        fn every_angle_survives_its_frame(angle in 1_u32..1 << 21) {
            prop_assert_eq!(take(frame(angle, 0)), Ok(angle));
        }
    }
}
