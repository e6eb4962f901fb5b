//! Processor in the loop: a board's firmware against the reference plant, or against a measured log.

use std::path::Path;

use strainwave::Angle;
use strainwave::compensator::{Input, Sensors, Setpoint, Shares};
use strainwave_desktop::baseline::Baseline;
use strainwave_desktop::closed_loop::{self, Controller, Run};
use strainwave_desktop::joint::{CONTROL_PERIOD, joint_params, source};
use strainwave_desktop::log::MeasuredLog;
use strainwave_desktop::plant::encoder_count;
use strainwave_desktop::scenario::Scenario;
use strainwave_desktop::{Figure, GearFile};

use crate::firmware::{self, Firmware};
use crate::machine::{Ending, Machine};
use crate::scratch::Scratch;
use crate::target::{Agreement, Error, Target};

/// What came of one scenario.
pub struct ScenarioRun {
    /// Which.
    pub scenario: Scenario,
    /// The firmware's compensator.
    pub compensated: Run,
    /// B0, the cascade alone.
    pub b0: Run,
    /// B1, with a rigid joint's feed-forward.
    pub b1: Run,
    /// Target against host.
    pub agreement: Agreement,
    /// The firmware's report.
    pub ending: Ending,
}

impl ScenarioRun {
    /// The compensated output error; in S2 it must be below both baselines on the same plant.
    pub fn beside_baselines(&self) -> Figure {
        let name = format!("pil.{}.compensated.rms", self.scenario.name());
        match self.scenario {
            Scenario::S2 => Figure::bounded(name, self.compensated.rms, "rad", self.b0.rms.min(self.b1.rms)),
            _ => Figure::reported(name, self.compensated.rms, "rad"),
        }
    }
}

/// Builds a board's firmware for the joint of a gear file.
///
/// # Errors
/// As [`firmware::build`]; a gear that no compensator can be built from.
pub fn build(board: &str, file: &GearFile) -> Result<Firmware, firmware::Error> {
    let joint = joint_params(file).map_err(std::io::Error::other)?;
    let folder = Scratch::new("joint")?;
    let generated = folder.path().join("joint.rs");
    std::fs::write(&generated, source(&joint, &file.gear.name))?;
    firmware::build(board, Some(&generated))
}

/// Runs a scenario on the plant of `seed`, the firmware and both baselines side by side.
///
/// # Errors
/// When the machine fails, or a parameter is out of range.
pub fn run(
    elf: &Path,
    qemu_arguments: &[String],
    file: &GearFile,
    scenario: Scenario,
    seed: u64,
    progress: impl FnMut(f64),
) -> Result<ScenarioRun, Error> {
    std::thread::scope(|scope| {
        let baseline = |build: fn(&GearFile) -> Result<Baseline, strainwave::Error>| {
            scope.spawn(move || closed_loop::run(file, scenario, seed, &mut build(file)?, |_| ()))
        };
        let (b0, b1) = (baseline(Baseline::b0), baseline(Baseline::b1));
        let (compensated, agreement, ending) =
            compensated(elf, qemu_arguments, file, scenario, seed, progress)?;
        let (b0, b1) = (joined(b0)?, joined(b1)?);
        Ok(ScenarioRun { scenario, compensated, b0, b1, agreement, ending })
    })
}

/// What a thread came back with; its panic goes on here.
fn joined<T>(thread: std::thread::ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// Runs a scenario on the plant of `seed` with the firmware alone.
///
/// # Errors
/// As [`run`].
pub fn compensated(
    elf: &Path,
    qemu_arguments: &[String],
    file: &GearFile,
    scenario: Scenario,
    seed: u64,
    progress: impl FnMut(f64),
) -> Result<(Run, Agreement, Ending), Error> {
    let mut target = Target::new(Machine::boot(elf, qemu_arguments)?, &joint_params(file)?)?;
    let run = closed_loop::run(file, scenario, seed, &mut target, progress)?;
    let agreement = target.agreement();
    Ok((run, agreement, target.finish()?))
}

/// One control period of a replay.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReplayRow {
    /// (s)
    pub time: f64,
    /// Measured output encoder, from the first sample (rad).
    pub measured: f64,
    /// Output that the observer predicts from the motor side (rad).
    pub predicted: f64,
    /// Output of a rigid gear (rad).
    pub rigid: f64,
}

/// What came of a replay.
pub struct Replay {
    /// One row a control period.
    pub rows: Vec<ReplayRow>,
    /// Predicted against measured output, mean removed, rms (rad).
    pub rms: f64,
    /// The same of a rigid gear.
    pub rigid_rms: f64,
    /// Target against host.
    pub agreement: Agreement,
    /// The firmware's report.
    pub ending: Ending,
}

/// Feeds a measured log through the firmware's observer; the output encoder is kept from it.
///
/// # Errors
/// When the machine fails, or a parameter is out of range.
pub fn replay(
    elf: &Path,
    qemu_arguments: &[String],
    file: &GearFile,
    log: &MeasuredLog,
    mut progress: impl FnMut(f64),
) -> Result<Replay, Error> {
    let mut target = Target::new(Machine::boot(elf, qemu_arguments)?, &joint_params(file)?)?;
    let ratio = file.gear.signed_ratio();
    let instants = log.time.resampled(CONTROL_PERIOD);
    let count = instants.len() as f64;
    let mut rows = Vec::with_capacity(instants.len());
    for (k, instant) in instants.enumerate() {
        let motor = Angle::<f64>::from_radians_f64(instant.of(&log.motor_position));
        let rigid = ratio.apply(motor).to_radians();
        let input = Input {
            sensors: Sensors {
                motor_encoder: encoder_count(motor, file.sensors.motor_encoder_bits),
                output_encoder: None,
                motor_torque: instant.of(&log.motor_torque) as f32,
                output_torque: log.output_torque.as_ref().map(|torque| instant.of(torque) as f32),
            },
            // Nothing is commanded: the setpoint is where the joint already is.
            setpoint: Setpoint { position: Angle::from_radians_f64(rigid), ..Setpoint::default() },
            shares: Shares::default(),
        };
        let answer = target.step(&input)?;
        rows.push(ReplayRow {
            time: instant.elapsed,
            measured: log.output_position.as_ref().map_or(f64::NAN, |angle| instant.of(angle)),
            predicted: answer.estimate.output_position.to_radians(),
            rigid,
        });
        if k % 100 == 0 {
            progress(k as f64 / count);
        }
    }
    let rms = spread(&rows, |row| row.predicted - row.measured);
    let rigid_rms = spread(&rows, |row| row.rigid - row.measured);
    let agreement = target.agreement();
    Ok(Replay { rows, rms, rigid_rms, agreement, ending: target.finish()? })
}

/// Standard deviation of a figure over all rows.
fn spread(rows: &[ReplayRow], figure: impl Fn(&ReplayRow) -> f64) -> f64 {
    let count = rows.len() as f64;
    let mean = rows.iter().map(&figure).sum::<f64>() / count;
    (rows.iter().map(|row| (figure(row) - mean).powi(2)).sum::<f64>() / count).sqrt()
}
