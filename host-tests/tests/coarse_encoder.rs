//! A resting joint with a coarse motor encoder: its speed is the observer's, which a count is no impulse to.

use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::catalogue::Set;
use strainwave_desktop::plant::unknowns::Which;
use strainwave_desktop::verify::catalogue::{Request, measure};
use strainwave_desktop::verify::robustness::JUDGED;

/// Training joints of 14 bits whose cascade alone goes to and fro between two counts.
const JOINTS: [u64; 3] = [6, 16, 94];

/// With the encoder's difference quotient it is most of what the cascade alone has.
#[test]
fn a_count_does_not_shake_a_resting_motor() {
    let fast_move = JUDGED.iter().position(|scenario| *scenario == Scenario::S3).unwrap();
    for first in JOINTS {
        let report =
            measure(&Request { set: Set::Training, first, count: 1, unknown: Which::BOX }, |_| ()).unwrap();
        let outcome = &report.outcomes[0];
        assert_eq!(outcome.joint.known.sensors.motor_encoder_bits, 14, "{first}");
        let [ours, cascade] = [&outcome.compensated, &outcome.baselines[0]]
            .map(|results| results[fast_move].as_ref().unwrap().torque_at_rest);
        assert!(cascade > 0.1 && ours < 0.1 * cascade, "{first}: {ours} beside {cascade}");
    }
}
