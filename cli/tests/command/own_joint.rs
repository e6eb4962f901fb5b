//! The path of a user's own joint through the real command: from catalogue data to firmware's source.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::process::Stdio;

use strainwave_desktop::GearFile;

use crate::bench::Bench;

/// Intervals of the motion and of the log (s).
const INTERVAL: [f64; 2] = [0.001, 0.004];

/// Motor angle (rad) and load (N m) over time, for `duration` (s).
fn experiment(duration: f64, inputs: impl Fn(f64) -> [f64; 2]) -> String {
    let mut text = String::from("t_s,theta_wg_rad,tau_load_nm\n");
    for k in 0..=(duration / INTERVAL[0]) as usize {
        let time = k as f64 * INTERVAL[0];
        let [motor, load] = inputs(time);
        let _ = writeln!(text, "{time},{motor},{load}");
    }
    text
}

/// A motor that swings, from rest to rest.
fn moving(duration: f64, revolutions: f64, cycles: f64) -> String {
    experiment(duration, |time| {
        let u = ((time - 0.25) / (duration - 0.5)).clamp(0.0, 1.0);
        [revolutions * TAU * (PI * u).sin().powi(2) * (TAU * cycles * u).sin(), 0.0]
    })
}

/// A held motor and loops of the load, of these amplitudes (N m), 1.5 s each.
fn held(amplitudes: &[f64]) -> String {
    experiment(1.5 * amplitudes.len() as f64 - INTERVAL[0], |time| {
        [0.0, amplitudes[(time / 1.5) as usize] * (TAU * time / 1.5).sin()]
    })
}

/// What the sensors of the joint of `truth.toml` log in an experiment, by the reference build; the output torque only of a held
/// one, as a joint's without a torque sensor.
fn log(bench: &Bench, experiment: &str, output_torque: bool) -> String {
    bench.write("experiment.csv", experiment);
    let answer = bench.run("sim --gear truth.toml --input experiment.csv --output plant.csv --mesh 8x3");
    assert_eq!(answer.code, Some(0), "{}", answer.error);
    let plant = std::fs::read_to_string(bench.path("plant.csv")).unwrap();
    let every = |interval: f64| (INTERVAL[1] / interval).round() as usize;
    let mut log = String::from("t_s,theta_motor_rad,tau_motor_nm,theta_out_rad");
    log.push_str(if output_torque { ",tau_out_nm\n" } else { "\n" });
    let inputs = experiment.lines().skip(1).step_by(every(INTERVAL[0]));
    for (row, input) in plant.lines().skip(1).step_by(every(1e-4)).zip(inputs) {
        let (row, input): (Vec<_>, Vec<_>) = (row.split(',').collect(), input.split(',').collect());
        let _ = write!(log, "{},{},{},{}", input[0], input[1], row[3], row[1]);
        let _ = if output_torque { writeln!(log, ",{}", row[5]) } else { writeln!(log) };
    }
    log
}

/// Another joint than its gear file says: softer by a tenth, twice the hysteresis, half as much friction again.
fn truth(said: &GearFile) -> GearFile {
    let mut gear = said.clone();
    let stiffness = &mut gear.stiffness;
    for value in [&mut stiffness.k1, &mut stiffness.k2, &mut stiffness.k3] {
        *value *= 0.9;
    }
    gear.hysteresis.width_arcmin *= 2.0;
    let input = &mut gear.friction.input;
    for level in [&mut input.coulomb, &mut input.static_level] {
        *level = level.map(|level| 1.5 * level);
    }
    gear
}

fn value(bench: &Bench, name: &str) -> f64 {
    let figures = bench.figures("out.json");
    let figure = figures.iter().find(|figure| figure["name"] == name);
    figure.unwrap_or_else(|| panic!("{name}"))["value"].as_f64().unwrap()
}

