//! ams AS5047P: absolute magnetic encoder, 14 bits a revolution, on SPI.
//!
//! ```text
//! command  P R a13 .. a0     P even parity of the other 15 bits, R = 1 reads, address a
//! reply    P E d13 .. d0     E = 1: the encoder refused an earlier command, data d
//! ```
//!
//! 16 bits a frame, most significant first, SPI mode 1 (CPOL 0, CPHA 1), 10 MHz at most; the reply to
//! a command arrives with the next frame. An angle therefore takes two frames: the second carries no
//! command, so that the angle is not one control period old. That is 4.8 us at 10 MHz, of which 1.6 us are the pauses before and
//! after each select. Two selects are no single transfer, so that there is no [`crate::OneFrame`].
//!
//! The angle is DAEC-compensated (register ANGLECOM), in counts of 2*pi/2^14 = 383 urad; it grows when
//! the magnet turns clockwise seen from above (its DIR setting as delivered).
//!
//! Refused: odd parity, the error flag (its reasons are read, which clears them), a reply of ones. A
//! reply of all zeros is valid by parity: a line stuck low would read as angle 0. Register DIAAGC tells the two apart, because a
//! working encoder always has its loop-finished bit set; a reading of exactly 0 therefore takes twice the time.
//!
//! Reference: ams AS5047P datasheet v1-10, sections "SPI interface", "Volatile registers" and "Timing characteristics".

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{MODE_1, Mode, SpiDevice};

use crate::bus::{Bus, Pauses};
use crate::encoder::{Encoder, SpiEncoder};
use crate::fault::{Error, Fault};

/// Between two frames, and from select to the first clock edge (t_CSn and t_L, at least 350).
const PAUSES: Pauses = Pauses { idle: 400, setup: 400 };

const NO_OPERATION: u16 = 0x0000;
const ERRORS: u16 = 0x0001;
const DIAGNOSIS: u16 = 0x3ffc;
const ANGLE: u16 = 0x3fff;

const READ: u16 = 1 << 14;
const ERROR_FLAG: u16 = 1 << 14;
const DATA: u16 = ERROR_FLAG - 1;

/// State of the magnet and the encoder (register DIAAGC).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Diagnosis {
    /// Gain that the field needs, 0 (strong) to 255 (weak).
    pub gain: u8,
    /// The offset loop has finished: angles are valid.
    pub ready: bool,
    /// The angle computation overflowed: angles are invalid.
    pub overflow: bool,
    /// The field is too strong.
    pub field_too_high: bool,
    /// The field is too weak, or the magnet is missing.
    pub field_too_low: bool,
}

impl Diagnosis {
    const fn of(register: u16) -> Self {
        Self {
            gain: register as u8,
            ready: bit(register, 8),
            overflow: bit(register, 9),
            field_too_high: bit(register, 10),
            field_too_low: bit(register, 11),
        }
    }

    /// Angles can be trusted.
    ///
    /// # Errors
    /// What stands against it.
    pub const fn sound(self) -> Result<(), Fault> {
        match self {
            Self { ready: false, .. } => Err(Fault::NotReady),
            Self { overflow: true, .. } => Err(Fault::InvalidAngle),
            Self { field_too_high: true, .. } => Err(Fault::FieldTooStrong),
            Self { field_too_low: true, .. } => Err(Fault::FieldTooWeak),
            _ => Ok(()),
        }
    }
}

/// The encoder on its bus.
#[derive(Debug)]
pub struct As5047p<S, D>(Bus<S, D>);

impl<S: SpiDevice, D: DelayNs> As5047p<S, D> {
    /// The encoder on a bus in its mode, no faster than its largest clock.
    pub const fn new(spi: S, delay: D) -> Self {
        Self(Bus::new(spi, delay))
    }

    /// Diagnostics of the encoder and its magnet.
    ///
    /// # Errors
    /// [`Error`].
    pub fn diagnosis(&mut self) -> Result<Diagnosis, Error<S::Error>> {
        Ok(Diagnosis::of(self.read(DIAGNOSIS)?))
    }

