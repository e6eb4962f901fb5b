//! Infineon TLE5012B: absolute magnetic (GMR) encoder, 15 bits a revolution, on SSC, the half-duplex SPI of this part.
//!
//! ```text
//! command      1 0000 0 000010 0001      read, no lock, current values, register 0x02 (AVAL), one data word
//! data word    N a14 .. a0               N: not read before; angle a
//! safety word  S3 .. S0 R3 .. R0 c7 .. c0
//!              S = 0: restarted, system error, interface access error, angle invalid; R = 1110: encoder 0 has answered
//! ```
//!
//! 16 bits a word, most significant first, SPI mode 1 (CPOL 0, CPHA 1), 8 MHz at most (2 MHz with the open-drain output); 130 ns
//! between command and data. That is 6.8 us for an angle at 8 MHz, of which 0.8 us are the pauses. The data pin goes to MISO, and to MOSI over a
//! resistor or as an open drain, which sends ones while the encoder speaks. In one transfer without the pause, as a DMA does it
//! ([`crate::OneFrame`]), half a clock has to be at least these 130 ns: 3.8 MHz, 12.6 us.
//!
//! The CRC is that of SAE J1850, x^8 + x^4 + x^3 + x^2 + 1, start value 0xff, inverted, over command and data word. Status and
//! response are not under it; each single bit of them that changes is refused by name all the same, as are a frame of zeros and a
//! frame of ones. An error bit stays until the status register is read, which [`Encoder::count`] does when it meets one.
//!
//! Delay of the angle without prediction, FIR_MD = 1 (t_adelSSC): 85 us, at most 95. With FIR_MD 2 it is 165, with 3 it is 300:
//! such an encoder is no motor encoder for a control period of 100 us.
//!
//! Reference: Infineon TLE5012B data sheet Rev. 2.0, 2014-02, sections 4.3 "Signal processing" and 4.4.1 "Synchronous Serial
//! Communication"; user's manual Rev. 1.2, 2018-02, section 5.2.

use crc::{CRC_8_SAE_J1850, Crc};
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{MODE_1, Mode, SpiDevice};

use crate::bus::{Bus, Pauses};
use crate::encoder::{Encoder, OneFrame, SpiEncoder};
use crate::fault::{Error, Fault};

/// Not selected between two transfers (t_CSoff), and from select to the first clock edge (t_CSs).
const PAUSES: Pauses = Pauses { idle: 600, setup: 105 };

/// From the command to the data (t_wr_delay), in ns.
const TURN_ROUND: u32 = 130;

/// x^8 + x^4 + x^3 + x^2 + 1 from 0xff, inverted.
const CHECKSUM: Crc<u8> = Crc::<u8>::new(&CRC_8_SAE_J1850);

/// Reads the angle, and reads the status, which clears its error bits; each with a safety word.
const READ_ANGLE: [u8; 2] = [0x80, 0x21];
const READ_STATUS: [u8; 2] = [0x80, 0x01];

/// What is sent while the encoder speaks: its open drain leaves the line alone.
const SILENT: u8 = 0xff;

/// Encoder number 0 has answered: its bit is low.
const RESPONSE: u8 = 0b1110;

/// The encoder on its bus.
#[derive(Debug)]
pub struct Tle5012b<S, D>(Bus<S, D>);

impl<S: SpiDevice, D: DelayNs> Tle5012b<S, D> {
    /// The encoder on a bus in its mode, no faster than its largest clock.
    pub const fn new(spi: S, delay: D) -> Self {
        Self(Bus::new(spi, delay))
    }

    /// The bus and the delay, given back.
    pub fn release(self) -> (S, D) {
        self.0.release()
    }

    /// Data word and safety word.
    fn read(&mut self, mut command: [u8; 2]) -> Result<[u8; 4], Error<S::Error>> {
        let mut reply = [SILENT; 4];
        self.0.turn_round(PAUSES, &mut command, TURN_ROUND, &mut reply)?;
        Ok(reply)
    }
}

