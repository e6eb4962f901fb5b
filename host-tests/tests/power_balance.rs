//! The reference plant's power balance over every scenario, under the compensator.

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::closed_loop;
use strainwave_desktop::bench::controller::HostCompensator;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::verify::bounds;

fn closes(scenario: Scenario) {
    let gear = GearFile::default_gear();
    let mut compensator = HostCompensator::build(&joint_params(&gear).unwrap()).unwrap();
    let run = closed_loop::run(&gear, scenario, 1, &mut compensator, |_| ()).unwrap();
    let figure = bounds::figure("plant.power_balance", run.imbalance);
    assert!(figure.holds, "{scenario:?}: {figure:?}");
}

#[test]
fn in_s1() {
    closes(Scenario::S1);
}

#[test]
fn in_s2() {
    closes(Scenario::S2);
}

#[test]
fn in_s3() {
    closes(Scenario::S3);
}

#[test]
fn in_s4() {
    closes(Scenario::S4);
}

#[test]
fn in_s5() {
    closes(Scenario::S5);
}

#[test]
fn in_s6() {
    closes(Scenario::S6);
}
