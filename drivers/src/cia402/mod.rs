//! CiA 402, the CANopen profile of drives, from both of its sides.
//!
//! | file | |
//! | --- | --- |
//! | `drive` | we are the master of a drive, which takes a torque |
//! | [`node`] | our joint is the drive, which an arm's controller commands |
//! | `state` | states, statuswords and controlwords, which both sides share |

mod drive;
pub mod node;
mod state;

pub use drive::{Cause, Drive, Feedback, Params};
pub use state::State;
