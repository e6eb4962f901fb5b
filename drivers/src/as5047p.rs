//! ams AS5047P: absolute magnetic encoder, 14 bits a revolution, on SPI.
//!
//! ```text
//! command  P R a13 .. a0     P even parity of the other 15 bits, R = 1 reads, address a
//! reply    P E d13 .. d0     E = 1: the encoder refused an earlier command, data d
//! ```
//!
//! 16 bits a frame, most significant first, SPI mode 1 (CPOL 0, CPHA 1), 10 MHz at most; the reply to
//! a command arrives with the next frame. An angle therefore takes two frames: the second carries no
//! command, so that the angle is not one control period old.
//!
//! The angle is DAEC-compensated (register ANGLECOM), in counts of 2*pi/2^14 = 383 urad; it grows when
//! the magnet turns clockwise seen from above (its DIR setting as delivered).
//!
//! A reply of all zeros is valid by parity: a line stuck low reads as angle 0. [`As5047p::diagnosis`]
//! tells the two apart, because a working encoder always has its loop-finished bit set.
//!
//! Reference: ams AS5047P datasheet v1-10, sections "SPI interface" and "Volatile registers".

use core::fmt;
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{MODE_1, Mode, Operation, SpiDevice};

/// The bus mode that the encoder needs.
pub const MODE: Mode = MODE_1;

/// The fastest clock that the encoder follows (Hz).
pub const FASTEST: u32 = 10_000_000;

/// Resolution: `2^BITS` counts a revolution.
pub const BITS: u32 = 14;

/// Between two frames, and from select to the first clock edge [ns] (t_CSn and t_L, at least 350).
const PAUSE: u32 = 400;

const NO_OPERATION: u16 = 0x0000;
const ERRORS: u16 = 0x0001;
const DIAGNOSIS: u16 = 0x3ffc;
const ANGLE: u16 = 0x3fff;

const READ: u16 = 1 << 14;
const ERROR_FLAG: u16 = 1 << 14;
const DATA: u16 = ERROR_FLAG - 1;

/// Why a register could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// The reply has odd parity: it was disturbed on its way.
    Parity {
        /// The frame as it came.
        reply: u16,
    },
    /// The encoder refused a command. Its error flag is cleared by now.
    Refused(Refusal),
}

/// Why the encoder refused a command (register ERRFL).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusal {
    /// The frame did not have 16 clock edges.
    pub framing: bool,
    /// There is no such register.
    pub invalid_command: bool,
    /// The command had odd parity.
    pub parity: bool,
}

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
    /// Angles can be trusted.
    pub const fn sound(self) -> bool {
        self.ready && !self.overflow && !self.field_too_high && !self.field_too_low
    }
}

