//! Disturbance estimate and compensation: the filtered external torque, and the motor's wind-up response to it.
//!
//! ```text
//! d_c = l + s*f                                                      compensated load
//! l:  dl/dt = omega_l*(D(d, z_0) - l) in motion, g*omega_l*D(d - l, z_0) at rest     slow part;  D(u, z) = u - limit(u, z)
//! f:  ddf = omega_f^2*(D(d - m, z) - f) - 2*omega_f*df,   dm/dt = omega_l*(d - m)     fast part,  z = z_0 + t*|tau_ff|
//! motor: speed -w*s*df/r,   acceleration -w*s*ddf/r,   torque -J_wg*w*s*ddf/r - r*f
//! ```
//!
//! d is the external torque on the flexspline that the observer estimates (N m), w the gear's compliance (rad/(N m)),
//! tau_ff the motor's feed-forward torque (N m). Semi-implicit Euler: f with the observer's period, l and the time
//! with the slow period of [`crate::compensator::schedule`]. g is the supervisor's gain, 0..=1 ([`crate::compensator::actuate::supervisor`]):
//! where friction lets go of the motor at once, the estimate of the load swings by several times that friction, the more the slower the
//! torsion mode is, and l alone kept a resting joint swinging. Units: rad, N m; signs as in [`crate::gear`].
//!
//! It responds to an estimate, so it closes a loop through the observer, which attributes every torque that the model
//! lacks to a load, and the motor. Each parameter limits the gain of that loop by an uncertainty:
//!
//! - z_0: the static friction of both sides, at the output. At standstill d is unobservable within it, and at a reversal
//!   where the friction is of another structure than the model's; most of it acts at the motor, which needs no wind-up
//!   for it. A response to d within z_0 would move the joint for its own friction: a limit cycle. So z_0 of a load is not
//!   compensated, and at rest, under any load, no change of it below z_0.
//! - t: tolerance of the torque constant and the rotor's inertia, which make an apparent load of an accelerating motor.
//! - s: a gear that winds up by the fraction s of its load is as stiff as K/(1 - s*K/K_model): a half leaves a gain
//!   margin of 2 to the stiffness.
//! - omega_f: the inverse of the delay of torque, drive and observer.
//!
//! A load is taken for a step. A residual d - m beyond z for more than 0.15 s, of which a tenth of the time within is taken
//! off, is an oscillation: f returns to zero, and the joint comes to rest on l alone. A third of it is added where the
//! residual is next beyond z with the other sign: a load comes and goes, the loop's limit cycle reverses a third time.

use crate::angle::Ratio;
use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::compensator::tuned::{OSCILLATION_TIME, OSCILLATIONS, RECOVERY};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::Real;

/// Parameters of the disturbance path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisturbanceParams<R> {
    /// omega_l, 0..=1e4 (rad/s).
    pub slow_corner: R,
    /// omega_f, 0..=1e4; limited to half of the inverse period of the observer (rad/s).
    pub fast_corner: R,
    /// z_0, half width of the dead zone, at least 0 (N m).
    pub dead_zone: R,
    /// t, at least 0 (N m at the output for each N m at the motor).
    pub tolerance: R,
    /// s, fraction of the fast part that the gear is wound up for, 0..=1.
    pub wind_up_fraction: R,
}

/// The built disturbance path.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance<R> {
    /// 1 - e^(-omega_l*dt) of the low pass l in a slow period.
    slow_gain: R,
    /// omega_f^2 and 2*omega_f.
    fast_square: R,
    fast_damping: R,
    dead_zone: R,
    tolerance: R,
    wind_up_fraction: R,
    longest: R,
    /// What a reversal adds to the time beyond the dead zone (s).
    reversal: R,
    wave_generator_inertia: R,
    ratio: R,
    /// s/r.
    motor_wind_up: R,
    /// Period of the observer, and slow period (s).
    dt: R,
    slow_dt: R,
}

