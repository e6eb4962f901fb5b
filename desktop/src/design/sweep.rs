//! The loop as the real code closes it: a small sine is added to its torque command, and what comes back is measured.
//!
//! ```text
//! u_applied = u + D sin(w t),   L = -U/U_applied       fundamentals over a second, after a second's settling
//! ```
//!
//! The f64 compensator at rest on the linear [`Plant`], its disturbance path within its dead zone; encoders of 30 bits,
//! friction, hysteresis and kinematic error off.

use std::f64::consts::TAU;

use nalgebra::Complex;
use strainwave::Error;
use strainwave::compensator::{CompensationGains, Compensator, Input, Sensors, Setpoint};

use super::corners::{Corner, Point};
use super::loops::torque_loop;
use super::mode::Mode;
use super::plant::{OUTPUTS, Plant};
use super::rules;
use super::variant::Variant;
use crate::design::joint::joint_params;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// D (N m) over the motor's peak torque: so little that the observer takes the motor to stand, so much that the dead zones of counts take
/// less than 2 % of what comes back.
const SINE: f64 = 1e-3;
/// Control periods of a second.
const SECOND: usize = (1.0 / CONTROL_PERIOD) as usize;
/// A dead zone that nothing passes (N m).
const WIDE: f64 = 1e6;

/// One frequency: in Hz, |L| measured and linear (dB).
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// (Hz)
    pub frequency: f64,
    /// Of the real code (dB).
    pub measured: f64,
    /// Of the linear loop (dB).
    pub linear: f64,
}

/// The gear without what is not linear.
pub fn linear_file(file: &GearFile) -> GearFile {
    let mut file = file.clone();
    for side in [&mut file.friction.input, &mut file.friction.output] {
        (side.coulomb, side.static_level) = (Some(1e-9), Some(1e-9));
    }
    file.hysteresis.width_arcmin = 0.0;
    (file.hysteresis.half_range, file.hysteresis.weights) = (None, None);
    file.kinematic_error = Default::default();
    (file.sensors.motor_encoder_bits, file.sensors.output_encoder_bits) = (30, Some(30));
    file
}

fn raw(angle: f64) -> u32 {
    let counts = f64::from(1 << 30);
    ((angle / TAU * counts).round().rem_euclid(counts)) as u32
}

/// Measured and linear at whole frequencies (Hz).
///
/// # Errors
/// A gear that cannot be built.
pub fn sweep(file: &GearFile, set: SensorSet, frequencies: &[u32]) -> Result<Vec<Measured>, Error> {
    let file = linear_file(file);
    let mut params = joint_params::<f64>(&file)?;
    params.disturbance.dead_zone = WIDE;
    let compensator = params.build()?;
    let corner = Corner { bandwidth: 1000.0, ..Corner::nominal(Mode::Standing) };
    let plant = Plant::new(&file, &corner);
    let variant = Variant { set, mode: Mode::Standing, point: Point::K1, passes: false };
    let omegas: Vec<f64> = frequencies.iter().map(|f| TAU * f64::from(*f)).collect();
    let linear = torque_loop(&file, &rules::parts(&file)?, variant, &corner, &omegas);
    let decibel = |l: Complex<f64>| 20.0 * l.norm().log10();
    let measured = |omega| decibel(measure(&file, &compensator, &plant, set, omega));
    let points = omegas.into_iter().zip(linear);
    Ok(points
        .map(|(omega, linear)| Measured {
            frequency: omega / TAU,
            measured: measured(omega),
            linear: decibel(linear),
        })
        .collect())
}

/// L of the real code at w (rad/s).
fn measure(
    file: &GearFile,
    compensator: &Compensator<f64>,
    plant: &Plant,
    set: SensorSet,
    omega: f64,
) -> Complex<f64> {
    let discrete = plant.discrete();
    let (mut state, mut x) = (compensator.rest(), vec![0.0; plant.states()]);
    let [mut commanded, mut applied] = [Complex::new(0.0, 0.0); 2];
    for k in 0..2 * SECOND {
        let input = input(file, set, plant.read(&x));
        let command = compensator.control(&mut state, &input).motor_torque;
        let phase = omega * CONTROL_PERIOD * k as f64;
        let sine = SINE * file.motor.peak_torque * phase.sin();
        if k >= SECOND {
            let rotation = Complex::from_polar(1.0, -phase);
            commanded += rotation * command;
            applied += rotation * (command + sine);
        }
        plant.step(&discrete, &mut x, command + sine);
    }
    -commanded / applied
}

fn input(file: &GearFile, set: SensorSet, [motor, output, torque, gauge]: [f64; OUTPUTS]) -> Input<f64> {
    let mut sensors = Sensors { motor_encoder: raw(motor), motor_torque: torque, ..Sensors::default() };
    if set == SensorSet::Both {
        sensors.output_encoder = Some(raw(output));
    }
    if file.sensors.output_torque {
        sensors.output_torque = Some(gauge);
    }
    Input {
        sensors,
        command: Setpoint::default().into(),
        gains: CompensationGains { adaptation: 0.0, ripple: 0.0, friction: 0.0, ..CompensationGains::ALL }
            .into(),
        ..Input::default()
    }
}
