//! The wave generator's motion between the rows of a log.
//!
//! - `omega_wg_rad_s`: linear between stamps; the angle is its integral, from 0 at the first row.
//! - `theta_wg_rad`: a cubic between stamps with the monotone slopes of F. Fritsch and J. Butland
//!   (A method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat.
//!   Comput. 5, 1984): the speed is continuous, and a step does not overshoot.
//!
//! Angles count from the first row's, so that they stay exact however large that is. (rad), (s).

use crate::io::log::Drive;

/// Angle of the wave generator with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// Angle from the first row's (rad).
    pub angle: f64,
    /// (rad/s)
    pub velocity: f64,
    /// (rad/s^2)
    pub acceleration: f64,
}

/// Angle and speed at every stamp.
#[derive(Debug)]
pub(crate) struct Trajectory {
    /// From the first stamp (s).
    time: Vec<f64>,
    angle: Vec<f64>,
    velocity: Vec<f64>,
    cubic: bool,
}

impl Trajectory {
    pub fn new(stamps: &[f64], drive: &Drive) -> Self {
        let time: Vec<f64> = stamps.iter().map(|stamp| stamp - stamps[0]).collect();
        match drive {
            Drive::Position(position) => {
                let angle: Vec<f64> = position.iter().map(|angle| angle - position[0]).collect();
                let velocity = monotone_slopes(&time, &angle);
                Self { time, angle, velocity, cubic: true }
            }
            Drive::Velocity(velocity) => {
                let angle = integral(&time, velocity);
                Self { time, angle, velocity: velocity.clone(), cubic: false }
            }
        }
    }

    /// The motion `elapsed` after the first stamp; at constant speed before it, beyond the last as there.
    pub fn at(&self, elapsed: f64) -> Sample {
        if elapsed < 0.0 {
            return Sample {
                angle: self.velocity[0] * elapsed,
                velocity: self.velocity[0],
                acceleration: 0.0,
            };
        }
        let after = self.time.partition_point(|stamp| *stamp <= elapsed).min(self.time.len() - 1);
        let Some(before) = after.checked_sub(1) else {
            return Sample { angle: self.angle[0], velocity: self.velocity[0], acceleration: 0.0 };
        };
        let span = self.time[after] - self.time[before];
        let passed = (elapsed - self.time[before]).min(span);
        if self.cubic { self.cubic(before, span, passed / span) } else { self.ramp(before, span, passed) }
    }

    /// Constant acceleration between two speeds.
    fn ramp(&self, before: usize, span: f64, passed: f64) -> Sample {
        let start = self.velocity[before];
        let acceleration = (self.velocity[before + 1] - start) / span;
        Sample {
            angle: self.angle[before] + passed * (start + 0.5 * acceleration * passed),
            velocity: start + acceleration * passed,
            acceleration,
        }
    }

    /// Hermite's cubic, x from 0 to 1.
    fn cubic(&self, before: usize, span: f64, x: f64) -> Sample {
        let rise = self.angle[before + 1] - self.angle[before];
        let (start, end) = (self.velocity[before] * span, self.velocity[before + 1] * span);
        let (square, cube) = (3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise);
        Sample {
            angle: self.angle[before] + x * (start + x * (square + x * cube)),
            velocity: (start + x * (2.0 * square + 3.0 * x * cube)) / span,
            acceleration: (2.0 * square + 6.0 * x * cube) / (span * span),
        }
    }
}

/// Trapezoids: exact for a speed that is linear between stamps.
fn integral(time: &[f64], velocity: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = time.windows(2).zip(velocity.windows(2)).map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0]));
    let ends = steps.map(|step| {
        sum += step;
        sum
    });
    std::iter::once(0.0).chain(ends).collect()
}

