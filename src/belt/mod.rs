//! Tooth-belt gear as a two-port: two pulleys, and both spans of the belt between them.
//!
//! ```text
//! s_1 = r_1*theta_1 + e_motor(theta_1),   s_2 = r_2*theta_2 + e_output(theta_2),   r = z*p/(2*pi)     travel of the belt
//! tau_t = (ds_2/dtheta_2) * (F_forward - F_backward)                                                  on the output
//! J_2 * d2theta_2 = tau_t - tau_fric_out + tau_load
//! tau_1 = J_1 * d2theta_1 + tau_fric_motor + (ds_1/dtheta_1) * (F_forward - F_backward)               what the motor must supply
//! phi = (s_1 - s_2)/r_2                                                                                torsion
//! ```
//!
//! The spans are [`chain`]s of N nodes each, between the travels of both pulleys; F are their tensions at the pulley in question.
//! With N = 0 they are the real-time reduction, [`RealTimeBelt`]. Statically, with K = EA/L a span and the pretension F0,
//! F = F0 +- K*(s_1 - s_2) until the tension of one span is 0; the torsional stiffness is 2*K*r_2^2 before and K*r_2^2 after.
//!
//! Sign: both pulleys turn the same way. The motor pulls the forward span when it turns forwards, the backward span when it turns
//! backwards; tension is positive. tau_load is the external torque ON the output, tau_t drives it forwards where phi > 0. With these
//! signs the power that enters both ports is the rate of the stored energy plus losses that are never negative. Units: rad, rad/s, m,
//! N, N m, kg m^2.
//!
//! J_1 and J_2 have the belt's own mass: that which lies on the pulley, and of either span half a link. Teeth do not
//! yield or jump; the belt on the pulleys does not stretch; centrifugal tension, rho*v^2, is left out.
//!
//! Discretisation: semi-implicit Euler with the step dt, speeds first, in spans and pulley alike; [`BeltParams::stable_step`] is its
//! bound. The travel s_1 - s_2 is a difference of integers: it is as exact after 10^6 revolutions as after none.
//!
//! R. Leniowski, "Modeling of torsional vibration in harmonic drives", introduction: the belt gear of the same library has axial
//! stretching alone and n degrees of freedom.

pub mod chain;
pub mod pitch_error;
pub mod series;

use core::f64::consts::TAU;

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::friction::{FrictionModel, FrictionParams, JointFriction, JointFrictionParams, Slip, StepTime};
use crate::gear::{Applied, Motion};
use crate::real::Real;

pub use chain::{BeltEnds, BeltReaction, Chain, ChainState, SpanParams, SpanState, Tension};
pub use pitch_error::{PitchError, PitchErrorParams, PitchTerm, TravelError};
pub use series::{SeriesBelt, SeriesBeltParams};

/// Most terms of each kind of the pitch error.
pub const PITCH_TERMS: usize = 8;
/// Most teeth of a pulley or belt.
pub const MOST_TEETH: i32 = 10_000;
/// Speeds (rad/s) and torques (N m) from outside beyond this count as this.
const LIMIT: f64 = 1e6;

/// For the controller: f32 or f64, each span one damped spring.
pub type RealTimeBelt<R> = Belt<R, JointFriction<R>, 0>;

/// One pulley.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulleyParams<R> {
    /// z; 1..=[`MOST_TEETH`].
    pub teeth: i32,
    /// Angle over which the belt lies on it (rad); up to 2*pi, and at least one tooth.
    pub wrap: R,
    /// Inertia of the pulley and what turns with it, without the belt (kg m^2); above 0, up to 1e6.
    pub inertia: R,
}

/// Everything that a belt gear is built from; `P` are the parameters of its friction model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltParams<R, P = JointFrictionParams<R>> {
    /// p, pitch of the teeth (m); 1e-4..=1.
    pub pitch: R,
    /// z_b, teeth of the belt; at least those of either pulley, up to [`MOST_TEETH`].
    pub belt_teeth: i32,
    /// Either span.
    pub span: SpanParams<R>,
    /// Pulley of the motor, its inertia with the rotor.
    pub motor: PulleyParams<R>,
    /// Pulley of the output, its inertia with the load.
    pub output: PulleyParams<R>,
    /// Pitch error of pulleys and belt.
    pub pitch_error: PitchErrorParams<R, PITCH_TERMS>,
    /// Friction at the motor's pulley.
    pub motor_friction: P,
    /// Friction at the output's pulley.
    pub output_friction: P,
}

