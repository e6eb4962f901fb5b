//! CSV files: UTF-8, a header row, SI units, the time column `t_s`; columns in any order.
//!
//! The conditions of a refusal, and the count of rows, are in `columns.rs` and `time.rs`; every refusal is one
//! line that names the file, the row and the column. Numbers are bounded in magnitude too, far beyond
//! any joint, so that a damaged digit is refused where it stands.

mod columns;
mod commanded_motion;
mod end_forces;
mod input_output;
mod joined;
mod link_input;
mod measured;
mod open_loop;
mod soundness;
mod time;
mod written;

pub use columns::Extra;
pub(crate) use commanded_motion::place;
pub use commanded_motion::{CommandedMotion, LONGEST_MOTION};
pub use end_forces::write_open_loop_with_forces;
pub use input_output::InputOutput;
pub use link_input::LinkInputLog;
pub use measured::MeasuredLog;
pub use open_loop::{BeltRow, Drive, DriveSample, OpenLoop, OpenLoopRow, write_belt, write_open_loop};
pub(crate) use soundness::BOTH_DIRECTIONS;
pub use time::{GAP_LEAST, GAP_RATIO, Instant, Jitter, LONGEST, Time};
pub use written::{write_columns, write_rows};

/// Longest file (bytes).
const LONGEST_FILE: u64 = 1 << 30;
/// Largest angle (rad): 10^8 revolutions.
const ANGLE_LIMIT: f64 = 6.3e8;
/// Largest speed (rad/s).
const SPEED_LIMIT: f64 = 1e5;
/// Largest torque (N m).
const TORQUE_LIMIT: f64 = 1e6;
