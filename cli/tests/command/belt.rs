//! The belt gear through the command.

use crate::bench::Bench;

const BELT: &str = include_str!("../../../gears/belt/at5-16.toml");
const WRIST: &str = include_str!("../../../gears/belt/wrist.toml");

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("b.toml", BELT);
    bench.write("motor.csv", "t_s,omega_motor_rad_s,tau_load_nm\n0,0,0\n0.01,1,-5\n0.02,2,-5\n");
    bench
}

#[test]
fn a_belt_is_checked_and_simulated_by_either_build() {
    let bench = bench();
    let checked = bench.run("check b.toml");
    assert_eq!(checked.code, Some(0), "{}", checked.error);
    assert!(checked.output.starts_with("b.toml: ok, centre distance 0.27"), "{}", checked.output);
    for build in ["reference", "realtime"] {
        let answer = bench.run(&format!(
            "sim --belt b.toml --input motor.csv --output out.csv --json f.json --build {build}"
        ));
        assert_eq!(answer.code, Some(0), "{}", answer.error);
        let text = std::fs::read_to_string(bench.path("out.csv")).unwrap();
        let header =
            "t_s,theta_out_rad,omega_out_rad_s,tau_motor_nm,torsion_rad,tau_t_nm,f_forward_n,f_backward_n";
        assert_eq!(text.lines().next(), Some(header));
        assert_eq!(text.lines().count(), 202);
        assert!(bench.figures("f.json").iter().any(|figure| figure["name"] == "sim.span_force.min"));
    }
}

#[test]
fn what_is_wrong_with_a_belt_is_told() {
    let bench = bench();
    bench.write(
        "none.toml",
        BELT.replace("pretension_n = 350.0", "pretension_n = -1").replace("teeth = 20", "teeth = 1"),
    );
    let answer = bench.run("check none.toml");
    assert_eq!(answer.code, Some(2));
    assert!(answer.error.contains("belt.pretension_n = -1 is out of range"), "{}", answer.error);
    let light = BELT.replace("inertia_kg_m2 = 0.05", "inertia_kg_m2 = 1e-6");
    bench.write("light.toml", light.replace("stiffness_n = 2.8e5", "stiffness_n = 2.8e7"));
    let only = bench.run("check light.toml");
    assert!(only.code == Some(0) && only.output.contains("; only --build reference: "), "{}", only.output);
    for (words, part) in [
        (
            "sim --belt none.toml --input motor.csv --output out.csv",
            "none.toml: belt.pretension_n = -1 is out of range",
        ),
        ("sim --belt b.toml --gear g.toml --input motor.csv --output out.csv", "cannot be used with"),
        ("sim --belt b.toml --input motor.csv --output out.csv --mesh 8x3", "cannot be used with"),
        ("sim --input motor.csv --output out.csv", "--gear"),
        (
            "sim --belt b.toml --input in.csv --output out.csv",
            "in.csv: row 1, column \"theta_wg_rad\": unknown",
        ),
        ("sim --belt b.toml --input motor.csv --output motor.csv", "are the same file"),
        ("sim --belt g.toml --input motor.csv --output out.csv", "g.toml: "),
        (
            "sim --belt light.toml --input motor.csv --output out.csv --build realtime",
            "light.toml: output_pulley.inertia_kg_m2 = 1e-6 is too light",
        ),
    ] {
        let line = bench.refused(words);
        assert!(line.contains(part), "{words}: {line}");
    }
}

/// A belt in front of a gear is told by `check`, exported, and refused where nothing is known of it.
#[test]
fn a_wrist_is_checked_and_exported_and_not_taken_for_a_gear_alone() {
    let bench = bench();
    bench.write("w.toml", WRIST);
    let checked = bench.run("check w.toml");
    assert_eq!(checked.code, Some(0), "{}", checked.error);
    assert!(checked.output.starts_with("w.toml: ok, centre distance 0.17"), "{}", checked.output);
    bench.write("loose.toml", WRIST.replace("pretension_n = 45.0", "pretension_n = 20.0"));
    let loose = bench.run("check loose.toml").output;
    assert!(loose.contains("; a span goes slack at 0.458 N m of the motor"), "{loose}");
    let exported = bench.run("export w.toml --rust joint.rs");
    assert_eq!(exported.code, Some(0), "{}", exported.error);
    for command in ["design w.toml", "sim --gear w.toml --input motor.csv --output out.csv"] {
        let refused = bench.run(command);
        assert_eq!(refused.code, Some(2), "{command}");
        assert!(refused.error.contains("w.toml: section [belt] is not known here"), "{}", refused.error);
    }
}
