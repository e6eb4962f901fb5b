//! The belt gear.

use std::path::Path;

use strainwave_desktop::io::log::{BeltRow, OpenLoop, write_belt};
use strainwave_desktop::plant::belt::{self, BeltBuild};
use strainwave_desktop::plant::measured::{MotorMotion, Truth, motion};
use strainwave_desktop::{BadInput, BeltFile, Figure};

use super::sensors::{self, Sensors};
use super::{Arguments, Models, answer, require_writable};
use crate::figures::Figures;
use crate::progress::Progress;

/// Reads, runs and writes.
pub(super) fn run(arguments: &Arguments, path: &Path) -> Result<Figures, BadInput> {
    let file = BeltFile::read(path)?;
    let build = match arguments.build {
        Models::Reference => BeltBuild::Reference,
        Models::Realtime => BeltBuild::RealTime,
    };
    if build == BeltBuild::RealTime {
        belt::require_real_time(&file).map_err(|why| BadInput::new(path, why))?;
    }
    let set = sensors::file(arguments)?;
    let input = OpenLoop::read_belt(&arguments.input)?;
    let motor_motion = MotorMotion::of(&input);
    let truth = |row: &BeltRow| Truth {
        motor: Some(motor_motion.at(row.time)),
        output: Some(motion(row.output_position, row.output_velocity)),
        torque: Some(row.transmitted_torque),
        motor_torque: Some(row.motor_torque),
        ..Truth::default()
    };
    let mut sensors = Sensors::build(arguments, set.as_ref(), &truth(&BeltRow::default()))?;
    require_writable(arguments)?;
    let rows = belt::run(&file, &input, build).map_err(|error| BadInput::new(path, error))?;
    let mut progress = Progress::new(rows.len() as u64, "simulating");
    let (mut extremes, names) = (Extremes::default(), sensors.columns());
    let watched = rows.enumerate().map(|(done, row)| {
        progress.set(done as u64);
        extremes.add(&row);
        let readings = sensors.step(&truth(&row));
        (row, readings)
    });
    write_belt(&arguments.output, &names, watched)?;
    Ok(answer(arguments, &input.time, extremes.figures().into_iter().chain(sensors.figures())))
}

/// Rows, largest magnitudes and least tension of a run.
#[derive(Default)]
struct Extremes {
    rows: u32,
    torsion: f64,
    transmitted: f64,
    motor: f64,
    tightest: f64,
    loosest: Option<f64>,
}

impl Extremes {
    fn add(&mut self, row: &BeltRow) {
        self.rows += 1;
        self.torsion = self.torsion.max(row.torsion.abs());
        self.transmitted = self.transmitted.max(row.transmitted_torque.abs());
        self.motor = self.motor.max(row.motor_torque.abs());
        self.tightest = self.tightest.max(row.forward_force.max(row.backward_force));
        let loose = row.forward_force.min(row.backward_force);
        self.loosest = Some(self.loosest.map_or(loose, |least| least.min(loose)));
    }

    fn figures(&self) -> [Figure; 6] {
        [
            Figure::reported("sim.rows", f64::from(self.rows), "1"),
            Figure::reported("sim.torsion.max", self.torsion, "rad"),
            Figure::reported("sim.transmitted_torque.max", self.transmitted, "N m"),
            Figure::reported("sim.motor_torque.max", self.motor, "N m"),
            Figure::reported("sim.span_force.max", self.tightest, "N"),
            Figure::reported("sim.span_force.min", self.loosest.unwrap_or(0.0), "N"),
        ]
    }
}
