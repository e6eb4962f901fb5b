//! Errors of the estimates, and how often they exceed three of their declared standard deviations.
//!
//! They are judged in the slots of the observer. Motion is estimated at the time of the reading;
//! torsion, torques and friction are those of its slot before, and so is the load that acted.

use strainwave::compensator::Estimate;
use strainwave::compensator::schedule::OBSERVER_PERIODS;

use crate::bench::closed_loop::Row;

/// Control periods from one slot of the observer to the next.
const SLOT: usize = OBSERVER_PERIODS as usize;

/// Deviations within which an estimate is to be.
const WITHIN: f64 = 3.0;

/// One of the estimates.
#[derive(Clone, Copy, Debug)]
pub struct Estimated {
    /// For people.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    estimate: fn(&Estimate<f32>) -> f64,
    deviation: fn(&Estimate<f32>) -> f32,
    truth: fn(&Row) -> f64,
    /// It is that of the slot before.
    before: bool,
}

/// Number of estimates.
pub const ESTIMATES: usize = 7;

/// All of them.
pub const ALL: [Estimated; ESTIMATES] = [
    Estimated {
        name: "output",
        unit: "rad",
        estimate: |estimate| estimate.output_position.to_radians(),
        deviation: |estimate| estimate.deviation.output_position,
        truth: |row| row.output,
        before: false,
    },
    Estimated {
        name: "output velocity",
        unit: "rad/s",
        estimate: |estimate| estimate.output_velocity.into(),
        deviation: |estimate| estimate.deviation.output_velocity,
        truth: |row| row.output_velocity,
        before: false,
    },
    Estimated {
        name: "torsion",
        unit: "rad",
        estimate: |estimate| estimate.torsion.into(),
        deviation: |estimate| estimate.deviation.torsion,
        truth: |row| row.torsion,
        before: true,
    },
    Estimated {
        name: "transmitted torque",
        unit: "N m",
        estimate: |estimate| estimate.transmitted_torque.into(),
        deviation: |estimate| estimate.deviation.transmitted_torque,
        truth: |row| row.transmitted,
        before: true,
    },
    Estimated {
        name: "friction at the wave generator",
        unit: "N m",
        estimate: |estimate| estimate.input_friction.into(),
        deviation: |estimate| estimate.deviation.input_friction,
        truth: |row| row.friction[0],
        before: true,
    },
    Estimated {
        name: "friction at the output",
        unit: "N m",
        estimate: |estimate| estimate.output_friction.into(),
        deviation: |estimate| estimate.deviation.output_friction,
        truth: |row| row.friction[1],
        before: true,
    },
    Estimated {
        name: "external torque",
        unit: "N m",
        estimate: |estimate| estimate.external_torque.into(),
        deviation: |estimate| estimate.deviation.external_torque,
        truth: |row| row.demand.load,
        before: true,
    },
];

impl Estimated {
    /// Estimate less truth, in the unit, of the rows of two slots that follow each other.
    pub fn error(&self, [before, now]: [&Row; 2]) -> f64 {
        (self.estimate)(&now.answer.estimate) - (self.truth)(if self.before { before } else { now })
    }

    /// Its standard deviation as stated, in the unit.
    pub fn deviation(&self, row: &Row) -> f64 {
        (self.deviation)(&row.answer.estimate).into()
    }

    fn is_outside(&self, before: &Row, now: &Row) -> bool {
        let inside = self.error([before, now]).abs() <= WITHIN * self.deviation(now);
        !inside
    }
}

/// Number of slots in which each estimate was outside, of the number of slots.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outside {
    times: [usize; ESTIMATES],
    periods: usize,
}

impl Outside {
    /// Counts rows of control periods that follow each other.
    pub fn count(&mut self, rows: &[Row]) {
        let evaluated = rows.windows(SLOT + 1).filter(|rows| rows[SLOT].answer.observed);
        for rows in evaluated.clone() {
            for (times, estimated) in self.times.iter_mut().zip(&ALL) {
                *times += usize::from(estimated.is_outside(&rows[0], &rows[SLOT]));
            }
        }
        self.periods += evaluated.count();
    }

    /// Largest fraction of the slots in which an estimate was outside; NaN without slots.
    pub fn worst_fraction(&self) -> f64 {
        let most = self.times.iter().copied().max().unwrap_or_default();
        most as f64 / self.periods as f64
    }
}

#[cfg(test)]
mod tests {
    use strainwave::Angle;

    use super::*;

    /// A row whose estimates have an error of `off` deviations of one.
    fn row(difference: f64) -> Row {
        let mut row =
            Row { output: 0.3, output_velocity: 2.0, torsion: 1e-3, transmitted: 20.0, ..Row::default() };
        row.friction = [0.05, 1.0];
        row.demand.load = 30.0;
        row.answer.observed = true;
        let estimate = &mut row.answer.estimate;
        estimate.output_position = Angle::from_radians_f64(0.3 + difference);
        for (value, truth) in [
            (&mut estimate.output_velocity, 2.0),
            (&mut estimate.torsion, 1e-3),
            (&mut estimate.transmitted_torque, 20.0),
            (&mut estimate.input_friction, 0.05),
            (&mut estimate.output_friction, 1.0),
            (&mut estimate.external_torque, 30.0),
        ] {
            *value = (truth + difference) as f32;
        }
        let deviation = &mut estimate.deviation;
        for value in [
            &mut deviation.output_position,
            &mut deviation.output_velocity,
            &mut deviation.torsion,
            &mut deviation.transmitted_torque,
            &mut deviation.input_friction,
            &mut deviation.output_friction,
            &mut deviation.external_torque,
        ] {
            *value = 1.0;
        }
        row
    }

    fn worst_fraction(rows: &[Row]) -> f64 {
        let mut outside = Outside::default();
        outside.count(rows);
        outside.worst_fraction()
    }

    #[test]
    fn three_deviations_are_inside_and_more_are_not() {
        assert_eq!(worst_fraction(&[row(0.0), row(0.0), row(2.9), row(-2.9)]), 0.0);
        let rows = [row(0.0), row(0.0), row(3.1), row(-3.1), row(0.0), row(0.0)];
        assert_eq!(worst_fraction(&rows), 0.5);
        assert!(worst_fraction(&[]).is_nan() && worst_fraction(&[row(0.0), row(0.0), row(f64::NAN)]) == 1.0);
    }

    #[test]
    fn what_was_not_observed_in_a_period_is_not_judged_in_it() {
        let mut held = row(9.0);
        held.answer.observed = false;
        assert_eq!(worst_fraction(&[row(0.0), held, row(0.0), held, row(3.1)]), 0.5);
    }

    /// One estimate with a large error is not hidden by six without.
    #[test]
    fn the_worst_estimate_counts() {
        let mut difference = row(0.0);
        difference.answer.estimate.external_torque += 10.0;
        assert_eq!(worst_fraction(&[row(0.0), row(0.0), difference, row(0.0)]), 0.5);
    }
}
