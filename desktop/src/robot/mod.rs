//! Robots of several joints: gears between motors and the links of an arm, each joint with a controller of its own.
//!
//! [`mod@file`] reads a robot, [`urdf`] the links of one, [`chain`] moves its rigid links, [`flexible`] those that bend, [`plant`] couples them with the gears, [`mod@bench`] closes the loop of
//! every joint, [`circle`] and [`motions`] are what the arm is asked for, [`run`] is what came of it.

pub mod beam;
pub mod bench;
pub mod chain;
pub mod circle;
pub mod file;
pub mod flexible;
pub mod jet;
mod joint;
pub mod motions;
pub mod plant;
pub mod run;
pub mod sample;
pub mod urdf;
mod urdf_file;

pub use bench::RobotBench;
pub use circle::Circle;
pub use file::RobotFile;
pub use plant::RobotPlant;
pub use run::RobotRun;
pub use sample::RobotSample;
