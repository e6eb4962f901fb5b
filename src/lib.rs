//! Harmonic-drive torsion, friction and hysteresis on the joint controller's microcontroller.
#![no_std]
#![warn(missing_docs)]

#[cfg(test)]
extern crate std;

pub mod angle;
pub mod compensator;
pub mod error;
pub mod flexspline;
pub mod friction;
pub mod gear;
pub mod hysteresis;
pub mod kinematic_error;
pub mod real;

pub use angle::{Angle, Ratio};
pub use error::Error;
pub use real::Real;
