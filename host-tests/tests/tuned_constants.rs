//! Tuned constants: each of them acts, and a scaled one returns to its value.
//!
//! A constant is scaled for the whole process, so the tests of this file take turns.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use strainwave::Angle;
use strainwave::compensator::tuned::{FADING_TIME, RESERVE, Tuned};
use strainwave::compensator::{CompensationGains, Input, Output, Sensors, Setpoint};
use strainwave::flexspline::Flexspline;
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::any_input::sequence;
use strainwave_desktop::bench::controller::{Controller, HostCompensator};
use strainwave_desktop::bench::working_motion::WorkingMotion;
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::catalogue::load::with_load;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::design::tuned;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::plant::divergence::RunError;
use strainwave_desktop::plant::sample::PlantSample;
use strainwave_desktop::plant::unknowns::Which;

/// Sequences of any inputs: in so many of them each constant that the control step reads has its turn.
const SEQUENCES: u64 = 60;

static TURN: Mutex<()> = Mutex::new(());

fn turn() -> MutexGuard<'static, ()> {
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Joints on which one or another rule is what limits a gain.
fn gears() -> Vec<GearFile> {
    let with_bits = |[motor, output]: [u32; 2]| {
        let mut gear = GearFile::default_gear();
        gear.sensors.motor_encoder_bits = motor;
        gear.sensors.output_encoder_bits = Some(output);
        gear
    };
    let mut weak = GearFile::default_gear();
    weak.motor.peak_torque *= 0.1;
    let light = with_load(&GearFile::default_gear(), 0.05);
    let coarse = [[13, 14], [14, 15], [15, 16], [16, 17]].map(with_bits);
    [GearFile::default_gear(), weak, light].into_iter().chain(coarse).collect()
}

/// The built compensator as words; none of a joint that is refused.
fn words(gear: &GearFile) -> Option<Vec<u32>> {
    Some(joint_params::<f32>(gear).ok()?.build().ok()?.to_words().to_vec())
}

/// A compensator at work, and what it reads.
struct Recorded {
    host: HostCompensator,
    read: Vec<Input<f32>>,
    /// Counts of the motor encoder, and periods by which they come late.
    counts: Vec<u32>,
    late: usize,
}

impl Controller for Recorded {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        self.counts.push(input.sensors.motor_encoder);
        let mut input = *input;
        input.sensors.motor_encoder = self.counts[self.read.len().saturating_sub(self.late)];
        self.read.push(input);
        Ok(self.host.step(&input))
    }
}

/// What a joint with this gear file reads while it works, with a motor encoder that is so many periods late.
fn work(gear: &GearFile, late: usize) -> Vec<Input<f32>> {
    record(gear, Bench::condensed(gear, &Conditions::of(gear, 1)).unwrap(), late)
}

/// The same on a bench.
fn record<F: Flexspline<f64>>(gear: &GearFile, mut bench: Bench<F>, late: usize) -> Vec<Input<f32>> {
    let host = HostCompensator::build(&joint_params(gear).unwrap()).unwrap();
    let mut recorded = Recorded { host, read: Vec::new(), counts: Vec::new(), late };
    bench.go(&WorkingMotion, &mut recorded, |_, _, _, _| ()).unwrap();
    recorded.read
}

/// A joint whose load swings on a flexible link, where the supervisor reduces the feedback at rest, and what it reads.
fn on_a_link() -> (GearFile, Vec<Input<f32>>) {
    const SEED: u64 = 153;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../gears/catalogue/hd32-100.toml");
    let sample = PlantSample::of(&GearFile::read(Path::new(path)).unwrap(), Which::All, SEED).unwrap();
    let conditions = Conditions { sensors: SensorSet::Both, ..Conditions::of(&sample.known, SEED) };
    let bench = Bench::condensed_of(&sample, &conditions).unwrap();
    (sample.known.clone(), record(&sample.known, bench, 0))
}

/// The default gear, known to a quarter: its cascade alone oscillates with a motor encoder that is seven periods late.
fn barely_known() -> GearFile {
    let mut gear = GearFile::default_gear();
    (gear.drive.torque_constant, gear.tolerances.stiffness) = (0.25, 0.25);
    gear.tolerances.rotor_inertia = 0.2;
    gear
}

