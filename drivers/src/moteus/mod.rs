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
//! | file | |
//! | --- | --- |
//! | `reply` | what a reply says, subframe by subframe |
//! | `value` | a register's value in each of its types |
//!
//! Reference: mjbots/moteus at db1a7623, `docs/protocol/can.md`, `docs/protocol/registers.md`, `docs/guides/control-modes.md` ("Torque Control");
//! mjbots/mjlib, `mjlib/multiplex/format.h`.

mod reply;
#[cfg(test)]
mod tests;
mod value;

use embedded_can::{ExtendedId, Id};

use self::reply::{NOP, Reply};
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
/// Number of the message that the drive has to send: its only one.
const REPLIES: usize = 0;

/// Bytes of a frame that is sent: the torque command has 37, and CAN FD knows 32 and 48.
const SIZE: usize = 48;

const STOPPED: &[u8] = &[0x01, 0x00, 0x00];
/// Position mode, and the position where it is.
const POSITION: &[u8] = &[0x01, 0x00, 0x0a, 0x01, 0x20, 0x80];
const FEED_FORWARD_TORQUE: &[u8] = &[0x0d, 0x22];
const NO_PROPORTIONAL_AND_DERIVATIVE: &[u8] = &[0x02, 0x23, 0x00, 0x00];
const LARGEST_TORQUE: &[u8] = &[0x0d, 0x25];
const WATCHDOG: &[u8] = &[0x0d, 0x27];
const NO_INTEGRATOR: &[u8] = &[0x01, 0x2b, 0x00];
const QUERY: &[u8] = &[0x11, 0x00, 0x1f, 0x01, 0x11, 0x0f];

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
        self.guard.heard(REPLIES);
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
