//! A joint with a belt as a joint without one: the motor as it is at the wave generator.
//!
//! ```text
//! i = z_1/z_2,   J = J_wg + J_belt + J_rotor/i^2,   tau_max/i,   omega_max*i,   1/K = 1/K_gear + c/N^2
//! ```
//!
//! z_1 and z_2 are the teeth of the motor's pulley and of the wave generator's, c the belt's compliance there
//! ([`strainwave::belt::SeriesBelt`]), 1/N the gear's ratio. Observer, cascade and feedback of a joint with a belt are designed for
//! that joint, for both have the same torsion mode. A count of the motor's encoder is i times as fine there; it counts as one of a
//! whole number of bits that is no finer.

use strainwave::belt::{BeltParams, SeriesBeltParams};
use strainwave::friction::ViscousParams;

use crate::design::belt::driving_belt;
use crate::io::gear_file::{GearFile, Stiffness};

/// Most bits of an encoder.
const MOST_BITS: u32 = 32;

/// The same joint without a belt; a file without one as it is.
pub fn at_wave_generator(file: &GearFile) -> GearFile {
    let mut known = file.clone();
    let (Some(belt), Some(params)) = (known.belt.take(), driving_belt(file)) else { return known };
    let ratio = belt.ratio();
    known.inertia.wave_generator = driving_inertia(&params, ratio);
    known.stiffness = in_series(&file.stiffness, series_stiffness(file, &params));
    known.motor.peak_torque /= ratio;
    known.motor.rotor_speed_limit *= ratio;
    known.sensors.motor_torque_noise /= ratio;
    known.sensors.motor_encoder_noise = file.sensors.motor_encoder_noise.map(|noise| noise * ratio);
    known.sensors.motor_encoder_bits = bits_at_wave_generator(file.sensors.motor_encoder_bits, ratio);
    known
}

/// What the compensator knows of the belt.
pub fn series_belt(file: &GearFile) -> Option<SeriesBeltParams<f64>> {
    driving_belt(file).map(|params| SeriesBeltParams::of(&params))
}

/// Inertia of rotor, belt, pulleys and wave generator, as it is there (kg m^2).
fn driving_inertia(params: &BeltParams<f64, ViscousParams<f64>>, ratio: f64) -> f64 {
    params.inertia(&params.output, 0) + params.inertia(&params.motor, 0) / (ratio * ratio)
}

/// Stiffness of the belt as it is at the output (N m/rad).
fn series_stiffness(file: &GearFile, params: &BeltParams<f64, ViscousParams<f64>>) -> f64 {
    params.torsional_stiffness() * f64::from(file.gear.signed_ratio().n()).powi(2)
}

fn in_series(gear: &Stiffness, belt: f64) -> Stiffness {
    let softer = |k: f64| 1.0 / (1.0 / k + 1.0 / belt);
    Stiffness { k1: softer(gear.k1), k2: softer(gear.k2), k3: softer(gear.k3), ..*gear }
}

/// Bits of an encoder at the wave generator that is no finer than the motor's is there.
pub fn bits_at_wave_generator(bits: u32, ratio: f64) -> u32 {
    let finer = (-ratio.log2()).floor() as i32;
    bits.saturating_add_signed(finer).clamp(10, MOST_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::gear_file::belt::WRIST;

    #[test]
    fn a_joint_without_a_belt_is_as_it_is() {
        let file = GearFile::default_gear();
        assert_eq!(at_wave_generator(&file), file);
    }

    /// Power, kinetic energy and wind-up are those of the joint with the belt.
    #[test]
    fn the_motor_as_it_is_behind_its_belt() {
        let file = GearFile::wrist();
        let (known, belt) = (at_wave_generator(&file), file.belt.unwrap());
        known.check().unwrap();
        let power = |file: &GearFile| file.motor.peak_torque * file.motor.rotor_speed_limit;
        assert!((power(&known) / power(&file) - 1.0).abs() < 1e-12);
        let light = belt.rotor_inertia / belt.ratio().powi(2) + file.inertia.wave_generator;
        assert!((1.0..1.2).contains(&(known.inertia.wave_generator / light)), "{WRIST}");
        let series = series_belt(&file).unwrap();
        let n = f64::from(file.gear.ratio);
        let wind_up = 10.0 / file.stiffness.k1 + series.compliance * 10.0 / (n * n);
        assert!((10.0 / known.stiffness.k1 / wind_up - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_count_is_no_finer_than_it_is() {
        let bits = |ratio| bits_at_wave_generator(19, ratio);
        assert_eq!([1.0, 0.5, 0.6, 2.0, 1.5].map(bits), [19, 20, 19, 18, 18]);
    }
}
