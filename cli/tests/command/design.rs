//! `design`: margins with their bounds, the exit code that follows from them.

use crate::bench::Bench;

#[test]
fn a_loop_without_margins_is_named_and_told_by_the_exit_code() {
    let bench = Bench::new();
    let answer = bench.run("design g.toml --functions none --json out.json");
    assert_eq!((answer.code, answer.error.as_str()), (Some(1), ""), "{}", answer.output);
    assert!(answer.output.contains("misses its bound: design.motor.torque.phase"), "{}", answer.output);
    let figures = bench.figures("out.json");
    let phase = figures.iter().find(|figure| figure["name"] == "design.motor.torque.phase").unwrap();
    assert!(phase["value"].as_f64() < Some(35.0) && phase["at_least"] == true, "{phase}");
}

#[test]
fn the_cascade_of_the_rule_has_its_margins() {
    let answer = Bench::new().run("design g.toml --cascade rule --functions none");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.contains("unstable corners: 0"), "{}", answer.output);
}

#[test]
fn a_drive_out_of_range_is_refused_by_key() {
    let bench = Bench::new();
    bench.write("late.toml", crate::bench::GEAR.replace("delay_periods = 2", "delay_periods = 99"));
    let line = bench.refused("design late.toml");
    assert!(line.contains("drive.delay_periods = 99") && line.contains("from 0 to 20"), "{line}");
}

/// The parameters are those that the library's examples use; the page of figures has the margins.
#[test]
fn a_joint_file_and_a_page_of_figures_are_written() {
    let bench = Bench::new();
    bench.run("design g.toml --functions none --joint joint.rs --markdown figures.md");
    let joint = std::fs::read_to_string(bench.path("joint.rs")).unwrap();
    assert!(joint == include_str!("../../../examples/joint/hd25_100.rs"), "{joint}");
    let page = std::fs::read_to_string(bench.path("figures.md")).unwrap();
    let line = page.lines().find(|line| line.starts_with("| `design.motor.torque.phase`")).unwrap();
    assert!(line.contains("| >= 35 | >= 35 | **missed, beyond its bound** |"), "{line}");
    bench.write("other.md", "no markers");
    assert!(bench.refused("design g.toml --markdown other.md").contains("figures: begin"));
}
