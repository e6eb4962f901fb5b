//! Adaptive map of the ripple over the wave generator's angle: a sum of sines, learnt in operation.
//!
//! ```text
//! ripple = sum_k a_k*cos(k*alpha) + b_k*sin(k*alpha),       alpha = theta_wg or theta_wg - theta_fs
//! law      a_k <- limit(a_k + dt*g*D*C, bound),  b_k alike with S;   C = cos(k*alpha), S = sin(k*alpha), e = 0.18, D = m of the torque,
//!          C + i*S = (u + i*(1 - u))*e^(i*k*alpha), D = limit(m, e*bound) of the position,   u = min(k*|omega_wg|/k_z, 1)
//! rate     g = g_0 of the torque, g_0/(1 + P/P_0) of the position;   P = path of the motor that was learnt from, mean of the orders
//! ```
//!
//! One map is of the position, the residual of the gear file's kinematic error (rad at the output; m is the measured
//! output less its setpoint): it is subtracted from the motor's reference. The other is of the torque at the motor's
//! shaft (N m; m is the observer's residual there): it is fed forward. Orders per revolution are relative to the case, or
//! to the flexspline at the output's setpoint: which gives k - k/N of both rims.
//!
//! With the true coefficients constant, x the error of the coefficients and V = x'x/(2*g), dV/dt = -(m's ripple)^2 +
//! noise where m is the ripple of x: the law is the gradient of m^2. It converges while m and that ripple are less than a
//! quarter period apart. The loop around it lags, so that it only learns where k*|omega_wg| is below a corner. And the integral of
//! the same error ([`crate::compensator::reference::output_feedback`]), of rate k_z in slow motion, leaves of a ripple
//! `S = i*w/(i*w + k_z)`, w = k*|omega_wg|: it leads by atan(k_z/w), well below k_z by nearly a quarter period, and by more behind
//! filters of less than 2*k_z. There the law without the lead hardly converges, or is unstable. u + i*(1 - u) has that lead within an
//! eighth of a period, a quarter at standstill and none from k_z on, where the loop lags; backwards it is the conjugate. In a fast move
//! the integral stands still: there the law has a lead that is too large, by less than a quarter period, and converges more slowly.
//!
//! The map of the position is a property of the gear: once an order has had the time to be learnt its rate falls with the path as that
//! of a mean over all of it, and begins anew with each start. It learns only in motion: at rest a ripple cannot be separated from any
//! constant. Nor can it within a part of its period: a constant m would move the coefficients there and back by m*g over
//! k*|omega_wg|. So g is at most [`FALSE_RIPPLE`]*k*|omega_wg|: a constant moves them by that fraction of it at any speed.
//! A position error far beyond a ripple is that of a load that swings, not a ripple: it counts for no more than
//! [`FALSE_RIPPLE`] of the largest ripple. Errors of inertia and friction, and the vibration that they leave, change with the speed as
//! fast as a ripple does where the speed changes within a part of its period: it learns once the speed has been steady,
//! abs domega_wg/dt <= [`FALSE_RIPPLE`]*omega_wg^2, over a radian of the wave generator.
//!
//! Discretisation: one order is evaluated in each slot, the others are held: each is evaluated at the middle of the
//! [`RIPPLE_ORDERS`] slots that it is held for, T = [`RIPPLE_ORDERS`]*dt, and learnt by explicit Euler over 2*T, position
//! and torque alternating; stable for 2*T*g < 1. Bounded by `bound` in each coefficient. The error of a held wave of
//! order k is at most k*|omega_wg|*T/2 of its amplitude.
//!
//! M. Bodson, A. Sacks, P. Khosla, "Harmonic generation in adaptive feedforward cancellation schemes", IEEE
//! Transactions on Automatic Control 39 (1994).

use zerocopy::KnownLayout;

use crate::angle::Angle;
use crate::compensator::tuned::FALSE_RIPPLE;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::{RADIANS_PER_COUNT, Real};

