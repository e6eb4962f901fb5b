//! Motion that a user asks of a joint's output.
//!
//! `t_s, theta_rad`, and where the file has them `omega_rad_s`, `alpha_rad_s2` (together with the former only) and `tau_load_nm`,
//! the external torque ON the output, 0 without the column. Nothing moves before the first row or after the last one.
//!
//! Speeds that do not belong to the angles, of another unit or sign, are refused: where, over all intervals, the rms of
//! (x1 - x0)/h - (v0 + v1)/2 is more than half the rms of (x1 - x0)/h. So are accelerations that do not belong to the speeds.

use std::path::Path;

use super::columns::{Column, Columns, Extra, Schema, row_of};
use super::time::{TIME, Time};
use super::{ANGLE_LIMIT, LONGEST_FILE, SPEED_LIMIT, TORQUE_LIMIT};
use crate::io::file::{self, BadInput};

/// Longest motion (s): a minute of it takes the emulator some minutes, and a gigabyte of memory.
pub const LONGEST_MOTION: f64 = 60.0;
/// Shortest motion (s).
const SHORTEST_MOTION: f64 = 0.1;
/// Largest acceleration (rad/s^2).
const ACCELERATION_LIMIT: f64 = 1e8;
/// Least rows: a curve of least jerk through two is not the only one.
const LEAST_ROWS: usize = 3;
/// Largest rms of what a column is off the slope of another one, over that of the slope.
const OFF: f64 = 0.5;

const POSITION: Column = Column {
    name: "theta_rad",
    limit: ANGLE_LIMIT,
    other_names: &["theta", "position", "position_rad", "q", "theta_out_rad", "angle_rad"],
};
const VELOCITY: Column = Column {
    name: "omega_rad_s",
    limit: SPEED_LIMIT,
    other_names: &["omega", "velocity", "velocity_rad_s", "qd", "dq"],
};
const ACCELERATION: Column = Column {
    name: "alpha_rad_s2",
    limit: ACCELERATION_LIMIT,
    other_names: &["alpha", "acceleration", "acceleration_rad_s2", "qdd", "ddq"],
};
const LOAD: Column = Column {
    name: "tau_load_nm",
    limit: TORQUE_LIMIT,
    other_names: &["load", "torque", "tau_nm", "load_nm"],
};
const SCHEMA: Schema =
    Schema { one_of: &[&[TIME], &[POSITION]], optional: &[VELOCITY, ACCELERATION, LOAD], may_ignore: false };

/// Commanded motion, row by row, as many of each column.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandedMotion {
    /// Time stamps.
    pub time: Time,
    /// Output angle (rad).
    pub position: Vec<f64>,
    /// Output speed (rad/s).
    pub velocity: Option<Vec<f64>>,
    /// Output acceleration (rad/s^2).
    pub acceleration: Option<Vec<f64>>,
    /// External torque on the output (N m).
    pub load: Option<Vec<f64>>,
}

impl CommandedMotion {
    /// Reads and checks `path`.
    ///
    /// # Errors
    /// One line that names the file, the row and the column.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::parse(path, &file::read(path, LONGEST_FILE)?)
    }

    /// The file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`CommandedMotion::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        let mut columns = Columns::parse(path, bytes, SCHEMA, Extra::Refused)?;
        let time = Time::check(columns.require(TIME)).map_err(|why| BadInput::new(path, why))?;
        let motion = Self {
            time,
            position: columns.require(POSITION),
            velocity: columns.take(VELOCITY),
            acceleration: columns.take(ACCELERATION),
            load: columns.take(LOAD),
        };
        motion.check().map_err(|why| BadInput::new(path, why))?;
        Ok(motion)
    }

    fn check(&self) -> Result<(), String> {
        let (stamps, rows) = (self.time.stamps(), self.position.len());
        if rows < LEAST_ROWS {
            return Err(format!("{rows} rows after the header; allowed: at least {LEAST_ROWS}"));
        }
        if let Some(late) = stamps.iter().position(|stamp| stamp - stamps[0] > LONGEST_MOTION) {
            return Err(format!(
                "row {}, column {}: time {} is {} s from the start; allowed: at most {LONGEST_MOTION} s",
                row_of(late),
                TIME.name,
                stamps[late],
                stamps[late] - stamps[0]
            ));
        }
        let last = stamps[rows - 1] - stamps[0];
        if last < SHORTEST_MOTION {
            return Err(format!(
                "row {}, column {}: the motion ends after {last} s; allowed: at least {SHORTEST_MOTION} s",
                row_of(rows - 1),
                TIME.name
            ));
        }
        match (&self.velocity, &self.acceleration) {
            (None, Some(_)) => Err(format!(
                "row 1, column {}: missing; a file with {} has it",
                VELOCITY.name, ACCELERATION.name
            )),
            (None, None) => Ok(()),
            (Some(velocity), None) => self.require_slope(POSITION, &self.position, VELOCITY, velocity),
            (Some(velocity), Some(acceleration)) => {
                self.require_slope(POSITION, &self.position, VELOCITY, velocity)?;
                self.require_slope(VELOCITY, velocity, ACCELERATION, acceleration)
            }
        }
    }

    /// Refuses a column that is not the slope of another one.
    fn require_slope(
        &self,
        column: Column,
        values: &[f64],
        slope_column: Column,
        slopes: &[f64],
    ) -> Result<(), String> {
        let pairs = self.time.stamps().windows(2).zip(values.windows(2)).zip(slopes.windows(2));
        let [slope, off]: [Vec<f64>; 2] =
            pairs.fold(Default::default(), |[mut slope, mut off], ((t, x), v)| {
                slope.push((x[1] - x[0]) / (t[1] - t[0]));
                off.push(slope[slope.len() - 1] - 0.5 * (v[0] + v[1]));
                [slope, off]
            });
        let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        if squares(&off) <= OFF * OFF * squares(&slope) {
            return Ok(());
        }
        let worst = (0..off.len()).max_by(|a, b| off[*a].abs().total_cmp(&off[*b].abs())).unwrap_or(0);
        let row = worst + 1;
        Err(format!(
            "row {}, column {}: {} does not belong to {}, which changes by {:.6e} a second up to this row; unit or sign may \
             be wrong",
            row_of(row),
            slope_column.name,
            slopes[row],
            column.name,
            slope[worst]
        ))
    }
}

