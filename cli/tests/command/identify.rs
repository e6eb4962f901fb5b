//! `identify` through the real command: a gear file from logs, and what is refused.

use std::fmt::Write as _;

use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::gear_params;
use strainwave_desktop::identify::reversal::loops;

use crate::bench::Bench;

const IDENTIFY: &str = "identify log.csv --gear g.toml --output new.toml --plot loop.svg --json out.json";

/// A joint of the default gear with twice its hysteresis, held at the motor, its output turned through loops.
fn log() -> String {
    let mut gear = GearFile::default_gear();
    gear.hysteresis.width_arcmin = 2.0;
    let params = gear_params::<f64>(&gear);
    let line = params.flexspline.line.build().unwrap();
    let model: TorsionHysteresis<f64, 24, 64> = params.hysteresis().unwrap();
    let mut state = TorsionHysteresisState::default();
    let mut log = String::from("t_s,theta_motor_rad,tau_motor_nm,theta_out_rad,tau_out_nm\n");
    for (k, torsion) in loops(line.torsion(params.rated_torque), 24, 2, 2).into_iter().enumerate() {
        let torque = line.torque(torsion) + model.step(&mut state, torsion).torque;
        let _ = writeln!(log, "{},0.5,0,{},{torque}", k as f64 * 0.01, -torsion);
    }
    log
}

fn figure(json: &str, name: &str) -> f64 {
    let json: serde_json::Value = serde_json::from_str(json).unwrap();
    let figures = json["figures"].as_array().unwrap();
    figures.iter().find(|figure| figure["name"] == name).unwrap()["value"].as_f64().unwrap()
}

#[test]
fn a_gear_file_is_identified_written_and_simulated() {
    let bench = Bench::new();
    bench.write("log.csv", log());
    let answer = bench.run(IDENTIFY);
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.starts_with("weights on "), "{}", answer.output);
    let json = std::fs::read_to_string(bench.path("out.json")).unwrap();
    assert!((figure(&json, "identify.stiffness_factor") - 1.0).abs() < 0.02);
    assert!((figure(&json, "identify.hysteresis.width") / 5.82e-4 - 1.0).abs() < 0.1);
    assert!(figure(&json, "identify.held_out.rms") < 0.2 * figure(&json, "identify.held_out.base.rms"));
    let svg = std::fs::read_to_string(bench.path("loop.svg")).unwrap();
    assert!(svg.contains("torsion [urad]") && svg.contains("identified"));
    let gear = GearFile::read(&bench.path("new.toml")).unwrap();
    assert!(gear.hysteresis.weights.is_some() && (gear.hysteresis.width_arcmin - 2.0).abs() < 0.2);
    for build in ["realtime", "reference"] {
        let run = |gear: &str| {
            let words = format!("sim --gear {gear} --input in.csv --output sim.csv --build {build}");
            let answer = bench.run(&words);
            assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
            std::fs::read_to_string(bench.path("sim.csv")).unwrap()
        };
        assert!(run("new.toml") != run("g.toml"), "{build}");
    }
}

#[test]
fn several_logs_share_their_weights() {
    let bench = Bench::new();
    bench.write("log.csv", log());
    bench.write("second.csv", log().replace(",0.5,", ",0.7,"));
    let answer = bench.run(&IDENTIFY.replace("log.csv", "log.csv second.csv --levels 8 --training 0.6"));
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert_eq!(GearFile::read(&bench.path("new.toml")).unwrap().hysteresis.weights.unwrap().len(), 8);
}

