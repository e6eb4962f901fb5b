//! The supervisor on whole joints: it ends an oscillation that the feedback keeps up, and leaves healthy joints alone.

use strainwave::compensator::{Faults, Mode};
use strainwave_desktop::catalogue::Set;
use strainwave_desktop::plant::unknowns::Which;
use strainwave_desktop::verify::catalogue::{Outcome, Request, measure};

fn outcome(first: u64) -> Outcome {
    let mut report =
        measure(&Request { set: Set::Training, first, count: 1, unknown: Which::BOX }, |_| ()).unwrap();
    report.outcomes.remove(0)
}

fn is_reduced(outcome: &Outcome) -> bool {
    let mut runs = outcome.compensated.iter().flatten();
    runs.any(|run| run.faults.contains(Faults::FEEDBACK_REDUCED))
}

/// Training joints under loads of thirteen to seventeen rotors, which may hunt across static friction: which of them do depends on single
/// counts.
#[test]
fn what_keeps_on_oscillating_is_reduced_and_named() {
    let reduced: Vec<_> = [243, 324, 350].map(outcome).into_iter().filter(is_reduced).collect();
    assert!(!reduced.is_empty());
    for outcome in reduced {
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
        assert!(!is_reduced(&outcome(seed)), "{seed}");
    }
}
