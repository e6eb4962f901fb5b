//! Capability of a joint: the loads and moves of a scenario scale with the ratings of the gear.
//!
//! ```text
//! loads   as on the default gear, times  tau_rated/67 N m
//! moves   as on the default gear, times  min(1, 0.75*omega_max/(abs n*v), 0.5*tau_p/(J_fs*a),
//!                                            0.6*tau_max/(abs n*J_wg*a + J_fs*a/abs n))
//! ```
//!
//! v and a: largest speed and acceleration of S3 as the default gear makes it, 4.4 rad/s and 60 rad/s^2. tau_p: peak torque
//! through the gear, tau_max and omega_max: of the motor. The default gear's are within all of them.

use crate::io::gear_file::GearFile;

/// Duration of the move of S3 (s).
pub(crate) const FAST_MOVE: f64 = 0.25;
/// Its distance on the default gear (rad).
pub(crate) const FAST_MOVE_DISTANCE: f64 = 0.5;
/// Rated torque of the default gear (N m), that the scenarios' loads refer to.
const RATED: f64 = 67.0;
/// Largest first and second derivative of the move from 0 to 1 in 1.
const SMOOTH_SPEED: f64 = 2.1875;
const SMOOTH_ACCELERATION: f64 = 7.5132;

/// Ratings of a joint that the scenarios scale with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capability {
    /// Rated torque through the gear (N m).
    pub rated_torque: f64,
    /// Size of its moves, in those of the default gear.
    pub moves: f64,
}

impl Default for Capability {
    /// The default gear's.
    fn default() -> Self {
        Self { rated_torque: RATED, moves: 1.0 }
    }
}

impl Capability {
    /// Of the joint of a gear file.
    pub fn of(file: &GearFile) -> Self {
        let n = f64::from(file.gear.ratio);
        let speed = FAST_MOVE_DISTANCE * SMOOTH_SPEED / FAST_MOVE;
        let acceleration = FAST_MOVE_DISTANCE * SMOOTH_ACCELERATION / (FAST_MOVE * FAST_MOVE);
        let (load, rotor) =
            (file.inertia.flexspline * acceleration, file.inertia.wave_generator * acceleration);
        let fractions = [
            0.75 * file.motor.rotor_speed_limit / (n * speed),
            0.5 * file.gear.peak_torque / load,
            0.6 * file.motor.peak_torque / (n * rotor + load / n),
        ];
        Self { rated_torque: file.gear.rated_torque, moves: fractions.into_iter().fold(1.0, f64::min) }
    }

    /// A load of the default gear (N m), as it is on this joint.
    pub fn load(&self, load: f64) -> f64 {
        load * (self.rated_torque / RATED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_gear_does_all_of_it() {
        assert_eq!(Capability::of(&GearFile::default_gear()), Capability::default());
    }

    /// Half the speed, torque or rating halves the moves at most; loads follow the rating.
    #[test]
    fn a_smaller_joint_gets_smaller_tasks() {
        let of = |change: fn(&mut GearFile)| {
            let mut file = GearFile::default_gear();
            change(&mut file);
            Capability::of(&file)
        };
        let slow = of(|file| file.motor.rotor_speed_limit *= 0.5);
        assert!(slow.moves < 0.55 && slow.moves > 0.45, "{slow:?}");
        assert!(of(|file| file.inertia.flexspline *= 4.0).moves < 0.4);
        assert!(of(|file| file.motor.peak_torque *= 0.25).moves < 0.4);
        let small = of(|file| file.gear.rated_torque *= 0.1);
        assert!((small.load(50.0) - 5.0).abs() < 1e-12);
    }
}