/// P_0 (rad): at the largest rate, [`FALSE_RIPPLE`] a radian, a ripple of order 1 is learnt but for a thousandth of it.
fn first_path() -> f64 {
    core::f64::consts::LN_10 * 3.0 / FALSE_RIPPLE.get()
}

/// 1/k_z without an integral (s): u is 1 at any speed of a motor.
const NO_INTEGRAL: f64 = 1e6;

/// Number of learnt orders.
pub const RIPPLE_ORDERS: usize = 4;

/// An order of the ripple.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RippleOrder {
    /// k, periods per revolution of the wave generator, 1..=1000; 0 leaves the place unused.
    pub order: u32,
    /// Revolutions relative to the flexspline, not to the case.
    pub to_flexspline: bool,
}

/// Coefficients [a_k, b_k] of every order.
pub type Coefficients<R> = [[R; 2]; RIPPLE_ORDERS];

/// Learnt map, as stored in a file.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq, KnownLayout)]
pub struct RippleMap<R> {
    /// Of the position (rad at the output).
    pub position: Coefficients<R>,
    /// Of the torque (N m at the motor).
    pub torque: Coefficients<R>,
}

/// Parameters of the learning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearntRippleParams<R> {
    /// The orders.
    pub orders: [RippleOrder; RIPPLE_ORDERS],
    /// g_0 of the position (1/s), >= 0.
    pub position_rate: R,
    /// g of the torque (1/s), >= 0.
    pub torque_rate: R,
    /// Largest coefficient of the position, >= 0 (rad).
    pub position_bound: R,
    /// Largest coefficient of the torque, >= 0 (N m).
    pub torque_bound: R,
    /// k_z, rate of the output feedback's integral in slow motion (1/s), >= 0; 0 without one.
    pub integral_rate: R,
    /// Speed of the motor up to which order 1 is learnt, order k up to 1/k of it, > 0 (rad/s).
    pub fastest: R,
}

/// The built ripple.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearntRipple<R> {
    orders: [RippleOrder; RIPPLE_ORDERS],
    position_gain: R,
    torque_gain: R,
    position_bound: R,
    torque_bound: R,
    /// Largest position error that is learnt from (rad).
    largest_sample: R,
    /// Fastest speed at which each order learns (rad/s); 0 for a place that is not used.
    fastest: [R; RIPPLE_ORDERS],
    /// 1/the speed from which on each order learns at the whole rate of position and of torque (s/rad).
    by_speed: [[R; 2]; RIPPLE_ORDERS],
    /// k/k_z (s); [`NO_INTEGRAL`] without an integral.
    by_integral: [R; RIPPLE_ORDERS],
    /// Time from one sample of the torque to the next over P_0 (s/rad).
    by_path: R,
    /// Phase advance per speed to the middle of the slots that a wave is held for (counts of 2^32 a revolution, s).
    phase_advance: R,
    dt: R,
}

/// The ripple, each order as of its last slot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RippleNow<R> {
    /// (rad at the output)
    pub position: R,
    /// (N m at the motor)
    pub torque: R,
    /// Position and torque of each order.
    waves: [[R; 2]; RIPPLE_ORDERS],
    /// The last slot: its order is the remainder of [`RIPPLE_ORDERS`], and the cosine and sine of that one's angle.
    slot: usize,
    basis: [R; 2],
    /// Angle of the wave generator since its speed is steady, up to 1 (rad).
    steady: R,
    /// 1 - g/g_0 of the position.
    fallen: R,
}

/// Sample of the ripple's residual in one slot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RippleSample<R> {
    /// Speed of the motor's reference (rad/s).
    pub speed: R,
    /// Its acceleration (rad/s^2).
    pub acceleration: R,
    /// Measured output less setpoint (rad), where there is an output encoder.
    pub position: Option<R>,
    /// Residual torque at the motor (N m).
    pub torque: R,
}

