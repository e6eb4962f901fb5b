//! `--sensors`: readings of a file's sensors as further columns.

use std::path::Path;

use strainwave_desktop::plant::measured::{Measurement, Truth};
use strainwave_desktop::{BadInput, Figure, SensorFile};

use super::Arguments;
use crate::figures::tell;

/// The sensors of the file that the arguments name; none when they name none.
pub(super) fn file(arguments: &Arguments) -> Result<Option<SensorFile>, BadInput> {
    arguments.sensors.as_deref().map(SensorFile::read).transpose()
}

/// Sensors along a run, or none.
pub(super) struct Sensors(Option<Measurement>);

impl Sensors {
    /// Those whose true value is in `sample`, the truth of any row; what is left out is told.
    pub fn build(arguments: &Arguments, file: Option<&SensorFile>, sample: &Truth) -> Result<Self, BadInput> {
        let (Some(path), Some(file)) = (arguments.sensors.as_deref(), file) else { return Ok(Self(None)) };
        let measurement = Measurement::build(file, sample).map_err(|error| BadInput::new(path, error))?;
        let missing = measurement.missing().join("], [");
        if measurement.columns().is_empty() {
            return Err(BadInput::new(
                path,
                format_args!("none of its sensors, [{missing}], is on this model"),
            ));
        }
        if !missing.is_empty() {
            let path = Path::display(path);
            tell(
                &arguments.output,
                format_args!("note: {path}: [{missing}]: not on this model, without a column"),
            );
        }
        Ok(Self(Some(measurement)))
    }

    /// Names of the columns.
    pub fn columns(&self) -> Vec<String> {
        self.0.as_ref().map(Measurement::columns).unwrap_or_default()
    }

    /// Readings of the next row.
    pub fn step(&mut self, truth: &Truth) -> Vec<f64> {
        self.0.as_mut().map(|measurement| measurement.step(truth)).unwrap_or_default()
    }

    /// Error of each.
    pub fn figures(&self) -> Vec<Figure> {
        self.0.as_ref().map(Measurement::figures).unwrap_or_default()
    }
}