/// l and f.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisturbanceState<R> {
    /// l and m (N m).
    slow: R,
    mean: R,
    /// z (N m); 0 before the first slow period, as d is.
    dead_zone: R,
    /// f (N m), with its derivatives.
    fast: R,
    rate: R,
    acceleration: R,
    /// Motor angle for each N m of f (rad/(N m)), and motor torque for each (1).
    by_torque: R,
    torque_ratio: R,
    /// d - m when it was last beyond the dead zone (N m).
    residual: R,
    /// For how long d has been beyond the dead zone (s).
    beyond: R,
    /// That is longer than a load takes to come.
    oscillates: bool,
    /// A change of d that takes from the compensated load is followed to its end.
    unloads: bool,
}

/// Inputs of the path in addition to d.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisturbanceInput<R> {
    /// Motor's feed-forward torque (N m).
    pub motor_torque: R,
    /// The setpoint rests.
    pub rests: bool,
    /// w times the gain of the wind-up compensation (rad/(N m)).
    pub compliance: R,
    /// Gain of the wind-up compensation, 0..=1.
    pub gain: R,
    /// Torque of gravity (N m).
    pub gravity: R,
    /// g, 0..=1.
    pub supervised: R,
}

/// Wind-up response: motion and torque of the motor, added to the feed-forward, that wind the gear up for a load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindUpResponse<R> {
    /// (rad/s)
    pub velocity: R,
    /// (rad/s^2)
    pub acceleration: R,
    /// (N m)
    pub torque: R,
}

impl<R: Real> DisturbanceParams<R> {
    /// Prepares the path for a gear and the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the parameter outside its range, `ratio`, or `dt` unless above 0 and up
    /// to 1.
    pub fn build(&self, gear: &GearParams<R>, dt: R) -> Result<Disturbance<R>, Error> {
        require(dt > R::ZERO && dt <= R::ONE, "dt")?;
        let within = |value: R, most: f64| value >= R::ZERO && value <= R::lit(most);
        require(within(self.slow_corner, 1e4), "slow_corner")?;
        require(within(self.fast_corner, 1e4), "fast_corner")?;
        require(within(self.dead_zone, 1e9), "dead_zone")?;
        require(within(self.tolerance, 1e9), "tolerance")?;
        require(within(self.wind_up_fraction, 1.0), "wind_up_fraction")?;
        let ratio = Ratio::one_over(gear.ratio)?;
        let [dt, slow_dt] = [OBSERVER_PERIODS, SLOW_PERIODS].map(|periods| R::from_i32(periods as i32) * dt);
        let fast_corner = self.fast_corner.min(R::lit(0.5) / dt);
        Ok(Disturbance {
            slow_gain: (slow_dt * self.slow_corner).one_minus_exp_neg(),
            fast_square: fast_corner * fast_corner,
            fast_damping: R::lit(2.0) * fast_corner,
            dead_zone: self.dead_zone,
            tolerance: self.tolerance,
            wind_up_fraction: self.wind_up_fraction,
            longest: R::lit(OSCILLATION_TIME),
            reversal: R::lit(OSCILLATION_TIME / OSCILLATIONS.get()),
            wave_generator_inertia: gear.wave_generator_inertia,
            ratio: ratio.value(),
            motor_wind_up: self.wind_up_fraction * R::from_i32(ratio.n()),
            dt,
            slow_dt,
        })
    }
}

impl<R: Real> Disturbance<R> {
    /// f over one period of the observer, towards d (N m).
    #[inline(always)]
    pub fn step_fast(&self, state: &mut DisturbanceState<R>, external_torque: R) {
        let beyond = (external_torque - state.mean).dead_zone(state.dead_zone);
        let target = if state.oscillates { R::ZERO } else { beyond };
        state.acceleration = self.fast_square * (target - state.fast) - self.fast_damping * state.rate;
        state.rate += self.dt * state.acceleration;
        state.fast += self.dt * state.rate;
    }

