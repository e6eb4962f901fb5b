//! Files: gear files, link files, logs, measured data, figures.

pub mod data;
pub mod figure;
pub mod file;
pub mod gear_file;
pub mod link_file;
pub mod log;

pub use figure::Figure;
pub use file::BadInput;
pub use gear_file::GearFile;
pub use link_file::LinkFile;
