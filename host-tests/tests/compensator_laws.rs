//! Laws of the compensator: the observer's error contracts, and feed-forward at rest does nothing new.

use core::f64::consts::TAU;

use strainwave::compensator::estimate::observer::{
    GearCorrection, Measurement, Observer, ObserverState, OutputReading,
};
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use strainwave::compensator::{Compensator, Faults, Input, JointParams, RealTimeGear};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, Motion};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::joint_params;

fn joint() -> JointParams<f64> {
    joint_params(&GearFile::default_gear()).unwrap()
}

/// The observer with a gear equal to its model, wound up by an unknown load.
struct Twins {
    joint: JointParams<f64>,
    gear: RealTimeGear<f64>,
    observer: Observer<f64>,
    state: ObserverState<f64>,
    with_output_encoder: bool,
}

impl Twins {
    fn new(with_output_encoder: bool) -> Self {
        let joint = joint();
        let reduced = Reduced::build(&joint.gear.flexspline, joint.gear.rated_torque).unwrap();
        let gear: RealTimeGear<f64> = joint.gear.build(reduced, joint.dt).unwrap();
        let observer = joint.observer.build(&joint.gear, &joint.limits, &joint.tolerances, joint.dt).unwrap();
        let state = observer.rest();
        Self { joint, gear, observer, state, with_output_encoder }
    }

    /// Errors of output angle (rad) and external torque (N m) at every step of the observer of a swinging motor.
    fn errors(&mut self, load: f64) -> Vec<(f64, f64)> {
        let (mut plant, mut flange) = (self.gear.rest(), Motion::default());
        for _ in 0..10_000 {
            self.gear.step(&mut plant, &mut flange, &Motion::default(), load);
        }
        let mut motor = Motion::default();
        let (mut errors, mut latch) = (Vec::new(), 0.0);
        for k in 0..20_000 {
            let acceleration = 300.0 * (10.0 * f64::from(k) * CONTROL_PERIOD).cos();
            let torques = self.gear.torques(&mut plant, &motor, &flange, Applied { motor: 0.0, load });
            let motor_torque = torques.wave_generator + self.joint.gear.wave_generator_inertia * acceleration;
            motor.advance(acceleration, CONTROL_PERIOD);
            flange.advance(self.gear.flange_acceleration(&torques, load), CONTROL_PERIOD);
            latch += motor_torque;
            if (k + 1) % OBSERVER_PERIODS != 0 {
                continue;
            }
            let reads_output = self.with_output_encoder && (k + 1) % SLOW_PERIODS == 0;
            let measured = Measurement {
                period: f64::from(OBSERVER_PERIODS) * CONTROL_PERIOD,
                motor: motor.angle,
                motor_speed: motor.velocity,
                reads_output,
                motor_torque: core::mem::take(&mut latch) / f64::from(OBSERVER_PERIODS),
                output_torque: None,
            };
            let mut faults = Faults::NONE;
            let gear_correction = GearCorrection::default();
            self.observer.step(&self.gear, &mut self.state, &measured, &gear_correction, false, &mut faults);
            if reads_output {
                let reading = OutputReading { angle: flange.angle, age: 0 };
                self.observer.correct_output(&mut self.state, &reading, &gear_correction, &mut faults);
            }
            let estimate = self.observer.estimate(&self.state, &gear_correction);
            // The start from a wrong torsion may reach a limit; a second later none is near.
            assert!(k < 10_000 || faults == Faults::NONE, "step {k}: {faults:?}");
            let angle = estimate.output_position.minus(flange.angle);
            errors.push((angle.abs(), (estimate.external_torque - load).abs()));
        }
        errors
    }
}

fn largest(errors: &[(f64, f64)]) -> (f64, f64) {
    errors.iter().fold((0.0, 0.0), |(a, b), &(x, y)| (f64::max(a, x), f64::max(b, y)))
}

#[test]
fn the_observers_error_contracts() {
    for with_output_encoder in [false, true] {
        for load in [-50.0, 30.0] {
            let errors = Twins::new(with_output_encoder).errors(load);
            let (first, last) = (largest(&errors[..50]), largest(&errors[7_500..]));
            println!("{with_output_encoder} {load}: {first:?} -> {last:?}");
            assert!(last.0 < 0.1 * first.0, "angle {first:?} -> {last:?}");
            assert!(last.1 < 0.1 * first.1, "external torque {first:?} -> {last:?}");
        }
    }
}

/// The default gear with this calibrated zero of its output encoder (rad).
fn with_zero(zero: Option<f64>) -> Compensator<f32> {
    let mut file = GearFile::default_gear();
    file.sensors.output_encoder_zero = zero;
    joint_params(&file).unwrap().build().unwrap()
}

