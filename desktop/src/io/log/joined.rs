//! Two logs of one joint, recorded one after the other, as one.
//!
//! Between the last row of the first and the first row of the second nothing was recorded. Where the time stamps go on within
//! [`PAUSE`] T both have one clock, and that is the time between; else it is T. In it the motor is led from the one to the
//! other by Hermite's cubic through both angles and speeds, and torques and output angle linearly.

use super::measured::MeasuredLog;
use super::time::Time;

/// T (s): some periods of any joint's torsion mode.
const PAUSE: f64 = 0.5;
/// Longest interval of the rows in between (s).
const INTERVAL: f64 = 0.004;
/// Time over which the speed at an end is averaged (s).
const END: f64 = 0.02;
/// Farthest that the motor may have moved unrecorded (rad).
const FARTHEST: f64 = std::f64::consts::TAU;

impl MeasuredLog {
    /// This log and the one after it, with the count of rows before the latter's first.
    ///
    /// # Errors
    /// One line: the motor is more than a revolution away from where this log ends, or one log lacks a sensor of the other.
    pub fn followed_by(&self, next: &Self) -> Result<(Self, usize), String> {
        let (last, first) = (self.motor_position[self.motor_position.len() - 1], next.motor_position[0]);
        let way = (first - last).abs();
        if way > FARTHEST {
            return Err(format!(
                "column theta_motor_rad: ends at {last} rad, {way:.3} rad from the first row of the log that it is to warm up \
                 for; allowed: at most {FARTHEST:.3} rad"
            ));
        }
        let bridge = Bridge::between(self, next);
        let optional = |name: &str, ends: [&Option<Vec<f64>>; 2]| match ends {
            [Some(before), Some(after)] => Ok(Some(bridge.linear(before, after))),
            [None, None] => Ok(None),
            _ => Err(format!("column {name}: in one of the two logs only")),
        };
        let joined = Self {
            time: bridge.time(&self.time, &next.time),
            motor_position: bridge.cubic(&self.motor_position, &next.motor_position, speeds(self, next)),
            motor_torque: bridge.linear(&self.motor_torque, &next.motor_torque),
            output_position: optional("theta_out_rad", [&self.output_position, &next.output_position])?,
            output_torque: optional("tau_out_nm", [&self.output_torque, &next.output_torque])?,
            model_torque: optional("tau_model_nm", [&self.model_torque, &next.model_torque])?,
        };
        Ok((joined, self.motor_position.len() + bridge.inner.len()))
    }
}

/// Speed of the motor at the end of the one and at the start of the other (rad/s).
fn speeds(log: &MeasuredLog, next: &MeasuredLog) -> [f64; 2] {
    let span = |log: &MeasuredLog| log.time.stamps()[log.time.stamps().len() - 1] - log.time.stamps()[0];
    let speed = |log: &MeasuredLog, from: f64| {
        let angle = |time| log.time.at(time).of(&log.motor_position);
        (angle(from + END) - angle(from)) / END
    };
    [speed(log, (span(log) - END).max(0.0)), speed(next, 0.0)]
}

/// The rows between two logs.
struct Bridge {
    /// Time from the last row before to the first row after (s).
    pause: f64,
    /// Fractions of the pause at which they are, 0 and 1 left out.
    inner: Vec<f64>,
}

impl Bridge {
    fn between(log: &MeasuredLog, next: &MeasuredLog) -> Self {
        let intervals = [log, next].map(|log| log.time.jitter().map_or(INTERVAL, |jitter| jitter.nominal));
        let gap = next.time.stamps()[0] - log.time.stamps()[log.time.stamps().len() - 1];
        let pause = if gap > 0.0 && gap <= PAUSE { gap } else { PAUSE };
        let rows = (pause / intervals[0].min(intervals[1]).min(INTERVAL)).round();
        Self { pause, inner: (1..rows as usize).map(|row| row as f64 / rows).collect() }
    }