impl<E: fmt::Debug> fmt::Display for Error<E> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(formatter, "encoder bus: {error:?}"),
            Self::Parity { reply } => write!(formatter, "encoder reply {reply:#06x} has odd parity"),
            Self::Refused(refusal) => write!(formatter, "encoder refused a command: {refusal:?}"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for Error<E> {}

/// The encoder on its bus.
#[derive(Debug)]
pub struct As5047p<S, D> {
    spi: S,
    delay: D,
}

impl<S: SpiDevice, D: DelayNs> As5047p<S, D> {
    /// The encoder on a bus in [`MODE`], no faster than [`FASTEST`].
    pub const fn new(spi: S, delay: D) -> Self {
        Self { spi, delay }
    }

    /// The angle, 0 to `2^14 - 1`.
    ///
    /// # Errors
    /// [`Error`]; the next call starts afresh.
    pub fn angle(&mut self) -> Result<u16, Error<S::Error>> {
        self.read(ANGLE)
    }

    /// Diagnostics of the encoder and its magnet.
    ///
    /// # Errors
    /// [`Error`].
    pub fn diagnosis(&mut self) -> Result<Diagnosis, Error<S::Error>> {
        let register = self.read(DIAGNOSIS)?;
        let bit = |position: u32| register >> position & 1 != 0;
        Ok(Diagnosis {
            gain: register as u8,
            ready: bit(8),
            overflow: bit(9),
            field_too_high: bit(10),
            field_too_low: bit(11),
        })
    }

    /// The bus and the delay, given back.
    pub fn release(self) -> (S, D) {
        (self.spi, self.delay)
    }

    fn read(&mut self, register: u16) -> Result<u16, Error<S::Error>> {
        self.exchange(command(register))?;
        let reply = self.exchange(command(NO_OPERATION))?;
        if odd_parity(reply) {
            return Err(Error::Parity { reply });
        }
        if reply & ERROR_FLAG != 0 {
            return Err(Error::Refused(self.refusal()?));
        }
        Ok(reply & DATA)
    }

    /// Reading the reasons clears them.
    fn refusal(&mut self) -> Result<Refusal, Error<S::Error>> {
        self.exchange(command(ERRORS))?;
        let reply = self.exchange(command(NO_OPERATION))?;
        if odd_parity(reply) {
            return Err(Error::Parity { reply });
        }
        let bit = |position: u32| reply >> position & 1 != 0;
        Ok(Refusal { framing: bit(0), invalid_command: bit(1), parity: bit(2) })
    }

    fn exchange(&mut self, frame: u16) -> Result<u16, Error<S::Error>> {
        let mut bytes = frame.to_be_bytes();
        self.delay.delay_ns(PAUSE);
        self.spi
            .transaction(&mut [Operation::DelayNs(PAUSE), Operation::TransferInPlace(&mut bytes)])
            .map_err(Error::Bus)?;
        Ok(u16::from_be_bytes(bytes))
    }
}

/// The frame that reads a register.
const fn command(register: u16) -> u16 {
    let frame = if register == NO_OPERATION { NO_OPERATION } else { READ | register };
    if odd_parity(frame) { frame | 1 << 15 } else { frame }
}

const fn odd_parity(frame: u16) -> bool {
    frame.count_ones() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal::spi::ErrorKind;
    use embedded_hal_mock::eh1::delay::NoopDelay;
    use embedded_hal_mock::eh1::spi::{Mock, Transaction};
    use std::string::ToString;
    use std::vec::Vec;

    /// The expectations of one frame: what goes out, what comes back.
    fn frame(sent: u16, received: u16) -> [Transaction<u8>; 4] {
        [
            Transaction::transaction_start(),
            Transaction::delay(PAUSE),
            Transaction::transfer_in_place(sent.to_be_bytes().to_vec(), received.to_be_bytes().to_vec()),
            Transaction::transaction_end(),
        ]
    }

    fn encoder(frames: &[(u16, u16)]) -> As5047p<Mock<u8>, NoopDelay> {
        let expected: Vec<_> = frames.iter().flat_map(|(sent, received)| frame(*sent, *received)).collect();
        As5047p::new(Mock::new(&expected), NoopDelay::new())
    }

    fn done(encoder: As5047p<Mock<u8>, NoopDelay>) {
        encoder.release().0.done();
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
        assert_eq!(encoder.angle(), Ok(0x1234));
        assert_eq!(encoder.angle(), Ok(0x3fff));
        done(encoder);
    }

    #[test]
    fn every_single_bit_error_is_caught() {
        for bit in 0..16 {
            let reply = 0x9234 ^ 1 << bit;
            let mut encoder = encoder(&[(0xffff, 0x0000), (0x0000, reply)]);
            assert_eq!(encoder.angle(), Err(Error::Parity { reply }), "bit {bit}");
            done(encoder);
        }
    }

    #[test]
    fn a_refusal_is_read_out_by_name_and_thereby_cleared() {
        // Error flag with data 0x0001: two ones.
        let refused = [(0xffff, 0x0000), (0x0000, 0x4001), (0x4001, 0x0000), (0x0000, 0x8004)];
        let again = [(0xffff, 0x0000), (0x0000, 0x0003)];
        let mut encoder = encoder(&[refused.as_slice(), &again].concat());
        let refusal = Refusal { parity: true, ..Refusal::default() };
        assert_eq!(encoder.angle(), Err(Error::Refused(refusal)));
        assert_eq!(encoder.angle(), Ok(3));
        done(encoder);
    }

    #[test]
    fn a_disturbed_refusal_is_a_parity_error() {
        let mut encoder = encoder(&[(0xffff, 0), (0x0000, 0x4001), (0x4001, 0), (0x0000, 0x0001)]);
        assert_eq!(encoder.angle(), Err(Error::Parity { reply: 1 }));
        done(encoder);
    }

    /// A bus on which nothing works: the mock has no errors.
    #[derive(Debug)]
    struct DeadBus;

    impl embedded_hal::spi::ErrorType for DeadBus {
        type Error = ErrorKind;
    }

    impl SpiDevice for DeadBus {
        fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
            Err(ErrorKind::Overrun)
        }
    }

    #[test]
    fn a_failing_bus_is_passed_on() {
        let mut encoder = As5047p::new(DeadBus, NoopDelay::new());
        assert_eq!(encoder.angle(), Err(Error::Bus(ErrorKind::Overrun)));
        assert_eq!(encoder.diagnosis(), Err(Error::Bus(ErrorKind::Overrun)));
    }

    #[test]
    fn a_diagnosis_names_each_bit() {
        // Gain 0x80 and ready: two ones.
        let mut encoder =
            encoder(&[(0xfffc, 0), (0, 0x0180), (0xfffc, 0), (0, 0x0900), (0xfffc, 0), (0, 0x0000)]);
        let sound = encoder.diagnosis().unwrap();
        assert_eq!(sound, Diagnosis { gain: 0x80, ready: true, ..Diagnosis::default() });
        assert!(sound.sound());
        let far_magnet = encoder.diagnosis().unwrap();
        assert!(far_magnet.field_too_low && !far_magnet.field_too_high && !far_magnet.sound());
        let stuck_low = encoder.diagnosis().unwrap();
        assert!(!stuck_low.sound());
        done(encoder);
    }

    #[test]
    fn errors_read_as_one_line() {
        let text = Error::<ErrorKind>::Parity { reply: 1 }.to_string();
        assert_eq!(text, "encoder reply 0x0001 has odd parity");
    }
}
