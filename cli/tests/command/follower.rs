//! A firmware that follows the host's build is compared in every step, and a step in which it differs is counted.

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::{Conditions, periods};
use strainwave_emulator::pil;
use strainwave_emulator::verify::BOARD;

use crate::bench::lacks_emulator;

/// Plant of the runs.
const SEED: u64 = 1;

#[test]
fn an_image_of_another_joint_is_told_from_the_host() {
    if lacks_emulator() {
        return;
    }
    let gear = GearFile::default_gear();
    let image = pil::build(BOARD, &gear).unwrap().elf;
    let mut other = gear.clone();
    other.stiffness.k1 *= 1.01;
    let [same, unlike] = [&gear, &other].map(|gear| {
        let conditions = Conditions::of(gear, SEED);
        pil::workload(&image, &[], gear, (Scenario::S5, &conditions), |_| ()).unwrap().0
    });
    let steps = periods(&Scenario::S5) as u64;
    assert_eq!((same.steps, same.different), (steps, 0));
    assert!(unlike.steps == steps && unlike.different > steps / 2, "{unlike:?}");
}
