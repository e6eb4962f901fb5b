//! Learning from a moving joint's log: what comes back from a joint of known parameters, and what is refused.

use std::f64::consts::TAU;
use std::path::Path;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use strainwave::friction::{FrictionModel, FrictionParams, JointFriction, JointFrictionState, Slip};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::firmware_gear_params;
use strainwave_desktop::identify::{Error, LearntGear, learn_gear};
use strainwave_desktop::io::gear_file::Harmonic;
use strainwave_desktop::io::log::{MeasuredLog, Time};
use strainwave_desktop::verify::identify::friction::measure;
use strainwave_desktop::verify::identify::{held, pairs};
use strainwave_desktop::verify::{Measured, replay};

const INTERVAL: f64 = 0.004;
const REVOLUTIONS: f64 = 9.0;
const DURATION: f64 = 6.0;
/// Steps of the block in an interval.
const PARTS: usize = 40;
/// Level of the friction over the base gear's.
const LEVEL: f64 = 1.6;
const ECCENTRIC: Harmonic = Harmonic { order: 1, amplitude: 3e-4, phase: 0.4 };
const ERROR: [Harmonic; 2] =
    [Harmonic { order: 2, amplitude: 7e-5, phase: 1.0 }, Harmonic { order: 4, amplitude: 2e-5, phase: -2.0 }];

/// The default gear without friction at the output.
fn base() -> GearFile {
    let mut gear = GearFile::default_gear();
    let output = &mut gear.friction.output;
    for level in [&mut output.coulomb, &mut output.static_level, &mut output.viscous] {
        *level = Some(0.0);
    }
    gear
}

/// Angle, speed and acceleration of a motor that stands, moves by `revolutions` there and back, and stands.
fn motion(t: f64, revolutions: f64) -> [f64; 3] {
    let rate = TAU / (DURATION - 1.0);
    let u = rate * (t - 0.5).clamp(0.0, DURATION - 1.0);
    let amplitude = revolutions * TAU / 2.0;
    let moves = f64::from(u8::from(u > 0.0 && u < TAU));
    [amplitude * (1.0 - u.cos()), amplitude * rate * u.sin(), moves * amplitude * rate * rate * u.cos()]
}

/// The input friction's block, its levels [`LEVEL`] times the base gear's.
fn block() -> JointFriction<f64> {
    let mut params = firmware_gear_params::<f64>(&base()).unwrap().input_friction;
    for contact in [&mut params.forward, &mut params.backward] {
        contact.coulomb *= LEVEL;
        contact.static_level *= LEVEL;
    }
    params.build().unwrap()
}

/// Friction of the block at the end of every interval (N m).
fn friction(revolutions: f64) -> impl FnMut(usize) -> f64 {
    let (block, mut state) = (block(), JointFrictionState::default());
    move |k| {
        for part in 0..PARTS {
            let time = ((k * PARTS + part + 1) as f64 / PARTS as f64 - 1.0) * INTERVAL;
            let [_, speed, _] = motion(time.max(0.0), revolutions);
            block.step(&mut state, &Slip::new(speed, INTERVAL / PARTS as f64));
        }
        block.force(&state)
    }
}

/// A joint that its load's inertia alone winds up.
fn log(revolutions: f64) -> MeasuredLog {
    let gear = base();
    let r: f64 = gear.gear.signed_ratio().value();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let noise = Normal::new(0.0, 1.0).unwrap();
    let mut sample = || noise.sample(&mut random);
    let stamps = (DURATION / INTERVAL) as usize;
    let mut log = MeasuredLog {
        time: Time::every(INTERVAL, stamps),
        motor_position: Vec::new(),
        motor_torque: Vec::new(),
        output_position: Some(Vec::new()),
        output_torque: None,
        model_torque: None,
    };
    let mut friction = friction(revolutions);
    for k in 0..stamps {
        let [motor, _, acceleration] = motion(k as f64 * INTERVAL, revolutions);
        let torsion = gear.inertia.flexspline * r * acceleration / gear.stiffness.k1;
        let error: f64 = ERROR.iter().map(|harmonic| harmonic.at(motor * (1.0 - r))).sum();
        log.motor_position.push(motor + 2e-5 * sample());
        let inertia = gear.inertia.wave_generator + r * r * gear.inertia.flexspline;
        log.motor_torque.push(friction(k) + inertia * acceleration + 2e-3 * sample());
        let output = r * motor + error - torsion + ECCENTRIC.at(r * motor) + 2e-6 * sample();
        log.output_position.as_mut().unwrap().push(output + 0.25);
    }
    log
}

