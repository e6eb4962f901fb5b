//! Causes that the observer must not attribute to a load: the timing of its motor's torque, the last count of a resting
//! output, and a stiffness that it is corrected by.

use std::f64::consts::TAU;

use strainwave::Angle;
use strainwave::compensator::estimate::observer::multi_rate::{
    Ends, GearCorrection, MultiRate, MultiRateGear,
};
use strainwave::compensator::estimate::observer::{Measurement, Observer, ObserverState, OutputReading};
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::schedule::OBSERVER_PERIODS;
use strainwave::compensator::{Faults, JointParams, RealTimeGear};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, GearParams, Motion};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::joint_params;

/// The observer's period (s).
const PERIOD: f64 = OBSERVER_PERIODS as f64 * CONTROL_PERIOD;

/// Steps of the plant in a control period.
const FINE: u32 = 10;

fn joint() -> JointParams<f64> {
    joint_params(&GearFile::default_gear()).unwrap()
}

fn gear(params: &GearParams<f64>, dt: f64) -> RealTimeGear<f64> {
    params.build(Reduced::build(&params.flexspline, params.rated_torque).unwrap(), dt).unwrap()
}

fn measured(motor: Motion<f64>, reads_output: bool, motor_torque: f64) -> Measurement<f64> {
    Measurement {
        period: f64::from(OBSERVER_PERIODS) * CONTROL_PERIOD,
        motor: motor.angle,
        motor_speed: motor.velocity,
        reads_output,
        motor_torque,
        output_torque: None,
    }
}

/// A step of a nominal gear's observer whose joint is in motion.
fn step(
    observer: &Observer<f64>,
    gear: &RealTimeGear<f64>,
    state: &mut ObserverState<f64>,
    measured: &Measurement<f64>,
) {
    observer.step(gear, state, measured, &GearCorrection::default(), false, &mut Faults::default());
}

/// Largest external torque (N m) that is estimated of a free joint whose motor's torque, held over each control
/// period, swings by 1 N m at 130 Hz: 100 N m at the output.
fn load_of_a_swinging_motor() -> f64 {
    let joint = joint();
    let (model, plant) =
        (gear(&joint.gear, CONTROL_PERIOD), gear(&joint.gear, CONTROL_PERIOD / f64::from(FINE)));
    let observer =
        joint.observer.build(&joint.gear, &joint.limits, &joint.tolerances, CONTROL_PERIOD).unwrap();
    let (mut state, mut inside) = (observer.rest(), plant.rest());
    let (mut motor, mut flange) = (Motion::default(), Motion::default());
    let (mut largest, mut before) = (0.0f64, 0.0);
    for k in 0..4000 {
        let held = (TAU * 130.0 * CONTROL_PERIOD * f64::from(k)).sin();
        for _ in 0..FINE {
            let torques = plant.torques(&mut inside, &motor, &flange, Applied { motor: held, load: 0.0 });
            let acceleration = (held - torques.wave_generator) / joint.gear.wave_generator_inertia;
            motor.advance(acceleration, CONTROL_PERIOD / f64::from(FINE));
            flange.advance(plant.flange_acceleration(&torques, 0.0), CONTROL_PERIOD / f64::from(FINE));
        }
        if k % OBSERVER_PERIODS == 1 {
            let measured = measured(motor, false, 0.5 * (before + held));
            step(&observer, &model, &mut state, &measured);
            largest = if k < 2000 { 0.0 } else { largest.max(state.external_torque().abs()) };
        }
        before = held;
    }
    largest
}

/// Taken for the whole of the observer's period that ended, half a period early, the torque would be a load of 29 N
/// m.
#[test]
fn the_timing_of_the_motors_torque_is_no_load() {
    let load = load_of_a_swinging_motor();
    assert!(load < 3.0, "{load} N m");
}

/// Angle of the output (rad) that is estimated of a resting joint whose output encoder has shown `off` (rad) so many times.
fn estimated_at_rest(off: f64, readings: u32) -> f64 {
    let joint = joint();
    let model = gear(&joint.gear, CONTROL_PERIOD);
    let observer =
        joint.observer.build(&joint.gear, &joint.limits, &joint.tolerances, CONTROL_PERIOD).unwrap();
    let mut state = observer.rest();
    let mut shown = Motion::default();
    shown.angle = shown.angle.plus(off);
    let measured = measured(Motion::default(), true, 0.0);
    let reading = OutputReading { angle: shown.angle, age: 0 };
    for _ in 0..readings {
        step(&observer, &model, &mut state, &measured);
        observer.correct_output(&mut state, &reading, &GearCorrection::default(), &mut Faults::default());
    }
    observer.estimate(&state, &GearCorrection::default()).output_position.to_radians()
}

#[test]
fn a_resting_outputs_last_count_moves_nothing() {
    let count = TAU / 2f64.powi(19);
    assert_eq!(estimated_at_rest(0.9 * count, 5000), estimated_at_rest(0.0, 5000));
    // It stops within the dead zone: at its edge, or beyond, where the correction of ten counts was taken for a motion of the motor.
    let off = estimated_at_rest(10.0 * count, 5000) - estimated_at_rest(0.0, 5000);
    assert!((8.8..10.0).contains(&(off / count)), "{} counts", off / count);
}

