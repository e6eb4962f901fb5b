//! The page on one's own joint, walked on the logs of `examples/logs/`: every command as it stands there, in its order.
//!
//! Left out: logs of other actuators, which are not there; scenarios, which other tests run; what leaves the folder; what flashes
//! a chip, which a test must not. Without an emulator what runs on it is left out.

use std::path::Path;

use strainwave_emulator::setup::{self, ThisHost};

use crate::bench::Bench;

const PAGE: &str = include_str!("../../../docs/src/your-joint.md");

/// Commands of the page's blocks, without the program's name.
fn commands() -> impl Iterator<Item = &'static str> {
    let blocks = PAGE.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    blocks.flat_map(str::lines).filter_map(|line| line.strip_prefix("strainwave "))
}

/// Whether a command reaches for a chip.
fn flashes_a_chip(words: &str) -> bool {
    words.starts_with("flash") && !words.contains("--board mps2") && !words.contains("--dry-run")
}

/// Whether a command runs an image on the emulator.
fn needs_emulator(words: &str) -> bool {
    words.starts_with("pil") || words.contains("--board mps2")
}

/// A folder with the example logs.
fn bench() -> Bench {
    let bench = Bench::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/logs");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        bench.write(path.file_name().unwrap().to_str().unwrap(), std::fs::read(&path).unwrap());
    }
    bench
}

/// A figure of the last command.
fn value(bench: &Bench, name: &str) -> f64 {
    let figures = bench.figures("out.json");
    let found = figures.iter().find(|figure| figure["name"] == name).unwrap_or_else(|| panic!("{name}"));
    found["value"].as_f64().unwrap()
}

#[test]
fn every_command_of_the_page_runs_on_the_example_logs() {
    let bench = bench();
    let gear = bench.files()[&bench.path("my-joint.toml")].clone();
    let emulator = setup::present_emulator(&ThisHost).is_some();
    let mut walked = 0;
    for words in commands().filter(|words| !words.contains("--operator") && !words.contains("--scenario")) {
        if flashes_a_chip(words) {
            continue;
        }
        if needs_emulator(words) && !emulator {
            println!("skipped, no emulator: {words}");
            continue;
        }
        let answer = bench.run(&format!("{words} --json out.json"));
        // The margins of a gear that is a catalogue's alone are missed, as the page says.
        let allowed = if words.starts_with("design") { 1 } else { 0 };
        assert!(
            answer.code.is_some_and(|code| code <= allowed),
            "{words}: {}{}",
            answer.output,
            answer.error
        );
        check(&bench, words);
        walked += 1;
    }
    assert!(walked >= 10, "{walked} commands");
    for page in ["held.html", "moving.html"] {
        assert!(bench.path(page).exists(), "{page}");
    }
    assert_eq!(bench.files()[&bench.path("my-joint.toml")], gear, "`new` writes what the logs start from");
    let source = std::fs::read_to_string(bench.path("my-joint.rs")).unwrap();
    assert!(source.contains("pub static WORDS: [u32; "), "{source}");
}

/// What was built into the joint is found, and predicts what did not train.
fn check(bench: &Bench, words: &str) {
    let value = |name: &str| value(bench, name);
    let near = |name: &str, expected: f64, within: f64| {
        let found = value(name);
        assert!((found / expected - 1.0).abs() < within, "{words}: {name} is {found}, built in {expected}");
    };
    let below = |name: &str, share: f64, of: &str| {
        assert!(value(name) < share * value(of), "{words}: {name} {} of {}", value(name), value(of));
    };
    match words.split_whitespace().collect::<Vec<_>>().as_slice() {
        ["identify", "held.csv", ..] => {
            near("identify.stiffness_factor", 0.9, 0.03);
            below("identify.held_out.rms", 0.3, "identify.held_out.base.rms");
        }
        ["identify", "moving.csv", ..] => {
            near("identify.kinematic_error.order_2", 1.3e-4, 0.05);
            near("identify.kinematic_error.order_4", 3e-5, 0.15);
            near("identify.friction_factor", 1.5, 0.02);
            near("identify.viscous_factor", 1.0, 0.1);
            below("identify.held_out.rms", 0.6, "identify.held_out.base.rms");
        }
        ["predict", ..] => {
            below("predict.output.shape.rms", 0.75, "predict.output.rigid.shape.rms");
            below("predict.motor_torque.shape.rms", 0.5, "predict.motor_torque.rigid.shape.rms");
        }
        ["pil", .., "--trajectory", _, "--series", _] | ["pil", .., "--payload-lever", _] => {
            below("pil.trajectory.compensated.rms", 0.25, "pil.trajectory.b0.rms");
        }
        ["pil", .., "--replay", _] | ["pil", .., "--learn", _] => {
            below("pil.replay.predicted.rms", 0.5, "pil.replay.rigid.rms");
        }
        _ => {}
    }
}
