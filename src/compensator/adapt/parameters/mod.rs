//! Adaptation of inertia, friction, stiffness and presliding in operation, by the gradient method.
//!
//! ```text
//! residual torque of the model at the output (the observer's external torque d, model: the nominal gear)
//!     d = phi' (theta* - theta) + d_0 + noise,   phi = F(s)*w*[-J_fs*ddq, -tau_fric_out, -n*tau_fric_in],   theta = factor - 1
//! error      epsilon = zone(d - d_0)
//! law        theta <- limit(theta + dt*Gamma*phi*epsilon, bounds),        Gamma = diag(rate_i/level_i^2)
//! slow part  d_0   <- d_0 + dt*omega_0*(epsilon before the zone)
//! sides      epsilon_in = zone(m - m_0),  m = -(s + nu/c_0),  epsilon_out = zone(d - d_0 - (m - m_0))    with an output encoder
//! stiffness  c     <- limit(c - dt*gamma_c*phi*nu, bounds),                gamma_c = rate_c/level_c^2    with an output encoder
//!            c     <- limit(c + dt*gamma_f*psi*epsilon, bounds),           gamma_f = rate_f/level_f^2    without
//! presliding f     <- limit(f + dt*gamma_p*phi_p*epsilon_in, bounds),      phi_p = -F(s)*w*n*(F_2 - F_1)
//!            u     <- limit(u + dt*gamma_u*phi_u*epsilon_in, bounds),      phi_u = -F(s)*w*n*s*dF/ds,  F(u) = F((1 + u + u^2/2)*s)
//! flexing    psi   = F(s)*limit(c_0*(f_J*J_fs)^2*ddddq, level_f) where |dq| < v_f, else F(s)*0
//! ```
//!
//! The model reference is the observer's gear, run parallel to the joint (series-parallel) with the learnt corrections
//! ([`super::learning`]): its residual d is the model error, in N m at the output. q is the setpoint, tau_fric the
//! feed-forward's friction along it, F(s) two low passes that are as slow as the observer's d; d_0 (N m) is a constant
//! load or gravity. With an output encoder the torsion is measured, and with it the torque through the flexspline: the
//! balance of the motor's side has the residual m (N m at the output), s being the observer's residual of the torque
//! against the torsion. -tau_fric_in is learnt from that, the other two from the flange's residual d - m. m_0 is slow as
//! d_0: the encoders' zero. nu = theta_o - theta_fs (rad), the innovation of an output encoder, gives the compliance
//! factor c: the torque follows from the motor's, so in fast motion nu is the error of the estimated torsion phi, nu =
//! (c - c*)*phi/c, while offsets are removed by the observer's slow gain. The observer's model is corrected by c. Without
//! that encoder c is observable where the torque's rate changes: the load's displacement is then the motor's, less the
//! torsion, and the observer's residual is the torque by which the torsion accelerates the load, d = J*c_0*(c* -
//! c)*ddtau_t with tau_t of J*ddq. c_0 is the nominal compliance. That needs motions whose jerk changes within a few
//! periods of the torsion's mode; slow ones do not excite it. psi is limited: the step is stable for any motion. Above
//! v_f, the speed at which the kinematic error excites that mode, it is learnt at the beginning and the end of a move
//! alone. w is the gain of the friction feed-forward: 0 at rest, so that friction is learnt in motion alone.
//!
//! Friction of another structure than the model's differs after a reversal: f is the fraction of order 2 in its
//! presliding, the rest is of order 1 over the same distance ([`crate::friction::JointFriction::shape`]), and u its
//! stiffening. Both are learnt at the wave generator, s being its path since the reversal, and hold for either side. F_2
//! and F_1 are the same in sliding, so that the levels are learnt independently of them.
//!
//! # Lyapunov
//!
//! With the true theta* constant and inside its bounds, and e = theta - theta*, take V = e' Gamma^-1 e/2. Without the
//! dead zone dV/dt = e' phi epsilon = -(phi' e)^2 + (phi' e)*noise, so V falls wherever |phi' e| exceeds the noise.
//! The dead zone, wider than the noise, removes just the rest: where |epsilon| > zone, phi' e has the sign of
//! -epsilon and dV/dt <= 0; elsewhere theta stands still. c alike, with V = (c - c*)^2/(2*gamma_c): dV/dt = -(c -
//! c*)*phi*nu <= 0; without an output encoder it is one more component of theta, with psi in phi. Limiting theta to a
//! box that holds theta* (projection) only shortens e, and with a diagonal Gamma each component by itself. Euler's
//! step keeps this while dt*phi' Gamma phi < 2 ([`AdaptationParams::build`] checks it at the joint's peak torque).
//! theta converges along the directions that the motion excites and stands still along the others: with the motor
//! encoder alone the two frictions are separated only by their different Stribeck speeds and presliding. With an
//! output encoder V of the motor's side falls independently, and the flange's with the motor's residual: either
//! friction converges where it is excited. f is one more component of theta. u is not: its phi is the slope of the friction
//! by it where u is, so that V falls while u is so near that the slope keeps its sign; beyond that its bounds alone hold.
//! Friction that is neither, LuGre or with static friction, has no theta*: f and u then converge to the least mean square
//! of epsilon along the motion, and V need not fall.
//!
//! A residual beyond the factors' bounds is a load: where |d - d_0| exceeds twice `|phi|'*bounds` nothing is learnt.
//! The factors are held when it is switched off, when the torque command was limited, and on a fault.
//!
//! K. Narendra, A. Annaswamy, "Stable Adaptive Systems", 1989, chapters 3 (series-parallel models) and 8 (dead zone,
//! projection); P. Ioannou, J. Sun, "Robust Adaptive Control", 1996, section 4.4.