/// Row in the file of a sample, from 0, with the column of the angle.
pub(crate) fn place(sample: usize) -> String {
    format!("row {}, column {}", row_of(sample), POSITION.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<CommandedMotion, String> {
        CommandedMotion::parse("m.csv".as_ref(), text.as_bytes()).map_err(|why| why.to_string())
    }

    #[test]
    fn columns_beyond_time_and_angle_may_be_there() {
        let motion = parse("theta_rad,t_s\n0,0\n0.1,0.1\n0.2,0.21\n").unwrap();
        assert_eq!((motion.position[2], motion.time.stamps()[2]), (0.2, 0.21));
        assert_eq!((motion.velocity, motion.load), (None, None));
        let motion = parse("t_s,theta_rad,omega_rad_s,tau_load_nm\n0,0,1,5\n0.1,0.1,1,5\n0.2,0.2,1,6\n");
        assert_eq!(motion.unwrap().load, Some(vec![5.0, 5.0, 6.0]));
    }

    #[test]
    fn what_is_wrong_is_named_with_file_row_and_column() {
        let starts = |text: &str, start: &str| {
            let line = parse(text).unwrap_err();
            assert!(line.starts_with(start), "{line}\n{start}");
        };
        starts("t_s,theta_rad\n0,0\n1,1\n", "m.csv: 2 rows after the header; allowed: at least 3");
        starts("t_s,theta_rad\n0,0\n1,1\n1,1\n", "m.csv: row 4, column t_s: time 1 does not come after 1");
        starts(
            "t_s,theta_rad\n0,0\n30,1\n60.5,1\n",
            "m.csv: row 4, column t_s: time 60.5 is 60.5 s from the start; allowed: at most 60 s",
        );
        starts("t_s,theta_rad\n0,0\n1,inf\n2,1\n", "m.csv: row 3, column theta_rad: \"inf\" is out of range");
        starts(
            "t_s,position\n0,0\n1,1\n2,1\n",
            "m.csv: row 1, column \"position\": unknown; known columns are",
        );
        starts(
            "t_s,theta_rad,alpha_rad_s2\n0,0,0\n1,1,0\n2,1,0\n",
            "m.csv: row 1, column omega_rad_s: missing; a file with alpha_rad_s2 has it",
        );
        let line = parse("t_s,theta_rad,position\n0,0,0\n1,1,0\n2,1,0\n").unwrap_err();
        assert!(line.contains("meant is perhaps theta_rad"), "{line}");
    }

    /// Degrees a second, or the other sign; accelerations too.
    #[test]
    fn speeds_of_another_unit_are_refused() {
        let file = |speed: f64, acceleration: f64| {
            let rows = (0..50).map(|k| f64::from(k) * 0.01).map(|t| {
                format!(
                    "{t},{},{},{}\n",
                    (3.0 * t).sin(),
                    speed * (3.0 * t).cos(),
                    acceleration * (3.0 * t).sin()
                )
            });
            format!("t_s,theta_rad,omega_rad_s,alpha_rad_s2\n{}", rows.collect::<String>())
        };
        assert!(parse(&file(3.0, -9.0)).is_ok());
        for (speed, acceleration, column) in [
            (-3.0, 9.0, "omega_rad_s: "),
            (3.0f64.to_degrees(), -9.0, "omega_rad_s: "),
            (3.0, 9.0, "alpha_rad_s2: "),
        ] {
            let line = parse(&file(speed, acceleration)).unwrap_err();
            assert!(line.contains(column) && line.contains(" does not belong to "), "{line}");
        }
    }
}
