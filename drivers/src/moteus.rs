//! moteus: a drive on CAN FD whose registers are written and read in one frame; it takes a torque in its position mode.
//!
//! ```text
//! to the drive   id 0x8000 + source * 0x100 + drive, extended      bit 15 asks for a reply
//!   01 00 0a         mode (0x000) = 10, position                   or 01 00 00, stopped, and then the query
//!   01 20 80         position (0x020) = where it is                the lowest integer is "not a number"
//!   0d 22 f32        feed-forward torque (0x022, N m)
//!   02 23 00 00      scales of kp, kd (0x023, 0x024) = 0
//!   0d 25 f32        largest torque (0x025, N m)
//!   0d 27 f32        watchdog (0x027, s)
//!   01 2b 00         scale of the integrator's limit (0x02b) = 0
//!   11 00 1f 01 11 0f   query of mode (0x000), position, velocity, torque (0x001 to 0x003) and fault (0x00f)
//!   50 ...           no operation, up to 48 bytes
//! from the drive id drive * 0x100 + source, extended from drive 8 on
//!   subframes 0x20 to 0x2f: kind, number (in the kind's lowest bits where these are not 0), first register, values
//!   0x30, 0x31: a register was not written or read
//! ```
//!
//! Little-endian; numbers and registers are `varuint`, 7 bits a byte. The kind's bits 2 and 3 say int8, int16, int32, f32. With the three scales
//! at 0 the position mode is torque control; the integrator has a scale of its own, and one left at 1 would wind up against the position.
//!
//! embedded-can 0.4 has no CAN FD frame: a frame is here an identifier and at most 64 bytes. [`Frame`] has 48, a length that CAN FD knows; the
//! board sends it with its peripheral, at 1 Mbit/s and 5 Mbit/s, without CAN prefix, and gives back what it receives.
//!
//! Modes of the drive, and the frame that leads on:
//!
//! ```text
//! stopped (0) --position, no torque--> enabling (2), calibrating (3, 4) --the same--> position (10): torque
//! fault (1), timeout (11), any other --stopped--> stopped (0)
//! ```
//!
//! Safe is: the frame `stopped`, until [`Drive::reset`]; the drive clears its fault with it. It is entered by name ([`Cause`]) when the drive
//! reports a fault, when its watchdog has expired, when it leaves the position mode by itself, when it refuses a register, and when no reply with
//! its mode has come for the time-out. A torque is sent in the position mode only, and none that is not a number. A fault code from
//! 96 on in the position mode is no fault: it says what limits the torque ([`Drive::fault_code`]).
//!
//! Position, velocity and torque are those at the output of the drive's `motor_position.rotor_to_output_ratio`: with 1 those of the motor, which a
//! joint's control wants. What the drive does when its watchdog expires is its `servo.timeout_mode`; 0 takes the torque off.
//!
//! Reference: mjbots/moteus at db1a7623, `docs/protocol/can.md`, `docs/protocol/registers.md`, `docs/guides/control-modes.md` ("Torque Control");
//! mjbots/mjlib, `mjlib/multiplex/format.h`.

use embedded_can::{ExtendedId, Id};

use crate::drive::Guard;
pub use crate::drive::{Cause, Feedback};

/// Addresses, limits and time-outs.
#[derive(Clone, Copy, Debug)]
pub struct Params {
    /// The drive's identifier, 1 to 126: 0 and 127 are broadcasts, the one by the registers' description, the other by the format's.
    pub drive: u8,
    /// Our own identifier, 0 to 126, not the drive's.
    pub source: u8,
    /// The largest torque that is commanded (N m); the drive is told it too.
    pub peak_torque: f32,
    /// Time after which the drive leaves the position mode when it does not hear us (s).
    pub watchdog: f32,
    /// Cycles without a reply after which the drive is taken for lost.
    pub timeout: u32,
}