fn learn(log: &MeasuredLog, training: f64) -> Result<LearntGear, Error> {
    learn_gear(&base(), log, training, |_| ())
}

/// The complex amplitudes of two harmonics differ by so much (rad).
fn apart(a: &Harmonic, b: &Harmonic) -> f64 {
    let (sa, ca) = a.phase.sin_cos();
    let (sb, cb) = b.phase.sin_cos();
    (a.amplitude * ca - b.amplitude * cb).hypot(a.amplitude * sa - b.amplitude * sb)
}

#[test]
fn kinematic_error_and_friction_come_back_from_a_third_of_the_motion() {
    let found = learn(&log(REVOLUTIONS), 1.0 / 3.0).unwrap();
    assert!((found.revolutions - 2.0 / 3.0 * REVOLUTIONS).abs() < 0.1, "{}", found.revolutions);
    for truth in &ERROR {
        let orders = &found.gear.kinematic_error.flexspline;
        let learnt = orders.iter().find(|harmonic| harmonic.order == truth.order).unwrap();
        assert!(apart(learnt, truth) < 5e-6, "{learnt:?} {truth:?}");
    }
    let level = found.gear.friction.input.coulomb.unwrap() / base().friction.input.coulomb.unwrap();
    assert!((level / LEVEL - 1.0).abs() < 0.15, "{level}");
    let judgement = found.judgement.unwrap();
    assert!(judgement.ratio() < 0.25, "{judgement:?}");
    assert!(judgement.rms < found.base_judgement.unwrap().rms);
    assert_eq!(found.gear.stiffness, base().stiffness);
    // The gear file says all of it.
    let again = GearFile::parse("learnt.toml".as_ref(), found.gear.to_toml().as_bytes()).unwrap();
    assert_eq!(again, found.gear);
}

/// The first third of the path there and back goes one way.
#[test]
fn friction_is_learnt_in_the_directions_that_the_motor_moved_in_alone() {
    let learnt = |training: f64| learn(&log(REVOLUTIONS), training).unwrap();
    let coulomb = |found: &LearntGear| {
        let input = &found.gear.friction.input;
        [input.coulomb.unwrap(), input.backwards().coulomb.unwrap()]
    };
    let before = base().friction.input.coulomb.unwrap();
    let (third, whole) = (learnt(1.0 / 3.0), learnt(1.0));
    assert_eq!((third.friction.directions, whole.friction.directions), ([true, false], [true, true]));
    assert_eq!(coulomb(&third), [before * third.friction.level, before]);
    assert_eq!(coulomb(&whole), [before * whole.friction.level; 2]);
    assert!(third.friction.level > 1.3 && third.friction.limits().is_empty());
}

#[test]
fn all_of_the_log_may_train_and_then_nothing_is_judged() {
    let found = learn(&log(REVOLUTIONS), 1.0).unwrap();
    assert!(found.judgement.is_none() && found.training_rms.unwrap() < 2e-5, "{:?}", found.training_rms);
}

/// What needs no output encoder is the same without one; what needs one stays.
#[test]
fn friction_is_learnt_without_an_output_encoder() {
    let (with, mut log) = (learn(&log(REVOLUTIONS), 0.5).unwrap(), log(REVOLUTIONS));
    log.output_position = None;
    let without = learn(&log, 0.5).unwrap();
    assert_eq!(without.friction, with.friction);
    assert_eq!(without.gear.friction, with.gear.friction);
    assert_eq!(without.gear.kinematic_error, base().kinematic_error);
    assert_eq!(without.gear.compensation, base().compensation);
    assert!(without.judgement.is_none() && without.training_rms.is_none());
    let why = without.not_identified().iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
    assert!(why.contains("kinematic error: not identified, the log has no column theta_out_rad"), "{why}");
}