impl<R: Real> LearntRippleParams<R> {
    /// Prepares the ripple for slots that come every dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `ripple_order`, `ripple_rate`, `ripple_bound` or `ripple_speed`.
    pub fn build(&self, dt: R) -> Result<LearntRipple<R>, Error> {
        require(self.orders.iter().all(|order| order.order <= 1000), "ripple_order")?;
        let round = R::from_i32(RIPPLE_ORDERS as i32) * dt;
        let rate = |rate: R| rate >= R::ZERO && rate * (round + round) < R::ONE;
        require(rate(self.position_rate) && rate(self.torque_rate), "ripple_rate")?;
        require(self.integral_rate.is_finite() && self.integral_rate >= R::ZERO, "ripple_integral_rate")?;
        let bound = |bound: R| bound.is_finite() && bound >= R::ZERO;
        require(bound(self.position_bound) && bound(self.torque_bound), "ripple_bound")?;
        require(self.fastest > R::ZERO && self.fastest.is_finite(), "ripple_speed")?;
        Ok(LearntRipple {
            orders: self.orders,
            position_gain: R::lit(4.0) * round * self.position_rate,
            torque_gain: R::lit(4.0) * round * self.torque_rate,
            position_bound: self.position_bound,
            torque_bound: self.torque_bound,
            largest_sample: R::lit(FALSE_RIPPLE.get()) * self.position_bound,
            fastest: self.orders.map(|order| match order.order {
                0 => R::ZERO,
                k => self.fastest / R::from_i32(k.cast_signed()),
            }),
            by_speed: self.orders.map(|RippleOrder { order, .. }| {
                let frequency = R::lit(FALSE_RIPPLE.get()) * R::from_i32(order.cast_signed());
                [self.position_rate, self.torque_rate]
                    .map(|rate| if rate > R::ZERO { frequency / rate } else { R::ZERO })
            }),
            by_integral: self.orders.map(|order| {
                let frequency = R::from_i32(order.order.cast_signed());
                if self.integral_rate > R::ZERO {
                    frequency / self.integral_rate
                } else {
                    R::lit(NO_INTEGRAL)
                }
            }),
            by_path: R::lit(2.0 / first_path()) * dt,
            phase_advance: R::lit(0.5 / RADIANS_PER_COUNT) * (round - dt),
            dt,
        })
    }
}

impl<R: Real> RippleMap<R> {
    /// Every coefficient limited to its bound; one that is not finite, or of a place that is not used, is 0.
    #[must_use]
    pub fn within(&self, ripple: &LearntRipple<R>) -> Self {
        let limited = |map: &Coefficients<R>, bound: R| {
            let mut limited = *map;
            for (place, order) in limited.iter_mut().zip(&ripple.orders) {
                for coefficient in place {
                    let used = if order.order == 0 { R::ZERO } else { *coefficient };
                    *coefficient = used.finite_or(R::ZERO).limit(bound);
                }
            }
            limited
        };
        Self {
            position: limited(&self.position, ripple.position_bound),
            torque: limited(&self.torque, ripple.torque_bound),
        }
    }
}

impl<R: Real> LearntRipple<R> {
    /// Evaluates the next order at the wave generator's angle `theta` and `speed` (rad/s), the flexspline being at
    /// `output`.
    #[inline(always)]
    pub fn evaluate_next(
        &self,
        map: &RippleMap<R>,
        now: &mut RippleNow<R>,
        theta: Angle<R>,
        output: Angle<R>,
        speed: R,
    ) {
        now.slot = (now.slot + 1) % (2 * RIPPLE_ORDERS);
        let place = now.slot % RIPPLE_ORDERS;
        let RippleOrder { order, to_flexspline } = self.orders[place];
        let advance = (self.phase_advance * speed).to_i32().cast_unsigned();
        let to_case = theta.phase().wrapping_add(advance);
        // Without r*advance: below a hundredth of the error by holding the wave.
        let angle = if to_flexspline { to_case.wrapping_sub(output.phase()) } else { to_case };
        let (sine, cosine) = R::sin_cos_phase(order.wrapping_mul(angle));
        let wave = |[a, b]: [R; 2]| a * cosine + b * sine;
        now.basis = [cosine, sine];
        now.waves[place] = [wave(map.position[place]), wave(map.torque[place])];
        let [first, second, third, fourth] = now.waves;
        now.position = (first[0] + second[0]) + (third[0] + fourth[0]);
        now.torque = (first[1] + second[1]) + (third[1] + fourth[1]);
    }

