//! Working motion of 10 s before a joint is judged, from which a controller may learn.
//!
//! Moves of several sizes and speeds there and back, slow reversals and crawls, both ways alike, without load; no part
//! of it repeats a scenario. It starts and ends at rest at the zero angle, where every scenario starts.

use crate::bench::task::{Demand, Task, rest_to_rest};
use crate::design::capability::Capability;

/// Length (s).
const DURATION: f64 = 10.0;
/// Rest between two moves (s).
const REST: f64 = 0.1;

/// End (rad) and duration (s) of each move.
const MOVES: [(f64, f64); 17] = [
    (0.50, 0.30),
    (0.00, 0.35),
    (-0.25, 0.25),
    (-0.22, 0.15),
    (-0.27, 0.20),
    (-0.17, 1.10),
    (-0.20, 0.70),
    (-0.14, 0.80),
    (0.30, 0.40),
    (0.305, 0.05),
    (0.30, 0.05),
    (0.10, 0.30),
    (0.04, 0.80),
    (0.10, 0.80),
    (0.00, 1.10),
    (-0.05, 0.25),
    (0.00, 0.25),
];

/// The working motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkingMotion;

impl Task for WorkingMotion {
    fn duration(&self) -> f64 {
        DURATION
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        let (mut from, mut elapsed) = (0.0, time);
        for (to, duration) in MOVES {
            if elapsed < duration + REST {
                let demand = rest_to_rest(elapsed, to - from, duration);
                return Demand { position: from + demand.position, ..demand }.scaled(capability);
            }
            (from, elapsed) = (to, elapsed - duration - REST);
        }
        Demand { position: from, ..Demand::default() }.scaled(capability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::controller::HostCompensator;
    use crate::bench::task::tests::require_one_motion;
    use crate::bench::{Bench, Conditions};
    use crate::design::joint::joint_params;
    use crate::io::gear_file::GearFile;
    use crate::io::gear_file::SensorSet;
    use crate::plant::box_sample::BoxSample;

    #[test]
    fn it_comes_back_in_time_and_stays_within_the_joint() {
        let demand = |k: u32| WorkingMotion.at(f64::from(k) * 1e-3, &Capability::default());
        let (start, end) = (demand(0), demand(9_900));
        assert_eq!((start.position, end.position), (0.0, 0.0));
        assert_eq!((end.velocity, end.acceleration, end.load), (0.0, 0.0, 0.0));
        let file = GearFile::default_gear();
        let speed = file.motor.rotor_speed_limit / f64::from(file.gear.ratio);
        let acceleration = file.gear.peak_torque / file.inertia.flexspline;
        for demand in (0..10_000).map(demand) {
            assert!(demand.velocity.abs() < speed && demand.acceleration.abs() < acceleration, "{demand:?}");
        }
    }

    #[test]
    fn it_is_one_motion() {
        require_one_motion(&WorkingMotion, 1e-5);
    }

    /// However often the output encoder reads, and on a late one.
    #[test]
    fn it_teaches_inertia_and_stiffness() {
        for (seed, period, delay) in [(14, 1, 0), (16, 1, 3), (14, 2, 0), (16, 3, 2), (14, 4, 0), (16, 10, 5)]
        {
            let mut file = GearFile::default_gear();
            (file.sensors.output_encoder_period, file.sensors.output_encoder_delay) = (period, delay);
            let conditions = Conditions { sensors: SensorSet::Both, ..Conditions::of(&file, seed) };
            let mut bench = Bench::condensed(&file, &conditions).unwrap();
            let mut controller = HostCompensator::build(&joint_params(&file).unwrap()).unwrap();
            bench.go(&WorkingMotion, &mut controller, |_, _, _, _| ()).unwrap();
            let (sample, factors) = (BoxSample::from_seed(seed), controller.learnt().factors);
            let (inertia, compliance) = (
                f64::from(factors.inertia) / sample.inertia,
                f64::from(factors.compliance) * sample.stiffness,
            );
            assert!((inertia - 1.0).abs() < 0.065, "{seed}, {period}: {inertia}");
            assert!((compliance - 1.0).abs() < 0.04, "{seed}, {period}: {compliance}");
        }
    }
}
