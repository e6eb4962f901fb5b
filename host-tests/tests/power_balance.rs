//! The reference plant's power balance under the compensator; `strainwave verify firmware` judges it over S1 to S6.

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::closed_loop;
use strainwave_desktop::bench::controller::HostCompensator;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::verify::bounds;

#[test]
fn it_closes_in_the_fast_move() {
    let gear = GearFile::default_gear();
    let mut compensator = HostCompensator::build(&joint_params(&gear).unwrap()).unwrap();
    let run = closed_loop::run(&gear, Scenario::S3, 1, &mut compensator, |_| ()).unwrap();
    let figure = bounds::figure("plant.power_balance", run.imbalance);
    assert!(figure.holds, "{figure:?}");
}