impl<R: Real> PulleyParams<R> {
    /// The names are those of the teeth, the wrap and the inertia.
    fn check(&self, [teeth, wrap, inertia]: [&'static str; 3]) -> Result<(), Error> {
        require((1..=MOST_TEETH).contains(&self.teeth), teeth)?;
        require(self.teeth_in_mesh() >= R::ONE && self.wrap <= R::lit(TAU), wrap)?;
        require(self.inertia.is_positive() && self.inertia <= R::lit(1e6), inertia)
    }

    /// Teeth that the belt lies on.
    pub fn teeth_in_mesh(&self) -> R {
        R::from_i32(self.teeth) * self.wrap * R::lit(1.0 / TAU)
    }
}

impl<R: Real, P> BeltParams<R, P> {
    /// r of a pulley, at the pitch line (m).
    pub fn radius(&self, pulley: &PulleyParams<R>) -> R {
        R::from_i32(pulley.teeth) * self.pitch * R::lit(1.0 / TAU)
    }

    /// Inertia of a pulley with the belt that moves with it (kg m^2), beside spans of `nodes` each.
    pub fn inertia(&self, pulley: &PulleyParams<R>, nodes: usize) -> R {
        let radius = self.radius(pulley);
        let belt = self.span.mass * pulley.wrap * radius + self.span.link_mass(nodes);
        pulley.inertia + belt * radius * radius
    }

    /// Torsional stiffness at the output, both spans taut (N m/rad).
    pub fn torsional_stiffness(&self) -> R {
        let radius = self.radius(&self.output);
        R::lit(2.0) * self.span.span_stiffness() * radius * radius
    }

    /// Bound of the time step with `nodes` a span (s): [`Self::build`] refuses it and every longer one. Friction is not in it.
    pub fn stable_step(&self, nodes: usize) -> R {
        let radius = self.radius(&self.output);
        self.span.stable_step(nodes, self.inertia(&self.output, nodes) / (radius * radius))
    }
}

impl<R: Real, P: FrictionParams<R>> BeltParams<R, P> {
    /// Checks and precomputes, for spans of `N` nodes and the time step dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is out of its range: `pitch`; `motor_teeth`,
    /// `motor_wrap` (less than one tooth engaged, or more than the pulley has), `motor_inertia`, `output_teeth`,
    /// `output_wrap`, `output_inertia`; `belt_teeth`; `length`, `stiffness`, `mass`, `pretension`, `damping_time` of the span; `order`,
    /// `amplitude`, `phase` of the pitch error; `dt` unless below [`Self::stable_step`] and at most 1 s; the names of the
    /// friction's own `build`.
    pub fn build<const N: usize>(&self, dt: R) -> Result<Belt<R, P::Model, N>, Error> {
        require((R::lit(1e-4)..=R::ONE).contains(&self.pitch), "pitch")?;
        self.motor.check(["motor_teeth", "motor_wrap", "motor_inertia"])?;
        self.output.check(["output_teeth", "output_wrap", "output_inertia"])?;
        let most = self.motor.teeth.max(self.output.teeth);
        require((most..=MOST_TEETH).contains(&self.belt_teeth), "belt_teeth")?;
        self.span.check()?;
        require(dt <= R::ONE, "dt")?;
        let output_radius = self.radius(&self.output);
        let output_inertia = self.inertia(&self.output, N);
        Ok(Belt {
            teeth: [self.motor.teeth, self.output.teeth],
            metres_per_radian: self.pitch * R::lit(1.0 / TAU),
            radius: [self.radius(&self.motor), output_radius],
            inverse_output_radius: R::ONE / output_radius,
            motor_inertia: self.inertia(&self.motor, N),
            inverse_output_inertia: R::ONE / output_inertia,
            dt: StepTime::new(dt),
            chain: self.span.build(output_inertia / (output_radius * output_radius), dt)?,
            pitch_error: self.pitch_error.build(self.motor.teeth, self.belt_teeth)?,
            motor_friction: self.motor_friction.build()?,
            output_friction: self.output_friction.build()?,
        })
    }
}

/// A belt gear with a friction model `C` of both pulleys and spans of `N` nodes each, stepped by a fixed dt.
///
/// The motor is held and a load comes on: the output gives way by the load over the stiffness of both spans, the one span
/// tighter and the other looser by half of the force each.
///
/// ```
/// use strainwave::belt::{BeltParams, PitchErrorParams, PulleyParams, SpanParams};
/// use strainwave::friction::ViscousParams;
/// use strainwave::gear::Motion;
///
/// let span = SpanParams { length: 0.2, stiffness: 2.8e5, mass: 0.05, pretension: 300.0, damping_time: 2e-4 };
/// let params = BeltParams {
///     pitch: 0.005,
///     belt_teeth: 120,
///     span,
///     motor: PulleyParams { teeth: 20, wrap: 3.1, inertia: 1e-4 },
///     output: PulleyParams { teeth: 60, wrap: 3.18, inertia: 0.01 },
///     pitch_error: PitchErrorParams::default(),
///     motor_friction: ViscousParams { viscous: 0.0 },
///     output_friction: ViscousParams { viscous: 2.0 },
/// };
/// let belt = params.build::<0>(1e-4)?; // the reduction of real time
/// let (mut state, held, mut output, load) = (belt.rest(), Motion::default(), Motion::default(), -5.0_f64);
/// let mut torques = Default::default();
/// for _ in 0..20_000 {
///     torques = belt.step(&mut state, &mut output, &held, load);
/// }
/// assert!((torques.transmitted + load).abs() < 1e-9);
/// assert!((torques.torsion + load / params.torsional_stiffness()).abs() < 1e-9); // up to rounding
/// let half = 0.5 * 5.0 / params.radius(&params.output);
/// assert!((torques.forward - 300.0 - half).abs() < 1e-6); // the load pulls the output backwards
/// assert!((torques.backward - 300.0 + half).abs() < 1e-6);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Belt<R: Real, C, const N: usize> {
    /// z_1 and z_2.
    teeth: [i32; 2],
    /// p/(2*pi).
    metres_per_radian: R,
    /// r_1 and r_2.
    radius: [R; 2],
    inverse_output_radius: R,
    motor_inertia: R,
    inverse_output_inertia: R,
    dt: StepTime<R>,
    chain: Chain<R, N>,
    pitch_error: PitchError<R, PITCH_TERMS>,
    motor_friction: C,
    output_friction: C,
}

