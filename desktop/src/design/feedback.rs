//! Gains of the compensator's motor-side cascade ([`strainwave::compensator::actuate::cascade`]), for the joint of a gear
//! file.

use strainwave::Real;
use strainwave::compensator::actuate::cascade::FeedbackParams;

use crate::io::gear_file::GearFile;

/// k_p over omega_v, and T_i times omega_v.
const POSITION_TO_VELOCITY: f64 = 0.375;
const INTEGRAL_PERIODS: f64 = 7.5;
/// omega_f over omega_v.
const FILTER_TO_VELOCITY: f64 = 10.0;

/// The compensator's motor-side cascade, from the file's velocity bandwidth f_v.
///
/// ```text
/// omega_v = 2*pi*f_v,   k_v = omega_v*(J_wg + r^2*J_fs),   k_p = 0.375*omega_v,   T_i = 7.5/omega_v,   omega_f = 10*omega_v
/// ```
///
/// The velocity loop sees the rotor and the reflected load as one inertia; its gain is the file's, for above the torsion
/// mode it meets the rotor alone, and that limits it. The position gain is half as large again as that of a cascade without
/// feed-forward (a quarter of omega_v), which must spare it for its own setpoint's steps. Larger gains follow a load step
/// better, but hunt about rest where friction has no presliding: at 0.475*omega_v.
pub fn feedback_params<R: Real>(file: &GearFile) -> FeedbackParams<R> {
    let r: f64 = file.gear.signed_ratio().value();
    let inertia = file.inertia.wave_generator + r * r * file.inertia.flexspline;
    let velocity = std::f64::consts::TAU * file.feedback.velocity_bandwidth;
    FeedbackParams {
        position_gain: R::lit(POSITION_TO_VELOCITY * velocity),
        velocity_gain: R::lit(velocity * inertia),
        integral_time: R::lit(INTEGRAL_PERIODS / velocity),
        filter_corner: R::lit(FILTER_TO_VELOCITY * velocity),
        torque_limit: R::lit(file.motor.peak_torque),
    }
}
