//! The flexspline: torque for torsion, as a mesh by eq. (6) or reduced to one law in real time.
//!
//! Both stand between the same two motions, the drive `r*theta_wg + e` at the tooth contact and the
//! output flange, and answer with the same torques, so that [`crate::gear::Gear`] composes either.
//!
//! The hardening has one of two places ([`Hardening`]). By default it is the tooth contact at the rim, in series with
//! a linear shell. More
//! teeth engage with torque (the paper's "non-stationary surface contact"), while the steel cup
//! itself is linear: its own stiffness G*J/l is about three times K3. A bend link that hardened in
//! plain L - L0 would respond mostly to the wave generator's ellipse (0.2-0.5 % of strain, rated torsion is
//! 0.1 %) and smear the catalogue's knees. As the other choice the bend links harden as in the paper, in their elongation
//! from the assembled, elliptic shape: the mesh is then all of the gear's compliance.

pub mod calibration;
mod chain;
mod condensation;
pub mod cup;
pub mod displacement_field;
pub mod end_forces;
pub mod mesh;
pub mod reduced;
pub mod shell;
mod spectrum;
pub mod stiffness_line;
pub mod strain_gauge;
pub mod torque_gauges;
pub mod two_links;

pub use calibration::{FlexsplineParams, Hardening};
pub use cup::Cup;
pub use displacement_field::DisplacementField;
pub use end_forces::NodeForce;
pub use mesh::Mesh;
pub use reduced::Reduced;
pub use shell::{Bend, Shell, ShellParams, Strained};
pub use stiffness_line::StiffnessLine;
pub use strain_gauge::StrainGauge;
pub use torque_gauges::{GaugeTorque, TorqueGauges, TorqueGaugesParams, TorqueGaugesState};
pub use two_links::{TwoLinks, TwoLinksParams};

use crate::angle::Angle;
use crate::real::Real;

/// Motion of both ends of the flexspline during one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ends<R> {
    /// Ideal output angle r*theta_wg + e(theta_wg): where the tooth contact drives the rim.
    pub drive: Angle<R>,
    /// Its rate (rad/s).
    pub drive_rate: R,
    /// Wave-generator angle, which orients the ellipse.
    pub wave_generator: Angle<R>,
    /// Its rate (rad/s).
    pub wave_generator_rate: R,
    /// Output flange angle theta_fs.
    pub flange: Angle<R>,
    /// Its rate (rad/s).
    pub flange_rate: R,
}

/// Torques of the flexspline on its ends (N m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reaction<R> {
    /// Torsion: drive angle less flange angle (rad).
    pub torsion: R,
    /// Through the tooth contact, positive for positive torsion: it loads the wave generator by r + de/dtheta.
    pub contact: R,
    /// On the output flange, positive for positive torsion.
    pub flange: R,
    /// On the wave generator, from rotating the ellipse; zero on average.
    pub ellipse: R,
    /// Power dissipated by the flexspline's damping (W).
    pub loss: R,
    /// The model has reached the end of its range: its torque is limited there.
    pub saturated: bool,
}

/// A flexspline model.
pub trait Flexspline<R: Real> {
    /// State of the model.
    type State: Clone;

    /// The state at rest with both ends at the zero angle, without torsion.
    fn rest(&self) -> Self::State;

    /// Advances by the model's time step and answers with the torques of that step.
    fn step(&self, state: &mut Self::State, ends: &Ends<R>) -> Reaction<R>;

    /// The most strained link of a model that has links; beyond [`Strained::is_valid`] the run has diverged.
    fn largest_strain(&self, _state: &Self::State) -> Option<Strained<R>> {
        None
    }

    /// Energy stored in `state`, elastic and kinetic (J), with its ends at `ends`.
    fn energy(&self, state: &Self::State, ends: &Ends<R>) -> R;
}
