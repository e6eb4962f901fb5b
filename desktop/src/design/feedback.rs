//! Gains of the compensator's motor-side cascade ([`strainwave::compensator::actuate::cascade`]), for the joint of a gear
//! file.

use std::f64::consts::TAU;

use strainwave::Real;
use strainwave::compensator::actuate::cascade::FeedbackParams;

use crate::design::tuned::FILTER_TO_VELOCITY;
use crate::io::gear_file::GearFile;

/// The compensator's motor-side cascade, from the bandwidths of the file's `[feedback]`.
///
/// ```text
/// omega_v = 2*pi*f_v,   k_v = omega_v*(J_wg + r^2*J_fs),   k_p = 2*pi*f_p,   T_i as in the file,   omega_f = 10*omega_v
/// ```
///
/// The velocity loop sees the rotor and the reflected load as one inertia.
pub fn feedback_params<R: Real>(file: &GearFile) -> FeedbackParams<R> {
    let r: f64 = file.gear.signed_ratio().value();
    let inertia = file.inertia.wave_generator + r * r * file.inertia.flexspline;
    let velocity = TAU * file.feedback.velocity_bandwidth;
    FeedbackParams {
        position_gain: R::lit(TAU * file.feedback.position_bandwidth),
        velocity_gain: R::lit(velocity * inertia),
        integral_time: R::lit(file.feedback.integral_time),
        filter_corner: R::lit(FILTER_TO_VELOCITY.get() * velocity),
        torque_limit: R::lit(file.motor.peak_torque),
    }
}
