//! Hysteresis of the gear (the paper's `gearHyst`), eq. (9): two realisations of one Preisach operator.
//!
//! | file | |
//! | --- | --- |
//! | `weights` | mu(alpha, beta) on the triangular grid, and the gear's standard shape |
//! | `relays` | eq. (9) as it stands, with the energy of every relay: the reference |
//! | `everett` | the same weights as a table of output changes |
//! | `staircase` | the operator from its past extrema: the real-time one |
//! | `torsion` | the torque over torsion that the operator stands for |
//! | `table` | identified weights as a gear stores them |
//!
//! The half range U of the input is cut into L cells of width h = 2U/L. Grid inputs are the L + 1
//! cell edges -U + k*h; relay (i, j), i >= j, switches in the middle of a cell, up past
//! alpha_i = -U + (i + 1/2)*h and down past beta_j. A grid input therefore never sits on a threshold.

pub mod everett;
pub mod inverse;
mod memory;
pub mod relays;
pub mod staircase;
pub mod table;
pub mod torsion;
pub mod weights;

pub use everett::Everett;
pub use inverse::{Inverse, TorsionInverse};
pub use relays::{Relays, RelaysState};
pub use staircase::{Staircase, StaircaseState};
pub use table::HysteresisTable;
pub use torsion::{
    HysteresisTorque, TorsionHysteresis, TorsionHysteresisParams, TorsionHysteresisState, gap_for_width,
};
pub use weights::Weights;
