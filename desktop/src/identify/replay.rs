//! A measured log through the observer, motor side only: the output encoder is what is predicted.
//!
//! ```text
//! predicted = theta_fs + error of the output encoder's scale at r*theta_motor        rigid = r*theta_motor
//! ```
//!
//! theta_fs is the observer's estimate, from the motor's angle and torque alone. A log may begin in motion, the observer
//! begins at rest: before its first row the motor is led up to that row's speed v over `LEAD_IN` T,
//!
//! ```text
//! theta(u) = theta_0 - v*((T - u)/2 + T/(2 pi)*sin(pi u/T)),        u from 0 to T
//! ```
//!
//! with the torque of the first row. Angles (rad) count as the controller counts them: in whole revolutions from where the
//! lead-in starts. Torques (N m), signs as in [`strainwave::gear`].
//!
//! Both angles of a log count from arbitrary zeros, so a prediction has an offset. [`Judgement`] takes it from the rows
//! that were learnt from, and from no other, for the observer and for the rigid gear alike.

use std::f64::consts::{PI, TAU};

use strainwave::Angle;
use strainwave::compensator::{Directions, Input, Sensors, Setpoint};

use crate::bench::controller::Controller;
use crate::io::gear_file::GearFile;
use crate::io::log::{Drive, MeasuredLog};
use crate::plant::two_port::trajectory::Trajectory;
use crate::sensor::encoder::encoder_count;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Time over which the motor is led to the log's first speed (s): some periods of any joint's torsion mode.
const LEAD_IN: f64 = 0.5;
/// Time over which the first speed and torque are averaged (s): some rows of a log at 250 Hz.
const FIRST: f64 = 0.02;

/// One control period of a replay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReplayRow {
    /// (s)
    pub time: f64,
    /// Motor's angle as the controller counts it (rad).
    pub motor: f64,
    /// Motor's torque at its shaft (N m).
    pub motor_torque: f64,
    /// Torque at the output, where it was measured (N m).
    pub output_torque: Option<f64>,
    /// Measured output encoder, from the first sample (rad).
    pub measured: f64,
    /// Reading of the output encoder that is predicted from the motor side (rad).
    pub predicted: f64,
    /// Output of a rigid gear (rad).
    pub rigid: f64,
}

/// Feeds a measured log through a controller's observer, up to the time `until` (s); the output encoder is kept from it.
///
/// # Errors
/// When the controller fails.
pub fn replay<C: Controller>(
    controller: &mut C,
    file: &GearFile,
    log: &MeasuredLog,
    until: f64,
    mut progress: impl FnMut(f64),
) -> Result<Vec<ReplayRow>, C::Error> {
    let start = Start::of(log);
    let mut rows = Vec::new();
    for k in 0..start.steps() {
        start.step(controller, file, log, k)?;
    }
    // Linear between its rows the motor would change its speed at once, which no motor can.
    let position = Trajectory::new(log.time.stamps(), &Drive::Position(log.motor_position.clone()));
    let instants = log.time.resampled(CONTROL_PERIOD);
    let count = instants.len() as f64;
    for (k, instant) in instants.take_while(|instant| instant.elapsed <= until).enumerate() {
        let motor = position.at(instant.elapsed);
        let speed = motor.velocity;
        let motor = log.motor_position[0] + motor.angle - start.whole_turns;
        let motor_torque = instant.of(&log.motor_torque);
        let output_torque = log.output_torque.as_ref().map(|torque| instant.of(torque));
        let (rigid, theta) = step(controller, file, [motor, speed], motor_torque, output_torque)?;
        rows.push(ReplayRow {
            time: instant.elapsed,
            motor,
            motor_torque,
            output_torque,
            measured: log.output_position.as_ref().map_or(f64::NAN, |angle| instant.of(angle)),
            predicted: theta + file.sensors.output_encoder_error_at(rigid),
            rigid,
        });
        if k % 100 == 0 {
            progress(k as f64 / count);
        }
    }
    Ok(rows)
}

/// One step with the motor at an angle (rad) and a speed (rad/s); the rigid gear's output and the observer's (rad).
fn step<C: Controller>(
    controller: &mut C,
    file: &GearFile,
    [motor, speed]: [f64; 2],
    motor_torque: f64,
    output_torque: Option<f64>,
) -> Result<(f64, f64), C::Error> {
    let motor = Angle::<f64>::from_radians_f64(motor);
    let rigid = file.gear.signed_ratio().apply(motor).to_radians();
    let setpoint = Setpoint {
        position: Angle::from_radians_f64(rigid),
        velocity: (speed * file.gear.signed_ratio().value::<f64>()) as f32,
        ..Setpoint::default()
    };
    let input = Input {
        sensors: Sensors {
            motor_encoder: encoder_count(motor, file.sensors.motor_encoder_bits),
            motor_torque: motor_torque as f32,
            output_torque: output_torque.map(|torque| torque as f32),
            ..Sensors::default()
        },
        // Nothing is commanded: the setpoint moves as the joint does.
        command: setpoint.into(),
        gains: Directions::default(),
        ..Input::default()
    };
    Ok((rigid, controller.step(&input)?.estimate.output_position.to_radians()))
}

