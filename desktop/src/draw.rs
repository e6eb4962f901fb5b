//! How far a plant is off what its controller knows.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::gear::GearParams;

/// Largest relative deviation of the friction of either side.
pub const FRICTION: f64 = 0.2;
/// Largest relative deviation of K1, K2, K3, by one factor.
pub const STIFFNESS: f64 = 0.1;
/// Largest relative deviation of J_fs.
pub const INERTIA: f64 = 0.3;

/// Factors on the plant's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// On the friction of wave generator and flexspline.
    pub friction: [f64; 2],
    /// On K1, K2, K3.
    pub stiffness: f64,
    /// On J_fs.
    pub inertia: f64,
}

impl Draw {
    /// The plant that the controller knows.
    pub const NOMINAL: Self = Self { friction: [1.0; 2], stiffness: 1.0, inertia: 1.0 };

    /// A uniform draw from the box, the same for the same seed; seed 0 is the nominal plant.
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
        let mut off = *params;
        for (side, factor) in
            [&mut off.input_friction, &mut off.output_friction].into_iter().zip(self.friction)
        {
            side.scale(factor);
        }
        off.flexspline.line.stiffness = params.flexspline.line.stiffness.map(|k| k * self.stiffness);
        off.flexspline_inertia *= self.inertia;
        off.flexspline.inertia *= self.inertia;
        off
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear_file::GearFile;
    use crate::joint::gear_params;

    fn factors(draw: &Draw) -> [(f64, f64); 4] {
        let [input, output] = draw.friction;
        [(input, FRICTION), (output, FRICTION), (draw.stiffness, STIFFNESS), (draw.inertia, INERTIA)]
    }

    #[test]
    fn draws_fill_their_box_and_stay_inside() {
        let draws: Vec<_> = (1..=500).map(|seed| factors(&Draw::from_seed(seed))).collect();
        for place in 0..4 {
            let shares = draws.iter().map(|draw| (draw[place].0 - 1.0) / draw[place].1);
            let (least, greatest) = shares.fold((0.0f64, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
            assert!((-1.0 - 1e-12..-0.95).contains(&least), "{place}: {least}");
            assert!((0.95..=1.0 + 1e-12).contains(&greatest), "{place}: {greatest}");
        }
    }

    #[test]
    fn a_seed_repeats_and_seed_0_is_nominal() {
        assert_eq!(Draw::from_seed(7), Draw::from_seed(7));
        assert_ne!(Draw::from_seed(7), Draw::from_seed(8));
        let params = gear_params(&GearFile::default_gear());
        assert_eq!(Draw::from_seed(0).apply(&params), params);
    }

    #[test]
    fn each_factor_acts_on_its_own_parameters() {
        let params: GearParams<f64> = gear_params(&GearFile::default_gear());
        let draw = Draw { friction: [0.5, 2.0], stiffness: 3.0, inertia: 4.0 };
        let mut wanted = params;
        for (side, factor) in [(&mut wanted.input_friction, 0.5), (&mut wanted.output_friction, 2.0)] {
            side.scale(factor);
        }
        wanted.flexspline.line.stiffness = params.flexspline.line.stiffness.map(|k| 3.0 * k);
        wanted.flexspline_inertia *= 4.0;
        wanted.flexspline.inertia *= 4.0;
        assert_eq!(draw.apply(&params), wanted);
    }
}