    /// l over one slow period, towards d (N m).
    #[inline(always)]
    pub fn step_slow(
        &self,
        state: &mut DisturbanceState<R>,
        external_torque: R,
        joint: &DisturbanceInput<R>,
    ) {
        let DisturbanceInput { motor_torque, rests, compliance, gain, gravity, supervised } = *joint;
        state.by_torque = -compliance * self.motor_wind_up;
        state.torque_ratio = self.ratio * gain;
        state.dead_zone = self.dead_zone + self.tolerance * motor_torque.abs();
        let residual = external_torque - state.mean;
        state.mean += self.slow_gain * residual;
        let change = if rests {
            let change = external_torque - state.slow;
            let beyond = change.dead_zone(self.dead_zone);
            let takes = change * (gravity + state.slow) < R::ZERO;
            state.unloads = takes && (state.unloads || beyond != R::ZERO);
            supervised * if state.unloads { change } else { beyond }
        } else {
            state.unloads = false;
            external_torque.dead_zone(self.dead_zone) - state.slow
        };
        state.slow += self.slow_gain * change;
        let time = if residual.is_within(state.dead_zone) {
            R::lit(-RECOVERY.get()) * self.slow_dt
        } else {
            let reverses = residual * state.residual < R::ZERO;
            state.residual = residual;
            if reverses { self.reversal } else { self.slow_dt }
        };
        state.beyond = (state.beyond + time).max(R::ZERO).min(self.longest + self.slow_dt);
        state.oscillates = state.beyond >= self.longest;
    }

    /// d_c (N m).
    #[inline(always)]
    pub fn compensated_load(&self, state: &DisturbanceState<R>) -> R {
        state.slow + self.wind_up_fraction * state.fast
    }

    /// m + s*f (N m): d with its slow part whole, its fast part as far as it is compensated.
    #[inline(always)]
    pub fn whole_load(&self, state: &DisturbanceState<R>) -> R {
        state.mean + self.wind_up_fraction * state.fast
    }

