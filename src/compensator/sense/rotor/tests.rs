//! Frozen encoders, the drive, sensors at the output, and the mode of the balance.

use std::vec::Vec;

use super::*;
use crate::compensator::schedule::{CONTROL_PERIOD, OBSERVER_PERIODS};
use crate::compensator::tolerances::tests::TENTHS;

fn rotor() -> Rotor<f64> {
    with(&TENTHS, 1.5e-3)
}

/// Of a joint that is known so well, whose drive takes so long to reach its command (s).
fn with(tolerances: &Tolerances<f64>, drive_response: f64) -> Rotor<f64> {
    build(&crate::gear::tests::params(), tolerances, drive_response)
}

fn build(gear: &GearParams<f64>, tolerances: &Tolerances<f64>, drive_response: f64) -> Rotor<f64> {
    let limits = Limits { motor_torque: 2.4, motor_speed: 586.0, output_torque: 157.0 };
    let count = core::f64::consts::TAU / f64::from(1 << 19);
    Rotor::build(gear, &limits, tolerances, [count; 2], drive_response, 141.0, CONTROL_PERIOD).unwrap()
}

/// Faults of one more round under `torque` (N m), at `within` (counts) during the round and at `end` at its end.
fn round(rotor: &Rotor<f64>, state: &mut RotorState<f64>, torque: f64, within: i64, end: i64) -> Faults {
    let angle = |counts: i64| Angle::from_counts(counts << (32 - 19));
    let steps = SLOW_PERIODS / OBSERVER_PERIODS;
    for step in 1..=steps {
        let periods = f64::from(OBSERVER_PERIODS);
        let motor = angle(if step < steps { within } else { end });
        state.add([torque, 0.0], periods * CONTROL_PERIOD, motor);
    }
    let motor = angle(end);
    let input = RotorInput { motor, reference: None, driven: true };
    let mut faults = Faults::NONE;
    rotor.step(state, &input, &mut faults);
    faults
}

/// Faults of a motor that ends every round at the same count, after an `excursion` (counts) within it, under a torque
/// that alternates between +-0.2 N m, more than friction holds, from round to round.
fn faults(excursion: i64) -> Faults {
    let (rotor, mut state) = (rotor(), RotorState::default());
    (0..20).fold(Faults::NONE, |faults, index| {
        let torque = if index % 2 == 0 { 0.2 } else { -0.2 };
        faults.with(round(&rotor, &mut state, torque, excursion, 0))
    })
}

/// Torque that friction could not hold means that the encoder is frozen; but not where the motor vibrates about a count.
#[test]
fn a_count_is_frozen_that_stands_still_within_the_round_too() {
    assert_eq!(faults(0), Faults::MOTOR_ENCODER_FROZEN);
    assert_eq!(faults(10), Faults::NONE);
}

/// A torque that friction cannot hold may have come at the end of its round: the motor has one round more to move.
#[test]
fn a_motor_has_a_round_to_follow_its_torque() {
    let rotor = rotor();
    for (after, expected) in [(0, Faults::MOTOR_ENCODER_FROZEN), (5, Faults::NONE)] {
        let mut state = RotorState::default();
        for _ in 0..6 {
            assert_eq!(round(&rotor, &mut state, 0.0, 0, 0), Faults::NONE);
        }
        assert_eq!(round(&rotor, &mut state, 3.0 * rotor.grip, 0, 0), Faults::NONE);
        assert_eq!(round(&rotor, &mut state, 3.0 * rotor.grip, after, after), expected);
    }
}

/// A rotor of a gear whose friction grows by `load` of the gear's torque.
fn loaded(load: f64) -> Rotor<f64> {
    let mut gear = crate::gear::tests::params();
    (gear.input_friction.load.driving, gear.input_friction.load.driven) = (load, 0.5 * load);
    build(&gear, &TENTHS, 1.5e-3)
}

/// Faults of a rotor that stands while its torque goes from `first` to `last` and stays there, the gear's torque at the output `seen` to
/// have changed by so much meanwhile.
fn standing(rotor: &Rotor<f64>, [first, last]: [f64; 2], seen: f64) -> Faults {
    let mut state = RotorState::default();
    let before = (0..6).map(|_| round(rotor, &mut state, first, 0, 0)).fold(Faults::NONE, Faults::with);
    state.gear_change = seen;
    (0..3).map(|_| round(rotor, &mut state, last, 0, 0)).fold(before, Faults::with)
}

/// Friction that grows with the load holds more of a torque: from a load on, what would show a frozen encoder without it shows none.
#[test]
fn a_loaded_gear_holds_a_larger_change_of_the_torque() {
    let (free, grown) = (rotor(), loaded(0.1));
    let held = crate::gear::tests::params().input_friction.largest_level();
    // What is added for noise.
    let margin = free.grip - 2.0 * 1.3 * held;
    // The gear carries what the smaller torque and friction hold; it surely carries none, and a load may come.
    let holds = |load: f64| 2.0 * 1.3 * (held + load * (held + held) / (1.0 - load)) + margin;
    for (rotor, load) in [(&free, 0.0), (&grown, 0.1)] {
        let allowed = holds(load) + rotor.grip;
        let change = |factor: f64| standing(rotor, [held, held + factor * allowed], 0.0);
        assert_eq!((change(0.99), change(1.01)), (Faults::NONE, Faults::MOTOR_ENCODER_FROZEN), "{load}");
    }
}