impl Params {
    /// The drive, safe until [`Drive::reset`].
    ///
    /// `None` when an identifier is out of range or both are the same, the peak torque or the watchdog's time is not positive and finite, or there
    /// is no time-out.
    pub fn build(&self) -> Option<Drive> {
        let Self { drive, source, peak_torque, watchdog, timeout } = *self;
        let addresses = (1..=126).contains(&drive) && source <= 126 && drive != source;
        let watched = watchdog > 0.0 && watchdog.is_finite();
        let guard = Guard::new(peak_torque, timeout, [Cause::StatusLost])?;
        let [drive, source] = [drive, source].map(u32::from);
        let id = ExtendedId::new(REPLY_WANTED | source << 8 | drive)?;
        (addresses && watched).then_some(Drive {
            id,
            reply: drive << 8 | source,
            peak_torque,
            watchdog,
            mode: Mode::Other,
            fault_code: 0,
            guard,
        })
    }
}

/// Mode of the drive by its last reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Without torque.
    Stopped,
    /// Without torque, for a fault.
    Fault,
    /// It prepares to operate.
    Starting,
    /// It follows the torque.
    Position,
    /// Its watchdog has expired.
    Timeout,
    /// One that nobody here has asked for, or none was told yet.
    Other,
}

impl Mode {
    /// The mode that register 0x000 tells.
    pub const fn of(register: u8) -> Self {
        match register {
            0 => Self::Stopped,
            1 => Self::Fault,
            2..=4 => Self::Starting,
            10 => Self::Position,
            11 => Self::Timeout,
            _ => Self::Other,
        }
    }

    /// Enabled, or the cause that it is not.
    const fn status(self) -> Result<(), Cause> {
        match self {
            Self::Position => Ok(()),
            Self::Fault => Err(Cause::DriveFault),
            Self::Timeout => Err(Cause::WatchdogExpired),
            Self::Stopped | Self::Starting | Self::Other => Err(Cause::Disabled),
        }
    }
}

/// Bit 15 of the identifier.
const REPLY_WANTED: u32 = 0x8000;

/// Bytes of a frame that is sent: the torque command has 37, and CAN FD knows 32 and 48.
const SIZE: usize = 48;

const NOP: u8 = 0x50;
const WRITE_ERROR: u8 = 0x30;
const READ_ERROR: u8 = 0x31;

const STOPPED: &[u8] = &[0x01, 0x00, 0x00];
/// Position mode, and the position where it is.
const POSITION: &[u8] = &[0x01, 0x00, 0x0a, 0x01, 0x20, 0x80];
const FEED_FORWARD_TORQUE: &[u8] = &[0x0d, 0x22];
const NO_PROPORTIONAL_AND_DERIVATIVE: &[u8] = &[0x02, 0x23, 0x00, 0x00];
const LARGEST_TORQUE: &[u8] = &[0x0d, 0x25];
const WATCHDOG: &[u8] = &[0x0d, 0x27];
const NO_INTEGRATOR: &[u8] = &[0x01, 0x2b, 0x00];
const QUERY: &[u8] = &[0x11, 0x00, 0x1f, 0x01, 0x11, 0x0f];

/// What one of an integer register stands for, as int8, int16 and int32.
type Scales = [f32; 3];
const REVOLUTIONS: Scales = [0.01, 0.0001, 0.00001];
const REVOLUTIONS_PER_SECOND: Scales = [0.1, 0.00025, 0.00001];
const NEWTON_METRES: Scales = [0.5, 0.01, 0.001];

/// A CAN FD frame to the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Its identifier.
    pub id: ExtendedId,
    /// Its payload.
    pub data: [u8; SIZE],
}

/// The drive as the board sees it.
#[derive(Clone, Debug)]
pub struct Drive {
    id: ExtendedId,
    /// The identifier of its replies.
    reply: u32,
    peak_torque: f32,
    watchdog: f32,
    mode: Mode,
    fault_code: u8,
    guard: Guard<1>,
}

