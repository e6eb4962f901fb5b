//! Armstrong's model of seven parameters: presliding, Stribeck effect with frictional memory, rising static
//! friction.
//!
//! ```text
//! sticking:  F = sigma0 * x                                      until |F| passes Fc + F_S(gamma, t_d)
//! sliding:   F = (Fc + F_S(gamma, t_d) / (1 + (v(t - tau_L)/vs)^2)) * sign(v) + Fv*v
//! F_S(gamma, t_d) = F_Sa + (F_Sinf - F_Sa) * t_d/(t_d + gamma)
//! ```
//!
//! x is the presliding deflection, t_d the time stuck before the slip, F_Sa what the Stribeck term had come
//! to when the last slip ended. A slip ends where v reaches zero or changes its sign; the spring then takes
//! over with the tension that sliding left, x = (Fc + F_Sa)/sigma0, so that F is continuous but for Fv*v.
//! (The paper's table has F_Sinf three times, and a dwell law that falls; this is Olsson's.)
//!
//! Frictional memory: v(t - tau_L) is a first-order lag of v, dw/dt = (v - w)/tau_L, not a delay line. It
//! delays by the same tau_L on average, needs one number instead of tau_L/dt of them, and is exact for any
//! step length, so that one built model serves steps of different length. What is lost is the sharp onset
//! of a pure delay.
//!
//! Sign: F has the sign of the velocity that it opposes or of the deflection, and is subtracted in the
//! equation of motion. Units: sigma0 (N/m) or (N m/rad), Fc, F_S (N) or (N m), Fv (N s/m) or (N m s/rad),
//! vs (m/s) or (rad/s), tau_L, gamma (s).
//!
//! Discretisation: spring, dwell and lag are exact over a step of constant velocity; which branch holds is
//! decided once a step, at its end, so that a break-away is late by less than a step.
//!
//! It loses work over any closed motion: what the spring gets back at the end of a slip is at most what it
//! lost when that slip began.
//!
//! Known weakness: two models and a switch. F jumps by Fv*v at a reversal that a step jumps over; the dwell
//! time of a joint that creeps is not defined by anything physical; seven parameters that no single
//! experiment separates.
//!
//! B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, "A survey of models, analysis tools and
//! compensation methods for the control of machines with friction", Automatica 30 (1994); H. Olsson et al.,
//! European Journal of Control 4 (1998).

use super::data::{FrictionData, LEVELS, PRESLIDING};
use super::registered::{ClosedMotionTest, Registered, Standstill};
use super::{FrictionModel, FrictionParams, Slip, require_divisor, require_level};
use crate::error::{Error, require};
use crate::real::Real;

/// The seven parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmstrongParams<R> {
    /// sigma0 (N/m) or (N m/rad); 1e-9..=1e12.
    pub stiffness: R,
    /// Fc (N) or (N m); 0..=1e6.
    pub coulomb: R,
    /// Fv (N s/m) or (N m s/rad); 0..=1e6.
    pub viscous: R,
    /// F_Sinf, what an endless rest adds to Fc (N) or (N m); 0..=1e6.
    pub stribeck: R,
    /// vs (m/s) or (rad/s); 1e-9..=1e6.
    pub stribeck_velocity: R,
    /// tau_L (s); 1e-9..=1e6.
    pub memory: R,
    /// gamma (s); 1e-9..=1e6.
    pub dwell: R,
}

impl<R: Real> FrictionParams<R> for ArmstrongParams<R> {
    type Model = Armstrong<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field.
    fn build(&self) -> Result<Armstrong<R>, Error> {
        require((R::lit(1e-9)..=R::lit(1e12)).contains(&self.stiffness), "stiffness")?;
        require_level(self.coulomb, "coulomb")?;
        require_level(self.viscous, "viscous")?;
        require_level(self.stribeck, "stribeck")?;
        require_divisor(self.stribeck_velocity, "stribeck_velocity")?;
        require_divisor(self.memory, "memory")?;
        require_divisor(self.dwell, "dwell")?;
        Ok(Armstrong {
            params: *self,
            slowness: R::ONE / self.stribeck_velocity,
            forgetting: R::ONE / self.memory,
        })
    }
}

impl<R: Real> Registered<R> for ArmstrongParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[
        LEVELS,
        &["stribeck_rad_per_s", "viscous_nm_s_per_rad"],
        PRESLIDING,
        &["frictional_memory_s", "dwell_s"],
    ];
    const STANDSTILL: Standstill = Standstill::Presliding;
    const STICK_SLIP: bool = true;

    /// sigma0 = Fs/eps, F_Sinf = Fs - Fc.
    fn of_data(data: &FrictionData<R>) -> Self {
        let FrictionData { forward, presliding, frictional_memory, dwell, .. } = *data;
        Self {
            stiffness: forward.static_level / presliding,
            coulomb: forward.coulomb,
            viscous: forward.viscous,
            stribeck: forward.static_level - forward.coulomb,
            stribeck_velocity: forward.stribeck_velocity,
            memory: frictional_memory,
            dwell,
        }
    }

    /// None: the force breaks away wherever its dwell puts it, so that no pieces of a path are known on which it is smooth.
    fn closed_motions(_: f64, _: f64, _: &mut impl ClosedMotionTest<R>) {}
}

