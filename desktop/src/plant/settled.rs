//! A mesh at rest under torsion.

use strainwave::flexspline::mesh::MeshState;
use strainwave::flexspline::{Ends, Flexspline, FlexsplineParams, Mesh, Reaction};
use strainwave::{Angle, Error};

use crate::plant::vectorised::Vectorised;

/// Fraction of the stable step that it settles by.
const STEP_SHARE: f64 = 0.9;

/// A mesh that settles from one torsion to the next.
pub(crate) struct Settled<const N: usize, const M: usize> {
    mesh: Vectorised<Mesh<f64, N, M>>,
    state: MeshState<f64, N, M>,
    steps: usize,
}

impl<const N: usize, const M: usize> Settled<N, M> {
    /// The assembled mesh, which takes `steps` to settle.
    pub fn build(params: &FlexsplineParams<f64>, steps: usize) -> Result<Self, Error> {
        params.check()?;
        let stable = Mesh::<f64, N, M>::stable_step(params);
        let mesh = Vectorised::new(Mesh::build(params, STEP_SHARE * stable)?);
        let state = mesh.rest();
        Ok(Self { mesh, state, steps })
    }

    /// Torque on the flange (N m), as in [`Self::reaction`].
    pub fn torque(&mut self, torsion: f64, wave_generator: f64) -> f64 {
        self.reaction(torsion, wave_generator).flange
    }

    /// Torques on the ends, the flange's angle 0, at a torsion and an angle of the wave generator (rad).
    pub fn reaction(&mut self, torsion: f64, wave_generator: f64) -> Reaction<f64> {
        let ends = Ends {
            drive: Angle::from_radians(torsion),
            wave_generator: Angle::from_radians_f64(wave_generator),
            ..Ends::default()
        };
        self.mesh.relax(&mut self.state, &ends, self.steps);
        self.mesh.step(&mut self.state, &ends)
    }

    /// Strain L/L0 - 1 of the link from node (i, j) that spans `direction`.
    ///
    /// # Errors
    /// As [`strainwave::flexspline::Shell::strain`].
    pub fn strain(&self, node: (usize, usize), direction: (i32, i32)) -> Result<f64, Error> {
        self.mesh.model().shell().strain(self.state.shell(), node, direction)
    }
}