impl Drive {
    /// Mode by the last reply.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Why there is no torque, if the drive is safe.
    pub fn cause(&self) -> Option<Cause> {
        self.guard.cause()
    }

    /// The last fault code (register 0x00f) other than 0 since the last reset; 0 if there was none.
    pub fn fault_code(&self) -> u8 {
        self.fault_code
    }

    /// Leaves safe: a fault is cleared and the drive enabled, step by step.
    pub fn reset(&mut self) {
        self.fault_code = 0;
        self.guard.reset();
    }

    /// Takes a frame from the bus; what the drive measures, if it was its reply to the query. Frames of others are left alone.
    pub fn receive(&mut self, id: Id, data: &[u8]) -> Option<Feedback> {
        let id = match id {
            Id::Standard(id) => id.as_raw().into(),
            Id::Extended(id) => id.as_raw(),
        };
        if id != self.reply {
            return None;
        }
        let reply = Reply::parse(data);
        if reply.refused {
            self.guard.stop(Cause::Refused);
        }
        // The safe frame clears the drive's fault, and its code with it.
        if let Some(code) = reply.fault.filter(|code| *code != 0) {
            self.fault_code = code;
        }
        self.mode = Mode::of(reply.mode?);
        self.guard.heard(Cause::StatusLost);
        self.guard.status(self.mode.status());
        Feedback::new(reply.position?, reply.velocity?, reply.torque?)
    }

    /// Once a cycle of the bus: the frame that commands a torque (N m), or what leads there.
    pub fn step(&mut self, torque: f32) -> Frame {
        self.guard.cycle();
        let data = if self.operates() { self.command(torque) } else { padded(&[STOPPED, QUERY]) };
        Frame { id: self.id, data }
    }

    /// Whether the drive is told its position mode, enabled or on its way there.
    fn operates(&mut self) -> bool {
        if self.mode == Mode::Fault {
            // Once: `stopped` clears it.
            self.guard.attempt(self.guard.timeout(), Cause::DriveFault);
        }
        self.guard.cause().is_none() && matches!(self.mode, Mode::Stopped | Mode::Starting | Mode::Position)
    }

    fn command(&self, torque: f32) -> [u8; SIZE] {
        let torque = self.guard.torque(torque).to_le_bytes();
        let (peak, watchdog) = (self.peak_torque.to_le_bytes(), self.watchdog.to_le_bytes());
        padded(&[
            POSITION,
            FEED_FORWARD_TORQUE,
            &torque,
            NO_PROPORTIONAL_AND_DERIVATIVE,
            LARGEST_TORQUE,
            &peak,
            WATCHDOG,
            &watchdog,
            NO_INTEGRATOR,
            QUERY,
        ])
    }
}

fn padded(parts: &[&[u8]]) -> [u8; SIZE] {
    let mut data = [NOP; SIZE];
    for (place, byte) in data.iter_mut().zip(parts.iter().copied().flatten()) {
        *place = *byte;
    }
    data
}

/// What a reply says of the registers that are asked for. What is left out, not a number, or behind the first unknown byte is missing.
#[derive(Debug, Default, PartialEq)]
struct Reply {
    mode: Option<u8>,
    position: Option<f32>,
    velocity: Option<f32>,
    torque: Option<f32>,
    fault: Option<u8>,
    /// A register was not written, or not read.
    refused: bool,
}

impl Reply {
    fn parse(data: &[u8]) -> Self {
        let mut reply = Self::default();
        let mut rest = data;
        // A subframe takes at least one byte.
        while let Some(behind) = reply.subframe(rest) {
            rest = behind;
        }
        reply
    }

