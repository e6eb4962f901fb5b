//! A joint behind a tooth belt: its file, and the compensator that knows the belt.

use std::path::Path;

use strainwave::Error;
use strainwave::belt::SeriesBeltParams;
use strainwave::compensator::{Compensator, JointParams, Output};
use strainwave::gear::Motion;
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::controller::HostCompensator;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::design::belt::driving_belt;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::belt::WRIST;
use strainwave_desktop::plant::driving_belt::{DrivingBelt, Spans};

/// Outputs of a compensator in a scenario, and the output's angle (rad).
fn run(
    file: &GearFile,
    joint: &JointParams<f32>,
    scenario: Scenario,
    spans: Spans,
) -> Vec<(Output<f32>, f64)> {
    let mut bench = Bench::condensed(file, &Conditions { spans, ..Conditions::of(file, 3) }).unwrap();
    let mut controller = HostCompensator::build(joint).unwrap();
    let mut rows = Vec::new();
    let visit = |_, _, plant: &strainwave_desktop::plant::Plant<_>, answer| {
        rows.push((answer, plant.output().angle.to_radians()));
    };
    bench.go(&scenario, &mut controller, visit).unwrap();
    rows
}

/// Every output of every step, learnt factors and deviations too.
#[test]
fn a_rigid_belt_of_equal_pulleys_is_none_bit_for_bit() {
    let file = GearFile::default_gear();
    let none: JointParams<f32> = joint_params(&file).unwrap();
    let rigid = SeriesBeltParams { teeth: [30; 2], compliance: 0.0, slack_torque: 1.0 };
    let belt = JointParams { belt: Some(rigid), ..none };
    for scenario in [Scenario::S2, Scenario::S3] {
        let runs = [&none, &belt].map(|joint| run(&file, joint, scenario, Spans::default()));
        assert!(runs[0] == runs[1], "{scenario:?}");
    }
}

/// The real joint in its own units: torque within the motor's limit, reference near the motor's angle.
#[test]
fn the_wrist_goes_where_it_is_sent() {
    let file = GearFile::wrist();
    let joint = joint_params(&file).unwrap();
    for spans in [Spans::Chain, Spans::Massless] {
        let rows = run(&file, &joint, Scenario::S3, spans);
        let limit = file.motor.peak_torque as f32;
        assert!(rows.iter().all(|(answer, _)| answer.motor_torque.abs() <= 1.0001 * limit));
        let (last, output) = rows.last().unwrap();
        assert!((last.estimate.output_position.to_radians() - output).abs() < 3e-4, "{spans:?}");
        let [motor, driven] = file.belt.unwrap().pulley_teeth().map(f64::from);
        let expected = output * f64::from(file.gear.signed_ratio().n()) * driven / motor;
        assert!((last.motor_reference.to_radians() - expected).abs() < 0.1, "{spans:?}");
    }
}

/// What firmware reads is what the host has built, belt and all.
#[test]
fn a_belt_is_among_the_words() {
    let built: Compensator<f32> = joint_params(&GearFile::wrist()).unwrap().build().unwrap();
    let words = built.to_words();
    let read = Compensator::from_words(&words).unwrap();
    assert_eq!(read, &built);
    let limits = read.limits();
    assert!((limits.motor_torque - GearFile::wrist().motor.peak_torque as f32).abs() < 1e-6);
}