/// At a turning point 0, else the weighted harmonic mean of the slopes on both sides; at the ends the
/// slope of the only neighbour.
fn monotone_slopes(time: &[f64], angle: &[f64]) -> Vec<f64> {
    let spans: Vec<f64> = time.windows(2).map(|t| t[1] - t[0]).collect();
    let slopes: Vec<f64> = angle.windows(2).zip(&spans).map(|(a, span)| (a[1] - a[0]) / span).collect();
    let (Some(first), Some(last)) = (slopes.first(), slopes.last()) else { return vec![0.0; time.len()] };
    let inner = slopes.windows(2).zip(spans.windows(2)).map(|(slope, span)| {
        if slope[0] * slope[1] <= 0.0 {
            return 0.0;
        }
        let (left, right) = (span[0] + 2.0 * span[1], 2.0 * span[0] + span[1]);
        // The longer side weighs less: its slope tells less about this stamp.
        (left + right) / (right / slope[0] + left / slope[1])
    });
    std::iter::once(*first).chain(inner).chain([*last]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps() -> Vec<f64> {
        (0..400).map(|k| 3.0 + 0.004 * f64::from(k) + 0.001 * (f64::from(k) * 1.7).sin()).collect()
    }

    #[test]
    fn both_kinds_of_file_give_the_motion_that_they_sample() {
        let time = stamps();
        let motion = |t: f64| (5.0 * (2.0 * t).sin(), 10.0 * (2.0 * t).cos());
        let position = Drive::Position(time.iter().map(|t| motion(*t).0).collect());
        let velocity = Drive::Velocity(time.iter().map(|t| motion(*t).1).collect());
        for (drive, tolerance) in [(position, (5e-4, 0.1)), (velocity, (1e-4, 1e-3))] {
            let trajectory = Trajectory::new(&time, &drive);
            for k in 0..15_000 {
                let elapsed = 1e-4 * f64::from(k);
                let (angle, velocity) = motion(time[0] + elapsed);
                let sample = trajectory.at(elapsed);
                assert!((sample.angle - (angle - motion(time[0]).0)).abs() < tolerance.0, "{k} {sample:?}");
                assert!((sample.velocity - velocity).abs() < tolerance.1, "{k} {sample:?} {velocity}");
            }
        }
    }

    #[test]
    fn angle_speed_and_acceleration_are_derivatives_of_each_other() {
        let time = stamps();
        let wild: Vec<f64> = (0..400).map(|k| f64::from(k * 7919 % 101)).collect();
        for drive in [Drive::Position(wild.clone()), Drive::Velocity(wild)] {
            let trajectory = Trajectory::new(&time, &drive);
            let h = 1e-7;
            for k in 1..1000 {
                let elapsed = 1.57 * f64::from(k) / 1000.0;
                let [before, now, after] = [elapsed - h, elapsed, elapsed + h].map(|t| trajectory.at(t));
                let velocity = (after.angle - before.angle) / (2.0 * h);
                assert!(
                    (velocity - now.velocity).abs() < 1e-2 * (1.0 + now.velocity.abs()),
                    "{velocity} {now:?}"
                );
                // Across a stamp the acceleration may jump; the mean of both sides is the difference quotient.
                let acceleration = (after.velocity - before.velocity) / (2.0 * h);
                let (least, most) = (
                    before.acceleration.min(after.acceleration),
                    before.acceleration.max(after.acceleration),
                );
                let slack = 1e-3 * (1.0 + most.abs().max(least.abs()));
                assert!(
                    (least - slack..=most + slack).contains(&acceleration),
                    "{acceleration} {before:?} {after:?}"
                );
            }
        }
    }

    #[test]
    fn a_step_does_not_overshoot() {
        let time: Vec<f64> = (0..10).map(f64::from).collect();
        let step: Vec<f64> = (0..10).map(|k| if k < 5 { 1e8 } else { 1e8 + 1.0 }).collect();
        let trajectory = Trajectory::new(&time, &Drive::Position(step));
        let angles: Vec<f64> = (0..1000).map(|k| trajectory.at(0.01 * f64::from(k)).angle).collect();
        assert!(angles.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!((angles[0], angles[999]), (0.0, 1.0));
    }

    #[test]
    fn one_row_stands_still_or_runs_on() {
        let still = Trajectory::new(&[2.0], &Drive::Position(vec![7.0]));
        assert_eq!(still.at(0.0), Sample { angle: 0.0, velocity: 0.0, acceleration: 0.0 });
        let runs = Trajectory::new(&[2.0], &Drive::Velocity(vec![7.0]));
        assert_eq!(runs.at(0.0).velocity, 7.0);
        assert_eq!(runs.at(-0.5), Sample { angle: -3.5, velocity: 7.0, acceleration: 0.0 });
    }
}
