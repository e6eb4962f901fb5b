//! MPS MA732: absolute magnetic encoder, 9 to 14 bits a revolution by its filter, on SPI.
//!
//! ```text
//! sent      010 a4 .. a0 0 .. 0    read register a        0 .. 0
//! received  angle of 16 bits                              register of 8 bits, 0 .. 0
//! ```
//!
//! 16 bits a frame, most significant first, SPI mode 3 (CPOL 1, CPHA 1; mode 0 works, too), 25 MHz at most. The angle comes with the
//! first frame, the register with the second, at least 750 ns later. Read with it is register 27, which tells whether the field is within the
//! thresholds of register 6: 2.9 us for both at 25 MHz, of which 1.7 us are the pauses. Two selects are no single transfer, so that
//! there is no [`crate::OneFrame`].
//!
//! There is no parity and no CRC in the angle. What is refused: a status that reports the field, that is of ones, or that
//! is not followed by 8 zeros. Angle and status of zeros are valid: a line stuck low would read as angle 0. The filter register tells the
//! two apart, which never is 0; a reading of exactly 0 therefore takes twice the time. A disturbed bit of the angle is left to
//! the compensator, which accepts only what the motor can reach: keep the wires short.
//!
//! The filter register FW sets noise against bandwidth. The datasheet's resolution r is that of six standard deviations of noise,
//! sigma = 2*pi/2^r/6. An ideal encoder of b bits has 2*pi/2^b/sqrt(12): the noise leaves b = r + log2(6/sqrt(12)) = r + 0.79 bits.
//!
//! | FW | 51 | 68 | 85 | 102 | 119 (as delivered) | 136 | 153 | 170 | 187 |
//! | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
//! | r at 45 mT | 9.5 | 10 | 10.5 | 11 | 11.5 | 12 | 12.5 | 13 | 13.5 |
//! | bandwidth (Hz) | 6000 | 3000 | 1500 | 740 | 370 | 185 | 93 | 46 | 23 |
//! | bits | 10 | 10 | 11 | 11 | 12 | 12 | 13 | 13 | 14 |
//!
//! Reference: MPS MA732 datasheet Rev. 1.0, sections "SPI", "Register map" and "Digital filter"; delay 10 us at constant speed.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{MODE_3, Mode, SpiDevice};

use crate::bus::{Bus, Pauses};
use crate::encoder::{Encoder, SpiEncoder};
use crate::fault::{Error, Fault};

/// Between the command and the register's frame (750), and from select to the first clock edge (80).
const PAUSES: Pauses = Pauses { idle: 750, setup: 80 };

/// FW, the filter, and MGH, MGL: the field is beyond its thresholds.
const FILTER_REGISTER: u8 = 14;
const STATUS_REGISTER: u8 = 27;

/// FW as delivered.
pub const DELIVERED: u8 = 119;

/// The encoder on its bus; its register FW is `FILTER`.
#[derive(Debug)]
pub struct Ma732<S, D, const FILTER: u8 = DELIVERED>(Bus<S, D>);

impl<S: SpiDevice, D: DelayNs, const FILTER: u8> Ma732<S, D, FILTER> {
    /// The encoder on a bus in its mode, no faster than its largest clock.
    pub const fn new(spi: S, delay: D) -> Self {
        let _ = <Self as Encoder>::BITS;
        Self(Bus::new(spi, delay))
    }

    /// The bus and the delay, given back.
    pub fn release(self) -> (S, D) {
        self.0.release()
    }

    /// The angle of 16 bits, and with it a register.
    fn read(&mut self, register: u8) -> Result<(u16, u8), Error<S::Error>> {
        let angle = self.exchange([0b010 << 5 | register, 0])?;
        match self.exchange([0, 0])? {
            [0xff, 0xff] => Err(Fault::StuckHigh.into()),
            [value, 0] => Ok((u16::from_be_bytes(angle), value)),
            _ => Err(Fault::Framing.into()),
        }
    }

    fn exchange(&mut self, mut frame: [u8; 2]) -> Result<[u8; 2], Error<S::Error>> {
        self.0.exchange(PAUSES, &mut frame)?;
        Ok(frame)
    }

    /// Somebody drives the data line, and the filter is as assumed.
    fn filter(&mut self) -> Result<(), Error<S::Error>> {
        match self.read(FILTER_REGISTER)?.1 {
            0 => Err(Fault::StuckLow.into()),
            filter if filter == FILTER => Ok(()),
            _ => Err(Fault::Configuration.into()),
        }
    }
}

impl<S: SpiDevice, D: DelayNs, const FILTER: u8> Encoder for Ma732<S, D, FILTER> {
    const BITS: u32 = match FILTER {
        51 | 68 => 10,
        85 | 102 => 11,
        119 | 136 => 12,
        153 | 170 => 13,
        187 => 14,
        _ => panic!("MA732: FW is one of 51, 68, 85, 102, 119, 136, 153, 170, 187"),
    };
    /// At constant speed.
    const LATENCY: f32 = 10e-6;
    type Bus = S::Error;

    fn check(&mut self) -> Result<(), Error<S::Error>> {
        self.filter()?;
        self.count().map(|_| ())
    }

