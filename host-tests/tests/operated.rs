//! A joint without a controller above it: it watches, then holds where it is, and tells a reading that failed.

use strainwave::Angle;
use strainwave::compensator::{CompensationGains, Setpoint, Status};
use strainwave_app::command_source::CommandSource;
use strainwave_app::jog::Jog;
use strainwave_app::operated::{Operated, WATCHING};
use strainwave_app::{Input, Output};

fn joint() -> Operated {
    Operated::new(Box::leak(Box::new(Jog::new())))
}

/// The input of a period, of which the step then tells that the output is at `position`.
fn period(joint: &mut Operated, position: Angle<f32>) -> Input<f32> {
    let mut input = Input::default();
    joint.input(Some(7), &mut input);
    let mut output = Output::default();
    output.estimate.output_position = position;
    joint.report(|| output);
    input
}

#[test]
fn it_watches_before_it_holds() {
    let mut joint = joint();
    for counts in 0..i64::from(WATCHING) {
        let gains = period(&mut joint, Angle::from_counts(counts)).gains;
        assert_eq!(gains, CompensationGains::default().into());
    }
    let last = Setpoint { position: Angle::from_counts(i64::from(WATCHING) - 1), ..Setpoint::default() };
    for _ in 0..3 {
        let Input { command, gains, .. } = period(&mut joint, Angle::from_counts(-5));
        assert_eq!(command, last.into());
        assert_ne!(gains, CompensationGains::default().into());
    }
}

#[test]
fn a_reading_that_failed_is_told() {
    let mut joint = joint();
    joint.commanded(0.3);
    let mut input = Input::default();
    joint.input(None, &mut input);
    assert!(input.status.contains(Status::MOTOR_ENCODER_INVALID));
    assert_eq!((input.sensors.motor_torque, input.sensors.output_encoder), (0.3, None));
    joint.input(Some(123), &mut input);
    assert_eq!((input.status, input.sensors.motor_encoder), (Status::FINE, 123));
}

#[test]
fn after_a_reset_it_watches_again_and_holds_where_it_then_is() {
    let mut joint = joint();
    for _ in 0..=WATCHING {
        period(&mut joint, Angle::from_counts(3));
    }
    joint.reset();
    for _ in 0..WATCHING {
        let gains = period(&mut joint, Angle::from_counts(9)).gains;
        assert_eq!(gains, CompensationGains::default().into());
    }
    let held = Setpoint { position: Angle::from_counts(9), ..Setpoint::default() };
    assert_eq!(period(&mut joint, Angle::from_counts(-5)).command, held.into());
}
