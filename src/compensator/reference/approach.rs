//! Approach of a setpoint that the joint cannot follow.
//!
//! With x the setpoint less the last reference, extrapolated over the time dt since then, and s <- (1 - h/T_s)*s + x, h the
//! round, the joint cannot follow a setpoint when
//!
//! ```text
//! |s| > tau_max/(4*k_p*k_v*|n|)   or   |dq - dq_foreseen| > tau_max/(4*k_v*|n|) + a_max*h
//! a_max = min(0.9*a_p, 0.6*tau_max*|n|/(n^2*J_wg + J_fs))
//! ```
//!
//! (dq_foreseen: the extrapolated speed; a_p: what the gear's protection admits,
//! [`crate::compensator::actuate::protection::Protection::acceleration`]), for that is a step that would take a quarter of
//! the motor's torque. The factors leave room for 10 % of inertia at the gear, and at the motor for its friction and the
//! feedback, too. Then the reference approaches the setpoint within the joint's speed (90 %), a and a jerk of a in T_r/2 = 4 ms,
//! as fast as the motor's torque is ramped, until it reaches it:
//!
//! ```text
//! v = dq_c + limit(min(k_p/4*|e|, sqrt(max(a - |ddq_c|, 0)*|e|)))*sign(e)
//! ddq -> ddq_c + k_p*(v - dq) in -a_minus..a_plus
//! a_plus, a_minus = a_max*(1 +- l),   a = min(a_plus, a_minus),   l = limit(tau_ext/min(L, tau_max*|n|), 0.85)
//! ```
//!
//! tau_ext is the estimated external torque: with it the torques L of the gear and tau_max of the motor accelerate
//! the output more, and against it less. What the setpoint's own acceleration leaves of a catches up with it. Near by e is damped
//! critically, both its poles at k_p/2: the position loop, whose own is at k_p, follows.
//!
//! A stale setpoint is not approached: the reference brakes to rest within the same limits, and rests from the speed on that its jerk
//! makes in a round. Units: rad, N m, s; explicit
//! Euler over dt. While it approaches, a round has one period more ([`crate::compensator::schedule`]).

use crate::compensator::actuate::cascade::FeedbackParams;
use crate::compensator::actuate::protection::Protection;
use crate::compensator::schedule::SLOW_PERIODS;
use crate::compensator::tuned::{RESERVE, SETTLED_TIME, TRANSIENT_TIME};
use crate::compensator::{Limits, Setpoint};
use crate::constants::constants;
use crate::gear::GearParams;
use crate::real::Real;

/// The built approach.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Approach<R> {
    /// A round of an approach (s), whose slot takes two periods, and its inverse (1/s).
    round: R,
    inverse_round: R,
    /// a_max (rad/s^2).
    acceleration: R,
    /// 1/min(L, tau_max*|n|) (1/(N m)).
    by_load: R,
    /// k_p/4, and k_p (1/s).
    rate: R,
    speed_rate: R,
    /// Top speed of a reference (rad/s).
    velocity: R,
    /// Bounds of s (rad) and of the speed's difference (rad/s) within which a setpoint passes unchanged.
    near: R,
    near_velocity: R,
    /// 1 - h/T_s.
    keep: R,
}

/// Circumstances of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment<R> {
    /// dt (s).
    pub time: R,
    /// The setpoint is stale.
    pub stale: bool,
    /// tau_ext (N m).
    pub load: R,
}

impl<R: Real> Approach<R> {
    /// For setpoints that are read every `round` (s), of a joint with this cascade, whose limits were checked.
    pub fn build(
        gear: &GearParams<R>,
        limits: &Limits<R>,
        cascade: &FeedbackParams<R>,
        protection: &Protection<R>,
        round: R,
    ) -> Self {
        let n = R::from_i32(gear.ratio).abs();
        let whole = n * n * gear.wave_generator_inertia + gear.flexspline_inertia;
        let by_gear = R::lit(0.9) * protection.acceleration(gear);
        let acceleration = by_gear.min(R::lit(0.6) * limits.motor_torque * n / whole);
        let longer = round * R::lit(f64::from(SLOW_PERIODS + 1) / f64::from(SLOW_PERIODS));
        let quarter = R::lit(0.25) * limits.motor_torque / (cascade.velocity_gain * n);
        Self {
            round: longer,
            inverse_round: R::ONE / longer,
            acceleration,
            by_load: R::ONE / protection.torque().min(limits.motor_torque * n),
            rate: R::lit(0.25) * cascade.position_gain,
            speed_rate: cascade.position_gain,
            velocity: limits.setpoint_speed(gear.ratio),
            near: quarter / cascade.position_gain,
            near_velocity: quarter + acceleration * round,
            keep: (R::ONE - round * R::lit(1.0 / SETTLED_TIME.get())).max(R::ZERO),
        }
    }

    /// a_max (rad/s^2).
    #[inline(always)]
    pub fn acceleration(&self) -> R {
        self.acceleration
    }

    /// Top speed of a reference (rad/s).
    pub fn speed(&self) -> R {
        self.velocity
    }

    /// A distance (rad) at which a setpoint passes unchanged.
    #[inline(always)]
    pub fn is_near(&self, distance: R) -> bool {
        distance.is_within(self.near)
    }

    /// A speed (rad/s) that is braked to rest within a distance at which a setpoint passes unchanged.
    #[inline(always)]
    pub fn stops_near(&self, velocity: R) -> bool {
        R::lit(0.5) * velocity * velocity <= self.acceleration * self.near
    }

