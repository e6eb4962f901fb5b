//! External load: what of the estimated external torque the gear is wound up for, and how the motor moves for it.
//!
//! ```text
//! d_ff = l + f,   l: low pass of d, 30 rad/s,   ddf = omega^2*(zone(d - l) - f) - 2*omega*df,   omega = 2400 rad/s
//! motor: speed -w*df/r,   acceleration -w*ddf/r,   torque -J_wg*w*ddf/r - r*f
//! ```
//!
//! d is the external torque on the flexspline that the observer believes (N m), zone: +-5 % of the rated torque, w
//! the gear's compliance (rad/(N m)). Semi-implicit Euler: f with the observer's period, l and the time with a round
//! of [`crate::compensator::schedule`]. Units: rad, N m; signs as in [`crate::gear`].
//!
//! It is an answer to an estimate, no feed-forward. What is small is left to the feedback's integral as a torque,
//! from which it is estimated, and its wind-up follows slowly: observer and motor loop would answer each other where
//! the gear is not what the model says, and noise would shake the joint. A load that leaves the zone is followed
//! within 1 ms, with all that the motor needs for it.
//!
//! The loop that this closes through observer and motor has little room for a drive that is later than it is believed
//! to be, and none while its torque is at its limit. So what leaves the zone must be a load that comes: after 0.15 s
//! beyond it, of which a tenth of the time within it is taken off, nothing large is followed, and a joint that shakes
//! comes to rest on l alone.

use crate::angle::Ratio;
use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::Real;

/// Parameters of the disturbance path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisturbanceParams<R> {
    /// Corner of l (rad/s).
    pub slow_corner: R,
    /// omega (rad/s).
    pub fast_corner: R,
    /// Half width of the dead zone (N m).
    pub dead_zone: R,
    /// How far d may be ahead of d_ff before it counts at once (N m).
    pub sudden: R,
    /// Share of d that is compensated, 0..=1.
    pub gain: R,
    /// By how much the dead zone is wider for each N m of the motor's feed-forward torque (N m/(N m)).
    pub tolerance: R,
    /// Share of the fast part that the gear is wound up for, and that the motor's torque carries.
    pub fast: [R; 2],
    /// Play of l at rest and in motion (N m).
    pub play: [R; 2],
}

/// Longest time that d may be beyond the zone as a load that comes (s), and the share of the time within that is
/// taken off it.
const LONGEST_LOAD: f64 = 0.15;
const FORGOTTEN: f64 = 0.1;

/// The built way of the external torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExternalLoad<R> {
    small_gain: R,
    large_corner: R,
    small: R,
    sudden: R,
    gain: R,
    tolerance: R,
    fast: [R; 2],
    play: [R; 2],
    longest: R,
    wave_generator_inertia: R,
    ratio: R,
    inverse_ratio: R,
    /// Period of the observer, and of a round (s).
    dt: R,
    round: R,
}

/// What is followed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExternalLoadState<R> {
    /// l (N m).
    small: R,
    /// By how much the dead zone is wider now (N m).
    wider: R,
    /// f, with its derivatives.
    large: R,
    rate: R,
    acceleration: R,
    /// For how long d has been beyond the zone (s).
    beyond: R,
    /// That is longer than a load takes to come.
    shakes: bool,
}

/// What of d may be rested on (N m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FollowedLoad<R> {
    /// d_ff: what the gear is wound up for.
    pub wound_up: R,
    /// The same, and at once what d is suddenly off it: what the output feedback may rest on.
    pub at_once: R,
}

/// What the motor does beside the feed-forward to wind the gear up for a load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Yielding<R> {
    /// (rad/s)
    pub velocity: R,
    /// (rad/s^2)
    pub acceleration: R,
    /// (N m)
    pub torque: R,
}

impl<R: Real> ExternalLoad<R> {
    /// For a gear and the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `ratio`, or `dt` unless above 0 and up to 1.
    pub fn build(params: &DisturbanceParams<R>, gear: &GearParams<R>, dt: R) -> Result<Self, Error> {
        require(dt > R::ZERO && dt <= R::ONE, "dt")?;
        let ratio = Ratio::one_over(gear.ratio)?;
        let [dt, round] = [OBSERVER_PERIODS, SLOW_PERIODS].map(|periods| R::from_i32(periods as i32) * dt);
        Ok(Self {
            small_gain: (round * params.slow_corner).one_minus_exp_neg(),
            large_corner: params.fast_corner.min(R::lit(0.5) / dt),
            small: params.dead_zone,
            sudden: params.sudden,
            gain: params.gain,
            tolerance: params.tolerance,
            fast: params.fast,
            play: params.play,
            longest: R::lit(LONGEST_LOAD),
            wave_generator_inertia: gear.wave_generator_inertia,
            ratio: ratio.value(),
            inverse_ratio: R::from_i32(ratio.n()),
            dt,
            round,
        })
    }

    /// f follows d (N m) for one period of the observer.
    #[inline(always)]
    pub fn follow(&self, state: &mut ExternalLoadState<R>, torque: R) {
        let torque = self.gain * torque;
        let (beyond, omega) = (self.beyond(torque - state.small, state.wider), self.large_corner);
        let lag = if state.shakes { R::ZERO } else { beyond } - state.large;
        state.acceleration = omega * (omega * lag - R::lit(2.0) * state.rate);
        state.rate += self.dt * state.acceleration;
        state.large += self.dt * state.rate;
    }

    /// What of a load is beyond the zone: one that comes, and no joint that shakes.
    #[inline(always)]
    fn beyond(&self, off: R, wider: R) -> R {
        off - off.limit(self.small + wider)
    }

    /// l follows d (N m) for one round; answers with what of d may be rested on (N m).
    #[inline(always)]
    pub fn rest_on(
        &self,
        state: &mut ExternalLoadState<R>,
        torque: R,
        motor_torque: R,
        rests: bool,
    ) -> FollowedLoad<R> {
        let torque = self.gain * torque;
        state.wider = self.tolerance * motor_torque.abs();
        let off = torque - state.small;
        let play = self.play[usize::from(!rests)];
        state.small += self.small_gain * (off - off.limit(play));
        state.beyond = if self.beyond(off, state.wider) == R::ZERO {
            (state.beyond - R::lit(FORGOTTEN) * self.round).max(R::ZERO)
        } else {
            (state.beyond + self.round).min(self.longest + self.round)
        };
        state.shakes = state.beyond >= self.longest;
        let wound_up = state.small + self.fast[0] * state.large;
        let ahead = torque - wound_up;
        let sudden = if state.shakes { R::ZERO } else { ahead - ahead.limit(self.sudden) };
        FollowedLoad { wound_up, at_once: wound_up + sudden }
    }

    /// What d_ff takes of the motor where the gear is wound up by `wound` (rad/(N m)) for it, the share `wind_up` of
    /// what it is.
    #[inline(always)]
    pub fn yielding(&self, state: &ExternalLoadState<R>, wound: R, wind_up: R) -> Yielding<R> {
        let by_torque = wound * self.inverse_ratio * self.fast[0];
        let acceleration = -by_torque * state.acceleration;
        Yielding {
            velocity: -by_torque * state.rate,
            acceleration,
            torque: self.wave_generator_inertia * acceleration
                - self.ratio * wind_up * self.fast[1] * state.large,
        }
    }
}
