//! The real-time gear, open loop, driven as fast as an encoder can report and wound up to its range.

use proptest::prelude::*;
use strainwave::compensator::RealTimeGear;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::flexspline::{Reduced, reduced};
use strainwave::gear::{GearParams, Motion};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::firmware_gear_params;

/// Half a revolution in a control period: the most that two readings of an encoder can differ by (rad/s).
const FASTEST: f32 = std::f32::consts::PI / CONTROL_PERIOD as f32;

fn gear() -> (GearParams<f32>, RealTimeGear<f32>) {
    let params = firmware_gear_params::<f32>(&GearFile::default_gear()).unwrap();
    let flexspline = Reduced::build(&params.flexspline, params.rated_torque).unwrap();
    let gear = params.build(flexspline, CONTROL_PERIOD as f32).unwrap();
    (params, gear)
}

/// Angle and rate of an encoder of 19 bits that moves by `counts` in a period.
fn turned(motor: &Motion<f32>, counts: i32) -> Motion<f32> {
    let mut angle = motor.angle;
    angle.counts += i64::from(counts) << 13;
    Motion { angle, velocity: counts as f32 / (1 << 18) as f32 * FASTEST }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Any counts of the encoder, the wildest among them, from any torsion within the range.
    #[test]
    fn any_encoder_and_any_torsion_leave_the_gear_bounded(
        torsion in -1.0..1.0f32,
        counts in prop::collection::vec(-(1 << 18)..=1 << 18, 1..300),
        swing in prop::sample::select(vec![0, 1 << 18]),
    ) {
        let (params, gear) = gear();
        let largest = reduced::RANGE as f32 * params.rated_torque;
        let (mut state, mut motor, mut flange) = (gear.rest(), Motion::default(), Motion::default());
        flange.angle = flange.angle.plus(-torsion * gear.flexspline().torsion(largest));
        // With hysteresis at its widest; past this speed viscous friction alone outweighs it.
        let hysteresis = params.flexspline.line.stiffness[0] * params.hysteresis_width;
        let fastest = (largest + hysteresis) / params.output_friction.forward.viscous;
        let mut saturated = false;
        for (k, count) in counts.iter().enumerate() {
            let alternating = if k % 2 == 0 { swing } else { -swing };
            motor = turned(&motor, if swing == 0 { *count } else { alternating });
            let torques = gear.step(&mut state, &mut flange, &motor, 0.0);
            saturated |= torques.saturated;
            prop_assert!(torques.transmitted.abs() <= largest + hysteresis, "{:?}", torques);
            prop_assert!(torques.wave_generator.is_finite());
            prop_assert!(flange.velocity.abs() <= fastest, "{:?}", flange);
        }
        // A quarter revolution is 1.6e-2 rad at the output, from anywhere in the range to beyond it.
        prop_assert!(saturated || counts.iter().all(|count| count.abs() < 1 << 17));
        // Held, it comes to rest within its range.
        let held = Motion { velocity: 0.0, ..motor };
        let torques = (0..40_000).map(|_| gear.step(&mut state, &mut flange, &held, 0.0)).last().unwrap();
        prop_assert!(!torques.saturated && flange.velocity.abs() < 1e-3, "{:?} {:?}", torques, flange);
    }
}

/// The motor runs away steadily: the torque stays at its end, and the answer says so in every step.
#[test]
fn a_motor_that_runs_away_meets_the_end_of_the_range() {
    let (params, gear) = gear();
    let largest = reduced::RANGE as f32 * params.rated_torque;
    let (mut state, mut motor, mut flange) = (gear.rest(), Motion::default(), Motion::default());
    for k in 0..30_000 {
        motor = turned(&motor, 1 << 18);
        let torques = gear.step(&mut state, &mut flange, &motor, 0.0);
        assert!(torques.saturated && torques.transmitted < 0.0, "step {k}: {torques:?}");
        let law = (torques.transmitted - torques.hysteresis).abs();
        assert!((law / largest - 1.0).abs() < 1e-6, "step {k}: {torques:?}");
        // After ten of its time constants J_fs/F_v the flange runs as fast as that torque can turn it.
        let left = torques.transmitted - torques.output_friction;
        assert!(k < 29_000 || left.abs() < 1e-2 * largest, "step {k}: {torques:?}");
    }
}
