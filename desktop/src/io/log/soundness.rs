//! What is wrong with a measured log whose every number is right by itself.
//!
//! | refused | where |
//! | --- | --- |
//! | too few rows | less than [`LEAST_ROWS`] |
//! | no motion | neither the motor's nor the output's angle changes |
//! | a jump | a step of an angle larger than both of its neighbours' together by more than the joint can accelerate (motor) or wind up (output) in an interval, or faster than twice the motor's speed limit |
//! | an encoder that stands, saturated or lost | over [`HELD_ROWS`] rows one angle stays while the other changes by more than the gear can wind up |
//! | a clipped torque | over [`HELD_ROWS`] rows in motion the motor torque stays exactly at its largest magnitude, in a log of more than [`FINE`] different torques |
//!
//! The wind-up is that of four times the peak torque at K1. A motion in one direction only limits what can be identified.

use std::ops::RangeInclusive;

use super::columns::row_of;
use super::measured::{MOTOR_POSITION, MOTOR_TORQUE, MeasuredLog, OUTPUT_POSITION};
use crate::io::gear_file::GearFile;

/// Least rows.
const LEAST_ROWS: usize = 20;
/// Rows over which a value that never changes is not measured any more.
const HELD_ROWS: usize = 10;
/// Different torques from which on equal ones are no rounding.
const FINE: usize = 50;
/// Motion of the motor in which a torque changes (rad).
const MOVING: f64 = 1e-3;
/// Fraction of the path that has to be in the other direction.
pub(crate) const BOTH_DIRECTIONS: f64 = 0.02;
/// Wind-up that a gear never reaches, over that of its peak torque at K1.
const WIND_UP: f64 = 4.0;
/// Room of speed and acceleration beyond the motor's limits.
const ROOM: [f64; 2] = [2.0, 3.0];

impl MeasuredLog {
    /// The log can be of the joint of this gear file.
    ///
    /// # Errors
    /// One line that names row and column.
    pub fn require_sound(&self, gear: &GearFile) -> Result<(), String> {
        let rows = self.motor_position.len();
        if rows < LEAST_ROWS {
            return Err(format!("{rows} rows; allowed: at least {LEAST_ROWS}"));
        }
        let moves = |column: &[f64]| column.iter().any(|value| *value != column[0]);
        if !moves(&self.motor_position) && !self.output_position.as_deref().is_some_and(moves) {
            let name = MOTOR_POSITION.name;
            return Err(format!("rows {} to {}, column {name}: no motion", row_of(0), row_of(rows - 1)));
        }
        let n = f64::from(gear.gear.ratio);
        let wind_up = WIND_UP * gear.gear.peak_torque / gear.stiffness.k1;
        let interval = self.time.jitter().map_or(0.0, |jitter| jitter.nominal);
        let fastest = ROOM[0] * gear.motor.rotor_speed_limit;
        let acceleration = ROOM[1] * gear.motor.peak_torque / gear.inertia.wave_generator;
        self.no_jump(MOTOR_POSITION.name, &self.motor_position, acceleration * interval * interval, fastest)?;
        if let Some(output) = &self.output_position {
            self.no_jump(OUTPUT_POSITION.name, output, wind_up, f64::INFINITY)?;
            standing(OUTPUT_POSITION.name, output, &self.motor_position, n * wind_up)?;
            standing(MOTOR_POSITION.name, &self.motor_position, output, wind_up)?;
        }
        self.unclipped()
    }

    /// What limits the use of a sound log, a line each.
    pub fn limits(&self) -> Vec<String> {
        let steps = || self.motor_position.windows(2).map(|pair| pair[1] - pair[0]);
        let path = |sign: f64| steps().map(|step| (sign * step).max(0.0)).sum::<f64>();
        let [forward, backward] = [1.0, -1.0].map(path);
        let one_way = forward.min(backward) < BOTH_DIRECTIONS * (forward + backward);
        let line = format!(
            "column {}: moves in one direction only; friction of the other and hysteresis do not show",
            MOTOR_POSITION.name
        );
        one_way.then_some(line).into_iter().collect()
    }

    /// `allowance` is what a step may be longer than its neighbours together (rad).
    fn no_jump(&self, name: &str, angle: &[f64], allowance: f64, fastest: f64) -> Result<(), String> {
        let interval = self.time.jitter().map_or(0.0, |jitter| jitter.nominal);
        let stamps = self.time.stamps();
        let step = |k: usize| if k + 1 < angle.len() { (angle[k + 1] - angle[k]).abs() } else { 0.0 };
        for k in 0..angle.len() - 1 {
            let around = if k == 0 { 0.0 } else { step(k - 1) } + step(k + 1);
            // Time stamps of some logs jitter by more than an interval.
            let time = (stamps[k + 1] - stamps[k]).max(interval);
            let most = (around + allowance).min(fastest * time);
            if step(k) > most {
                let row = row_of(k + 1);
                return Err(format!(
                    "row {row}, column {name}: jumps by {:.4} rad in {time:.6} s; allowed: at most {most:.4} rad",
                    step(k)
                ));
            }
        }
        Ok(())
    }

