//! What passes between the node and the joint.

/// What the joint is to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Position of the output (counts of 2^-26 revolution), which wraps.
    Position(i32),
    /// Velocity of the output (counts/s).
    Velocity(i32),
    /// Torque at the output (N m), at most 32.767 times the rated one.
    Torque(f32),
}

/// What the joint's power is to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Wanted {
    /// No torque.
    #[default]
    Off,
    /// No torque, but the drive is to be powered: operation is enabled as soon as it is.
    Standby,
    /// Stop, whatever the target.
    Brake,
    /// Follow the target.
    On,
}

/// What the joint measures and says of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actual {
    /// The joint knows its state: it can be switched on.
    pub ready: bool,
    /// The drive follows a torque, or does so at once: operation can be enabled. Its end in operation is to be told as a fault.
    pub powered: bool,
    /// Position of the output (counts of 2^-26 revolution), which wraps.
    pub position: i32,
    /// Velocity of the output (counts/s).
    pub velocity: i32,
    /// Torque at the output (N m).
    pub torque: f32,
    /// Error code of the joint's own fault, with which it is off; 0 without.
    pub fault: u16,
    /// The joint does not move.
    pub at_rest: bool,
    /// It follows the target, which may be out of its reach.
    pub follows: bool,
}
