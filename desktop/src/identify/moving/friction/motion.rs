//! Motion of the motor and what drives it, as the friction block sees both: every [`STEP`] the mean over +-[`HALF_MEAN`].
//!
//! ```text
//! v_k = (theta_k - theta_(k-1))/STEP        a_k = (theta(t + S) - 2*theta(t) + theta(t - S))/S^2,   S = HALF_SPAN
//! ```
//!
//! The path of the steps is that of the angle, so that presliding ends where it does whatever the speed's noise. Every
//! second step is a row of the fit: the means of two rows share no reading. Units: rad, rad/s, rad/s^2, N m.

use strainwave::Angle;
use strainwave::angle::Heading;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::{FrictionModel, FrictionParams, JointFrictionState, Slip};

use super::super::EVERY;
use crate::identify::Error;
use crate::identify::replay::ReplayRow;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::friction_params::joint_friction_params;

/// Control periods of a step.
const PERIODS: usize = EVERY / STEPS_A_ROW;
/// Steps of a row.
pub(super) const STEPS_A_ROW: usize = 2;
/// A step (s).
pub(super) const STEP: f64 = PERIODS as f64 * CONTROL_PERIOD;
/// Control periods on either side that a mean is over.
const HALF_MEAN: usize = EVERY / 2;
/// S, half of the time over which accelerations are taken (s).
const HALF_SPAN: f64 = 0.024;

/// One step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// theta (rad)
    pub angle: f64,
    /// Of theta, for the ripple.
    pub heading: Heading<f64>,
    /// v, constant over the step (rad/s).
    pub speed: f64,
    /// a (rad/s^2)
    pub acceleration: f64,
    /// r*theta (rad)
    pub output: f64,
    /// Of the motor (N m).
    pub torque: f64,
    /// Measured at the output, as the motor bears it (N m); NaN where it is not.
    pub reflected: f64,
    /// Friction of the output as the base gear has it, as the motor bears it (N m).
    pub output_friction: f64,
}

/// Motion over a log.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// All steps.
    pub steps: Vec<Step>,
}

impl Motion {
    /// Of the rows of a log in every control period.
    ///
    /// # Errors
    /// When the log is shorter than what accelerations are taken over, or the output's friction cannot be built.
    pub fn of(gear: &GearFile, rows: &[ReplayRow]) -> Result<Self, Error> {
        let span = (HALF_SPAN / CONTROL_PERIOD) as usize;
        let margin = span + HALF_MEAN + PERIODS;
        let least = 2 * margin + EVERY;
        if rows.len() < least {
            return Err(Error::TooShort { samples: rows.len(), least });
        }
        let motor = mean(rows, |row| row.motor);
        let torque = mean(rows, |row| row.motor_torque);
        let transmitted = mean(rows, |row| row.output_torque.unwrap_or(f64::NAN));
        let ratio = gear.gear.signed_ratio();
        let r: f64 = ratio.value();
        let first = motor(margin);
        let at = |k: usize| {
            let angle = Angle::<f64>::from_radians_f64(motor(k));
            Step {
                angle: motor(k),
                heading: angle.heading(),
                speed: (motor(k) - motor(k - PERIODS)) / STEP,
                acceleration: (motor(k + span) - 2.0 * motor(k) + motor(k - span)) / HALF_SPAN.powi(2),
                output: r * (motor(k) - first),
                torque: torque(k),
                reflected: r * transmitted(k),
                output_friction: 0.0,
            }
        };
        let mut steps: Vec<_> = (margin..rows.len() - margin).step_by(PERIODS).map(at).collect();
        add_output_friction(gear, &mut steps)?;
        Ok(Self { steps })
    }

    /// Every row's last step.
    pub fn rows(&self) -> impl Iterator<Item = &Step> + Clone {
        self.steps.iter().skip(STEPS_A_ROW - 1).step_by(STEPS_A_ROW)
    }

    /// The torque at the output was measured.
    pub fn has_load(&self) -> bool {
        self.steps.iter().all(|step| step.reflected.is_finite())
    }

    /// Revolutions that the motor's angle spans.
    pub fn revolutions(&self) -> f64 {
        let angles = self.steps.iter().map(|step| step.angle);
        let span = angles.clone().fold(f64::MIN, f64::max) - angles.fold(f64::MAX, f64::min);
        span / std::f64::consts::TAU
    }
}

/// Means of a figure about a row.
fn mean(rows: &[ReplayRow], figure: impl Fn(&ReplayRow) -> f64) -> impl Fn(usize) -> f64 {
    // About the first, so that sums of angles of many turns lose no digits.
    let first = figure(&rows[0]);
    let mut sums = vec![0.0];
    for row in rows {
        sums.push(sums[sums.len() - 1] + figure(row) - first);
    }
    move |k| first + (sums[k + HALF_MEAN + 1] - sums[k - HALF_MEAN]) / (2 * HALF_MEAN + 1) as f64
}

fn add_output_friction(gear: &GearFile, steps: &mut [Step]) -> Result<(), Error> {
    let Some(params) = joint_friction_params::<f64>(&gear.friction.output) else { return Ok(()) };
    let (model, mut state) = (params.build()?, JointFrictionState::default());
    let r: f64 = gear.gear.signed_ratio().value();
    for step in steps {
        step.output_friction = r * model.step(&mut state, &Slip::new(r * step.speed, STEP)).force;
    }
    Ok(())
}
