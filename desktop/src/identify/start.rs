//! Start of a held joint's log: where its angles count from, and which torque the joint came from.
//!
//! ```text
//! theta_measured = c + phi[m, tau]
//! ```
//!
//! The angles count from arbitrary zeros, so a log has an offset c (rad). The torsion before the first row is
//! not in the log either: the hysteresis starts as after one extreme torque m (N m) from the demagnetised state, m = 0 being
//! that state. Of [`CANDIDATES`] to either side, up to the rated torque, the m that fits the trained rows best is taken.

use std::iter::once;

use super::gear_log::GearLog;
use super::law::{Law, OnLaw};

/// Extreme torques that are tried to either side of none.
const CANDIDATES: i32 = 10;

/// c and m of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// c (rad).
    pub offset: f64,
    /// m (N m).
    pub extreme_torque: f64,
}

impl Start {
    /// That fits the first `count` rows of a log best; |m| up to `most` (N m).
    pub(super) fn of<const L: usize>(law: &Law<L>, log: &GearLog, count: usize, most: f64) -> Self {
        let mut best = (Self::default(), f64::INFINITY);
        // Where the log does not show m the smallest stays.
        for step in once(0).chain((1..=CANDIDATES).flat_map(|k| [k, -k])) {
            let extreme_torque = most * f64::from(step) / f64::from(CANDIDATES);
            let on = law.torsions_after(extreme_torque, &log.torque[..count]);
            let differences = || log.torsion.iter().zip(&on).map(|(measured, on)| measured - on.torsion);
            let offset = differences().sum::<f64>() / count as f64;
            let squares: f64 = differences().map(|difference| (difference - offset).powi(2)).sum();
            if squares < best.1 {
                best = (Self { offset, extreme_torque }, squares);
            }
        }
        best.0
    }

    /// c + phi at every row.
    pub(super) fn predicted(&self, on: &[OnLaw]) -> Vec<f64> {
        on.iter().map(|on| self.offset + on.torsion).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::gear_params;
    use crate::identify::law::torques;
    use crate::io::gear_file::GearFile;

    fn law() -> Law<24> {
        Law::of(&gear_params(&GearFile::default_gear())).unwrap()
    }

    #[test]
    fn the_start_of_a_log_comes_back_from_its_torsions() {
        let torque: Vec<_> = torques(&[0.0, 0.1, -0.1, 0.2]).map(|fraction| 100.0 * fraction).collect();
        for start in [-60.0, 0.0, 42.0].map(|m| Start { offset: 0.3, extreme_torque: m }) {
            let torsion = start.predicted(&law().torsions_after(start.extreme_torque, &torque));
            let log = GearLog { torque: torque.clone(), torsion, ..GearLog::default() };
            let found = Start::of(&law(), &log, torque.len(), 60.0);
            assert!((found.offset - start.offset).abs() < 1e-12, "{found:?} {start:?}");
            assert!((found.extreme_torque - start.extreme_torque).abs() < 1e-9, "{found:?} {start:?}");
        }
    }

    #[test]
    fn what_a_log_does_not_show_is_the_demagnetised_state() {
        // One row: every start gives it.
        let log = GearLog { torque: vec![1.0], torsion: vec![0.0], ..GearLog::default() };
        assert_eq!(Start::of(&law(), &log, 1, 60.0).extreme_torque, 0.0);
    }
}
