//! From references to the torque command: the cascade, and what it falls back to.

pub mod cascade;
pub mod fallback;
pub mod mode;
pub mod protection;