/// A setpoint that runs at this speed (rad/s), then is stale; a setpoint far away, while the motor's torque does not move the joint. Both encoders stand
/// still.
fn stale_and_far(output_encoder: Option<u32>, speed: f32) -> Vec<Input<f32>> {
    let input = move |k: u32| {
        let time = 1e-4 * f64::from(k);
        let position = if k < 10_000 { f64::from(speed) * time.min(0.5) } else { 2.0 };
        let motor_torque = if k < 10_000 { 0.0 } else { 2.0 };
        let velocity = if k < 5000 { speed } else { 0.0 };
        let setpoint =
            Setpoint { position: Angle::from_radians_f64(position), velocity, ..Setpoint::default() };
        Input {
            command: setpoint.into(),
            gains: CompensationGains::ALL.into(),
            setpoint_age: if (5000..10_000).contains(&k) { 1.0 } else { 0.0 },
            sensors: Sensors { motor_torque, output_encoder, ..Sensors::default() },
            ..Input::default()
        }
    };
    (0..15_000).map(input).collect()
}

/// What a compensator of this gear answers.
fn answers<'a>(gear: &GearFile, inputs: &'a [Input<f32>]) -> impl Iterator<Item = Output<f32>> + use<'a> {
    let mut host = HostCompensator::build(&joint_params(gear).unwrap()).unwrap();
    inputs.iter().map(move |input| host.step(input))
}

/// What a joint reads, and what its compensator answered before a constant was scaled.
struct Recording<'a> {
    gear: &'a GearFile,
    inputs: Vec<Input<f32>>,
    before: Vec<Output<f32>>,
}

/// Every answer is what it was. Looked for on all processors, up to the first that is not.
fn unchanged(recorded: &[Recording]) -> bool {
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let changed = AtomicBool::new(false);
    let search = |worker: usize| {
        let own = recorded.iter().skip(worker).step_by(workers);
        for Recording { gear, inputs, before } in own.take_while(|_| !changed.load(Ordering::Relaxed)) {
            if !answers(gear, inputs).eq(before.iter().copied()) {
                changed.store(true, Ordering::Relaxed);
            }
        }
    };
    thread::scope(|scope| {
        for worker in 0..workers {
            scope.spawn(move || search(worker));
        }
    });
    !changed.into_inner()
}

#[test]
fn every_constant_acts() {
    let _turn = turn();
    let gears = gears();
    let coarse = gears.iter().min_by_key(|gear| gear.sensors.motor_encoder_bits).unwrap();
    let before: Vec<_> = gears.iter().map(words).collect();
    let unbuilt = |constant: &Tuned| {
        [0.5, 2.0].into_iter().all(|factor| {
            let _scaled = constant.scale(factor).unwrap();
            gears.iter().zip(&before).all(|(gear, before)| words(gear) == *before)
        })
    };
    let read: Vec<_> = tuned::every().filter(unbuilt).collect();
    println!("read by the control step: {:?}", read.iter().map(|constant| constant.name).collect::<Vec<_>>());
    let gear = GearFile::default_gear();
    let barely_known = barely_known();
    let (linked, on_a_link) = on_a_link();
    // First those of which nearly every constant changes one.
    let recorded: Vec<Recording> = [
        (coarse, work(coarse, 0)),
        (&barely_known, work(&barely_known, 7)),
        (&linked, on_a_link),
        (&gear, stale_and_far(None, 0.1)),
        (&gear, stale_and_far(Some(0), 0.02)),
    ]
    .into_iter()
    .chain((1..=SEQUENCES).flat_map(|seed| [&gear, coarse].map(|gear| (gear, sequence(gear, seed).unwrap()))))
    .map(|(gear, inputs)| Recording { gear, before: answers(gear, &inputs).collect(), inputs })
    .collect();
    let idle: Vec<_> = read
        .into_iter()
        .filter(|constant| {
            [0.5, 2.0].into_iter().all(|factor| {
                let _scaled = constant.scale(factor).unwrap();
                unchanged(&recorded)
            })
        })
        .map(|constant| constant.name)
        .collect();
    assert!(idle.is_empty(), "nothing changes with {idle:?}");
}

#[test]
fn a_scaled_constant_returns_to_its_value() {
    let _turn = turn();
    let values = || [FADING_TIME, RESERVE].map(Tuned::get);
    let gear = GearFile::default_gear();
    let before = words(&gear);
    {
        let _scaled = FADING_TIME.scale(2.0).unwrap();
        assert_eq!(values(), [2.0 * FADING_TIME.value, RESERVE.value]);
        assert!(RESERVE.scale(0.5).is_none(), "one constant is scaled at a time");
        assert_ne!(words(&gear), before);
        let elsewhere = thread::spawn(move || FADING_TIME.get()).join().unwrap();
        assert_eq!(elsewhere, 2.0 * FADING_TIME.value);
    }
    assert_eq!(values(), [FADING_TIME.value, RESERVE.value]);
    assert_eq!(words(&gear), before);
    for constant in tuned::every() {
        assert_eq!(constant.get().to_bits(), constant.value.to_bits(), "{}", constant.name);
    }
}
