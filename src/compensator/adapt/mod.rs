//! Parameters and ripple that are adapted while the joint works.

pub mod gravity;
pub mod learning;
pub mod parameters;
pub mod ripple;
