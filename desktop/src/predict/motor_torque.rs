//! The motor torque of a measured motion: what inertia, friction and gear ask of the motor.
//!
//! ```text
//! tau_motor = J_wg*ddtheta + tau_fric_in + (r + de/dtheta)*tau_t
//! ```
//!
//! tau_t is the measured output torque; without one that of the two-port whose output nothing loads but inertia and friction.
//! Speed and acceleration are central differences over +-W of the motor's angle,
//!
//! ```text
//! dtheta = (theta(t + W) - theta(t - W))/(2*W),   ddtheta = (theta(t + W) - 2*theta(t) + theta(t - W))/W^2
//! ```
//!
//! which passes 0.8 of an acceleration at 60 Hz, and of an encoder's count c makes an acceleration of 2*c/W^2 at most.
//! Discretisation: steps of the control period; the output starts in the motor's motion, without torsion.

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{HYSTERESIS_MEMORY, RealTimeGear};
use strainwave::friction::{FrictionModel, JointFrictionState, Slip};
use strainwave::gear::{GearState, Motion};
use strainwave::{Angle, Error};

use super::real_time_gear;
use crate::bench::baseline::Commanded;
use crate::bench::baseline::rigid_body::RigidBody;
use crate::design::joint::firmware_gear_params;
use crate::io::gear_file::GearFile;
use crate::io::log::{Drive, MeasuredLog};
use crate::plant::two_port::trajectory::Trajectory;

/// W (s), unless the log's intervals are longer.
const WINDOW: f64 = 0.004;

/// Torque of a control period (N m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Torque {
    /// By the real-time model.
    pub predicted: f64,
    /// By a rigid joint.
    pub rigid: f64,
}

/// The motor torque in every control period of a log.
pub(super) fn predict(file: &GearFile, log: &MeasuredLog) -> Result<Vec<Torque>, Error> {
    let motor = Motor::of(log);
    let mut joint = Joint::build(file, &motor.at(0.0))?;
    let torques = log.time.resampled(CONTROL_PERIOD).map(|instant| {
        let transmitted = log.output_torque.as_ref().map(|torque| instant.of(torque));
        joint.step(&motor.at(instant.elapsed), transmitted)
    });
    Ok(torques.collect())
}

/// Motion of the motor at an instant.
struct Moving {
    /// (rad)
    angle: f64,
    /// (rad/s)
    velocity: f64,
    /// (rad/s^2)
    acceleration: f64,
}

impl Moving {
    fn motion(&self) -> Motion<f32> {
        Motion { angle: Angle::from_radians_f64(self.angle), velocity: self.velocity as f32 }
    }
}

/// Motion of the motor over the time since the first row.
struct Motor {
    trajectory: Trajectory,
    /// Angle of the first row (rad).
    first: f64,
    /// W (s).
    window: f64,
    /// Time of the last row less W (s).
    last: f64,
}

impl Motor {
    fn of(log: &MeasuredLog) -> Self {
        let stamps = log.time.stamps();
        let interval = log.time.jitter().map_or(0.0, |jitter| jitter.nominal);
        let window = WINDOW.max(interval);
        Self {
            trajectory: Trajectory::new(stamps, &Drive::Position(log.motor_position.clone())),
            first: log.motor_position[0],
            window,
            last: (stamps[stamps.len() - 1] - stamps[0] - window).max(0.0),
        }
    }

    fn at(&self, elapsed: f64) -> Moving {
        let angle = |time: f64| self.first + self.trajectory.at(time).angle;
        // The trajectory stands after its last row.
        let middle = elapsed.min(self.last);
        let [before, now, after] = [-self.window, 0.0, self.window].map(|shift| angle(middle + shift));
        Moving {
            angle: angle(elapsed),
            velocity: (after - before) / (2.0 * self.window),
            acceleration: (after - 2.0 * now + before) / self.window.powi(2),
        }
    }
}

/// The real-time gear and a rigid joint beside it.
struct Joint {
    gear: RealTimeGear<f32>,
    state: GearState<f32, (), JointFrictionState<f32>, HYSTERESIS_MEMORY>,
    friction: JointFrictionState<f32>,
    flange: Motion<f32>,
    rigid: RigidBody,
    /// r
    ratio: f64,
    /// J_wg (kg m^2).
    inertia: f64,
}

