//! Motor-side cascade: proportional position control around proportional-integral speed control.
//!
//! ```text
//! omega_ref = k_p*(theta_ref - theta) + dtheta_ref - T*ddtheta_ref
//! omega     = low pass of the encoder's difference quotient, corner omega_f
//! tau       = k_v*(omega_ref - omega) + I,   I += k_v/T_i*dt*(omega_ref - omega), |I| <= tau_max
//! ```
//!
//! While the supervisor ([`super::supervisor`]) reduces the feedback functions, k_p and 1/T_i are multiplied by
//! c + (1 - c)*gain, with c = 2/3, the inverse of [`UNCERTAINTY_MARGIN`], as the rule for a gear that nobody has tuned has its gains over
//! those of B0: an oscillation that goes on without these functions is one of the cascade. When they
//! are back, both rise slowly again. The cascade damps a load that swings on a spring above sqrt(k_p/T_i) (rad/s) and excites it below: position
//! loop and integral lag by the angles whose tangents are k_p/omega and 1/(T_i*omega), 90 degrees there. With the lag of filter and drive
//! it is a higher frequency; c lowers it to two thirds.
//!
//! T = 1/omega_f + dt/2 is the delay of omega, so that a reference whose acceleration is known does not lag by the
//! filter; an unknown acceleration is 0. Units: rad, rad/s, N m at the motor shaft; positive torque accelerates the
//! motor. Backward differences and explicit Euler with the control period dt. The integral is limited
//! to the motor's peak torque and stands still while the command is limited (conditional anti-windup).
//!
//! K. Astrom, T. Hagglund, "PID Controllers", 1995, section 3.5 (windup).
//!
//! Baselines and compensated runs share this cascade. The compensator alone leaves the rounding of the encoder out of the
//! position error of a motor at rest (`motor_reference.rs`): its reference lies anywhere within a count, theirs on one. And where the
//! encoder is coarse ([`FeedbackParams::estimates_speed`]) it takes omega of a motor at rest from the observer. A count is an impulse k_v*count on
//! the rotor, which returns a motor as fast as it came: between two counts nothing damps it, and it would go to and fro at some
//! k_v/(4*J) periods a second, with pulses of torque of up to half of the rated one with 14 bits.

use crate::compensator::tuned::{COARSE_COUNT, UNCERTAINTY_MARGIN};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::low_pass::LowPass;
use crate::real::Real;

/// Parameters of the cascade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackParams<R> {
    /// k_p (1/s).
    pub position_gain: R,
    /// k_v (N m s/rad).
    pub velocity_gain: R,
    /// T_i (s).
    pub integral_time: R,
    /// omega_f (rad/s).
    pub filter_corner: R,
    /// tau_max (N m).
    pub torque_limit: R,
}

/// The built cascade.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback<R> {
    position_gain: R,
    velocity_gain: R,
    integral_gain: R,
    filter: LowPass<R>,
    torque_limit: R,
    /// T (s).
    lateness: R,
}

/// Reference of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CascadeInput<R> {
    /// theta_ref - theta (rad).
    pub position_error: R,
    /// dtheta_ref (rad/s).
    pub velocity: R,
    /// ddtheta_ref, 0 where it is unknown (rad/s^2).
    pub acceleration: R,
}

/// How stiff the cascade is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness<R>(R);

impl<R: Real> Stiffness<R> {
    /// As it was built.
    pub const FULL: Self = Self(R::ONE);

    /// Of a cascade whose feedback functions have this `gain` (0..=1): k_p and 1/T_i are c of themselves at 0.
    #[inline(always)]
    fn with(gain: R) -> Self {
        let reduced = R::lit(1.0 / UNCERTAINTY_MARGIN.get());
        Self(reduced + (R::ONE - reduced) * gain)
    }

    /// No more of it than with this `gain` (0..=1).
    #[inline(always)]
    pub fn softer(self, gain: R) -> Self {
        Self(self.0.min(Self::with(gain).0))
    }

    /// More of it, by a `part` of what the full gain brings; above [`Stiffness::FULL`] until [`Stiffness::softer`] limits it.
    #[inline(always)]
    pub fn stiffer(self, part: R) -> Self {
        Self(self.0 + (R::ONE - R::lit(1.0 / UNCERTAINTY_MARGIN.get())) * part)
    }
}

/// State of the cascade.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeedbackState<R> {
    velocity: R,
    integral: R,
}

impl<R: Real> FeedbackParams<R> {
    /// Prepares the cascade for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first gain that is not finite and positive, or outside of what a cascade with this
    /// period can have: k_p*dt < 1, or each period reverses the position error; T_i >= dt; omega_f > k_p, or the speed loop is slower than
    /// the position loop around it.
    pub fn build(&self, dt: R) -> Result<Feedback<R>, Error> {
        require(self.position_gain.is_positive() && self.position_gain * dt < R::ONE, "position_gain")?;
        require(self.velocity_gain.is_positive(), "velocity_gain")?;
        require(self.integral_time.is_positive() && self.integral_time >= dt, "integral_time")?;
        require(
            self.filter_corner.is_positive() && self.filter_corner > self.position_gain,
            "filter_corner",
        )?;
        require(self.torque_limit.is_positive(), "torque_limit")?;
        let filter = LowPass::build(self.filter_corner, dt);
        Ok(Feedback {
            position_gain: self.position_gain,
            velocity_gain: self.velocity_gain,
            integral_gain: self.velocity_gain * dt / self.integral_time,
            filter,
            torque_limit: self.torque_limit,
            lateness: dt * (R::ONE / filter.gain() - R::lit(0.5)),
        })
    }

