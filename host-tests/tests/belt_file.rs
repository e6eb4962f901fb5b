//! The belt file: what is accepted, and how each kind of mistake is refused; its run open loop.

use std::collections::BTreeSet;
use std::path::Path;

use strainwave_desktop::BeltFile;
use strainwave_desktop::io::belt_file::{EXAMPLE, KEYS};
use strainwave_desktop::io::log::{BeltRow, OpenLoop};
use strainwave_desktop::plant::belt::{BeltBuild, require_real_time, run};
use toml::{Table, Value};

fn parse(text: &str) -> Result<BeltFile, String> {
    BeltFile::parse(Path::new("b.toml"), text.as_bytes()).map_err(|error| error.to_string())
}

/// The message for the example with `from` replaced by `to`.
fn refusal(from: &str, to: &str) -> String {
    assert!(EXAMPLE.contains(from), "{from} is not in the example");
    parse(&EXAMPLE.replacen(from, to, 1)).expect_err("must be refused")
}

#[test]
fn the_example_is_read_and_written_back_unchanged() {
    let belt = BeltFile::example();
    assert_eq!(parse(&belt.to_toml()).unwrap(), belt);
    assert_eq!(require_real_time(&belt), Ok(()));
}

/// Paths of the numbers of a table, lists as `[]`.
fn paths(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Table(table) => {
            let dot = if path.is_empty() { "" } else { "." };
            table.iter().for_each(|(name, inner)| paths(inner, &format!("{path}{dot}{name}"), found));
        }
        Value::Array(items) => items.iter().for_each(|item| paths(item, &format!("{path}[]"), found)),
        _ => {
            found.insert(path.to_owned());
        }
    }
}

#[test]
fn every_key_of_the_example_is_in_the_table_and_every_required_one_in_the_example() {
    let mut written = BTreeSet::new();
    paths(&Value::Table(EXAMPLE.parse::<Table>().unwrap()), "", &mut written);
    let listed: BTreeSet<_> = KEYS.iter().map(|key| key.path.to_owned()).collect();
    assert_eq!(listed.len(), KEYS.len(), "a key is listed twice");
    assert!(written.is_subset(&listed), "{:?}", written.difference(&listed));
    for key in KEYS.iter().filter(|key| !key.optional && !key.path.contains("state_space")) {
        assert!(written.contains(key.path), "{} is not in the example", key.path);
    }
}

#[test]
fn every_required_key_is_missed_by_its_name() {
    for key in KEYS.iter().filter(|key| !key.optional && !key.path.contains("[]")) {
        let mut table: Table = EXAMPLE.parse().unwrap();
        let (section, name) = key.path.rsplit_once('.').unwrap();
        let inner = section.split('.').fold(&mut table, |table, part| table[part].as_table_mut().unwrap());
        inner.remove(name).unwrap();
        let line = parse(&table.to_string()).unwrap_err();
        assert!(
            line.starts_with(&format!("b.toml: missing key {}; allowed: {}", key.path, key.allowed)),
            "{line}"
        );
    }
}

#[test]
fn what_is_wrong_is_named_with_value_and_range() {
    for (from, to, line) in [
        (
            "pretension_n = 350.0",
            "pretension_n = -350.0",
            "b.toml: belt.pretension_n = -350.0 is out of range; allowed: a number from 0 to 1e6 N",
        ),
        (
            "teeth = 20",
            "teeth = 0",
            "b.toml: motor_pulley.teeth = 0 is out of range; allowed: a whole number from 1 to 2000",
        ),
        (
            "teeth = 20",
            "teeth = 1",
            "b.toml: motor_pulley.teeth = 1 is out of range: no tooth engaged, the belt lies on 0.45 teeth; allowed: at least 1 \
             tooth in mesh",
        ),
        (
            "teeth = 150",
            "teeth = 60",
            "b.toml: belt.teeth = 60 is out of range; allowed: at least 69, to go around pulleys of 20 and 60 teeth",
        ),
        (
            "stiffness_n = 2.8e5",
            "stiffnes_n = 2.8e5",
            "b.toml: unknown key belt.stiffnes_n = 280000.0; the nearest known key is belt.stiffness_n (a number from 100 to 1e9 N)",
        ),
        (
            "output_mode_ratio = 0.03",
            "output_mode_ratio = 1.0",
            "b.toml: damping.output_mode_ratio = 1.0 is out of range; allowed: a number from 0 below 1",
        ),
        (
            "static_nm = 0.028",
            "static_nm = 0.01",
            "b.toml: friction.motor.static_nm = 0.01 is out of range; allowed: at least friction.motor.coulomb_nm = 0.02",
        ),
        (
            "viscous_nm_s_per_rad = 2.0e-3",
            "viscous_nm_s_per_rad = 1e4",
            "b.toml: friction.output.viscous_nm_s_per_rad = 10000 is out of range; allowed: below J/dt = 5.000e2 N m s/rad",
        ),
    ] {
        let found = refusal(from, to);
        assert!(found.starts_with(line), "{found}");
    }
}

