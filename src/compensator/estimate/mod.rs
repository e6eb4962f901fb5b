//! Estimates of motion, torsion, torques and external load.

pub mod disturbance;
pub mod observer;
