//! Laws of the belt gear.

use super::*;
use crate::friction::{LubricatedContactParams, Order, Viscous, ViscousParams};
use proptest::prelude::*;

const PITCH_ERROR_FREE: [PitchTerm<f64>; PITCH_TERMS] =
    [PitchTerm { order: 0, amplitude: 0.0, phase: 0.0 }; PITCH_TERMS];

/// 20 to 60 teeth, steel cords, without pitch error; viscous friction at the output.
fn params(viscous: f64, damping_time: f64) -> BeltParams<f64, ViscousParams<f64>> {
    let none = PITCH_ERROR_FREE;
    BeltParams {
        pitch: 0.005,
        belt_teeth: 120,
        span: SpanParams { length: 0.2, stiffness: 2.8e5, mass: 0.05, pretension: 200.0, damping_time },
        motor: PulleyParams { teeth: 20, wrap: 2.9, inertia: 1e-4 },
        output: PulleyParams { teeth: 60, wrap: 3.3, inertia: 0.01 },
        pitch_error: PitchErrorParams { motor: none, output: none, belt: none },
        motor_friction: ViscousParams { viscous: 0.0 },
        output_friction: ViscousParams { viscous },
    }
}

/// The same with pitch errors of every kind.
fn uneven() -> BeltParams<f64, ViscousParams<f64>> {
    let mut params = params(0.5, 1e-4);
    params.pitch_error.motor[0] = PitchTerm { order: 1, amplitude: 2e-5, phase: 0.3 };
    params.pitch_error.motor[1] = PitchTerm { order: 20, amplitude: 2e-6, phase: 0.0 };
    params.pitch_error.output[0] = PitchTerm { order: 1, amplitude: 3e-5, phase: 1.0 };
    params.pitch_error.belt[0] = PitchTerm { order: 1, amplitude: 4e-5, phase: -1.0 };
    params
}

/// Torques after a load that was put on slowly and waited for.
fn settled<const N: usize>(load: f64) -> BeltTorques<f64> {
    let params = params(4.0, 2e-5);
    let dt = (0.5 * params.stable_step(N)).min(1e-5);
    let belt: Belt<f64, Viscous<f64>, N> = params.build(dt).unwrap();
    let (mut state, mut output) = (belt.rest(), Motion::default());
    let steps = (2.0 / dt) as u32;
    let mut torques = BeltTorques::default();
    for k in 0..steps {
        let ramp = (2.0 * f64::from(k) / f64::from(steps)).min(1.0);
        torques = belt.step(&mut state, &mut output, &Motion::default(), load * ramp);
    }
    torques
}

#[test]
fn a_load_winds_the_belt_up_against_itself_and_half_as_stiff_once_a_span_is_slack() {
    let params = params(4.0, 2e-5);
    let (stiffness, radius) = (params.torsional_stiffness(), params.radius(&params.output));
    // Slack from twice the pretension on.
    let slack = 2.0 * 200.0 * radius;
    for load in [-0.9 * slack, 3.0, 0.5 * slack, 1.5 * slack, -2.0 * slack] {
        let beyond = (load.abs() - slack).max(0.0);
        let torsion =
            -load.signum() * (load.abs() - beyond) / stiffness - load.signum() * beyond / (0.5 * stiffness);
        for torques in [settled::<0>(load), settled::<3>(load)] {
            assert!((torques.torsion - torsion).abs() < 1e-6 * torsion.abs(), "{torques:?} {torsion}");
            assert!((torques.transmitted + load).abs() < 1e-6 * load.abs());
            assert_eq!(torques.slack, beyond > 0.0);
            assert!(torques.forward.min(torques.backward) >= 0.0);
        }
    }
}

/// Motor and output after a second of acceleration.
fn accelerated(params: &BeltParams<f64, ViscousParams<f64>>, acceleration: f64) -> [Motion<f64>; 2] {
    let dt = 1e-4;
    let belt = params.build::<0>(dt).unwrap();
    let (mut state, mut output, mut motor) = (belt.rest(), Motion::default(), Motion::default());
    for _ in 0..10_000 {
        belt.step(&mut state, &mut output, &motor, 0.0);
        motor.advance(acceleration, dt);
    }
    [motor, output]
}

#[test]
fn the_output_turns_with_the_motor_by_the_ratio_of_teeth() {
    for acceleration in [30.0, -30.0] {
        let [motor, output] = accelerated(&params(0.0, 2e-4), acceleration);
        let moved = output.angle.to_radians() / motor.angle.to_radians();
        assert!((moved - 20.0 / 60.0).abs() < 1e-4, "{moved}");
    }
}

#[test]
fn a_million_revolutions_change_nothing() {
    let params = uneven();
    let belt = params.build::<0>(1e-4).unwrap();
    let run = |revolutions: i64| {
        let start = |teeth: i64| Motion {
            angle: Angle::from_counts((revolutions * teeth) << 32),
            ..Motion::default()
        };
        // 60 and 20 revolutions of the pulleys, ten of the belt.
        let (mut motor, mut output, mut state) = (start(60), start(20), belt.rest());
        let mut last = BeltTorques::default();
        for _ in 0..3000 {
            last = belt.step(&mut state, &mut output, &motor, 2.0);
            motor.advance(20.0, 1e-4);
        }
        last
    };
    assert_eq!(run(0), run(1_000_000));
}

