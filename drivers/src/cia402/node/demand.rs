//! What the master asks for: its RPDOs, the mode of operation, and the target of that mode.

use super::Target;

/// Mode of operation, object 0x6060.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Cyclic synchronous position.
    Position = 8,
    /// Cyclic synchronous velocity.
    Velocity = 9,
    /// Cyclic synchronous torque.
    Torque = 10,
}

impl Mode {
    pub(super) const fn of(mode: i8) -> Option<Self> {
        match mode {
            8 => Some(Self::Position),
            9 => Some(Self::Velocity),
            10 => Some(Self::Torque),
            _ => None,
        }
    }
}

/// Bits 7, 8 and 9 of object 0x6502.
pub(super) const SUPPORTED_MODES: u32 = 0b111 << 7;

/// What RPDO1 carries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rpdo1 {
    pub(super) controlword: u16,
    mode: i8,
    position: i32,
}

impl Rpdo1 {
    pub(super) const fn of([c0, c1, mode, p0, p1, p2, p3]: [u8; 7]) -> Self {
        Self {
            controlword: u16::from_le_bytes([c0, c1]),
            mode: i8::from_le_bytes([mode]),
            position: i32::from_le_bytes([p0, p1, p2, p3]),
        }
    }
}

/// What RPDO2 carries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rpdo2 {
    velocity: i32,
    torque: i16,
}

impl Rpdo2 {
    pub(super) const fn of([v0, v1, v2, v3, t0, t1]: [u8; 6]) -> Self {
        Self { velocity: i32::from_le_bytes([v0, v1, v2, v3]), torque: i16::from_le_bytes([t0, t1]) }
    }
}

/// What the RPDOs have brought since the last SYNC.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Received {
    pub(super) first: Option<Rpdo1>,
    pub(super) second: Option<Rpdo2>,
}

/// What is in effect.
#[derive(Clone, Debug, Default)]
pub(super) struct Demand {
    /// `None` until one was asked for.
    pub(super) mode: Option<Mode>,
    pub(super) position: i32,
    pub(super) velocity: i32,
    /// Thousandths of the rated torque.
    pub(super) torque: i16,
}

impl Demand {
    /// A SYNC makes effective what has come; true if all that the mode needs was there.
    pub(super) fn take(&mut self, received: Received) -> bool {
        if let Some(Rpdo1 { mode, position, .. }) = received.first {
            self.mode = Mode::of(mode).or(self.mode);
            self.position = position;
        }
        if let Some(Rpdo2 { velocity, torque }) = received.second {
            (self.velocity, self.torque) = (velocity, torque);
        }
        let second = matches!(self.mode, Some(Mode::Velocity | Mode::Torque));
        received.first.is_some() && (received.second.is_some() || !second)
    }

    /// Object 0x6061.
    pub(super) fn display(&self) -> i8 {
        self.mode.map_or(0, |mode| mode as i8)
    }

    /// The target of the mode; a torque as a multiple of the rated one (N m).
    pub(super) fn target(&self, rated_torque: f32) -> Option<Target> {
        self.mode.map(|mode| match mode {
            Mode::Position => Target::Position(self.position),
            Mode::Velocity => Target::Velocity(self.velocity),
            // Symmetric: -32768 is no more than -32767.
            Mode::Torque => Target::Torque(f32::from(self.torque.max(-i16::MAX)) * (rated_torque / 1000.0)),
        })
    }
}
