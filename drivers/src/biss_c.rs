//! BiSS-C: the serial interface of absolute encoders by many makers, read through SPI as a clocked frame.
//!
//! ```text
//! MA   idle high, then 64 clocks
//! SLO  1 .. 1   0 .. 0       1      0    p(n-1) .. p0   nE     nW       c5 .. c0   0 .. 0
//!      idle     acknowledge  start  CDS  position       error  warning  CRC        zeros
//! ```
//!
//! MA is the SPI clock, SLO its MISO, both through an RS-422 transceiver; MOSI and select stay unconnected. SPI mode 3 (CPOL 1,
//! CPHA 1: the bit is taken at the rising edge, at which the encoder shifts out the next), 10 MHz at most. The position is turns (optional),
//! then the count within the turn, most significant bit first. nE = 0: the position is invalid; nW = 0: it is valid, and the
//! encoder near the limit of what it can do.
//!
//! 8 bytes a frame, in one transfer, which a DMA can do ([`crate::OneFrame`]): 6.4 us at 10 MHz. The acknowledge lasts as long as the
//! encoder computes; it may take 64 - 12 - n bits less the idle ones, and more time at a lower clock. A frame that ends before its CRC is
//! refused. After a frame the encoder needs its timeout, at most 40 us, before the next one: within a control period of 100 us it has passed.
//!
//! The CRC is that of x^6 + x + 1 (0x43), start value 0, inverted, over position, error and warning: every single bit of these and
//! of itself that changes is refused. Acknowledge and start bit are under no CRC: a disturbed one moves the frame, which the CRC and the
//! zeros that have to follow it refuse, too. Counted in a test over 17 to 32 bits a turn: only with 18 bits one in 300 passes, and is left to the
//! compensator, which accepts what the motor can reach. A line that is stuck has no start bit behind an acknowledge: it is
//! refused by name.
//!
//! The position is taken at the first clock edge: the interface adds no latency; what the encoder's own filter adds is in its datasheet.
//!
//! Reference: iC-Haus "BiSS Interface, protocol description (C-mode)" C6; the CRC of the single-cycle data as in the iC-MU datasheet
//! Rev D1, table 41. The test's frame was received from a 22-bit encoder on an STM32.

use crc::{Algorithm, Crc};
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{MODE_3, Mode, SpiDevice};

use crate::bus::{Bus, Pauses};
use crate::encoder::{Encoder, OneFrame, SpiEncoder};
use crate::fault::{Error, Fault};

const PAUSES: Pauses = Pauses { idle: 0, setup: 0 };

/// x^6 + x + 1 from 0, inverted.
const CHECKSUM: Crc<u8> = Crc::<u8>::new(&Algorithm {
    width: 6,
    poly: 0x03,
    init: 0,
    refin: false,
    refout: false,
    xorout: 0x3f,
    check: 0x2e,
    residue: 0,
});

const CHECKSUM_BITS: u32 = 6;

/// Behind the position: error and warning.
const FLAGS: u32 = 2;

/// An encoder with 2^TURN_BITS turns of 2^BITS counts, on its bus.
#[derive(Debug)]
pub struct BissC<S, D, const BITS: u32, const TURN_BITS: u32 = 0>(Bus<S, D>);

/// What a frame holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Whole turns; 0 of an encoder of a single turn.
    pub turns: u32,
    /// Count within the turn.
    pub count: u32,
    /// The encoder warns: it is near the limit of what it can do, the position is valid.
    pub warning: bool,
}

impl<S: SpiDevice, D: DelayNs, const BITS: u32, const TURN_BITS: u32> BissC<S, D, BITS, TURN_BITS> {
    /// Bits under the CRC: turns, count, error and warning.
    const PROTECTED: u32 = {
        assert!(
            BITS >= 10 && BITS <= 32 && TURN_BITS <= 16,
            "BiSS-C: 10 to 32 bits a turn, up to 16 of turns"
        );
        TURN_BITS + BITS + FLAGS
    };

    /// The encoder on a bus in its mode, no faster than its largest clock, without a select.
    pub const fn new(spi: S, delay: D) -> Self {
        let _ = Self::PROTECTED;
        Self(Bus::new(spi, delay))
    }

    /// The whole of a frame.
    ///
    /// # Errors
    /// [`Error`].
    pub fn position(&mut self) -> Result<Position, Error<S::Error>> {
        let mut frame = Self::START;
        self.0.exchange(PAUSES, &mut frame)?;
        Ok(Self::decode(&frame)?)
    }

    /// What `received` holds.
    ///
    /// # Errors
    /// [`Fault`].
    pub fn decode(received: &[u8; 8]) -> Result<Position, Fault> {
        let (protected, checksum) = split(u64::from_be_bytes(*received), Self::PROTECTED)?;
        if CHECKSUM.checksum(&protected.to_be_bytes()) != checksum {
            return Err(Fault::Checksum);
        }
        if protected & 0b10 == 0 {
            return Err(Fault::EncoderError);
        }
        let position = protected >> FLAGS;
        Ok(Position {
            turns: (position >> BITS) as u32,
            count: (position & ((1 << BITS) - 1)) as u32,
            warning: protected & 0b01 == 0,
        })
    }