fn refused(from: &str, to: &str) -> String {
    assert!(WRIST.contains(from), "{from}");
    let text = WRIST.replace(from, to);
    GearFile::parse(Path::new("w.toml"), text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn what_is_wrong_with_the_belt_is_named() {
    for (from, to, line) in [
        (
            "pretension_n = 45.0",
            "pretension_n = -1.0",
            "w.toml: belt.pretension_n = -1.0 is out of range; allowed: a number from 0 to 1e6 N",
        ),
        (
            "pretension_n = 45.0\n",
            "",
            "w.toml: missing key belt.pretension_n; allowed: a number from 0 to 1e6 N",
        ),
        (
            "mass_kg_per_m",
            "mas_kg_per_m",
            "w.toml: unknown key belt.mas_kg_per_m = 0.025; the nearest known key is belt.mass_kg_per_m (a number from 1e-4 to 100 kg/m); and 1 more: strainwave check w.toml",
        ),
        (
            "\nteeth = 150",
            "\nteeth = 40",
            "w.toml: belt.teeth = 40 is out of range; allowed: at least 50, to go around pulleys of 24 and 36 teeth",
        ),
        (
            "motor_pulley_teeth = 24",
            "motor_pulley_teeth = 2",
            "w.toml: belt.motor_pulley_teeth = 2 is out of range: no tooth engaged, the belt lies on 0.95 teeth; allowed: at least 1 tooth in mesh",
        ),
        (
            "motor_pulley_teeth = 24",
            "motor_pulley_teeth = 4",
            "w.toml: belt.motor_pulley_teeth = 4 is out of range beside belt.wave_generator_pulley_teeth = 36; allowed: 1/8 to 4 times as many",
        ),
    ] {
        assert_eq!(refused(from, to), line);
    }
}

/// A belt as soft as the gear has no stretch that the observer could follow.
#[test]
fn a_belt_that_is_too_soft_is_refused_by_its_key() {
    let text = WRIST.replace("stiffness_n = 6.0e4", "stiffness_n = 600.0");
    let file = GearFile::parse(Path::new("w.toml"), text.as_bytes()).unwrap();
    let line = strainwave_desktop::design::buildable::buildable(&file).unwrap_err();
    assert!(
        line.starts_with("belt.stiffness_n = 600.0 is out of range; allowed, with the other keys as they"),
        "{line}"
    );
}

/// Micro-step of the belt alone (s), and the steps of a run.
const DT: f64 = 5e-6;
const STEPS: u32 = 40_000;

fn belt(spans: Spans) -> DrivingBelt {
    DrivingBelt::build(&driving_belt(&GearFile::wrist()).unwrap(), spans, DT).unwrap()
}

/// The motor swings a wave generator that is free, from rest.
fn swung(mut belt: DrivingBelt, torque: impl Fn(f64) -> f64) -> (DrivingBelt, Motion<f64>) {
    let mut wave_generator = Motion::default();
    for k in 0..STEPS {
        let on_gear = belt.step(Some(torque(f64::from(k) * DT)), &wave_generator);
        wave_generator.advance(on_gear / belt.wave_generator_inertia(), DT);
    }
    (belt, wave_generator)
}

/// Whatever the motor does, its work is on the wave generator, stored or lost in the belt; with a span that goes slack too.
#[test]
fn the_power_through_the_belt_balances() {
    for spans in [Spans::Chain, Spans::Massless] {
        let at_rest = belt(spans).stored(&Motion::default());
        for amplitude in [0.05, 2.0] {
            let (belt, wave_generator) = swung(belt(spans), |time| amplitude * (300.0 * time).sin());
            let [work, missing] = belt.balance(&wave_generator, at_rest);
            let moved = wave_generator.velocity.abs().max(1.0);
            assert!(
                missing.abs() < 0.02 * work.abs().max(1e-6 * moved),
                "{spans:?} {amplitude}: {missing} of {work}"
            );
        }
    }
}

/// Both pulleys by their teeth, and as one inertia.
#[test]
fn a_steady_torque_turns_both_as_one() {
    let file = GearFile::wrist();
    let ratio = file.belt.unwrap().ratio();
    let (belt, wave_generator) = swung(belt(Spans::Chain), |_| 0.01);
    let known = strainwave_desktop::design::wave_generator::at_wave_generator(&file);
    let expected = 0.01 / ratio / known.inertia.wave_generator * f64::from(STEPS) * DT;
    assert!((wave_generator.velocity / expected - 1.0).abs() < 0.02, "{}", wave_generator.velocity);
    assert!((belt.motor().velocity * ratio / wave_generator.velocity - 1.0).abs() < 0.01);
}

#[test]
fn a_micro_step_that_is_too_long_is_refused() {
    let params = driving_belt(&GearFile::wrist()).unwrap();
    let refused = DrivingBelt::build(&params, Spans::Massless, 1e-3).err();
    assert_eq!(refused, Some(Error::OutOfRange("dt")));
}
