//! Zero of the output encoder: its reading where the joint's output angle is 0.
//!
//! The joint's angle is counted by the motor's encoder, theta = r*theta_motor where the gear is neither wound up nor
//! deformed. Of the first readings of both encoders that are accepted,
//!
//! ```text
//! z   = theta_out - theta                                  not calibrated
//! z   = z_c + k*2*pi*r,   k = round((theta_out - theta - z_c)/(2*pi*r))     calibrated
//! ```
//!
//! The first contains the noise of one reading and the torsion of that moment, and so does every angle from then on. The
//! calibrated zero z_c (rad) is the output encoder's reading where that of the motor's is 0, known but for whole turns of
//! the motor. It is right while the gear's torsion and kinematic error are below half of such a turn, pi*|r|.

use crate::angle::{Angle, Ratio};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// The built zero.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputZero {
    calibrated: bool,
    /// z_c, counts of 2^32 a revolution.
    zero: i32,
    ratio: Ratio,
}

impl OutputZero {
    /// From z_c (rad, -pi..=pi), where there is one, and n = 1/r.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `output_encoder_zero` outside its range, `ratio` as [`Ratio::one_over`].
    pub fn build<R: Real>(calibrated: Option<R>, ratio: i32) -> Result<Self, Error> {
        let zero = calibrated.unwrap_or(R::ZERO);
        require(zero.is_within(R::lit(core::f64::consts::PI)), "output_encoder_zero")?;
        let counts = Angle::from_radians(zero).phase().cast_signed();
        Ok(Self { calibrated: calibrated.is_some(), zero: counts, ratio: Ratio::one_over(ratio)? })
    }

    /// z of the first readings, which differ by `first` = theta_out - theta.
    #[cold]
    #[inline(never)]
    pub fn of<R: Real>(&self, first: Angle<R>) -> Angle<R> {
        if !self.calibrated {
            return first;
        }
        let zero = i64::from(self.zero);
        let beyond = Angle::from_counts(first.counts.wrapping_sub(zero));
        // Half a turn is added: what is left of the shift is rounded to the nearest one.
        let turns = self.ratio.to_motor::<R>(beyond).counts.wrapping_add(1 << 31) >> 32;
        let whole: Angle<R> = self.ratio.apply(Angle::from_counts(turns << 32));
        Angle::from_counts(whole.counts.wrapping_add(zero))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    fn of(calibrated: Option<f64>, ratio: i32, first: f64) -> f64 {
        OutputZero::build(calibrated, ratio).unwrap().of(Angle::<f64>::from_radians_f64(first)).to_radians()
    }

    #[test]
    fn without_a_calibration_the_first_readings_are_the_zero() {
        assert!((of(None, -100, 0.1234) - 0.1234).abs() < 1e-9);
    }

    /// Whatever the turn of the motor, the torsion and the noise of the first readings.
    #[test]
    fn a_calibrated_zero_is_known_but_for_turns_of_the_motor() {
        for ratio in [-160, -100, 30, 101] {
            let turn = 2.0 * PI / f64::from(ratio);
            for zero in [-3.1, -0.2, 0.0, 0.7] {
                for turns in [-40, -3, 0, 1, 17] {
                    let right = zero + f64::from(turns) * turn;
                    for error in [-0.45, -0.02, 0.0, 0.3] {
                        let found = of(Some(zero), ratio, right + error * turn);
                        assert!((found - right).abs() < 3e-9, "{ratio} {zero} {turns} {error}: {found}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_zero_out_of_range_is_named() {
        for zero in [3.2, f64::NAN] {
            let error = OutputZero::build(Some(zero), 100).unwrap_err();
            assert_eq!(error, Error::OutOfRange("output_encoder_zero"));
        }
    }
}
