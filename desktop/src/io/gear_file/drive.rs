//! `[drive]` and `[tolerances]`: the box that the joint of a gear file lies in.
//!
//! Omitted keys have the defaults below: the parameter ranges of the judged plants
//! ([`crate::plant::unknowns`], [`crate::plant::box_sample`]).

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Largest relative deviation of the friction of either side.
pub const FRICTION: f64 = 0.2;
/// Largest relative deviation of K1, K2, K3, by one factor.
pub const STIFFNESS: f64 = 0.1;
/// Largest relative deviation of J_fs.
pub const INERTIA: f64 = 0.3;

/// `[drive]`: what makes a torque of the command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drive {
    /// Longest delay beyond the control's own, the shortest is none (control periods).
    #[serde(rename = "delay_periods")]
    pub delay: u32,
    /// Least bandwidth of the current loop (Hz).
    #[serde(rename = "current_loop_least_hz")]
    pub least_current_loop: f64,
    /// Largest bandwidth of the current loop (Hz).
    #[serde(rename = "current_loop_largest_hz")]
    pub largest_current_loop: f64,
    /// Largest relative deviation of the torque constant.
    #[serde(rename = "torque_constant_tolerance")]
    pub torque_constant: f64,
}

/// Time constants of a current loop in which it reaches its command to 2 %.
const RESPONSE: f64 = 4.0;

impl Drive {
    /// Longest time in which the drive reaches its command (s): its delay, and the response of the slowest current loop.
    pub fn response(&self) -> f64 {
        f64::from(self.delay) * CONTROL_PERIOD + RESPONSE / (TAU * self.least_current_loop)
    }
}

impl Default for Drive {
    fn default() -> Self {
        Self { delay: 2, least_current_loop: 500.0, largest_current_loop: 2000.0, torque_constant: 0.1 }
    }
}

/// `[tolerances]`: how well the parameters are known, as largest relative deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerances {
    /// Of J_wg.
    pub rotor_inertia: f64,
    /// Of J_fs.
    pub load_inertia: f64,
    /// Of K1, K2, K3, by one factor.
    pub stiffness: f64,
    /// Of the friction of either side.
    pub friction: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self { rotor_inertia: 0.1, load_inertia: INERTIA, stiffness: STIFFNESS, friction: FRICTION }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::io::gear_file::GearFile;

    fn parse(text: &str) -> Result<GearFile, String> {
        GearFile::parse(Path::new("g.toml"), text.as_bytes()).map_err(|error| error.to_string())
    }

    /// The default gear with these sections in the place of [drive] and [tolerances].
    fn with(sections: &str) -> Result<GearFile, String> {
        let mut table: toml::Table = GearFile::default_gear().to_toml().parse().unwrap();
        table.remove("drive");
        table.remove("tolerances");
        parse(&format!("{table}\n{sections}\n"))
    }

    #[test]
    fn what_is_left_out_has_its_default() {
        let plain = with("").unwrap();
        assert_eq!((plain.drive, plain.tolerances), (Drive::default(), Tolerances::default()));
        assert_eq!(plain, GearFile::default_gear());
        let slow = with("[drive]\ncurrent_loop_least_hz = 300\n[tolerances]\nload_inertia = 0.5").unwrap();
        assert_eq!(slow.drive, Drive { least_current_loop: 300.0, ..Drive::default() });
        assert_eq!(slow.tolerances, Tolerances { load_inertia: 0.5, ..Tolerances::default() });
    }

    #[test]
    fn a_late_drive_with_a_slow_current_loop_takes_longer_to_respond() {
        let response = Drive::default().response();
        assert!((response - 1.473e-3).abs() < 1e-6, "{response}");
        assert!(Drive { delay: 5, ..Drive::default() }.response() > response + 2.9e-4);
        assert!(Drive { least_current_loop: 250.0, ..Drive::default() }.response() > response + 1.2e-3);
    }

    #[test]
    fn a_current_loop_whose_ends_are_exchanged_is_named() {
        let refused = with("[drive]\ncurrent_loop_least_hz = 3000.0").unwrap_err();
        assert!(refused.starts_with("g.toml: drive.current_loop_least_hz = 3000"), "{refused}");
        assert!(refused.contains("at most drive.current_loop_largest_hz = 2000 Hz"), "{refused}");
    }
}
