//! How far a plant is off what its controller knows.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::gear::GearParams;

/// Largest deviation of friction, stiffness and load inertia.
pub const FRICTION: f64 = 0.2;
/// See [`FRICTION`].
pub const STIFFNESS: f64 = 0.1;
/// See [`FRICTION`].
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
            side.coulomb *= factor;
            side.static_level *= factor;
            side.viscous *= factor;
        }
        off.flexspline.line.stiffness = params.flexspline.line.stiffness.map(|k| k * self.stiffness);
        off.flexspline_inertia *= self.inertia;
        off.flexspline.inertia *= self.inertia;
        off
    }
}