    /// The bus and the delay, given back.
    pub fn release(self) -> (S, D) {
        self.0.release()
    }

    fn read(&mut self, register: u16) -> Result<u16, Error<S::Error>> {
        let reply = self.exchange_twice(register)?;
        if reply & ERROR_FLAG != 0 {
            return Err(self.refusal()?.into());
        }
        Ok(reply & DATA)
    }

    /// Why a command was refused (register ERRFL). Reading it clears it.
    fn refusal(&mut self) -> Result<Fault, Error<S::Error>> {
        let reasons = self.exchange_twice(ERRORS)?;
        Ok(match reasons {
            _ if bit(reasons, 0) => Fault::CommandFraming,
            _ if bit(reasons, 1) => Fault::InvalidCommand,
            _ if bit(reasons, 2) => Fault::CommandParity,
            _ => Fault::EncoderError,
        })
    }

    /// The reply to the command that reads `register`.
    fn exchange_twice(&mut self, register: u16) -> Result<u16, Error<S::Error>> {
        self.exchange(command(register))?;
        let reply = self.exchange(command(NO_OPERATION))?;
        if reply == u16::MAX {
            return Err(Fault::StuckHigh.into());
        }
        if odd_parity(reply) {
            return Err(Fault::Parity.into());
        }
        Ok(reply)
    }

    fn exchange(&mut self, frame: u16) -> Result<u16, Error<S::Error>> {
        let mut bytes = frame.to_be_bytes();
        self.0.exchange(PAUSES, &mut bytes)?;
        Ok(u16::from_be_bytes(bytes))
    }
}

impl<S: SpiDevice, D: DelayNs> Encoder for As5047p<S, D> {
    const BITS: u32 = 14;
    /// Residual delay after the compensation, 1.5 to 1.9 us.
    const LATENCY: f32 = 1.9e-6;
    type Bus = S::Error;

    fn check(&mut self) -> Result<(), Error<S::Error>> {
        // The first read also clears what was refused before the bus was set up.
        let _ = self.refusal()?;
        Ok(self.diagnosis()?.sound()?)
    }

    fn count(&mut self) -> Result<u32, Error<S::Error>> {
        let angle = self.read(ANGLE)?;
        if angle == 0 && !self.diagnosis()?.ready {
            return Err(Fault::StuckLow.into());
        }
        Ok(angle.into())
    }
}

impl<S: SpiDevice, D: DelayNs> SpiEncoder for As5047p<S, D> {
    const MODE: Mode = MODE_1;
    const FASTEST: u32 = 10_000_000;
    const READING_TIME: f32 = PAUSES.time(2, 16, Self::FASTEST);
}

/// The frame that reads a register.
const fn command(register: u16) -> u16 {
    let frame = if register == NO_OPERATION { NO_OPERATION } else { READ | register };
    if odd_parity(frame) { frame | 1 << 15 } else { frame }
}

const fn odd_parity(frame: u16) -> bool {
    frame.count_ones() % 2 == 1
}

