//! The gear's friction block, the same type at the wave generator and at the flexspline.
//!
//! ```text
//! dx_i/ds = (f_i*g*sign(v) - x_i) / (eps_i*g/g0)       F = sum x_i + Fv*v
//! g       = (Fc + (Fs - Fc)*exp(-|v/vs|^delta)) * ripple(theta_wg) + k*|tau|
//! ```
//!
//! g is the level: that of the lubricated contact, times what the ripple over the wave generator's angle
//! makes of it, plus what the torque tau through the contact adds. Fc, Fs, vs, Fv and the ripple have one value
//! for forward and one for backward motion; k one while the motor drives the load (tau*v > 0) and another
//! while the load drives the motor. f_i and eps_i are the levels and distances of a Bliman-Sorine model whose
//! kinetic level f1 - f2 is 1; g0 is Fs of forward motion.
//!
//! Levels: order 1 has f1 = 1. Order 2 has f1 = 1/(1 - eta), f2 = eta/(1 - eta), so that eta alone shapes
//! the rise: x peaks at s = eps*eta/(1-eta) * ln(1/eta^2) before it settles. A slow break-away from rest
//! therefore passes Fs by that peak: for eta = 0.3 it needs 1.107 Fs.
//!
//! Sign: F has the sign of the velocity that it opposes and is subtracted in the equation of motion; F*v >
//! 0 is power lost. Units: (N m), (rad), (rad/s); k has no unit.
//!
//! Discretisation: exact over a step of constant velocity and level.
//!
//! Work: never negative from rest, so over any closed motion, whatever speed, load and angle make of the
//! level. In the stretched path dq = g0/g ds the equation is that of Bliman and Sorine, dx_i/dq = (f_i*u -
//! x_i)/eps_i, with the input u = g*sign(v) instead of sign(v). Their transfer function is positive real, so
//! that the integral of F*u dq is not negative for any u whatever; and u dq = g0*sign(v) ds = g0*dx.
//!
//! Two simpler forms of a varying level do not have this. The product g*z with a normalised z and
//! dx_i/ds = (f_i*g*sign(v) - x_i)/eps_i both have a stiffness that follows g: loaded fast and unloaded
//! slowly, or the other way round, they return more than they stored, to second order in the stroke, while
//! the loss is of third order. Steady sliding is the same in all three: g*sign(v) + Fv*v. With this one,
//! presliding is as stiff at every level, f_i*g0/eps_i, and its distance grows with the level, as in LuGre.
//!
//! Known weakness: that presliding distance depends on speed and load is not measured on a strain-wave gear;
//! the break-away peak and eta are tied together; the level follows the load at once, without its lag.
//!
//! P.-A. Bliman, M. Sorine, European Control Conference, 1995; H. Olsson et al., European Journal of Control 4
//! (1998); the load's factors as in [`super::load_dependence`].

mod params;
#[cfg(test)]
mod passivity;
mod registered;
#[cfg(test)]
mod tests;

pub use self::params::{JointFrictionParams, Order};
pub use self::registered::JointFrictionOfOrder;
use super::bliman_sorine::{BlimanSorine, BlimanSorineState};
use super::load_dependence::DirectedLoad;
use super::lubricated_contact::LubricatedContact;
use super::ripple::{Harmonics, RIPPLE_ORDERS};
use super::{FrictionModel, Slip, StepTime};
use crate::angle::Heading;
use crate::constants::constants;
use crate::real::Real;

/// Presliding forces and the last torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFrictionState<R> {
    presliding: BlimanSorineState<R, 2>,
    /// Weights of the presliding forces, and what their path is stretched by: [`JointFriction::shape`].
    weights: [R; 2],
    stretch: R,
    force: R,
}

impl<R: Real> Default for JointFrictionState<R> {
    fn default() -> Self {
        Self {
            presliding: BlimanSorineState::default(),
            weights: [R::ONE; 2],
            stretch: R::ONE,
            force: R::ZERO,
        }
    }
}

