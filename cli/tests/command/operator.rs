//! `identify --operator` through the real command: an operator from logs of u and y, and what is refused.

use std::fmt::Write as _;

use strainwave_desktop::identify::Operator;
use strainwave_desktop::identify::operator::Grid;

use crate::bench::Bench;

const IDENTIFY: &str = "identify --operator log.csv --output op.toml --plot loops.svg --json out.json";
/// One grid, so that it takes a second.
const QUICK: &str = "--levels 6 --smoothing 1e-8";

/// An asymmetric operator that is none of the grid's, along a ring-down and back.
fn log(turns: &[f64]) -> String {
    let grid = Grid { low: -3.0, high: 6.0, levels: 13 };
    let weights = grid.cells().map(|(i, j)| 1e-3 * (1 + i * j) as f64).collect();
    let operator = Operator::build(grid, 40.0, 0.2, weights).unwrap();
    let leg = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        (0..40).map(move |k| from + (to - from) * f64::from(k) / 40.0)
    };
    let input: Vec<f64> = turns.windows(2).flat_map(leg).chain(turns.last().copied()).collect();
    let mut text = String::from("t_s,u,y\n");
    for (k, (u, point)) in input.iter().zip(operator.points(&input)).enumerate() {
        let _ = writeln!(text, "{k},{u},{}", point.output);
    }
    text
}

fn ring_down() -> String {
    log(&[1.0, 5.0, -2.0, 4.0, -1.5, 3.0, -0.5, 2.0, 0.5, 1.0, -2.0, 5.0, 0.0, 3.0])
}

#[test]
fn an_operator_is_identified_written_drawn_and_read_back() {
    let bench = Bench::new();
    bench.write("log.csv", ring_down());
    bench.write("nested.csv", log(&[5.0, -2.0, 4.5, 0.0, 2.0, 1.0, 3.0]));
    let answer = bench.run(&format!("{IDENTIFY} {QUICK} --predict nested.csv --training 0.8"));
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.starts_with("weights on 6 levels over inputs from -2 to 5"), "{}", answer.output);
    assert!(answer.output.contains("the output lags its input"), "{}", answer.output);
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(bench.path("out.json")).unwrap()).unwrap();
    let figure = |name: &str| {
        let figures = json["figures"].as_array().unwrap();
        figures.iter().find(|figure| figure["name"] == name).unwrap()["value"].as_f64().unwrap()
    };
    let held_out = figure("identify.operator.held_out.rms");
    assert!(held_out < 0.04 && held_out < 0.3 * figure("identify.operator.held_out.line.rms"), "{held_out}");
    let svg = std::fs::read_to_string(bench.path("loops.svg")).unwrap();
    assert!(svg.contains("identified - measured [% of span]") && svg.contains("held out"));
    let operator = Operator::read(&bench.path("op.toml")).unwrap();
    assert!(operator.grid().levels == 6 && operator.weights().iter().all(|weight| *weight >= 0.0));
}

#[test]
fn what_shows_no_operator_is_refused_by_file_row_and_column() {
    let bench = Bench::new();
    let log = ring_down();
    let lines: Vec<&str> = log.lines().collect();
    let rows = |y: &dyn Fn(u32) -> String| {
        let rows = (0..60).map(|k| format!("{k},{}\n", y(k)));
        format!("u,y\n{}", rows.collect::<String>())
    };
    for (text, expected) in [
        (lines[..11].join("\n"), "log.csv: 10 rows after the header; allowed: at least 20"),
        (
            log.replace("t_s,u,y", "t_s,u,z"),
            "log.csv: row 1, column \"z\": unknown; known columns are u, y, t_s",
        ),
        (log.replace("\n7,", "\n7,x"), "log.csv: row 9, column u: \"x"),
        (log.replace("\n7,", "\n7,nan"), "log.csv: row 9, column u: \"nan"),
        (log.replace("\n7,", "\n6,"), "log.csv: row 9, column t_s: time 6 does not come after 6"),
        ("u,z\n1,2\n".into(), "log.csv: row 1, column \"z\": unknown"),
        ("u\n1\n".into(), "log.csv: row 1, column y: missing"),
        (rows(&|k| k.to_string()), "log.csv: the input u never reverses by 0.01 of its span"),
        (
            rows(&|_| "1".into()).replace("u,y", "y,u"),
            "log.csv: the input u never reverses by 0.01 of its span 0",
        ),
        (
            log.lines()
                .map(|line| line.rsplit_once(',').unwrap().0)
                .map(|line| format!("{line},1\n"))
                .collect::<String>()
                .replacen("t_s,u,1", "t_s,u,y", 1),
            "log.csv: the output y is the same in every row that trains",
        ),
    ] {
        bench.write("log.csv", text);
        let line = bench.refused(IDENTIFY);
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
    assert!(!bench.path("op.toml").exists());
}

#[test]
fn options_of_the_gear_and_of_the_operator_are_told_apart() {
    let bench = Bench::new();
    bench.write("log.csv", ring_down());
    for (words, expected) in [
        (format!("{IDENTIFY} --levels 65"), "--levels 65 is out of range; allowed: 2 to 64"),
        (format!("{IDENTIFY} --gear g.toml"), "--gear with --operator; allowed: one of the two"),
        (format!("{IDENTIFY} --moving"), "the argument '--operator' cannot be used with"),
        (
            "identify log.csv --gear g.toml --output new.toml --signed".into(),
            "the following required arguments",
        ),
        (format!("{IDENTIFY} --predict none.csv"), "none.csv: cannot be read"),
    ] {
        let line = bench.refused(&words);
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
}

/// The hysteresis of the first half is gone in the second.
#[test]
fn an_operator_that_predicts_worse_than_a_line_is_not_written_unless_forced() {
    let bench = Bench::new();
    let row = |k: u32| {
        let phase = 0.1 * f64::from(k);
        let lag = if k < 200 { 0.8 * phase.cos() } else { 0.0 };
        format!("{},{}\n", phase.sin(), phase.sin() - lag)
    };
    bench.write("log.csv", format!("u,y\n{}", (0..400).map(row).collect::<String>()));
    let words = format!("{IDENTIFY} --levels 8 --smoothing 1e-12");
    let answer = bench.run(&words);
    assert_eq!(answer.code, Some(1), "{}", answer.output);
    assert!(answer.error.starts_with("op.toml: not written: it predicts to "), "{}", answer.error);
    assert!(!bench.path("op.toml").exists());
    let answer = bench.run(&format!("{words} --force"));
    assert!(answer.code == Some(1) && answer.error.starts_with("op.toml: warning: "), "{}", answer.error);
    assert!(Operator::read(&bench.path("op.toml")).is_ok());
}
