//! Pulleys of a belt between motor and wave generator: the motor's readings and torques as they are at the wave generator.
//!
//! ```text
//! theta_in = (z_1/z_2)*theta_m,   tau_in = (z_2/z_1)*tau_m
//! q = floor(d*z_1/z_2) + e,   rest <- rest + d*z_1 - q*z_2,   e = floor(rest/z_2)
//! ```
//!
//! theta_m and tau_m are the motor's angle and torque, z_1 and z_2 the teeth of its pulley and of the wave generator's. In front of the
//! belt the compensator knows a motor with the angle theta_in, which is the wave generator's but for the stretch of the belt
//! ([`crate::belt::series`]), and with the motor's limits and counts as they are there. d is the change of theta_m in counts of 2^32 a
//! revolution, q that of theta_in: what is not whole is carried to the next reading, so that theta_in is exact to a count after any
//! number of revolutions. floor is by multiplication with a fraction of 28 and of 16 bits; an error of it is carried too. Units: rad, N m.

use crate::angle::Angle;
use crate::belt::SeriesBeltParams;
use crate::belt::series::ENABLED;
use crate::branch::seldom;
use crate::compensator::Limits;
use crate::compensator::sense::encoder::Reading;
use crate::constants::constants;
use crate::real::Real;

/// Bits of z_1/z_2 behind the point: up to a ratio of 4 it is an i32.
const RATIO_BITS: u32 = 28;
/// Bits of 1/z_2.
const INVERSE_BITS: u32 = 16;

/// The built pulleys.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulleys<R> {
    /// There is a belt.
    present: bool,
    teeth: [i32; 2],
    /// z_1/z_2 and 1/z_2 in units of their last bits.
    fraction: i32,
    inverse_teeth: i32,
    /// z_1/z_2 and z_2/z_1.
    ratio: R,
    inverse: R,
}

/// Angle of the pulleys so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PulleysState {
    /// theta_m within its revolution, and theta_in, in counts.
    motor: u32,
    counts: i64,
    /// rest.
    rest: i32,
}

impl<R: Real> Pulleys<R> {
    /// Of a belt that was checked, if there is one.
    pub fn build(belt: Option<&SeriesBeltParams<R>>) -> Self {
        let teeth = belt.map_or([1, 1], |belt| belt.teeth);
        let [motor, driven] = teeth.map(i64::from);
        let [one, other] = teeth.map(R::from_i32);
        Self {
            present: belt.is_some(),
            teeth,
            fraction: ((motor << RATIO_BITS) / driven.max(1)) as i32,
            inverse_teeth: ((1 << INVERSE_BITS) / driven.max(1)) as i32,
            ratio: one / other,
            inverse: other / one,
        }
    }

    /// z_1/z_2.
    pub fn ratio(&self) -> R {
        self.ratio
    }

    /// There is a belt.
    pub fn are_present(&self) -> bool {
        ENABLED && self.present
    }

    /// Limits of the motor as they are at the wave generator.
    pub fn limits_at_wave_generator(&self, limits: &Limits<R>) -> Limits<R> {
        Limits {
            motor_torque: limits.motor_torque * self.inverse,
            motor_speed: limits.motor_speed * self.ratio,
            ..*limits
        }
    }

    /// The same the other way.
    pub fn limits_at_motor(&self, limits: &Limits<R>) -> Limits<R> {
        Limits {
            motor_torque: limits.motor_torque * self.ratio,
            motor_speed: limits.motor_speed * self.inverse,
            ..*limits
        }
    }

    /// A reading of the motor's encoder as it is at the wave generator.
    #[inline(always)]
    pub fn reading(&self, state: &mut PulleysState, motor: Reading<R>) -> Reading<R> {
        if !self.are_present() {
            seldom();
            return motor;
        }
        let phase = motor.angle.phase();
        let change = phase.wrapping_sub(state.motor).cast_signed();
        state.motor = phase;
        let [driving, driven] = self.teeth;
        let whole = (i64::from(change) * i64::from(self.fraction)) >> RATIO_BITS;
        // What is left is small: it may be told by the low words alone.
        let left = change.wrapping_mul(driving).wrapping_sub((whole as i32).wrapping_mul(driven));
        let rest = state.rest.wrapping_add(left);
        let carried = rest.wrapping_mul(self.inverse_teeth) >> INVERSE_BITS;
        state.rest = rest.wrapping_sub(carried.wrapping_mul(driven));
        state.counts = state.counts.wrapping_add(whole).wrapping_add(i64::from(carried));
        Reading { angle: Angle::from_counts(state.counts), moved: motor.moved * self.ratio, ..motor }
    }

