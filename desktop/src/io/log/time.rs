//! Time stamps: checked, reported on, and resampled to the control step's grid.
//!
//! Time must run strictly forwards, for [`LONGEST`] at most. A pause of more than [`GAP_RATIO`] times
//! the median interval and more than [`GAP_LEAST`] is a gap and refused: over shorter ones a value
//! between two stamps t0 <= t <= t1 is the linear
//!
//! ```text
//! x(t) = x0 + (x1 - x0) (t - t0)/(t1 - t0)
//! ```

use super::columns::{Column, row_of};
use crate::io::figure::Figure;

/// Longest log (s).
pub const LONGEST: f64 = 3600.0;
/// A pause is a gap above this many median intervals ...
pub const GAP_RATIO: f64 = 10.0;
/// ... and above this duration (s).
pub const GAP_LEAST: f64 = 0.05;

/// The time column. Stamps may count from 1970.
pub(super) const TIME: Column = Column {
    name: "t_s",
    limit: 1e10,
    other_names: &["t", "time", "time_s", "timestamp", "timestamp_s", "seconds"],
};

/// Strictly increasing time stamps (s) without a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Time(Vec<f64>);

/// The intervals between time stamps (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jitter {
    /// The median, the lower one of an even number.
    pub nominal: f64,
    /// The shortest.
    pub least: f64,
    /// The longest.
    pub most: f64,
}

impl Jitter {
    /// The same as figures `log.interval.*`.
    pub fn figures(&self) -> [Figure; 3] {
        [("nominal", self.nominal), ("min", self.least), ("max", self.most)]
            .map(|(name, value)| Figure::reported(format!("log.interval.{name}"), value, "s"))
    }
}

/// Refuses stamps of a file's rows that do not run strictly forwards.
pub(super) fn require_forwards(stamps: &[f64]) -> Result<(), String> {
    let stands = stamps.windows(2).position(|pair| pair[1] <= pair[0]);
    stands.map_or(Ok(()), |before| {
        let (row, time) = (row_of(before + 1), TIME.name);
        let [earlier, later] = [stamps[before], stamps[before + 1]];
        Err(format!("row {row}, column {time}: time {later} does not come after {earlier}, the row before"))
    })
}

impl Time {
    /// Checks the stamps of a file's rows.
    pub(super) fn check(stamps: Vec<f64>) -> Result<Self, String> {
        let refuse =
            |sample: usize, why: String| Err(format!("row {}, column {}: {why}", row_of(sample), TIME.name));
        require_forwards(&stamps)?;
        if let Some(late) = stamps.iter().position(|stamp| stamp - stamps[0] > LONGEST) {
            return refuse(late, format!("time {} is more than {LONGEST} s from the start", stamps[late]));
        }
        let time = Self(stamps);
        let Some(jitter) = time.jitter() else { return Ok(time) };
        let allowed = (GAP_RATIO * jitter.nominal).max(GAP_LEAST);
        match time.0.windows(2).position(|pair| pair[1] - pair[0] > allowed) {
            None => Ok(time),
            Some(before) => {
                let pause = time.0[before + 1] - time.0[before];
                refuse(
                    before + 1,
                    format!("a gap of {pause:.6} s before this row; allowed: at most {allowed:.6} s"),
                )
            }
        }
    }

    /// `count` stamps every `interval` (s), from 0.
    pub fn every(interval: f64, count: usize) -> Self {
        Self((0..count).map(|k| k as f64 * interval).collect())
    }

    /// Stamps that were checked in parts.
    pub(super) fn from_stamps(stamps: impl Iterator<Item = f64>) -> Self {
        Self(stamps.collect())
    }

    /// The stamps (s).
    pub fn stamps(&self) -> &[f64] {
        &self.0
    }

    /// The intervals; `None` for a single row.
    pub fn jitter(&self) -> Option<Jitter> {
        let mut intervals: Vec<f64> = self.0.windows(2).map(|pair| pair[1] - pair[0]).collect();
        intervals.sort_unstable_by(f64::total_cmp);
        let (least, most) = (*intervals.first()?, *intervals.last()?);
        Some(Jitter { nominal: intervals[(intervals.len() - 1) / 2], least, most })
    }

    /// Instants every `interval` (s) from the first stamp to the last.
    pub fn resampled(&self, interval: f64) -> impl ExactSizeIterator<Item = Instant> {
        let span = self.0[self.0.len() - 1] - self.0[0];
        // A log that ends on the grid keeps its last point, whatever the rounding of its stamps.
        let steps = (span / interval + 1e-3) as usize;
        (0..steps + 1).map(move |step| self.at(step as f64 * interval))
    }

