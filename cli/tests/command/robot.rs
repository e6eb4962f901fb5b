//! `robot`: an arm of several joints.

use crate::bench::Bench;

const ARM: &str = include_str!("../../../examples/arm/arm.toml");
const ELBOW: &str = include_str!("../../../examples/arm/elbow.toml");
const WITH_WRIST: &str = include_str!("../../../examples/arm/wrist.toml");
const WRIST: &str = include_str!("../../../gears/belt/wrist.toml");

/// A folder with the example's arm; its shoulder is the default gear `g.toml`.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("elbow.toml", ELBOW);
    bench.write("arm.toml", arm());
    bench
}

fn arm() -> String {
    ARM.replace("../../gears/hd25-100.toml", "g.toml")
}

#[test]
fn bad_robot_files_are_refused_by_key() {
    let bench = bench();
    for (from, to, expected) in [
        (
            "mass_kg = 4.0",
            "mass_kg = 0",
            "arm.toml: joint[0].mass_kg = 0 is out of range; allowed: a number above 0",
        ),
        (
            "mass_kg = 4.0",
            "mas_kg = 4.0",
            "arm.toml: unknown key joint[0].mas_kg = 4.0; the nearest known key is joint[].mass_kg",
        ),
        (
            "length_m = 0.40\n",
            "",
            "arm.toml: missing key joint[0].length_m; allowed: a number from 0 to 100 m",
        ),
        (
            "centre_m = 0.20",
            "centre_m = \"0.2\"",
            "arm.toml: joint[0].centre_m = \"0.2\" is text; allowed: a number",
        ),
        (
            "gravity_y_m_per_s2 = -9.80665",
            "gravity_m_per_s2 = 9.8",
            "arm.toml: unknown key robot.gravity_m_per_s2 = 9.8",
        ),
        ("gear = \"elbow.toml\"", "gear = \"none.toml\"", "none.toml: cannot be read: "),
    ] {
        assert!(ARM.contains(from), "{from}");
        bench.write("arm.toml", arm().replacen(from, to, 1));
        let line = bench.refused("robot arm.toml --series out.csv --json out.json");
        assert!(line.contains(expected), "{line}");
    }
    bench.write("arm.toml", arm());
    bench.write("elbow.toml", ELBOW.replacen("k1_nm_per_rad = 10000.0", "k1_nm_per_rad = -1", 1));
    let line = bench.refused("robot arm.toml --series out.csv");
    assert!(line.contains("elbow.toml: stiffness.k1_nm_per_rad = -1 is out of range; allowed: "), "{line}");
}

#[test]
fn what_the_arm_cannot_do_is_refused() {
    let bench = bench();
    bench.write("move.csv", "t_s,theta_rad\n0,0\n0.5,0.1\n1,0\n");
    bench.write("leap.csv", "t_s,theta_rad\n0,0\n0.05,3\n0.1,0\n");
    for (words, expected) in [
        ("--circle 0.5", "arm.toml: a circle of radius 0.5 m from the start is "),
        ("--circle nan", "arm.toml: a circle of radius NaN m from the start is "),
        ("--period 0.05", "--period 0.05 is out of range; allowed: a number from 0.1 to 60 s"),
        ("--period 0.15", "arm.toml: at "),
        ("--trajectory move.csv", "arm.toml: 2 joints; --trajectory is given 1 times"),
        ("--trajectory move.csv --trajectory leap.csv", "leap.csv: row "),
        ("--series arm.toml", "arm.toml: --series and ROBOT.toml are the same file"),
    ] {
        let line = bench.refused(&format!("robot arm.toml {words}"));
        assert!(line.contains(expected), "{line}");
    }
}

