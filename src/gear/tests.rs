//! Laws of the gear.

use super::*;
use crate::flexspline::Reduced;
use crate::flexspline::calibration::tests::SIZE_25;
use crate::friction::{JointFriction, LubricatedContactParams, Order};
use crate::kinematic_error::Term;
use proptest::prelude::*;

type TestGear<R> = Gear<R, Reduced<R, 8, 3>, JointFriction<R>, 24, 24>;
const DT: f64 = 1e-5;

fn friction(coulomb: f64, stribeck_velocity: f64, viscous: f64, presliding: f64) -> JointFrictionParams<f64> {
    let static_level = coulomb;
    let contact =
        LubricatedContactParams { coulomb, static_level, stribeck_velocity, stribeck_exponent: 1.0, viscous };
    JointFrictionParams::symmetric(Order::Two, contact, presliding, 0.3)
}

/// The default gear with Fs = Fc.
pub(crate) fn params() -> GearParams<f64> {
    let mut kinematic_error = KinematicErrorParams::default();
    kinematic_error.case[0] = Term { order: 2, amplitude: 1e-4, phase: 0.3 };
    kinematic_error.flexspline[0] = Term { order: 4, amplitude: 2e-5, phase: 0.0 };
    GearParams {
        ratio: -100,
        rated_torque: 67.0,
        flexspline: SIZE_25,
        hysteresis_width: 2.909e-4,
        hysteresis_table: None,
        kinematic_error,
        input_friction: friction(0.035, 2.0, 1.2e-4, 0.02),
        output_friction: friction(1.0, 0.02, 4.0, 2e-4),
        wave_generator_inertia: 6e-5,
        flexspline_inertia: 1.2,
    }
}

fn gear(params: &GearParams<f64>) -> TestGear<f64> {
    params.build(Reduced::build(&params.flexspline, params.rated_torque).unwrap(), DT).unwrap()
}

/// Torsion after the wave generator was held and a load put on and waited for.
fn wind_up(params: &GearParams<f64>, load: f64) -> f64 {
    let gear = gear(params);
    let (mut state, mut flange) = (gear.rest(), Motion::default());
    let mut torsion = 0.0;
    for k in 0..200_000 {
        let ramp = (f64::from(k) / 100_000.0).min(1.0);
        torsion = gear.step(&mut state, &mut flange, &Motion::default(), load * ramp).torsion;
    }
    torsion
}

#[test]
fn a_load_winds_up_against_itself_by_the_catalogues_line() {
    let mut params = params();
    params.hysteresis_width = 0.0;
    params.kinematic_error = KinematicErrorParams::default();
    params.output_friction = friction(0.0, 0.02, 4.0, 2e-4);
    let line = params.flexspline.line.build().unwrap();
    for load in [-50.0, 10.0, 67.0] {
        let torsion = wind_up(&params, load);
        assert!((torsion - line.torsion(-load)).abs() < 1e-3 * torsion.abs(), "{torsion} under {load}");
    }
}

#[test]
fn the_output_turns_by_the_signed_ratio() {
    for (ratio, expected) in [(-100, -0.01), (101, 1.0 / 101.0)] {
        let params = GearParams { ratio, ..params() };
        let gear = gear(&params);
        let (mut state, mut flange, mut motor) = (gear.rest(), Motion::default(), Motion::default());
        for _ in 0..100_000 {
            motor.velocity += DT * 10.0;
            motor.angle = motor.angle.plus(DT * motor.velocity);
            gear.step(&mut state, &mut flange, &motor, 0.0);
        }
        let moved = flange.angle.to_radians() / motor.angle.to_radians();
        assert!((moved / expected - 1.0).abs() < 0.01, "{moved}");
    }
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let refused = |change: fn(&mut GearParams<f64>)| {
        let mut params = params();
        change(&mut params);
        let flexspline = Reduced::<f64, 8, 3>::build(&SIZE_25, 67.0).unwrap();
        params.build::<_, 24, 24>(flexspline, DT).err()
    };
    assert_eq!(refused(|p| p.ratio = 0), Some(Error::OutOfRange("ratio")));
    assert_eq!(refused(|p| p.rated_torque = -1.0), Some(Error::OutOfRange("rated_torque")));
    assert_eq!(refused(|p| p.hysteresis_width = 1.0), Some(Error::OutOfRange("width")));
    assert_eq!(refused(|p| p.flexspline_inertia = 1e-6), Some(Error::OutOfRange("dt")));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    /// Power in at both ports = rate of stored energy + losses, and the losses are never negative. In slower
    /// motions most of what moves is presliding, whose force is that of the step's start.
    #[test]
    fn the_power_balance_closes(amplitude in 5.0..20.0f64, frequency in 1.0..20.0f64, load in -60.0..60.0f64) {
        let params = params();
        let gear = gear(&params);
        let (mut state, mut flange, mut motor) = (gear.rest(), Motion::default(), Motion::default());
        let (mut came, mut lost, mut hysteresis, mut moved) = (0.0, 0.0, 0.0, 0.0);
        for k in 0..50_000 {
            let time = f64::from(k) * DT;
            let acceleration = amplitude * frequency * (frequency * time).cos();
            let pull = load * (3.0 * time).sin();
            let before = (motor.velocity, flange.velocity);
            let torques = gear.torques(&mut state, &motor, &flange, Applied::default());
            motor.advance(acceleration, DT);
            flange.advance(gear.flange_acceleration(&torques, pull), DT);
            let turned = (0.5 * DT * (before.0 + motor.velocity), 0.5 * DT * (before.1 + flange.velocity));
            let supplied = torques.wave_generator + params.wave_generator_inertia * acceleration;
            came += supplied * turned.0 + pull * turned.1;
            moved += (supplied * turned.0).abs() + (pull * turned.1).abs();
            lost += torques.input_friction * turned.0 + torques.output_friction * turned.1
                + torques.damping_loss * DT;
            hysteresis += torques.hysteresis * (torques.slope * turned.0 - turned.1);
        }
        let stored = 0.5 * params.wave_generator_inertia * motor.velocity.powi(2)
            + 0.5 * params.flexspline_inertia * flange.velocity.powi(2)
            + gear.flexspline_energy(&state, &motor, &flange);
        prop_assert!((came - stored - lost - hysteresis).abs() < 1e-3 * moved, "{came} {stored} {lost} {hysteresis}");
        prop_assert!(lost >= 0.0);
    }
}
