//! The motor's encoder of a joint of the catalogue that differs from its gear file by no more than the unknowns of the plant is no faulty one.

use strainwave::compensator::Faults;
use strainwave_desktop::GearFile;
use strainwave_desktop::catalogue::FILES;
use strainwave_desktop::plant::unknowns::Which;
use strainwave_desktop::verify::robustness::{Request, measure};

/// What the motor's encoder is said to have.
const BROKEN: [Faults; 3] =
    [Faults::MOTOR_ENCODER_JUMP, Faults::MOTOR_ENCODER_FROZEN, Faults::MOTOR_ENCODER_LOST];

fn gear(name: &str) -> GearFile {
    FILES.iter().map(|file| file.gear()).find(|file| file.gear.name == name).unwrap()
}

/// The motor's encoder works in every run on these training plants.
fn is_sound(name: &str, unknown: &str, first: u64, seeds: u64) {
    let which = Which::named(unknown).unwrap();
    let request = Request { rows: vec![which], first, seeds: Some(seeds), noises: 1, reference: false };
    let robustness = measure(&gear(name), &request, |_| ()).unwrap();
    let (_, outcomes) = &robustness.outcomes[0];
    assert_eq!(outcomes.len() as u64, seeds);
    for outcome in outcomes {
        for run in outcome.compensated.iter().flatten() {
            let faults = run.as_ref().unwrap().faults;
            assert!(
                !BROKEN.into_iter().any(|broken| faults.contains(broken)),
                "{}: {faults:?}",
                outcome.seed
            );
        }
    }
}

/// Friction without presliding holds the rotor at one count, the more torque of the motor the more the gear carries.
#[test]
fn a_rotor_that_loaded_friction_holds_has_no_frozen_encoder() {
    is_sound("hd20-100", "friction.stribeck", 100, 4);
    is_sound("hd45-160", "friction.stribeck", 104, 4);
}

/// An encoder of 14 bits with a count of noise, on a rotor that no torque accelerates by a count in a period.
#[test]
fn a_coarse_encoder_of_a_slow_rotor_does_not_jump() {
    is_sound("hd50-160", "all", 107, 1);
    is_sound("hd50-160", "all", 117, 1);
}
