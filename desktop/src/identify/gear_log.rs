//! A measured log as torque and torsion of a held joint.
//!
//! ```text
//! torsion + c = r*theta_motor - theta_out
//! ```
//!
//! Both angles count from arbitrary zeros: c (rad) is unknown. The log is resampled to the median interval of its time
//! stamps, a long one to fewer samples.

use super::Error;
use super::reversal::travel;
use super::sequence::{LEAST_SAMPLES, require_reversal, span};
use crate::io::gear_file::GearFile;
use crate::io::log::MeasuredLog;

/// Most that the motor may turn (rad): the gear's wind-up at its shaft, up to rated torque, where the kinematic error
/// hardly changes.
const MOST_TRAVEL: f64 = 0.5;
/// Most samples of a log.
const MOST_SAMPLES: f64 = 20_000.0;
/// Fraction of the torque's span below which a way back is noise.
const NOISE: f64 = 0.02;
/// Fraction of its span that the torque must go back to show the hysteresis.
const LOOPING: f64 = 1.0 / 3.0;

/// Torque and torsion at equal intervals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GearLog {
    /// Time from the first stamp (s).
    pub time: Vec<f64>,
    /// tau (N m).
    pub torque: Vec<f64>,
    /// r*theta_motor - theta_out (rad).
    pub torsion: Vec<f64>,
    /// Span of the motor's angle (rad).
    pub motor_travel: f64,
}

impl GearLog {
    /// From a measured log; `None` when it lacks the output's angle or torque.
    pub fn of(log: &MeasuredLog, gear: &GearFile) -> Option<Self> {
        let (output, torque) = (log.output_position.as_ref()?, log.output_torque.as_ref()?);
        let ratio: f64 = gear.gear.signed_ratio().value();
        let (stamps, motor) = (log.time.stamps(), &log.motor_position);
        let shortest = (stamps[stamps.len() - 1] - stamps[0]) / MOST_SAMPLES;
        let interval = log.time.jitter().map_or(1.0, |jitter| jitter.nominal).max(shortest);
        let mut found = Self { motor_travel: span(motor), ..Self::default() };
        for instant in log.time.resampled(interval) {
            found.time.push(instant.elapsed);
            found.torque.push(instant.of(torque));
            found.torsion.push(ratio * (instant.of(motor) - motor[0]) - instant.of(output));
        }
        Some(found)
    }

    /// The torque of the first `count` samples goes both ways, far enough to show a loop. Where it does not, the one branch that is
    /// seen is a line as well as a hysteresis.
    pub(super) fn loops(&self, count: usize) -> bool {
        let torque = &self.torque[..count];
        let span = span(torque);
        let [up, down] = travel(torque, NOISE * span);
        up.min(down) > LOOPING * span
    }

    /// From sample to sample (s).
    pub(super) fn interval(&self) -> f64 {
        self.time.get(1).map_or(1.0, |second| second - self.time[0])
    }

    /// Samples that train, of the chosen fraction.
    ///
    /// # Errors
    /// [`Error`] when they are too few, their torque never reverses, or the joint was not held.
    pub fn training(&self, fraction: f64) -> Result<usize, Error> {
        let count = (self.torque.len() as f64 * fraction) as usize;
        if count < LEAST_SAMPLES {
            let least = (LEAST_SAMPLES as f64 / fraction).ceil() as usize;
            return Err(Error::TooShort { samples: self.torque.len(), least });
        }
        if self.motor_travel > MOST_TRAVEL {
            return Err(Error::NotHeld { travel: self.motor_travel, most: MOST_TRAVEL });
        }
        require_reversal("torque", &self.torque[..count])?;
        Ok(count)
    }
}
