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

use crate::angle::Angle;
use crate::error::{Error, require};
pub use crate::flexspline::condensation::unit_stiffness;
use crate::flexspline::shell::{Bend, ShellParams};
use crate::flexspline::stiffness_line::StiffnessLineParams;
use crate::real::Real;

/// Half of the 16 link directions (the other half are their opposites): steps around and along.
pub const DIRECTIONS: [(i32, usize); 8] = [(1, 0), (0, 1), (1, 1), (-1, 1), (2, 0), (0, 2), (2, 2), (-2, 2)];

/// The flexspline's cup.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cup<R> {
    /// Mean radius R (m).
    pub radius: R,
    /// Length l from rim to diaphragm (m).
    pub length: R,
    /// Wall thickness h (m).
    pub wall: R,
    /// Radial displacement w0 by the wave generator (m).
    pub ellipse: R,
    /// Young's modulus E (Pa).
    pub youngs_modulus: R,
    /// Poisson's ratio nu.
    pub poisson_ratio: R,
    /// Density rho (kg/m^3).
    pub density: R,
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
    /// Hardening of the mesh's bend links.
    pub bend: Bend<R>,
}

impl<R: Real> Cup<R> {
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first dimension or constant that is not positive,
    /// or `poisson_ratio` outside 0..0.5, `wall` or `ellipse` not below a tenth of the radius.
    pub fn check(&self) -> Result<(), Error> {
        let positive = |value: R| value.is_finite() && value > R::ZERO;
        require(positive(self.radius), "radius")?;
        require(positive(self.length), "length")?;
        let tenth = self.radius * R::lit(0.1);
        require(positive(self.wall) && self.wall < tenth, "wall")?;
        require(self.ellipse >= R::ZERO && self.ellipse < tenth, "ellipse")?;
        require(positive(self.youngs_modulus), "youngs_modulus")?;
        require(self.poisson_ratio >= R::ZERO && self.poisson_ratio < R::lit(0.5), "poisson_ratio")?;
        require(positive(self.density), "density")
    }

    /// Mass of the cylinder 2*pi*R*l*h*rho (kg).
    pub fn mass(&self) -> R {
        R::lit(core::f64::consts::TAU) * self.radius * self.length * self.wall * self.density
    }

    /// Torsional stiffness G*J/l of the tube (N m/rad).
    pub fn stiffness(&self) -> R {
        let shear_modulus = self.youngs_modulus / (R::lit(2.0) * (R::ONE + self.poisson_ratio));
        let polar = R::lit(core::f64::consts::TAU) * self.radius * self.radius * self.radius * self.wall;
        shear_modulus * polar / self.length
    }

    /// Lowest torsional angular frequency of the tube with both ends held, (pi/l)*sqrt(G/rho) (rad/s).
    pub fn torsion_frequency(&self) -> R {
        let shear_modulus = self.youngs_modulus / (R::lit(2.0) * (R::ONE + self.poisson_ratio));
        R::lit(core::f64::consts::PI) / self.length * (shear_modulus / self.density).sqrt()
    }
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
        require(self.inertia.is_finite() && self.inertia > R::ZERO, "inertia")
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

/// Length of a link that spans `around` of `n` nodes and `along` slices of `spacing` (m).
pub fn link_length<R: Real>(cup: &Cup<R>, n: usize, spacing: R, (around, along): (i32, usize)) -> R {
    let chord = R::lit(2.0) * cup.radius * Angle::from_turn_fraction(around, 2 * n as i32).sin_cos().0;
    let axial = spacing * R::from_i32(along as i32);
    (chord * chord + axial * axial).sqrt()
}

/// Whether a direction is a bend link's, to the next neighbours but one.
pub fn is_bend((around, along): (i32, usize)) -> bool {
    around.abs() == 2 || along == 2
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
