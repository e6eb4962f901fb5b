//! The control step is total: for any input bits finite, bounded outputs and faults by name.

use std::sync::LazyLock;

use proptest::prelude::*;
use strainwave::Angle;
use strainwave::compensator::schedule::{CONTROL_PERIOD, SLOW_PERIODS};
use strainwave::compensator::{
    Command, CompensationGains, Compensator, Directions, Faults, Input, JointParams, Mode, Output, Sensors,
    Setpoint, State, Status,
};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::output_bounds::beyond_bounds;
use strainwave_desktop::design::joint::joint_params;

/// The default joint; its gains are designed once, which takes longer than ten thousand control steps.
fn joint() -> &'static JointParams<f32> {
    static JOINT: LazyLock<JointParams<f32>> =
        LazyLock::new(|| joint_params(&GearFile::default_gear()).unwrap());
    &JOINT
}

fn gains() -> CompensationGains<f32> {
    CompensationGains { friction: 0.8, ..CompensationGains::ALL }
}

/// A joint at rest whose encoder reads `motor_encoder`.
fn resting(motor_encoder: u32) -> Input<f32> {
    Input {
        sensors: Sensors { motor_encoder, ..Sensors::default() },
        command: Command::default(),
        gains: gains().into(),
        ..Input::default()
    }
}

fn settled() -> (Compensator<f32>, State<f32>) {
    let compensator = joint().build().unwrap();
    let mut state = compensator.rest();
    for _ in 0..200 {
        compensator.step(&mut state, &resting(0));
    }
    (compensator, state)
}

/// Faults that inputs alone raise.
const INPUT_FAULTS: [Faults; 3] =
    [Faults::INPUT_NOT_FINITE, Faults::SETPOINT_LIMITED, Faults::MOTOR_ENCODER_JUMP];

/// Every output is finite and within what the joint can do.
fn assert_bounded(output: &Output<f32>) {
    assert_eq!(beyond_bounds(joint(), output), None, "{output:?}");
}

fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![any::<u32>().prop_map(f32::from_bits), -2.0..2.0f32, Just(f32::NAN), Just(f32::INFINITY)]
}

prop_compose! {
    fn any_gains()(
        [feedback, inertia, friction, wind_up, kinematic_error, output_feedback, adaptation, ripple]
            in prop::array::uniform8(any_float()),
    ) -> CompensationGains<f32> {
        CompensationGains { feedback, inertia, friction, wind_up, kinematic_error, output_feedback, adaptation, ripple }
    }
}

/// Rest with another setpoint.
fn commanded(setpoint: Setpoint<f32>) -> Input<f32> {
    Input { command: setpoint.into(), ..resting(0) }
}

prop_compose! {
    fn any_input()(
        encoders in any::<(u32, Option<u32>)>(),
        torque in any_float(),
        (elapsed, age, status) in (any_float(), any_float(), prop_oneof![Just(0), any::<u32>()]),
        gauge in prop::option::of(any_float()),
        counts in any::<i64>(),
        rest in any_float(),
        [velocity, acceleration, jerk, snap] in prop::array::uniform4(any_float()),
        kind in 0..3u8,
        forward in any_gains(),
        backward in any_gains(),
    ) -> Input<f32> {
        Input {
            sensors: Sensors {
                motor_encoder: encoders.0,
                output_encoder: encoders.1,
                motor_torque: torque,
                output_torque: gauge,
            },
            command: match kind {
                0 => Command::Torque(velocity),
                1 => Command::Velocity { velocity, acceleration },
                _ => Command::Position(Setpoint {
                    position: Angle { counts, rest },
                    velocity,
                    acceleration,
                    jerk,
                    snap,
                }),
            },
            gains: Directions { forward, backward },
            elapsed,
            setpoint_age: age,
            status: Status(status),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_bits_give_finite_bounded_outputs(inputs in prop::collection::vec(any_input(), 1..60)) {
        let compensator = joint().build().unwrap();
        let mut state = compensator.rest();
        for input in &inputs {
            assert_bounded(&compensator.step(&mut state, input));
        }
        // And it recovers: ordinary inputs lead to a tenth of a second without an input fault.
        let mut clear = 0;
        for _ in 0..50_000 {
            let output = compensator.step(&mut state, &resting(0));
            assert_bounded(&output);
            clear = if INPUT_FAULTS.iter().any(|fault| output.faults.contains(*fault)) { 0 } else { clear + 1 };
            if clear == 1000 {
                break;
            }
        }
        prop_assert_eq!(clear, 1000);
    }
}

#[test]
fn nan_and_infinity_are_held_and_named() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for place in 0..9 {
            let (compensator, mut state) = settled();
            let mut untouched = state.clone();
            let (mut input, mut setpoint) = (resting(0), Setpoint::default());
            let values = [
                &mut input.sensors.motor_torque,
                &mut setpoint.velocity,
                &mut setpoint.acceleration,
                &mut setpoint.jerk,
                &mut setpoint.snap,
                &mut setpoint.position.rest,
                &mut input.gains.forward.feedback,
                &mut input.gains.backward.friction,
                &mut input.gains.forward.wind_up,
            ];
            *values.into_iter().nth(place).unwrap() = bad;
            input.command = setpoint.into();
            // Setpoint and gains are read in different slots.
            let named = (0..4 * SLOW_PERIODS).any(|_| {
                let output = compensator.step(&mut state, &input);
                let expected = compensator.step(&mut untouched, &resting(0));
                // A setpoint that is no number takes the command's slot a period more.
                let held = if (1..=5).contains(&place) {
                    (output.motor_torque - expected.motor_torque).abs() < 1e-6 && output.mode == expected.mode
                } else {
                    Output { faults: expected.faults, ..output } == expected
                };
                assert!(held, "place {place}: {output:?} {expected:?}");
                output.faults.contains(Faults::INPUT_NOT_FINITE)
            });
            assert!(named, "{place}");
        }
    }
}

