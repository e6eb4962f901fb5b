//! Blind prediction of a measured log by the real-time model of a gear file, the code that the firmware runs, in f32.
//!
//! | predicted | from | model | rigid joint |
//! | --- | --- | --- | --- |
//! | output angle | motor angle and torque, output torque where measured | observer ([`crate::identify::replay`]) | r*theta_motor |
//! | motor torque | motor angle, output torque where measured | `motor_torque.rs` | inertia, Coulomb and viscous friction |
//! | torsion | output torque | `torsion.rs` | 0 |
//!
//! The torsion is predicted where output torque and output angle are measured; its measurement is r*theta_motor + e -
//! theta_out, e being the file's kinematic error. Without an output torque the motor torque is that of a joint which
//! nothing but its own inertia and friction loads.
//!
//! The gear starts at rest at the first row, or warmed up by the log that was recorded before. Angles count from arbitrary
//! zeros: the predicted ones are shifted to agree with the measured ones in the first row, or on average over the log
//! before; nothing else of the log is used. A [`Deviation`] tells the error as it is, and its shape, what is left
//! after its mean over the log is removed. Units: s, rad, N m; signs as in [`strainwave::gear`].

mod deviation;
mod motor_torque;
mod torsion;

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{RealTimeFlexspline, RealTimeGear};
use strainwave::{Angle, Error as ParameterError};

use crate::bench::controller::HostCompensator;
use crate::design::joint::{firmware_gear_params, joint_params};
use crate::identify::replay::replay;
use crate::io::gear_file::GearFile;
use crate::io::log::MeasuredLog;
pub use deviation::Deviation;

/// Why a log could not be predicted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// No compensator can be built for the gear.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The observer ended.
    #[error("{0}")]
    Observer(String),
    /// The log before does not lead to this one.
    #[error("{0}")]
    Before(String),
}

/// A quantity over the rows of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name, as in `output`.
    pub name: &'static str,
    /// Name of its column without the unit, as in `theta_out`.
    column: &'static str,
    /// Unit, as in `rad`.
    pub unit: &'static str,
    /// As measured, where the log has it.
    pub measured: Option<Vec<f64>>,
    /// By the real-time model.
    pub predicted: Vec<f64>,
    /// By a rigid joint.
    pub rigid: Vec<f64>,
}

/// A predicted log.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Time stamps of the rows, as the log has them (s).
    pub time: Vec<f64>,
    /// Motor angle (rad).
    pub motor: Vec<f64>,
    /// Output angle, motor torque and, where it can be measured, torsion.
    pub quantities: Vec<Quantity>,
}

/// Predicts a log; `before` is one of the same joint that was recorded just before it, and `progress` is called with the
/// fraction done.
///
/// # Errors
/// [`Error`] when no compensator can be built for the gear, or the log does not go on from the one before.
pub fn predict(
    file: &GearFile,
    log: &MeasuredLog,
    before: Option<&MeasuredLog>,
    progress: impl FnMut(f64),
) -> Result<Prediction, Error> {
    let joined = before.map(|before| before.followed_by(log)).transpose().map_err(Error::Before)?;
    let (whole, first) = joined.as_ref().map_or((log, 0), |(joined, first)| (joined, *first));
    // Rows from which the zeros of the angles are taken.
    let reference = before.map_or(1, |before| before.time.stamps().len());
    let output = output(file, whole, progress)?.shifted(reference);
    let mut quantities = vec![output, motor_torque(file, whole)?];
    quantities.extend(torsion(file, whole)?.map(|torsion| torsion.shifted(reference)));
    quantities.iter_mut().for_each(|quantity| quantity.drop_first(first));
    Ok(Prediction { time: log.time.stamps().to_vec(), motor: log.motor_position.clone(), quantities })
}

/// The control period of each row.
fn periods(log: &MeasuredLog) -> impl Iterator<Item = usize> {
    let stamps = log.time.stamps();
    stamps.iter().map(|stamp| ((stamp - stamps[0]) / CONTROL_PERIOD).round() as usize)
}

