//! From references to the torque command: braking, cascade, fallback, limit cycle, mode, protection of the gear, supervisor.

pub mod braking;
pub mod cascade;
pub mod fallback;
pub mod limit_cycle;
pub mod mode;
pub mod protection;
pub mod supervisor;