/// Built model.
///
/// Static friction rises with the time at rest: after 1 s more is needed to break away than after 10 ms.
///
/// ```
/// use strainwave::friction::{ArmstrongParams, FrictionModel, FrictionParams, Slip};
///
/// let params = ArmstrongParams {
///     stiffness: 1e4, coulomb: 1.0, viscous: 0.0, stribeck: 0.5, stribeck_velocity: 0.01, memory: 1e-3, dwell: 0.1,
/// };
/// let friction = params.build()?;
/// let break_away_after = |rest: f64| {
///     let mut state = Default::default();
///     let mut peak = |velocity, time: f64| {
///         let steps = (time / 1e-4) as u32;
///         let slip = Slip::new(velocity, 1e-4);
///         (0..steps).fold(0.0_f64, |peak, _| peak.max(friction.step(&mut state, &slip).force))
///     };
///     peak(0.1, 0.5); // slides, its static surplus is gone
///     peak(0.0, rest);
///     peak(0.1, 0.1)
/// };
/// assert!(break_away_after(1.0) > break_away_after(0.01) + 0.3);
/// assert!(break_away_after(1.0) < 1.5);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Armstrong<R> {
    params: ArmstrongParams<R>,
    /// 1/vs.
    slowness: R,
    /// 1/tau_L.
    forgetting: R,
}

/// Which of the two laws holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Contact<R> {
    /// `deflection` x, stuck for `dwell` since the Stribeck term was `left`, F_Sa.
    Stuck { deflection: R, dwell: R, left: R },
    /// In the sense of `direction`, +-1, with F_S as it was at break-away.
    Sliding { direction: R, surplus: R },
}

/// Deflection or slip, the lagged velocity, and the last force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmstrongState<R> {
    contact: Contact<R>,
    lagged_velocity: R,
    force: R,
}

impl<R: Real> Default for ArmstrongState<R> {
    /// At rest for ever.
    fn default() -> Self {
        let contact = Contact::Stuck { deflection: R::ZERO, dwell: R::MAX, left: R::ZERO };
        Self { contact, lagged_velocity: R::ZERO, force: R::ZERO }
    }
}

impl<R: Real> Armstrong<R> {
    /// The Stribeck term `surplus` at the lagged velocity.
    #[inline]
    fn weakened(&self, surplus: R, lagged_velocity: R) -> R {
        let ratio = lagged_velocity * self.slowness;
        surplus / (R::ONE + ratio * ratio)
    }

    /// F_S(gamma, t_d).
    #[inline]
    fn surplus(&self, dwell: R, left: R) -> R {
        left + (self.params.stribeck - left) * (dwell / (dwell + self.params.dwell))
    }

    /// The end of a slip that `velocity` does not continue.
    #[inline]
    fn stopped(&self, state: &ArmstrongState<R>, velocity: R) -> Contact<R> {
        match state.contact {
            Contact::Sliding { direction, surplus } if velocity.sign() != direction => {
                let left = self.weakened(surplus, state.lagged_velocity);
                let deflection = direction * (self.params.coulomb + left) / self.params.stiffness;
                Contact::Stuck { deflection, dwell: R::ZERO, left }
            }
            unchanged => unchanged,
        }
    }

    /// A stuck contact moved on, which may break away.
    #[inline]
    fn moved(&self, contact: Contact<R>, slip: &Slip<R>) -> Contact<R> {
        let Contact::Stuck { deflection, dwell, left } = contact else { return contact };
        let dwell = (dwell + slip.duration.seconds()).min(R::MAX);
        let deflection = deflection + slip.displacement();
        let surplus = self.surplus(dwell, left);
        let direction = slip.velocity.sign();
        if direction * deflection * self.params.stiffness > self.params.coulomb + surplus {
            Contact::Sliding { direction, surplus }
        } else {
            Contact::Stuck { deflection, dwell, left }
        }
    }
}

impl<R: Real> FrictionModel<R> for Armstrong<R> {
    type State = ArmstrongState<R>;