/// Built model: everything that one direction of motion needs is in one place.
///
/// In steady sliding the level grows with the torque through the gear, by one factor while the motor drives the load and
/// by another while the load drives the motor. Over a closed stroke work is lost, whatever the load does meanwhile:
///
/// ```
/// use strainwave::friction::{
///     FrictionModel, FrictionParams, JointFrictionParams, LoadFactors, LubricatedContactParams, Order, Slip,
/// };
///
/// let contact = LubricatedContactParams {
///     coulomb: 0.035_f64, static_level: 0.050, stribeck_velocity: 2.0, stribeck_exponent: 1.0, viscous: 0.0,
/// };
/// let mut params = JointFrictionParams::symmetric(Order::Two, contact, 0.02, 0.3);
/// params.load = LoadFactors { driving: 0.1, driven: 0.05 };
/// let friction = params.build()?;
/// let steady = |load| {
///     let mut state = Default::default();
///     friction.step(&mut state, &Slip::new(100.0, 1.0).under(0.0, load)).force
/// };
/// assert!((steady(0.2) - steady(0.0) - 0.1 * 0.2).abs() < 1e-12);
/// assert!((steady(-0.2) - steady(0.0) - 0.05 * 0.2).abs() < 1e-12);
///
/// let (mut state, mut work) = (Default::default(), 0.0);
/// for step in 0..20_000 {
///     let time = f64::from(step) * 1e-4;
///     let slip = Slip::new(0.3 * (6.28 * time).cos(), 1e-4).under(0.0, 0.3 * (40.0 * time).sin());
///     work += friction.step(&mut state, &slip).force * slip.displacement();
/// }
/// assert!(work > 0.0);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFriction<R> {
    forward: Side<R>,
    backward: Side<R>,
    /// 1/eta; 0 with order 1.
    inverse_eta: R,
}

/// One direction of motion.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side<R> {
    contact: LubricatedContact<R>,
    ripple: Harmonics<R, RIPPLE_ORDERS>,
    load: DirectedLoad<R>,
    /// Of level 1 in this direction, over the path divided by g.
    presliding: BlimanSorine<R, 2>,
    /// The level is the contact's alone: there is neither ripple nor load.
    plain: bool,
}

impl<R: Real> Side<R> {
    fn new(
        contact: LubricatedContact<R>,
        ripple: Harmonics<R, RIPPLE_ORDERS>,
        load: DirectedLoad<R>,
        presliding: BlimanSorine<R, 2>,
    ) -> Self {
        Self { contact, ripple, load, presliding, plain: ripple.is_none() && load.is_none() }
    }

    /// g.
    #[inline(always)]
    fn level(&self, slip: &Slip<R>) -> R {
        let contact = self.contact.level(slip.velocity);
        if self.plain {
            return contact;
        }
        contact * self.ripple.relative_level(slip.wave_generator) + self.load.level(slip.load)
    }
}

impl<R: Real> JointFriction<R> {
    /// Gives the presliding the shape f*F_2 + (1 - f)*F_1 between that of order 2, f = 1, and that of order 1 over the
    /// same distance, f = 0: F_1 = -x_2*(1 - eta)/eta; and makes it 1 + u + u^2/2 times as stiff. Steady sliding is the
    /// same. A model of order 1 has no other shape. Dissipative for f > 0: the levels f/(1 - eta) and (f + eta - 1)/(1 - eta)
    /// are those of an order 2, or add up.
    #[inline(always)]
    pub fn shape(&self, state: &mut JointFrictionState<R>, order_two: R, stiffening: R) {
        state.stretch = R::ONE + stiffening + R::lit(0.5) * stiffening * stiffening;
        let other = R::ONE - order_two;
        if self.inverse_eta != R::ZERO {
            state.weights = [order_two, R::ONE - other * self.inverse_eta];
        }
    }

    /// F (N m) without the viscous part.
    #[inline(always)]
    pub fn presliding(&self, state: &JointFrictionState<R>) -> R {
        state.presliding.weighted(&state.weights)
    }

    /// F_2 - F_1 (N m), what f weighs; 0 in steady sliding.
    #[inline(always)]
    pub fn shaped(&self, state: &JointFrictionState<R>) -> R {
        if self.inverse_eta == R::ZERO {
            R::ZERO
        } else {
            state.presliding.weighted(&[R::ONE, self.inverse_eta])
        }
    }

    /// Moves on by `duration` at `velocity` (rad/s), within the limits of [`Slip`].
    // Never inlined: the timing budget counts this block by its symbol. Numbers come in registers.
    #[inline(never)]
    fn moved(
        &self,
        state: &mut JointFrictionState<R>,
        velocity: R,
        duration: StepTime<R>,
        load: R,
        wave_generator: Heading<R>,
    ) {
        let slip = Slip { velocity, duration, load, wave_generator, applied: R::ZERO };
        let side = if velocity < R::ZERO { &self.backward } else { &self.forward };
        let level = side.level(&slip);
        side.presliding.approach(
            &mut state.presliding,
            state.stretch * slip.displacement().abs() / level,
            level,
        );
        state.force = state.presliding.weighted(&state.weights) + side.contact.viscous(velocity);
    }
}

impl<R: Real> FrictionModel<R> for JointFriction<R> {
    type State = JointFrictionState<R>;
    const READS_LOAD: bool = true;

    #[inline(always)]
    fn force(&self, state: &Self::State) -> R {
        state.force
    }

    #[inline(always)]
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        self.moved(state, slip.velocity, slip.duration, slip.load, slip.wave_generator);
    }
}
