//! Motions of all joints of a robot at once.

use crate::bench::Trajectory;
use crate::bench::task::{Demand, Task};
use crate::bench::working_motion::WorkingMotion;
use crate::design::capability::Capability;
use crate::robot::file::{Joint, RobotFile};

/// Size of a joint's working motion, in that of the joint by itself: the others' motion loads it too.
const SIZE: f64 = 0.5;

/// Task of a robot.
pub trait RobotTask {
    /// Length (s).
    fn duration(&self) -> f64;

    /// Demand of each joint at `time` (s), from its angle at the start on.
    fn at(&self, time: f64) -> Vec<Demand>;

    /// From here on the error counts, and until then (s): all of it.
    fn judged(&self) -> [f64; 2] {
        [0.0, self.duration()]
    }
}

/// Work of 10 s before a robot is judged, from which its controllers may learn: every joint makes the moves of
/// [`WorkingMotion`] at half their size about its start, all at once, each the other way than the one before.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotWork {
    /// What each joint can do, and the sign of its moves.
    joints: Vec<(Capability, f64)>,
}

impl RobotWork {
    /// The work of a robot.
    pub fn of(robot: &RobotFile) -> Self {
        let joint = |(index, gear): (usize, &Joint)| {
            let capability = Capability::of(&gear.gear);
            (
                Capability { moves: SIZE * capability.moves, ..capability },
                if index % 2 == 0 { 1.0 } else { -1.0 },
            )
        };
        Self { joints: robot.joints.iter().enumerate().map(joint).collect() }
    }
}

impl RobotTask for RobotWork {
    fn duration(&self) -> f64 {
        WorkingMotion.duration()
    }

    fn at(&self, time: f64) -> Vec<Demand> {
        self.joints
            .iter()
            .map(|(capability, sign)| turned(WorkingMotion.at(time, capability), *sign))
            .collect()
    }
}

fn turned(demand: Demand, sign: f64) -> Demand {
    Demand {
        position: sign * demand.position,
        velocity: sign * demand.velocity,
        acceleration: sign * demand.acceleration,
        jerk: sign * demand.jerk,
        snap: sign * demand.snap,
        load: sign * demand.load,
    }
}

/// A trajectory of the user for each joint; one that ends before the others rests.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotTrajectory(pub Vec<Trajectory>);

impl RobotTask for RobotTrajectory {
    fn duration(&self) -> f64 {
        self.0.iter().map(Task::duration).fold(0.0, f64::max)
    }

    fn at(&self, time: f64) -> Vec<Demand> {
        let demand = |joint: &Trajectory| joint.at(time.min(joint.duration()), &Capability::default());
        self.0.iter().map(demand).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_joints_work_at_once_and_come_back() {
        let robot = RobotFile::example();
        let work = RobotWork::of(&robot);
        assert_eq!(work.duration(), 10.0);
        let [shoulder, elbow] = [0, 1].map(|joint: usize| work.at(0.3)[joint].position);
        assert!((shoulder - 0.25).abs() < 1e-12 && elbow < -0.05, "{shoulder} {elbow}");
        assert!(work.at(10.0).iter().all(|demand| demand.position == 0.0 && demand.velocity == 0.0));
    }
}
