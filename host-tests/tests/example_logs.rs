//! Logs in `examples/logs/` are those of an invented joint, which is not what its gear file says: `my-joint.toml` is what
//! `strainwave new --size 25 --ratio 100 --load 0.8` writes, the joint is softer by a tenth, has twice the hysteresis, half as much
//! friction at the motor again, and a kinematic error of its own.
//!
//! The reference plant moves under the cascade that the gear file has, its sensors as noisy as stated there, and every fiftieth
//! control period is logged, the clock off by up to twelve. `held.csv`: the motor is braked, the torque at the output goes
//! through loops. `moving.csv`: slow and medium moves both ways. `other.csv` and `next.csv`: other moves, cut in motion.
//! `my-motion.csv` and `in.csv` are a commanded motion, and inputs of the open loop.
//!
//! Kept logs and those of today agree within a count of an encoder and [`TORQUE`] of a torque: the mesh is summed by the vector
//! instructions that a processor has. After a change of plant or catalogue: `STRAINWAVE_OVERWRITE=1 cargo test -p
//! strainwave-host-tests example_logs`, and review the difference.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::PathBuf;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{Input, Output, Sensors};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::baseline::Baseline;
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::bench::task::{Demand, Task};
use strainwave_desktop::bench::{Bench, Conditions, Trajectory};
use strainwave_desktop::catalogue::{Model, NewJoint};
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::io::log::{CommandedMotion, Time};
use strainwave_desktop::plant::divergence::RunError;

/// Control periods from one row to the next, and by how many the clock is off.
const ROWS: (i64, i64) = (50, 12);
/// Largest difference of two torques of one log (N m): that of their last digit.
const TORQUE: f64 = 2e-3;
/// All files together are at most so long (bytes).
const LONGEST: u64 = 400_000;
/// Seed of noise and clock.
const SEED: u64 = 25_100;

/// End (rad) and duration (s) of each move, rest to rest.
const MOVES: [(f64, f64); 8] =
    [(0.25, 2.0), (-0.05, 3.0), (0.15, 4.0), (0.1, 1.5), (0.4, 2.0), (0.0, 3.5), (-0.1, 2.0), (0.0, 2.0)];
/// The same of the other motion, and when it is cut (s).
const OTHER_MOVES: [(f64, f64); 4] = [(-0.3, 2.5), (-0.15, 2.0), (-0.25, 2.0), (0.0, 2.0)];
const CUT: f64 = 3.4;
/// The commanded motion.
const MY_MOTION: [(f64, f64); 2] = [(0.3, 0.5), (0.0, 0.7)];
/// Amplitudes of the held joint's torque loops (N m), and how long each takes (s).
const LOOPS: ([f64; 4], f64) = ([80.0, 40.0, 60.0, 80.0], 1.5);

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples/logs")
}

/// What a user has to start from.
fn said() -> NewJoint {
    NewJoint { model: Model { size: 25, ratio: 100 }, load: Some(0.8) }
}

/// The joint as it is.
fn truth() -> GearFile {
    let mut gear = said().gear();
    let stiffness = &mut gear.stiffness;
    for value in [&mut stiffness.k1, &mut stiffness.k2, &mut stiffness.k3] {
        *value *= 0.9;
    }
    gear.hysteresis.width_arcmin *= 2.0;
    let input = &mut gear.friction.input;
    for level in [&mut input.coulomb, &mut input.static_level] {
        *level = level.map(|level| 1.5 * level);
    }
    for (harmonic, (amplitude, phase)) in
        gear.kinematic_error.wave_generator.iter_mut().zip([(1.3e-4, 0.8), (3e-5, -1.1)])
    {
        (harmonic.amplitude, harmonic.phase) = (amplitude, phase);
    }
    gear
}

/// Angles every 10 ms of moves from rest to rest.
fn moves(ends: &[(f64, f64)]) -> CommandedMotion {
    let angle = |time: f64| {
        let (mut from, mut elapsed) = (0.0, time);
        for (to, duration) in ends {
            let x = elapsed / duration;
            if x < 1.0 {
                return from + (to - from) * x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3));
            }
            (from, elapsed) = (*to, elapsed - duration);
        }
        from
    };
    let duration: f64 = ends.iter().map(|(_, duration)| duration).sum();
    let time = Time::every(0.01, (duration / 0.01).round() as usize + 1);
    let position = time.stamps().iter().map(|time| angle(*time)).collect();
    CommandedMotion { time, position, velocity: None, acceleration: None, load: None }
}