    /// The order of the last slot learns from the sample, once a slot: its position and its torque alternating.
    #[inline(always)]
    pub fn learn(&self, map: &mut RippleMap<R>, now: &mut RippleNow<R>, sample: &RippleSample<R>) {
        let (speed, order) = (sample.speed.abs(), now.slot % RIPPLE_ORDERS);
        let is_steady = sample.acceleration.abs() <= R::lit(FALSE_RIPPLE.get()) * speed * speed;
        now.steady = if is_steady { (now.steady + self.dt * speed).min(R::ONE) } else { R::ZERO };
        if now.steady < R::ONE || speed >= self.fastest[order] {
            return;
        }
        let [cosine, sine] = now.basis;
        let level = |k: usize| (self.by_speed[order][k] * speed).min(R::ONE);
        if now.slot >= RIPPLE_ORDERS {
            let rate = R::ONE - now.fallen;
            now.fallen += self.by_path * speed * rate * rate;
            let by = level(1) * self.torque_gain * sample.torque;
            add(&mut map.torque[order], [by * cosine, by * sine], self.torque_bound);
        } else if let Some(position) = sample.position {
            let by = level(0) * self.position_gain * position.limit(self.largest_sample);
            let by = (R::ONE - now.fallen) * by;
            let real = by * (self.by_integral[order] * speed).min(R::ONE);
            let imaginary = if sample.speed < R::ZERO { real - by } else { by - real };
            let coefficients = [real * cosine - imaginary * sine, real * sine + imaginary * cosine];
            add(&mut map.position[order], coefficients, self.position_bound);
        }
    }
}