#[test]
fn an_output_too_light_for_the_real_time_build_is_named() {
    let light = EXAMPLE.replacen("inertia_kg_m2 = 0.05", "inertia_kg_m2 = 1e-6", 1);
    let text = light.replacen("stiffness_n = 2.8e5", "stiffness_n = 2.8e7", 1);
    let line = require_real_time(&parse(&text).unwrap()).unwrap_err();
    assert!(line.starts_with("output_pulley.inertia_kg_m2 = 1e-6 is too light"), "{line}");
}

/// Rows of the example, the motor at a constant speed (rad/s) from an angle (rad), under a load (N m).
fn rows(build: BeltBuild, start: f64, speed: f64, load: f64) -> Vec<BeltRow> {
    let mut text = String::from("t_s,theta_motor_rad,tau_load_nm\n");
    for k in 0..=400 {
        let time = f64::from(k) * 1e-3;
        text += &format!("{time},{},{load}\n", start + speed * time);
    }
    let input = OpenLoop::parse_belt(Path::new("in.csv"), text.as_bytes()).unwrap();
    run(&BeltFile::example(), &input, build).unwrap().collect()
}

#[test]
fn the_output_runs_with_the_motor_from_the_first_row_on_and_gives_way_to_the_load() {
    for build in [BeltBuild::Reference, BeltBuild::RealTime] {
        for start in [0.0, 1e5] {
            let rows = rows(build, start, 30.0, 0.0);
            for row in &rows {
                // But for the pitch errors, 60 um on a radius of 48 mm, and what swings with them.
                assert!((row.output_velocity - 10.0).abs() < 0.2, "{build:?} {row:?}");
                let ideal = (start + 30.0 * row.time) / 3.0;
                assert!((row.output_position - ideal).abs() < 3e-3, "{build:?} {row:?}");
            }
        }
        let last = rows(build, 0.0, 0.0, -10.0).pop().unwrap();
        assert!(last.torsion > 0.0 && last.forward_force > last.backward_force);
        assert!((last.transmitted_torque - 10.0).abs() < 0.15, "{last:?}");
        assert!((last.motor_torque - last.transmitted_torque / 3.0).abs() < 0.2, "{last:?}");
    }
}

#[test]
fn both_builds_agree() {
    let (reference, real_time) =
        (rows(BeltBuild::Reference, 0.0, 30.0, -10.0), rows(BeltBuild::RealTime, 0.0, 30.0, -10.0));
    let largest = reference.iter().map(|row| row.torsion.abs()).fold(0.0, f64::max);
    for (a, b) in reference.iter().zip(&real_time) {
        assert!((a.torsion - b.torsion).abs() < 0.05 * largest, "{a:?} {b:?}");
    }
}

#[test]
fn columns_of_a_gear_are_refused_by_name() {
    let refused =
        |text: &str| OpenLoop::parse_belt(Path::new("in.csv"), text.as_bytes()).unwrap_err().to_string();
    let line = refused("t_s,theta_wg_rad,tau_load_nm\n0,0,0\n");
    assert!(
        line.starts_with(
            "in.csv: row 1, column \"theta_wg_rad\": unknown; known columns are t_s, theta_motor_rad"
        ),
        "{line}"
    );
    let line = refused("t_s,tau_load_nm\n0,0\n");
    assert!(
        line.starts_with("in.csv: row 1, column theta_motor_rad or omega_motor_rad_s: missing"),
        "{line}"
    );
}
