//! Tooth pitch error: displacement of the belt at a pulley less that of the ideal pitch.
//!
//! ```text
//! e_motor(theta_1) = sum_i A_i sin(k_i*theta_1 + p_i) + sum_j A_j sin(k_j*theta_1*z_1/z_b + p_j)
//! e_output(theta_2) = sum_i A_i sin(k_i*theta_2 + p_i)
//! ```
//!
//! theta_1 and theta_2 are the angles of the motor's and of the output's pulley, z_1 the teeth of the former, z_b those of the
//! belt. Orders of the first list count periods a revolution of the motor's pulley, of the second a revolution of the belt, of
//! the third a revolution of the output's pulley. Order 1 of a pulley is its eccentricity, order z its tooth
//! engagement, order 1 of the belt its joint.
//!
//! Sign: e adds to the travel r*theta of the belt at the pulley. Units: e (m), de/dtheta (m/rad). Memoryless: there is nothing
//! to discretise.
//!
//! Precision: angles are integer phases, so that an order times a phase wraps exactly and e does not lose accuracy over any
//! number of revolutions; the phase of the belt is a quotient of integers, rounded down to a count, 1.5e-9 rad.
//!
//! Cost: a sine and cosine for each term that is not 0.
//!
//! M. Kagotani, T. Koyama, H. Ueda, "Study on transmission error in timing belt drives (effect of production error in
//! polyurethane belt)", Bulletin of JSME 26 (1983).

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::real::Real;

/// One sine; amplitude 0 leaves the place unused.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PitchTerm<R> {
    /// k, periods per revolution; 0..=1000.
    pub order: u32,
    /// A (m); within +-0.01.
    pub amplitude: R,
    /// p (rad); within +-pi.
    pub phase: R,
}

/// Up to `K` sines of each kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PitchErrorParams<R, const K: usize> {
    /// Orders per revolution of the motor's pulley.
    pub motor: [PitchTerm<R>; K],
    /// Orders per revolution of the output's pulley.
    pub output: [PitchTerm<R>; K],
    /// Orders per revolution of the belt.
    pub belt: [PitchTerm<R>; K],
}

impl<R: Real, const K: usize> Default for PitchErrorParams<R, K> {
    fn default() -> Self {
        let none = [PitchTerm::default(); K];
        Self { motor: none, output: none, belt: none }
    }
}

impl<R: Real, const K: usize> PitchErrorParams<R, K> {
    /// Checks and precomputes for a motor's pulley of `motor_teeth`, 1..=[`super::MOST_TEETH`], and a belt of `belt_teeth`,
    /// which are as many or more.
    pub(super) fn build(&self, motor_teeth: i32, belt_teeth: i32) -> Result<PitchError<R, K>, Error> {
        let around_the_belt = R::from_i32(motor_teeth) / R::from_i32(belt_teeth);
        Ok(PitchError {
            motor: series(&self.motor, R::ONE)?,
            output: series(&self.output, R::ONE)?,
            belt: series(&self.belt, around_the_belt)?,
            motor_teeth,
            belt_teeth,
        })
    }
}

fn series<R: Real, const K: usize>(
    terms: &[PitchTerm<R>; K],
    turns_per_theta: R,
) -> Result<[Sine<R>; K], Error> {
    let mut sines = [Sine::default(); K];
    for (sine, term) in sines.iter_mut().zip(terms) {
        *sine = term.build(turns_per_theta)?;
    }
    Ok(sines)
}

impl<R: Real> PitchTerm<R> {
    fn build(&self, turns_per_theta: R) -> Result<Sine<R>, Error> {
        require(self.order <= 1000, "order")?;
        require(self.amplitude.is_within(R::lit(0.01)), "amplitude")?;
        require(self.phase.is_within(R::lit(core::f64::consts::PI)), "phase")?;
        let rate = R::from_i32(self.order.cast_signed()) * turns_per_theta;
        Ok(Sine {
            order: self.order,
            phase: Angle::from_radians(self.phase).phase(),
            amplitude: self.amplitude,
            slope: rate * self.amplitude,
        })
    }
}

/// A term as the step needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sine<R> {
    order: u32,
    /// p in counts.
    phase: u32,
    amplitude: R,
    /// Largest de/dtheta (m/rad).
    slope: R,
}

/// Travel of the belt at a pulley beyond that of the ideal pitch, and its derivative by the angle of the pulley.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TravelError<R> {
    /// e (m).
    pub error: R,
    /// de/dtheta (m/rad).
    pub slope: R,
}

