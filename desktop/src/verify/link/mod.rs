//! The arm link: eigenvalues and steady deflections against closed forms, a motion against finite elements, its laws.

pub mod eigenvalues;
mod laws;
pub mod motion;
mod steady;

use super::Measured;

/// Every figure.
pub(super) fn measure() -> Measured {
    [eigenvalues::measure(), steady::measure(), motion::measure(), laws::measure()].concat().into()
}
