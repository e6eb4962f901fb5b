//! The arm link.

use std::convert::Infallible;
use std::f64::consts::TAU;
use std::path::Path;

use strainwave_desktop::io::log::{LinkInputLog, write_rows};
use strainwave_desktop::plant::link::{self, LinkRow, LinkRun, SensedLink};
use strainwave_desktop::plant::measured::Truth;
use strainwave_desktop::{BadInput, Figure, LinkFile};

use super::sensors::{self, Sensors};
use super::{Arguments, answer, require_writable};
use crate::figures::{Figures, tell};
use crate::progress::Progress;

/// Reads, runs and writes.
pub(super) fn run(arguments: &Arguments, path: &Path) -> Result<Figures, BadInput> {
    let file = LinkFile::read(path)?;
    let log = LinkInputLog::read(&arguments.input, file.piezo.is_some())?;
    let set = sensors::file(arguments)?;
    let bridge = set.as_ref().and_then(|set| set.gauge_bridge).map(|bridge| bridge.at);
    require_on_link(arguments, bridge, file.link.length)?;
    require_writable(arguments)?;
    if let Some(warning) = file.warning() {
        tell(&arguments.output, format_args!("warning: {}: {warning}", path.display()));
    }
    let LinkRun { frequencies, rows } =
        link::run(&file, &log, bridge).map_err(|error| BadInput::new(path, error))?;
    let sample = truth_of(0.0, &SensedLink { strain: Some(0.0), ..SensedLink::default() });
    let mut sensors = Sensors::build(arguments, set.as_ref(), &sample)?;
    let mut progress = Progress::new(rows.len() as u64, "simulating");
    let mut largest = Largest::default();
    let columns = [link::columns(&file), sensors.columns()].concat();
    let watched = rows.enumerate().map(|(done, row)| {
        progress.set(done as u64);
        largest.add(&row);
        let readings = sensors.step(&truth_of(row.torque, &row.sensed));
        Ok::<_, Infallible>([row.numbers(), readings].concat())
    });
    write_rows(&arguments.output, &columns.iter().map(String::as_str).collect::<Vec<_>>(), watched)?;
    let modes = (1..)
        .zip(frequencies)
        .map(|(mode, omega)| Figure::reported(format!("sim.link.mode_{mode}.frequency"), omega / TAU, "Hz"));
    Ok(answer(arguments, &log.time, modes.chain(largest.figures()).chain(sensors.figures())))
}

/// Refuses a bridge beyond the end of the link (m).
fn require_on_link(arguments: &Arguments, bridge: Option<f64>, length: f64) -> Result<(), BadInput> {
    let (Some(at), Some(path)) = (bridge.filter(|at| *at > length), &arguments.sensors) else {
        return Ok(());
    };
    let why = format_args!(
        "gauge_bridge.at_m = {at} is out of range; allowed: at most {length} m, the length of the link"
    );
    Err(BadInput::new(path, why))
}

/// True values of the sensors on a link whose joint gives so much torque (N m).
fn truth_of(torque: f64, sensed: &SensedLink) -> Truth {
    Truth {
        output: Some(sensed.joint),
        torque: Some(torque),
        specific_force: Some(sensed.specific_force),
        strain: sensed.strain,
        ..Truth::default()
    }
}

/// Rows and largest magnitudes of a run.
#[derive(Default)]
struct Largest {
    rows: u32,
    deflection: f64,
    torque: f64,
    strain: Option<f64>,
    charge: Option<f64>,
}

impl Largest {
    fn add(&mut self, row: &LinkRow) {
        self.rows += 1;
        self.deflection = self.deflection.max(row.deflection.abs());
        self.torque = self.torque.max(row.torque.abs());
        let larger = |most: Option<f64>, value: f64| Some(most.unwrap_or(0.0).max(value.abs()));
        self.strain = row.strains.iter().fold(self.strain, |most, strain| larger(most, *strain));
        self.charge = row.patch.iter().fold(self.charge, |most, patch| larger(most, patch.charge));
    }

    fn figures(&self) -> Vec<Figure> {
        let always = [
            ("rows", Some(f64::from(self.rows)), "1"),
            ("tip_deflection.max", Some(self.deflection), "m"),
            ("joint_torque.max", Some(self.torque), "N m"),
            ("strain.max", self.strain, "1"),
            ("charge.max", self.charge, "C"),
        ];
        let named = always.into_iter().filter_map(|(name, value, unit)| {
            Some(Figure::reported(format!("sim.link.{name}"), value?, unit))
        });
        named.collect()
    }
}
