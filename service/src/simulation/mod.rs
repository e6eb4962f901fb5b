//! Flash whose power fails and lines that garble, simulated on the host: what tests and `strainwave verify tuning` measure with.

pub mod cuts;
pub mod flash;
pub mod frames;
pub mod host;
pub mod joint;