/// The zero between the two encoders is taken from readings that are accepted.
#[test]
fn a_bad_first_reading_does_not_become_the_zero_of_the_output_encoder() {
    let compensator = with_zero(None);
    for (bad_motor, bad_output) in [(100_000, 1 << 19), (1 << 19, 300_000)] {
        let mut state = compensator.rest();
        let mut input = Input::<f32>::default();
        input.sensors.motor_encoder = bad_motor;
        input.sensors.output_encoder = Some(bad_output);
        let mut rounds = (0..2 * SLOW_PERIODS).map(|_| compensator.step(&mut state, &input));
        assert!(rounds.any(|output| output.faults != Faults::NONE));
        input.sensors.motor_encoder = 100_000;
        input.sensors.output_encoder = Some(300_000);
        let settled = (0..20_000).map(|_| compensator.step(&mut state, &input)).last().unwrap();
        // The setpoint has never been where the output is.
        assert!([Faults::NONE, Faults::SETPOINT_STEP].contains(&settled.faults), "{settled:?}");
        // Of a resting output one count of 2^19 a revolution is taken for nothing.
        assert!(settled.estimate.torsion.abs() < (1.1 * TAU / 2f64.powi(19)) as f32, "{settled:?}");
    }
}

/// Output encoder's reading (counts of 2^19) at rest after 2 s, whose first one was `noise` counts off, beyond where the
/// compensator takes the output for.
fn beyond_estimate(zero: Option<f64>, at_rest: u32, noise: u32) -> (f64, Faults) {
    let compensator = with_zero(zero);
    let (mut state, mut input) = (compensator.rest(), Input::<f32>::default());
    let mut last = compensator.output(&state);
    for k in 0..20_000 {
        input.sensors.output_encoder = Some(if k < SLOW_PERIODS { at_rest + noise } else { at_rest });
        last = compensator.step(&mut state, &input);
    }
    (f64::from(last.estimate.torsion) * 2f64.powi(19) / TAU, last.faults)
}

/// Without a calibrated zero the noise of the first reading stays: 20 counts.
#[test]
fn the_noise_of_the_first_reading_is_not_in_a_calibrated_zero() {
    let (torsion, faults) = beyond_estimate(Some(0.0), 0, 20);
    assert!(torsion.abs() < 1.1 && faults == Faults::NONE, "{torsion} {faults:?}");
    let (torsion, _) = beyond_estimate(None, 0, 20);
    assert!((15.0..21.0).contains(&torsion), "{torsion}");
}

/// 1000 counts are 12 mrad, more than any torque winds this gear up.
#[test]
fn a_wrong_zero_takes_the_output_encoder_out() {
    let (_, faults) = beyond_estimate(Some(0.0), 1000, 0);
    assert!(faults.contains(Faults::OUTPUT_ENCODER_OFF), "{faults:?}");
}

/// 0.05 rad from one look at it to the next, a round later, are 62 rad/s: the motor's speed, but no output's.
#[test]
fn an_output_encoder_jump_is_judged_by_the_outputs_speed() {
    let compensator = joint_params::<f32>(&GearFile::default_gear()).unwrap().build().unwrap();
    let mut state = compensator.rest();
    let mut input = Input::<f32>::default();
    input.sensors.output_encoder = Some(0);
    let mut faults_of_two_rounds = |input: &Input<f32>| {
        let faults = (0..2 * SLOW_PERIODS).map(|_| compensator.step(&mut state, input).faults);
        faults.fold(Faults::NONE, Faults::with)
    };
    assert_eq!(faults_of_two_rounds(&input), Faults::NONE);
    input.sensors.output_encoder = Some(4_172);
    assert_eq!(faults_of_two_rounds(&input), Faults::OUTPUT_ENCODER_JUMP);
}

/// A reading of an encoder that reads in every period, but not in the one in which it is looked at, is not taken for
/// one of now.
#[test]
fn a_reading_that_is_missed_is_no_reading() {
    let compensator = joint_params::<f32>(&GearFile::default_gear()).unwrap().build().unwrap();
    let estimates = |reads: fn(u32) -> bool| {
        let mut state = compensator.rest();
        let steps = (0..2000).map(|k| {
            let mut input = Input::<f32>::default();
            input.sensors.motor_encoder = 20 * k;
            input.sensors.output_encoder = reads(k).then(|| 0u32.wrapping_sub(k / 5) & 0x7_ffff);
            compensator.step(&mut state, &input).estimate.output_position
        });
        steps.last().unwrap()
    };
    assert_eq!(estimates(|k| k % SLOW_PERIODS == 5), estimates(|_| false));
    assert_ne!(estimates(|_| true), estimates(|_| false));
}
