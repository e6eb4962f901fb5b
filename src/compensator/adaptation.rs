//! Adaptation: what the joint's inertia, friction and stiffness really are, learnt while it works.
//!
//! ```text
//! torque that the model misses at the output (the observer's external torque d, model: the nominal gear)
//!     d = phi' theta + d_0 + noise,   phi = F(s)*w*[-J_fs*ddq, -tau_fric_out, -n*tau_fric_in],   theta = factor - 1
//! error      epsilon = zone(d + d_in - phi' theta - d_0),   d_in = phi_in*theta_in, which the observer was told
//! law        theta <- limit(theta + dt*Gamma*phi*epsilon, bounds),        Gamma = diag(rate_i/level_i^2)
//! slow part  d_0   <- d_0 + dt*omega_0*(epsilon before the zone)
//! stiffness  c     <- limit(c - dt*gamma_c*tau_t*(s - (1 - c)*tau_t), bounds)
//! ```
//!
//! The model reference is the observer's own gear, run beside the joint (series-parallel): what it misses is the
//! model error, in N m at the output. q is the setpoint, tau_fric the feed-forward's friction along it, F(s) two low passes that
//! are as slow as the observer's d; d_0 (N m) is a load or gravity that is there anyway. s (N m), what the
//! transmitted torque is off the stiffness line where an output encoder shows it, gives the compliance factor c.
//! w is the share of friction that is fed forward: 0 at rest, so that friction is learnt in motion alone.
//!
//! # Lyapunov
//!
//! With the true theta* constant and inside its bounds, and e = theta - theta*, take V = e' Gamma^-1 e/2. Without
//! the dead zone dV/dt = e' phi epsilon = -(phi' e)^2 + (phi' e)*noise, so V falls wherever |phi' e| exceeds the noise. The dead zone,
//! wider than the noise, takes away just the rest: where |epsilon| > zone, phi' e has the sign of -epsilon and dV/dt <= 0;
//! elsewhere theta stands still. Limiting theta to a box that holds theta* (projection) only shortens e, and with a diagonal
//! Gamma each component by itself. Euler's step keeps this while dt*phi' Gamma phi < 2 ([`AdaptationParams::build`] checks it
//! at the joint's peak torque). theta converges along the directions that the motion excites and stands still along the
//! others: with the motor encoder alone the two frictions are told apart only by their different Stribeck speeds and presliding.
//!
//! It stands still when it is switched off, when the torque command was limited, and on a fault.
//!
//! K. Narendra, A. Annaswamy, "Stable Adaptive Systems", 1989, chapters 3 (series-parallel models) and 8 (dead zone,
//! projection); P. Ioannou, J. Sun, "Robust Adaptive Control", 1996, section 4.4.

use crate::error::{Error, require};
use crate::real::Real;

/// Factors on the nominal gear's parameters; 1 is the nominal gear.
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
}

impl<R: Real> Default for Factors<R> {
    fn default() -> Self {
        Self { inertia: R::ONE, input_friction: R::ONE, output_friction: R::ONE, compliance: R::ONE }
    }
}

/// Parameters of the adaptation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptationParams<R> {
    /// Largest deviation of each factor from 1, 0..=0.9.
    pub bounds: Factors<R>,
    /// rate_i (1/s), > 0 or 0 for none: how fast each factor is learnt where its torque is at its level.
    pub rates: Factors<R>,
    /// level_i > 0 (N m at the output): torque of inertia, of the friction of either side, and transmitted.
    pub levels: Factors<R>,
    /// Half width of the dead zone, >= 0 (N m at the output).
    pub dead_zone: R,
    /// Corner of F(s) (rad/s), > 0.
    pub filter_corner: R,
    /// omega_0 (rad/s), > 0.
    pub bias_corner: R,
}

/// The built adaptation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptation<R> {
    bounds: Factors<R>,
    /// dt*Gamma.
    gains: Factors<R>,
    dead_zone: R,
    filter: R,
    bias: R,
    n: R,
    flexspline_inertia: R,
}

/// What has been learnt, and the filters' states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AdaptationState<R: Real> {
    factors: Factors<R>,
    inertia: Delayed<R>,
    input_friction: Delayed<R>,
    output_friction: Delayed<R>,
    bias: R,
}

/// What the model says of this control period, from the nominal gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excitation<R> {
    /// ddq (rad/s^2).
    pub acceleration: R,
    /// w*tau_fric_in (N m).
    pub input_friction: R,
    /// w*tau_fric_out (N m).
    pub output_friction: R,
}

/// What the observer says of this control period (N m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observed<R> {
    /// d.
    pub external_torque: R,
    /// tau_t.
    pub transmitted_torque: R,
    /// s, where the sensors show it.
    pub stiffness_torque: Option<R>,
}

/// What the nominal gear missed (N m at the output).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Missed<R> {
    /// What the factors of inertia and output friction explain of d.
    pub explained: R,
    /// What is left when the slow part has been taken out as well.
    pub left: R,
}

/// Two low passes in a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Delayed<R> {
    first: R,
    second: R,
}

