//! The full-precision reference build, the plant, baselines, scenarios and files.
//!
//! | room | what is in it |
//! | --- | --- |
//! | [`sensor`] | sensors with the errors of their datasheets |
//! | [`io`] | files: gear files, belt files, logs, measured data, figures |
//! | [`design`] | from a gear file to parameters and gains, and their margins |
//! | [`plant`] | the reference plant and the open-loop two-port |
//! | [`mod@bench`] | closed loop: tasks, sensors, controllers, baselines |
//! | [`robot`] | arms of several joints, each with its gear and its controller |
//! | [`catalogue`] | gears of sizes 8 to 100, and joints that are built with them |
//! | [`identify`] | from measurements to parameters |
//! | [`predict`] | blind predictions of measured logs |
//! | [`experiment`] | motions that show a joint's parameters |
//! | [`verify`] | claimed figures: metrics, bounds, and what measures them |
//! | [`speed`] | time that the real-time parts take on this machine |
//! | [`tune`] | search for a baseline's gains |
//! | [`report`] | pages and pictures |
//!
//! A room imports only from the library and from rooms above it.

pub mod bench;
pub mod catalogue;
pub mod design;
pub mod experiment;
pub mod identify;
pub mod io;
pub mod plant;
pub mod predict;
pub mod report;
pub mod robot;
pub mod sensor;
pub mod speed;
pub mod tune;
pub mod verify;

pub use io::{BadInput, BeltFile, Figure, GearFile, LinkFile, SensorFile};