const fn bit(register: u16, position: u32) -> bool {
    register >> position & 1 != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DeadBus, Delay, Echo, Spi, bus, done, flipped};
    use embedded_hal::spi::ErrorKind;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn encoder(frames: &[(u16, u16)]) -> As5047p<Spi, Delay> {
        let bytes: Vec<_> =
            frames.iter().map(|(sent, received)| (sent.to_be_bytes(), received.to_be_bytes())).collect();
        let (spi, delay) = bus(PAUSES, &bytes);
        As5047p::new(spi, delay)
    }

    #[test]
    fn commands_are_those_of_the_datasheet() {
        assert_eq!(command(ANGLE), 0xffff);
        assert_eq!(command(ERRORS), 0x4001);
        assert_eq!(command(DIAGNOSIS), 0xfffc);
        assert_eq!(command(NO_OPERATION), 0x0000);
    }

    #[test]
    fn an_angle_is_the_data_of_the_second_frame() {
        // 0x1234 has five ones: its parity bit is set.
        let mut encoder = encoder(&[(0xffff, 0x0000), (0x0000, 0x9234), (0xffff, 0x0000), (0x0000, 0x3fff)]);
        assert_eq!(encoder.count(), Ok(0x1234));
        assert_eq!(encoder.count(), Ok(0x3fff));
        done(encoder.release());
    }

    #[test]
    fn every_single_bit_error_is_caught() {
        for reply in flipped(0x9234_u16.to_be_bytes()) {
            let mut encoder = encoder(&[(0xffff, 0x0000), (0x0000, u16::from_be_bytes(reply))]);
            assert_eq!(encoder.count(), Err(Error::Fault(Fault::Parity)), "{reply:x?}");
            done(encoder.release());
        }
    }

    #[test]
    fn a_line_that_is_stuck_is_no_angle() {
        let mut high = encoder(&[(0xffff, 0xffff), (0x0000, 0xffff)]);
        assert_eq!(high.count(), Err(Error::Fault(Fault::StuckHigh)));
        done(high.release());
        let mut low = encoder(&[(0xffff, 0), (0, 0), (0xfffc, 0), (0, 0)]);
        assert_eq!(low.count(), Err(Error::Fault(Fault::StuckLow)));
        done(low.release());
        // A working encoder at angle 0: gain 0x80 and ready.
        let mut zero = encoder(&[(0xffff, 0), (0, 0), (0xfffc, 0), (0, 0x0180)]);
        assert_eq!(zero.count(), Ok(0));
        done(zero.release());
    }

    #[test]
    fn a_refusal_is_read_out_by_name_and_thereby_cleared() {
        let reasons = [
            (0x8001, Fault::CommandFraming),
            (0x8002, Fault::InvalidCommand),
            (0x8004, Fault::CommandParity),
            (0x0000, Fault::EncoderError),
        ];
        for (reason, fault) in reasons {
            // Error flag with data 0x0001: two ones.
            let refused = [(0xffff, 0x0000), (0x0000, 0x4001), (0x4001, 0x0000), (0x0000, reason)];
            let again = [(0xffff, 0x0000), (0x0000, 0x0003)];
            let mut encoder = encoder(&[refused.as_slice(), &again].concat());
            assert_eq!(encoder.count(), Err(Error::Fault(fault)));
            assert_eq!(encoder.count(), Ok(3));
            done(encoder.release());
        }
    }

    #[test]
    fn a_disturbed_refusal_is_a_parity_error() {
        let mut encoder = encoder(&[(0xffff, 0), (0x0000, 0x4001), (0x4001, 0), (0x0000, 0x0001)]);
        assert_eq!(encoder.count(), Err(Error::Fault(Fault::Parity)));
        done(encoder.release());
    }

    #[test]
    fn a_failing_bus_is_passed_on() {
        let mut encoder = As5047p::new(DeadBus, Delay::new());
        assert_eq!(encoder.count(), Err(Error::Bus(ErrorKind::Overrun)));
        assert_eq!(encoder.check(), Err(Error::Bus(ErrorKind::Overrun)));
    }

    #[test]
    fn a_diagnosis_names_what_is_wrong() {
        let cases = [
            (0x0180, Ok(())),
            (0x0000, Err(Fault::NotReady)),
            (0x0300, Err(Fault::InvalidAngle)),
            (0x0500, Err(Fault::FieldTooStrong)),
            (0x0900, Err(Fault::FieldTooWeak)),
        ];
        for (register, sound) in cases {
            let mut encoder = encoder(&[(0x4001, 0), (0, 0), (0xfffc, 0), (0, register)]);
            assert_eq!(encoder.check(), sound.map_err(Error::Fault), "{register:#x}");
            done(encoder.release());
        }
        assert_eq!(Diagnosis::of(0x0180), Diagnosis { gain: 0x80, ready: true, ..Diagnosis::default() });
    }

    proptest! {
        #[test]
        fn any_bits_are_an_angle_or_refused(reply: [u8; 2]) {
            let mut encoder = As5047p::new(Echo(&reply), Delay::new());
            prop_assert!(encoder.count().is_ok_and(|count| count < 1 << 14) || encoder.count().is_err());
            let _ = encoder.check();
        }
    }
}