    /// What is behind the subframe; `None` at the end, or where none begins.
    fn subframe<'a>(&mut self, data: &'a [u8]) -> Option<&'a [u8]> {
        let (&kind, rest) = data.split_first()?;
        match kind {
            NOP => Some(rest),
            0x20..=0x2f => self.values(kind, rest),
            WRITE_ERROR | READ_ERROR => {
                self.refused = true;
                let (_register, rest) = varuint(rest)?;
                let (_error, rest) = varuint(rest)?;
                Some(rest)
            }
            _ => None,
        }
    }

    fn values<'a>(&mut self, kind: u8, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (number, rest) = match kind & 3 {
            0 => varuint(rest)?,
            number => (number.into(), rest),
        };
        let (first, mut rest) = varuint(rest)?;
        // Ends with the bytes, whatever the number.
        for register in 0..number {
            let (value, behind) = Value::take(kind, rest)?;
            self.set(first.checked_add(register)?, value);
            rest = behind;
        }
        Some(rest)
    }

    fn set(&mut self, register: u32, value: Value) {
        match register {
            0x000 => self.mode = value.code(),
            0x001 => self.position = value.quantity(REVOLUTIONS),
            0x002 => self.velocity = value.quantity(REVOLUTIONS_PER_SECOND),
            0x003 => self.torque = value.quantity(NEWTON_METRES),
            0x00f => self.fault = value.code(),
            _ => {}
        }
    }
}

/// A register's value as it comes.
#[derive(Clone, Copy)]
enum Value {
    Int8(i8),
    Int16(i16),
    Int32(i32),
    Float(f32),
}

impl Value {
    /// The value of this kind of subframe, and what is behind it.
    fn take(kind: u8, data: &[u8]) -> Option<(Self, &[u8])> {
        Some(match kind >> 2 & 3 {
            0 => taken(data, |bytes| Self::Int8(i8::from_le_bytes(bytes)))?,
            1 => taken(data, |bytes| Self::Int16(i16::from_le_bytes(bytes)))?,
            2 => taken(data, |bytes| Self::Int32(i32::from_le_bytes(bytes)))?,
            _ => taken(data, |bytes| Self::Float(f32::from_le_bytes(bytes)))?,
        })
    }

    /// A mode or a fault code.
    fn code(self) -> Option<u8> {
        match self {
            Self::Int8(code) => code.try_into().ok(),
            Self::Int16(code) => code.try_into().ok(),
            Self::Int32(code) => code.try_into().ok(),
            Self::Float(_) => None,
        }
    }

    /// Of an integer type the lowest value is "not a number".
    fn quantity(self, [int8, int16, int32]: Scales) -> Option<f32> {
        match self {
            Self::Int8(value) => (value != i8::MIN).then_some(f32::from(value) * int8),
            Self::Int16(value) => (value != i16::MIN).then_some(f32::from(value) * int16),
            Self::Int32(value) => (value != i32::MIN).then_some(value as f32 * int32),
            Self::Float(value) => Some(value),
        }
    }
}

fn taken<const N: usize>(data: &[u8], value: impl FnOnce([u8; N]) -> Value) -> Option<(Value, &[u8])> {
    let (bytes, rest) = data.split_first_chunk()?;
    Some((value(*bytes), rest))
}

