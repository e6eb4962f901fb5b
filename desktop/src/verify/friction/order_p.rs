//! Eq. (8) of orders 1 to 4 with general A, B, C against scipy: 20 random stable, dissipative systems, each
//! along 24 strokes.
//!
//! Systems, strokes and scipy's forces are `desktop/oracle/friction/bliman_sorine.toml`.

use serde::Deserialize;
use strainwave::friction::state_space::StateSpaceState;
use strainwave::friction::{FrictionModel, FrictionParams, StateSpaceParams};

use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

const STORED: &str = include_str!("../../../oracle/friction/bliman_sorine.toml");

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    system: Vec<System>,
}

/// A system, a path, and scipy's forces along it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct System {
    /// A by rows (1/m).
    pub a_per_m: Vec<Vec<f64>>,
    b: Vec<f64>,
    c: Vec<f64>,
    /// -C A^-1 B (N).
    level_n: f64,
    strokes_m: Vec<f64>,
    forces_n: Vec<f64>,
}

pub(super) fn measure() -> Vec<Figure> {
    vec![bounds::figure("friction.order_p.scipy", largest(stored().iter().map(System::distance)))]
}

/// The stored systems.
///
/// # Panics
/// When the embedded file is not what this code reads, which is a mistake in the program.
pub fn stored() -> Vec<System> {
    let stored: Stored = toml::from_str(STORED).expect("bliman_sorine.toml has systems");
    stored.system
}

impl System {
    /// P.
    pub fn order(&self) -> usize {
        self.b.len()
    }

    /// Largest distance from scipy's force, as a fraction of the kinetic level.
    ///
    /// # Panics
    /// When the system is of another order than 1 to 4, or is refused.
    pub fn distance(&self) -> f64 {
        match self.order() {
            1 => self.distance_of::<1>(),
            2 => self.distance_of::<2>(),
            3 => self.distance_of::<3>(),
            4 => self.distance_of::<4>(),
            order => panic!("order {order}"),
        }
    }

    fn distance_of<const P: usize>(&self) -> f64 {
        let row = |values: &Vec<f64>| <[f64; P]>::try_from(values.as_slice()).expect("P columns");
        let a = std::array::from_fn(|i| row(&self.a_per_m[i]));
        let params = StateSpaceParams { a, b: row(&self.b), c: row(&self.c) };
        let model = params.build().expect("the system is stable and dissipative");
        let mut state = StateSpaceState::default();
        assert_eq!(self.strokes_m.len(), self.forces_n.len(), "a force a stroke");
        largest(self.strokes_m.iter().zip(&self.forces_n).map(|(&stroke, force)| {
            model.slide(&mut state, stroke);
            (model.force(&state) - force).abs() / self.level_n
        }))
    }
}