/// Bad frames are bridged; after two milliseconds of them the angle is lost, and with it the torque, until a reset.
#[test]
fn an_encoder_that_jumps_away_takes_the_torque_away() {
    let (compensator, mut state) = settled();
    for k in 0..100 {
        let output = compensator.step(&mut state, &resting(1 << 19));
        assert!(output.faults.contains(Faults::MOTOR_ENCODER_JUMP));
        assert_eq!(output.mode == Mode::Safe, k >= 19, "{k}");
        assert!(k < 19 || output.motor_torque == 0.0, "{k}");
    }
    let after = compensator.step(&mut state, &resting(0));
    assert!(!after.faults.contains(Faults::MOTOR_ENCODER_JUMP));
    assert_eq!((after.mode, after.motor_torque), (Mode::Safe, 0.0));
    assert_eq!(state.cause(), Faults::MOTOR_ENCODER_LOST);
}

#[test]
fn a_frozen_encoder_is_named_while_the_joint_is_asked_to_move() {
    let (compensator, mut state) = settled();
    let (mut faults, mut torque) = (Faults::NONE, 0.0);
    for k in 0..10_000 {
        let position = Angle::from_radians(0.05 * CONTROL_PERIOD as f32 * k as f32);
        let mut input = commanded(Setpoint { position, velocity: 0.05, ..Setpoint::default() });
        input.sensors.motor_torque = torque;
        let output = compensator.step(&mut state, &input);
        assert_bounded(&output);
        (faults, torque) = (output.faults, output.motor_torque);
    }
    assert!(
        faults.contains(Faults::MOTOR_ENCODER_FROZEN),
        "{faults:?} {:?}",
        state.cause().names().collect::<Vec<_>>()
    );
    assert_eq!(state.mode(), Mode::Safe);
    assert_eq!(faults.names().filter(|name| *name == "motor encoder frozen").count(), 1);
}

/// The motor is turned away from an output that stands still, at 1.2 rad/s of the output, as if the teeth had
/// ratcheted.
#[test]
fn a_torsion_beyond_the_gears_range_is_named() {
    let (compensator, mut state) = settled();
    let (mut raised, mut reset) = (0, Vec::new());
    let mut restarted = Vec::new();
    // Faults are of the torsion of a period ago.
    let mut torsion = 0.0;
    for k in 0..100 {
        let mut input = resting(k * 1000);
        input.sensors.output_encoder = Some(0);
        let output = compensator.step(&mut state, &input);
        assert_bounded(&output);
        // Five times the rated 67 N m: 14/3.1e4 + 34/5.0e4 + 287/5.7e4 rad, less what the dashpot adds.
        if output.faults.contains(Faults::OBSERVER_RESET) {
            reset.push(k);
        } else if output.faults.contains(Faults::TORSION_BEYOND_RANGE) {
            raised += 1;
            assert!(torsion > 5.5e-3, "{torsion}");
            assert!(output.faults.names().any(|name| name == "torsion beyond range"));
        } else {
            assert!(torsion < 6.2e-3, "{torsion}");
        }
        torsion = output.estimate.torsion.abs();
        restarted.extend((torsion == 0.0).then_some(k));
    }
    assert!(raised > 0 && !reset.is_empty());
    // The observer's next step starts it again, which may wait for a change of the mode.
    for k in reset {
        assert!((k..=k + SLOW_PERIODS).any(|later| restarted.contains(&later)), "{k}: {restarted:?}");
    }
}

#[test]
fn switching_a_share_makes_no_step_in_the_torque() {
    let (compensator, mut state) = settled();
    let mut input = commanded(Setpoint { acceleration: 5.0, ..Setpoint::default() });
    let mut last = None;
    for k in 0..2000 {
        let inertia = if (k / 500) % 2 == 0 { 1.0 } else { 0.0 };
        input.gains = CompensationGains { inertia, ..gains() }.into();
        let output = compensator.step(&mut state, &input);
        input.sensors.motor_torque = output.motor_torque;
        let torque = output.feed_forward_torque;
        if k > 3 * SLOW_PERIODS {
            let change = (torque - last.unwrap_or(torque)).abs();
            assert!(change < 0.04, "step {k}: {change}");
        }
        last = Some(torque);
    }
}

#[test]
fn the_first_encoder_reading_is_no_jump() {
    let compensator = joint().build().unwrap();
    let output = compensator.step(&mut compensator.rest(), &resting(400_000));
    assert_eq!(output.faults, Faults::NONE);
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    use strainwave::Error::OutOfRange;
    let build = |change: fn(&mut JointParams<f32>)| {
        let mut params = *joint();
        change(&mut params);
        params.build().err()
    };
    assert_eq!(build(|p| p.gear.ratio = 0), Some(OutOfRange("ratio")));
    assert_eq!(build(|p| p.gear.flexspline.line.stiffness[1] = -1.0), Some(OutOfRange("stiffness")));
    assert_eq!(build(|p| p.gear.flexspline_inertia = f32::NAN), Some(OutOfRange("flexspline_inertia")));
    assert_eq!(build(|p| p.motor_encoder_bits = 40), Some(OutOfRange("encoder_bits")));
    assert_eq!(build(|p| p.limits.motor_torque = 0.0), Some(OutOfRange("motor_torque")));
    assert_eq!(build(|p| p.observer.moving[0].motor[2] = f32::INFINITY), Some(OutOfRange("gains")));
    assert_eq!(build(|p| p.feedback.velocity_gain = -1.0), Some(OutOfRange("velocity_gain")));
}