impl<S: SpiDevice, D: DelayNs> Encoder for Tle5012b<S, D> {
    const BITS: u32 = 15;
    /// t_adelSSC, FIR_MD = 1, at most.
    const LATENCY: f32 = 95e-6;
    type Bus = S::Error;

    fn check(&mut self) -> Result<(), Error<S::Error>> {
        // The encoder has restarted with the board; it tells so until it was asked.
        self.read(READ_STATUS)?;
        self.count().map(|_| ())
    }

    fn count(&mut self) -> Result<u32, Error<S::Error>> {
        let read = angle(self.read(READ_ANGLE)?);
        if let Err(Fault::Restarted | Fault::EncoderError | Fault::CommandFraming | Fault::InvalidAngle) =
            read
        {
            self.read(READ_STATUS)?;
        }
        Ok(read?)
    }
}

impl<S: SpiDevice, D: DelayNs> SpiEncoder for Tle5012b<S, D> {
    const MODE: Mode = MODE_1;
    const FASTEST: u32 = 8_000_000;
    const READING_TIME: f32 = PAUSES.time(1, 48, Self::FASTEST) + TURN_ROUND as f32 * 1e-9;
}

/// At 3.8 MHz at most: there is no pause behind the command.
impl<S: SpiDevice, D: DelayNs> OneFrame for Tle5012b<S, D> {
    type Frame = [u8; 6];
    const START: [u8; 6] = [READ_ANGLE[0], READ_ANGLE[1], SILENT, SILENT, SILENT, SILENT];

    fn take(received: &[u8; 6]) -> Result<u32, Fault> {
        let [_, _, reply @ ..] = *received;
        angle(reply)
    }
}

