//! Readings of a motor in front of a belt as a baseline has them: its angle and torque at the wave generator.
//!
//! ```text
//! theta = (z_1/z_2)*theta_m,   tau_m = (z_1/z_2)*tau
//! ```
//!
//! As the compensator's own pulleys ([`strainwave::compensator::sense::pulleys`]), in whole numbers: the count at the wave generator is that of an
//! encoder of [`bits_at_wave_generator`].

use crate::design::wave_generator::bits_at_wave_generator;
use crate::io::gear_file::GearFile;

/// A belt in front of a baseline's cascade.
#[derive(Clone)]
pub(super) struct MotorSide {
    teeth: [i128; 2],
    /// Bits of the motor's encoder and of that at the wave generator.
    bits: [u32; 2],
    /// Last phase and whole angle of the motor, counts of 2^32 a revolution.
    phase: u32,
    counts: i64,
}

impl MotorSide {
    /// Of a gear file with a belt.
    pub fn of(file: &GearFile) -> Option<Self> {
        let belt = file.belt.as_ref()?;
        let bits = file.sensors.motor_encoder_bits;
        Some(Self {
            teeth: belt.pulley_teeth().map(i128::from),
            bits: [bits, bits_at_wave_generator(bits, belt.ratio())],
            phase: 0,
            counts: 0,
        })
    }

    /// A count of the motor's encoder as one at the wave generator.
    pub fn count(&mut self, raw: u32) -> u32 {
        let [motor, wave_generator] = self.bits;
        let phase = raw << (32 - motor);
        self.counts += i64::from(phase.wrapping_sub(self.phase).cast_signed());
        self.phase = phase;
        let turned = i128::from(self.counts) * self.teeth[0];
        (turned.div_euclid(self.teeth[1]) as u32) >> (32 - wave_generator)
    }

    /// A torque at the wave generator as one of the motor (N m).
    pub fn torque(&self, at_wave_generator: f64) -> f64 {
        at_wave_generator * self.teeth[0] as f64 / self.teeth[1] as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revolution_of_the_motor_is_so_many_teeth_of_the_wave_generator() {
        let file = GearFile::wrist();
        let [motor, driven] = file.belt.unwrap().pulley_teeth();
        let mut side = MotorSide::of(&file).unwrap();
        let bits = file.sensors.motor_encoder_bits;
        let eighth = 1u32 << (bits - 3);
        let mut last = 0;
        for step in 0..8 * driven {
            last = side.count((step * eighth) & ((1 << bits) - 1));
        }
        // z_2 revolutions less an eighth make z_1 revolutions less z_1/z_2 of it.
        let whole =
            2f64.powi(bits_at_wave_generator(bits, f64::from(motor) / f64::from(driven)).cast_signed());
        let expected = (1.0 - f64::from(motor) / f64::from(8 * driven)) * whole;
        assert!((f64::from(last) - expected).abs() <= 1.0, "{last} {expected}");
        assert!((side.torque(1.0) - f64::from(motor) / f64::from(driven)).abs() < 1e-15);
    }
}