    /// There is a belt, and no code for it.
    pub(in crate::compensator) fn lack_code(&self) -> bool {
        self.present && !ENABLED
    }

    /// A torque at the wave generator as it is at the motor's shaft (N m).
    #[inline(always)]
    pub fn at_motor(&self, torque: R) -> R {
        if ENABLED { torque * self.ratio } else { torque }
    }

    /// A torque at the motor's shaft as it is at the wave generator (N m).
    #[inline(always)]
    pub fn at_wave_generator(&self, torque: R) -> R {
        if ENABLED { torque * self.inverse } else { torque }
    }

    /// A small angle of the wave generator as it is at the motor (rad).
    pub fn angle_at_motor(&self, angle: R) -> R {
        if ENABLED { angle * self.inverse } else { angle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pulleys(teeth: [i32; 2]) -> Pulleys<f64> {
        Pulleys::build(Some(&SeriesBeltParams { teeth, compliance: 0.0, slack_torque: 0.0 }))
    }

    fn reading(counts: i64) -> Reading<f64> {
        Reading { angle: Angle::from_counts(counts), moved: 0.0, accepted: true }
    }

    proptest! {
        /// However the motor goes, and for how long: to a count where the ratio says.
        #[test]
        fn the_angle_is_exact_to_a_count(
            teeth in (10i32..=200, 0.3..8.0f64),
            steps in prop::collection::vec(-(1i64 << 29)..1 << 29, 1..50),
            revolutions in 0i64..1_000,
        ) {
            let teeth = [teeth.0, (f64::from(teeth.0) * teeth.1) as i32];
            let (pulleys, mut state) = (pulleys(teeth), PulleysState::default());
            let [driving, driven] = teeth.map(i128::from);
            let mut counts = 0i64;
            let turned = (0..4 * revolutions).map(|_| 1i64 << 30);
            for step in turned.chain(steps) {
                counts += step;
                let angle = pulleys.reading(&mut state, reading(counts)).angle.counts;
                let error = i128::from(angle) * driven - i128::from(counts) * driving;
                prop_assert!(error.abs() <= 3 * driven, "{counts}: {error} of {driven}");
            }
        }

        #[test]
        fn any_angle_is_total(raws in prop::collection::vec(any::<i64>(), 1..50), teeth in (1i32..10_000, 1i32..10_000)) {
            let (pulleys, mut state) = (pulleys([teeth.0, teeth.1]), PulleysState::default());
            for raw in raws {
                pulleys.reading(&mut state, reading(raw));
            }
        }
    }

    /// Pulleys of as many teeth change nothing, bit for bit; without a belt nothing is touched.
    #[test]
    fn equal_pulleys_are_none() {
        for teeth in [20, 37] {
            let (pulleys, mut state) = (pulleys([teeth; 2]), PulleysState::default());
            for counts in [0i64, 5, -1_000_003, 77_777_777, -1_900_000_000, 12] {
                assert_eq!(pulleys.reading(&mut state, reading(counts)), reading(counts));
            }
            assert_eq!(pulleys.at_motor(0.3), 0.3);
        }
        let none = Pulleys::<f64>::build(None);
        assert_eq!(none.reading(&mut PulleysState::default(), reading(1 << 40)), reading(1 << 40));
    }

    /// What the torque does at one side it does at the other.
    #[test]
    fn power_passes() {
        let pulleys = pulleys([24, 36]);
        let (torque, speed) = (0.4, 100.0);
        let at_wave_generator = pulleys.at_wave_generator(torque);
        assert!((at_wave_generator * speed * pulleys.ratio() - torque * speed).abs() < 1e-12);
        assert!((pulleys.at_motor(at_wave_generator) - torque).abs() < 1e-15);
    }
}