impl<R: Real> Delayed<R> {
    #[inline(always)]
    fn step(&mut self, value: R, gain: R) -> R {
        self.first += gain * (value - self.first);
        self.second += gain * (self.first - self.second);
        self.second
    }
}

impl<R: Real> Factors<R> {
    #[inline(always)]
    fn all(&self) -> [R; 4] {
        [self.inertia, self.input_friction, self.output_friction, self.compliance]
    }

    #[inline(always)]
    fn from_all([inertia, input_friction, output_friction, compliance]: [R; 4]) -> Self {
        Self { inertia, input_friction, output_friction, compliance }
    }

    /// 1 + share*(factor - 1) of each.
    #[inline(always)]
    #[must_use]
    pub fn scaled(&self, share: R) -> Self {
        Self::from_all(self.all().map(|factor| R::ONE + share * (factor - R::ONE)))
    }

    /// Each limited to 1 +- its bound; one that is not finite is 1.
    #[must_use]
    pub fn within(&self, bounds: &Self) -> Self {
        let (values, bounds) = (self.all(), bounds.all());
        Self::from_all(core::array::from_fn(|k| {
            R::ONE + (values[k].finite_or(R::ONE) - R::ONE).limit(bounds[k])
        }))
    }
}

impl<R: Real> AdaptationParams<R> {
    /// Prepares the adaptation of a joint with the ratio 1/n, flexspline inertia J_fs (kg m^2) and peak torque at the
    /// output (N m), for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `adaptation_bounds`, `adaptation_levels`, `adaptation_rates` (also when so fast that a step at the peak torque
    /// would not be stable), `dead_zone`, `filter_corner` or `bias_corner`.
    pub fn build(&self, n: R, flexspline_inertia: R, peak_torque: R, dt: R) -> Result<Adaptation<R>, Error> {
        let within = |value: R, least: R, most: R| value.is_finite() && value >= least && value <= most;
        let every = |factors: &Factors<R>, holds: &dyn Fn(R) -> bool| factors.all().into_iter().all(holds);
        let fastest = R::lit(0.5) / dt;
        require(every(&self.bounds, &|bound| within(bound, R::ZERO, R::lit(0.9))), "adaptation_bounds")?;
        require(every(&self.levels, &|level| within(level, R::lit(1e-6), R::lit(1e6))), "adaptation_levels")?;
        require(every(&self.rates, &|rate| within(rate, R::ZERO, fastest)), "adaptation_rates")?;
        require(within(self.dead_zone, R::ZERO, peak_torque), "dead_zone")?;
        require(within(self.filter_corner, R::lit(1e-3), fastest), "filter_corner")?;
        require(within(self.bias_corner, R::lit(1e-6), fastest), "bias_corner")?;
        let (rates, levels) = (self.rates.all(), self.levels.all());
        let gains = core::array::from_fn(|k| dt * rates[k] / (levels[k] * levels[k]));
        let stable = |gain: R| gain * peak_torque * peak_torque < R::ONE;
        require(stable(gains[0]) && stable(gains[3]), "adaptation_rates")?;
        Ok(Adaptation {
            bounds: self.bounds,
            gains: Factors::from_all(gains),
            dead_zone: self.dead_zone,
            filter: (dt * self.filter_corner).one_minus_exp_neg(),
            bias: dt * self.bias_corner,
            n,
            flexspline_inertia,
        })
    }
}

impl<R: Real> AdaptationState<R> {
    /// What has been learnt.
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

    /// One control period; learns while `learns`. The input friction is not in the answer: the observer was told.
    #[inline(never)] // The timing budget counts blocks by their symbols.
    pub fn step(
        &self,
        state: &mut AdaptationState<R>,
        excitation: &Excitation<R>,
        observed: &Observed<R>,
        learns: bool,
    ) -> Missed<R> {
        let inertia = state.inertia.step(-self.flexspline_inertia * excitation.acceleration, self.filter);
        let input = state.input_friction.step(-self.n * excitation.input_friction, self.filter);
        let output = state.output_friction.step(-excitation.output_friction, self.filter);
        let explained =
            inertia * (state.factors.inertia - R::ONE) + output * (state.factors.output_friction - R::ONE);
        let left = observed.external_torque - explained - state.bias;
        if learns {
            state.bias += self.bias * left;
            let error = left - left.limit(self.dead_zone);
            let (gains, bounds) = (&self.gains, &self.bounds);
            learn(&mut state.factors.inertia, gains.inertia * inertia * error, bounds.inertia);
            learn(&mut state.factors.input_friction, gains.input_friction * input * error, bounds.input_friction);
            let by = gains.output_friction * output * error;
            learn(&mut state.factors.output_friction, by, bounds.output_friction);
            if let Some(missed) = observed.stiffness_torque {
                let torque = observed.transmitted_torque;
                let error = missed - (R::ONE - state.factors.compliance) * torque;
                learn(&mut state.factors.compliance, -gains.compliance * torque * error, bounds.compliance);
            }
        }
        Missed { explained, left }
    }
}

/// Adds `by` to a factor, limited to 1 +- `bound` (the projection).
#[inline(always)]
fn learn<R: Real>(factor: &mut R, by: R, bound: R) {
    *factor = R::ONE + (*factor + by - R::ONE).limit(bound);
}
