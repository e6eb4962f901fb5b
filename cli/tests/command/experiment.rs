//! `experiment`: a motion that shows the parameters, and what it is told beside it.

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::Trajectory;
use strainwave_desktop::io::log::CommandedMotion;

use crate::bench::Bench;

#[test]
fn a_plan_is_a_motion_that_the_joint_can_follow() {
    let bench = Bench::new();
    let answer = bench.run("experiment g.toml --output plan.csv --range 0.4 --parts 2 --json out.json");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
    let motion = CommandedMotion::read(&bench.path("plan.csv")).unwrap();
    let trajectory = Trajectory::of(&motion);
    let gear = GearFile::read(&bench.path("g.toml")).unwrap();
    assert_eq!(trajectory.require_within(&gear), Ok(()));
    assert!(trajectory.warnings(&gear).is_empty());
    assert_eq!((motion.time.stamps()[1600], motion.position.len()), (16.0, 1601));
    assert!(motion.position.iter().all(|angle| angle.abs() <= 0.4));
    let figures = bench.figures("out.json");
    let value = |name: &str| {
        let found = figures.iter().find(|figure| figure["name"] == format!("experiment.{name}"));
        found.unwrap_or_else(|| panic!("{name}"))["value"].as_f64().unwrap()
    };
    for kind in ["triangles", "speeds", "chirp", "pendulum"] {
        assert!(answer.output.contains(kind), "{}", answer.output);
        assert!(value("plan.log_determinant") >= value(&format!("{kind}.log_determinant")), "{kind}");
    }
    // Known to a factor before; the load's weight to the peak torque.
    assert!(value("plan.friction_level") < 0.1 && value("plan.weight.cosine") < 0.1 * 157.0);
    assert!(value("plan.kinematic_error.order_2.sine") < 4e-5);
}

#[test]
fn plans_that_cannot_be_made_are_refused() {
    let bench = Bench::new();
    for (words, expected) in [
        ("none.toml --output plan.csv", "none.toml: cannot be read: No such file"),
        ("g.toml --output none/plan.csv", "none/plan.csv: cannot be written: there is no folder none"),
        ("g.toml --output g.toml", "g.toml: --output and GEAR.toml are the same file"),
        (
            "g.toml --output plan.csv --range 0",
            "--range 0 is out of range; allowed: a number from 0.001 to 1000 rad",
        ),
        ("g.toml --output plan.csv --range nan", "--range NaN is out of range"),
        ("g.toml --output plan.csv --parts 6", "invalid value '6' for '--parts <COUNT>': 6 is not in 1..=5"),
        ("g.toml", "the following required arguments were not provided: --output <PLAN.csv>"),
    ] {
        let line = bench.refused(&format!("experiment {words}"));
        assert!(line.contains(expected), "{line}\n{expected}");
    }
}
