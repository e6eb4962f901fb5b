//! Learnt factors and ripple go into the gear file, and the next run starts from them.

use strainwave::compensator::adapt::learning;
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::controller::HostCompensator;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::Learnt;

use crate::bench::{Bench, GEAR, lacks_emulator};

/// Content of a kept gear file.
fn kept(bench: &Bench, name: &str) -> (GearFile, Learnt) {
    let gear = GearFile::read(&bench.path(name)).unwrap();
    let learnt = gear.learnt.clone().expect("a section [learnt]");
    (gear, learnt)
}

/// A figure of the fast move in a file of figures.
fn figure(bench: &Bench, name: &str) -> f64 {
    let named = |figure: &&serde_json::Value| figure["name"] == format!("pil.s3.{name}");
    bench.figures("out.json").iter().find(named).unwrap()["value"].as_f64().unwrap()
}

fn run(bench: &Bench, words: &str) {
    let answer = bench.run(&format!("pil --scenario S3 --json out.json {words}"));
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.contains("learnt: kept.toml"), "{}", answer.output);
}

#[test]
fn a_run_starts_from_what_the_one_before_has_kept() {
    if lacks_emulator() {
        return;
    }
    let bench = Bench::new();
    run(&bench, "--gear g.toml --keep kept.toml");
    let text = std::fs::read_to_string(bench.path("kept.toml")).unwrap();
    assert!(text.starts_with(GEAR), "the gear file's own text");
    let (gear, first) = kept(&bench, "kept.toml");
    assert_ne!(first, Learnt::of(&learning::Learnt::default()), "a fast move teaches nothing");
    assert_eq!(figure(&bench, "learnt.inertia"), first.inertia);

    // The compensator that is built from it has learnt just that; the firmware is beside it, bit for bit.
    let host = HostCompensator::build(&joint_params(&gear).unwrap()).unwrap();
    assert_eq!(Learnt::of(&host.learnt()), first);

    // In the place of the file that it starts from.
    run(&bench, "--gear kept.toml --keep kept.toml");
    assert_eq!(figure(&bench, "steps_unlike_host"), 0.0);
    let (again, second) = kept(&bench, "kept.toml");
    assert_eq!(GearFile { learnt: gear.learnt.clone(), ..again }, gear);
    let off = |learnt: &Learnt| (learnt.inertia - first.inertia).abs();
    let nominal = Learnt { inertia: 1.0, ..first.clone() };
    assert!(off(&second) < off(&nominal), "{second:?} goes on from {first:?}");
}