use crate::constants::constants;
use crate::error::{Error, require};
use crate::low_pass::LowPass;
use crate::real::Real;

/// Factors on the nominal gear's parameters; 1 is the nominal gear.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors<R> {
    /// On J_fs.
    pub inertia: R,
    /// On the friction of the wave generator.
    pub input_friction: R,
    /// On the friction of the flexspline.
    pub output_friction: R,
    /// c, on the compliance of the flexspline.
    pub compliance: R,
    /// f, the fraction of order 2 in the presliding of both frictions.
    pub presliding: R,
    /// 1 + u: the presliding of both is 1 + u + u^2/2 times as stiff.
    pub presliding_stiffness: R,
}

impl<R: Real> Default for Factors<R> {
    fn default() -> Self {
        Self {
            inertia: R::ONE,
            input_friction: R::ONE,
            output_friction: R::ONE,
            compliance: R::ONE,
            presliding: R::ONE,
            presliding_stiffness: R::ONE,
        }
    }
}

/// Largest deviation of a factor from 1 that may be allowed: a factor keeps its sign.
pub const LARGEST_DEVIATION: f64 = 0.9;

/// Parameters of the adaptation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptationParams<R> {
    /// Largest deviation of each factor from 1, 0..=[`LARGEST_DEVIATION`].
    pub bounds: Factors<R>,
    /// rate_i (1/s), > 0 or 0 for none: how fast each factor is learnt where its torque is at its level.
    pub rates: Factors<R>,
    /// level_i > 0: torque of inertia, of the friction of either side (N m at the output), and torsion (rad), where
    /// the gear bears its rated torque.
    pub levels: Factors<R>,
    /// Half width of the dead zone, >= 0 (N m at the output).
    pub dead_zone: R,
    /// Corner of F(s) (rad/s), > 0.
    pub filter_corner: R,
    /// omega_0 (rad/s), > 0.
    pub bias_corner: R,
    /// rate_f (1/s), >= 0.
    pub flexing_rate: R,
    /// level_f (N m), > 0.
    pub flexing_level: R,
    /// v_f, at the output (rad/s), >= 0.
    pub flexing_speed: R,
}

/// The built adaptation.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptation<R> {
    bounds: Factors<R>,
    /// dt*Gamma.
    gains: Factors<R>,
    dead_zone: R,
    filter: LowPass<R>,
    bias: R,
    n: R,
    flexspline_inertia: R,
    /// dt*gamma_f.
    flexing_gain: R,
    flexing_level: R,
    flexing_speed: R,
    /// c_0 (rad/(N m)), and its inverse.
    flexibility: R,
    stiffness: R,
}

/// Learnt factors, and the filters' states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AdaptationState<R: Real> {
    factors: Factors<R>,
    inertia: Delayed<R>,
    input_friction: Delayed<R>,
    output_friction: Delayed<R>,
    presliding: Delayed<R>,
    stiffness: Delayed<R>,
    flexing: Delayed<R>,
    /// d_0 and m_0.
    bias: R,
    input_bias: R,
}

/// Regressors of one slot, from the nominal gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excitation<R> {
    /// dq (rad/s).
    pub velocity: R,
    /// ddq (rad/s^2).
    pub acceleration: R,
    /// dddq (rad/s^3).
    pub jerk: R,
    /// ddddq (rad/s^4).
    pub snap: R,
    /// w*tau_fric_in, 0 where the setpoint rests (N m).
    pub input_friction: R,
    /// w*tau_fric_out, 0 where the setpoint rests (N m).
    pub output_friction: R,
    /// w*(F_2 - F_1) of the wave generator, 0 where the setpoint rests (N m).
    pub presliding: R,
    /// w*s*dF/ds of it (N m).
    pub stiffness: R,
}