    /// The instant `elapsed` (s) after the first stamp; the ends of the log outside it.
    pub fn at(&self, elapsed: f64) -> Instant {
        let since = |stamp: f64| stamp - self.0[0];
        let after = self.0.partition_point(|stamp| since(*stamp) <= elapsed).min(self.0.len() - 1);
        let before = after.saturating_sub(1);
        let (start, end) = (since(self.0[before]), since(self.0[after]));
        let fraction = if end > start { ((elapsed - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        Instant { elapsed, before, after, fraction }
    }
}

/// One instant of a resampled log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Time since the first stamp (s).
    pub elapsed: f64,
    before: usize,
    after: usize,
    fraction: f64,
}

impl Instant {
    /// The value of a column of the same log at this instant.
    pub fn of(&self, column: &[f64]) -> f64 {
        let (start, end) = (column[self.before], column[self.after]);
        // Rounding may leave the interval by the last digit.
        (start + (end - start) * self.fraction).clamp(start.min(end), start.max(end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use strainwave::compensator::schedule::CONTROL_PERIOD;

    fn time(stamps: &[f64]) -> Time {
        Time::check(stamps.to_vec()).unwrap()
    }

    #[test]
    fn rounding_does_not_leave_the_values_of_the_log() {
        // (end - start) is rounded away from zero here, so that start + (end - start) is not end.
        let column = [426.5851927960378, -986.312159340444, 0.1, 0.3 - 0.1, 1e16, 1.0];
        for pair in column.windows(2) {
            let end = Instant { elapsed: 1.0, before: 0, after: 1, fraction: 1.0 }.of(pair);
            assert!(end >= pair[0].min(pair[1]) && end <= pair[0].max(pair[1]), "{pair:?}: {end}");
        }
    }

    #[test]
    fn resampling_a_line_gives_the_line_whatever_the_jitter() {
        let stamps = [5.0, 5.003, 5.0034, 5.009, 5.0121];
        let line: Vec<f64> = stamps.iter().map(|t| 3.0 - 20.0 * (t - 5.0)).collect();
        let time = time(&stamps);
        let resampled = time.resampled(CONTROL_PERIOD);
        assert_eq!(resampled.len(), 122);
        for (step, instant) in resampled.enumerate() {
            assert!((instant.elapsed - step as f64 * CONTROL_PERIOD).abs() < 1e-12);
            assert!((instant.of(&line) - (3.0 - 20.0 * instant.elapsed)).abs() < 1e-11);
        }
    }

    #[test]
    fn a_log_on_the_grid_is_kept_point_by_point() {
        let stamps: Vec<f64> = (0..5000).map(|k| f64::from(k) * CONTROL_PERIOD).collect();
        let noise: Vec<f64> = (0..5000).map(|k| f64::from(k * 7919 % 1000)).collect();
        let time = time(&stamps);
        let kept: Vec<f64> = time.resampled(CONTROL_PERIOD).map(|instant| instant.of(&noise)).collect();
        assert_eq!(kept.len(), noise.len());
        assert!(kept.iter().zip(&noise).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn one_row_is_one_instant() {
        let time = time(&[7.0]);
        assert_eq!(time.jitter(), None);
        assert_eq!(
            time.resampled(CONTROL_PERIOD).map(|instant| instant.of(&[4.0])).collect::<Vec<_>>(),
            [4.0]
        );
    }

    #[test]
    fn jitter_is_median_and_extremes() {
        let jitter = time(&[0.0, 0.004, 0.0083, 0.0124, 0.0127, 0.0167]).jitter().unwrap();
        assert!((jitter.nominal - 0.004).abs() < 1e-9);
        assert!((jitter.least - 0.0003).abs() < 1e-9 && (jitter.most - 0.0043).abs() < 1e-9);
    }

    #[test]
    fn a_gap_is_long_in_both_senses() {
        let regular: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.001).collect();
        let with_pause = |pause: f64| {
            let resumed = regular.iter().map(|t| t + 0.099 + pause);
            Time::check(regular.iter().copied().chain(resumed).collect())
        };
        // 20 median intervals, but short.
        assert!(with_pause(0.02).is_ok());
        let why = with_pause(0.06).unwrap_err();
        assert_eq!(
            why,
            "row 102, column t_s: a gap of 0.060000 s before this row; allowed: at most 0.050000 s"
        );
        // A tenth of a second is an ordinary interval of a slow log.
        assert!(Time::check(vec![0.0, 0.1, 0.2, 0.9]).is_ok());
        assert!(Time::check(vec![0.0, 0.1, 0.2, 1.3]).is_err());
    }

    #[test]
    fn time_runs_forwards_and_not_for_ever() {
        let why = Time::check(vec![0.0, 0.2, 0.1]).unwrap_err();
        assert_eq!(why, "row 4, column t_s: time 0.1 does not come after 0.2, the row before");
        assert!(Time::check(vec![1.0, 1.0]).is_err());
        assert!(Time::check(vec![0.0, 3601.0]).unwrap_err().contains("more than 3600 s"));
    }
}