/// Power that enters at both ports is stored or lost, over a motion in which spans go slack.
#[test]
fn the_power_balance_closes() {
    let params = uneven();
    let dt = 0.05 * params.stable_step(4);
    let belt = params.build::<4>(dt).unwrap();
    let (mut state, mut output, mut motor) = (belt.rest(), Motion::<f64>::default(), Motion::default());
    let inertia = 1.0 / belt.inverse_output_inertia;
    let (mut entered, mut lost, mut through, mut time, mut slack) = (0.0, 0.0, 0.0, 0.0f64, false);
    let stored = |state: &BeltState<f64, _, 4>, motor: &Motion<f64>, output: &Motion<f64>| {
        belt.span_energy(state, motor, output) + 0.5 * inertia * output.velocity * output.velocity
    };
    let start = stored(&state, &motor, &output);
    while time < 0.5 {
        let load = 40.0 * (60.0 * time).sin();
        let before = output.velocity;
        let torques = belt.step(&mut state, &mut output, &motor, load);
        let mean = 0.5 * (before + output.velocity);
        entered += dt * (torques.motor * motor.velocity + load * mean);
        through += dt * (torques.motor * motor.velocity).abs();
        lost += dt * (torques.damping_loss + torques.output_friction * mean);
        slack |= torques.slack;
        time += dt;
        motor.velocity = 20.0 * (15.0 * time).sin();
        motor.angle = motor.angle.plus(dt * motor.velocity);
    }
    assert!(slack && lost > 0.0);
    let end = stored(&state, &motor, &output);
    assert!(
        (entered - lost - (end - start)).abs() < 2e-3 * through,
        "{entered} {lost} {start} {end} {through}"
    );
}

#[test]
fn a_parameter_out_of_range_is_named() {
    let sound = params(0.0, 0.0);
    let named = |params: BeltParams<f64, ViscousParams<f64>>| params.build::<2>(1e-7).unwrap_err();
    assert!(sound.build::<2>(1e-7).is_ok());
    let pulley = sound.motor;
    for (params, name) in [
        (BeltParams { pitch: 0.0, ..sound }, "pitch"),
        (BeltParams { belt_teeth: 59, ..sound }, "belt_teeth"),
        (BeltParams { motor: PulleyParams { teeth: 0, ..pulley }, ..sound }, "motor_teeth"),
        (BeltParams { motor: PulleyParams { wrap: 0.3, ..pulley }, ..sound }, "motor_wrap"),
        (BeltParams { output: PulleyParams { teeth: 1, wrap: 3.0, ..pulley }, ..sound }, "output_wrap"),
        (BeltParams { motor: PulleyParams { inertia: 0.0, ..pulley }, ..sound }, "motor_inertia"),
        (BeltParams { output: PulleyParams { inertia: f64::NAN, ..pulley }, ..sound }, "output_inertia"),
        (BeltParams { span: SpanParams { pretension: -1.0, ..sound.span }, ..sound }, "pretension"),
        (BeltParams { output_friction: ViscousParams { viscous: -1.0 }, ..sound }, "viscous"),
    ] {
        assert_eq!(named(params), Error::OutOfRange(name));
    }
    assert_eq!(sound.build::<2>(sound.stable_step(2)).unwrap_err(), Error::OutOfRange("dt"));
    assert_eq!(sound.build::<0>(2.0).unwrap_err(), Error::OutOfRange("dt"));
}

fn single() -> BeltParams<f32> {
    let contact = LubricatedContactParams {
        coulomb: 0.05f32,
        static_level: 0.07,
        stribeck_velocity: 0.5,
        stribeck_exponent: 1.0,
        viscous: 1e-3,
    };
    let friction = JointFrictionParams::symmetric(Order::Two, contact, 0.01, 0.3);
    BeltParams {
        pitch: 0.005,
        belt_teeth: 120,
        span: SpanParams { length: 0.2, stiffness: 2.8e5, mass: 0.05, pretension: 200.0, damping_time: 2e-4 },
        motor: PulleyParams { teeth: 20, wrap: 2.9, inertia: 1e-4 },
        output: PulleyParams { teeth: 60, wrap: 3.3, inertia: 0.01 },
        pitch_error: PitchErrorParams::default(),
        motor_friction: friction,
        output_friction: friction,
    }
}

fn finite<const N: usize>(dt: f32, inputs: &[(i64, u32, u32, u32)]) -> bool {
    let belt = single().build::<N>(dt).unwrap();
    let (mut state, mut output) = (belt.rest(), Motion::<f32>::default());
    inputs.iter().all(|&(counts, rest, velocity, load)| {
        let angle = Angle { counts, rest: f32::from_bits(rest) };
        let motor = Motion { angle, velocity: f32::from_bits(velocity) };
        let torques = belt.step(&mut state, &mut output, &motor, f32::from_bits(load));
        let numbers =
            [torques.torsion, torques.transmitted, torques.forward, torques.backward, torques.motor];
        let finite = numbers.into_iter().chain([output.velocity, output.angle.rest]).all(f32::is_finite);
        finite && torques.forward >= 0.0 && torques.backward >= 0.0
    })
}

proptest! {
    #[test]
    fn any_input_is_total(inputs in prop::collection::vec(any::<(i64, u32, u32, u32)>(), 1..300)) {
        prop_assert!(finite::<0>(1e-4, &inputs));
        prop_assert!(finite::<3>(2e-7, &inputs));
    }
}
