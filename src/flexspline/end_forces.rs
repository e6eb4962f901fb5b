//! Forces on the mesh's ends, node by node: the balances of rim and flange.
//!
//! The links pull at the end nodes; wave generator, tooth contact and flange hold against them. At rest the
//! forces of both ends balance, in all three directions and about the axis:
//!
//! ```text
//! radial:      the wave generator presses the rim into its ellipse; zero without it
//! tangential:  sum over a slice * R = the torque through it
//! axial:       what keeps the rim's and the diaphragm's nodes in their planes
//! ```
//!
//! Forces ON the shell in N, in each node's own frame: radial outward, tangential counter-clockwise, axial away
//! from the rim. Inertia of the end nodes is not in them.

use crate::flexspline::mesh::{Mesh, MeshState};
use crate::flexspline::shell::ring::Ring;
use crate::real::Real;

/// Force on a node in its own frame (N).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NodeForce<R> {
    /// Outward.
    pub radial: R,
    /// Counter-clockwise, seen against the axis.
    pub tangential: R,
    /// Towards the flange.
    pub axial: R,
}

impl<R: Real, const N: usize, const M: usize> Mesh<R, N, M> {
    /// Forces that hold the nodes 0..n of the rim and of the flange, of a state that was stepped last with its
    /// ends where they are.
    pub fn end_forces(&self, state: &MeshState<R, N, M>) -> [[NodeForce<R>; N]; 2] {
        let mut links = [[Ring::ZERO; 3]; M];
        self.shell().pull(state.shell(), &mut links);
        [0, M - 1].map(|slice| {
            core::array::from_fn(|i| {
                let pull = links[slice].each_ref().map(|axis| axis.node(i));
                held(pull, state.shell().position(i, slice))
            })
        })
    }
}

/// The force against a pull (N), at a node's position (m), in the frame of its radius.
fn held<R: Real>([x, y, z]: [R; 3], [along_x, along_y, _]: [R; 3]) -> NodeForce<R> {
    let inverse_radius = R::ONE / (along_x * along_x + along_y * along_y).sqrt();
    let (cosine, sine) = (along_x * inverse_radius, along_y * inverse_radius);
    NodeForce { radial: -(x * cosine + y * sine), tangential: x * sine - y * cosine, axial: -z }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle::Angle;
    use crate::flexspline::calibration::tests::SIZE_25;
    use crate::flexspline::{Ends, Flexspline};

    type Coarse = Mesh<f64, 8, 3>;

    /// Settled under a torsion (rad): the forces of both ends and the torque.
    fn settled(torsion: f64, ellipse: f64) -> ([[NodeForce<f64>; 8]; 2], f64) {
        let mut params = SIZE_25;
        params.cup.ellipse = ellipse;
        let mesh = Coarse::build(&params, 0.9 * Coarse::stable_step(&params)).unwrap();
        let ends = Ends {
            drive: Angle::from_radians(torsion),
            wave_generator: Angle::from_radians(0.3),
            ..Ends::default()
        };
        let mut state = mesh.rest();
        mesh.relax(&mut state, &ends, 20_000);
        let torque = mesh.step(&mut state, &ends).flange;
        (mesh.end_forces(&state), torque)
    }

    fn sum(forces: &[NodeForce<f64>; 8], of: fn(&NodeForce<f64>) -> f64) -> f64 {
        forces.iter().map(of).sum()
    }

    #[test]
    fn tangential_forces_carry_the_torque_through_both_ends() {
        let ([rim, flange], torque) = settled(1e-3, SIZE_25.cup.ellipse);
        let radius = SIZE_25.cup.radius;
        assert!(torque > 40.0);
        // The flange is round; at the rim the arm changes with the ellipse, by 1 %.
        assert!((sum(&flange, |f| f.tangential) * radius / -torque - 1.0).abs() < 1e-9);
        assert!((sum(&rim, |f| f.tangential) * radius / torque - 1.0).abs() < 2e-2);
        assert!((sum(&rim, |f| f.axial) + sum(&flange, |f| f.axial)).abs() < 1e-3);
    }

    /// Along the major axis the rim is pushed outward, along the minor axis it is held inward.
    #[test]
    fn the_wave_generator_presses_the_rim_into_its_ellipse() {
        let ([rim, flange], _) = settled(0.0, SIZE_25.cup.ellipse);
        let weighted: f64 = rim
            .iter()
            .enumerate()
            .map(|(i, force)| force.radial * (2.0 * (core::f64::consts::TAU * i as f64 / 8.0 - 0.3)).cos())
            .sum();
        assert!(weighted > 100.0, "{weighted} N");
        let largest =
            |forces: &[NodeForce<f64>; 8]| forces.iter().fold(0.0, |m: f64, f| m.max(f.radial.abs()));
        assert!(largest(&rim) > largest(&flange));
        let (ends, _) = settled(0.0, 0.0);
        assert!(ends.iter().all(|forces| largest(forces) < 1e-6), "a round rim needs no pressing");
    }
}
