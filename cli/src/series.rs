//! Time series of a trial: what was asked, and of every controller what came of it, a row each control period.
//!
//! Columns that all share; columns of each controller, with its name: `compensated`, `b0` to `b3`; columns of the compensator alone:
//! what the plant did beside what was estimated of it. docs/src/commands.md lists them.

use std::path::Path;

use strainwave_desktop::BadInput;
use strainwave_desktop::bench::closed_loop::{Row, Run};
use strainwave_desktop::io::log::write_columns;
use strainwave_desktop::verify::judge::error;
use strainwave_emulator::pil::TrialRun;

/// Name and values of a column; the angle at which the bench has its zero is added to angles of the joint (rad).
type Column = (&'static str, fn(&Row, f64) -> f64);

/// What was asked.
const ASKED: [Column; 5] = [
    // Stamps on the grid, not with the last digits of their rounding.
    ("t_s", |row, _| (row.time * 1e9).round() / 1e9),
    ("theta_set_rad", |row, zero| zero + row.demand.position),
    ("omega_set_rad_s", |row, _| row.demand.velocity),
    ("alpha_set_rad_s2", |row, _| row.demand.acceleration),
    ("tau_load_nm", |row, _| row.demand.load),
];

/// What came of it under a controller, whose name replaces `*`.
const OF_CONTROLLER: [Column; 6] = [
    ("theta_out_*_rad", |row, zero| zero + row.output),
    ("error_*_rad", |row, _| error(row)),
    ("theta_motor_*_rad", |row, _| row.motor),
    ("torsion_*_rad", |row, _| row.torsion),
    ("tau_gear_*_nm", |row, _| row.transmitted),
    ("tau_motor_*_nm", |row, _| row.answer.motor_torque.into()),
];

/// What the compensator fed forward and estimated, and the truth that has no column yet.
const OF_COMPENSATOR: [Column; 11] = [
    ("tau_feed_forward_nm", |row, _| row.answer.feed_forward_torque.into()),
    ("theta_out_estimated_rad", |row, zero| zero + row.answer.estimate.output_position.to_radians()),
    ("omega_out_compensated_rad_s", |row, _| row.output_velocity),
    ("omega_out_estimated_rad_s", |row, _| row.answer.estimate.output_velocity.into()),
    ("torsion_estimated_rad", |row, _| row.answer.estimate.torsion.into()),
    ("tau_gear_estimated_nm", |row, _| row.answer.estimate.transmitted_torque.into()),
    ("friction_in_compensated_nm", |row, _| row.friction[0]),
    ("friction_in_estimated_nm", |row, _| row.answer.estimate.input_friction.into()),
    ("friction_out_compensated_nm", |row, _| row.friction[1]),
    ("friction_out_estimated_nm", |row, _| row.answer.estimate.output_friction.into()),
    ("tau_load_estimated_nm", |row, _| row.answer.estimate.external_torque.into()),
];

/// Writes the series of a trial, complete or not at all.
pub fn write(run: &TrialRun<'_>, path: &Path) -> Result<(), BadInput> {
    let (ours, zero) = (("compensated", &run.target.run), run.trial.motion.zero());
    let controllers = [ours].into_iter().chain(run.baselines.iter().map(|(name, run)| (*name, run)));
    let mut columns = of(&ASKED, ours, zero);
    columns.extend(controllers.flat_map(|controller| of(&OF_CONTROLLER, controller, zero)));
    columns.extend(of(&OF_COMPENSATOR, ours, zero));
    let columns: Vec<_> = columns.iter().map(|(name, values)| (name.clone(), values.as_slice())).collect();
    write_columns(path, &columns)
}

fn of(columns: &[Column], (name, run): (&str, &Run), zero: f64) -> Vec<(String, Vec<f64>)> {
    let values = |(title, value): &Column| {
        (title.replace('*', name), run.trace.iter().map(|row| value(row, zero)).collect())
    };
    columns.iter().map(values).collect()
}
