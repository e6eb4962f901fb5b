//! `pil --trajectory`: a motion of the user, a payload, and the time series of the run.

use std::fmt::Write as _;

use crate::bench::{Bench, lacks_emulator};

/// A move of 0.2 rad from 1.5 rad on in 0.2 s, rest to rest, as a planner writes it: every 5 ms, but for a clock that jitters.
fn motion(columns: &str) -> String {
    let mut text = format!("{columns}\n");
    for k in 0..=60 {
        let time = 0.005 * f64::from(k) + if k % 3 == 1 { 0.001 } else { 0.0 };
        let x = ((time - 0.03) / 0.2).clamp(0.0, 1.0);
        let angle = 1.5 + 0.2 * x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3));
        let _ = write!(text, "{},{angle}", 100.0 + time);
        let _ = if columns.ends_with("tau_load_nm") {
            writeln!(text, ",{}", 50.0 * time)
        } else {
            writeln!(text)
        };
    }
    text
}

fn figure(bench: &Bench, name: &str) -> f64 {
    let figures = bench.figures("out.json");
    let found = figures.iter().find(|figure| figure["name"] == format!("pil.trajectory.{name}"));
    found.unwrap_or_else(|| panic!("{name}"))["value"].as_f64().unwrap()
}

/// The columns of a series by name.
fn series(bench: &Bench) -> impl Fn(&str) -> Vec<f64> {
    let text = std::fs::read_to_string(bench.path("series.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    move |name| {
        let place =
            header.iter().position(|title| title == name).unwrap_or_else(|| panic!("{name}: {header:?}"));
        rows.iter().map(|row| row[place]).collect()
    }
}

#[test]
fn motions_that_cannot_be_followed_are_refused_before_anything_is_built() {
    let bench = Bench::new();
    let good = motion("t_s,theta_rad");
    let words = "pil --gear g.toml --trajectory my.csv --series series.csv --json out.json";
    for (text, expected) in [
        (String::new(), "empty file"),
        ("t_s,theta_rad\n0,0\n1,1\n".into(), "2 rows after the header; allowed: at least 3"),
        (
            good.replacen("theta_rad", "position", 1),
            "row 1, column \"position\": unknown; known columns are t_s, theta_rad, ",
        ),
        (
            good.replacen("100.021", "100.004", 1),
            "row 6, column t_s: time 100.004 does not come after 100.015, the row",
        ),
        (good.replacen("100.015,1.5", "100.015,x", 1), "row 5, column theta_rad: \"x\" is not a number"),
        (good.replacen("100.015,1.5", "100.015,nan", 1), "row 5, column theta_rad: \"nan\" is out of range"),
        (good.replacen("100.015,1.5", "100.015,", 1), "row 5, column theta_rad: no value (a gap)"),
        (
            "t_s,theta_rad\n0,0\n30,1\n61,1\n".into(),
            "row 4, column t_s: time 61 is 61 s from the start; allowed: at most 60",
        ),
        (
            "t_s,theta_rad\n0,0\n0.01,0\n0.02,0\n".into(),
            "row 4, column t_s: the motion ends after 0.02 s; allowed: at least",
        ),
        (
            "t_s,theta_rad,alpha_rad_s2\n0,0,0\n1,1,0\n2,0,0\n".into(),
            "row 1, column omega_rad_s: missing; a file with alpha_rad_s2 has it",
        ),
        (
            "t_s,theta_rad,omega_rad_s\n0,0,0\n1,1,-1\n2,2,-1\n3,3,-1\n".into(),
            "row 5, column omega_rad_s: -1 does not belong to theta_rad, which changes by 1.000000e0 a second up to this row",
        ),
        ("t_s,theta_rad\n0,0\n1,6\n2,12\n3,12\n".into(), "row 2, column theta_rad: needs "),
    ] {
        assert_ne!(text, good);
        bench.write("my.csv", &text);
        let line = bench.refused(words);
        assert!(line.starts_with(&format!("error: my.csv: {expected}")), "{line}\n{expected}");
    }
    let loaded = |load: f64| {
        let rows = good.lines().skip(1).map(|line| format!("{line},{load}\n"));
        format!("t_s,theta_rad,tau_load_nm\n{}", rows.collect::<String>())
    };
    bench.write("my.csv", loaded(-200.0));
    let line = bench.refused(words);
    assert!(
        line.starts_with("error: my.csv: row 2, column theta_rad: an acceleration of ")
            && line.contains(" under a load of -200.0000 N m needs ")
            && line.contains(" N m through the gear; allowed: at most gear.peak_torque_nm = "),
        "{line}"
    );
}

#[test]
fn options_of_a_trajectory_that_exclude_each_other_are_named() {
    let bench = Bench::new();
    bench.write("my.csv", motion("t_s,theta_rad"));
    let conflict =
        |other: &str| format!("error: the argument '--trajectory <MY.csv>' cannot be used with '{other}'");
    for (words, expected) in [
        ("--trajectory my.csv --scenario S2", conflict("--scenario <S1..S6|all>")),
        ("--trajectory my.csv --gear g.toml --replay log.csv", conflict("--replay <LOG.csv>")),
        (
            "--gear g.toml --replay log.csv --series s.csv",
            "error: the argument '--replay <LOG.csv>' cannot be used with '--series <SERIES.csv>'".into(),
        ),
        ("--scenario all --series s.csv", "error: --series with --scenario all: a series is of one run".into()),
        ("--scenario all --payload 1", "error: --payload with --scenario all: what is claimed is of".into()),
        ("--trajectory my.csv --series my.csv", "my.csv: --series and --trajectory are the same file".into()),
        ("--trajectory none.csv", "error: none.csv: cannot be read: No such file".into()),
        ("--trajectory my.csv --series none/s.csv", "error: none/s.csv: cannot be written: there is no folder".into()),
        ("--payload -1", "error: --payload -1 is out of range; allowed: a number from 0e0 to 1e5 kg m^2".into()),
        ("--payload nan", "error: --payload NaN is out of range".into()),
        ("--payload heavy", "error: invalid value 'heavy' for '--payload <KG_M2>'".into()),
        ("--payload-mass 5", "error: the following required arguments were not provided: --payload-lever <M>".into()),
        ("--payload-lever 5", "error: the following required arguments were not provided: --payload-mass <KG>".into()),
        (
            "--payload-mass 100 --payload-lever 1",
            "error: --payload-mass 100 --payload-lever 1: 980.6650 N m of weight; allowed: at most gear.peak_torque_nm".into(),
        ),
    ] {
        let line = bench.refused(&format!("pil {words}"));
        assert!(line.contains(&expected), "{line}\n{expected}");
    }
}

#[test]
fn a_users_motion_runs_with_a_payload_and_leaves_its_series() {
    if lacks_emulator() {
        return;
    }
    let bench = Bench::new();
    let run = |words: &str| {
        let answer = bench.run(&format!(
            "pil --gear g.toml --trajectory my.csv --series series.csv --json out.json {words}"
        ));
        assert!(answer.code.is_some_and(|code| code < 2) && answer.error.is_empty(), "{}", answer.error);
        answer.output
    };
    bench.write("my.csv", motion("t_s,theta_rad,tau_load_nm"));
    let output = run("");
    assert!(
        output.starts_with("trajectory: trajectory of the user; plots out/pil.trajectory.*.svg"),
        "{output}"
    );
    assert!(!output.contains("payload:") && !output.contains("to_b0_"), "{output}");
    assert_eq!(figure(&bench, "steps_unlike_host"), 0.0);
    assert_eq!(figure(&bench, "steps"), 3000.0);
    let alone = figure(&bench, "compensated.rms");
    assert!(alone < 0.5 * figure(&bench, "b0.rms"), "{output}");
    let column = series(&bench);
    let (time, asked) = (column("t_s"), column("theta_set_rad"));
    assert_eq!((time.len(), time[2999], asked[0]), (3000, 0.2999, 1.5));
    assert!((asked[2999] - 1.7).abs() < 1e-9 && (column("tau_load_nm")[2000] - 10.0).abs() < 1e-9);
    // The figures are those of the series, and estimates stand beside what they estimate.
    for controller in ["compensated", "b0", "b1", "b2"] {
        let (out, error) =
            (column(&format!("theta_out_{controller}_rad")), column(&format!("error_{controller}_rad")));
        let rms = (error.iter().map(|error| error * error).sum::<f64>() / 3000.0).sqrt();
        assert!((rms / figure(&bench, &format!("{controller}.rms")) - 1.0).abs() < 1e-9, "{controller}");
        assert!(out.iter().zip(&asked).zip(&error).all(|((out, asked), e)| (out - asked - e).abs() < 1e-12));
        assert!(column(&format!("tau_motor_{controller}_nm")).iter().any(|torque| torque.abs() > 0.1));
    }
    let off =
        |a: &str, b: &str| column(a).iter().zip(column(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off("theta_out_estimated_rad", "theta_out_compensated_rad") < 5e-4);
    assert!(off("tau_gear_estimated_nm", "tau_gear_compensated_nm") < 5.0);

    // Three times the inertia, and a weight that it does not know, are another joint.
    let output = run("--payload 1.2 --payload-mass 4 --payload-lever 0.5 --payload-hangs-at 1.5");
    assert!(
        output.contains("payload: 2.2000 kg m^2, weight up to 19.6133 N m, hanging at 1.5000 rad"),
        "{output}"
    );
    assert!(figure(&bench, "compensated.rms") > 1.5 * alone, "{output}");
    let torque = series(&bench)("tau_gear_compensated_nm");
    assert!(
        torque.iter().zip(column("tau_gear_compensated_nm")).any(|(now, before)| (now - before).abs() > 10.0)
    );
}
