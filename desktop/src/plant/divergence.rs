//! A reference run that has left what its model describes.
//!
//! Every link of the mesh is looked at after every control period. A mesh that has diverged goes from 10 % of strain
//! to numbers that are none within some micro-steps, and those spread by two nodes a micro-step: the first
//! micro-step whose loss is not finite ends the period, so that the node which is named is still near those from
//! which it began. Its strain is then NaN or infinite, and others may have the same.

use strainwave::flexspline::shell::link_law::VALID_STRAIN;
use strainwave::flexspline::{Flexspline, Strained};
use strainwave::gear::Torques;
use strainwave::{Error, Real};

/// When and where a run diverged.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "diverged at {time:.6} s: a link of node (i, j) = ({}, {}) is strained by {strain:.3}; allowed: {VALID_STRAIN} \
     either way", node.0, node.1
)]
pub struct Diverged {
    /// (s)
    pub time: f64,
    /// An end of the link.
    pub node: (usize, usize),
    /// L/L0 - 1.
    pub strain: f64,
}

/// Why a run of the reference build ended.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RunError {
    /// A parameter that no model can be built from.
    #[error(transparent)]
    Parameter(#[from] Error),
    /// The mesh.
    #[error(transparent)]
    Diverged(#[from] Diverged),
}

/// The micro-steps of a period may go on.
pub fn may_go_on<R: Real>(torques: &Torques<R>) -> bool {
    torques.damping_loss.is_finite()
}

impl Diverged {
    /// # Errors
    /// At this time (s), when the most strained link of a flexspline that has links is beyond what its law is made
    /// for, or its last torques are none.
    pub fn check<R: Real, F: Flexspline<R>>(
        time: f64,
        flexspline: &F,
        state: &F::State,
        last: &Torques<R>,
    ) -> Result<(), Self> {
        let most = flexspline.largest_strain(state);
        match most.filter(|most| !most.is_valid() || !may_go_on(last)) {
            None => Ok(()),
            Some(Strained { node, strain }) => Err(Self { time, node, strain: strain.to_f64() }),
        }
    }
}