#[test]
fn logs_that_show_no_hysteresis_are_refused_by_name() {
    let bench = Bench::new();
    let log = log();
    let lines: Vec<&str> = log.lines().collect();
    let rise = |count: usize| lines[..=count].join("\n");
    for (text, expected) in [
        (rise(20), "log.csv: 20 samples are too few; allowed: at least 100"),
        (rise(0), "log.csv: no rows after the header"),
        (log.replace(",tau_out_nm", ""), "log.csv: row 2, column 5: "),
        (
            log.replace("theta_out_rad", "theta_rad"),
            "log.csv: row 1, column \"theta_rad\": unknown; known columns",
        ),
        (log.replace("0.01,0.5,0,", "0.01,0.5,0,nan"), "log.csv: row 3, column theta_out_rad: \"nan"),
        (
            [&lines[..11], &lines[61..]].concat().join("\n"),
            "log.csv: row 12, column t_s: a gap of 0.510000 s before this row",
        ),
        (
            log.lines().map(|line| line.rsplit_once(',').unwrap().0).collect::<Vec<_>>().join("\n"),
            "log.csv: column tau_out_nm is missing; the torsion and the torque at the output are needed",
        ),
        (
            log.replacen("0.01,0.5", "0.01,3.5", 1),
            "log.csv: the motor turns by 3.000 rad; allowed: at most 0.5 rad, the joint has to be held",
        ),
    ] {
        bench.write("log.csv", text);
        let line = bench.refused(IDENTIFY);
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
    let mut steady = String::from("t_s,theta_motor_rad,tau_motor_nm,theta_out_rad,tau_out_nm\n");
    (0..200).for_each(|k| _ = writeln!(steady, "{},0,0,{},{k}", f64::from(k) * 0.01, f64::from(-k) * 1e-5));
    bench.write("log.csv", steady);
    let line = bench.refused(IDENTIFY);
    assert!(line.starts_with("error: log.csv: the torque never reverses by 0.01 of its span"), "{line}");
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    let bench = Bench::new();
    bench.write("log.csv", log());
    for (option, expected) in [
        ("--training 0", "--training 0 is out of range; allowed: a number from 0.2 to 1"),
        ("--training nan", "--training NaN is out of range; allowed: a number from 0.2 to 1"),
        ("--levels 7", "--levels 7 is out of range; allowed: 6, 8, 12 or 24"),
        ("--smoothing -1", "--smoothing -1 is out of range; allowed: a number from 1e-12 to 1e6"),
    ] {
        assert_eq!(bench.refused(&format!("{IDENTIFY} {option}")), format!("error: {expected}"));
    }
    let line = bench.refused(&IDENTIFY.replace("new.toml", "log.csv"));
    assert!(line.ends_with("are the same file"), "{line}");
    let line = bench.refused(&IDENTIFY.replace("new.toml", "none/new.toml"));
    assert!(line.contains("none/new.toml: cannot be written: there is no folder"), "{line}");
    let line = bench.refused("identify --gear g.toml --output new.toml");
    assert!(
        line.starts_with("error: the following required arguments were not provided: <LOG.csv>"),
        "{line}"
    );
}

/// In the first half of the log the joint is twice as soft, in the second it is not.
#[test]
fn a_gear_that_predicts_worse_than_its_base_is_not_written_unless_forced() {
    let bench = Bench::new();
    let log = log();
    let lines: Vec<&str> = log.lines().collect();
    let softer = |(row, line): (usize, &&str)| {
        let (before, torque) = line.rsplit_once(',').unwrap();
        let (before, output) = before.rsplit_once(',').unwrap();
        let factor = if row < lines.len() / 2 { 2.0 } else { 1.0 };
        format!("{before},{},{torque}", factor * output.parse::<f64>().unwrap())
    };
    let rows = lines[1..].iter().enumerate().map(softer);
    bench.write("log.csv", [lines[0].to_owned()].into_iter().chain(rows).collect::<Vec<_>>().join("\n"));
    let answer = bench.run(IDENTIFY);
    assert_eq!(answer.code, Some(1), "{}", answer.output);
    let line = answer.error.trim();
    assert!(line.starts_with("new.toml: not written: it predicts the part held out to "), "{line}");
    assert!(line.contains("; what helps is a held log") && line.lines().count() == 1, "{line}");
    assert!(!bench.path("new.toml").exists());
    let answer = bench.run(&format!("{IDENTIFY} --force"));
    assert_eq!(answer.code, Some(1), "{}", answer.output);
    assert!(
        answer.error.starts_with("new.toml: warning: it predicts the part held out to"),
        "{}",
        answer.error
    );
    GearFile::read(&bench.path("new.toml")).unwrap();
}
