//! The full-precision reference build, the plant, baselines, scenarios and files.

pub mod figure;
pub mod file;
pub mod gear_file;
pub mod log;

pub use figure::Figure;
pub use file::BadInput;
pub use gear_file::GearFile;