/// The angle in data word and safety word.
fn angle(reply: [u8; 4]) -> Result<u32, Fault> {
    let [high, low, status, checksum] = reply;
    match reply {
        [0, 0, 0, 0] => return Err(Fault::StuckLow),
        [0xff, 0xff, 0xff, 0xff] => return Err(Fault::StuckHigh),
        _ => {}
    }
    if CHECKSUM.checksum(&[READ_ANGLE[0], READ_ANGLE[1], high, low]) != checksum {
        return Err(Fault::Checksum);
    }
    match status {
        _ if status & 0x80 == 0 => Err(Fault::Restarted),
        _ if status & 0x40 == 0 => Err(Fault::EncoderError),
        _ if status & 0x20 == 0 => Err(Fault::CommandFraming),
        _ if status & 0x10 == 0 => Err(Fault::InvalidAngle),
        _ if status & 0x0f != RESPONSE => Err(Fault::OtherEncoder),
        _ => Ok(u32::from_be_bytes([0, 0, high & 0x7f, low])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DeadBus, Delay, Echo, flipped};
    use embedded_hal::spi::ErrorKind;
    use embedded_hal_mock::eh1::spi::{Mock, Transaction};
    use proptest::prelude::*;
    use std::vec::Vec;

    /// The reply with this angle, `new` or read before, and this upper half of the safety word.
    fn reply(angle: u16, new: bool, status: u8) -> [u8; 4] {
        let [high, low] = (angle | u16::from(new) << 15).to_be_bytes();
        // Bit by bit, as the datasheet draws it: inverted start and end.
        let mut rest = 0xff_u8;
        for byte in [READ_ANGLE[0], READ_ANGLE[1], high, low] {
            for bit in (0..8).rev() {
                let carry = (rest >> 7) ^ (byte >> bit & 1);
                rest = rest << 1 ^ if carry == 1 { 0x1d } else { 0 };
            }
        }
        [high, low, status, !rest]
    }

    fn encoder(frames: &[([u8; 2], [u8; 4])]) -> Tle5012b<Mock<u8>, Delay> {
        let expected: Vec<_> = frames
            .iter()
            .flat_map(|(command, reply)| {
                [
                    Transaction::transaction_start(),
                    Transaction::delay(PAUSES.setup),
                    Transaction::transfer_in_place(command.to_vec(), command.to_vec()),
                    Transaction::delay(TURN_ROUND),
                    Transaction::transfer_in_place([SILENT; 4].to_vec(), reply.to_vec()),
                    Transaction::transaction_end(),
                ]
            })
            .collect();
        Tle5012b::new(Mock::new(&expected), Delay::new())
    }

    fn read_once(received: [u8; 4]) -> Result<u32, Error<ErrorKind>> {
        let mut encoder = encoder(&[(READ_ANGLE, received)]);
        let read = encoder.count();
        encoder.release().0.done();
        read
    }

    #[test]
    fn the_checksum_has_its_catalogued_check_value() {
        assert_eq!(CHECKSUM.checksum(b"123456789"), 0x4b);
    }

    #[test]
    fn an_angle_is_checked_and_unpacked() {
        assert_eq!(reply(0x4dac, true, 0xfe), [0xcd, 0xac, 0xfe, 0xf6]);
        for (angle, new) in [(0, false), (0x7fff, true), (0x1234, true), (0x4dac, false)] {
            assert_eq!(read_once(reply(angle, new, 0xfe)), Ok(angle.into()));
        }
    }

    #[test]
    fn each_status_bit_is_named_and_cleared_by_reading_the_status() {
        let cases = [
            (0x7e, Fault::Restarted),
            (0xbe, Fault::EncoderError),
            (0xde, Fault::CommandFraming),
            (0xee, Fault::InvalidAngle),
        ];
        for (status, fault) in cases {
            let frames = [
                (READ_ANGLE, reply(5, true, status)),
                (READ_STATUS, [0x80, 0x01, status, 0x00]),
                (READ_ANGLE, reply(6, true, 0xfe)),
            ];
            let mut encoder = encoder(&frames);
            assert_eq!(encoder.count(), Err(Error::Fault(fault)));
            assert_eq!(encoder.count(), Ok(6));
            encoder.release().0.done();
        }
    }

    #[test]
    fn every_single_bit_error_is_caught() {
        for angle in (0..1 << 15).step_by(61) {
            for received in flipped(reply(angle, true, 0xfe)) {
                assert!(super::angle(received).is_err(), "angle {angle}, {received:x?}");
            }
        }
    }

    #[test]
    fn another_encoder_and_a_stuck_line_are_no_angle() {
        assert_eq!(read_once(reply(5, true, 0xfd)), Err(Error::Fault(Fault::OtherEncoder)));
        assert_eq!(read_once([0; 4]), Err(Error::Fault(Fault::StuckLow)));
        assert_eq!(read_once([0xff; 4]), Err(Error::Fault(Fault::StuckHigh)));
        let dead = Tle5012b::new(DeadBus, Delay::new()).count();
        assert_eq!(dead, Err(Error::Bus(ErrorKind::Overrun)));
    }

    #[test]
    fn the_first_restart_is_expected() {
        let frames = [(READ_STATUS, [0x80, 0x01, 0x7e, 0x00]), (READ_ANGLE, reply(5, true, 0xfe))];
        let mut encoder = encoder(&frames);
        assert_eq!(encoder.check(), Ok(()));
        encoder.release().0.done();
    }

    #[test]
    fn one_transfer_has_the_same_reply() {
        type Encoder15 = Tle5012b<Mock<u8>, Delay>;
        let [a, b, c, d] = reply(0x1234, true, 0xfe);
        assert_eq!(Encoder15::START, [0x80, 0x21, 0xff, 0xff, 0xff, 0xff]);
        assert_eq!(Encoder15::take(&[0x80, 0x21, a, b, c, d]), Ok(0x1234));
    }

    proptest! {
        #[test]
        fn any_bits_are_an_angle_or_refused(received: [u8; 6]) {
            let mut encoder = Tle5012b::new(Echo(&received), Delay::new());
            prop_assert!(encoder.count().map_or(true, |count| count < 1 << 15));
            let _ = encoder.check();
        }

        #[test]
        fn every_angle_survives_its_frame(angle in 0_u16..1 << 15, new: bool) {
            prop_assert_eq!(super::angle(reply(angle, new, 0xfe)), Ok(angle.into()));
        }
    }
}
