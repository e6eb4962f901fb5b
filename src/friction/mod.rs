//! Friction of the gear (the paper's `gearFric`): one file a model.
//!
//! Sign: a friction force has the sign of the velocity that it opposes, so that the equation of
//! motion subtracts it and `force * velocity` is the power lost. "Force" is N over m or N m over
//! rad; the equations are the same.

pub mod bliman_sorine;
pub mod joint_friction;
pub mod lubricated_contact;

pub use bliman_sorine::BlimanSorine;
pub use joint_friction::{JointFriction, JointFrictionParams, JointFrictionState, Order};
pub use lubricated_contact::{LubricatedContact, LubricatedContactParams};

/// Friction of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction<R> {
    /// Force (N) or torque (N m); finite for any input.
    pub force: R,
    /// The input was not finite: `force` is that of the step before and the state is untouched.
    pub held: bool,
}
