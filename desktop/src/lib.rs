//! The full-precision reference build, the plant, baselines, scenarios and files.

pub mod any_friction;
pub mod baseline;
pub mod bench;
pub mod bounds;
pub mod closed_loop;
pub mod compensation;
pub mod data;
mod dense;
pub mod divergence;
pub mod draw;
pub mod figure;
pub mod file;
pub mod friction_params;
pub mod gear_file;
pub mod identify;
pub mod joint;
pub mod judge;
pub mod log;
pub mod mesh_size;
pub mod observer_design;
pub mod plant;
pub mod plot;
pub mod replay;
pub mod report;
pub mod ripple_fit;
pub mod scenario;
mod settled;
pub mod step_response;
pub mod torque_loop;
pub mod two_port;
pub mod vectorised;
pub mod verify;
pub mod working_motion;

pub use figure::Figure;
pub use file::BadInput;
pub use gear_file::GearFile;
