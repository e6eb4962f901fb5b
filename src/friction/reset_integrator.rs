//! The reset integrator of Haessig and Friedland: one bond that stretches, and holds at its end.
//!
//! ```text
//! dz/dt = 0   where v > 0 and z >= z0,  or v < 0 and z <= -z0;     else v
//! F = (1 + a(z)) * sigma0 * z + sigma1 * dz/dt        a(z) = a where |z| < z0, else 0
//! ```
//!
//! The factor 1 + a makes static friction, (1 + a)*sigma0*z0, higher than sliding friction, sigma0*z0.
//!
//! Sign: F has the sign of v in steady sliding and is subtracted in the equation of motion. Units: sigma0
//! (N/m) or (N m/rad), sigma1 (N s/m) or (N m s/rad), z0 (m) or (rad); a has none.
//!
//! Discretisation: z is exact for any step; dz/dt is its mean over the step. It loses work over any closed
//! motion: sticking is a spring with a damper, sliding gives nothing back.
//!
//! Known weakness: the force drops from static to sliding all at once, at a place (z0) and not at a speed,
//! so there is no Stribeck curve; at a reversal after sliding it jumps up by a*sigma0*z0 before it falls;
//! sticking without sigma1 rings.
//!
//! D. A. Haessig, B. Friedland, "On the modeling and simulation of friction", Journal of Dynamic Systems,
//! Measurement, and Control 113 (1991); H. Olsson et al., European Journal of Control 4 (1998).

use super::data::{FrictionData, LEVELS, PRESLIDING};
use super::registered::{ClosedMotionTest, ForceOverPath, Registered, Standstill};
use super::{FrictionModel, FrictionParams, Slip, require_divisor, require_level};
use crate::error::Error;
use crate::real::Real;

/// Spring, damper and reach of the bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResetIntegratorParams<R> {
    /// sigma0 (N/m) or (N m/rad); 0..=1e6.
    pub stiffness: R,
    /// a, by which static friction is higher; 0..=1e6.
    pub stick_gain: R,
    /// sigma1 (N s/m) or (N m s/rad); 0..=1e6.
    pub damping: R,
    /// z0 (m) or (rad); 1e-9..=1e6.
    pub reach: R,
}

impl<R: Real> FrictionParams<R> for ResetIntegratorParams<R> {
    type Model = ResetIntegrator<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field.
    fn build(&self) -> Result<ResetIntegrator<R>, Error> {
        require_level(self.stiffness, "stiffness")?;
        require_level(self.stick_gain, "stick_gain")?;
        require_level(self.damping, "damping")?;
        require_divisor(self.reach, "reach")?;
        Ok(ResetIntegrator {
            sticking: (R::ONE + self.stick_gain) * self.stiffness,
            sliding: self.stiffness,
            damping: self.damping,
            reach: self.reach,
        })
    }
}

impl<R: Real> Registered<R> for ResetIntegratorParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[LEVELS, PRESLIDING];
    const MAY_HAVE: &'static [&'static str] = &["micro_damping_nm_s_per_rad"];
    const STANDSTILL: Standstill = Standstill::Presliding;
    const STICK_SLIP: bool = true;

    /// z0 = eps, sigma0 = Fc/eps, a = Fs/Fc - 1: static friction peaks at Fs.
    fn of_data(data: &FrictionData<R>) -> Self {
        let FrictionData { forward, presliding, micro_damping, .. } = *data;
        Self {
            stiffness: forward.coulomb / presliding,
            stick_gain: forward.static_level / forward.coulomb - R::ONE,
            damping: micro_damping,
            reach: presliding,
        }
    }

    /// Without sigma1, whose force depends on the speed.
    fn closed_motions(level: f64, distance: f64, test: &mut impl ClosedMotionTest<R>) {
        let [stiffness, stick_gain, damping, reach] = [level / distance, 0.5, 0.0, distance].map(R::lit);
        test.run(Self { stiffness, stick_gain, damping, reach }.build(), ForceOverPath::Straight);
    }
}

