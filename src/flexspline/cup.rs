//! The cup of a flexspline, and the links of a mesh over it.

use crate::angle::Angle;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Half of the 16 link directions (the other half are their opposites): steps around and along.
pub const DIRECTIONS: [(i32, usize); 8] = [(1, 0), (0, 1), (1, 1), (-1, 1), (2, 0), (0, 2), (2, 2), (-2, 2)];

/// The flexspline's cup.
#[constants]
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

impl<R: Real> Cup<R> {
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first dimension or constant that is not positive,
    /// or `poisson_ratio` outside 0..0.5, `wall` or `ellipse` not below a tenth of the radius.
    pub fn check(&self) -> Result<(), Error> {
        require(self.radius.is_positive(), "radius")?;
        require(self.length.is_positive(), "length")?;
        let tenth = self.radius * R::lit(0.1);
        require(self.wall.is_positive() && self.wall < tenth, "wall")?;
        require(self.ellipse >= R::ZERO && self.ellipse < tenth, "ellipse")?;
        require(self.youngs_modulus.is_positive(), "youngs_modulus")?;
        require(self.poisson_ratio >= R::ZERO && self.poisson_ratio < R::lit(0.5), "poisson_ratio")?;
        require(self.density.is_positive(), "density")
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