/// The gear's torque has changed with the motor's on a rotor that friction holds: as seen, else by as much as it surely carried, and at least by
/// what a load may change that comes.
#[test]
fn what_the_gear_has_changed_by_is_no_sign_of_a_frozen_encoder() {
    let rotor = rotor();
    let changed = |first: f64, change: f64, seen: f64| standing(&rotor, [first, first + change], seen);
    for (seen, by_gear) in [(0.0, rotor.grip), (0.4 * rotor.n, 0.4), (-0.4 * rotor.n, 0.0)] {
        let allowed = rotor.grip + by_gear;
        assert_eq!(changed(0.0, 0.99 * allowed, seen), Faults::NONE, "{seen}");
        assert_eq!(changed(0.0, 1.01 * allowed, seen), Faults::MOTOR_ENCODER_FROZEN, "{seen}");
    }
    // It may be lost as well as doubled.
    let carried = 4.0 * rotor.grip;
    let allowed = rotor.grip + carried - 0.5 * rotor.grip;
    for (first, sign) in [(carried, 1.0), (-carried, -1.0), (carried, -1.0), (-carried, 1.0)] {
        assert_eq!(changed(first, sign * 0.99 * allowed, 0.0), Faults::NONE);
        assert_eq!(changed(first, sign * 1.01 * allowed, 0.0), Faults::MOTOR_ENCODER_FROZEN);
    }
}

/// A motor that its torque brakes to rest, more torque than friction holds, stands without it.
#[test]
fn a_motor_that_is_braked_to_rest_is_not_frozen() {
    let (rotor, mut state) = (rotor(), RotorState::default());
    let (count, round_time) =
        (core::f64::consts::TAU / f64::from(1 << 19), f64::from(SLOW_PERIODS) * CONTROL_PERIOD);
    let braking = 1.5 * rotor.grip;
    let change = braking / rotor.inertia * round_time;
    let mut place = 0.0;
    let rounds = (0..40).map(|index| {
        let speed = (f64::from(20 - index) * change).max(0.0);
        place -= speed * round_time / count;
        let torque = if speed > 0.0 { braking } else { 0.0 };
        round(&rotor, &mut state, torque, place as i64, place as i64)
    });
    assert_eq!(rounds.fold(Faults::NONE, Faults::with), Faults::NONE);
}

/// A motor that one round's torque has stopped, and which then stands without torque, has not stopped at once: the change of two mean
/// speeds is the work of both rounds. With no torque in either it has.
#[test]
fn a_motor_is_stopped_by_the_torque_of_the_round_before_too() {
    let rotor = rotor();
    for (braking, expected) in [(-2.0, Faults::NONE), (0.0, Faults::MOTOR_ENCODER_FROZEN)] {
        let mut state = RotorState::default();
        let count = core::f64::consts::TAU / f64::from(1 << 19);
        // Stopped from this speed by 1.8 N m in a round.
        let step = 1.8 / rotor.inertia * rotor.round * rotor.round / count;
        let mut faults = Faults::NONE;
        for (index, torque) in [0.0, 0.0, 0.0, braking].into_iter().enumerate() {
            let place = (step * index as f64) as i64;
            faults = faults.with(round(&rotor, &mut state, torque, place, place));
        }
        assert_eq!(faults, Faults::NONE);
        let stopped = (3.0 * step) as i64;
        assert_eq!(round(&rotor, &mut state, 0.0, stopped, stopped), expected, "{braking}");
    }
}

/// Whether a drive is named within `rounds`, of which each observer step has a torque and its error (N m), on a motor that moves.
fn names_drive(rotor: &Rotor<f64>, rounds: i64, torques: impl Fn(i64, u32) -> [f64; 2]) -> bool {
    let mut state = RotorState::default();
    let rounds = (0..rounds).map(|round| {
        for step in 1..=SLOW_PERIODS / OBSERVER_PERIODS {
            let motor = Angle::from_counts((4 * round + i64::from(step)) << 20);
            state.add(torques(round, step), f64::from(OBSERVER_PERIODS) * CONTROL_PERIOD, motor);
        }
        let input = RotorInput { motor: Angle::default(), reference: None, driven: true };
        let mut faults = Faults::NONE;
        rotor.step(&mut state, &input, &mut faults);
        faults
    });
    rounds.fold(Faults::NONE, Faults::with).contains(Faults::DRIVE_NOT_FOLLOWING)
}