#[test]
fn a_joint_goes_from_the_catalogue_to_firmware() {
    let bench = Bench::new();
    // Whether a figure misses its bound is not the question here.
    let run = |words: &str| {
        let answer = bench.run(words);
        assert!(answer.code.is_some_and(|code| code < 2), "{words}: {}{}", answer.output, answer.error);
        answer.output
    };
    run("new --size 25 --ratio 100 --load 0.8 --output said.toml");
    assert_eq!(run("check said.toml"), "said.toml: ok\n");
    truth(&GearFile::read(&bench.path("said.toml")).unwrap()).write(&bench.path("truth.toml")).unwrap();
    bench.write("held.csv", log(&bench, &held(&[80.0, 40.0, 60.0, 80.0]), true));
    bench.write("other-held.csv", log(&bench, &held(&[70.0, 30.0]), true));
    bench.write("moving.csv", log(&bench, &moving(6.0, 5.0, 2.5), false));
    // Cut in its motion.
    let other = log(&bench, &moving(4.0, -4.0, 1.5), false);
    let lines: Vec<_> = other.lines().collect();
    bench.write("before.csv", lines[..=400].join("\n"));
    bench.write("after.csv", [&lines[..1], &lines[401..]].concat().join("\n"));

    // The torque loop of the held joint is learnt, and another one predicted.
    run("identify held.csv --gear said.toml --output held.toml --json out.json");
    let torsion = |gear: &str| {
        run(&format!("predict other-held.csv --gear {gear} --output predicted.csv --json out.json"));
        value(&bench, "predict.torsion.shape.rms")
    };
    let [said, learnt] = ["said.toml", "held.toml"].map(torsion);
    assert!(learnt < 0.3 * said, "{learnt} of {said} rad");

    // Friction of the moving joint is learnt.
    run("identify moving.csv --moving --gear held.toml --output identified.toml --json out.json");
    let friction = value(&bench, "identify.friction_factor");
    assert!((friction - 1.5).abs() < 0.1, "{friction}");

    // A gear file that is right predicts the reference plant's torque, a rigid joint does not; the more so from what was before.
    let errors = |start: &str| {
        let table = run(&format!(
            "predict after.csv --gear truth.toml --output predicted.csv --start {start} --json out.json --plot out.svg"
        ));
        assert!(table.starts_with("error") && table.contains("motor_torque of a rigid joint"), "{table}");
        ["motor_torque.rms", "motor_torque.rigid.rms", "output.rms", "output.rigid.rms"]
            .map(|name| value(&bench, &format!("predict.{name}")))
    };
    let (first, warm) = (errors("first"), errors("before.csv"));
    assert!(first[0] < 0.5 * first[1] && first[2] < first[3], "{first:?}");
    assert!(warm[0] < 0.1 * warm[1] && warm[0] < 0.5 * first[0] && warm[2] < warm[3], "{warm:?} {first:?}");
    let predicted = std::fs::read_to_string(bench.path("predicted.csv")).unwrap();
    let header = "t_s,theta_motor_rad,theta_out_rad,theta_out_predicted_rad,theta_out_rigid_rad,tau_motor_nm,\
                  tau_motor_predicted_nm,tau_motor_rigid_nm";
    assert_eq!((predicted.lines().next(), predicted.lines().count()), (Some(header), lines.len() - 400));

    run("export identified.toml --rust joint.rs");
    let source = std::fs::read_to_string(bench.path("joint.rs")).unwrap();
    assert!(source.contains("pub static WORDS: [u32; "), "{source}");
}