    /// Wind-up response to f.
    #[inline(always)]
    pub fn wind_up(&self, state: &DisturbanceState<R>) -> WindUpResponse<R> {
        let acceleration = state.by_torque * state.acceleration;
        WindUpResponse {
            velocity: state.by_torque * state.rate,
            acceleration,
            torque: self.wave_generator_inertia * acceleration - state.torque_ratio * state.fast,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::schedule::CONTROL_PERIOD;

    const PARAMS: DisturbanceParams<f64> = DisturbanceParams {
        slow_corner: 30.0,
        fast_corner: 1000.0,
        dead_zone: 6.0,
        tolerance: 20.0,
        wind_up_fraction: 0.5,
    };

    fn gear() -> GearParams<f64> {
        crate::gear::tests::params()
    }

    /// d_c and f after so many seconds under d (N m).
    fn after(seconds: f64, torque: impl Fn(f64) -> f64, motor_torque: f64, rests: bool) -> (f64, f64) {
        let compliance = 2.5e-5;
        let joint =
            DisturbanceInput { motor_torque, rests, compliance, gain: 1.0, gravity: 0.0, supervised: 1.0 };
        response(seconds, torque, &joint)
    }

    /// The same of this joint.
    fn response(seconds: f64, torque: impl Fn(f64) -> f64, joint: &DisturbanceInput<f64>) -> (f64, f64) {
        let (path, mut state) = (PARAMS.build(&gear(), CONTROL_PERIOD).unwrap(), DisturbanceState::default());
        let round = f64::from(SLOW_PERIODS) * CONTROL_PERIOD;
        for k in 0..(seconds / round) as usize {
            let d = torque(k as f64 * round);
            for _ in 0..SLOW_PERIODS / OBSERVER_PERIODS {
                path.step_fast(&mut state, d);
            }
            path.step_slow(&mut state, d, joint);
        }
        (path.compensated_load(&state), state.fast)
    }

    #[test]
    fn nothing_within_the_dead_zone_is_compensated() {
        let (compensated, fast) = after(1.0, |_| 5.9, 0.0, false);
        assert!(compensated.abs() < 1e-9 && fast.abs() < 1e-9, "{compensated}, {fast}");
    }

    #[test]
    fn a_load_is_compensated_within_milliseconds_and_in_the_end_but_for_the_dead_zone() {
        let (_, fast) = after(0.005, |_| 40.0, 0.0, true);
        assert!((20.0..34.0).contains(&fast), "{fast}");
        let (compensated, _) = after(1.0, |_| 40.0, 0.0, true);
        assert!((compensated - 34.0).abs() < 0.1, "{compensated}");
    }

    /// What is left of gravity and a load against it is compensated with the sign that it has, or not at all.
    #[test]
    fn a_load_that_holds_up_gravity_is_not_compensated_beyond_it() {
        let joint =
            DisturbanceInput { rests: true, gravity: -35.0, supervised: 1.0, ..DisturbanceInput::default() };
        for (load, least, most) in
            [(38.0, -0.1, 3.1), (33.0, -2.1, 0.1), (60.0, 18.9, 19.1), (5.9, -35.0, -35.0)]
        {
            let (compensated, _) = response(2.0, |_| load, &joint);
            let whole = joint.gravity + compensated;
            assert!((least..=most).contains(&whole), "{load}: {whole}");
        }
    }

    /// While the feedback functions are away; a joint that moves follows its load.
    #[test]
    fn at_rest_the_slow_part_stands_while_the_feedback_is_reduced() {
        let compensated = |rests, supervised| {
            let joint = DisturbanceInput { rests, supervised, ..DisturbanceInput::default() };
            response(2.0, |_| 40.0, &joint).0 - 0.5 * response(2.0, |_| 40.0, &joint).1
        };
        assert_eq!(compensated(true, 0.0), 0.0);
        assert!(
            [compensated(true, 1.0), compensated(false, 0.0)].iter().all(|slow| (slow - 34.0).abs() < 0.1)
        );
    }

    /// A tolerance of 20 N m at the output for each N m at the motor.
    #[test]
    fn the_dead_zone_widens_with_the_torque_that_is_fed_forward() {
        // The first response is to the torque that was fed forward before.
        let of = |motor_torque| after(0.005, |_| 25.0, motor_torque, false).1;
        assert!(of(1.0) < 0.1 * of(0.0) && of(0.0) > 5.0, "{}, {}", of(1.0), of(0.0));
    }

    /// Nor what grows for longer than a load takes to come.
    #[test]
    fn what_stays_beyond_the_mean_is_no_load() {
        let growing = |time: f64| 1000.0 * time;
        assert!(after(0.1, growing, 0.0, true).1 > 20.0);
        assert!(after(0.4, growing, 0.0, true).1.abs() < 1e-6);
    }

    #[test]
    fn an_oscillation_is_known_by_its_third_reversal() {
        let oscillation = |time: f64| 30.0 * (300.0 * time).sin();
        let half = core::f64::consts::PI / 300.0;
        assert!(after(3.0 * half, oscillation, 0.0, true).1.abs() > 3.0);
        assert!(after(3.5 * half + 0.02, oscillation, 0.0, true).1.abs() < 1e-4);
    }

    /// A blow of 10 ms is followed to its end.
    #[test]
    fn a_load_that_comes_and_goes_is_no_oscillation() {
        let blow = |time: f64| if (0.01..0.02).contains(&time) { 40.0 } else { 0.0 };
        assert!(after(0.02, blow, 0.0, true).1 > 20.0);
        assert!(after(0.1, blow, 0.0, true).1.abs() < 1.0);
        let again = |time: f64| blow(time) + blow(time - 0.1);
        assert!(after(0.12, again, 0.0, true).1 > 20.0);
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let build = |params: DisturbanceParams<f64>| params.build(&gear(), CONTROL_PERIOD).unwrap_err();
        let named = |name| Error::OutOfRange(name);
        assert_eq!(build(DisturbanceParams { wind_up_fraction: 1.1, ..PARAMS }), named("wind_up_fraction"));
        assert_eq!(build(DisturbanceParams { dead_zone: f64::NAN, ..PARAMS }), named("dead_zone"));
    }
}