/// The lead-in of a log.
struct Start {
    /// theta_0 of the log (rad).
    motor: f64,
    /// v (rad/s)
    speed: f64,
    /// (N m)
    torque: f64,
    /// Offset of the controller's angle, which starts within half a revolution of 0, against the log's (rad).
    whole_turns: f64,
}

impl Start {
    fn of(log: &MeasuredLog) -> Self {
        let motor = log.motor_position[0];
        let speed = (log.time.at(FIRST).of(&log.motor_position) - motor) / FIRST;
        let first =
            log.time.stamps().iter().take_while(|stamp| **stamp - log.time.stamps()[0] <= FIRST).count();
        let torque = log.motor_torque[..first].iter().sum::<f64>() / first as f64;
        let begin = motor - speed * LEAD_IN / 2.0;
        Self { motor, speed, torque, whole_turns: (begin / TAU).round() * TAU }
    }

    fn steps(&self) -> usize {
        (LEAD_IN / CONTROL_PERIOD) as usize
    }

    fn step<C: Controller>(
        &self,
        controller: &mut C,
        file: &GearFile,
        log: &MeasuredLog,
        k: usize,
    ) -> Result<(), C::Error> {
        let u = k as f64 * CONTROL_PERIOD;
        let left = (LEAD_IN - u) / 2.0 + LEAD_IN / TAU * (PI * u / LEAD_IN).sin();
        let speed = self.speed * (0.5 - 0.5 * (PI * u / LEAD_IN).cos());
        let motor = self.motor - self.speed * left - self.whole_turns;
        let output_torque = log.output_torque.as_ref().map(|torque| torque[0]);
        step(controller, file, [motor, speed], self.torque, output_torque).map(|_| ())
    }
}

/// When the motor has gone the first `fraction` of the log's path (s). A joint may stand still for most of a log, and
/// shows nothing while it does: fractions of a moving joint's log are fractions of its motion.
pub fn time_of_path(log: &MeasuredLog, fraction: f64) -> f64 {
    let steps = || log.motor_position.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let expected = fraction * steps().sum::<f64>();
    let mut gone = 0.0;
    let reached = steps().position(|step| {
        gone += step;
        gone >= expected
    });
    let stamps = log.time.stamps();
    stamps[reached.map_or(stamps.len() - 1, |before| before + 1)] - stamps[0]
}

/// Prediction error of the output encoder in the rows that were not learnt from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Residual, the mean over the rows learnt from removed, rms (rad).
    pub rms: f64,
    /// The same of a rigid gear.
    pub rigid_rms: f64,
    /// Residual, its own mean removed: its shape alone, rms (rad).
    pub spread: f64,
    /// The same of a rigid gear.
    pub rigid_spread: f64,
}

impl Judgement {
    /// Of the rows after `learnt` (s); without rows that were learnt from each error has its own mean removed.
    pub fn of(rows: &[ReplayRow], learnt: f64) -> Self {
        let (learnt, judged) = rows.split_at(rows.partition_point(|row| row.time <= learnt));
        let predicted = |row: &ReplayRow| row.predicted - row.measured;
        let rigid = |row: &ReplayRow| row.rigid - row.measured;
        let learnt = if learnt.is_empty() { judged } else { learnt };
        Self {
            rms: rms(judged, predicted, mean(learnt, predicted)),
            rigid_rms: rms(judged, rigid, mean(learnt, rigid)),
            spread: rms(judged, predicted, mean(judged, predicted)),
            rigid_spread: rms(judged, rigid, mean(judged, rigid)),
        }
    }

    /// rms over that of the rigid gear.
    pub fn ratio(&self) -> f64 {
        self.rms / self.rigid_rms
    }
}

/// Mean of a figure over rows.
fn mean(rows: &[ReplayRow], figure: impl Fn(&ReplayRow) -> f64) -> f64 {
    rows.iter().map(figure).sum::<f64>() / rows.len() as f64
}

/// Rms of a figure about `offset`.
fn rms(rows: &[ReplayRow], figure: impl Fn(&ReplayRow) -> f64, offset: f64) -> f64 {
    mean(rows, |row| (figure(row) - offset).powi(2)).sqrt()
}
