//! Trajectory of a user as a task of the joint: its rows joined by a smooth curve, and what of the joint's limits it needs.
//!
//! Between the rows the setpoint is the curve of the least squared jerk through them (`plant/curve.rs`), every control period; the
//! load is linear. The joint is at rest in the first row: its angle is the bench's zero angle, and [`Trajectory::zero`] leads
//! back to the file's angles.

use crate::bench::task::{Demand, Task, periods};
use crate::design::capability::Capability;
use crate::design::wave_generator::at_wave_generator;
use crate::io::gear_file::{DrivingBelt, GearFile};
use crate::io::log::{CommandedMotion, Time, place};
use crate::plant::curve::Curve;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Fraction of the output's fastest speed that a setpoint may have: the compensator keeps the rest for overshoot.
pub(crate) const SETPOINT_SPEED: f64 = 0.95;
/// Fraction of the output's fastest speed below which a joint at rest may be taken along at once.
const START_SPEED: f64 = 0.01;

/// A motion and a load over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    time: Time,
    curve: Curve,
    zero: f64,
    load: Option<Vec<f64>>,
}

impl Trajectory {
    /// Joins the rows of a file.
    pub fn of(motion: &CommandedMotion) -> Self {
        let (first, zero) = (motion.time.stamps()[0], motion.position[0]);
        let stamps: Vec<f64> = motion.time.stamps().iter().map(|stamp| stamp - first).collect();
        let position: Vec<f64> = motion.position.iter().map(|angle| angle - zero).collect();
        let curve =
            Curve::through(&stamps, &position, motion.velocity.as_deref(), motion.acceleration.as_deref());
        Self { time: motion.time.clone(), curve, zero, load: motion.load.clone() }
    }

    /// Angle of the first row, from which the bench counts (rad).
    pub fn zero(&self) -> f64 {
        self.zero
    }

    /// Time stamps of the file.
    pub fn time(&self) -> &Time {
        &self.time
    }

    /// Refuses a motion that asks more of the joint of a gear file than its limits allow: speed of the motor, torque of the gear
    /// and of the motor by inertia and load.
    ///
    /// # Errors
    /// One line that names the row nearest to where it first does.
    pub fn require_within(&self, file: &GearFile) -> Result<(), String> {
        let limits = Limits::of(file);
        for period in 0..=periods(self) {
            let time = period as f64 * CONTROL_PERIOD;
            limits
                .check(&self.demand(time))
                .map_err(|why| format!("{}: {why}", place(self.curve.nearest_row(time))))?;
        }
        Ok(())
    }

    /// What a joint that is at rest in the first row can only do late, a line each.
    pub fn warnings(&self, file: &GearFile) -> Vec<String> {
        let speed = self.curve.first_velocity();
        let late = speed.abs() > START_SPEED * Limits::of(file).speed;
        let line = || {
            format!("{}: starts at {speed:.4} rad/s; the joint is at rest there and follows late", place(0))
        };
        late.then(line).into_iter().collect()
    }

    fn demand(&self, time: f64) -> Demand {
        let point = self.curve.at(time);
        Demand {
            position: point.position,
            velocity: point.velocity,
            acceleration: point.acceleration,
            jerk: point.jerk,
            snap: point.snap,
            load: self.load.as_ref().map_or(0.0, |load| self.time.at(time).of(load)),
        }
    }
}

impl Task for Trajectory {
    fn duration(&self) -> f64 {
        let stamps = self.time.stamps();
        stamps[stamps.len() - 1] - stamps[0]
    }

    fn at(&self, time: f64, _capability: &Capability) -> Demand {
        self.demand(time)
    }
}

/// Limits of a joint, at the output.
struct Limits<'a> {
    /// Fastest speed (rad/s).
    speed: f64,
    /// Turns of the motor in one of the output.
    n: f64,
    /// Inertia of all in front of the gear, as it is at the motor (kg m^2).
    motor_inertia: f64,
    file: &'a GearFile,
}

impl<'a> Limits<'a> {
    fn of(file: &'a GearFile) -> Self {
        let belt = file.belt.as_ref().map_or(1.0, DrivingBelt::ratio);
        let n = f64::from(file.gear.signed_ratio().n().unsigned_abs()) / belt;
        let motor_inertia = at_wave_generator(file).inertia.wave_generator * belt * belt;
        Self { speed: file.motor.rotor_speed_limit / n, n, motor_inertia, file }
    }