/// What no torsion within the uncertainty explains is an encoder's error until it lasts: 8 ms, ten readings. Twice what is
/// uncertain does nothing before, half of it corrects at once.
#[test]
fn a_gross_output_reading_corrects_nothing_at_first() {
    let joint = joint();
    let line = joint.gear.flexspline.line.build().unwrap();
    let uncertain = joint.tolerances.of_torsion() * line.torsion(joint.limits.output_torque);
    let moved = |off, readings| estimated_at_rest(off, readings) - estimated_at_rest(0.0, readings);
    assert!(moved(0.5 * uncertain, 1) > 0.0);
    for readings in 1..=10 {
        assert_eq!(moved(2.0 * uncertain, readings), 0.0, "{readings}");
    }
    assert!(moved(2.0 * uncertain, 11) > 0.0);
}

/// Ends of the gear in a period of the observer, for both models: the wave generator moves, the
/// flange twists by a wave of `torsion` (rad).
fn ends(model: &RealTimeGear<f64>, speed: f64, torsion: f64, k: u32) -> (Motion<f64>, Motion<f64>) {
    let time = f64::from(k) * PERIOD;
    let motor = Motion { angle: Angle::from_radians_f64(speed * time), velocity: speed };
    let (phase, rate) = (TAU * time, TAU * torsion);
    let deviation = model.kinematic_error(motor.angle, motor.angle.heading());
    let drive_rate = (model.ratio().value::<f64>() + deviation.slope) * speed;
    let angle = model.drive(motor.angle).plus(-torsion * phase.sin());
    (motor, Motion { angle, velocity: drive_rate - rate * phase.cos() })
}

fn observer_ends(
    model: &RealTimeGear<f64>,
    motor: Motion<f64>,
    flange: Motion<f64>,
) -> Ends<f64, impl Fn() -> Angle<f64>> {
    Ends {
        wave_generator: move || motor.angle,
        wave_generator_speed: motor.velocity,
        link_offset: flange.angle.minus(model.ratio().apply(motor.angle)),
        flange_speed: flange.velocity,
    }
}

/// By turns the gear is the gear: what is held for a period, or moved on, is off by no more than what happens in it.
#[test]
fn a_gear_by_turns_is_the_gear() {
    let joint = joint();
    let rated = joint.gear.rated_torque;
    for (speed, torsion, allowed) in [(0.0, 1.2e-3, 1e-3), (5.0, 1.2e-3, 1e-3), (200.0, 1e-4, 5e-3)] {
        let model = gear(&joint.gear, PERIOD);
        let multi_rate = MultiRate::build(model.ratio().value(), PERIOD);
        let (mut ours, mut theirs) = (MultiRateGear::default(), model.rest());
        ours.start_at(&model, Angle::default());
        for k in 0..10_000 {
            let (motor, flange) = ends(&model, speed, torsion, k);
            let one = ours.torques(
                &multi_rate,
                &model,
                &observer_ends(&model, motor, flange),
                &GearCorrection::default(),
            );
            let other = model.torques(&mut theirs, &motor, &flange, Applied::default());
            let off = (one.transmitted - other.transmitted).abs() / rated;
            assert!(k < 2 || off < allowed, "{speed} rad/s, period {k}: {off} {one:?} {other:?}");
            let n = f64::from(joint.gear.ratio.abs());
            let friction = n * (one.input_friction - other.input_friction).abs()
                + (one.output_friction - other.output_friction).abs();
            assert!(
                k < 100 || friction < 0.02 * rated,
                "{speed} rad/s, period {k}: {friction} {one:?} {other:?}"
            );
        }
    }
}

/// A gear file whose stiffness is larger by a fraction is the nominal gear corrected by it: hysteresis and wind-up.
#[test]
fn a_gear_told_to_be_stiffer_is_the_stiffer_gear() {
    for stiffening in [-0.1, 0.1] {
        let joint = joint();
        let mut stiffer = joint.gear;
        stiffer.flexspline.line.stiffness = stiffer.flexspline.line.stiffness.map(|k| (1.0 + stiffening) * k);
        let [nominal, true_one] = [&joint.gear, &stiffer].map(|params| gear(params, PERIOD));
        let multi_rate = MultiRate::build(nominal.ratio().value(), PERIOD);
        let known = GearCorrection { stiffening, ..GearCorrection::default() };
        let (mut of_corrected, mut of_true) = (MultiRateGear::default(), true_one.rest());
        for k in 0..10_000 {
            let (motor, flange) = ends(&nominal, 0.0, 1.2e-3, k);
            let ours =
                of_corrected.torques(&multi_rate, &nominal, &observer_ends(&nominal, motor, flange), &known);
            let theirs = true_one.torques(&mut of_true, &motor, &flange, Applied::default());
            let off = (ours.transmitted - theirs.transmitted).abs() / joint.gear.rated_torque;
            assert!(off < 3e-3, "{off}: {ours:?} {theirs:?}");
        }
    }
}