/// Built model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PitchError<R, const K: usize> {
    motor: [Sine<R>; K],
    output: [Sine<R>; K],
    belt: [Sine<R>; K],
    motor_teeth: i32,
    belt_teeth: i32,
}

impl<R: Real, const K: usize> PitchError<R, K> {
    /// e_motor at an angle of the motor's pulley.
    pub fn motor(&self, angle: Angle<R>) -> TravelError<R> {
        let own = sum(&self.motor, || angle.phase());
        let belt = sum(&self.belt, || self.belt_phase(angle));
        TravelError { error: own.error + belt.error, slope: own.slope + belt.slope }
    }

    /// e_output at an angle of the output's pulley.
    pub fn output(&self, angle: Angle<R>) -> TravelError<R> {
        sum(&self.output, || angle.phase())
    }

    /// Place of the belt within its revolution, theta_1*z_1/z_b.
    fn belt_phase(&self, angle: Angle<R>) -> u32 {
        let (motor, belt) = (i64::from(self.motor_teeth), i64::from(self.belt_teeth));
        // Revolutions are taken modulo those after which belt and pulley stand as before.
        let revolutions = (angle.counts >> 32).rem_euclid(belt);
        ((((revolutions << 32) | i64::from(angle.phase())) * motor).div_euclid(belt)) as u32
    }
}

/// Sum of the terms at a phase, which is not asked for when there are none.
fn sum<R: Real>(sines: &[Sine<R>], phase: impl Fn() -> u32) -> TravelError<R> {
    let mut sum = TravelError::default();
    for sine in sines.iter().filter(|sine| sine.amplitude != R::ZERO) {
        let at = phase().wrapping_mul(sine.order).wrapping_add(sine.phase);
        let (sin, cos) = R::sin_cos_phase(at);
        sum.error += sine.amplitude * sin;
        sum.slope += sine.slope * cos;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    fn term(order: u32, amplitude: f64, phase: f64) -> PitchTerm<f64> {
        PitchTerm { order, amplitude, phase }
    }

    fn params() -> PitchErrorParams<f64, 2> {
        PitchErrorParams {
            motor: [term(1, 2e-5, 0.3), term(20, 5e-6, -1.0)],
            output: [term(1, 3e-5, 2.0), term(60, 4e-6, 0.0)],
            belt: [term(1, 4e-5, 1.0), PitchTerm::default()],
        }
    }

    proptest! {
        #[test]
        fn a_sum_of_sines_and_its_derivative(turns in -200_000..200_000i64, phase: u32) {
            let model = params().build(20, 150).unwrap();
            let angle = Angle::<f64>::from_counts((turns << 32) + i64::from(phase));
            let theta = (turns.rem_euclid(150) as f64 + f64::from(phase) / 4_294_967_296.0) * TAU;
            let belt = theta * 20.0 / 150.0;
            let error = 2e-5 * (theta + 0.3).sin() + 5e-6 * (20.0 * theta - 1.0).sin() + 4e-5 * (belt + 1.0).sin();
            let slope = 2e-5 * (theta + 0.3).cos()
                + 1e-4 * (20.0 * theta - 1.0).cos()
                + 4e-5 * 20.0 / 150.0 * (belt + 1.0).cos();
            let motor = model.motor(angle);
            prop_assert!((motor.error - error).abs() < 1e-12 && (motor.slope - slope).abs() < 1e-11);
            let output = model.output(angle);
            let error = 3e-5 * (theta + 2.0).sin() + 4e-6 * (60.0 * theta).sin();
            prop_assert!((output.error - error).abs() < 1e-12);
        }

        /// After z_b revolutions of the motor's pulley the belt has made z_1.
        #[test]
        fn belt_and_pulley_stand_as_before_after_as_many_revolutions_as_the_belt_has_teeth(counts: i32) {
            let model = params().build(20, 150).unwrap();
            let angle = Angle::<f64>::from_counts(i64::from(counts));
            let later = Angle::from_counts(angle.counts + (150 << 32));
            prop_assert_eq!(model.motor(angle), model.motor(later));
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let named = |term: PitchTerm<f64>| {
            PitchErrorParams { belt: [term], ..PitchErrorParams::default() }.build(20, 150).unwrap_err()
        };
        assert_eq!(named(term(1001, 1e-5, 0.0)), Error::OutOfRange("order"));
        assert_eq!(named(term(1, 0.02, 0.0)), Error::OutOfRange("amplitude"));
        assert_eq!(named(term(1, 1e-5, 1.1 * PI)), Error::OutOfRange("phase"));
        assert_eq!(named(term(1, f64::NAN, 0.0)), Error::OutOfRange("amplitude"));
    }
}