    fn force(&self, state: &Self::State) -> R {
        state.force
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        let Slip { velocity, duration, .. } = *slip;
        state.contact = self.moved(self.stopped(state, velocity), slip);
        state.lagged_velocity +=
            (duration.seconds() * self.forgetting).one_minus_exp_neg() * (velocity - state.lagged_velocity);
        state.force = match state.contact {
            Contact::Stuck { deflection, .. } => self.params.stiffness * deflection,
            Contact::Sliding { direction, surplus } => {
                let level = self.params.coulomb + self.weakened(surplus, state.lagged_velocity);
                direction * level + self.params.viscous * velocity
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensator::schedule::CONTROL_PERIOD;
    use crate::friction::tests::Extremes;
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for ArmstrongParams<R> {
        fn extremes() -> Vec<Self> {
            let lit = R::lit;
            vec![Self {
                stiffness: lit(1e9),
                coulomb: lit(0.035),
                viscous: lit(1e6),
                stribeck: lit(0.015),
                stribeck_velocity: lit(1e-9),
                memory: lit(1e-9),
                dwell: lit(1e6),
            }]
        }
    }

    const PARAMS: ArmstrongParams<f64> = ArmstrongParams {
        stiffness: 1e3,
        coulomb: 1.0,
        viscous: 0.5,
        stribeck: 0.6,
        stribeck_velocity: 0.1,
        memory: 0.02,
        dwell: 2.0,
    };

    /// Force at the end, and the largest before, of a time (s) at a velocity (m/s).
    fn run(state: &mut ArmstrongState<f64>, velocity: f64, time: f64) -> (f64, f64) {
        let model = PARAMS.build().unwrap();
        let steps = (time / CONTROL_PERIOD).round() as usize;
        let forces = (0..steps).map(|_| model.step(state, &Slip::new(velocity, CONTROL_PERIOD)).force);
        forces.fold((0.0, 0.0), |(_, largest), force| (force, f64::max(largest, force)))
    }

    #[test]
    fn from_a_long_rest_it_breaks_away_at_the_full_static_level() {
        let (force, largest) = run(&mut ArmstrongState::default(), 1e-4, 30.0);
        assert!((largest - 1.6).abs() < 1e-3, "{largest}");
        assert!((force - (1.0 + 0.6 / (1.0 + 1e-6) + 0.5e-4)).abs() < 1e-12);
    }

    #[test]
    fn presliding_is_a_spring() {
        let mut state = ArmstrongState::default();
        assert!((run(&mut state, 0.01, 0.1).0 - 1.0).abs() < 1e-9);
        assert!(run(&mut state, -0.01, 0.1).0.abs() < 1e-9);
    }

    #[test]
    fn sliding_lies_on_the_stribeck_curve_and_lags_behind_a_change_of_speed() {
        let mut state = ArmstrongState::default();
        run(&mut state, 1.0, 1.0);
        let level =
            |lagged: f64, velocity: f64| 1.0 + 0.6 / (1.0 + (lagged / 0.1f64).powi(2)) + 0.5 * velocity;
        assert!((run(&mut state, 1.0, 0.5).0 - level(1.0, 1.0)).abs() < 1e-12);
        let force = run(&mut state, 0.05, 0.02).0;
        let lagged = 0.05 + 0.95 * (-1.0f64).exp();
        assert!((force - level(lagged, 0.05)).abs() < 1e-12);
    }

    #[test]
    fn static_friction_rises_with_the_dwell() {
        let break_away = |rest| {
            let mut state = ArmstrongState::default();
            run(&mut state, 1.0, 1.0);
            run(&mut state, 0.0, rest);
            run(&mut state, 1e-3, 2.0).1
        };
        let left = 0.6 / 101.0;
        for rest in [0.1, 1.0, 10.0] {
            let expected = 1.0 + left + (0.6 - left) * rest / (rest + 2.0);
            assert!((break_away(rest) - expected).abs() < 0.2, "{rest}: {} {expected}", break_away(rest));
        }
        assert!(break_away(0.1) < break_away(1.0) && break_away(1.0) < break_away(10.0));
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let name = |params: ArmstrongParams<f64>| params.build().unwrap_err();
        assert_eq!(name(ArmstrongParams { stiffness: 0.0, ..PARAMS }), Error::OutOfRange("stiffness"));
        assert_eq!(name(ArmstrongParams { coulomb: -1.0, ..PARAMS }), Error::OutOfRange("coulomb"));
        assert_eq!(name(ArmstrongParams { viscous: -1.0, ..PARAMS }), Error::OutOfRange("viscous"));
        assert_eq!(name(ArmstrongParams { stribeck: -1.0, ..PARAMS }), Error::OutOfRange("stribeck"));
        let error = name(ArmstrongParams { stribeck_velocity: 0.0, ..PARAMS });
        assert_eq!(error, Error::OutOfRange("stribeck_velocity"));
        assert_eq!(name(ArmstrongParams { memory: 0.0, ..PARAMS }), Error::OutOfRange("memory"));
        assert_eq!(name(ArmstrongParams { dwell: f64::NAN, ..PARAMS }), Error::OutOfRange("dwell"));
    }
}
