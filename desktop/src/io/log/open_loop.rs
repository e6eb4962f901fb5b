//! Files of the gear as a two-port, open loop.
//!
//! In: `t_s`, one of `theta_wg_rad` and `omega_wg_rad_s`, and `tau_load_nm`, the external torque ON
//! the flexspline. Out: `t_s, theta_fs_rad, omega_fs_rad_s, tau_wg_nm, torsion_rad, tau_t_nm`, and a column a gauge.

use std::fmt::Display;
use std::path::Path;

use super::columns::{Column, Columns, Extra, Schema};
use super::time::{Instant, TIME, Time};
use super::written::write_rows;
use super::{ANGLE_LIMIT, LONGEST_FILE, SPEED_LIMIT, TORQUE_LIMIT};
use crate::io::file::{self, BadInput};

const POSITION: Column = Column { name: "theta_wg_rad", limit: ANGLE_LIMIT, other_names: &[] };
const VELOCITY: Column = Column { name: "omega_wg_rad_s", limit: SPEED_LIMIT, other_names: &[] };
const LOAD: Column = Column { name: "tau_load_nm", limit: TORQUE_LIMIT, other_names: &[] };
const SCHEMA: Schema =
    Schema { one_of: &[&[TIME], &[POSITION, VELOCITY], &[LOAD]], optional: &[], may_ignore: false };

/// Drive of the wave generator.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Its angle (rad).
    Position(Vec<f64>),
    /// Its speed (rad/s).
    Velocity(Vec<f64>),
}

/// Drive of the wave generator at one instant.
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
    /// Drive of the wave generator.
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
        let mut columns = Columns::parse(path, bytes, SCHEMA, Extra::Refused)?;
        let time = Time::check(columns.require(TIME)).map_err(|why| BadInput::new(path, why))?;
        let drive = match columns.take(POSITION) {
            Some(position) => Drive::Position(position),
            None => Drive::Velocity(columns.require(VELOCITY)),
        };
        Ok(Self { time, drive, load_torque: columns.require(LOAD) })
    }
}

/// Columns of the open-loop output, before those of the gauges.
const OUTPUT: [&str; 6] = ["t_s", "theta_fs_rad", "omega_fs_rad_s", "tau_wg_nm", "torsion_rad", "tau_t_nm"];

/// One row of the open-loop output.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenLoopRow {
    /// Time (s).
    pub time: f64,
    /// Flexspline angle (rad).
    pub output_position: f64,
    /// Flexspline speed (rad/s).
    pub output_velocity: f64,
    /// Torque at the wave generator, to be supplied by the motor (N m).
    pub input_torque: f64,
    /// Torsion of the flexspline (rad).
    pub torsion: f64,
    /// Torque through the flexspline (N m).
    pub transmitted_torque: f64,
    /// Strain at each gauge, without unit.
    pub strains: Vec<f64>,
}

impl OpenLoopRow {
    /// The numbers in the order of the columns.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let Self { output_position, output_velocity, input_torque, torsion, transmitted_torque, .. } = self;
        // Stamps on the grid, not with the last digits of their rounding.
        let time = (self.time * 1e9).round() / 1e9;
        [time, *output_position, *output_velocity, *input_torque, *torsion, *transmitted_torque]
            .into_iter()
            .chain(self.strains.iter().copied())
    }
}

/// Writes the open-loop output, complete or not at all; `gauges` name the columns of the rows' strains.
///
/// # Errors
/// The file cannot be written, a row has failed, or a value is not finite.
pub fn write_open_loop<E: Display>(
    path: &Path,
    gauges: &[String],
    rows: impl IntoIterator<Item = Result<OpenLoopRow, E>>,
) -> Result<(), BadInput> {
    let names: Vec<_> = OUTPUT.into_iter().chain(gauges.iter().map(String::as_str)).collect();
    write_rows(path, &names, rows.into_iter().map(|row| row.map(|row| row.numbers().collect())))
}
