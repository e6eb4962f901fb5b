//! One log of a measured joint trains, another of the same joint is predicted by the observer, from the motor side.
//!
//! The logs count their angles from arbitrary zeros: of the predicted log the first third of the motion gives the offset of the
//! output, and where it is long enough the zeros of the motor's and of the output's angle, on which the phases of the kinematic error
//! and of the encoder's depend. The remainder is judged, for the trained, the untrained and the rigid gear alike.

use std::f64::consts::TAU;

use crate::identify::moving::{observe_log, without_errors};
use crate::identify::replay::{Judgement, ReplayRow, time_of_path};
use crate::identify::{Error, Refusal, learn_gear};
use crate::io::data;
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::{GearFile, Harmonic};
use crate::io::log::MeasuredLog;
use crate::verify::bounds::figure;
use crate::verify::replay::{LEARNT, read, shipped_gear};
use crate::verify::{Measured, largest};

/// Joints, whether their motor torque counts against the angle, and their logs.
const JOINTS: [(&str, bool, &[&str]); 4] = [
    ("j1", true, &["jog_j1", "jog_linear_mass", "multi_joint_0p5"]),
    ("j2", true, &["jog_j2_mass", "jog_linear_mass", "multi_joint_0p5"]),
    ("j3", false, &["jog_j2_mass", "jog_linear_mass", "multi_joint_0p5"]),
    ("j6", true, &["jog_linear_mass", "multi_joint_0p5"]),
];
/// Fraction of the motor's path that trains, as by default of the command; the rest decides whether the file is written.
const TRAINING: f64 = 0.5;
/// Zeros that are tried, a revolution.
const ZEROS: usize = 36;
/// Revolutions of the motor from which on its zero can be told: half a period of the order of two lobes.
const REVOLUTIONS: f64 = 0.25;
/// Every how many rows a zero is judged by.
const EVERY: usize = 200;

/// Every figure.
///
/// # Errors
/// Logs that are there and cannot be used.
pub fn measure() -> Result<Measured, BadInput> {
    let mut measured = Measured::default();
    let (mut over_rigid, mut over_untrained) = (Vec::new(), Vec::new());
    for (joint, reversed, logs) in JOINTS {
        let base = shipped_gear(joint)?;
        let Some(logs) = read_all(joint, reversed, logs)? else {
            return Ok(Measured::skipped("identify.pairs.*: skipped: no data (lara8)".into()));
        };
        for (name, log) in &logs {
            let trained = train(&base, log)?;
            for (other, predicted) in logs.iter().filter(|(other, _)| other != name) {
                let judge = |gear: &GearFile| judge(gear, predicted).map_err(BadInput::message);
                let untrained = judge(&base)?;
                let found = trained.as_ref().map_or(Ok(untrained), judge)?;
                over_rigid.push(found.ratio());
                over_untrained.push(found.rms / untrained.rms);
                let pair = format!("identify.pairs.{joint}.{name}.{other}");
                measured.figures.extend([
                    Figure::reported(format!("{pair}.over_rigid"), found.ratio(), "1"),
                    Figure::reported(format!("{pair}.untrained_over_rigid"), untrained.ratio(), "1"),
                ]);
            }
        }
    }
    measured.figures.extend([
        figure("identify.pairs.median_over_rigid", median(&mut over_rigid)),
        figure("identify.pairs.worst_over_untrained", largest(over_untrained)),
    ]);
    Ok(measured)
}

/// `None` when one is not there.
fn read_all<'a>(
    joint: &str,
    reversed: bool,
    logs: &[&'a str],
) -> Result<Option<Vec<(&'a str, MeasuredLog)>>, BadInput> {
    let read_one = |log: &&'a str| {
        let path = data::find(&format!("lara8/joint/{log}.{joint}.csv"));
        path.map(|path| Ok((*log, read(&path, reversed)?))).transpose()
    };
    logs.iter().map(read_one).collect()
}

/// From a log; `None` where nothing is written, and the base gear stays.
fn train(base: &GearFile, log: &MeasuredLog) -> Result<Option<GearFile>, BadInput> {
    let found = match learn_gear(base, log, TRAINING, |_| ()) {
        Ok(found) => found,
        Err(Error::TooLittleTravel { .. } | Error::ReversedTorque { .. }) => return Ok(None),
        Err(why) => return Err(BadInput::message(why)),
    };
    let held_out = found.judgement.zip(found.base_judgement).map(|(found, base)| (found.rms, base.rms));
    let refusal = Refusal::of(&found.gear, &found.friction.limits(), held_out);
    Ok(refusal.is_none().then_some(found.gear))
}

fn judge(gear: &GearFile, log: &MeasuredLog) -> Result<Judgement, Error> {
    let learnt = time_of_path(log, LEARNT);
    let mut rows = observe_log(&without_errors(gear), log)?;
    add_errors(gear, &mut rows, learnt);
    Ok(Judgement::of(&rows, learnt))
}

/// Adds the kinematic error and the encoder's with the zeros that fit the rows up to `learnt` (s) best; neither where they do
/// not tell.
fn add_errors(gear: &GearFile, rows: &mut [ReplayRow], learnt: f64) {
    let known = &rows[..rows.partition_point(|row| row.time <= learnt)];
    let motor = known.iter().map(|row| row.motor);
    let revolutions = (motor.clone().fold(f64::MIN, f64::max) - motor.fold(f64::MAX, f64::min)) / TAU;
    if revolutions < REVOLUTIONS {
        return;
    }
    let known: Vec<_> = known.iter().step_by(EVERY).copied().collect();
    let zeros = (0..ZEROS).flat_map(|motor| (0..ZEROS).map(move |output| [motor, output]));
    let zeros = zeros.map(|zeros| zeros.map(|zero| zero as f64 / ZEROS as f64 * TAU));
    let spread = |zeros: &[f64; 2]| {
        let left = known.iter().map(|row| row.predicted + errors(gear, row, zeros) - row.measured);
        let mean = left.clone().sum::<f64>() / known.len() as f64;
        left.map(|left| (left - mean).powi(2)).sum::<f64>()
    };
    if let Some(best) = zeros.min_by(|a, b| spread(a).total_cmp(&spread(b))) {
        rows.iter_mut().for_each(|row| row.predicted += errors(gear, row, &best));
    }
}

/// Kinematic error and that of the encoder, their angles counted from the zeros of motor and output (rad).
fn errors(gear: &GearFile, row: &ReplayRow, [motor, output]: &[f64; 2]) -> f64 {
    let sum = |harmonics: &[Harmonic], x: f64| harmonics.iter().map(|harmonic| harmonic.at(x)).sum::<f64>();
    let motor = row.motor + motor;
    let error = &gear.kinematic_error;
    sum(&error.wave_generator, motor)
        + sum(&error.flexspline, motor - row.rigid)
        + sum(&gear.sensors.output_encoder_error, row.rigid + output)
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        count if count.is_multiple_of(2) => (values[count / 2 - 1] + values[count / 2]) / 2.0,
        count => values[count / 2],
    }
}