#[test]
fn everything_wrong_with_a_file_is_told_at_once() {
    let bench = Bench::new();
    let text = String::from_utf8(bench.files()[&bench.path("g.toml")].clone()).unwrap();
    let wrong = text
        .replace("ratio = 100", "ratoi = 100")
        .replace("k2_nm_per_rad = 5.0e4", "k2_nm_per_rad = 2e4")
        .replace("width_arcmin = 1.0", "width_arcmin = \"1\"")
        .replace("peak_torque_nm = 2.4", "peak_torque_nm = 1e-320")
        .replace("rotor_inertia = 0.1", "rotor_inertia = 1e40")
        .replace("flexspline_kg_m2 = 1.2", "flexspline_kg_m2 = 1e-3");
    bench.write("wrong.toml", wrong);
    let answer = bench.run("check wrong.toml");
    assert_eq!((answer.code, answer.output.as_str()), (Some(2), ""));
    let expected = [
        "unknown key gear.ratoi = 100; the nearest known key is gear.ratio (a whole number from 30 to 320)",
        "missing key gear.ratio; allowed: a whole number from 30 to 320",
        "hysteresis.width_arcmin = \"1\" is text; allowed: a number from 0 to 60 arcmin",
        "motor.peak_torque_nm = 1e-320 is out of range; allowed: a number above 0 to 10000 N m, its magnitude",
        "tolerances.rotor_inertia = 1e40 is out of range; allowed: a number from 0 to 0.5",
        "stiffness.k2_nm_per_rad = 20000 is out of range; allowed: at least stiffness.k1_nm_per_rad = 31000",
    ];
    let lines: Vec<_> = answer.error.lines().collect();
    assert_eq!(lines.len(), expected.len(), "{}", answer.error);
    for (line, expected) in lines.iter().zip(expected) {
        assert!(line.starts_with(&format!("error: wrong.toml: {expected}")), "{line}\n{expected}");
    }
    let line = bench.refused("sim --gear wrong.toml --input in.csv --output out.csv");
    assert!(line.ends_with("; and 5 more: strainwave check wrong.toml"), "{line}");
    bench.write("wrong.toml", "name = \n[gear]\nratio == 100\n[motor\n");
    let answer = bench.run("check wrong.toml");
    let at: Vec<_> = answer.error.lines().filter_map(|line| line.split(": not TOML").next()).collect();
    assert_eq!(at, [1, 3, 4].map(|line| format!("error: wrong.toml: line {line}")), "{}", answer.error);
    // Of a section that is right by itself conditions are checked, too.
    bench.write(
        "wrong.toml",
        text.replace("t2_nm = 48.0", "t2_nm = 1")
            .replace("delay_periods = 2", "delay_periods = 2\ncurrent_loop_slow_hz = 3")
            .replace("viscous_nm_s_per_rad = 1.2e-4", "viscous_nm_s_per_rad = 600.0"),
    );
    let answer = bench.run("check wrong.toml");
    assert!(
        answer.error.contains("friction.input.viscous_nm_s_per_rad = 600")
            && answer.error.lines().count() == 3,
        "{}",
        answer.error
    );
}

#[test]
fn a_parameter_that_stands_in_no_file_is_traced_to_its_key() {
    let bench = Bench::new();
    let text = String::from_utf8(bench.files()[&bench.path("g.toml")].clone()).unwrap();
    bench.write("g.toml", text.replace("k1_nm_per_rad = 3.1e4", "k1_nm_per_rad = 3.0"));
    for words in ["check g.toml", "design g.toml", "pil --gear g.toml --scenario S3"] {
        let line = bench.refused(words);
        assert!(
            line.starts_with("error: g.toml: stiffness.k1_nm_per_rad = 3.0 is out of range; allowed, with"),
            "{line}"
        );
    }
}