/// z and the last force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResetIntegratorState<R> {
    deflection: R,
    force: R,
}

/// Built model.
///
/// The bond breaks at (1 + a)*sigma0*z0 and then slides at sigma0*z0:
///
/// ```
/// use strainwave::friction::{FrictionModel, FrictionParams, ResetIntegratorParams, Slip};
///
/// let params = ResetIntegratorParams { stiffness: 1e4, stick_gain: 0.3, damping: 0.0, reach: 1e-4 };
/// let (friction, mut state) = (params.build()?, Default::default());
/// let slip = Slip::new(0.01, 1e-5);
/// let forces = [(); 2000].map(|()| friction.step(&mut state, &slip).force);
/// let peak = forces.into_iter().fold(0.0_f64, f64::max);
/// assert!((peak - 1.3).abs() < 2e-3); // to a step of the way
/// assert!((forces[1999] - 1.0).abs() < 1e-12);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResetIntegrator<R> {
    /// (1 + a)*sigma0.
    sticking: R,
    /// sigma0.
    sliding: R,
    damping: R,
    reach: R,
}

impl<R: Real> FrictionModel<R> for ResetIntegrator<R> {
    type State = ResetIntegratorState<R>;

    fn force(&self, state: &Self::State) -> R {
        state.force
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
        let before = state.deflection;
        state.deflection = (before + slip.displacement()).limit(self.reach);
        let stretched = state.deflection - before;
        let slope = if state.deflection.abs() < self.reach { self.sticking } else { self.sliding };
        // A step of no time has no rate; in a short one rounding must not pass for speed.
        let rate = (stretched / slip.duration.seconds()).finite_or(R::ZERO).limit(slip.velocity.abs());
        state.force = slope * state.deflection + self.damping * rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::Extremes;
    use std::vec;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for ResetIntegratorParams<R> {
        fn extremes() -> Vec<Self> {
            let [stiffness, stick_gain, damping, reach] = [1e6, 0.5, 1e6, 1e-9].map(R::lit);
            vec![Self { stiffness, stick_gain, damping, reach }]
        }
    }

    #[test]
    fn it_sticks_higher_than_it_slides_and_jumps_back_at_a_reversal() {
        let params = ResetIntegratorParams { stiffness: 100.0, stick_gain: 0.5, damping: 2.0, reach: 0.01 };
        let model = params.build().unwrap();
        let mut state = ResetIntegratorState::default();
        let mut after = |velocity, duration| model.step(&mut state, &Slip::new(velocity, duration)).force;
        assert!((after(0.01, 0.99) - (150.0 * 0.0099 + 0.02)).abs() < 1e-15);
        after(0.01, 0.1);
        assert_eq!(after(0.01, 0.1), 1.0);
        assert_eq!(after(7.0, 1.0), 1.0);
        assert_eq!(after(0.0, 0.1), 1.0);
        assert!((after(-0.001, 1e-3) - (1.5 - 0.002)).abs() < 1e-3);
        assert!((after(-1.0, 0.0) - 150.0 * 0.009_999).abs() < 1e-15);
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let params = ResetIntegratorParams { stiffness: 1.0, stick_gain: 1.0, damping: 1.0, reach: 1.0 };
        let name = |params: ResetIntegratorParams<f64>| params.build().unwrap_err();
        assert_eq!(name(ResetIntegratorParams { stiffness: -1.0, ..params }), Error::OutOfRange("stiffness"));
        assert_eq!(
            name(ResetIntegratorParams { stick_gain: -1.0, ..params }),
            Error::OutOfRange("stick_gain")
        );
        assert_eq!(name(ResetIntegratorParams { damping: -1.0, ..params }), Error::OutOfRange("damping"));
        assert_eq!(name(ResetIntegratorParams { reach: 0.0, ..params }), Error::OutOfRange("reach"));
    }
}