/// Internal state of a belt gear, without the motion of its ends.
#[derive(Clone, Debug)]
pub struct BeltState<R, T, const N: usize> {
    /// Nodes of both spans.
    pub chain: ChainState<R, N>,
    motor_friction: T,
    output_friction: T,
}

/// Torques (N m) and forces (N) of a belt gear, and what they follow from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeltTorques<R> {
    /// Torsion phi at the output (rad).
    pub torsion: R,
    /// tau_t on the output's pulley.
    pub transmitted: R,
    /// Tension of the forward span at the output's pulley (N).
    pub forward: R,
    /// Tension of the backward span at the output's pulley (N).
    pub backward: R,
    /// Friction at the motor's pulley.
    pub motor_friction: R,
    /// Friction at the output's pulley.
    pub output_friction: R,
    /// All that resists the motor but inertia: tau_1 - J_1*d2theta_1.
    pub motor: R,
    /// Power dissipated by the spans' damping (W).
    pub damping_loss: R,
    /// A link of a span is slack.
    pub slack: bool,
}

/// Travel of the belt at both pulleys, and its derivatives by their angles (m/rad).
struct Travel<R> {
    ends: BeltEnds<R>,
    slope: [R; 2],
}

impl<R: Real, C: FrictionModel<R>, const N: usize> Belt<R, C, N> {
    /// At rest, both pulleys at the zero angle.
    pub fn rest(&self) -> BeltState<R, C::State, N> {
        self.running(R::ZERO)
    }

    /// As at rest, the belt running at the speed of the motor's pulley at `motor_velocity` (rad/s).
    pub fn running(&self, motor_velocity: R) -> BeltState<R, C::State, N> {
        BeltState {
            chain: ChainState::running(self.radius[0] * motor_velocity),
            motor_friction: C::State::default(),
            output_friction: C::State::default(),
        }
    }

    /// J_1 with the belt that moves with it (kg m^2).
    pub fn motor_inertia(&self) -> R {
        self.motor_inertia
    }

    /// z_1/z_2, angle of the output over that of the motor.
    pub fn ratio(&self) -> R {
        self.radius[0] * self.inverse_output_radius
    }

    /// Both spans.
    pub fn chain(&self) -> &Chain<R, N> {
        &self.chain
    }

