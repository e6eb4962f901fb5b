//! A factor on the stiffness line from a held joint's logs, the hysteresis of the base gear kept.
//!
//! ```text
//! min  sum of (theta_measured - c - phi[m, tau; s])^2/NOISE^2 + ((s - 1)/DEVIATION)^2        LIMITS[0] <= s <= LIMITS[1]
//! ```
//!
//! phi (rad) is the inverse of the gear's own law along the measured torque tau (N m), s its stretch: K1, K2 and K3 are
//! divided by it. c and m start each log ([`Start`]); both are renewed at every step. Gauss and Newton's steps
//! in s alone: c is linear, which takes the mean off each log's derivatives.
//!
//! What the model misses is alike along a log, so that rows close in time are one witness: NOISE is [`LEFT`] times the root
//! of the rows in twice [`ALIKE`].

use super::Error;
use super::gear_log::GearLog;
use super::law::{Law, OnLaw};
use super::start::Start;
use crate::design::joint::gear_params;
use crate::io::gear_file::GearFile;
use strainwave::hysteresis::table::TABLE_LEVELS;

/// Standard deviation of the prior of s, the catalogue's stiffness over a joint's.
const DEVIATION: f64 = 0.3;
/// Range of s: beyond it the base gear is not of the joint's kind.
pub const LIMITS: [f64; 2] = [0.1, 5.0];
/// Part of a torsion that the model misses (rad): the size of the orders of a kinematic error.
const LEFT: f64 = 2e-5;
/// Time over which that is alike (s): a period of an arm's sway.
const ALIKE: f64 = 0.2;
/// Most steps.
const STEPS: usize = 30;
/// The steps end when s changes by less.
const SETTLED: f64 = 1e-9;

/// s, with its standard error, and the start of each log.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// s
    pub factor: f64,
    /// Standard error of s.
    pub deviation: f64,
    /// c and m of each log.
    pub starts: Vec<Start>,
}

impl Line {
    /// From the first `training` rows of each log.
    ///
    /// # Errors
    /// As [`Law::of`].
    pub fn identify(base: &GearFile, logs: &[GearLog], training: &[usize]) -> Result<Self, Error> {
        let mut law = Law::<TABLE_LEVELS>::of(&gear_params(base))?;
        for _ in 0..STEPS {
            let Step { change, .. } = Step::of(&law, base, logs, training);
            let [least, most] = LIMITS;
            // A step that halves or doubles the stiffness goes too far for what is linear around here.
            let next = (law.factor + change).clamp(0.5 * law.factor, 2.0 * law.factor).clamp(least, most);
            let settled = (next - law.factor).abs() < SETTLED;
            law.factor = next;
            if settled {
                break;
            }
        }
        let Step { deviation, starts, .. } = Step::of(&law, base, logs, training);
        Ok(Self { factor: law.factor, deviation, starts })
    }
}

/// A step of s from a law.
struct Step {
    change: f64,
    /// Standard error of s.
    deviation: f64,
    starts: Vec<Start>,
}

impl Step {
    fn of(law: &Law<TABLE_LEVELS>, base: &GearFile, logs: &[GearLog], training: &[usize]) -> Self {
        let prior = DEVIATION.powi(-2);
        let (mut gradient, mut information) = ((1.0 - law.factor) * prior, prior);
        let mut starts = Vec::new();
        for (log, count) in logs.iter().zip(training) {
            let start = Start::of(law, log, *count, base.gear.rated_torque);
            let on = law.torsions_after(start.extreme_torque, &log.torque[..*count]);
            let derivatives: Vec<_> = on.iter().map(|on| by_factor(on, law.factor)).collect();
            let mean = derivatives.iter().sum::<f64>() / *count as f64;
            let weight = weight(log.interval());
            for ((derivative, predicted), measured) in
                derivatives.iter().zip(start.predicted(&on)).zip(&log.torsion)
            {
                gradient += weight * (derivative - mean) * (measured - predicted);
                information += weight * (derivative - mean).powi(2);
            }
            starts.push(start);
        }
        Self { change: gradient / information, deviation: information.recip().sqrt(), starts }
    }
}

/// 1/NOISE^2 of rows every `interval` (s).
pub(super) fn weight(interval: f64) -> f64 {
    (LEFT * (2.0 * ALIKE / interval).sqrt().max(1.0)).powi(-2)
}

/// dphi/ds at a torque.
fn by_factor(on: &OnLaw, factor: f64) -> f64 {
    on.line_stiffness * on.torsion / on.stiffness / factor
}
