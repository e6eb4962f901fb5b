//! Bounds of every output of a control step for any input: finite numbers within the joint's limits.

use strainwave::compensator::{JointParams, Output};

/// Largest torsion that is estimated (rad).
const TORSION: f32 = 0.02;
/// The same friction of either side (N m).
const FRICTION: f32 = 100.0;
/// Largest fraction of a count of an angle (rad).
const REST: f32 = 2.0;

/// The first value of `output` that is not finite or beyond its bound, by name; `None` when there is none.
pub fn beyond_bounds(joint: &JointParams<f32>, output: &Output<f32>) -> Option<&'static str> {
    let (limits, estimate) = (&joint.limits, &output.estimate);
    let (deviation, factors) = (&estimate.deviation, &output.factors);
    let bounded = [
        ("motor torque", output.motor_torque, limits.motor_torque),
        ("feed-forward torque", output.feed_forward_torque, limits.motor_torque),
        ("motor reference", output.motor_reference.rest, REST),
        ("output position", estimate.output_position.rest, REST),
        ("output velocity", estimate.output_velocity, 2.0 * limits.output_speed(joint.gear.ratio)),
        ("torsion", estimate.torsion, TORSION),
        ("transmitted torque", estimate.transmitted_torque, 4.0 * limits.output_torque),
        ("input friction", estimate.input_friction, FRICTION),
        ("output friction", estimate.output_friction, FRICTION),
        ("external torque", estimate.external_torque, limits.output_torque),
        ("deviation of the output position", deviation.output_position, f32::MAX),
        ("deviation of the output velocity", deviation.output_velocity, f32::MAX),
        ("deviation of the torsion", deviation.torsion, f32::MAX),
        ("deviation of the transmitted torque", deviation.transmitted_torque, f32::MAX),
        ("deviation of the input friction", deviation.input_friction, f32::MAX),
        ("deviation of the output friction", deviation.output_friction, f32::MAX),
        ("deviation of the external torque", deviation.external_torque, f32::MAX),
        ("factor on the inertia", factors.inertia, f32::MAX),
        ("factor on the input friction", factors.input_friction, f32::MAX),
        ("factor on the output friction", factors.output_friction, f32::MAX),
        ("factor on the compliance", factors.compliance, f32::MAX),
    ];
    let beyond = |(_, value, bound): &(&str, f32, f32)| value.is_nan() || value.abs() > *bound;
    bounded.iter().find(|row| beyond(row)).map(|(name, ..)| *name)
}
