//! Link constants from the gear's data, for any n x m.
//!
//! The shell is a steel tube, so its torsional stiffness is that of a thin-walled tube,
//!
//! ```text
//! K_shell = G*J/l,   G = E/(2*(1 + nu)),   J = 2*pi*R^3*h
//! ```
//!
//! and every link gets the one constant k of eq. (6) that gives the mesh this stiffness. Torsion is
//! axisymmetric: all nodes of a slice rotate by one angle psi_j, and a link from slice j to j + dj whose
//! direction has the tangential cosine c lengthens by R*c*(psi_{j+dj} - psi_j). The mesh is therefore a
//! chain of m angles; the inner ones are eliminated (static condensation) and k follows by division.
//!
//! The tooth contact, softer than the tube, gives the rest of the catalogue's line: its compliances are the
//! catalogue's less the shell's ([`StiffnessLineParams::without_series`]).
//!
//! Damping: the catalogue's modal damping ratio zeta of the torsion mode (stiffness K1, inertia J_fs)
//! is placed in the lubricated contact as a dashpot. Seen from outside a dashpot behind a series
//! spring counts by the square of its fraction of the motion, hence c_contact = c*(K_contact1/K1)^2,
//! c = 2*zeta*sqrt(K1*J_fs). The links' own mu gives the first torsion mode of the shell the same
//! zeta; more would not be steel and would govern the stable step.

use crate::error::{Error, require};
pub use crate::flexspline::condensation::unit_stiffness;
use crate::flexspline::cup::Cup;
use crate::flexspline::shell::{Bend, ShellParams};
use crate::flexspline::stiffness_line::StiffnessLineParams;
use crate::real::Real;

/// Everything that a flexspline is built from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlexsplineParams<R> {
    /// The cup.
    pub cup: Cup<R>,
    /// The catalogue's K1, K2, K3 and T1, T2.
    pub line: StiffnessLineParams<R>,
    /// Damping ratio zeta of the torsion mode, wave generator held, 0..1.
    pub damping_ratio: R,
    /// Inertia J_fs that the damping ratio refers to (kg m^2).
    pub inertia: R,
    /// Hardening of the mesh's bend links.
    pub bend: Bend<R>,
}

impl<R: Real> FlexsplineParams<R> {
    /// # Errors
    /// As [`Cup::check`] and [`StiffnessLineParams::build`]; `stiffness` when the line is stiffer than
    /// the cup itself; `damping_ratio` outside 0..1; `inertia` not positive.
    pub fn check(&self) -> Result<(), Error> {
        self.cup.check()?;
        self.line.build()?;
        let shell = self.cup.stiffness();
        require(self.line.stiffness.iter().all(|k| *k < shell), "stiffness")?;
        require(self.damping_ratio >= R::ZERO && self.damping_ratio < R::ONE, "damping_ratio")?;
        require(self.inertia.is_positive(), "inertia")
    }

    /// The tooth contact's line: the catalogue's without the shell.
    pub fn contact_line(&self) -> StiffnessLineParams<R> {
        self.line.without_series(self.cup.stiffness())
    }

    /// The shell: one k for all links that gives an n x M mesh the stiffness of the cup, and the mu that gives
    /// the tube's first torsion mode the joint's damping ratio.
    pub fn shell<const M: usize>(&self, n: usize) -> ShellParams<R> {
        let link_stiffness = self.cup.stiffness() / unit_stiffness::<R, M>(&self.cup, n, &self.bend);
        let time = R::lit(2.0) * self.damping_ratio / self.cup.torsion_frequency();
        ShellParams { cup: self.cup, link_stiffness, link_damping: time * link_stiffness, bend: self.bend }
    }

    /// The tooth contact's dashpot (N m s/rad).
    pub fn contact_damping(&self) -> R {
        let k1 = self.line.stiffness[0];
        let relative = self.contact_line().stiffness[0] / k1;
        R::lit(2.0) * self.damping_ratio * (k1 * self.inertia).sqrt() * relative * relative
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The default gear's flexspline.
    pub(crate) const SIZE_25: FlexsplineParams<f64> = FlexsplineParams {
        cup: Cup {
            radius: 0.031,
            length: 0.037,
            wall: 0.40e-3,
            ellipse: 0.30e-3,
            youngs_modulus: 206e9,
            poisson_ratio: 0.3,
            density: 7850.0,
        },
        line: StiffnessLineParams { stiffness: [3.1e4, 5.0e4, 5.7e4], knee_torque: [14.0, 48.0] },
        damping_ratio: 0.02,
        inertia: 1.2,
        bend: Bend::LINEAR,
    };
}
