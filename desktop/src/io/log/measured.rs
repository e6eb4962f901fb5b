//! Logs of a real joint.
//!
//! `t_s, theta_motor_rad, tau_motor_nm` (at the motor's shaft), and when the joint has the sensor
//! `theta_out_rad` and `tau_out_nm`. A further column `tau_model_nm` is accepted: the torque at the
//! output that the joint's own controller expects from its rigid-body model, which several
//! controllers log beside the measured one. Any other column is refused, or ignored on request.
//!
//! Motor and output angle count in the same direction as r has it, each from an arbitrary zero.

use std::path::Path;

use super::columns::{Column, Columns, Extra, Schema};
use super::time::{TIME, Time};
use super::{ANGLE_LIMIT, LONGEST_FILE, TORQUE_LIMIT};
use crate::io::file::{self, BadInput};

pub(super) const MOTOR_POSITION: Column =
    Column { name: "theta_motor_rad", limit: ANGLE_LIMIT, other_names: &[] };
pub(super) const OUTPUT_POSITION: Column =
    Column { name: "theta_out_rad", limit: ANGLE_LIMIT, other_names: &[] };
pub(super) const MOTOR_TORQUE: Column =
    Column { name: "tau_motor_nm", limit: TORQUE_LIMIT, other_names: &[] };
const OUTPUT_TORQUE: Column = Column { name: "tau_out_nm", limit: TORQUE_LIMIT, other_names: &[] };
const MODEL_TORQUE: Column = Column { name: "tau_model_nm", limit: TORQUE_LIMIT, other_names: &[] };
const SCHEMA: Schema = Schema {
    one_of: &[&[TIME], &[MOTOR_POSITION], &[MOTOR_TORQUE]],
    optional: &[OUTPUT_POSITION, OUTPUT_TORQUE, MODEL_TORQUE],
    may_ignore: true,
};

/// A measured log.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredLog {
    /// Time stamps.
    pub time: Time,
    /// Motor angle (rad).
    pub motor_position: Vec<f64>,
    /// Motor torque at its shaft (N m).
    pub motor_torque: Vec<f64>,
    /// Output angle (rad).
    pub output_position: Option<Vec<f64>>,
    /// Torque at the output (N m).
    pub output_torque: Option<Vec<f64>>,
    /// Torque at the output that the joint's controller expects (N m).
    pub model_torque: Option<Vec<f64>>,
}

impl MeasuredLog {
    /// Reads and checks `path`.
    ///
    /// # Errors
    /// One line that names the file, the row and the column.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        Self::read_with(path, Extra::Refused).map(|(log, _)| log)
    }

    /// The same of a file with other columns, too, and the names of those that were ignored.
    ///
    /// # Errors
    /// As [`MeasuredLog::read`].
    pub fn read_with(path: &Path, extra: Extra) -> Result<(Self, Vec<String>), BadInput> {
        Self::parse_with(path, &file::read(path, LONGEST_FILE)?, extra)
    }

    /// The same log of a motor whose torque was logged with the other sign.
    #[must_use]
    pub fn with_reversed_torque(mut self) -> Self {
        self.motor_torque.iter_mut().for_each(|torque| *torque = -*torque);
        self
    }

    /// The file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`MeasuredLog::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, BadInput> {
        Self::parse_with(path, bytes, Extra::Refused).map(|(log, _)| log)
    }

    fn parse_with(path: &Path, bytes: &[u8], extra: Extra) -> Result<(Self, Vec<String>), BadInput> {
        let mut columns = Columns::parse(path, bytes, SCHEMA, extra)?;
        let time = Time::check(columns.require(TIME)).map_err(|why| BadInput::new(path, why))?;
        let log = Self {
            time,
            motor_position: columns.require(MOTOR_POSITION),
            motor_torque: columns.require(MOTOR_TORQUE),
            output_position: columns.take(OUTPUT_POSITION),
            output_torque: columns.take(OUTPUT_TORQUE),
            model_torque: columns.take(MODEL_TORQUE),
        };
        Ok((log, columns.ignored()))
    }
}
