//! The mesh in real time: one law and one dashpot for 0.1 ms.
//!
//! ```text
//! tau = line(phi) + c_piece * dphi
//! ```
//!
//! Derivation from eq. (6). (1) Torque and torsion are axisymmetric, so of the ring's harmonics only
//! harmonic 0 of the tangential displacement couples to them; the ellipse excites harmonic 2, which
//! carries no torque. What is left of an n x m mesh is a chain of m angles. (2) The chain's lowest
//! frequency is that of the steel tube, (pi/l)*sqrt(G/rho) = 43 kHz for size 25: against a 0.1 ms step
//! it is quasi-static, and the inner angles condense into one spring K_shell, whatever n and m are
//! ([`super::calibration::unit_stiffness`] does this for the calibration). (3) The rim between shell
//! and tooth contact carries no mass that matters at these frequencies, so the two are in series:
//! compliances add, which gives the line, and the contact's dashpot acts with its share of the motion
//! squared, `c_piece = c_contact*(K_piece/K_contact,piece)^2`.
//!
//! Torque in N m, torsion in rad, positive when the drive is ahead of the flange. No state. What is
//! neglected: the inertia of the shell (2e-5 of J_fs), the time constants of the shell (4 us) and of
//! the dashpot against the shell (c/K_shell, below 0.1 ms).

use crate::error::Error;
use crate::flexspline::calibration::FlexsplineParams;
use crate::flexspline::stiffness_line::StiffnessLine;
use crate::flexspline::{Ends, Flexspline, Reaction};
use crate::real::Real;

/// The condensed mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduced<R> {
    line: StiffnessLine<R>,
    /// Dashpot of each piece of the line (N m s/rad).
    damping: [R; 3],
}

impl<R: Real> Reduced<R> {
    /// Condenses the mesh that these parameters describe.
    ///
    /// # Errors
    /// As [`FlexsplineParams::check`].
    pub fn build(params: &FlexsplineParams<R>) -> Result<Self, Error> {
        params.check()?;
        let contact = params.contact_line();
        let whole = contact.in_series(params.cup.stiffness());
        let mut damping = [params.contact_damping(); 3];
        for (c, (k, k_contact)) in damping.iter_mut().zip(whole.stiffness.into_iter().zip(contact.stiffness))
        {
            *c *= (k / k_contact) * (k / k_contact);
        }
        Ok(Self { line: whole.build()?, damping })
    }

    /// Torque at a torsion and its rate (N m).
    #[inline(never)] // The timing budget counts blocks by their symbols.
    pub fn torque(&self, torsion: R, rate: R) -> R {
        self.line.torque(torsion) + self.damping(torsion) * rate
    }

    /// Torsion that carries a torque at rest (rad).
    #[inline(always)]
    pub fn torsion(&self, torque: R) -> R {
        self.line.torsion(torque)
    }

    /// Slope of that torsion over the torque (rad/(N m)).
    #[inline(always)]
    pub fn compliance(&self, torque: R) -> R {
        self.line.compliance(torque)
    }

    #[inline(always)]
    fn damping(&self, torsion: R) -> R {
        let [first, second, third] = self.damping;
        match self.line.piece(torsion) {
            0 => first,
            1 => second,
            _ => third,
        }
    }
}

impl<R: Real> Flexspline<R> for Reduced<R> {
    type State = ();

    fn rest(&self) -> Self::State {}

    fn step(&self, _state: &mut Self::State, ends: &Ends<R>) -> Reaction<R> {
        let torsion = ends.drive.minus(ends.flange);
        let rate = ends.drive_rate - ends.flange_rate;
        let torque = self.torque(torsion, rate);
        Reaction {
            contact: torque,
            flange: torque,
            ellipse: R::ZERO,
            loss: self.damping(torsion) * rate * rate,
        }
    }

    fn energy(&self, _state: &Self::State, ends: &Ends<R>) -> R {
        self.line.energy(ends.drive.minus(ends.flange))
    }
}
