//! Sample from the box of parameter tolerances: factors of a plant's parameters on its controller's.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::gear::GearParams;

pub use crate::io::gear_file::drive::{FRICTION, INERTIA, STIFFNESS};
use crate::plant::driving_belt::DrivingBeltParams;

/// Factors on the plant's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxSample {
    /// On the friction of wave generator and flexspline.
    pub friction: [f64; 2],
    /// On K1, K2, K3.
    pub stiffness: f64,
    /// On J_fs.
    pub inertia: f64,
}

impl BoxSample {
    /// The plant that the controller knows.
    pub const NOMINAL: Self = Self { friction: [1.0; 2], stiffness: 1.0, inertia: 1.0 };

    /// A uniform sample from the box, the same for the same seed; seed 0 is the nominal plant.
    pub fn from_seed(seed: u64) -> Self {
        if seed == 0 {
            return Self::NOMINAL;
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut factor = |span: f64| random.random_range(1.0 - span..=1.0 + span);
        Self {
            friction: [factor(FRICTION), factor(FRICTION)],
            stiffness: factor(STIFFNESS),
            inertia: factor(INERTIA),
        }
    }

    /// The parameters with the factors applied; knee torques and damping ratio stay.
    pub fn apply(&self, params: &GearParams<f64>) -> GearParams<f64> {
        let mut sampled = *params;
        for (side, factor) in
            [&mut sampled.input_friction, &mut sampled.output_friction].into_iter().zip(self.friction)
        {
            side.scale(factor);
        }
        sampled.flexspline.line.stiffness = params.flexspline.line.stiffness.map(|k| k * self.stiffness);
        sampled.flexspline_inertia *= self.inertia;
        sampled.flexspline.inertia *= self.inertia;
        sampled
    }

    /// The belt in front of the gear, off in its stiffness as the gear is.
    pub fn apply_to_belt(&self, mut belt: DrivingBeltParams) -> DrivingBeltParams {
        belt.span.stiffness *= self.stiffness;
        belt
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::firmware_gear_params;
    use crate::io::gear_file::GearFile;

    fn factors(sample: &BoxSample) -> [(f64, f64); 4] {
        let [input, output] = sample.friction;
        [(input, FRICTION), (output, FRICTION), (sample.stiffness, STIFFNESS), (sample.inertia, INERTIA)]
    }

    #[test]
    fn samples_fill_their_box_and_stay_inside() {
        let samples: Vec<_> = (1..=500).map(|seed| factors(&BoxSample::from_seed(seed))).collect();
        for place in 0..4 {
            let relative = samples.iter().map(|sample| (sample[place].0 - 1.0) / sample[place].1);
            let (least, greatest) = relative.fold((0.0f64, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
            assert!((-1.0 - 1e-12..-0.95).contains(&least), "{place}: {least}");
            assert!((0.95..=1.0 + 1e-12).contains(&greatest), "{place}: {greatest}");
        }
    }

    #[test]
    fn a_seed_repeats_and_seed_0_is_nominal() {
        assert_eq!(BoxSample::from_seed(7), BoxSample::from_seed(7));
        assert_ne!(BoxSample::from_seed(7), BoxSample::from_seed(8));
        let params = firmware_gear_params(&GearFile::default_gear()).unwrap();
        assert_eq!(BoxSample::from_seed(0).apply(&params), params);
    }

    #[test]
    fn each_factor_acts_on_its_own_parameters() {
        let params: GearParams<f64> = firmware_gear_params(&GearFile::default_gear()).unwrap();
        let sample = BoxSample { friction: [0.5, 2.0], stiffness: 3.0, inertia: 4.0 };
        let mut expected = params;
        for (side, factor) in [(&mut expected.input_friction, 0.5), (&mut expected.output_friction, 2.0)] {
            side.scale(factor);
        }
        expected.flexspline.line.stiffness = params.flexspline.line.stiffness.map(|k| 3.0 * k);
        expected.flexspline_inertia *= 4.0;
        expected.flexspline.inertia *= 4.0;
        assert_eq!(sample.apply(&params), expected);
    }
}