/// Loops of the torque at the output while a brake holds the motor.
struct Held;

impl Task for Held {
    fn duration(&self) -> f64 {
        LOOPS.1 * LOOPS.0.len() as f64
    }

    fn at(&self, time: f64, _: &Capability) -> Demand {
        let amplitude = LOOPS.0[((time / LOOPS.1) as usize).min(LOOPS.0.len() - 1)];
        Demand { load: amplitude * (TAU * time / LOOPS.1).sin(), ..Demand::default() }
    }

    fn blocked(&self) -> bool {
        true
    }
}

/// A cascade, and what it read.
struct Recorder(Baseline, Vec<Sensors<f32>>);

impl Controller for Recorder {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        self.1.push(input.sensors);
        Controller::step(&mut self.0, input)
    }
}

/// Readings of the joint in a task, with or without a torque sensor at its output.
fn readings(task: &impl Task, output_torque: bool) -> Vec<Sensors<f32>> {
    let mut gear = truth();
    gear.sensors.output_torque = output_torque;
    // The nominal plant of this gear.
    let conditions = Conditions { sensors: SensorSet::Both, ..Conditions::of(&gear, 0) };
    let mut bench = Bench::build(&gear, &conditions).unwrap();
    let mut recorder = Recorder(Baseline::b0(&said().gear()).unwrap(), Vec::new());
    bench.go(task, &mut recorder, |_, _, _, _| ()).unwrap();
    recorder.1
}

/// An encoder's counts as an angle that goes on from turn to turn (rad).
struct Unwrapped {
    bits: u32,
    turns: f64,
    last: f64,
}

impl Unwrapped {
    fn new(bits: u32) -> Self {
        Self { bits, turns: 0.0, last: 0.0 }
    }

    fn angle(&mut self, count: u32) -> f64 {
        let phase = TAU * f64::from(count) / 2f64.powi(self.bits.cast_signed());
        let wrapped = ((self.last - phase) / TAU).round();
        self.turns = wrapped * TAU;
        self.last = phase + self.turns;
        self.last
    }
}

/// Readings as a log, of which every row within the seconds of `part` is kept.
fn log(readings: &[Sensors<f32>], part: [f64; 2]) -> String {
    let sensors = truth().sensors;
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let (mut motor, mut output) =
        (Unwrapped::new(sensors.motor_encoder_bits), Unwrapped::new(sensors.output_bits()));
    let torque = readings.iter().any(|reading| reading.output_torque.is_some());
    let mut text = String::from("t_s,theta_motor_rad,tau_motor_nm,theta_out_rad");
    text.push_str(if torque { ",tau_out_nm\n" } else { "\n" });
    for row in 1..readings.len() as i64 / ROWS.0 {
        let period = row * ROWS.0 + random.random_range(-ROWS.1..=ROWS.1);
        let (reading, time) = (&readings[period as usize], period as f64 * CONTROL_PERIOD);
        let Some(count) = reading.output_encoder else { panic!("the output encoder reads every period") };
        let angles = [motor.angle(reading.motor_encoder), output.angle(count)];
        if (part[0]..part[1]).contains(&time) {
            let _ = write!(text, "{time:.4},{:.6},{:.4},{:.7}", angles[0], reading.motor_torque, angles[1]);
            let _ = reading.output_torque.map_or(Ok(()), |torque| write!(text, ",{torque:.3}"));
            text.push('\n');
        }
    }
    text
}

/// A commanded motion as a file.
fn commanded(motion: &CommandedMotion) -> String {
    let mut text = String::from("t_s,theta_rad\n");
    for (time, angle) in motion.time.stamps().iter().zip(&motion.position) {
        let _ = writeln!(text, "{time:.2},{angle:.9}");
    }
    text
}

