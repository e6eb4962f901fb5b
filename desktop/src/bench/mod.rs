//! Bench: a joint in closed loop, on its tasks, under any controller.

pub mod any_input;
pub mod baseline;
pub mod closed_loop;
pub mod controller;
pub mod joint_bench;
pub mod motion;
pub mod output_bounds;
pub mod placed_gauge;
pub mod scenario;
pub mod task;
pub mod torque_fusion;
pub mod torque_sensing;
pub mod trajectory;
pub mod working_life;
pub mod working_motion;

pub use joint_bench::{Bench, Conditions};
pub use motion::Motion;
pub use task::periods;
pub use trajectory::Trajectory;