    /// Motion of the belt on both pulleys for a motion of both.
    pub fn ends(&self, motor: &Motion<R>, output: &Motion<R>) -> BeltEnds<R> {
        self.travel(motor, output).ends
    }

    /// Torsion phi for a motion of both (rad).
    pub fn torsion(&self, motor: &Motion<R>, output: &Motion<R>) -> R {
        self.ends(motor, output).travel * self.inverse_output_radius
    }

    fn travel(&self, motor: &Motion<R>, output: &Motion<R>) -> Travel<R> {
        let (driving, driven) = (self.pitch_error.motor(motor.angle), self.pitch_error.output(output.angle));
        let teeth = in_teeth(motor.angle, self.teeth[0]).minus(in_teeth(output.angle, self.teeth[1]));
        let slope = [self.radius[0] + driving.slope, self.radius[1] + driven.slope];
        let ends = BeltEnds {
            travel: teeth * self.metres_per_radian + (driving.error - driven.error),
            motor_speed: slope[0] * motor.velocity,
            output_speed: slope[1] * output.velocity,
        };
        Travel { ends, slope }
    }

    /// Advances the memories by dt for the motion of both pulleys, and answers with the torques.
    pub fn torques(
        &self,
        state: &mut BeltState<R, C::State, N>,
        motor: &Motion<R>,
        output: &Motion<R>,
        applied: Applied<R>,
    ) -> BeltTorques<R> {
        let (motor, output) = (limited(motor), limited(output));
        let Travel { ends, slope } = self.travel(&motor, &output);
        let BeltReaction { forward, backward, loss } = self.chain.step(&mut state.chain, &ends);
        let reflected = slope[0] * (forward.motor - backward.motor);
        let transmitted = slope[1] * (forward.output - backward.output);
        let heading = motor.angle.heading();
        let slip = |velocity| Slip { wave_generator: heading, ..Slip::over(velocity, self.dt) };
        let at_motor = slip(motor.velocity).under(applied.motor - reflected, reflected);
        let at_output = slip(output.velocity).under(applied.load + transmitted, transmitted);
        let motor_friction = self.motor_friction.step(&mut state.motor_friction, &at_motor).force;
        let output_friction = self.output_friction.step(&mut state.output_friction, &at_output).force;
        BeltTorques {
            torsion: ends.travel * self.inverse_output_radius,
            transmitted,
            forward: forward.output,
            backward: backward.output,
            motor_friction,
            output_friction,
            motor: motor_friction + reflected,
            damping_loss: loss,
            slack: forward.slack || backward.slack,
        }
    }

    /// Acceleration of the output (rad/s^2).
    pub fn output_acceleration(&self, torques: &BeltTorques<R>, load: R) -> R {
        (torques.transmitted - torques.output_friction + load) * self.inverse_output_inertia
    }

    /// The two-port: moves the output by one dt under `load` (N m), the motor as prescribed. Speeds and loads beyond 1e6, and what
    /// is not finite, count as a number within.
    pub fn step(
        &self,
        state: &mut BeltState<R, C::State, N>,
        output: &mut Motion<R>,
        motor: &Motion<R>,
        load: R,
    ) -> BeltTorques<R> {
        let load = load.finite_or(R::ZERO).limit(R::lit(LIMIT));
        let torques = self.torques(state, motor, output, Applied { motor: R::ZERO, load });
        *output = limited(output);
        output.advance(self.output_acceleration(&torques, load), self.dt.seconds());
        torques
    }

    /// Energy stored in the spans, stretch and motion (J).
    pub fn span_energy(&self, state: &BeltState<R, C::State, N>, motor: &Motion<R>, output: &Motion<R>) -> R {
        self.chain.energy(&state.chain, &self.ends(motor, output))
    }
}

/// An angle of a pulley in teeth that have passed, a revolution each.
fn in_teeth<R: Real>(angle: Angle<R>, teeth: i32) -> Angle<R> {
    Angle { counts: angle.counts.wrapping_mul(i64::from(teeth)), rest: angle.rest * R::from_i32(teeth) }
}

/// With a finite speed within the limits, and a fraction of a count that is one.
fn limited<R: Real>(motion: &Motion<R>) -> Motion<R> {
    let rest = motion.angle.rest.finite_or(R::ZERO).limit(R::ONE);
    Motion {
        angle: Angle { rest, ..motion.angle },
        velocity: motion.velocity.finite_or(R::ZERO).limit(R::lit(LIMIT)),
    }
}

#[cfg(test)]
mod tests;