/// Residuals of the observer in one slot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observed<R> {
    /// d (N m).
    pub external_torque: R,
    /// phi (rad).
    pub torsion: R,
    /// nu, where the sensors show it (rad).
    pub output_innovation: Option<R>,
    /// s, residual of the transmitted torque against the model's of that torsion (N m).
    pub stiffness_torque: R,
}

/// Two low passes in a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Delayed<R> {
    first: R,
    second: R,
}

impl<R: Real> Delayed<R> {
    #[inline(always)]
    fn step(&mut self, value: R, filter: LowPass<R>) -> R {
        filter.step(&mut self.first, value);
        filter.step(&mut self.second, self.first);
        self.second
    }
}

impl<R: Real> Factors<R> {
    #[inline(always)]
    fn all(&self) -> [R; 6] {
        [
            self.inertia,
            self.input_friction,
            self.output_friction,
            self.compliance,
            self.presliding,
            self.presliding_stiffness,
        ]
    }

    #[inline(always)]
    fn from_all(
        [inertia, input_friction, output_friction, compliance, presliding, presliding_stiffness]: [R; 6],
    ) -> Self {
        Self { inertia, input_friction, output_friction, compliance, presliding, presliding_stiffness }
    }

    /// 1 + gain*(factor - 1) of each.
    #[inline(always)]
    #[must_use]
    pub fn scaled(&self, gain: R) -> Self {
        Self::from_all(self.all().map(|factor| R::ONE + gain * (factor - R::ONE)))
    }

    /// 1/c - 1, the stiffening of the flexspline: to second order, within 0.2 % where |c - 1| <= 0.125.
    #[inline(always)]
    pub fn stiffening(&self) -> R {
        let difference = R::ONE - self.compliance;
        difference + difference * difference
    }

    /// Each limited to 1 +- its bound; one that is not finite is 1.
    #[must_use]
    pub fn within(&self, bounds: &Self) -> Self {
        let mut values = self.all();
        for (value, bound) in values.iter_mut().zip(bounds.all()) {
            *value = admitted(*value, bound);
        }
        Self::from_all(values)
    }
}

impl<R: Real> AdaptationParams<R> {
    /// Prepares the adaptation of a joint with the ratio 1/n, flexspline inertia J_fs (kg m^2) and peak torque at the
    /// output (N m), for slots that come every dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `adaptation_bounds`, `adaptation_levels`, `adaptation_rates` (also when so fast that a
    /// step at the peak torque would not be stable), `dead_zone`, `filter_corner`, `bias_corner`, `flexing_rate`,
    /// `flexing_level` or `flexing_speed`.
    pub fn build(&self, n: R, flexspline_inertia: R, peak_torque: R, dt: R) -> Result<Adaptation<R>, Error> {
        let within = |value: R, least: R, most: R| value.is_finite() && value >= least && value <= most;
        let every = |factors: &Factors<R>, holds: &dyn Fn(R) -> bool| factors.all().into_iter().all(holds);
        let fastest = R::lit(0.5) / dt;
        require(
            every(&self.bounds, &|bound| within(bound, R::ZERO, R::lit(LARGEST_DEVIATION))),
            "adaptation_bounds",
        )?;
        require(every(&self.levels, &|level| within(level, R::lit(1e-6), R::lit(1e6))), "adaptation_levels")?;
        require(every(&self.rates, &|rate| within(rate, R::ZERO, fastest)), "adaptation_rates")?;
        require(within(self.dead_zone, R::ZERO, peak_torque), "dead_zone")?;
        require(within(self.filter_corner, R::lit(1e-3), fastest), "filter_corner")?;
        require(within(self.bias_corner, R::lit(1e-6), fastest), "bias_corner")?;
        require(within(self.flexing_rate, R::ZERO, fastest), "flexing_rate")?;
        require(within(self.flexing_level, R::lit(1e-6), R::lit(1e6)), "flexing_level")?;
        require(within(self.flexing_speed, R::ZERO, R::lit(1e6)), "flexing_speed")?;
        let (rates, levels) = (self.rates.all(), self.levels.all());
        let gains = core::array::from_fn(|k| dt * rates[k] / (levels[k] * levels[k]));
        let overload = peak_torque / self.levels.inertia;
        let stable = |rate: R| dt * rate * overload * overload < R::ONE;
        require(stable(self.rates.inertia) && stable(self.rates.compliance), "adaptation_rates")?;
        Ok(Adaptation {
            bounds: self.bounds,
            gains: Factors::from_all(gains),
            dead_zone: self.dead_zone,
            filter: LowPass::build(self.filter_corner, dt),
            bias: dt * self.bias_corner,
            n,
            flexspline_inertia,
            flexing_gain: dt * self.flexing_rate / (self.flexing_level * self.flexing_level),
            flexing_level: self.flexing_level,
            flexing_speed: self.flexing_speed,
            flexibility: self.levels.compliance / self.levels.inertia,
            stiffness: self.levels.inertia / self.levels.compliance,
        })
    }
}

