//! From references to the torque command: braking, cascade, fallback, mode, protection of the gear, supervisor.

pub mod braking;
pub mod cascade;
pub mod fallback;
pub mod mode;
pub mod protection;
pub mod supervisor;