/// A drive that gives 20 % of its command is named; one that is as far off to either side in turn is not, nor one that may take longer to
/// reach its command.
#[test]
fn a_drive_is_judged_by_the_mean_of_a_round() {
    let named = |alternates: bool, drive_response: f64| {
        names_drive(&with(&TENTHS, drive_response), 6, |_, step| {
            let error = if alternates && step % 2 == 0 { 0.8 } else { -0.8 };
            [1.0 + error, error]
        })
    };
    assert!(named(false, 1.5e-3) && !named(true, 1.5e-3) && !named(false, 5e-3));
}

/// A drive that gives 60 % of its command, and that a round later, is not named while the command reverses every third round; one of the
/// other sign is.
#[test]
fn a_drive_may_be_late_where_its_command_reverses() {
    let named = |torque: fn(i64) -> f64| {
        names_drive(&rotor(), 30, |round, _| [torque(round), torque(round) - reversing(round)])
    };
    assert!(!named(|round| 0.6 * reversing(round - 1)));
    assert!(named(|round| -0.6 * reversing(round)));
}

/// A command of 2 N m (N m).
fn reversing(round: i64) -> f64 {
    if round.div_euclid(3) % 2 == 0 { 2.0 } else { -2.0 }
}

/// A torque by the encoders that disagrees with the motor's by half of the peak torque is a fault of a joint that is known well.
#[test]
fn a_torque_is_judged_by_how_well_the_joint_is_known() {
    let disagrees = |tolerances: &Tolerances<f64>| {
        with(tolerances, 1.5e-3).disagrees(&RotorState::default(), 0.5 * 157.0)
    };
    let unknown = Tolerances { torque_constant: 0.2, stiffness: 0.2, ..TENTHS };
    assert!(disagrees(&TENTHS) && !disagrees(&unknown));
}

/// A motor is lost from 1.5 times the error on that takes all of its torque to brake from, and farther off its moving reference.
#[test]
fn a_motor_far_from_its_reference_is_lost() {
    let rotor = rotor();
    let lost = |error: f64, velocity: f64| {
        let mut state = RotorState::default();
        let input = RotorInput { motor: Angle::default(), reference: Some([error, velocity]), driven: true };
        let mut faults = Faults::NONE;
        (0..4).for_each(|_| rotor.step(&mut state, &input, &mut faults));
        faults.contains(Faults::FOLLOWING_ERROR)
    };
    let gear = crate::gear::tests::params();
    let n = f64::from(gear.ratio);
    let most =
        1.5 * 2.4 / (gear.wave_generator_inertia + gear.flexspline_inertia / (n * n)) / (141.0 * 141.0);
    assert!(!lost(0.99 * most, 0.0) && lost(1.01 * most, 0.0) && lost(-1.01 * most, 0.0));
    assert!(!lost(most + 0.99, 141.0) && lost(most + 1.01, -141.0));
}

/// A gear's torque that friction cannot hold for two rounds on a motor at a constant torque is seen by both sensors; what
/// the sensor's uncertainty or the motor's own torque explains is not, nor one that came at the end of the round.
#[test]
fn a_gear_torque_that_friction_cannot_hold_is_seen() {
    let rotor = rotor();
    for place in 0..2 {
        let rounds = |applied: f64, torques: &[f64]| {
            let mut state = RotorState { still: 1, ..RotorState::default() };
            assert!(!rotor.slips(&mut state, 10.0, place));
            (state.still, state.applied) = (5, applied);
            torques.iter().map(|change| rotor.slips(&mut state, 10.0 + change, place)).collect::<Vec<_>>()
        };
        let held = rotor.held[place] / (1.0 - rotor.uncertainty[place]);
        assert_eq!(rounds(0.0, &[0.99 * held; 3]), [false; 3]);
        assert_eq!(rounds(0.0, &[1.01 * held; 2]), [false, true]);
        assert_eq!(rounds(0.0, &[-1.01 * held; 2]), [false, true]);
        assert_eq!(
            rounds(0.0, &[1.01 * held, 0.99 * held, 1.01 * held, 1.01 * held]),
            [false, false, false, true]
        );
        assert_eq!(rounds(held / rotor.n, &[held; 2]), [false; 2], "the motor's torque balances it");
    }
}

/// However light the output is, the mode of the balance goes through at most half a radian in a round, and an output
/// whose mode is slower keeps its inertia.
#[test]
fn the_mode_of_the_balance_is_slow_enough_for_the_round() {
    let gear = crate::gear::tests::params();
    let round = f64::from(SLOW_PERIODS) * CONTROL_PERIOD;
    let [_, _, stiffest] = gear.flexspline.line.stiffness;
    for inertia in [1e-4, 1e-2, 0.1, 0.2, 1.2, 20.0] {
        let counted = output_inertia(&GearParams { flexspline_inertia: inertia, ..gear }, CONTROL_PERIOD);
        let rotation = |inertia: f64| (stiffest / inertia).sqrt() * round;
        assert!(counted >= inertia && rotation(counted) <= 0.5 + 1e-12, "{inertia}: {counted}");
        assert!(rotation(inertia) > 0.5 || counted == inertia, "{inertia}: {counted}");
    }
}
