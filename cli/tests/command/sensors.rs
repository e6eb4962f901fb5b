//! `sim --sensors`: readings of a file's sensors beside the true values.

use crate::bench::Bench;

const SENSORS: &str = include_str!("../../../examples/sensors/joint.toml");
const LINK: &str = include_str!("../../../examples/link/forearm.toml");
const GEAR: &str = include_str!("../../../gears/hd25-100.toml");
const BELT: &str = include_str!("../../../gears/belt/at5-16.toml");
const DRIVE: [&str; 4] = ["motor_encoder_rad", "output_encoder_rad", "torque_sensor_nm", "motor_current_a"];
const ON_LINK: [&str; 4] =
    ["output_encoder_rad", "torque_sensor_nm", "accelerometer_m_per_s2", "gauge_bridge_v"];

fn bench() -> Bench {
    let bench = Bench::new();
    for (name, text) in [("s.toml", SENSORS), ("l.toml", LINK), ("g.toml", GEAR), ("b.toml", BELT)] {
        bench.write(name, text);
    }
    let rows = |line: fn(f64) -> String| (0..=100).map(|k| line(f64::from(k) * 1e-3)).collect::<String>();
    let drive = rows(|t| format!("{t},{},{}\n", 3.0 * (20.0 * t).sin(), 10.0 * t));
    bench.write("g.csv", format!("t_s,theta_wg_rad,tau_load_nm\n{drive}"));
    bench.write("b.csv", format!("t_s,theta_motor_rad,tau_load_nm\n{drive}"));
    let joint = rows(|t| format!("{t},{}\n", 0.1 * (20.0 * t).sin()));
    bench.write("l.csv", format!("t_s,theta_joint_rad\n{joint}"));
    bench
}

fn sim(model: &str, letter: &str) -> String {
    let build = if letter == "l" { "" } else { " --build realtime" };
    format!(
        "sim --{model} {letter}.toml --input {letter}.csv --output out.csv --json out.json --sensors s.toml{build}"
    )
}

/// Header and rows of the output.
fn output(bench: &Bench) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(bench.path("out.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    (header.split(',').map(String::from).collect(), rows.lines().map(numbers).collect())
}

#[test]
fn readings_stand_behind_the_true_values_and_repeat() {
    let bench = bench();
    for (model, letter, columns) in [("gear", "g", DRIVE), ("belt", "b", DRIVE), ("link", "l", ON_LINK)] {
        let command = sim(model, letter);
        let answer = bench.run(&command);
        assert_eq!(answer.code, Some(0), "{}", answer.error);
        assert!(answer.output.contains("note: s.toml: ["), "{}", answer.output);
        let (header, rows) = output(&bench);
        assert_eq!(header[header.len() - 4..], columns);
        assert_eq!(rows.len(), 1001);
        let figures = bench.figures("out.json");
        let errors =
            figures.iter().filter(|figure| figure["name"].as_str().unwrap().starts_with("sim.sensor."));
        let errors: Vec<_> = errors.map(|figure| figure["value"].as_f64().unwrap()).collect();
        assert!(errors.len() == 4 && errors.iter().all(|error| *error > 0.0), "{errors:?}");
        bench.run(&command);
        assert_eq!(output(&bench).1, rows);
        // Without sensors the true values are the same.
        assert_eq!(bench.run(&command.replace(" --sensors s.toml", "")).code, Some(0));
        let (bare, truths) = output(&bench);
        assert_eq!(bare[..], header[..header.len() - 4]);
        assert!(truths.iter().zip(&rows).all(|(truth, row)| truth[..] == row[..truth.len()]));
    }
}

#[test]
fn ideal_sensors_read_the_true_values() {
    let bench = bench();
    bench.write(
        "s.toml",
        "[sensor_set]\nname = \"ideal\"\n[output_encoder]\nbits = 32\n[torque_sensor]\n[motor_current]\ntorque_constant_nm_per_a = 0.5\n",
    );
    assert_eq!(bench.run(&sim("gear", "g")).code, Some(0));
    for row in output(&bench).1 {
        let [theta, _, motor_torque, _, transmitted] = row[1..6] else { panic!("{row:?}") };
        // The phase of an angle is truncated to 32 bits itself: half a count, and one.
        assert!((row[6] - theta).abs() < 2.5e-9);
        assert_eq!([row[7], row[8]], [transmitted, motor_torque / 0.5]);
    }
}

#[test]
fn what_cannot_be_measured_is_refused_by_one_line() {
    let bench = bench();
    bench.write("s.toml", SENSORS.replacen("at_m = 0.05", "at_m = 0.7", 1));
    assert_eq!(
        bench.refused(&sim("link", "l")),
        "error: s.toml: gauge_bridge.at_m = 0.7 is out of range; allowed: at most 0.5 m, the length of the link"
    );
    bench.write("s.toml", SENSORS.replacen("bits = 17", "bits = 3", 1));
    assert_eq!(
        bench.refused(&sim("gear", "g")),
        "error: s.toml: motor_encoder.bits = 3 is out of range; allowed: a whole number from 4 to 32"
    );
    bench.write("s.toml", "[sensor_set]\nname = \"tip\"\n[accelerometer]\nbias_m_per_s2 = 0.1\n");
    assert_eq!(
        bench.refused(&sim("gear", "g")),
        "error: s.toml: none of its sensors, [accelerometer], is on this model"
    );
    let line = bench.refused(&sim("gear", "g").replace("s.toml", "none.toml"));
    assert!(line.starts_with("error: none.toml: "), "{line}");
    let line = bench.refused(&sim("gear", "g").replace("s.toml", "g.toml"));
    assert!(line.contains("are the same file"), "{line}");
}

#[test]
fn check_tells_everything_that_is_wrong() {
    let bench = bench();
    let answer = bench.run("check s.toml");
    assert_eq!(answer.code, Some(0));
    assert!(
        answer.output.starts_with("s.toml: ok, sensors: motor_encoder, output_encoder, "),
        "{}",
        answer.output
    );
    let wrong =
        SENSORS.replacen("bits = 17", "bits = 3", 1).replacen("excitation_v = 5.0", "excitation_v = 0", 1);
    bench.write("s.toml", wrong);
    let answer = bench.run("check s.toml");
    assert_eq!((answer.code, answer.error.lines().count()), (Some(2), 2), "{}", answer.error);
}