    fn unclipped(&self) -> Result<(), String> {
        let torque = &self.motor_torque;
        let most = torque.iter().fold(0.0, |most: f64, torque| torque.abs().max(most));
        let mut different: Vec<_> = torque.iter().map(|torque| torque.to_bits()).collect();
        different.sort_unstable();
        different.dedup();
        if different.len() <= FINE {
            return Ok(());
        }
        let moving = |rows: &RangeInclusive<usize>| span(&self.motor_position[rows.clone()]) > MOVING;
        match runs(torque).find(|rows| torque[*rows.start()].abs() == most && moving(rows)) {
            None => Ok(()),
            Some(rows) => Err(format!(
                "{}, column {}: stays at {} N m, its largest magnitude, in motion: clipped",
                shown(&rows),
                MOTOR_TORQUE.name,
                torque[*rows.start()]
            )),
        }
    }
}

/// Refuses an angle that stays while the other one changes by more than `most` (rad).
fn standing(name: &str, angle: &[f64], other: &[f64], most: f64) -> Result<(), String> {
    let found = runs(angle).map(|rows| (span(&other[rows.clone()]), rows)).find(|(change, _)| *change > most);
    match found {
        None => Ok(()),
        Some((change, rows)) => Err(format!(
            "{}, column {name}: stays at {} rad while the other side moves by {change:.4} rad; allowed: at most {most:.4} rad",
            shown(&rows),
            angle[*rows.start()]
        )),
    }
}

/// The runs of at least [`HELD_ROWS`] equal values.
fn runs(column: &[f64]) -> impl Iterator<Item = RangeInclusive<usize>> {
    let mut start = 0;
    column.chunk_by(|a, b| a == b).filter_map(move |run| {
        let first = start;
        start += run.len();
        (run.len() >= HELD_ROWS).then(|| first..=start - 1)
    })
}

fn span(values: &[f64]) -> f64 {
    let (least, most) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (value.min(least), value.max(most)));
    most - least
}

fn shown(rows: &RangeInclusive<usize>) -> String {
    format!("rows {} to {}", row_of(*rows.start()), row_of(*rows.end()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::log::Time;

    /// Two seconds of a swing of 9 rad at the motor, every 4 ms.
    fn log() -> MeasuredLog {
        let time = Time::every(0.004, 500);
        let motor: Vec<_> = time.stamps().iter().map(|t| 9.0 * (3.0 * t).sin()).collect();
        MeasuredLog {
            output_position: Some(motor.iter().map(|angle| -angle / 100.0).collect()),
            motor_torque: time.stamps().iter().map(|t| 0.3 * (3.0 * t + 0.2).cos()).collect(),
            motor_position: motor,
            time,
            output_torque: None,
            model_torque: None,
        }
    }

    fn refusal(change: impl Fn(&mut MeasuredLog)) -> String {
        let mut log = log();
        change(&mut log);
        log.require_sound(&GearFile::default_gear()).unwrap_err()
    }

    #[test]
    fn a_sound_log_passes() {
        assert_eq!(log().require_sound(&GearFile::default_gear()), Ok(()));
        assert!(log().limits().is_empty());
    }

    #[test]
    fn each_defect_is_named_with_its_rows() {
        let output = |log: &mut MeasuredLog, change: &dyn Fn(&mut Vec<f64>)| {
            change(log.output_position.as_mut().unwrap())
        };
        let short = refusal(|log| {
            log.time = Time::every(0.004, 10);
            log.motor_position.truncate(10);
        });
        assert_eq!(short, "10 rows; allowed: at least 20");
        let still = refusal(|log| {
            log.motor_position.fill(1.0);
            output(log, &|angle| angle.fill(0.0));
        });
        assert_eq!(still, "rows 2 to 501, column theta_motor_rad: no motion");
        let jump = refusal(|log| log.motor_position[200..].iter_mut().for_each(|angle| *angle += 6.3));
        assert!(jump.starts_with("row 202, column theta_motor_rad: jumps by 6.2"), "{jump}");
        let jump =
            refusal(|log| output(log, &|angle| angle[200..].iter_mut().for_each(|angle| *angle += 0.1)));
        assert!(jump.starts_with("row 202, column theta_out_rad: jumps by 0."), "{jump}");
        let saturated =
            refusal(|log| output(log, &|angle| angle.iter_mut().for_each(|angle| *angle = angle.min(0.05))));
        assert!(
            saturated.contains("column theta_out_rad: stays at 0.05 rad while the other side moves by"),
            "{saturated}"
        );
        let lost = refusal(|log| log.motor_position[..250].fill(0.0));
        assert!(lost.contains("theta_motor_rad"), "{lost}");
        let clipped =
            refusal(|log| log.motor_torque.iter_mut().for_each(|torque| *torque = torque.clamp(-0.2, 0.2)));
        assert!(
            clipped.contains(", column tau_motor_nm: stays at 0.2 N m, its largest magnitude"),
            "{clipped}"
        );
    }

    #[test]
    fn one_direction_is_a_limit() {
        let mut log = log();
        log.motor_position.iter_mut().zip(0..).for_each(|(angle, k)| *angle = 0.01 * f64::from(k));
        let limits = log.limits();
        assert!(limits.len() == 1 && limits[0].contains("one direction only"), "{limits:?}");
    }
}