    /// The bus and the delay, given back.
    pub fn release(self) -> (S, D) {
        self.0.release()
    }
}

/// The `bits` that the CRC protects, and the CRC.
fn split(frame: u64, bits: u32) -> Result<(u64, u8), Fault> {
    match frame {
        0 => return Err(Fault::StuckLow),
        u64::MAX => return Err(Fault::StuckHigh),
        _ => {}
    }
    let idle = frame.leading_ones();
    let acknowledge = (frame << idle).leading_zeros();
    // Behind the start bit comes CDS, which is 0 when no register was written.
    let begin = idle + acknowledge + 2;
    let end = begin + bits + CHECKSUM_BITS;
    if idle == 0 || end > u64::BITS {
        return Err(Fault::Framing);
    }
    if frame >> (u64::BITS - begin) & 1 != 0 {
        return Err(Fault::Framing);
    }
    if end < u64::BITS && frame << end != 0 {
        return Err(Fault::Framing);
    }
    let data = (frame << begin) >> (u64::BITS - bits - CHECKSUM_BITS);
    Ok((data >> CHECKSUM_BITS, data as u8 & ((1 << CHECKSUM_BITS) - 1)))
}

impl<S: SpiDevice, D: DelayNs, const BITS: u32, const TURN_BITS: u32> Encoder
    for BissC<S, D, BITS, TURN_BITS>
{
    const BITS: u32 = BITS;
    /// Of the interface: the encoder's own comes on top.
    const LATENCY: f32 = 0.0;
    type Bus = S::Error;

    fn check(&mut self) -> Result<(), Error<S::Error>> {
        self.position().map(|_| ())
    }

    fn count(&mut self) -> Result<u32, Error<S::Error>> {
        Ok(self.position()?.count)
    }
}

impl<S: SpiDevice, D: DelayNs, const BITS: u32, const TURN_BITS: u32> SpiEncoder
    for BissC<S, D, BITS, TURN_BITS>
{
    const MODE: Mode = MODE_3;
    const FASTEST: u32 = 10_000_000;
    const READING_TIME: f32 = PAUSES.time(1, 64, Self::FASTEST);
}