#[test]
fn an_arm_draws_its_circle_into_files() {
    let bench = bench();
    let answer = bench.run(
        "robot arm.toml --period 1 --laps 1 --seed 5 --without-work --series s.csv --picture c.svg --json out.json",
    );
    assert_eq!(answer.code, Some(0), "{}", answer.error);
    let figures = bench.figures("out.json");
    let value = |name: &str| {
        let found = figures.iter().find(|figure| figure["name"] == name).unwrap_or_else(|| panic!("{name}"));
        found["value"].as_f64().unwrap()
    };
    assert!(value("robot.motor.to_b1") < 1.0 && value("robot.both.to_b1") < value("robot.motor.to_b1"));
    assert!(value("robot.b1.tip.max") > value("robot.b1.tip.rms"));
    let series = std::fs::read_to_string(bench.path("s.csv")).unwrap();
    let header = series.lines().next().unwrap();
    for column in ["t_s", "tip_y_set_m", "tip_x_b1_m", "theta_2_both_rad", "tau_load_1_motor_nm"] {
        assert!(header.split(',').any(|name| name == column), "{column}: {header}");
    }
    assert_eq!(series.lines().count(), 1 + 20_000);
    assert!(std::fs::read_to_string(bench.path("c.svg")).unwrap().contains("its error"));
}

#[test]
fn a_wrist_behind_a_belt_is_a_joint_like_any_other() {
    let bench = bench();
    bench.write("w.toml", WRIST);
    bench.write("arm.toml", WITH_WRIST.replace("../../gears/belt/wrist.toml", "w.toml"));
    assert_eq!(bench.run("check arm.toml").output, "arm.toml: ok, joints: 2\n");
    let answer = bench.run("robot arm.toml --period 1 --laps 1 --without-work --json out.json");
    assert_eq!(answer.code, Some(0), "{}", answer.error);
    let figures = bench.figures("out.json");
    let ratio = figures.iter().find(|figure| figure["name"] == "robot.both.to_b1").unwrap();
    assert!(ratio["value"].as_f64() < Some(0.5), "{ratio}");
}

#[test]
fn joints_follow_trajectories_from_their_first_rows() {
    let bench = bench();
    bench.write("one.csv", "t_s,theta_rad\n0,-0.4\n0.2,-0.4\n0.5,-0.3\n0.8,-0.4\n1,-0.4\n");
    bench.write("two.csv", "t_s,theta_rad,tau_load_nm\n0,1,0\n0.25,1,0\n0.5,1.2,5\n");
    let answer =
        bench.run("robot arm.toml --trajectory one.csv --trajectory two.csv --without-work --series -");
    assert_eq!(answer.code, Some(0), "{}", answer.error);
    let mut lines = answer.output.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').collect();
    let of = |line: &str, name: &str| -> f64 {
        let place = header.iter().position(|title| *title == name).unwrap();
        line.split(',').nth(place).unwrap().parse().unwrap()
    };
    let (first, last) = (lines.next().unwrap(), answer.output.lines().last().unwrap());
    assert_eq!(["theta_1_set_rad", "theta_2_set_rad"].map(|name| of(first, name)), [-0.4, 1.0]);
    // The second rests where it has come to, and both joints are near.
    assert!((of(last, "theta_2_set_rad") - 1.2).abs() < 1e-9);
    for (set, found) in [("theta_1_set_rad", "theta_1_both_rad"), ("theta_2_set_rad", "theta_2_both_rad")] {
        assert!((of(last, set) - of(last, found)).abs() < 2e-3, "{set}");
    }
    assert!(answer.error.contains("robot.both.tip.rms"));
}

#[test]
fn check_tells_everything_that_is_wrong() {
    let bench = bench();
    let answer = bench.run("check arm.toml");
    assert_eq!((answer.code, answer.output.as_str()), (Some(0), "arm.toml: ok, joints: 2\n"));
    let wrong = arm().replacen("[robot]", "[robot]\nlegs = 2", 1);
    bench.write("arm.toml", wrong.replacen("inertia_x_kg_m2 = 0.006", "inertia_x_kg_m2 = 0.6", 1));
    let answer = bench.run("check arm.toml");
    let lines: Vec<_> = answer.error.lines().collect();
    assert_eq!((answer.code, lines.len()), (Some(2), 2), "{}", answer.error);
    assert!(lines[0].starts_with("error: arm.toml: unknown key robot.legs = 2; "), "{}", lines[0]);
    assert!(lines[1].starts_with("error: arm.toml: joint[0].inertia_kg_m2 = 0.06 with "), "{}", lines[1]);
}
