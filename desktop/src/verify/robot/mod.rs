//! Robots of several joints: the rigid arm against laws and MuJoCo, and scenario S7.
//!
//! | figure | definition |
//! | --- | --- |
//! | `robot.rigid.energy` | change of the energy of the rigid two-joint arm that swings 10 s without loss, over its largest kinetic energy |
//! | `robot.rigid.swing` | largest difference of its angles from MuJoCo's over the first 2 s (rad) |
//! | `robot.rigid.torques` | largest difference of the torques of a spatial arm's inverse dynamics from MuJoCo's, over the largest torque |
//! | `robot.s7.motor.to_b1`, `robot.s7.both.to_b1` | tip error of S7, rms, over that of B1 at both joints on the same robot, the worst of the robots |
//! | `robot.s7.b1`, `.motor`, `.both`, `.b3` | median of the tip error itself (m), of the baseline B3 with both encoders too; only reported |
//!
//! S7: the arm of `examples/arm/arm.toml` works 10 s under gravity ([`crate::robot::motions`]) and then draws two laps of a circle
//! ([`crate::robot::circle`]), every controller on its own. Robots are drawn as [`crate::robot::sample`] says, their meshes condensed.

mod oracle;
mod s7;

use crate::plant::divergence::RunError;
use crate::verify::{BadInput, Measured};

/// Robots that S7 is judged on.
pub const ROBOTS: u64 = 20;
/// The first seed that claims are judged on.
pub const FIRST: u64 = 10_000;

/// Every figure, S7 on so many robots; `progress` is called with the fraction done.
///
/// # Errors
/// Oracle tables that cannot be used, or a robot that cannot be built or diverges.
pub fn measure(first: u64, robots: u64, progress: impl FnMut(f64)) -> Result<Measured, BadInput> {
    let mut measured = Measured::from(oracle::figures()?);
    measured.add(s7::measure(first, robots, progress).map_err(BadInput::message)?);
    Ok(measured.with_tight_bounds())
}

/// The rigid arm alone.
///
/// # Errors
/// As [`measure`].
pub fn rigid() -> Result<Measured, BadInput> {
    Ok(Measured::from(oracle::figures()?).with_tight_bounds())
}

/// One robot of S7: tip error of B1 and of the compensator with either set of sensors, rms (m).
///
/// # Errors
/// A robot that cannot be built or diverges.
pub fn s7(seed: u64) -> Result<[f64; 3], RunError> {
    s7::errors(seed)
}
