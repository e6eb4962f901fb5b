//! `sim --link`: an arm link from its file.

use crate::bench::Bench;

const LINK: &str = include_str!("../../../examples/link/forearm.toml");
const INPUT: &str = include_str!("../../../examples/link/in.csv");
const SIM: &str = "sim --link l.toml --input in.csv --output out.csv --json out.json";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("l.toml", LINK);
    bench.write("in.csv", INPUT);
    bench
}

/// Header and rows of the output.
fn output(bench: &Bench) -> (String, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(bench.path("out.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    (header.to_owned(), rows.lines().map(numbers).collect())
}

#[test]
fn the_example_swings_and_settles() {
    let bench = bench();
    let answer = bench.run(SIM);
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
    let (header, rows) = output(&bench);
    assert_eq!(
        header,
        "t_s,tip_deflection_m,tip_x_m,tip_y_m,tau_joint_nm,strain_at_0_m,strain_at_0.25_m,voltage_v,couple_nm,charge_c"
    );
    assert_eq!((rows.len(), rows[20_000][0]), (20_001, 2.0));
    // Level at first: beam and payload pull down, the upper face is longer.
    let (beam, payload, g, l, ei) = (0.432, 0.15, 9.81, 0.5_f64, 14.9);
    let sag = -g * (beam * l.powi(4) / 8.0 + payload * l.powi(3) / 3.0) / ei;
    let torque = g * (0.5 * beam * l * l + payload * l);
    assert!(
        (rows[0][1] / sag - 1.0).abs() < 1e-9 && (rows[0][4] / torque - 1.0).abs() < 1e-9,
        "{:?}",
        rows[0]
    );
    assert!((rows[0][5] / (0.002 * torque / ei) - 1.0).abs() < 1e-9);
    // At rest until the joint moves.
    let moved = rows[999].iter().zip(&rows[0]).skip(1).map(|(now, first)| (now - first).abs());
    assert!(moved.fold(0.0, f64::max) < 1e-9, "{:?}", rows[999]);
    // The patch ends without voltage, but not without couple: hysteresis.
    let last = &rows[20_000];
    assert!(last[7].abs() < 1e-9 && last[8] > 1e-3, "{last:?}");
    let figures = bench.figures("out.json");
    let value = |name: &str| {
        figures
            .iter()
            .find(|figure| figure["name"] == name)
            .and_then(|figure| figure["value"].as_f64())
            .unwrap()
    };
    assert_eq!(value("sim.link.rows"), 20_001.0);
    assert!((5.0..15.0).contains(&value("sim.link.mode_1.frequency")));
    let most = rows.iter().fold(0.0_f64, |most, row| most.max(row[1].abs()));
    assert_eq!(value("sim.link.tip_deflection.max"), most);
}

#[test]
fn without_patch_and_gauges_the_columns_are_fewer() {
    let bench = bench();
    let (head, _) = LINK.split_once("# A plate of soft PZT").unwrap();
    bench.write("l.toml", head.replacen("gauges_m", "# gauges_m", 1));
    bench.write("in.csv", "t_s,theta_joint_rad\n0,0\n0.1,0.001\n0.2,0\n");
    assert_eq!(bench.run(SIM).code, Some(0));
    assert_eq!(output(&bench).0, "t_s,tip_deflection_m,tip_x_m,tip_y_m,tau_joint_nm");
}

#[test]
fn a_payload_beyond_its_rating_is_warned_of() {
    let bench = bench();
    bench.write("l.toml", LINK.replacen("payload_kg = 0.15", "payload_kg = 0.3", 1));
    let answer = bench.run(SIM);
    let warning = "warning: l.toml: link.payload_kg = 0.3 is more than link.rated_payload_kg = 0.25\n";
    assert!(answer.code == Some(0) && answer.output.starts_with(warning), "{}", answer.output);
}

#[test]
fn what_cannot_run_is_refused_by_one_line() {
    let bench = bench();
    let line = bench.refused(&SIM.replace("l.toml", "g.toml"));
    assert!(line.starts_with("error: g.toml: unknown key "), "{line}");
    let stiff = LINK.replacen("= 14.9", "= 1490.0", 1).replacen("0.004, 0.005", "0.004", 1);
    bench.write("l.toml", stiff.replacen("modes = 2", "modes = 8", 1));
    let line = bench.refused(SIM);
    assert!(line.starts_with("error: l.toml: link.modes = 8 is out of range; allowed: at most "), "{line}");
    bench.write("l.toml", LINK.split_once("# A plate").unwrap().0);
    let line = bench.refused(SIM);
    assert_eq!(line, "error: in.csv: row 1, column voltage_v: the link file has no [piezo] to apply it to");
    let line = bench.refused("sim --input in.csv --output out.csv");
    assert!(line.contains("--gear <G.toml>"), "{line}");
    let line = bench.refused("sim --link l.toml --gear g.toml --input in.csv --output out.csv");
    assert!(line.contains("cannot be used with"), "{line}");
    let line = bench.refused("sim --link l.toml --build realtime --input in.csv --output out.csv");
    assert!(line.contains("cannot be used with"), "{line}");
}

#[test]
fn check_tells_everything_that_is_wrong() {
    let bench = bench();
    let answer = bench.run("check l.toml");
    assert_eq!((answer.code, answer.output.as_str()), (Some(0), "l.toml: ok\n"));
    bench.write("l.toml", LINK.replacen("payload_kg = 0.15", "payload_kg = 0.3", 1));
    let odd = "l.toml: ok; link.payload_kg = 0.3 is more than link.rated_payload_kg = 0.25\n";
    assert_eq!(bench.run("check l.toml").output, odd);
    let thick = LINK.replacen("[link]", "[link]\nwide = 1", 1);
    bench.write("l.toml", thick.replacen("charge_constant_m_per_v = ", "charge_constant_m_per_v = 0 # ", 1));
    let answer = bench.run("check l.toml");
    let lines: Vec<_> = answer.error.lines().collect();
    assert_eq!((answer.code, lines.len()), (Some(2), 2), "{}", answer.error);
    assert!(lines[0].starts_with("error: l.toml: unknown key link.wide = 1; "), "{}", lines[0]);
    assert_eq!(
        lines[1],
        "error: l.toml: piezo.charge_constant_m_per_v = 0 is out of range; allowed: not 0; below 0 for PZT"
    );
}
