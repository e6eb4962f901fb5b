//! The two-port of Figs. 7-8: composes flexspline, hysteresis, friction and kinematic error.
//!
//! ```text
//! phi    = r*theta_wg + e(theta_wg) - theta_fs
//! tau_t  = tau_mesh(phi, dphi) + tau_hyst[phi]
//! J_fs * d2theta_fs = tau_t - tau_fric_out + tau_load
//! tau_wg = J_wg * d2theta_wg + tau_fric_in + (r + de/dtheta_wg) * tau_t
//! ```
//!
//! tau_load is the external torque ON the flexspline; tau_wg is what the motor must supply. With these
//! signs the power that enters both ports is the rate of the stored energy plus losses that are never
//! negative. Units: rad, rad/s, N m, kg m^2.
//!
//! Discretisation: semi-implicit Euler with the step dt, speeds first. The real-time build takes one
//! step per 0.1 ms with the condensed flexspline, the reference build many with the mesh: same code.
//! Inside a mesh the torque at the contact and at the flange differ by the shell's own inertia, and
//! the ellipse adds its reaction to tau_wg; the condensed flexspline has neither.

use crate::angle::{Angle, Heading, Ratio};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::flexspline::{Ends, Flexspline, FlexsplineParams, Reaction};
use crate::friction::{FrictionModel, FrictionParams, JointFrictionParams, Slip, StepTime};
use crate::hysteresis::table::HysteresisTable;
use crate::hysteresis::torsion::{TorsionHysteresis, TorsionHysteresisState, gap_for_width};
use crate::hysteresis::weights::Weights;
use crate::kinematic_error::{ErrorAndSlope, KinematicError, KinematicErrorParams};
use crate::real::Real;

/// Most terms of the kinematic error, relative to the case and to the flexspline each.
pub const KINEMATIC_TERMS: usize = 8;

/// Everything that a gear is built from; `P` are the parameters of its friction model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearParams<R, P = JointFrictionParams<R>> {
    /// n of the signed ratio r = 1/n: -N with the circular spline fixed, N + 1 with the flexspline fixed.
    pub ratio: i32,
    /// Rated torque at the output: the hysteresis loop closes there (N m).
    pub rated_torque: R,
    /// Cup, stiffness line and damping.
    pub flexspline: FlexsplineParams<R>,
    /// Full width of the hysteresis loop at zero torque after +-rated torque; 0 for none (rad).
    pub hysteresis_width: R,
    /// Identified weights of the hysteresis in the place of the standard shape of that width.
    pub hysteresis_table: Option<HysteresisTable<R>>,
    /// Kinematic error.
    pub kinematic_error: KinematicErrorParams<R, KINEMATIC_TERMS>,
    /// Friction at the wave generator.
    pub input_friction: P,
    /// Friction at the flexspline.
    pub output_friction: P,
    /// Inertia of wave generator and motor J_wg (kg m^2).
    pub wave_generator_inertia: R,
    /// Inertia of flexspline and load J_fs (kg m^2).
    pub flexspline_inertia: R,
}

/// An angle and its rate (rad/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<R> {
    /// Angle.
    pub angle: Angle<R>,
    /// Rate (rad/s).
    pub velocity: R,
}

impl<R: Real> Motion<R> {
    /// One semi-implicit step: the new rate moves the angle.
    #[inline(always)]
    pub fn advance(&mut self, acceleration: R, dt: R) {
        self.velocity += dt * acceleration;
        self.angle = self.angle.plus(dt * self.velocity);
    }
}

/// A gear around a flexspline model `F` and a friction model `C` of both contacts, stepped by a fixed dt, with
/// `L` levels of hysteresis and a memory of `MEMORY` turning points.
///
/// The wave generator is held and a load of -50 N m comes on: the output swings and settles at a wind-up of about
/// 50 N m over the stiffness, less what static friction holds.
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::compensator::{RealTimeFlexspline, RealTimeGear};
/// use strainwave::gear::Motion;
///
/// let params = JOINT.gear;
/// let flexspline = RealTimeFlexspline::build(&params.flexspline, params.rated_torque)?;
/// let gear: RealTimeGear<f32> = params.build(flexspline, JOINT.dt)?;
/// let (mut state, held, mut output) = (gear.rest(), Motion::default(), Motion::default());
/// let mut deepest = 0.0_f32;
/// for _ in 0..20_000 {
///     let torques = gear.step(&mut state, &mut output, &held, -50.0);
///     deepest = deepest.max(torques.torsion);
/// }
/// let torsion = held.angle.minus(output.angle);
/// let line = params.flexspline.line.build()?;
/// assert!((torsion - line.torsion(50.0)).abs() < 0.15 * torsion, "{torsion}"); // rad
/// assert!(deepest > 1.3 * torsion); // it overshot
/// assert!(output.velocity.abs() < 1e-3); // and is at rest after 2 s
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Debug, PartialEq)]
pub struct Gear<R: Real, F, C, const L: usize, const MEMORY: usize> {
    ratio: Ratio,
    ratio_value: R,
    inverse_flexspline_inertia: R,
    dt: StepTime<R>,
    input_friction: C,
    output_friction: C,
    flexspline: F,
    hysteresis: TorsionHysteresis<R, L, MEMORY>,
    kinematic_error: KinematicError<R, KINEMATIC_TERMS>,
}

