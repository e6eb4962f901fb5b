//! Tuning: the search for a baseline's gains, and the objective that it minimises.

pub mod objective;
pub mod search;
