//! Gains of the observer: which it has, and with them which friction.

/// Which gains the observer has, and with them which friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The motor moves, friction slides.
    Moving,
    /// It stands, friction is a spring.
    Standing,
}

impl Mode {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Moving, Self::Standing];
}
