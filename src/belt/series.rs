//! Tooth belt in front of another gear, quasi-static: its two spans as one compliance between the pulleys.
//!
//! ```text
//! s       = (z_1/z_2)*theta_1 - theta_2                                                  stretch, at the driven pulley
//! s(tau)  = c*(tau + D(tau, tau_0)),   c = 1/(2*K*r_2^2),   tau_0 = 2*F0*r_2,   D(u, w) = u - limit(u, w)
//! F_forward, F_backward = max(0, F0 +- K*r_2*s),   tau = r_2*(F_forward - F_backward)
//! ```
//!
//! theta_1 is the angle of the motor's pulley, theta_2 that of the driven one, tau the torque that the belt gives it, K = EA/L the
//! stiffness of a span, F0 its tension at rest, r_2 the radius of the driven pulley. Beyond tau_0 one span is slack and the compliance
//! is doubled: it never pushes. Sign: tau and s are positive where the driven pulley is pulled forwards. Units: rad, N m, rad/(N m).
//!
//! Without state, and exact at rest: it is what [`super::RealTimeBelt`] settles to. Inertia and damping of the spans are left out: they
//! are for the inertias of both pulleys, which count as one on a belt that is stiff against the control's bandwidth.

use crate::belt::BeltParams;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::Real;

/// Whether the control step has code for a belt: the cargo feature `belt`.
pub const ENABLED: bool = cfg!(any(feature = "belt", test));

/// Parameters of the belt in front of a gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesBeltParams<R> {
    /// z_1 of the motor's pulley and z_2 of the driven one; 1..=[`super::MOST_TEETH`], their ratio 1/8..=4.
    pub teeth: [i32; 2],
    /// c (rad/(N m)), 0..=1; 0 of a belt that does not stretch.
    pub compliance: R,
    /// tau_0 (N m), at least 0.
    pub slack_torque: R,
}

/// The built belt.
///
/// Twice the torque at which one span goes slack stretches the belt three times as far as that torque:
///
/// ```
/// use strainwave::belt::SeriesBeltParams;
///
/// let belt = SeriesBeltParams { teeth: [24, 36], compliance: 4e-3_f64, slack_torque: 0.5 }.build()?;
/// assert_eq!(belt.stretch(0.5), 2e-3);
/// assert_eq!(belt.stretch(-1.0), -6e-3);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesBelt<R> {
    /// It stretches.
    stretches: bool,
    compliance: R,
    slack_torque: R,
}

impl<R: Real> SeriesBeltParams<R> {
    /// That of a belt gear of many parts.
    pub fn of<P>(belt: &BeltParams<R, P>) -> Self {
        let slack_torque = R::lit(2.0) * belt.span.pretension * belt.radius(&belt.output);
        let compliance = R::ONE / belt.torsional_stiffness();
        Self { teeth: [belt.motor.teeth, belt.output.teeth], compliance, slack_torque }
    }

    /// z_1/z_2: angle of the driven pulley over that of the motor's.
    pub fn ratio(&self) -> R {
        let [motor, driven] = self.teeth.map(R::from_i32);
        motor / driven
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `belt_teeth`, `belt_compliance` or `belt_slack_torque`.
    pub fn build(&self) -> Result<SeriesBelt<R>, Error> {
        require(self.teeth.iter().all(|teeth| (1..=super::MOST_TEETH).contains(teeth)), "belt_teeth")?;
        require((R::lit(0.125)..=R::lit(4.0)).contains(&self.ratio()), "belt_teeth")?;
        require((R::ZERO..=R::ONE).contains(&self.compliance), "belt_compliance")?;
        require(self.slack_torque.is_finite() && self.slack_torque >= R::ZERO, "belt_slack_torque")?;
        Ok(SeriesBelt {
            stretches: self.compliance > R::ZERO,
            compliance: self.compliance,
            slack_torque: self.slack_torque,
        })
    }
}

impl<R: Real> SeriesBelt<R> {
    /// None: it does not stretch.
    pub const NONE: Self = Self { stretches: false, compliance: R::ZERO, slack_torque: R::ZERO };