impl<R: Real> AdaptationState<R> {
    /// Learnt factors.
    #[inline(always)]
    pub fn factors(&self) -> &Factors<R> {
        &self.factors
    }
}

impl<R: Real> Adaptation<R> {
    /// Starts from stored factors, limited to their bounds.
    pub fn starting_from(&self, stored: &Factors<R>) -> AdaptationState<R> {
        AdaptationState { factors: stored.within(&self.bounds), ..AdaptationState::default() }
    }

    /// One slot; learns while `learns`. Returns epsilon (N m), 0 where nothing is learnt.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut AdaptationState<R>,
        excitation: &Excitation<R>,
        observed: &Observed<R>,
        learns: bool,
    ) -> R {
        let inertia = state.inertia.step(-self.flexspline_inertia * excitation.acceleration, self.filter);
        let input = state.input_friction.step(-self.n * excitation.input_friction, self.filter);
        let output = state.output_friction.step(-excitation.output_friction, self.filter);
        let presliding = state.presliding.step(-self.n * excitation.presliding, self.filter);
        let stiffness = state.stiffness.step(-self.n * excitation.stiffness, self.filter);
        let flexing = state.flexing.step(self.flexing(excitation, &state.factors), self.filter);
        let residual = observed.external_torque - state.bias;
        let (gains, bounds) = (&self.gains, &self.bounds);
        let reach = inertia.abs() * bounds.inertia
            + input.abs() * bounds.input_friction
            + output.abs() * bounds.output_friction
            + presliding.abs() * bounds.presliding
            + stiffness.abs() * bounds.presliding_stiffness;
        if !learns {
            return R::ZERO;
        }
        state.bias += self.bias * residual;
        if residual.abs() >= R::lit(2.0) * reach {
            return R::ZERO;
        }
        let [error, of_input] = self.errors(state, observed, residual);
        learn(&mut state.factors.inertia, gains.inertia * inertia * error, bounds.inertia);
        learn(
            &mut state.factors.input_friction,
            gains.input_friction * input * of_input,
            bounds.input_friction,
        );
        learn(
            &mut state.factors.output_friction,
            gains.output_friction * output * error,
            bounds.output_friction,
        );
        learn(&mut state.factors.presliding, gains.presliding * presliding * of_input, bounds.presliding);
        learn(
            &mut state.factors.presliding_stiffness,
            gains.presliding_stiffness * stiffness * of_input,
            bounds.presliding_stiffness,
        );
        let softer = match observed.output_innovation {
            Some(innovation) => -gains.compliance * observed.torsion * innovation,
            None => self.flexing_gain * flexing * error,
        };
        learn(&mut state.factors.compliance, softer, bounds.compliance);
        self.zone(residual)
    }

    /// Errors of flange and motor, for a d - d_0 of `residual` (N m): epsilon_out and epsilon_in, or twice epsilon.
    #[inline(always)]
    fn errors(&self, state: &mut AdaptationState<R>, observed: &Observed<R>, residual: R) -> [R; 2] {
        let Some(innovation) = observed.output_innovation else {
            return [self.zone(residual); 2];
        };
        let of_input = -(observed.stiffness_torque + self.stiffness * innovation) - state.input_bias;
        state.input_bias += self.bias * of_input;
        [self.zone(residual - of_input), self.zone(of_input)]
    }

    #[inline(always)]
    fn zone(&self, residual: R) -> R {
        residual.dead_zone(self.dead_zone)
    }

    /// psi before its filter.
    #[inline(always)]
    fn flexing(&self, excitation: &Excitation<R>, factors: &Factors<R>) -> R {
        if excitation.velocity.abs() >= self.flexing_speed {
            return R::ZERO;
        }
        let inertia = factors.inertia * self.flexspline_inertia;
        (self.flexibility * inertia * inertia * excitation.snap).limit(self.flexing_level)
    }
}

/// Adds `by` to a factor, limited to 1 +- `bound`.
#[inline(always)]
fn learn<R: Real>(factor: &mut R, by: R, bound: R) {
    *factor = projected(*factor + by, bound);
}

/// A stored factor, limited to 1 +- `bound`; 1 in the place of one that is not finite.
#[inline(never)] // Of six factors, once: for size.
fn admitted<R: Real>(factor: R, bound: R) -> R {
    projected(factor.finite_or(R::ONE), bound)
}

/// The projection of a factor: limited to 1 +- `bound`.
#[inline(always)]
fn projected<R: Real>(factor: R, bound: R) -> R {
    R::ONE + (factor - R::ONE).limit(bound)
}

#[cfg(test)]
mod tests;
