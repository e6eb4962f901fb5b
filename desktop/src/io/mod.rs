//! Files: gear files, belt files, link files, sensor files, logs, measured data, figures.

pub mod belt_file;
pub mod data;
pub mod figure;
pub mod file;
pub mod gear_file;
pub mod keyed_file;
pub mod link_file;
pub mod log;
pub mod sensor_file;

pub use belt_file::BeltFile;
pub use figure::Figure;
pub use file::BadInput;
pub use gear_file::GearFile;
pub use link_file::LinkFile;
pub use sensor_file::SensorFile;