    /// The joint can follow from a reference to the setpoint after `time` (s); `slip` is s (rad).
    #[inline(always)]
    pub fn can_follow(&self, slip: &mut R, from: &Setpoint<R>, commanded: &Setpoint<R>, time: R) -> bool {
        let change = time * from.acceleration;
        let step = time * (from.velocity + R::lit(0.5) * change);
        *slip = self.keep * *slip + (commanded.position.minus(from.position) - step);
        let velocity_step = commanded.velocity - from.velocity - change;
        self.is_near(*slip) && velocity_step.is_within(self.near_velocity)
    }

    /// The reference extrapolated by `time` (s).
    #[cold]
    pub fn extrapolated(&self, from: Setpoint<R>, time: R) -> Setpoint<R> {
        let change = time * from.acceleration;
        let position = from.position.plus(time * (from.velocity + R::lit(0.5) * change));
        let velocity = (from.velocity + change).limit(self.velocity);
        Setpoint { position, velocity, acceleration: from.acceleration, ..Setpoint::default() }
    }

    /// The next reference; none where it has reached the setpoint.
    #[inline(always)]
    pub fn step(
        &self,
        from: &Setpoint<R>,
        commanded: &Setpoint<R>,
        moment: &Moment<R>,
    ) -> Option<Setpoint<R>> {
        let Moment { time, stale, load } = *moment;
        let helped = self.acceleration * (self.by_load * load).limit(R::lit(1.0 - RESERVE.get()));
        let [down, up] = [helped - self.acceleration, helped + self.acceleration];
        let most = up.min(-down);
        // A reference is extrapolated by its jerk until the next one.
        let jerked = time * from.jerk;
        let present = (from.acceleration + jerked).min(up).max(down);
        let change = time * (present - R::lit(0.5) * jerked);
        let position = from.position.plus(time * (from.velocity + R::lit(0.5) * change));
        let velocity = (from.velocity + change).limit(self.velocity);
        let step = most * self.round * R::lit(2.0 / TRANSIENT_TIME.get());
        let (target, along) = if stale {
            if velocity.is_within(step * time) {
                return Some(Setpoint { position, ..Setpoint::default() });
            }
            (R::ZERO, R::ZERO)
        } else {
            let distance = commanded.position.minus(position);
            let difference = commanded.velocity - velocity;
            if distance.is_within(R::lit(0.125) * self.near)
                && difference.is_within(R::lit(0.25) * self.near_velocity)
            {
                return None;
            }
            let (room, spare) = (distance.abs(), (most - commanded.acceleration.abs()).max(R::ZERO));
            let speed = (self.rate * room).min((spare * room).sqrt_or_zero());
            ((commanded.velocity + speed.copysign(distance)).limit(self.velocity), commanded.acceleration)
        };
        let acceleration = (along + self.speed_rate * (target - velocity)).min(up).max(down);
        let jerk = (acceleration - present).limit(step) * self.inverse_round;
        Some(Setpoint { position, velocity, acceleration: present, jerk, snap: R::ZERO })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::angle::Angle;
    use crate::compensator::schedule::{CONTROL_PERIOD, SLOW_PERIODS};
    use crate::compensator::tolerances::tests::TENTHS;

    pub const ROUND: f64 = SLOW_PERIODS as f64 * CONTROL_PERIOD;

    /// Gear, limits, cascade and protection of a joint.
    pub fn joint() -> (GearParams<f64>, Limits<f64>, FeedbackParams<f64>, Protection<f64>) {
        let gear = crate::gear::tests::params();
        let limits = Limits { motor_torque: 2.4, motor_speed: 586.0, output_torque: 157.0 };
        let cascade = FeedbackParams {
            position_gain: 141.0,
            velocity_gain: 0.068,
            integral_time: 0.03,
            filter_corner: 2500.0,
            torque_limit: 2.4,
        };
        let protection = Protection::build(&gear, &limits, &TENTHS, CONTROL_PERIOD);
        (gear, limits, cascade, protection)
    }

    fn approach() -> Approach<f64> {
        let (gear, limits, cascade, protection) = joint();
        Approach::build(&gear, &limits, &cascade, &protection, ROUND)
    }

    /// References on the way to rest at 0.5 rad, under a load (N m).
    fn way(load: f64) -> impl Iterator<Item = Setpoint<f64>> {
        let (approach, moment) = (approach(), Moment { time: ROUND, stale: false, load });
        let goal = Setpoint { position: Angle::from_radians_f64(0.5), ..Setpoint::default() };
        let next = move |from: &Setpoint<f64>| approach.step(from, &goal, &moment);
        core::iter::successors(Some(Setpoint::default()), next).take(2000)
    }

    #[test]
    fn it_arrives_within_its_acceleration() {
        for load in [-60.0, 0.0, 60.0] {
            let most = 2.0 * approach().acceleration;
            assert!(way(load).all(|reference| reference.acceleration.abs() <= most));
            let last = way(load).last().unwrap();
            assert!((last.position.to_radians() - 0.5).abs() < 1e-4 && way(load).count() < 2000, "{last:?}");
        }
    }

    #[test]
    fn a_load_leaves_less_acceleration_against_it() {
        let largest = |load: f64| way(load).map(|reference| reference.acceleration).fold(0.0, f64::max);
        assert!(largest(-60.0) < 0.6 * largest(0.0), "{} {}", largest(-60.0), largest(0.0));
        assert!(largest(60.0) > 1.4 * largest(0.0), "{} {}", largest(60.0), largest(0.0));
    }
}