/// A figure of the control period of each row; of the last one where it has ended before.
fn at_rows<T>(log: &MeasuredLog, steps: &[T], figure: impl Fn(&T) -> f64) -> Vec<f64> {
    periods(log).map(|period| figure(&steps[period.min(steps.len() - 1)])).collect()
}

fn output(file: &GearFile, log: &MeasuredLog, progress: impl FnMut(f64)) -> Result<Quantity, Error> {
    let mut controller = HostCompensator::build(&joint_params(file)?)?;
    let rows = replay(&mut controller, file, log, f64::INFINITY, progress)
        .map_err(|error| Error::Observer(error.to_string()))?;
    Ok(Quantity {
        name: "output",
        column: "theta_out",
        unit: "rad",
        measured: log.output_position.clone(),
        predicted: at_rows(log, &rows, |row| row.predicted),
        rigid: at_rows(log, &rows, |row| row.rigid),
    })
}

fn motor_torque(file: &GearFile, log: &MeasuredLog) -> Result<Quantity, Error> {
    let torques = motor_torque::predict(file, log)?;
    Ok(Quantity {
        name: "motor_torque",
        column: "tau_motor",
        unit: "N m",
        measured: Some(log.motor_torque.clone()),
        predicted: at_rows(log, &torques, |torque| torque.predicted),
        rigid: at_rows(log, &torques, |torque| torque.rigid),
    })
}

/// The gear in its real-time build.
fn real_time_gear(file: &GearFile) -> Result<RealTimeGear<f32>, ParameterError> {
    let params = firmware_gear_params::<f32>(file)?;
    let flexspline = RealTimeFlexspline::build(&params.flexspline, params.rated_torque)?;
    params.build(flexspline, CONTROL_PERIOD as f32)
}

fn torsion(file: &GearFile, log: &MeasuredLog) -> Result<Option<Quantity>, Error> {
    let (Some(output), Some(torque)) = (&log.output_position, &log.output_torque) else { return Ok(None) };
    let gear = real_time_gear(file)?;
    let unloaded =
        log.motor_position.iter().map(|motor| gear.drive(Angle::from_radians_f64(*motor)).to_radians());
    Ok(Some(Quantity {
        name: "torsion",
        column: "torsion",
        unit: "rad",
        measured: Some(unloaded.zip(output).map(|(unloaded, output)| unloaded - output).collect()),
        predicted: torsion::predict(file, torque)?,
        rigid: vec![0.0; torque.len()],
    }))
}

impl Quantity {
    /// Error of the model and of the rigid joint; `None` where the quantity was not measured.
    pub fn deviations(&self) -> Option<[Deviation; 2]> {
        let measured = self.measured.as_ref()?;
        Some([&self.predicted, &self.rigid].map(|predicted| Deviation::of(predicted, measured)))
    }

    /// Shifted so that the mean error of the first rows is 0.
    fn shifted(mut self, rows: usize) -> Self {
        if let Some(measured) = &self.measured {
            for predicted in [&mut self.predicted, &mut self.rigid] {
                let offset = Deviation::of(&predicted[..rows], &measured[..rows]).offset;
                predicted.iter_mut().for_each(|value| *value -= offset);
            }
        }
        self
    }

    /// Without so many rows before.
    fn drop_first(&mut self, first: usize) {
        for column in
            [Some(&mut self.predicted), Some(&mut self.rigid), self.measured.as_mut()].into_iter().flatten()
        {
            column.drain(..first);
        }
    }
}

impl Prediction {
    /// The columns of its file by name: time, motor angle, and each quantity as measured, predicted and by a rigid joint.
    pub fn columns(&self) -> Vec<(String, &[f64])> {
        let mut columns =
            vec![("t_s".to_owned(), &self.time[..]), ("theta_motor_rad".to_owned(), &self.motor[..])];
        for quantity in &self.quantities {
            let unit = quantity.unit.replace(' ', "").to_lowercase();
            let name = |kind: &str| format!("{}{kind}_{unit}", quantity.column);
            columns.extend(quantity.measured.as_ref().map(|measured| (name(""), &measured[..])));
            columns.push((name("_predicted"), &quantity.predicted));
            columns.push((name("_rigid"), &quantity.rigid));
        }
        columns
    }
}