impl<S: SpiDevice, D: DelayNs, const BITS: u32, const TURN_BITS: u32> OneFrame
    for BissC<S, D, BITS, TURN_BITS>
{
    type Frame = [u8; 8];
    const START: [u8; 8] = [0; 8];

    fn take(received: &[u8; 8]) -> Result<u32, Fault> {
        Ok(Self::decode(received)?.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{DeadBus, Delay, Echo, Spi, bus, done, flipped};
    use embedded_hal::spi::ErrorKind;
    use proptest::prelude::*;

    type Single = BissC<Spi, Delay, 22>;
    type Multi = BissC<Spi, Delay, 20, 12>;

    /// Received: position 0b0001100111010000000101, no error, no warning, CRC 0b011110.
    const RECEIVED: [u8; 8] = [0xc0, 0x00, 0x86, 0x74, 0x05, 0xde, 0x00, 0x00];
    const POSITION: u32 = 0b00_0110_0111_0100_0000_0101;

    /// A frame with two idle bits, this acknowledge, and these bits under a CRC that is divided bit by bit.
    fn frame(acknowledge: u32, protected: u64, bits: u32) -> [u8; 8] {
        let mut rest = protected << CHECKSUM_BITS;
        for bit in (CHECKSUM_BITS..bits + CHECKSUM_BITS).rev() {
            rest ^= if rest >> bit & 1 == 1 { 0x43 << (bit - CHECKSUM_BITS) } else { 0 };
        }
        let data = 0b10 << (bits + CHECKSUM_BITS) | protected << CHECKSUM_BITS | (rest ^ 0x3f);
        let end = 2 + acknowledge + 2 + bits + CHECKSUM_BITS;
        (0b11 << 62 | data << (64 - end)).to_be_bytes()
    }

    #[test]
    fn the_checksum_has_its_check_value() {
        assert_eq!(CHECKSUM.checksum(b"123456789"), CHECKSUM.algorithm.check);
        // The same polynomial, shifted to the left of a byte and divided by hand: x^6 = x + 1.
        assert_eq!(CHECKSUM.checksum(&[0b0000_0001]), 0b00_0011 ^ 0x3f);
        assert_eq!(CHECKSUM.checksum(&[0b0000_0010]), 0b00_0110 ^ 0x3f);
    }

    #[test]
    fn a_received_frame_is_checked_and_unpacked() {
        let (spi, delay) = bus(PAUSES, &[([0; 8], RECEIVED)]);
        let mut encoder = Single::new(spi, delay);
        assert_eq!(encoder.count(), Ok(POSITION));
        done(encoder.release());
        assert_eq!(frame(14, u64::from(POSITION) << 2 | 0b11, 24), RECEIVED);
    }

    #[test]
    fn turns_come_before_the_count() {
        let position = Position { turns: 0xabc, count: 0x1_2345, warning: false };
        assert_eq!(Multi::decode(&frame(3, 0xabc1_2345 << 2 | 0b11, 34)), Ok(position));
        let warned = Position { warning: true, ..position };
        assert_eq!(Multi::decode(&frame(3, 0xabc1_2345 << 2 | 0b10, 34)), Ok(warned));
    }

    #[test]
    fn an_error_bit_refuses_the_position() {
        assert_eq!(Single::take(&frame(1, 5 << 2 | 0b01, 24)), Err(Fault::EncoderError));
        assert_eq!(Single::take(&frame(1, 5 << 2, 24)), Err(Fault::EncoderError));
    }

    #[test]
    fn every_acknowledge_that_fits_is_found() {
        let longest = 64 - 2 - 2 - 24 - CHECKSUM_BITS;
        for acknowledge in 1..=longest {
            assert_eq!(Single::take(&frame(acknowledge, 77 << 2 | 0b11, 24)), Ok(77), "{acknowledge}");
        }
        // One bit later the frame is cut off.
        let late = u64::from_be_bytes(frame(longest, 77 << 2 | 0b11, 24));
        let late = (late & u64::MAX >> 2) >> 1 | 0b11 << 62;
        assert_eq!(Single::take(&late.to_be_bytes()), Err(Fault::Framing));
    }

    #[test]
    fn every_single_bit_error_under_the_checksum_is_caught() {
        for position in (0..1 << 22).step_by(1021) {
            // Bits 19 to 48: position, error, warning and CRC.
            for received in flipped(frame(15, position << 2 | 0b11, 24)).take(49).skip(19) {
                assert!(Single::take(&received).is_err(), "{position}: {received:x?}");
            }
        }
    }

    /// Of frames with one disturbed bit outside of the CRC: those that are taken for another position, and all.
    fn mistaken<const BITS: u32>() -> (u32, u32) {
        let (mut wrong, mut all) = (0, 0);
        for index in 0..4096_u64 {
            let position = (index * 0x9e37_79b9) & ((1 << BITS) - 1);
            for acknowledge in [1, 8, 15] {
                let first = (acknowledge + 4) as usize;
                let protected = first..first + (BITS + FLAGS + CHECKSUM_BITS) as usize;
                let received = flipped(frame(acknowledge, position << 2 | 0b11, BITS + FLAGS));
                for (_, received) in received.enumerate().filter(|(bit, _)| !protected.contains(bit)) {
                    let read = BissC::<Spi, Delay, BITS>::take(&received);
                    all += 1;
                    wrong += u32::from(read.is_ok_and(|read| u64::from(read) != position));
                }
            }
        }
        (wrong, all)
    }

    #[test]
    fn a_frame_disturbed_around_it_is_no_other_position_but_seldom_with_18_bits() {
        let others = [
            mistaken::<17>(),
            mistaken::<19>(),
            mistaken::<20>(),
            mistaken::<22>(),
            mistaken::<24>(),
            mistaken::<26>(),
            mistaken::<32>(),
        ];
        assert!(others.iter().all(|&(wrong, _)| wrong == 0), "{others:?}");
        let (wrong, all) = mistaken::<18>();
        assert!((1..all / 300).contains(&wrong), "{wrong} of {all}");
    }

    #[test]
    fn a_line_that_is_stuck_is_no_position() {
        assert_eq!(Single::take(&[0; 8]), Err(Fault::StuckLow));
        assert_eq!(Single::take(&[0xff; 8]), Err(Fault::StuckHigh));
        // The timeout of the last frame has not passed: no idle bit.
        assert_eq!(Single::take(&[0x00, 0x00, 0x86, 0x74, 0x05, 0xde, 0, 0]), Err(Fault::Framing));
        assert_eq!(Single::take(&[0xff, 0, 0, 0, 0, 0, 0, 0]), Err(Fault::Framing));
        let mut dead = BissC::<_, _, 22>::new(DeadBus, Delay::new());
        assert_eq!(dead.check(), Err(Error::Bus(ErrorKind::Overrun)));
    }

    proptest! {
        #[test]
        fn any_bits_are_a_position_or_refused(received: [u8; 8]) {
            let mut encoder = BissC::<_, _, 22>::new(Echo(&received), Delay::new());
            prop_assert!(encoder.count().map_or(true, |count| count < 1 << 22));
            let multi = Multi::decode(&received);
            prop_assert!(multi.map_or(true, |at| at.turns < 1 << 12 && at.count < 1 << 20));
            let _ = BissC::<Spi, Delay, 32, 16>::decode(&received);
        }

        #[test]
        fn every_position_survives_its_frame(position in 0_u64..1 << 22, acknowledge in 1_u32..30) {
            let received = frame(acknowledge, position << 2 | 0b11, 24);
            prop_assert_eq!(Single::take(&received), Ok(position as u32));
        }
    }
}
