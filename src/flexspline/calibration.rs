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
//! With [`Hardening::Bends`] there is no contact line: all compliance is the mesh's, and k gives it K1. Its bend links
//! harden by a cubic that saturates, of the elongation from the assembled shape (`chain.rs`).
//!
//! Damping: the catalogue's modal damping ratio zeta of the torsion mode (stiffness K1, inertia J_fs)
//! is placed in the lubricated contact as a dashpot. Seen from outside a dashpot behind a series
//! spring counts by the square of its fraction of the motion, hence c_contact = c*(K_contact1/K1)^2,
//! c = 2*zeta*sqrt(K1*J_fs). The links' own mu gives the first torsion mode of the shell the same
//! zeta; more would not be steel and would govern the stable step. Without a contact spring the dashpot c lies across
//! the whole flexspline.

use crate::error::{Error, require};
use crate::flexspline::chain::{Chain, MeshLaw};
pub use crate::flexspline::condensation::unit_stiffness;
use crate::flexspline::cup::Cup;
use crate::flexspline::shell::{Bend, ShellParams};
use crate::flexspline::stiffness_line::StiffnessLineParams;
use crate::real::Real;

/// Where the flexspline's hardening lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hardening {
    /// In the tooth contact at the rim, in series with a linear shell of steel.
    #[default]
    Contact,
    /// In the bend links of the mesh, which is all of the compliance.
    Bends,
}

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
    /// Where the hardening lies.
    pub hardening: Hardening,
    /// Hardening of the mesh's bend links. With [`Hardening::Contact`] in their elongation from the free length, which the
    /// reduced mesh does not have; with [`Hardening::Bends`] in that from the assembled shape, and
    /// [`Bend::LINEAR`] stands for the one that follows the catalogue's line.
    pub bend: Bend<R>,
}

impl<R: Real> FlexsplineParams<R> {
    /// # Errors
    /// As [`Cup::check`] and [`StiffnessLineParams::build`]; `stiffness` when the line is stiffer than
    /// the cup itself; `damping_ratio` outside 0..1; `inertia` not positive.
    pub fn check(&self) -> Result<(), Error> {
        self.cup.check()?;
        self.line.build()?;
        self.bend.check()?;
        let shell = self.cup.stiffness();
        require(self.line.stiffness.iter().all(|k| *k < shell), "stiffness")?;
        require(self.damping_ratio >= R::ZERO && self.damping_ratio < R::ONE, "damping_ratio")?;
        require(self.inertia.is_positive(), "inertia")
    }

    /// The tooth contact's line: the catalogue's without the shell.
    pub fn contact_line(&self) -> StiffnessLineParams<R> {
        self.line.without_series(self.cup.stiffness())
    }

    /// The shell: one k for all links that gives an n x M mesh the stiffness of the cup, or K1 when its bend links
    /// harden, and the mu that gives the mesh's first torsion mode the joint's damping ratio.
    pub fn shell<const M: usize>(&self, n: usize) -> ShellParams<R> {
        let ratio = R::lit(2.0) * self.damping_ratio / self.cup.torsion_frequency();
        if self.hardening == Hardening::Bends {
            let link_stiffness = self.line.stiffness[0] / unit_stiffness::<R, M>(&self.cup, n, &Bend::LINEAR);
            let softer = (self.cup.stiffness() / self.line.stiffness[0]).sqrt();
            let bend = self.assembled_bend::<M>(n, link_stiffness);
            return ShellParams {
                cup: self.cup,
                link_stiffness,
                link_damping: ratio * softer * link_stiffness,
                bend,
            };
        }
        let link_stiffness = self.cup.stiffness() / unit_stiffness::<R, M>(&self.cup, n, &self.bend);
        ShellParams { cup: self.cup, link_stiffness, link_damping: ratio * link_stiffness, bend: self.bend }
    }

    /// The hardening from the assembled shape: as given, or that which follows the line.
    fn assembled_bend<const M: usize>(&self, n: usize, link_stiffness: R) -> Bend<R> {
        if self.bend.hardening > R::ZERO {
            return self.bend;
        }
        Chain::<R, M>::new(&self.cup, n, link_stiffness).following(&self.line).unwrap_or(Bend::LINEAR)
    }

    /// The law of an n x M mesh whose bend links harden: torque over torsion in pieces up to `largest` torque (N m), and the
    /// angle of each slice over torsion and torque.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `stiffness` when no hardening of the bend links follows the line, `m` below 3.
    pub(super) fn mesh_law<const M: usize>(&self, n: usize, largest: R) -> Result<MeshLaw<R, M>, Error> {
        require(M > 2, "m")?;
        let shell = self.shell::<M>(n);
        require(shell.bend.hardening > R::ZERO, "stiffness")?;
        Chain::new(&self.cup, n, shell.link_stiffness).law(&shell.bend, largest)
    }

    /// The tooth contact's dashpot (N m s/rad).
    pub fn contact_damping(&self) -> R {
        let relative = self.contact_line().stiffness[0] / self.line.stiffness[0];
        self.damping() * relative * relative
    }

    /// A dashpot across the whole flexspline that gives the torsion mode its damping ratio (N m s/rad).
    pub(super) fn damping(&self) -> R {
        R::lit(2.0) * self.damping_ratio * (self.line.stiffness[0] * self.inertia).sqrt()
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
        hardening: Hardening::Contact,
        bend: Bend::LINEAR,
    };
}
