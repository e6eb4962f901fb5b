//! The full-precision reference build, the plant, baselines, scenarios and files.

pub mod figure;

pub use figure::Figure;