/// Internal state of a gear, without the motion of its ends.
#[derive(Clone, Debug)]
pub struct GearState<R: Real, S, T, const MEMORY: usize> {
    flexspline: S,
    hysteresis: TorsionHysteresisState<R, MEMORY>,
    input_friction: T,
    output_friction: T,
}

/// Torques on both ends from outside (N m), where they are known: only friction at standstill reads them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Applied<R> {
    /// Of the motor on the wave generator.
    pub motor: R,
    /// Of the load on the flexspline.
    pub load: R,
}

/// Torques inside a gear (N m), and what they follow from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Torques<R> {
    /// Torsion phi (rad).
    pub torsion: R,
    /// Rate of the drive r*theta_wg + e (rad/s).
    pub drive_rate: R,
    /// Ratio r + de/dtheta_wg by which the transmitted torque loads the wave generator.
    pub slope: R,
    /// tau_t on the output flange.
    pub transmitted: R,
    /// Friction at the wave generator.
    pub input_friction: R,
    /// Friction at the flexspline.
    pub output_friction: R,
    /// Hysteresis part of tau_t.
    pub hysteresis: R,
    /// All that resists the wave generator but its inertia: tau_wg - J_wg*d2theta_wg.
    pub wave_generator: R,
    /// Power dissipated by the flexspline's damping (W).
    pub damping_loss: R,
    /// The flexspline's torque is at the end of its range.
    pub saturated: bool,
}

impl<R: Real, S, T, const MEMORY: usize> GearState<R, S, T, MEMORY> {
    /// Model of the flexspline.
    pub fn flexspline(&self) -> &S {
        &self.flexspline
    }
}

impl<R: Real, P: FrictionParams<R>> GearParams<R, P> {
    /// The hysteresis: identified weights, or the standard shape of its width.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is out of its range.
    pub fn hysteresis<const L: usize, const MEMORY: usize>(
        &self,
    ) -> Result<TorsionHysteresis<R, L, MEMORY>, Error> {
        let (half_range, weights) = self.hysteresis_weights()?;
        TorsionHysteresis::from_weights(half_range, &weights)
    }

    /// Its half range (rad) and weights (N m).
    ///
    /// # Errors
    /// As [`Self::hysteresis`].
    pub fn hysteresis_weights<const L: usize>(&self) -> Result<(R, Weights<R, L>), Error> {
        let half_range = self.flexspline.line.build()?.torsion(self.rated_torque);
        let gap = gap_for_width(self.flexspline.line.stiffness[0], self.hysteresis_width, half_range)?;
        match &self.hysteresis_table {
            Some(table) => Ok((table.half_range, table.weights()?)),
            None => Ok((half_range, Weights::uniform(gap)?)),
        }
    }

    /// Builds the gear around a flexspline model of the same time step dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is out of its range, as in the
    /// blocks' own `build`; `wave_generator_inertia`, `flexspline_inertia`, `rated_torque` unless finite and
    /// positive; `width` unless the loop is narrower than the torsion at rated torque; `dt` unless below
    /// half the period's radian of the torsion mode.
    pub fn build<F: Flexspline<R>, const L: usize, const MEMORY: usize>(
        &self,
        flexspline: F,
        dt: R,
    ) -> Result<Gear<R, F, P::Model, L, MEMORY>, Error> {
        self.flexspline.check()?;
        require(self.rated_torque.is_positive(), "rated_torque")?;
        require(self.wave_generator_inertia.is_positive(), "wave_generator_inertia")?;
        require(self.flexspline_inertia.is_positive(), "flexspline_inertia")?;
        let hysteresis = self.hysteresis()?;
        let stiffest = self.flexspline.line.stiffness[2];
        require(
            dt.is_positive() && dt <= R::ONE && dt * dt * stiffest < R::lit(0.25) * self.flexspline_inertia,
            "dt",
        )?;
        let ratio = Ratio::one_over(self.ratio)?;
        Ok(Gear {
            ratio,
            ratio_value: ratio.value(),
            kinematic_error: self.kinematic_error.build(ratio)?,
            flexspline,
            hysteresis,
            input_friction: self.input_friction.build()?,
            output_friction: self.output_friction.build()?,
            inverse_flexspline_inertia: R::ONE / self.flexspline_inertia,
            dt: StepTime::new(dt),
        })
    }
}

