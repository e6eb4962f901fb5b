//! The supervisor on whole joints: it ends an oscillation that the feedback keeps up, and leaves healthy joints alone.

use strainwave::compensator::{Faults, Mode};
use strainwave_desktop::catalogue::Set;
use strainwave_desktop::plant::unknowns::Which;
use strainwave_desktop::verify::catalogue::{Outcome, Request, measure};

fn outcome(first: u64, unknown: Which) -> Outcome {
    let mut report = measure(&Request { set: Set::Training, first, count: 1, unknown }, |_| ()).unwrap();
    report.outcomes.remove(0)
}

fn is_reduced(outcome: &Outcome) -> bool {
    let mut runs = outcome.compensated.iter().flatten();
    runs.any(|run| run.faults.contains(Faults::FEEDBACK_REDUCED))
}

/// Training joints that hunt across a static friction without presliding, or whose load rings on a flexible link.
#[test]
fn what_keeps_on_oscillating_is_reduced_and_named() {
    let joints = [
        ("friction.stribeck", 229),
        ("friction.stribeck", 271),
        ("load.flexible", 203),
        ("load.flexible", 226),
    ];
    for (unknown, seed) in joints {
        let outcome = outcome(seed, Which::named(unknown).unwrap());
        assert!(is_reduced(&outcome), "{unknown} {seed}");
        for (run, cascade) in outcome.compensated.iter().zip(&outcome.baselines[0]) {
            let [run, cascade] = [run, cascade].map(|run| run.as_ref().unwrap());
            assert_ne!(run.mode, Mode::Safe);
            assert_eq!(run.oscillates(cascade), None);
        }
    }
}

#[test]
fn healthy_joints_are_left_alone() {
    for seed in [1, 8, 55, 94, 184] {
        assert!(!is_reduced(&outcome(seed, Which::BOX)), "{seed}");
    }
}