    fn count(&mut self) -> Result<u32, Error<S::Error>> {
        let (angle, status) = self.read(STATUS_REGISTER)?;
        if status & 0x80 != 0 {
            return Err(Fault::FieldTooStrong.into());
        }
        if status & 0x40 != 0 {
            return Err(Fault::FieldTooWeak.into());
        }
        if angle == 0 && status == 0 {
            self.filter()?;
        }
        Ok(u32::from(angle) >> (u16::BITS - <Self as Encoder>::BITS))
    }
}

impl<S: SpiDevice, D: DelayNs, const FILTER: u8> SpiEncoder for Ma732<S, D, FILTER> {
    const MODE: Mode = MODE_3;
    const FASTEST: u32 = 25_000_000;
    const READING_TIME: f32 = PAUSES.time(2, 16, Self::FASTEST);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DeadBus, Delay, Echo, Spi, bus, done};
    use embedded_hal::spi::ErrorKind;
    use proptest::prelude::*;

    /// As delivered.
    fn encoder(frames: &[([u8; 2], [u8; 2])]) -> Ma732<Spi, Delay> {
        let (spi, delay) = bus(PAUSES, frames);
        Ma732::new(spi, delay)
    }

    fn read_once(frames: &[([u8; 2], [u8; 2])]) -> Result<u32, Error<ErrorKind>> {
        let mut encoder = encoder(frames);
        let read = encoder.count();
        done(encoder.release());
        read
    }

    const STATUS: [u8; 2] = [0x5b, 0x00];
    const FILTER: [u8; 2] = [0x4e, 0x00];
    const NOTHING: [u8; 2] = [0x00, 0x00];

    #[test]
    fn an_angle_comes_with_its_status() {
        assert_eq!(read_once(&[(STATUS, [0x9a, 0xbc]), (NOTHING, [0x00, 0x00])]), Ok(0x9ab));
        assert_eq!(read_once(&[(STATUS, [0xff, 0xff]), (NOTHING, [0x00, 0x00])]), Ok(0xfff));
    }

    #[test]
    fn the_filter_sets_the_bits() {
        let (spi, delay) = bus(PAUSES, &[(STATUS, [0x9a, 0xbc]), (NOTHING, [0x00, 0x00])]);
        let mut slow = Ma732::<_, _, 187>::new(spi, delay);
        assert_eq!(slow.count(), Ok(0x9abc >> 2));
        done(slow.release());
        let bits = [
            <Ma732<Spi, Delay, 51> as Encoder>::BITS,
            <Ma732<Spi, Delay, 102> as Encoder>::BITS,
            <Ma732<Spi, Delay, 119> as Encoder>::BITS,
            <Ma732<Spi, Delay, 170> as Encoder>::BITS,
            <Ma732<Spi, Delay, 187> as Encoder>::BITS,
        ];
        let resolution = [9.5, 11.0, 11.5, 13.0, 13.5];
        assert_eq!(bits, resolution.map(|r: f64| (r + (6.0 / 12_f64.sqrt()).log2()) as u32));
    }

    #[test]
    fn the_field_is_named() {
        let read = |status| read_once(&[(STATUS, [0x9a, 0xbc]), (NOTHING, [status, 0x00])]);
        assert_eq!(read(0x80), Err(Error::Fault(Fault::FieldTooStrong)));
        assert_eq!(read(0x40), Err(Error::Fault(Fault::FieldTooWeak)));
    }

    #[test]
    fn a_line_that_is_stuck_is_no_angle() {
        let high = [(STATUS, [0xff, 0xff]), (NOTHING, [0xff, 0xff])];
        assert_eq!(read_once(&high), Err(Error::Fault(Fault::StuckHigh)));
        let zero = [(STATUS, [0, 0]), (NOTHING, [0, 0]), (FILTER, [0, 0])];
        let low = [zero.as_slice(), &[(NOTHING, [0, 0])]].concat();
        assert_eq!(read_once(&low), Err(Error::Fault(Fault::StuckLow)));
        let working = [zero.as_slice(), &[(NOTHING, [119, 0])]].concat();
        assert_eq!(read_once(&working), Ok(0));
        let shifted = [(STATUS, [0x9a, 0xbc]), (NOTHING, [0x00, 0x80])];
        assert_eq!(read_once(&shifted), Err(Error::Fault(Fault::Framing)));
    }

    #[test]
    fn another_filter_is_named_before_it_is_used() {
        let mut other = encoder(&[(FILTER, [0x12, 0x34]), (NOTHING, [187, 0])]);
        assert_eq!(other.check(), Err(Error::Fault(Fault::Configuration)));
        done(other.release());
        let filter = [(FILTER, [0x12, 0x34]), (NOTHING, [119, 0])];
        let angle = [(STATUS, [0x12, 0x34]), (NOTHING, [0, 0])];
        let mut sound = encoder(&[filter, angle].concat());
        assert_eq!(sound.check(), Ok(()));
        done(sound.release());
        let dead = Ma732::<_, _, 119>::new(DeadBus, Delay::new()).count();
        assert_eq!(dead, Err(Error::Bus(ErrorKind::Overrun)));
    }

    proptest! {
        #[test]
        fn any_bits_are_an_angle_or_refused(reply: [u8; 2]) {
            let mut encoder = Ma732::<_, _, 119>::new(Echo(&reply), Delay::new());
            prop_assert!(encoder.count().map_or(true, |count| count < 1 << 12));
            let _ = encoder.check();
        }
    }
}