/// A quarter of a revolution is needed for the two lobes.
#[test]
fn a_short_motion_shows_friction_alone() {
    let found = learn(&log(0.3), 1.0 / 3.0).unwrap();
    assert!(!found.errors && found.revolutions < 0.25, "{}", found.revolutions);
    assert_eq!(found.gear.kinematic_error, base().kinematic_error);
    assert!((found.friction.level / LEVEL - 1.0).abs() < 0.15, "{}", found.friction.level);
    assert!(found.training_rms.is_some());
}

#[test]
fn what_the_log_does_not_show_is_refused_by_name() {
    let least_travel = 2.0 * base().friction.input.presliding.unwrap();
    match learn(&log(0.005), 1.0 / 3.0) {
        Err(error @ Error::TooLittleTravel { travel, least }) => {
            assert!(travel < least && least == least_travel);
            let line = error.to_string();
            assert!(line.contains("friction needs at least 4.000e-2 rad"), "{line}");
        }
        other => panic!("{:?}", other.map(|found| found.revolutions)),
    }
    let mut turned = log(REVOLUTIONS);
    turned.output_position.iter_mut().flatten().for_each(|angle| *angle = -*angle);
    let line = learn(&turned, 0.5).unwrap_err().to_string();
    assert!(line.starts_with("column theta_out_rad: it moves by -1.00"), "{line}");
    let reversed = log(REVOLUTIONS).with_reversed_torque();
    let error = learn(&reversed, 0.5).unwrap_err();
    assert!(matches!(error, Error::ReversedTorque { .. }));
    assert!(error.to_string().ends_with("give --reversed-torque"), "{error}");
    assert!(learn(&log(REVOLUTIONS), 0.1).is_err());
}

/// A sample of what `strainwave verify identify` measures.
#[test]
fn friction_of_the_blocks_own_law_comes_back_with_its_intervals() {
    let measured = measure(0..10, |_| ()).unwrap();
    measured.figures.iter().for_each(|figure| println!("{}", figure.cells().join("  ")));
    let value = |name: &str| measured.figures.iter().find(|figure| figure.name == name).unwrap().value;
    // Of 10 joints one in 20 is outside by chance, more than two of them once in 90 samples.
    assert!(value("identify.friction.outside") <= 0.2);
    assert!(value("identify.friction.level.worst") < 0.05);
    assert!(value("identify.friction.over_static") < 0.1);
}

/// The joint of `examples/logs/` has 1.5 times the levels that its gear file says, and the same viscous friction.
#[test]
fn friction_of_the_example_joint_is_found() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/logs");
    let base = GearFile::read(&folder.join("my-joint.toml")).unwrap();
    let log = MeasuredLog::read(&folder.join("moving.csv")).unwrap();
    let friction = learn_gear(&base, &log, 0.5, |_| ()).unwrap().friction;
    println!("{friction:#?}");
    assert!((friction.level - 1.5).abs() < 0.03, "{}", friction.level);
    assert!((friction.viscous - 1.0).abs() < 0.1, "{}", friction.viscous);
}

/// What of `strainwave verify identify` meets its bounds goes on meeting them.
#[test]
fn held_joints_and_pairs_of_logs_are_as_good_as_they_were() {
    let [held, pairs] = [held::measure(), pairs::measure()].map(Result::unwrap);
    let value = |measured: &Measured, name: &str| {
        let found = measured.figures.iter().find(|figure| figure.name == name);
        found.map_or(0.0, |figure| figure.value)
    };
    assert!(held.figures.iter().all(|figure| figure.holds), "{:#?}", held.figures);
    assert!(value(&pairs, "identify.pairs.worst_over_untrained") <= 1.0);
    // 1.09 is measured, and 1.4 where short logs do not train.
    assert!(value(&pairs, "identify.pairs.median_over_rigid") < 1.2);
    let skipped = held.notes.iter().chain(&pairs.notes);
    skipped.for_each(|note| assert!(note.contains("skipped: no data"), "{note}"));
}

#[test]
fn measured_joints_are_predicted_or_their_absence_is_told() {
    let measured = replay::measure().unwrap();
    measured.figures.iter().for_each(|figure| println!("{}", figure.cells().join("  ")));
    assert!(measured.figures.iter().all(|figure| figure.holds), "{:#?}", measured.figures);
    if measured.figures.is_empty() {
        assert!(measured.notes.iter().all(|note| note.ends_with("skipped: no data (lara8)")));
        measured.notes.iter().for_each(|note| println!("{note}"));
    }
}
