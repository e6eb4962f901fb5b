//! The full-precision reference build, the plant, baselines, scenarios and files.