#[inline(always)]
fn add<R: Real>([cosine, sine]: &mut [R; 2], by: [R; 2], bound: R) {
    *cosine = (*cosine + by[0]).limit(bound);
    *sine = (*sine + by[1]).limit(bound);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle::Ratio;
    use crate::compensator::schedule::CONTROL_PERIOD;

    fn params() -> LearntRippleParams<f64> {
        let order = |order, to_flexspline| RippleOrder { order, to_flexspline };
        LearntRippleParams {
            orders: [order(1, false), order(2, false), order(2, true), RippleOrder::default()],
            position_rate: 5.0,
            torque_rate: 5.0,
            position_bound: 3e-4,
            torque_bound: 0.01,
            integral_rate: 0.0,
            fastest: 60.0,
        }
    }

    const TRUTH: RippleMap<f64> = RippleMap {
        position: [[0.0, 2e-5], [1e-4, 0.0], [-3e-5, 4e-5], [0.0; 2]],
        torque: [[2e-3, 0.0], [0.0, 1e-3], [0.0; 2], [0.0; 2]],
    };

    /// The map that is learnt at `speed` (rad/s) in `seconds` of a joint with the ripple of `TRUTH`.
    fn learnt(speed: f64, seconds: f64) -> RippleMap<f64> {
        learnt_by(&params(), speed, seconds)
    }

    fn learnt_by(params: &LearntRippleParams<f64>, speed: f64, seconds: f64) -> RippleMap<f64> {
        let (ripple, ratio) = (params.build(CONTROL_PERIOD).unwrap(), Ratio::one_over(-20).unwrap());
        let (mut map, mut now, mut there) =
            (RippleMap::default(), RippleNow::default(), RippleNow::default());
        for k in 0..(seconds / CONTROL_PERIOD) as usize {
            let theta = Angle::from_radians_f64(speed * CONTROL_PERIOD * k as f64);
            ripple.evaluate_next(&map, &mut now, theta, ratio.apply(theta), speed);
            ripple.evaluate_next(&TRUTH, &mut there, theta, ratio.apply(theta), speed);
            let sample = RippleSample {
                speed,
                acceleration: 0.0,
                position: Some(there.position - now.position),
                torque: there.torque - now.torque,
            };
            ripple.learn(&mut map, &mut now, &sample);
        }
        map
    }

    /// Orders 2 of both rims beat once in ten revolutions, which must be observed to separate them.
    #[test]
    fn it_finds_the_ripple_of_both_rims() {
        let map = learnt(25.0, 60.0);
        for (found, truth) in [(map.position, TRUTH.position), (map.torque, TRUTH.torque)] {
            let largest = truth.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            for (found, truth) in found.as_flattened().iter().zip(truth.as_flattened()) {
                assert!((found - truth).abs() < 0.01 * largest, "{found} of {truth}");
            }
        }
    }

    #[test]
    fn it_learns_nothing_within_a_radian_nor_where_the_loop_is_too_slow() {
        assert_eq!(learnt(0.5, 1.0), RippleMap::default());
        let map = learnt(40.0, 1.0);
        assert!(map.position[0] != [0.0; 2] && map.position[1] == [0.0; 2], "{map:?}");
        assert_eq!(learnt(70.0, 1.0), RippleMap::default());
    }

    /// A radian at a steady speed comes before the first thing learnt, and after every change of speed.
    #[test]
    fn it_learns_at_a_steady_speed() {
        let ripple = params().build(CONTROL_PERIOD).unwrap();
        let mut now = RippleNow { basis: [1.0, 0.0], ..RippleNow::default() };
        let mut learns = |acceleration| {
            let sample =
                RippleSample { speed: 10.0, acceleration, position: Some(1e-5), ..RippleSample::default() };
            let mut map = RippleMap::default();
            ripple.learn(&mut map, &mut now, &sample);
            map != RippleMap::default()
        };
        let radian = (0.1 / CONTROL_PERIOD) as usize;
        assert!((0..radian - 1).all(|_| !learns(17.0)) && learns(17.0) && learns(-17.0));
        assert!(!learns(19.0) && (0..radian - 1).all(|_| !learns(0.0)) && learns(0.0));
    }

    /// Largest error of the output (rad) in the last of 40 s, at `speed` (rad/s) in a loop that integrates the error at the rate of 50/s
    /// behind two poles of 75 rad/s; `known` is the rate that the law is told.
    fn error_beside_an_integral(speed: f64, known: f64) -> f64 {
        const INTEGRAL: f64 = 50.0;
        const POLE: f64 = 75.0;
        const STEPS: usize = 400_000;
        let params = LearntRippleParams { integral_rate: known, fastest: 100.0, ..params() };
        let (ripple, ratio) = (params.build(CONTROL_PERIOD).unwrap(), Ratio::one_over(-20).unwrap());
        let (mut map, mut now, mut there) =
            (RippleMap::default(), RippleNow::default(), RippleNow::default());
        let (mut poles, mut integral, mut largest) = ([0.0f64; 2], 0.0, 0.0f64);
        for k in 0..STEPS {
            let theta = Angle::from_radians_f64(speed * CONTROL_PERIOD * k as f64);
            ripple.evaluate_next(&map, &mut now, theta, ratio.apply(theta), speed);
            ripple.evaluate_next(&TRUTH, &mut there, theta, ratio.apply(theta), speed);
            let error = there.position - now.position - integral;
            poles[0] += CONTROL_PERIOD * POLE * (error - poles[0]);
            poles[1] += CONTROL_PERIOD * POLE * (poles[0] - poles[1]);
            integral += CONTROL_PERIOD * INTEGRAL * poles[1];
            let sample = RippleSample { speed, position: Some(error), ..RippleSample::default() };
            ripple.learn(&mut map, &mut now, &sample);
            if k >= STEPS - STEPS / 40 {
                largest = largest.max(error.abs());
            }
        }
        largest
    }

    /// Well below the integral's rate the error leads the ripple by more than a quarter period: without the lead the law moves away from
    /// the ripple, up to its bounds; with it, forwards and backwards, it converges, there and above the integral's rate.
    #[test]
    fn it_converges_beside_an_integral_of_the_same_error() {
        let never_learnt = 1e-4;
        assert!(error_beside_an_integral(6.0, 0.0) > 0.5 * never_learnt);
        for speed in [6.0, -6.0, 20.0, 45.0] {
            let left = error_beside_an_integral(speed, 50.0);
            assert!(left < 0.02 * never_learnt, "{speed}: {left}");
        }
    }

    /// Where no integral runs, the lead is too large and the law converges all the same.
    #[test]
    fn it_converges_where_the_integral_stands_still() {
        let told = LearntRippleParams { integral_rate: 50.0, ..params() };
        for (speed, most) in [(12.0, 0.03), (-12.0, 0.03), (25.0, 0.01)] {
            let map = learnt_by(&told, speed, 60.0);
            for (found, truth) in map.position.as_flattened().iter().zip(TRUTH.position.as_flattened()) {
                assert!((found - truth).abs() < most * 1e-4, "{speed}: {found} of {truth}");
            }
        }
    }

    /// After n times its path the rate is 1/(1 + n) of the first: what is learnt tends to a mean over the path. Three of the four orders
    /// are used.
    #[test]
    fn the_rate_of_the_position_falls_with_the_path() {
        let (ripple, mut now) = (params().build(CONTROL_PERIOD).unwrap(), RippleNow::default());
        let sample = RippleSample { speed: 20.0, position: Some(0.0), ..RippleSample::default() };
        for paths in [1.0, 3.0, 9.0] {
            let mut state = RippleNow { steady: 1.0, ..RippleNow::default() };
            for slot in 0..(paths * first_path() / 20.0 / CONTROL_PERIOD) as usize {
                state.slot = slot % (2 * RIPPLE_ORDERS);
                ripple.learn(&mut RippleMap::default(), &mut state, &sample);
            }
            let rate = 1.0 - state.fallen;
            assert!((rate * (1.0 + 0.75 * paths) - 1.0).abs() < 0.01, "{paths}: {rate}");
        }
        // At rest nothing is learnt, and the rate stays.
        ripple.learn(&mut RippleMap::default(), &mut now, &RippleSample { speed: 0.0, ..sample });
        assert_eq!(now.fallen, 0.0);
    }

    #[test]
    fn an_error_beyond_a_ripple_counts_for_a_part_of_the_largest() {
        let ripple = params().build(CONTROL_PERIOD).unwrap();
        let learnt_from = |position| {
            let now = RippleNow { basis: [1.0, 0.0], steady: 1.0, ..RippleNow::default() };
            let sample = RippleSample { speed: 10.0, position: Some(position), ..RippleSample::default() };
            let mut map = RippleMap::default();
            ripple.learn(&mut map, &mut { now }, &sample);
            map
        };
        let bound = FALSE_RIPPLE.get() * params().position_bound;
        assert_eq!(learnt_from(1.0), learnt_from(bound));
        assert!(learnt_from(0.5 * bound).position[0][0] < learnt_from(bound).position[0][0]);
    }

    #[test]
    fn a_map_is_kept_within_its_bounds() {
        let ripple = params().build(CONTROL_PERIOD).unwrap();
        let wild = RippleMap { position: [[1.0, f64::NAN]; 4], torque: [[-1.0, 0.005]; 4] };
        let kept = wild.within(&ripple);
        let used = |pair| [pair, pair, pair, [0.0; 2]];
        assert_eq!(kept, RippleMap { position: used([3e-4, 0.0]), torque: used([-0.01, 0.005]) });
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let build = |params: LearntRippleParams<f64>| params.build(CONTROL_PERIOD).unwrap_err();
        let named = |name| Error::OutOfRange(name);
        let order = RippleOrder { order: 1001, to_flexspline: false };
        assert_eq!(build(LearntRippleParams { orders: [order; 4], ..params() }), named("ripple_order"));
        assert_eq!(build(LearntRippleParams { torque_rate: -1.0, ..params() }), named("ripple_rate"));
        assert_eq!(
            build(LearntRippleParams { integral_rate: -1.0, ..params() }),
            named("ripple_integral_rate")
        );
        assert_eq!(build(LearntRippleParams { position_bound: f64::NAN, ..params() }), named("ripple_bound"));
        assert_eq!(build(LearntRippleParams { fastest: 0.0, ..params() }), named("ripple_speed"));
    }
}