    fn check(&self, demand: &Demand) -> Result<(), String> {
        let Demand { velocity, acceleration, load, .. } = *demand;
        let (gear, motor, inertia) = (&self.file.gear, &self.file.motor, self.motor_inertia);
        if velocity.abs() > SETPOINT_SPEED * self.speed {
            return Err(format!(
                "needs {:.4} rad/s; allowed: at most {:.4} rad/s, {SETPOINT_SPEED} of motor.rotor_speed_limit_rad_per_s = {} over \
                 the ratio",
                velocity.abs(),
                SETPOINT_SPEED * self.speed,
                motor.rotor_speed_limit
            ));
        }
        let through_gear = self.file.inertia.flexspline * acceleration - load;
        let at_motor = self.n * inertia * acceleration + through_gear / self.n;
        let torques = [
            (through_gear, "through the gear", gear.peak_torque, "gear"),
            (at_motor, "at the motor", motor.peak_torque, "motor"),
        ];
        match torques.into_iter().find(|(torque, _, most, _)| torque.abs() > *most) {
            None => Ok(()),
            Some((torque, part, most, table)) => Err(format!(
                "an acceleration of {acceleration:.4} rad/s^2 under a load of {load:.4} N m needs {:.4} N m {part}; allowed: at \
                 most {table}.peak_torque_nm = {most}",
                torque.abs()
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trajectory(position: impl Fn(f64) -> f64, load: f64) -> Trajectory {
        let time = Time::every(0.01, 201);
        let position: Vec<f64> = time.stamps().iter().map(|t| position(*t)).collect();
        let load = Some(vec![load; position.len()]);
        Trajectory::of(&CommandedMotion { time, position, velocity: None, acceleration: None, load })
    }

    /// The bench's zero is the first row's angle.
    #[test]
    fn angles_count_from_the_first_row() {
        let trajectory = trajectory(|t| 1.5 + 0.1 * (2.0 * t).sin(), 3.0);
        assert_eq!((trajectory.zero(), trajectory.duration()), (1.5, 2.0));
        let demand = trajectory.at(1.0, &Capability::default());
        assert!((demand.position - 0.1 * 2f64.sin()).abs() < 1e-9 && demand.load == 3.0);
        assert_eq!(trajectory.at(0.0, &Capability::default()).position, 0.0);
    }

    /// A motor in front of a belt turns faster than the wave generator, and so much less the output.
    #[test]
    fn speed_and_torque_are_those_of_a_motor_in_front_of_its_belt() {
        let wrist = GearFile::wrist();
        let known = at_wave_generator(&wrist);
        let (here, there) = (Limits::of(&wrist), Limits::of(&known));
        assert!((here.speed / there.speed - 1.0).abs() < 1e-12 && here.n > there.n);
        let [here, there] =
            [here, there].map(|limits| limits.n * limits.motor_inertia / limits.file.motor.peak_torque);
        assert!((here / there - 1.0).abs() < 1e-12, "{here} {there}");
    }

    #[test]
    fn what_the_joint_cannot_do_is_named_with_its_row() {
        let file = GearFile::default_gear();
        let refusal = |trajectory: &Trajectory| trajectory.require_within(&file).unwrap_err();
        assert_eq!(trajectory(|t| 0.1 * (2.0 * t).sin(), 0.0).require_within(&file), Ok(()));
        // 1 rad/s to 40 rad/s: more than the default joint does, from some row on.
        let fast = refusal(&trajectory(|t| t + 5.0 * t.powi(4), 0.0));
        assert!(
            fast.contains("column theta_rad: needs ") && fast.contains("motor.rotor_speed_limit"),
            "{fast}"
        );
        let row: usize = fast.strip_prefix("row ").unwrap().split(',').next().unwrap().parse().unwrap();
        let speed = |t: f64| 1.0 + 20.0 * t.powi(3);
        let limit = SETPOINT_SPEED * file.motor.rotor_speed_limit / 100.0;
        let [before, at] = [row - 3, row - 1].map(|sample| speed(0.01 * sample as f64));
        assert!(before < limit && at > limit, "{row}: {before} {limit} {at}");
        let heavy = refusal(&trajectory(|_| 0.0, 500.0));
        assert!(heavy.starts_with("row 2, column theta_rad: an acceleration of 0.0000 rad/s^2"), "{heavy}");
        assert!(heavy.contains("needs 500.0000 N m through the gear"), "{heavy}");
        let rough = refusal(&trajectory(|t| if t < 1.0 { 0.0 } else { 0.1 }, 0.0));
        assert!(rough.contains("an acceleration of ") && rough.contains("row 10"), "{rough}");
    }

    #[test]
    fn a_motion_that_starts_in_motion_is_a_warning() {
        let file = GearFile::default_gear();
        assert!(trajectory(|t| 0.1 * (1.0 - t.cos()), 0.0).warnings(&file).is_empty());
        let warnings = trajectory(|t| 0.5 * t.sin(), 0.0).warnings(&file);
        assert!(warnings[0].starts_with("row 2, column theta_rad: starts at 0.5000 rad/s"), "{warnings:?}");
    }
}