impl<R: Real, F: Flexspline<R>, C: FrictionModel<R>, const L: usize, const MEMORY: usize>
    Gear<R, F, C, L, MEMORY>
{
    /// At rest, both ends at the zero angle, never loaded before.
    pub fn rest(&self) -> GearState<R, F::State, C::State, MEMORY> {
        GearState {
            flexspline: self.flexspline.rest(),
            hysteresis: TorsionHysteresisState::default(),
            input_friction: C::State::default(),
            output_friction: C::State::default(),
        }
    }

    /// The exact gear ratio.
    pub fn ratio(&self) -> Ratio {
        self.ratio
    }

    /// The flexspline model.
    pub fn flexspline(&self) -> &F {
        &self.flexspline
    }

    /// Friction of the wave generator and of the flexspline.
    pub fn frictions(&self) -> (&C, &C) {
        (&self.input_friction, &self.output_friction)
    }

    /// The hysteresis of the torsion.
    pub fn hysteresis(&self) -> &TorsionHysteresis<R, L, MEMORY> {
        &self.hysteresis
    }

    /// Kinematic error at a wave-generator angle of this heading.
    #[inline(always)]
    pub fn kinematic_error(&self, wave_generator: Angle<R>, heading: Heading<R>) -> ErrorAndSlope<R> {
        self.kinematic_error.evaluate(wave_generator.counts, heading)
    }

    /// Angle of the output without torsion: r*theta_wg + e(theta_wg).
    pub fn drive(&self, wave_generator: Angle<R>) -> Angle<R> {
        self.ratio.apply(wave_generator).plus(self.kinematic_error.at(wave_generator).error)
    }

    /// Motion of the flexspline's ends for a motion of both sides.
    pub fn flexspline_ends(&self, wave_generator: &Motion<R>, flange: &Motion<R>) -> Ends<R> {
        self.ends(wave_generator, flange, wave_generator.angle.heading()).0
    }

    #[inline(always)]
    fn ends(&self, wave_generator: &Motion<R>, flange: &Motion<R>, heading: Heading<R>) -> (Ends<R>, R) {
        let ideal = self.ratio.apply(wave_generator.angle);
        let kinematic_error = self.kinematic_error(wave_generator.angle, heading);
        let slope = self.ratio_value + kinematic_error.slope;
        let ends = Ends {
            drive: ideal.plus(kinematic_error.error),
            drive_rate: slope * wave_generator.velocity,
            wave_generator: wave_generator.angle,
            wave_generator_rate: wave_generator.velocity,
            flange: flange.angle,
            flange_rate: flange.velocity,
        };
        (ends, slope)
    }

    /// Advances the memories by dt for the motion of both ends, and answers with the torques.
    pub fn torques(
        &self,
        state: &mut GearState<R, F::State, C::State, MEMORY>,
        wave_generator: &Motion<R>,
        flange: &Motion<R>,
        applied: Applied<R>,
    ) -> Torques<R> {
        let heading = wave_generator.angle.heading();
        let (ends, slope) = self.ends(wave_generator, flange, heading);
        let Reaction { torsion, contact, flange: on_flange, ellipse, loss, saturated } =
            self.flexspline.step(&mut state.flexspline, &ends);
        let hysteresis = self.hysteresis.step(&mut state.hysteresis, torsion).torque;
        let transmitted = on_flange + hysteresis;
        let reflected = slope * (contact + hysteresis);
        let resisting = reflected - ellipse;
        let slip = |velocity| Slip { wave_generator: heading, ..Slip::over(velocity, self.dt) };
        let input = slip(wave_generator.velocity).under(applied.motor - resisting, reflected);
        let output = slip(flange.velocity).under(applied.load + transmitted, transmitted);
        let input_friction = self.input_friction.step(&mut state.input_friction, &input).force;
        let output_friction = self.output_friction.step(&mut state.output_friction, &output).force;
        Torques {
            torsion,
            drive_rate: ends.drive_rate,
            slope,
            transmitted,
            input_friction,
            output_friction,
            hysteresis,
            wave_generator: input_friction + resisting,
            damping_loss: loss,
            saturated,
        }
    }

    /// Acceleration of the output flange (rad/s^2).
    #[inline(always)]
    pub fn flange_acceleration(&self, torques: &Torques<R>, load: R) -> R {
        (torques.transmitted - torques.output_friction + load) * self.inverse_flexspline_inertia
    }

    /// The two-port: moves the flange by one dt under `load` (N m), the wave generator as prescribed: where it
    /// stands, static friction holds as much of the torque that comes back through the gear as it can.
    pub fn step(
        &self,
        state: &mut GearState<R, F::State, C::State, MEMORY>,
        flange: &mut Motion<R>,
        wave_generator: &Motion<R>,
        load: R,
    ) -> Torques<R> {
        let torques = self.torques(state, wave_generator, flange, Applied { motor: R::ZERO, load });
        flange.advance(self.flange_acceleration(&torques, load), self.dt.seconds());
        torques
    }

    /// Energy stored in the flexspline (J).
    pub fn flexspline_energy(
        &self,
        state: &GearState<R, F::State, C::State, MEMORY>,
        wave_generator: &Motion<R>,
        flange: &Motion<R>,
    ) -> R {
        self.flexspline.energy(&state.flexspline, &self.flexspline_ends(wave_generator, flange))
    }
}

#[cfg(test)]
pub(crate) mod tests;
