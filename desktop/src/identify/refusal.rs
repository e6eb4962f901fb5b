//! Why an identified gear file is not written: a file that is worse than the one that it came from helps nobody.

use std::cmp::Ordering;

use crate::design::buildable::use_of;
use crate::io::gear_file::GearFile;

/// The first reason against an identified gear file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// `strainwave check` would refuse the file, for this reason.
    #[error("{0}")]
    Invalid(String),
    /// A parameter ends where its search does.
    #[error("{parameter} is at the limit of its search, {factor} times the base gear's")]
    AtLimit {
        /// Key of the gear file.
        parameter: &'static str,
        /// Its value over the base gear's.
        factor: f64,
    },
    /// The part held out is predicted worse than by the base gear.
    #[error("it predicts the part held out to {rms:.3e} rad, the base gear to {base_rms:.3e} rad")]
    Worse {
        /// Rms error of the identified gear (rad).
        rms: f64,
        /// The same of the base gear.
        base_rms: f64,
    },
}

impl Refusal {
    /// Of a gear, the parameters at a limit with their factors on the base gear's, and the rms errors on the part held out of the
    /// gear and of its base (rad); `None` when the file may be written.
    pub fn of(gear: &GearFile, limits: &[(&'static str, f64)], held_out: Option<(f64, f64)>) -> Option<Self> {
        let invalid = gear.check().map_err(|why| why.to_string()).and_then(|()| use_of(gear)).err();
        let limit = limits.first().map(|&(parameter, factor)| Self::AtLimit { parameter, factor });
        // An error that is not a number is worse, too.
        let worse = held_out
            .filter(|(rms, base_rms)| rms.partial_cmp(base_rms).is_none_or(Ordering::is_gt))
            .map(|(rms, base_rms)| Self::Worse { rms, base_rms });
        invalid.map(Self::Invalid).or(limit).or(worse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gear_is_refused_for_each_reason_and_for_no_other() {
        let gear = GearFile::default_gear();
        assert_eq!(Refusal::of(&gear, &[], None), None);
        assert_eq!(Refusal::of(&gear, &[], Some((1e-5, 1e-5))), None);
        let worse = Refusal::Worse { rms: 1.1e-5, base_rms: 1e-5 };
        assert_eq!(Refusal::of(&gear, &[], Some((1.1e-5, 1e-5))), Some(worse));
        assert!(matches!(Refusal::of(&gear, &[], Some((f64::NAN, 1e-5))), Some(Refusal::Worse { .. })));
        let limit = Refusal::of(&gear, &[("stiffness.k1_nm_per_rad", 10.0)], None).unwrap();
        assert!(
            limit.to_string().starts_with("stiffness.k1_nm_per_rad is at the limit of its search, 10 times")
        );
    }

    #[test]
    fn what_check_refuses_is_refused_with_its_reason() {
        let mut gear = GearFile::default_gear();
        gear.hysteresis.width_arcmin = -1e-19;
        let Some(Refusal::Invalid(why)) = Refusal::of(&gear, &[], None) else { panic!("it is not refused") };
        assert!(why.contains("hysteresis.width_arcmin = -"), "{why}");
    }
}
