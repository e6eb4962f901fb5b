use crate::stand_in::JointParams;

/// The joint that this firmware controls.
pub const JOINT: JointParams<f32> = JointParams { stiffness: 3.1e4 };
