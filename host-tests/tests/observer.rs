//! What the observer must not take for a load: the timing of its motor's torque, the last count of a resting output, and
//! a stiffness that it is told of.

use std::f64::consts::TAU;

use strainwave::compensator::observer::Measurement;
use strainwave::compensator::{Faults, JointParams, RealTimeGear};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, GearParams, Motion};
use strainwave_desktop::GearFile;
use strainwave_desktop::joint::{CONTROL_PERIOD, joint_params};

/// Steps of the plant in a control period.
const FINE: u32 = 10;

fn joint() -> JointParams<f64> {
    joint_params(&GearFile::default_gear()).unwrap()
}

fn gear(params: &GearParams<f64>, dt: f64) -> RealTimeGear<f64> {
    params.build(Reduced::build(&params.flexspline, params.rated_torque).unwrap(), dt).unwrap()
}

fn measured(motor: Motion<f64>, output: Option<Motion<f64>>, motor_torque: f64) -> Measurement<f64> {
    Measurement {
        motor: motor.angle,
        output: output.map(|flange| flange.angle),
        motor_torque,
        known_torque: 0.0,
        known_stiffness: 0.0,
        output_torque: None,
    }
}

/// Largest external torque (N m) that is believed of a free joint whose motor's torque, held over each control period, swings by
/// 1 N m at 130 Hz: 100 N m at the output.
fn load_of_a_swinging_motor() -> f64 {
    let joint = joint();
    let (model, plant) =
        (gear(&joint.gear, CONTROL_PERIOD), gear(&joint.gear, CONTROL_PERIOD / f64::from(FINE)));
    let observer = joint.observer.build(&joint.gear, &joint.limits, CONTROL_PERIOD).unwrap();
    let (mut state, mut inside) = (observer.rest(&model), plant.rest());
    let (mut motor, mut flange) = (Motion::default(), Motion::default());
    let mut largest = 0.0f64;
    for k in 0..4000 {
        let held = (TAU * 130.0 * CONTROL_PERIOD * f64::from(k)).sin();
        for _ in 0..FINE {
            let torques = plant.torques(&mut inside, &motor, &flange, Applied { motor: held, load: 0.0 });
            let acceleration = (held - torques.wave_generator) / joint.gear.wave_generator_inertia;
            motor.advance(acceleration, CONTROL_PERIOD / f64::from(FINE));
            flange.advance(plant.flange_acceleration(&torques, 0.0), CONTROL_PERIOD / f64::from(FINE));
        }
        let measured = measured(motor, None, held);
        let estimate = observer.step(&model, &mut state, &measured, &mut Faults::default());
        largest = if k < 2000 { 0.0 } else { largest.max(estimate.external_torque.abs()) };
    }
    largest
}

/// Taken for the whole of the period that ended, half a period early, the torque would be a load of 14 N m.
#[test]
fn the_timing_of_the_motors_torque_is_no_load() {
    let load = load_of_a_swinging_motor();
    assert!(load < 2.0, "{load} N m");
}

/// Angle of the output (rad) that is believed of a resting joint whose output encoder shows `off` (rad).
fn believed_at_rest(off: f64) -> f64 {
    let joint = joint();
    let model = gear(&joint.gear, CONTROL_PERIOD);
    let observer = joint.observer.build(&joint.gear, &joint.limits, CONTROL_PERIOD).unwrap();
    let mut state = observer.rest(&model);
    let mut shown = Motion::default();
    shown.angle = shown.angle.plus(off);
    let measured = measured(Motion::default(), Some(shown), 0.0);
    let estimates = (0..5000)
        .map(|_| observer.step(&model, &mut state, &measured, &mut Faults::default()).output_position);
    estimates.last().unwrap().to_radians()
}

#[test]
fn a_resting_outputs_last_count_moves_nothing() {
    let count = TAU / 2f64.powi(19);
    assert_eq!(believed_at_rest(0.9 * count), believed_at_rest(0.0));
    let off = believed_at_rest(10.0 * count) - believed_at_rest(0.0);
    assert!((off / count - 9.0).abs() < 0.2, "{} counts", off / count);
}

/// A gear file whose stiffness is larger by a share is the nominal gear told of that share: hysteresis and wind-up.
#[test]
fn a_gear_told_to_be_stiffer_is_the_stiffer_gear() {
    for stiffening in [-0.1, 0.1] {
        let joint = joint();
        let mut stiffer = joint.gear;
        stiffer.flexspline.line.stiffness = stiffer.flexspline.line.stiffness.map(|k| (1.0 + stiffening) * k);
        let [told, true_one] = [&joint.gear, &stiffer].map(|params| gear(params, CONTROL_PERIOD));
        let (mut of_told, mut of_true, motor) = (told.rest(), true_one.rest(), Motion::default());
        for k in 0..4000 {
            let mut flange = Motion::default();
            let torsion = 1.2e-3 * (TAU * f64::from(k) / 1000.0).sin();
            flange.angle = told.drive(motor.angle).plus(-torsion);
            let applied = Applied::default();
            let ours = told.torques_of_stiffer(&mut of_told, &motor, &flange, applied, stiffening);
            let theirs = true_one.torques(&mut of_true, &motor, &flange, applied);
            assert!((ours.hysteresis - theirs.hysteresis).abs() < 0.01, "{ours:?} {theirs:?}");
            // The told line keeps its knees at their torsion, the stiffer one at their torque.
            assert!(
                (ours.transmitted - theirs.transmitted).abs() < 0.03 * joint.gear.rated_torque,
                "{ours:?} {theirs:?}"
            );
        }
    }
}
