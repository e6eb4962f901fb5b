//! Files of the gear and of the belt gear as two-ports, open loop.
//!
//! In: `t_s`, one of `theta_wg_rad` and `omega_wg_rad_s`, and `tau_load_nm`, the external torque ON
//! the flexspline. Out: `t_s, theta_fs_rad, omega_fs_rad_s, tau_wg_nm, torsion_rad, tau_t_nm`, and a column a gauge.
//! Of the belt gear, in: `t_s`, `theta_motor_rad` or `omega_motor_rad_s`, `tau_load_nm`. Out: `t_s, theta_out_rad, omega_out_rad_s,
//! tau_motor_nm, torsion_rad, tau_t_nm, f_forward_n, f_backward_n`.

use std::convert::Infallible;
use std::fmt::Display;
use std::path::Path;

use strainwave::flexspline::NodeForce;

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

const MOTOR_POSITION: Column = Column { name: "theta_motor_rad", limit: ANGLE_LIMIT, other_names: &[] };
const MOTOR_VELOCITY: Column = Column { name: "omega_motor_rad_s", limit: SPEED_LIMIT, other_names: &[] };
const BELT_SCHEMA: Schema = Schema {
    one_of: &[&[TIME], &[MOTOR_POSITION, MOTOR_VELOCITY], &[LOAD]],
    optional: &[],
    may_ignore: false,
};

/// Drive of the wave generator, or of a belt gear's motor.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Its angle (rad).
    Position(Vec<f64>),
    /// Its speed (rad/s).
    Velocity(Vec<f64>),
}

/// Drive at one instant.
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

/// The two inputs of a gear over time.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenLoop {
    /// Time stamps.
    pub time: Time,
    /// Drive of the input side.
    pub drive: Drive,
    /// External torque on the output (N m).
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
        Self::parse_as(path, bytes, SCHEMA, [POSITION, VELOCITY])
    }

    /// Reads and checks the inputs of a belt gear.
    ///
    /// # Errors
    /// One line that names the file, the row and the column.
    pub fn read_belt(path: &Path) -> Result<Self, BadInput> {
        Self::parse_belt(path, &file::read(path, LONGEST_FILE)?)
    }

    /// The same in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`OpenLoop::read_belt`].
    pub fn parse_belt(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        Self::parse_as(path, bytes, BELT_SCHEMA, [MOTOR_POSITION, MOTOR_VELOCITY])
    }

    fn parse_as(
        path: &Path,
        bytes: &[u8],
        schema: Schema,
        [position, velocity]: [Column; 2],
    ) -> Result<Self, BadInput> {
        let mut columns = Columns::parse(path, bytes, schema, Extra::Refused)?;
        let time = Time::check(columns.require(TIME)).map_err(|why| BadInput::new(path, why))?;
        let drive = match columns.take(position) {
            Some(position) => Drive::Position(position),
            None => Drive::Velocity(columns.require(velocity)),
        };
        Ok(Self { time, drive, load_torque: columns.require(LOAD) })
    }
}

/// Columns of the open-loop output, before those of the gauges.
const OUTPUT: [&str; 6] = ["t_s", "theta_fs_rad", "omega_fs_rad_s", "tau_wg_nm", "torsion_rad", "tau_t_nm"];

/// One row of the open-loop output.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// The part of it that strains the shell, without the hysteresis beside it (N m); in no column.
    pub shell_torque: f64,
    /// Strain at each gauge, without unit.
    pub strains: Vec<f64>,
    /// Forces on the nodes of rim and flange (N), in the rows that have them.
    pub forces: Option<[Vec<NodeForce<f64>>; 2]>,
}

impl OpenLoopRow {
    /// The numbers in the order of the columns.
    fn numbers(&self) -> Vec<f64> {
        let Self { output_position, output_velocity, input_torque, torsion, transmitted_torque, .. } = self;
        [self.time, *output_position, *output_velocity, *input_torque, *torsion, *transmitted_torque]
            .into_iter()
            .chain(self.strains.iter().copied())
            .collect()
    }
}

/// Columns of a belt gear's open-loop output.
const BELT_OUTPUT: [&str; 8] = [
    "t_s",
    "theta_out_rad",
    "omega_out_rad_s",
    "tau_motor_nm",
    "torsion_rad",
    "tau_t_nm",
    "f_forward_n",
    "f_backward_n",
];

/// One row of a belt gear's open-loop output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeltRow {
    /// Time (s).
    pub time: f64,
    /// Output angle (rad).
    pub output_position: f64,
    /// Output speed (rad/s).
    pub output_velocity: f64,
    /// Torque that the motor supplies (N m).
    pub motor_torque: f64,
    /// Torsion at the output (rad).
    pub torsion: f64,
    /// Torque through the belt, on the output (N m).
    pub transmitted_torque: f64,
    /// Tension of the forward span at the output's pulley (N).
    pub forward_force: f64,
    /// Tension of the backward span at the output's pulley (N).
    pub backward_force: f64,
}

impl BeltRow {
    /// The numbers in the order of the columns.
    fn numbers(&self) -> Vec<f64> {
        let Self { time, output_position, output_velocity, motor_torque, torsion, .. } = *self;
        let forces = [self.forward_force, self.backward_force];
        [
            &[time, output_position, output_velocity, motor_torque, torsion, self.transmitted_torque],
            &forces[..],
        ]
        .concat()
    }
}

/// Writes the open-loop output, complete or not at all: rows, each with the readings of sensors. `more` names the columns of the rows' strains and,
/// behind them, of the readings.
///
/// # Errors
/// The file cannot be written, a row has failed, or a value is not finite.
pub fn write_open_loop<E: Display>(
    path: &Path,
    more: &[String],
    rows: impl IntoIterator<Item = Result<(OpenLoopRow, Vec<f64>), E>>,
) -> Result<(), BadInput> {
    let rows = rows.into_iter().map(|row| row.map(|(row, readings)| [row.numbers(), readings].concat()));
    write_rows(path, &header(&OUTPUT, more), rows)
}

fn header<'a>(columns: &[&'a str], more: &'a [String]) -> Vec<&'a str> {
    columns.iter().copied().chain(more.iter().map(String::as_str)).collect()
}

/// Writes the open-loop output of a belt gear, complete or not at all: rows, each with the readings of `sensors`.
///
/// # Errors
/// The file cannot be written, or a value is not finite.
pub fn write_belt(
    path: &Path,
    sensors: &[String],
    rows: impl IntoIterator<Item = (BeltRow, Vec<f64>)>,
) -> Result<(), BadInput> {
    let numbers = |(row, readings): (BeltRow, Vec<f64>)| [row.numbers(), readings].concat();
    let rows = rows.into_iter().map(|row| Ok::<_, Infallible>(numbers(row)));
    write_rows(path, &header(&BELT_OUTPUT, sensors), rows)
}
