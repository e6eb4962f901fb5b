//! Motions of all joints of a robot at once.

use crate::bench::Trajectory;
use crate::bench::task::{Demand, Task};
use crate::bench::trajectory::SETPOINT_SPEED;
use crate::bench::working_motion::WorkingMotion;
use crate::design::capability::Capability;
use crate::design::wave_generator::at_wave_generator;
use crate::robot::chain::Chain;
use crate::robot::file::{Joint, RobotFile};

/// Size of a joint's working motion, in that of the joint by itself: the others' motion loads it too.
const SIZE: f64 = 0.5;

/// Instants at which a task is checked before it is run.
const INSTANTS: u32 = 2000;

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

/// Refuses a task that asks more of a robot than its joints can do: an angle or a speed beyond the limits of a joint, speed of a motor, or torque
/// through a gear by the links' inertia, motion and weight.
///
/// # Errors
/// One line that names when, which joint, and what is allowed.
pub fn require_within(task: &impl RobotTask, robot: &RobotFile) -> Result<(), String> {
    let links: Vec<_> = robot.joints.iter().map(|joint| joint.link).collect();
    let chain = Chain::build(&links, robot.gravity).map_err(|why| why.to_string())?;
    let mut state = chain.rest();
    for k in 0..=INSTANTS {
        let time = task.duration() * f64::from(k) / f64::from(INSTANTS);
        let demands = task.at(time);
        for (index, (joint, demand)) in robot.joints.iter().zip(&demands).enumerate() {
            state.set(index, [joint.start + demand.position, demand.velocity]);
        }
        let accelerations: Vec<_> = demands.iter().map(|demand| demand.acceleration).collect();
        let torques = chain.torques(&state, &accelerations);
        for (index, joint) in robot.joints.iter().enumerate() {
            joint
                .require(&demands[index], torques[index] - demands[index].load)
                .map_err(|why| format!("at {time:.3} s joint {} {why}", index + 1))?;
        }
    }
    Ok(())
}

/// What is odd about a task that a robot can do: joints that have to bear more than their gear's rated torque at rest, and what its file warned of.
///
/// # Errors
/// As [`Chain::build`].
pub fn warnings(task: &impl RobotTask, robot: &RobotFile) -> Result<Vec<String>, strainwave::Error> {
    let links: Vec<_> = robot.joints.iter().map(|joint| joint.link).collect();
    let chain = Chain::build(&links, robot.gravity)?;
    let (mut state, mut most) = (chain.rest(), vec![0.0f64; links.len()]);
    for k in 0..=INSTANTS {
        let demands = task.at(task.duration() * f64::from(k) / f64::from(INSTANTS));
        let angles = robot.joints.iter().zip(&demands).map(|(joint, demand)| joint.start + demand.position);
        angles.enumerate().for_each(|(index, angle)| state.set(index, [angle, 0.0]));
        let held = chain.holding_torques(&state);
        most.iter_mut().zip(held).for_each(|(most, held)| *most = most.max(held.abs()));
    }
    let over = robot.joints.iter().zip(most).enumerate().filter_map(|(index, (joint, torque))| {
        let rated = joint.gear.gear.rated_torque;
        (torque > rated).then(|| {
            format!(
                "joint {} bears a weight of up to {torque:.4} N m, more than gear.rated_torque_nm = {rated}",
                index + 1
            )
        })
    });
    Ok(robot.warnings.iter().cloned().chain(over).collect())
}

impl Joint {
    fn require(&self, demand: &Demand, torque: f64) -> Result<(), String> {
        let gear = &self.gear.gear;
        let n = f64::from(gear.signed_ratio().n().unsigned_abs());
        let (angle, [least, largest]) = (self.start + demand.position, self.limits.angle);
        if !(least..=largest).contains(&angle) {
            return Err(format!("is at {angle:.4} rad; allowed: its limits {least} to {largest} rad"));
        }
        let of_motor = at_wave_generator(&self.gear).motor.rotor_speed_limit / n;
        let fastest = (SETPOINT_SPEED * of_motor).min(self.limits.velocity);
        if demand.velocity.abs() > fastest {
            let needed = demand.velocity.abs();
            return Err(format!("needs {needed:.4} rad/s; allowed: at most {fastest:.4} rad/s"));
        }
        if torque.abs() > gear.peak_torque {
            let (needed, most) = (torque.abs(), gear.peak_torque);
            return Err(format!("needs {needed:.4} N m; allowed: at most gear.peak_torque_nm = {most}"));
        }
        if torque.abs() > self.limits.torque {
            let (needed, most) = (torque.abs(), self.limits.torque);
            return Err(format!("needs {needed:.4} N m; allowed: its limit of {most} N m"));
        }
        Ok(())
    }
}

/// Work of 10 s before a robot is judged, from which its controllers may learn: every joint makes the moves of
/// [`WorkingMotion`] at half their size about its start, all at once, each the other way than the one before.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotWork {
    /// What each joint can do; moves that go the other way are negative.
    joints: Vec<Capability>,
}

impl RobotWork {
    /// The work of a robot.
    pub fn of(robot: &RobotFile) -> Self {
        let joint = |(index, joint): (usize, &Joint)| {
            let capability = Capability::of(&at_wave_generator(&joint.gear));
            let size = if index % 2 == 0 { SIZE } else { -SIZE };
            Capability { moves: size * capability.moves, ..capability }
        };
        Self { joints: robot.joints.iter().enumerate().map(joint).collect() }
    }
}

impl RobotTask for RobotWork {
    fn duration(&self) -> f64 {
        WorkingMotion.duration()
    }

    fn at(&self, time: f64) -> Vec<Demand> {
        self.joints.iter().map(|capability| WorkingMotion.at(time, capability)).collect()
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

    /// The work is within the example; as heavy or as fast as this nothing is.
    #[test]
    fn what_the_joints_cannot_do_is_refused() {
        let robot = RobotFile::example();
        let work = RobotWork::of(&robot);
        assert_eq!(require_within(&work, &robot), Ok(()));
        let refused = |change: fn(&mut Joint)| {
            let mut robot = robot.clone();
            change(&mut robot.joints[1]);
            require_within(&work, &robot).unwrap_err()
        };
        let line = refused(|joint| joint.link.mass *= 12.0);
        assert!(
            line.starts_with("at 0.000 s joint 1 needs ") && line.ends_with("gear.peak_torque_nm = 157"),
            "{line}"
        );
        let line = refused(|joint| joint.gear.motor.rotor_speed_limit = 10.0);
        assert!(
            line.contains(" joint 2 needs ") && line.ends_with("allowed: at most 0.0950 rad/s"),
            "{line}"
        );
        let line = refused(|joint| joint.limits.angle = [-1.0, 1.0]);
        assert_eq!(line, "at 0.000 s joint 2 is at 1.1000 rad; allowed: its limits -1 to 1 rad");
        let line = refused(|joint| joint.limits.torque = 1.0);
        assert!(line.ends_with("allowed: its limit of 1 N m"), "{line}");
    }

    #[test]
    fn a_payload_beyond_the_rating_is_told() {
        let mut robot = RobotFile::example();
        let work = RobotWork::of(&robot);
        assert_eq!(warnings(&work, &robot), Ok(Vec::new()));
        robot.joints[1].link.mass *= 4.0;
        let lines = warnings(&work, &robot).unwrap();
        // The shoulder bears all of it; the elbow, 16 kg at 0.2 m, stays below its 31 N m as it is never level.
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(
            lines[0].starts_with("joint 1 bears a weight of up to ") && lines[0].ends_with(" = 67"),
            "{lines:?}"
        );
    }

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
