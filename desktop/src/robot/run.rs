//! A run of a robot: the work before it, the task, and what came of it at the tip.
//!
//! The tip's error is the distance from where it is to where the demanded angles lead, over the judged part of the task.

use strainwave::flexspline::Flexspline;

use super::bench::{Moment, RobotBench};
use super::motions::RobotTask;
use crate::bench::controller::Controller;
use crate::plant::divergence::RunError;

/// Demand and result of one joint in one control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointRow {
    /// Demanded angle (rad), from 0 of the joint.
    pub demanded: f64,
    /// True angle (rad).
    pub output: f64,
    /// True torsion of the gear (rad).
    pub torsion: f64,
    /// Torque that the rest of the arm loads the gear with (N m).
    pub load: f64,
    /// Torque command of the controller (N m).
    pub motor_torque: f64,
}

/// One control period.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotRow {
    /// Since the start of the task (s).
    pub time: f64,
    /// Place of the tip for the demanded angles (m).
    pub demanded_tip: [f64; 3],
    /// True place of the tip (m).
    pub tip: [f64; 3],
    /// The joints, from the base on.
    pub joints: Vec<JointRow>,
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotRun {
    /// A row each control period.
    pub rows: Vec<RobotRow>,
    /// Between these times the tip's error counts (s).
    pub judged: [f64; 2],
}

impl RobotRow {
    fn of<F: Flexspline<f64>>(moment: &Moment<'_, F>) -> Self {
        let (plant, starts) = (moment.plant, moment.plant.starts());
        let joints: Vec<_> = plant
            .joints()
            .iter()
            .enumerate()
            .map(|(index, joint)| JointRow {
                demanded: starts[index] + moment.demands[index].position,
                output: starts[index] + joint.output().angle.to_radians(),
                torsion: joint.last_torques().torsion,
                load: plant.loads()[index],
                motor_torque: moment.answers[index].motor_torque.into(),
            })
            .collect();
        let mut demanded = plant.chain().rest();
        joints.iter().enumerate().for_each(|(index, joint)| demanded.set(index, [joint.demanded, 0.0]));
        Self { time: moment.time, demanded_tip: plant.chain().tip(&demanded), tip: plant.tip(), joints }
    }

    /// Distance of the tip from where it should be (m).
    pub fn tip_error(&self) -> f64 {
        let squares = self.tip.iter().zip(self.demanded_tip).map(|(found, asked)| (found - asked).powi(2));
        squares.sum::<f64>().sqrt()
    }
}

impl RobotRun {
    /// Goes through `work`, where there is some, and then through a task; `progress` is called with the fraction done.
    ///
    /// # Errors
    /// As [`RobotBench::go`].
    pub fn of<F: Flexspline<f64>, C: Controller<Error = RunError>>(
        mut bench: RobotBench<F>,
        mut controllers: Vec<C>,
        work: Option<&impl RobotTask>,
        task: &impl RobotTask,
        mut progress: impl FnMut(f64),
    ) -> Result<Self, RunError> {
        let before = work.map_or(0.0, RobotTask::duration);
        let whole = before + task.duration();
        if let Some(work) = work {
            bench.go(work, &mut controllers, |moment| progress(moment.time / whole))?;
        }
        let mut rows = Vec::new();
        bench.go(task, &mut controllers, |moment| {
            progress((before + moment.time) / whole);
            rows.push(RobotRow::of(moment));
        })?;
        Ok(Self { rows, judged: task.judged() })
    }

    fn errors(&self) -> impl Iterator<Item = f64> {
        let [from, to] = self.judged;
        self.rows.iter().filter(move |row| (from..=to).contains(&row.time)).map(RobotRow::tip_error)
    }

    /// Error of the tip, rms (m).
    pub fn rms(&self) -> f64 {
        let (squares, count) =
            self.errors().fold((0.0, 0.0), |(sum, count), error| (sum + error * error, count + 1.0));
        f64::sqrt(squares / count)
    }

    /// Largest error of the tip (m).
    pub fn largest(&self) -> f64 {
        self.errors().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::bench::baseline::Kind;
    use crate::io::gear_file::SensorSet;
    use crate::robot::bench::{baselines, compensators};
    use crate::robot::circle::CircleParams;
    use crate::robot::motions::RobotWork;
    use crate::robot::{Circle, RobotFile, RobotPlant, RobotSample};

    fn bench(file: &RobotFile, sensors: SensorSet) -> RobotBench<crate::plant::CondensedMesh> {
        let plant = RobotPlant::condensed(&RobotSample::boxed(file, 3).unwrap()).unwrap();
        RobotBench::new(plant, file, 3, sensors)
    }

    /// The compensators draw better than the baseline from the first lap on, and the same run repeats bit for bit.
    #[test]
    fn a_compensated_arm_draws_better() {
        let file = RobotFile::example();
        let circle =
            Circle::of(&file, CircleParams { period: 2.0, laps: 1, ..CircleParams::default() }).unwrap();
        let none = None::<&RobotWork>;
        let b1 = baselines(&file, Kind::B1).unwrap();
        let b1 = RobotRun::of(bench(&file, SensorSet::Motor), b1, none, &circle, |_| ()).unwrap();
        let ours = |sensors| {
            let controllers = compensators(&file).unwrap();
            RobotRun::of(bench(&file, sensors), controllers, none, &circle, |_| ()).unwrap()
        };
        let [motor, both] = SensorSet::ALL.map(ours);
        assert!(
            motor.rms() < 0.7 * b1.rms() && both.rms() < 0.3 * b1.rms(),
            "{} {} {}",
            b1.rms(),
            motor.rms(),
            both.rms()
        );
        assert!(both.largest() >= both.rms() && both.rows.len() == 30_000);
        assert_eq!(ours(SensorSet::Both), both);
    }

    /// So does an arm whose wrist is behind a belt.
    #[test]
    fn a_compensated_wrist_draws_better() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/arm/wrist.toml");
        let file = RobotFile::read(&path).unwrap();
        assert!(file.joints[1].gear.belt.is_some());
        let circle =
            Circle::of(&file, CircleParams { period: 2.0, laps: 1, ..CircleParams::default() }).unwrap();
        let none = None::<&RobotWork>;
        let b1 = baselines(&file, Kind::B1).unwrap();
        let b1 = RobotRun::of(bench(&file, SensorSet::Motor), b1, none, &circle, |_| ()).unwrap().rms();
        let [motor, both] = SensorSet::ALL.map(|sensors| {
            let controllers = compensators(&file).unwrap();
            RobotRun::of(bench(&file, sensors), controllers, none, &circle, |_| ()).unwrap().rms()
        });
        assert!(motor < 0.3 * b1 && both < 0.1 * b1, "{b1} {motor} {both}");
    }

    #[test]
    fn the_error_counts_where_it_is_judged() {
        let row = |time: f64, off: f64| RobotRow {
            time,
            demanded_tip: [1.0, 0.0, 0.0],
            tip: [1.0, off, 0.0],
            joints: Vec::new(),
        };
        let rows = vec![row(0.0, 9.0), row(1.0, 3.0), row(2.0, -4.0), row(3.0, 9.0)];
        let run = RobotRun { rows, judged: [0.5, 2.5] };
        assert!((run.rms() - 12.5f64.sqrt()).abs() < 1e-12 && (run.largest() - 4.0).abs() < 1e-12);
    }
}
