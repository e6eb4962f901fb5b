//! Files of the gear as a two-port, open loop.
//!
//! In: `t_s`, one of `theta_wg_rad` and `omega_wg_rad_s`, and `tau_load_nm`, the external torque ON
//! the flexspline. Out: `t_s, theta_fs_rad, omega_fs_rad_s, tau_wg_nm, torsion_rad, tau_t_nm`.

use std::path::Path;

use serde::Serialize;

use super::columns::{Column, Columns, Schema};
use super::time::{Instant, TIME, Time};
use super::{ANGLE_LIMIT, LONGEST_FILE, SPEED_LIMIT, TORQUE_LIMIT};
use crate::file::{self, BadInput, WriteError};

const POSITION: Column = Column { name: "theta_wg_rad", limit: ANGLE_LIMIT };
const VELOCITY: Column = Column { name: "omega_wg_rad_s", limit: SPEED_LIMIT };
const LOAD: Column = Column { name: "tau_load_nm", limit: TORQUE_LIMIT };
const SCHEMA: Schema = Schema { one_of: &[&[TIME], &[POSITION, VELOCITY], &[LOAD]], optional: &[] };

/// What drives the wave generator.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Its angle (rad).
    Position(Vec<f64>),
    /// Its speed (rad/s).
    Velocity(Vec<f64>),
}

/// What drives the wave generator at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveSample {
    /// Its angle (rad).
    Position(f64),
    /// Its speed (rad/s).
    Velocity(f64),
}

impl Drive {
    /// The drive at an instant of the same file.
    pub fn at(&self, instant: Instant) -> DriveSample {
        match self {
            Self::Position(column) => DriveSample::Position(instant.of(column)),
            Self::Velocity(column) => DriveSample::Velocity(instant.of(column)),
        }
    }
}

/// The two inputs of the gear over time.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenLoop {
    /// Time stamps.
    pub time: Time,
    /// What drives the wave generator.
    pub drive: Drive,
    /// External torque on the flexspline (N m).
    pub load_torque: Vec<f64>,
}

impl OpenLoop {
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
    /// As [`OpenLoop::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        let mut columns = Columns::parse(path, bytes, SCHEMA)?;
        let time = Time::check(columns.require(TIME)).map_err(|why| BadInput::new(path, why))?;
        let drive = match columns.take(POSITION) {
            Some(position) => Drive::Position(position),
            None => Drive::Velocity(columns.require(VELOCITY)),
        };
        Ok(Self { time, drive, load_torque: columns.require(LOAD) })
    }
}

/// One row of the open-loop output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OpenLoopRow {
    /// Time (s).
    #[serde(rename = "t_s")]
    pub time: f64,
    /// Flexspline angle (rad).
    #[serde(rename = "theta_fs_rad")]
    pub output_position: f64,
    /// Flexspline speed (rad/s).
    #[serde(rename = "omega_fs_rad_s")]
    pub output_velocity: f64,
    /// What the motor must supply (N m).
    #[serde(rename = "tau_wg_nm")]
    pub input_torque: f64,
    /// Torsion of the flexspline (rad).
    #[serde(rename = "torsion_rad")]
    pub torsion: f64,
    /// Torque through the flexspline (N m).
    #[serde(rename = "tau_t_nm")]
    pub transmitted_torque: f64,
}

impl OpenLoopRow {
    fn is_finite(&self) -> bool {
        let Self { time, output_position, output_velocity, input_torque, torsion, transmitted_torque } = self;
        [time, output_position, output_velocity, input_torque, torsion, transmitted_torque]
            .iter()
            .all(|number| number.is_finite())
    }
}

/// Writes the open-loop output, complete or not at all.
///
/// # Errors
/// The file cannot be written, or a value is not finite.
pub fn write_open_loop(path: &Path, rows: impl IntoIterator<Item = OpenLoopRow>) -> Result<(), BadInput> {
    file::write(path, |out| {
        let mut writer = csv::Writer::from_writer(out);
        for row in rows {
            if !row.is_finite() {
                return Err(WriteError::Refused(format!("a value at {} s is not finite", row.time)));
            }
            // Stamps on the grid, not with the last digits of their rounding.
            let row = OpenLoopRow { time: (row.time * 1e9).round() / 1e9, ..row };
            writer.serialize(row).map_err(|error| WriteError::Io(error.into()))?;
        }
        Ok(writer.flush()?)
    })
}