/// A number of at most 32 bits in at most 5 bytes, and what is behind it.
fn varuint(data: &[u8]) -> Option<(u32, &[u8])> {
    let (mut number, mut rest) = (0, data);
    for shift in [0, 7, 14, 21, 28] {
        let (&byte, behind) = rest.split_first()?;
        number |= u32::from(byte & 0x7f) << shift;
        rest = behind;
        if byte & 0x80 == 0 {
            return Some((number, rest));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_can::StandardId;
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    const PARAMS: Params = Params { drive: 1, source: 0, peak_torque: 2.5, watchdog: 0.02, timeout: 10 };

    /// The reply that `docs/protocol/can.md` explains byte by byte, and its mode.
    const REPLY: [u8; 16] =
        [0x24, 0x04, 0x00, 0x0a, 0x00, 0x50, 0x00, 0x00, 0x01, 0x70, 0xff, 0x23, 0x0d, 0x18, 0x14, 0x00];

    fn from(id: u16) -> Id {
        StandardId::new(id).unwrap().into()
    }

    /// What the drive answers to the query in this mode, with this fault.
    fn reply(mode: u8, fault: u8) -> Vec<u8> {
        let [position, velocity, torque] = [-1.25_f32, 0.5, 0.75].map(f32::to_le_bytes);
        [&[0x21, 0x00, mode, 0x2f, 0x01], &position[..], &velocity, &torque, &[0x21, 0x0f, fault]].concat()
    }

    /// A subframe that writes or reads: first register, and for each the bytes that are written.
    #[derive(Debug, PartialEq)]
    enum Asked {
        Write(u8, Vec<Vec<u8>>),
        Read(u8, u8),
    }

    /// Takes a command apart, with numbers and registers below 128.
    fn asked(data: &[u8]) -> Vec<Asked> {
        let mut bytes = data.iter().copied();
        let mut all = vec![];
        while let Some(kind) = bytes.next() {
            if kind == NOP {
                continue;
            }
            let number = if kind & 3 == 0 { bytes.next().unwrap() } else { kind & 3 };
            let first = bytes.next().unwrap();
            let size = [1, 2, 4, 4][usize::from(kind >> 2 & 3)];
            all.push(match kind {
                0x00..=0x0f => {
                    let mut value = |_| bytes.by_ref().take(size).collect();
                    Asked::Write(first, (0..number).map(&mut value).collect())
                }
                0x10..=0x1f => Asked::Read(first, number),
                _ => panic!("{kind:#04x} in {data:02x?}"),
            });
        }
        all
    }

    fn query() -> Vec<Asked> {
        vec![Asked::Read(0x00, 1), Asked::Read(0x01, 3), Asked::Read(0x0f, 1)]
    }

    fn bytes(value: f32) -> Vec<u8> {
        value.to_le_bytes().to_vec()
    }

    /// The torque of a command, `None` of the safe frame; there is no third.
    fn torque_of(frame: Frame) -> Option<f32> {
        assert_eq!(frame.id, ExtendedId::new(0x8001).unwrap());
        let asked = asked(&frame.data);
        if asked[0] == Asked::Write(0x00, vec![vec![0]]) {
            assert_eq!(asked[1..], query());
            return None;
        }
        let Asked::Write(0x22, torque) = &asked[2] else { panic!("{asked:02x?}") };
        let torque = f32::from_le_bytes(torque[0][..].try_into().unwrap());
        let mut expected = vec![
            Asked::Write(0x00, vec![vec![10]]),
            Asked::Write(0x20, vec![vec![0x80]]),
            Asked::Write(0x22, vec![bytes(torque)]),
            Asked::Write(0x23, vec![vec![0], vec![0]]),
            Asked::Write(0x25, vec![bytes(2.5)]),
            Asked::Write(0x27, vec![bytes(0.02)]),
            Asked::Write(0x2b, vec![vec![0]]),
        ];
        expected.extend(query());
        assert_eq!(asked, expected);
        Some(torque)
    }

    /// One period in which the drive has this mode: the torque that is sent.
    fn period(drive: &mut Drive, mode: u8, torque: f32) -> Option<f32> {
        drive.receive(from(0x100), &reply(mode, 0));
        torque_of(drive.step(torque))
    }

    fn enabled() -> Drive {
        let mut drive = PARAMS.build().unwrap();
        drive.reset();
        for mode in [0, 2, 3, 4, 10] {
            period(&mut drive, mode, 1.0);
        }
        assert_eq!((drive.mode(), drive.cause()), (Mode::Position, None));
        drive
    }

    #[test]
    fn the_documented_commands_are_read_as_they_are_explained() {
        // docs/protocol/can.md: 01000a07206000200150ff140400130d, to id 8001.
        let command =
            [0x01, 0x00, 0x0a, 0x07, 0x20, 0x60, 0x00, 0x20, 0x01, 0x50, 0xff, 0x14, 0x04, 0x00, 0x13, 0x0d];
        let values = vec![vec![0x60, 0x00], vec![0x20, 0x01], vec![0x50, 0xff]];
        let expected = [
            Asked::Write(0x00, vec![vec![10]]),
            Asked::Write(0x20, values),
            Asked::Read(0x00, 4),
            Asked::Read(0x0d, 3),
        ];
        assert_eq!(asked(&command), expected);
        // docs/integration/can-fd.md: position 1, velocity 2.
        let command = [
            0x01, 0x00, 0x0a, 0x0e, 0x20, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x40, 0x11, 0x00, 0x1f,
            0x01, 0x13, 0x0d,
        ];
        let expected = [
            Asked::Write(0x00, vec![vec![10]]),
            Asked::Write(0x20, vec![bytes(1.0), bytes(2.0)]),
            Asked::Read(0x00, 1),
            Asked::Read(0x01, 3),
            Asked::Read(0x0d, 3),
        ];
        assert_eq!(asked(&command), expected);
    }

    #[test]
    fn the_documented_replies_are_read_as_they_are_explained() {
        let reply = Reply::parse(&REPLY);
        assert_eq!((reply.mode, reply.fault, reply.refused), (Some(10), Some(0), false));
        let close = |value: Option<f32>, expected: f32| (value.unwrap() - expected).abs() < 1e-6;
        // 2.88 degrees, 23.04 degrees/s, -1.44 N m.
        assert!(close(reply.position, 2.88 / 360.0));
        assert!(close(reply.velocity, 23.04 / 360.0));
        assert!(close(reply.torque, -1.44));
        // docs/integration/can-fd.md: stopped, no fault.
        let stopped = Reply { mode: Some(0), fault: Some(0), ..Reply::default() };
        assert_eq!(Reply::parse(&[0x21, 0x00, 0x00, 0x21, 0x0f, 0x00]), stopped);
    }

    #[test]
    fn every_type_of_value_is_scaled() {
        let close = |data: &[u8], position: f32| {
            let read = Reply::parse(data).position.unwrap();
            assert!((read - position).abs() <= position.abs() * 1e-6, "{data:02x?}: {read}");
        };
        close(&[0x21, 0x01, 0x81], -1.27);
        close(&[0x25, 0x01, 0xff, 0x7f], 3.2767);
        close(&[0x29, 0x01, 0x40, 0x42, 0x0f, 0x00], 10.0);
        close(&[0x2d, 0x01, 0x00, 0x00, 0xa0, 0xbf], -1.25);
        for lowest in [&[0x21, 0x01, 0x80][..], &[0x25, 0x01, 0, 0x80], &[0x29, 0x01, 0, 0, 0, 0x80]] {
            assert_eq!(Reply::parse(lowest), Reply::default());
        }
    }

    #[test]
    fn a_reply_is_read_up_to_where_it_ends() {
        let good = reply(10, 0);
        let whole = Reply::parse(&good);
        assert_eq!(Reply::parse(&[&[NOP, NOP], &good[..], &[NOP]].concat()), whole);
        assert_eq!(Reply::parse(&[&good[..], &[0x41, 0x00]].concat()), whole);
        for length in 0..good.len() {
            assert_ne!(Reply::parse(&good[..length]), whole);
        }
        // As many registers as a number of 5 bytes can tell; a number of 6 bytes.
        assert_eq!(Reply::parse(&[0x20, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00, 0x0a]).mode, Some(10));
        assert_eq!(Reply::parse(&[0x20, 0x81, 0x80, 0x80, 0x80, 0x80, 0x00, 0x00, 0x0a]), Reply::default());
        // Register 1 in two bytes; the one behind the last, which is not 0.
        assert_eq!(Reply::parse(&[0x21, 0x81, 0x00, 0x32]).position, Some(0.5));
        assert_eq!(Reply::parse(&[0x22, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00, 0x0a]), Reply::default());
    }

    #[test]
    fn it_is_enabled_step_by_step_and_only_then_driven() {
        let mut drive = PARAMS.build().unwrap();
        assert_eq!(period(&mut drive, 0, 1.0), None);
        assert_eq!(drive.cause(), Some(Cause::NotStarted));
        drive.reset();
        for mode in [0, 2, 3, 4] {
            assert_eq!(period(&mut drive, mode, 1.0), Some(0.0));
        }
        assert_eq!(period(&mut drive, 10, 1.0), Some(1.0));
        assert_eq!(period(&mut drive, 10, -9.0), Some(-2.5));
        assert_eq!(period(&mut drive, 10, f32::INFINITY), Some(2.5));
        assert_eq!(period(&mut drive, 10, f32::NAN), Some(0.0));
    }

    #[test]
    fn a_mode_that_was_left_behind_is_stopped_first() {
        for mode in [1, 5, 9, 11, 12, 15, 99] {
            let mut drive = PARAMS.build().unwrap();
            drive.reset();
            assert_eq!(torque_of(drive.step(1.0)), None);
            assert_eq!(period(&mut drive, mode, 1.0), None);
            assert_eq!(period(&mut drive, 0, 1.0), Some(0.0));
            assert_eq!(drive.cause(), None);
        }
    }

    #[test]
    fn what_the_drive_does_by_itself_makes_safe_until_a_reset() {
        for (mode, cause) in [
            (1, Cause::DriveFault),
            (11, Cause::WatchdogExpired),
            (0, Cause::Disabled),
            (3, Cause::Disabled),
            (9, Cause::Disabled),
        ] {
            let mut drive = enabled();
            assert_eq!(period(&mut drive, mode, 1.0), None);
            assert_eq!(period(&mut drive, 10, 1.0), None);
            assert_eq!(drive.cause(), Some(cause), "{mode}");
            drive.reset();
            assert_eq!(torque_of(drive.step(1.0)), Some(0.0));
            assert_eq!(period(&mut drive, 10, 1.0), Some(1.0));
        }
    }

    #[test]
    fn a_fault_that_stays_is_named_with_its_code() {
        let mut drive = PARAMS.build().unwrap();
        drive.reset();
        for _ in 0..=PARAMS.timeout {
            assert_eq!(drive.cause(), None);
            drive.receive(from(0x100), &reply(1, 40));
            assert_eq!(torque_of(drive.step(1.0)), None);
        }
        assert_eq!((drive.cause(), drive.fault_code()), (Some(Cause::DriveFault), 40));
        period(&mut drive, 0, 1.0);
        assert_eq!(drive.fault_code(), 40);
        drive.reset();
        assert_eq!(drive.fault_code(), 0);
    }

    #[test]
    fn what_limits_the_torque_is_no_fault() {
        let mut drive = enabled();
        drive.receive(from(0x100), &reply(10, 102));
        assert_eq!(torque_of(drive.step(1.0)), Some(1.0));
        assert_eq!((drive.cause(), drive.fault_code()), (None, 102));
    }

    #[test]
    fn a_refused_register_makes_safe() {
        let mut drive = enabled();
        drive.receive(from(0x100), &[&[0x30, 0x2b, 0x01][..], &reply(10, 0)].concat());
        assert_eq!(torque_of(drive.step(1.0)), None);
        assert_eq!((drive.mode(), drive.cause()), (Mode::Position, Some(Cause::Refused)));
    }

    #[test]
    fn silence_is_noticed_after_the_timeout_and_not_before() {
        for (id, data) in [(0x101, reply(10, 0)), (0x200, reply(10, 0)), (0x100, vec![0x21, 0x0f, 0x00])] {
            let mut drive = enabled();
            for _ in 1..PARAMS.timeout {
                drive.receive(from(id), &data);
                assert_eq!(torque_of(drive.step(1.0)), Some(1.0));
            }
            drive.receive(from(id), &data);
            assert_eq!(torque_of(drive.step(1.0)), None);
            assert_eq!(drive.cause(), Some(Cause::StatusLost));
        }
    }

    #[test]
    fn what_it_measures_is_told_when_all_of_it_has_come() {
        let mut drive = PARAMS.build().unwrap();
        let feedback = Feedback { position: -1.25, velocity: 0.5, torque: 0.75 };
        assert_eq!(drive.receive(from(0x100), &reply(10, 0)), Some(feedback));
        let extended = ExtendedId::new(0x100).unwrap().into();
        assert_eq!(drive.receive(extended, &reply(10, 0)), Some(feedback));
        assert_eq!(drive.receive(from(0x100), &[0x21, 0x00, 0x0a]), None);
        assert_eq!(drive.receive(from(0x101), &reply(10, 0)), None);
        let no_number = [&[0x21, 0x00, 0x0a, 0x2f, 0x01][..], &[0xff; 12]].concat();
        assert_eq!(drive.receive(from(0x100), &no_number), None);
    }

    #[test]
    fn addresses_are_in_the_identifiers() {
        let mut drive = Params { drive: 0x12, source: 0x34, ..PARAMS }.build().unwrap();
        assert_eq!(drive.step(0.0).id, ExtendedId::new(0xb412).unwrap());
        let reply_id = ExtendedId::new(0x1234).unwrap().into();
        assert!(drive.receive(reply_id, &reply(0, 0)).is_some());
    }

    #[test]
    fn parameters_out_of_range_build_no_drive() {
        let bad = [
            Params { drive: 0, ..PARAMS },
            Params { drive: 127, ..PARAMS },
            Params { source: 127, ..PARAMS },
            Params { source: 1, ..PARAMS },
            Params { peak_torque: 0.0, ..PARAMS },
            Params { watchdog: 0.0, ..PARAMS },
            Params { watchdog: f32::NAN, ..PARAMS },
            Params { watchdog: f32::INFINITY, ..PARAMS },
            Params { timeout: 0, ..PARAMS },
        ];
        assert!(bad.iter().all(|params| params.build().is_none()));
    }

    /// Any bytes, or replies that are in order.
    fn any_reply() -> impl Strategy<Value = Vec<u8>> {
        prop_oneof![
            prop::collection::vec(any::<u8>(), 0..65),
            (0_u8..16, any::<u8>()).prop_map(|(mode, fault)| reply(mode, fault)),
            Just(reply(10, 0)),
        ]
    }

    proptest! {
        #[test]
        fn any_replies_leave_the_torque_bounded_and_safe_latched(
            replies in prop::collection::vec((prop::bool::weighted(0.8), any_reply()), 0..60),
            torque in prop::num::f32::ANY,
        ) {
            let mut drive = PARAMS.build().unwrap();
            drive.reset();
            let mut latched = None;
            for (ours, data) in replies {
                drive.receive(from(if ours { 0x100 } else { 0x200 }), &data);
                let sent = torque_of(drive.step(torque));
                prop_assert!(sent.is_none_or(|sent| sent.abs() <= 2.5));
                prop_assert!(sent.is_none_or(|sent| sent == 0.0 || drive.mode() == Mode::Position));
                latched = latched.or(drive.cause());
                prop_assert_eq!(drive.cause(), latched);
                prop_assert!(latched.is_none() || sent.is_none());
            }
        }

        #[test]
        fn any_bytes_are_read(data in prop::collection::vec(any::<u8>(), 0..65)) {
            Reply::parse(&data);
        }

        #[test]
        fn any_subframes_are_read(kind in 0x20_u8..0x30, data in prop::collection::vec(any::<u8>(), 0..64)) {
            Reply::parse(&[&[kind][..], &data].concat());
        }
    }
}