    /// s under a torque (rad).
    #[inline(always)]
    pub fn stretch(&self, torque: R) -> R {
        self.compliance * (torque + torque.dead_zone(self.slack_torque))
    }

    /// It stretches.
    #[inline(always)]
    pub fn stretches(&self) -> bool {
        ENABLED && self.stretches
    }

    /// In front of this gear, at its stiffest and with a span slack, it gives way by less than half as much as the gear: with the
    /// stretch of the torque before, the torsion comes to rest.
    pub fn contracts<P>(&self, gear: &GearParams<R, P>) -> bool {
        let n = R::from_i32(gear.ratio);
        let [.., stiffest] = gear.flexspline.line.stiffness;
        R::lit(2.0) * self.compliance * stiffest < R::lit(0.5) * n * n
    }

    /// ds/dtau while both spans are taut (rad/(N m)).
    #[inline(always)]
    pub fn compliance(&self) -> R {
        self.compliance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belt::{PitchErrorParams, PulleyParams, SpanParams};
    use crate::friction::ViscousParams;
    use crate::gear::{Applied, Motion};
    use proptest::prelude::*;

    fn belt() -> BeltParams<f64, ViscousParams<f64>> {
        let span =
            SpanParams { length: 0.2, stiffness: 6e4, mass: 0.025, pretension: 20.0, damping_time: 1e-5 };
        BeltParams {
            pitch: 0.003,
            belt_teeth: 160,
            span,
            motor: PulleyParams { teeth: 24, wrap: 3.1, inertia: 1e-5 },
            output: PulleyParams { teeth: 36, wrap: 3.18, inertia: 1e-5 },
            pitch_error: PitchErrorParams::default(),
            motor_friction: ViscousParams { viscous: 0.0 },
            output_friction: ViscousParams { viscous: 0.0 },
        }
    }

    proptest! {
        /// Both pulleys held apart by s: the belt gear of two spans gives the torque that s belongs to, taut and slack.
        #[test]
        fn the_belt_gear_at_rest_has_this_stretch(torque in -3.0..3.0f64) {
            let params = belt();
            let series = SeriesBeltParams::of(&params).build().unwrap();
            let model = params.build::<0>(1e-5).unwrap();
            let driven = Motion { angle: crate::Angle::from_radians_f64(-series.stretch(torque)), velocity: 0.0 };
            let torques = model.torques(&mut model.rest(), &Motion::default(), &driven, Applied::default());
            // To the counts of an angle.
            prop_assert!((torques.transmitted - torque).abs() < 1e-6, "{} {torque}", torques.transmitted);
            prop_assert!(torques.forward >= 0.0 && torques.backward >= 0.0);
            prop_assert_eq!(torques.slack, torque.abs() > 2.0 * 20.0 * params.radius(&params.output));
        }

        #[test]
        fn the_stretch_is_odd_and_rises(torque in -3.0..3.0f64, more in 1e-6..1.0f64) {
            let series = SeriesBeltParams::of(&belt()).build().unwrap();
            prop_assert_eq!(series.stretch(-torque), -series.stretch(torque));
            prop_assert!(series.stretch(torque + more) >= series.stretch(torque) + series.compliance() * more * (1.0 - 1e-9));
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let params = SeriesBeltParams { teeth: [24, 36], compliance: 1e-3, slack_torque: 1.0 };
        let named = |changed: SeriesBeltParams<f64>| changed.build().map(|_| ());
        let error = |name| Err(Error::OutOfRange(name));
        assert_eq!(named(params), Ok(()));
        assert_eq!(named(SeriesBeltParams { teeth: [24, 5], ..params }), error("belt_teeth"));
        assert_eq!(named(SeriesBeltParams { teeth: [0, 36], ..params }), error("belt_teeth"));
        assert_eq!(named(SeriesBeltParams { compliance: f64::NAN, ..params }), error("belt_compliance"));
        assert_eq!(named(SeriesBeltParams { slack_torque: -1.0, ..params }), error("belt_slack_torque"));
    }
}