    fn time(&self, before: &Time, after: &Time) -> Time {
        let (before, after) = (before.stamps(), after.stamps());
        let last = before[before.len() - 1] - before[0];
        let elapsed = before.iter().map(|stamp| stamp - before[0]);
        let inner = self.inner.iter().map(|x| last + x * self.pause);
        Time::from_stamps(
            elapsed.chain(inner).chain(after.iter().map(|stamp| last + self.pause + stamp - after[0])),
        )
    }

    fn joined(&self, before: &[f64], after: &[f64], between: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
        let (start, end) = (before[before.len() - 1], after[0]);
        let inner = self.inner.iter().map(|x| between(start, end, *x));
        before.iter().copied().chain(inner).chain(after.iter().copied()).collect()
    }

    fn linear(&self, before: &[f64], after: &[f64]) -> Vec<f64> {
        self.joined(before, after, |start, end, x| start + (end - start) * x)
    }

    fn cubic(&self, before: &[f64], after: &[f64], speeds: [f64; 2]) -> Vec<f64> {
        let [leaving, arriving] = speeds.map(|speed| speed * self.pause);
        self.joined(before, after, |start, end, x| {
            let rise = end - start;
            let (square, cube) = (3.0 * rise - 2.0 * leaving - arriving, leaving + arriving - 2.0 * rise);
            start + x * (leaving + x * (square + x * cube))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(first: f64, speed: f64) -> MeasuredLog {
        let time = Time::every(0.01, 50);
        MeasuredLog {
            motor_position: time.stamps().iter().map(|t| first + speed * t).collect(),
            motor_torque: vec![speed; 50],
            output_position: None,
            output_torque: None,
            model_torque: None,
            time,
        }
    }

    #[test]
    fn the_motor_goes_on_without_a_step_of_its_speed() {
        let (joined, first) = log(0.0, 2.0).followed_by(&log(1.5, -1.0)).unwrap();
        assert_eq!((joined.motor_position[first], joined.motor_torque[first]), (1.5, -1.0));
        assert!((joined.time.stamps()[first] - 0.49 - PAUSE).abs() < 1e-12);
        let slopes: Vec<_> = joined
            .motor_position
            .windows(2)
            .zip(joined.time.stamps().windows(2))
            .map(|(angle, time)| (angle[1] - angle[0]) / (time[1] - time[0]))
            .collect();
        assert!(slopes.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.3), "{slopes:?}");
    }

    /// A log that was cut in two is whole again.
    #[test]
    fn one_clock_goes_on() {
        let mut next = log(0.98 + 0.02, 2.0);
        next.time = Time::from_stamps((50..100).map(|k| f64::from(k) * 0.01));
        let (joined, first) = log(0.0, 2.0).followed_by(&next).unwrap();
        let whole = Time::every(0.01, 100);
        assert_eq!((first, joined.time.stamps().len()), (52, 102));
        let expected = |time: f64| 2.0 * time;
        assert!(
            joined
                .time
                .stamps()
                .iter()
                .zip(&joined.motor_position)
                .all(|(t, a)| (a - expected(*t)).abs() < 1e-9)
        );
        assert!((joined.time.stamps()[101] - whole.stamps()[99]).abs() < 1e-9);
    }

    #[test]
    fn a_log_of_another_place_or_other_sensors_is_refused() {
        let far = log(0.0, 2.0).followed_by(&log(9.0, 2.0)).unwrap_err();
        assert!(
            far.starts_with("column theta_motor_rad: ends at 0.98 rad, 8.020 rad from the first row"),
            "{far}"
        );
        let with_output = MeasuredLog { output_position: Some(vec![0.0; 50]), ..log(1.0, 2.0) };
        let line = log(0.0, 2.0).followed_by(&with_output).unwrap_err();
        assert_eq!(line, "column theta_out_rad: in one of the two logs only");
    }
}