#[test]
fn sizes_ratios_and_loads_out_of_range_are_named() {
    let bench = Bench::new();
    for (words, expected) in [
        ("--size 7 --ratio 100", "invalid value '7' for '--size <SIZE>': 7 is not in 8..=100"),
        ("--size 25 --ratio 161", "invalid value '161' for '--ratio <N>': 161 is not in 30..=160"),
        (
            "--size 25 --ratio 100 --load 0.001",
            "--load 0.001 is out of range; allowed: above 4*dt^2*K3 = 2.280e-3 kg m^2",
        ),
        (
            "--size 25 --ratio 100 --load nan",
            "--load NaN is out of range; allowed: a number from 1e-6 to 1e5 kg m^2",
        ),
        (
            "--size 8 --ratio 30 --load 1e4",
            "--load 10000: inertia.flexspline_kg_m2 = 10000.0 is out of range; allowed",
        ),
    ] {
        let line = bench.refused(&format!("new {words} --output new.toml"));
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
}

#[test]
fn values_that_were_put_into_a_file_are_not_lost() {
    let bench = Bench::new();
    let written = || std::fs::read_to_string(bench.path("mine.toml")).unwrap();
    let words = "new --size 25 --ratio 100 --output mine.toml";
    bench.write("mine.toml", "mine");
    let line = bench.refused(words);
    assert_eq!(line, "error: mine.toml: is there already, with other values; --force replaces it");
    assert_eq!(written(), "mine");
    assert_eq!(bench.run(&format!("{words} --force")).code, Some(0));
    assert!(written().contains("[gear]"));
    assert_eq!(bench.run(words).code, Some(0), "the same values again");
}

/// What one command writes to its standard output the next one reads.
#[test]
fn a_stroke_stands_for_the_standard_streams() {
    let bench = Bench::new();
    let new = bench.run("new --size 20 --ratio 160 --output -");
    assert!(new.code == Some(0) && new.error.starts_with("name"), "{}", new.error);
    bench.write("new.toml", &new.output);
    assert!(GearFile::read(&bench.path("new.toml")).is_ok());
    let mut command = bench.command("sim --gear new.toml --input - --output - --build realtime");
    command.stdin(Stdio::from(std::fs::File::open(bench.path("in.csv")).unwrap()));
    let sim = Bench::answer(&mut command);
    assert!(
        sim.code == Some(0) && sim.output.starts_with("t_s,theta_fs_rad") && sim.error.contains("sim.rows"),
        "{}",
        sim.error
    );
    assert_eq!(sim.output.lines().count(), 22);
}

#[test]
fn logs_that_show_no_joint_are_refused_and_limits_are_told() {
    let bench = Bench::new();
    let row = |k: i32| {
        let time = 0.004 * f64::from(k);
        let angle = 9.0 * (3.0 * time).sin();
        format!("{time},{angle},{},{}", 0.3 * (3.0 * time + 0.2).cos(), -angle / 100.0)
    };
    let log = |rows: &dyn Fn(i32) -> String| {
        let rows: Vec<_> = (0..500).map(rows).collect();
        format!("t_s,theta_motor_rad,tau_motor_nm,theta_out_rad\n{}\n", rows.join("\n"))
    };
    let good = log(&row);
    let words = "predict log.csv --gear g.toml --output out.csv --json out.json";
    for (text, expected) in [
        (good.lines().take(11).collect::<Vec<_>>().join("\n"), "10 rows; allowed: at least 20"),
        (good.replacen("t_s", "time", 1), "row 1, column \"time\": unknown; known columns are t_s, "),
        (good.replace(',', ";"), "row 1, columns are separated by `;`; allowed: commas"),
        (
            log(&|k| if k < 200 { row(k) } else { row(k).replacen(',', ",1", 1).replacen(",1-", ",-1", 1) }),
            "row 202, column theta_motor_rad: jumps by ",
        ),
    ] {
        bench.write("log.csv", text);
        let line = bench.refused(words);
        assert!(line.starts_with(&format!("error: log.csv: {expected}")), "{line}\n{expected}");
    }
    bench.write(
        "log.csv",
        good.replace("tau_motor_nm", "tau_motor_nm,temperature").replace(',', ",0,").replacen(",0,", ",", 4),
    );
    assert!(bench.refused(words).ends_with("--ignore-extra reads the file without it"));
    let one_way = good.lines().take(120).collect::<Vec<_>>().join("\n");
    bench.write("log.csv", one_way.replace("theta_out_rad", "temperature"));
    let answer = bench.run(&format!("{words} --ignore-extra"));
    assert!(answer.code.is_some_and(|code| code < 2), "{}", answer.error);
    let notes: Vec<_> = answer.error.lines().collect();
    assert_eq!(notes.len(), 2, "{}", answer.error);
    assert_eq!(notes[0], "log.csv: ignored: temperature");
    assert!(
        notes[1].starts_with("log.csv: warning: column theta_motor_rad: moves in one direction only"),
        "{}",
        notes[1]
    );
}