    /// At rest the speed comes from the observer: `count` (rad) is so coarse that one changes the torque by more than
    /// [`COARSE_COUNT`] of tau_max at once.
    pub fn estimates_speed(&self, count: R, dt: R) -> bool {
        let at_once = self.velocity_gain * LowPass::build(self.filter_corner, dt).gain() * count;
        at_once > R::lit(COARSE_COUNT.get()) * self.torque_limit * dt
    }
}

impl<R: Real> Feedback<R> {
    /// Adds a torque (N m) that another controller applied to the integral, within its limit; returns the change.
    pub fn take_over(&self, state: &mut FeedbackState<R>, torque: R) -> R {
        let before = state.integral;
        state.integral = (before + torque).limit(self.torque_limit);
        state.integral - before
    }

    /// Torque for a motor whose speed over this period was `speed` (rad/s); `limited`: the last command was limited.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut FeedbackState<R>,
        speed: R,
        input: &CascadeInput<R>,
        Stiffness(stiffness): Stiffness<R>,
        limited: bool,
    ) -> R {
        self.filter.step(&mut state.velocity, speed);
        let late = self.lateness * input.acceleration;
        let velocity = stiffness * self.position_gain * input.position_error + input.velocity - late;
        let lag = velocity - state.velocity;
        if !limited {
            state.integral = (state.integral + stiffness * self.integral_gain * lag).limit(self.torque_limit);
        }
        self.velocity_gain * lag + state.integral
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    const DT: f64 = 1e-4;
    const PARAMS: FeedbackParams<f64> = FeedbackParams {
        position_gain: 141.0,
        velocity_gain: 0.05,
        integral_time: 0.013,
        filter_corner: 1900.0,
        torque_limit: 2.4,
    };

    #[test]
    fn gains_that_make_no_cascade_are_refused_by_name() {
        let refused = |params: FeedbackParams<f64>| params.build(DT).err();
        let named = |what| Some(Error::OutOfRange(what));
        assert_eq!(refused(FeedbackParams { filter_corner: 9.9e3, position_gain: 9.8e3, ..PARAMS }), None);
        assert_eq!(refused(FeedbackParams { integral_time: DT, ..PARAMS }), None);
        for gain in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(refused(FeedbackParams { position_gain: gain, ..PARAMS }), named("position_gain"));
        }
        let fast = FeedbackParams { filter_corner: 2e4, position_gain: 1.0 / DT, ..PARAMS };
        assert_eq!(refused(fast), named("position_gain"));
        assert_eq!(refused(FeedbackParams { integral_time: 0.9 * DT, ..PARAMS }), named("integral_time"));
        let slow = FeedbackParams { filter_corner: PARAMS.position_gain, ..PARAMS };
        assert_eq!(refused(slow), named("filter_corner"));
    }

    /// The torque that a count brings at once, by the built cascade.
    fn by_a_count(bits: i32) -> f64 {
        let feedback = PARAMS.build(DT).unwrap();
        let speed = TAU / 2f64.powi(bits) / DT;
        -feedback.step(&mut FeedbackState::default(), speed, &CascadeInput::default(), Stiffness::FULL, true)
    }

    /// Position gain and integral are those of the softer cascade.
    #[test]
    fn a_reduced_cascade_is_softer() {
        let feedback = PARAMS.build(DT).unwrap();
        let input = CascadeInput { position_error: 1e-3, ..CascadeInput::default() };
        let torques = |stiffness| {
            let mut state = FeedbackState::default();
            let torque = feedback.step(&mut state, 0.0, &input, stiffness, false);
            [torque - state.integral, state.integral]
        };
        let softer = 1.0 / UNCERTAINTY_MARGIN.get();
        let expected = [softer, softer * softer];
        let [reduced, built] = [Stiffness::FULL.softer(0.0), Stiffness::FULL].map(torques);
        for (reduced, (built, expected)) in reduced.iter().zip(built.iter().zip(expected)) {
            assert!((reduced / built - expected).abs() < 1e-12);
        }
    }

    /// To the bit: a joint that never oscillated has the cascade that was built.
    #[test]
    fn a_cascade_is_as_soft_as_its_gain_at_once_and_comes_back_to_what_it_was() {
        let full = Stiffness::<f32>::FULL;
        assert_eq!([full.softer(1.0), full.stiffer(0.5).softer(1.0)], [full; 2]);
        let soft = full.softer(0.0);
        assert_eq!(soft.softer(1.0), soft);
        assert_eq!(soft.stiffer(0.5).softer(0.0), soft);
        let half = soft.stiffer(0.5);
        assert!((half.0 - full.softer(0.5).0).abs() < 1e-6);
        assert_eq!(half.stiffer(0.6).softer(1.0), full);
    }

    #[test]
    fn a_count_that_is_a_pulse_of_torque_makes_an_encoder_coarse() {
        for bits in 10..24 {
            let coarse = PARAMS.estimates_speed(TAU / 2f64.powi(bits), DT);
            assert_eq!(coarse, by_a_count(bits) > COARSE_COUNT.get() * PARAMS.torque_limit, "{bits}");
        }
        assert!(PARAMS.estimates_speed(TAU / 2f64.powi(13), DT));
        assert!(!PARAMS.estimates_speed(TAU / 2f64.powi(19), DT));
    }
}