/// Inputs of the open loop: half a turn of the wave generator and back, and a load that comes and goes.
fn open_loop() -> String {
    let mut text = String::from("t_s,theta_wg_rad,tau_load_nm\n");
    for k in 0..=100 {
        let x = f64::from(k) / 100.0;
        let angle = PI * (PI * x).sin().powi(2);
        let _ = writeln!(text, "{:.3},{angle:.9},{:.6}", 0.2 * x, 30.0 * (TAU * x).sin().powi(3));
    }
    text
}

/// Every file of the folder.
fn files() -> Vec<(&'static str, String)> {
    std::thread::scope(|scope| {
        let moving = scope.spawn(|| readings(&Trajectory::of(&moves(&MOVES)), false));
        let other = scope.spawn(|| readings(&Trajectory::of(&moves(&OTHER_MOVES)), false));
        let held = readings(&Held, true);
        let [moving, other] = [moving, other].map(|thread| thread.join().unwrap());
        let whole = [0.0, f64::INFINITY];
        vec![
            ("my-joint.toml", said().text()),
            ("held.csv", log(&held, whole)),
            ("moving.csv", log(&moving, whole)),
            ("other.csv", log(&other, [0.0, CUT])),
            ("next.csv", log(&other, [CUT, f64::INFINITY])),
            ("my-motion.csv", commanded(&moves(&MY_MOTION))),
            ("in.csv", open_loop()),
        ]
    })
}

/// The first cell in which two logs differ by more than a count or a digit.
fn difference(kept: &str, today: &str) -> Option<String> {
    let sensors = truth().sensors;
    let count = |bits: u32| 1.1 * TAU / 2f64.powi(bits.cast_signed());
    if kept.lines().count() != today.lines().count() || kept.lines().next() != today.lines().next() {
        return Some("header or number of rows".into());
    }
    let header: Vec<_> = kept.lines().next()?.split(',').collect();
    let allowed = |name: &str| match name {
        "theta_motor_rad" => count(sensors.motor_encoder_bits),
        "theta_out_rad" => count(sensors.output_bits()),
        "tau_motor_nm" | "tau_out_nm" => TORQUE,
        _ => 0.0,
    };
    for (row, (a, b)) in kept.lines().zip(today.lines()).enumerate().skip(1) {
        for ((name, a), b) in header.iter().zip(a.split(',')).zip(b.split(',')) {
            let [x, y]: [f64; 2] = [a, b].map(|cell| cell.parse().unwrap());
            if (x - y).abs() > allowed(name) {
                return Some(format!("row {}, column {name}: {a} is {b} today", row + 1));
            }
        }
    }
    None
}

#[test]
fn the_checked_in_logs_are_those_of_the_plant() {
    let files = files();
    for (name, today) in &files {
        let path = folder().join(name);
        if std::env::var_os("STRAINWAVE_OVERWRITE").is_some() {
            std::fs::write(&path, today).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap();
        let same = if name.ends_with("csv") { difference(&kept, today).is_none() } else { kept == *today };
        assert!(same, "examples/logs/{name}: {:?}", difference(&kept, today));
    }
    let there: Vec<_> = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap()).collect();
    assert_eq!(there.len(), files.len(), "no other file stands among them");
    let bytes: u64 = there.iter().map(|entry| entry.metadata().unwrap().len()).sum();
    assert!(bytes < LONGEST, "{bytes} bytes");
}

/// A digit more than allowed is found.
#[test]
fn a_changed_log_is_found() {
    let log = "t_s,theta_motor_rad,tau_motor_nm\n0.1,0.5,0.25\n0.2,0.5,0.25\n";
    assert_eq!(difference(log, log), None);
    let changed = log.replacen("0.25", "0.253", 1);
    assert_eq!(difference(log, &changed).unwrap(), "row 2, column tau_motor_nm: 0.25 is 0.253 today");
    assert!(difference(log, &log.replacen("0.5", "0.5001", 1)).is_some());
    assert!(difference(log, &log.replacen("0.2,", "0.21,", 1)).is_some());
    assert!(difference(log, &log.replacen("0.2,0.5,0.25\n", "", 1)).is_some());
}
