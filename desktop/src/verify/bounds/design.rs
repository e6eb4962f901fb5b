//! Bounds of `design`: stability margins of each loop, over the box of joint parameters.

use super::Bound;
use crate::design::required::{DELAY, GAIN, PHASE, SIZE};

const fn row(name: &'static str, value: f64, unit: &'static str, why: &'static str) -> Bound {
    Bound { name, value, unit, why }
}

const GAIN_WHY: &str = "gain margin of the loop at the motor's torque over the box: stable at twice the gain";
const PHASE_WHY: &str = "phase margin of the same: a damped closed loop";
const DELAY_WHY: &str =
    "delay margin of the same beyond the declared delay: stable with a drive two periods later";
const SIZE_WHY: &str = "largest |T|*|Delta| of the disturbance path, whose loop closes through the uncertainty: small-gain theorem";

/// Smallest allowed values.
pub(super) const FLOORS: [Bound; 6] = [
    row("design.motor.torque.gain", GAIN, "dB", GAIN_WHY),
    row("design.motor.torque.phase", PHASE, "deg", PHASE_WHY),
    row("design.motor.torque.delay", DELAY, "period", DELAY_WHY),
    row("design.both.torque.gain", GAIN, "dB", GAIN_WHY),
    row("design.both.torque.phase", PHASE, "deg", PHASE_WHY),
    row("design.both.torque.delay", DELAY, "period", DELAY_WHY),
];

pub(super) const ROWS: &[Bound] = &[
    row("design.motor.disturbance.uncertainty", SIZE, "1", SIZE_WHY),
    row("design.both.disturbance.uncertainty", SIZE, "1", SIZE_WHY),
];