impl Joint {
    fn build(file: &GearFile, start: &Moving) -> Result<Self, Error> {
        let gear = real_time_gear(file)?;
        let ratio = file.gear.signed_ratio();
        let velocity = (ratio.value::<f64>() * start.velocity) as f32;
        Ok(Self {
            state: gear.rest(),
            friction: JointFrictionState::default(),
            flange: Motion { angle: gear.drive(start.motion().angle), velocity },
            gear,
            rigid: RigidBody::new(ratio, &firmware_gear_params(file)?, 1.0),
            ratio: ratio.value(),
            inertia: file.inertia.wave_generator,
        })
    }

    fn step(&mut self, motor: &Moving, transmitted: Option<f64>) -> Torque {
        let resisting = match transmitted {
            Some(torque) => self.resisting(motor, torque as f32),
            None => self.gear.step(&mut self.state, &mut self.flange, &motor.motion(), 0.0).wave_generator,
        };
        Torque {
            predicted: self.inertia * motor.acceleration + f64::from(resisting),
            rigid: self.rigid(motor, transmitted),
        }
    }

    /// Friction at the wave generator and the torque that the gear transmits (N m).
    fn resisting(&mut self, motor: &Moving, transmitted: f32) -> f32 {
        let motion = motor.motion();
        let heading = motion.angle.heading();
        let reflected =
            (self.ratio as f32 + self.gear.kinematic_error(motion.angle, heading).slope) * transmitted;
        let slip = Slip { wave_generator: heading, ..Slip::new(motion.velocity, CONTROL_PERIOD as f32) };
        let friction = self.gear.frictions().0.step(&mut self.friction, &slip.under(-reflected, reflected));
        friction.force + reflected
    }

    fn rigid(&self, motor: &Moving, transmitted: Option<f64>) -> f64 {
        let [velocity, acceleration] = [motor.velocity, motor.acceleration].map(|rate| self.ratio * rate);
        match transmitted {
            Some(torque) => {
                self.inertia * motor.acceleration + self.rigid.friction(velocity)[0] + self.ratio * torque
            }
            None => self.rigid.torque(&Commanded { velocity, acceleration, ..Commanded::default() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::log::Time;

    /// A motor that swings, sampled every millisecond.
    fn log(output_torque: Option<f64>) -> MeasuredLog {
        let time = Time::every(1e-3, 2000);
        let motor: Vec<_> = time.stamps().iter().map(|t| 3.0 * (5.0 * t).sin()).collect();
        MeasuredLog {
            motor_torque: vec![0.0; motor.len()],
            output_torque: output_torque.map(|torque| vec![torque; motor.len()]),
            motor_position: motor,
            time,
            output_position: None,
            model_torque: None,
        }
    }

    fn at(torques: &[Torque], time: f64) -> Torque {
        torques[(time / CONTROL_PERIOD) as usize]
    }

    /// At a turning point friction changes its sign; where the speed is largest the motor bears friction alone, and both
    /// joints agree but for the Stribeck curve and presliding.
    #[test]
    fn inertia_and_friction_are_what_a_motion_asks() {
        let file = GearFile::default_gear();
        let torques = predict(&file, &log(None)).unwrap();
        let fastest = at(&torques, std::f64::consts::TAU / 5.0);
        let friction = file.friction.input.coulomb.unwrap();
        assert!(fastest.predicted > friction && fastest.predicted < 2.0 * friction, "{fastest:?}");
        assert!((fastest.predicted / fastest.rigid - 1.0).abs() < 0.1, "{fastest:?}");
    }

    /// A constant torque at the output adds its fraction r.
    #[test]
    fn an_output_torque_reaches_the_motor_through_the_ratio() {
        let file = GearFile::default_gear();
        let [loaded, free] = [20.0, 0.0].map(|torque| predict(&file, &log(Some(torque))).unwrap());
        let difference = at(&loaded, 1.0).rigid - at(&free, 1.0).rigid;
        assert!((difference + 0.2).abs() < 1e-9, "{difference}");
        // The kinematic error modulates it.
        let difference = at(&loaded, 1.0).predicted - at(&free, 1.0).predicted;
        assert!((difference + 0.2).abs() < 0.01, "{difference}");
    }
}
