//! Friction of the gear (the paper's `gearFric`) and every model of the paper's Table 1: one file a model.
//!
//! Sign: a friction force has the sign of the velocity that it opposes, so that the equation of
//! motion subtracts it and `force * velocity` is the power lost. "Force" is N over m or N m over
//! rad; the equations are the same.
//!
//! All are one [`FrictionModel`]: built once, then stepped by a [`Slip`]. They lose work over any closed motion, but for
//! [`Karnopp`], whose dead band is not bound to oppose v, and [`LuGre`] with too much damping of its bristles.
//!
//! The registry, which opens this file, names the models that a program may choose when it runs ([`any`]). All else about a
//! model is in its own file, as [`Registered`]: the data of a contact that it needs and how its parameters follow from them, its
//! friction at standstill, and the parameters at which the laws of all models are tested.

/// Hands the registry of the friction models to the macro `$then`: name, word in a gear file, parameters, and what it is.
macro_rules! friction_models {
    ($then:ident) => {
        $then! {
            Coulomb = "coulomb", CoulombParams<R>, "One level.";
            Viscous = "viscous", ViscousParams<R>, "In proportion to the speed.";
            Static = "static", StaticParams<R>, "Holds at standstill, Coulomb's in motion.";
            Stribeck = "stribeck", StribeckParams<R>, "Holds at standstill, the lubricated contact's in motion.";
            Karnopp = "karnopp", KarnoppParams<R>, "A dead band of speed in which it holds.";
            Armstrong = "armstrong", ArmstrongParams<R>, "Presliding, Stribeck effect with memory, and dwell.";
            Dahl = "dahl", DahlParams<R>, "A spring that yields.";
            Bristle = "bristle", BristleParams<R, BRISTLES>, "Bonds that snap.";
            ResetIntegrator = "reset_integrator", ResetIntegratorParams<R>, "A bond that holds at its end.";
            BlimanSorine1 = "bliman_sorine_1", JointFrictionOfOrder<R, 1>, "The gear's block of order 1.";
            BlimanSorine2 = "bliman_sorine_2", JointFrictionOfOrder<R, 2>, "The gear's block of order 2.";
            LubricatedContact = "lubricated_contact", LubricatedContactParams<R>, "A level that falls with speed.";
            LuGre = "lugre", LuGreParams<R>, "The mean deflection of bristles.";
            StateSpace = "state_space", AnyStateSpaceParams<R>, "Eq. (8) with general A, B, C.";
        }
    };
}

pub mod any;
mod any_model;
pub mod any_state_space;
pub mod armstrong;
pub mod bliman_sorine;
pub mod bristle;
pub mod coulomb;
pub mod dahl;
pub mod data;
pub mod joint_friction;
pub mod karnopp;
pub mod load_dependence;
pub mod lubricated_contact;
pub mod lugre;
pub mod positive_real;
pub mod registered;
pub mod reset_integrator;
pub mod ripple;
pub mod state_space;
pub mod stiction;
pub mod stribeck;
pub mod viscous;

pub use any::{AnyFriction, AnyFrictionParams, AnyFrictionState, ModelName};
pub use any_state_space::{AnyStateSpace, AnyStateSpaceParams, AnyStateSpaceState};
pub use armstrong::{Armstrong, ArmstrongParams};
pub use bliman_sorine::BlimanSorine;
pub use bristle::{BRISTLES, Bristle, BristleParams};
pub use coulomb::{Coulomb, CoulombParams};
pub use dahl::{Dahl, DahlParams};
pub use data::FrictionData;
pub use joint_friction::{
    JointFriction, JointFrictionOfOrder, JointFrictionParams, JointFrictionState, Order,
};
pub use karnopp::{Karnopp, KarnoppParams};
pub use load_dependence::{LoadDependence, LoadDependenceParams, LoadFactors, LoadedLevel};
pub use lubricated_contact::{LubricatedContact, LubricatedContactParams};
pub use lugre::{LuGre, LuGreParams};
pub use registered::{ClosedMotionTest, ForceOverPath, Registered, Standstill};
pub use reset_integrator::{ResetIntegrator, ResetIntegratorParams};
pub use ripple::{Harmonics, RIPPLE_ORDERS, Ripple, RippleParams};
pub use state_space::{StateSpace, StateSpaceParams};
pub use stiction::{Static, StaticParams};
pub use stribeck::{Stribeck, StribeckParams};
pub use viscous::{Viscous, ViscousParams};

use crate::angle::Heading;
use crate::branch::seldom;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Greatest value of a level (N), (N m) or of a length (m), (rad).
const GREATEST: f64 = 1e6;
/// Smallest value of a parameter that divides.
const LEAST: f64 = 1e-9;
/// A finite velocity, applied force or load beyond this counts as this: products of it stay finite in f32.
const LIMIT: f64 = 1e9;

/// Time that a step takes (s), 0..=1: checked once, where it is made.
#[constants]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTime<R>(R);

impl<R: Real> StepTime<R> {
    /// `seconds` limited to 0..=1; NaN counts as 0.
    #[inline(always)]
    pub fn new(seconds: R) -> Self {
        Self(seconds.max(R::ZERO).min(R::ONE))
    }

    /// (s).
    #[inline(always)]
    pub fn seconds(self) -> R {
        self.0
    }
}

/// Motion and forces of a friction contact in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slip<R: Real> {
    /// v, constant over the step (m/s) or (rad/s).
    pub velocity: R,
    /// Time that the step takes.
    pub duration: StepTime<R>,
    /// F_e: all other forces on the body together (N) or (N m), in the sense of v. Only friction at
    /// standstill reads it.
    pub applied: R,
    /// Torque through the contact (N) or (N m), positive where the motor drives the load at v > 0. Only
    /// [`JointFriction`] reads it.
    pub load: R,
    /// Angle of the wave generator. Only [`JointFriction`] reads it.
    pub wave_generator: Heading<R>,
}

impl<R: Real> Slip<R> {
    /// A step of `duration` (s) at `velocity` (m/s) or (rad/s), nothing applied, without load, the wave
    /// generator at 0.
    pub fn new(velocity: R, duration: R) -> Self {
        Self::over(velocity, StepTime::new(duration))
    }

    /// The same, without the check.
    #[inline(always)]
    pub fn over(velocity: R, duration: StepTime<R>) -> Self {
        Self { velocity, duration, ..Self::default() }
    }

    /// The same with an applied force and a load (N) or (N m).
    #[inline(always)]
    pub fn under(self, applied: R, load: R) -> Self {
        Self { applied, load, ..self }
    }

    /// Displacement of the step, with its sign (m) or (rad).
    #[inline(always)]
    pub fn displacement(&self) -> R {
        self.velocity * self.duration.seconds()
    }

    /// The velocity, and the applied force and the load where they are read, are finite and together within the limit.
    #[inline(always)]
    fn is_usual(&self, [reads_applied, reads_load]: [bool; 2]) -> bool {
        let mut size = self.velocity.abs();
        if reads_applied {
            size += self.applied.abs();
        }
        if reads_load {
            size += self.load.abs();
        }
        // False for NaN, too.
        size <= R::lit(LIMIT)
    }

    /// `None` when anything is NaN or infinite.
    #[inline(always)]
    fn limited(&self) -> Option<Self> {
        let limit = R::lit(LIMIT);
        let numbers = [self.velocity, self.applied, self.load];
        numbers.iter().all(|number| number.is_finite()).then(|| Self {
            velocity: self.velocity.limit(limit),
            applied: self.applied.limit(limit),
            load: self.load.limit(limit),
            ..*self
        })
    }
}

/// Parameters of a friction model.
pub trait FrictionParams<R: Real> {
    /// The built model.
    type Model: FrictionModel<R> + 'static;

    /// Checks and precomputes.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the parameter.
    fn build(&self) -> Result<Self::Model, Error>;
}

/// A friction model, its parameters checked and built.
pub trait FrictionModel<R: Real> {
    /// State of the model; by default at rest, without tension.
    type State: Clone + Default + 'static;

    /// The model reads [`Slip::applied`]. What it does not read may be anything.
    const READS_APPLIED: bool = false;
    /// The model reads [`Slip::load`]. What it does not read may be anything.
    const READS_LOAD: bool = false;
    /// The force depends on the path alone, not on the speed.
    const RATE_INDEPENDENT: bool = false;

    /// Force after the last step (N) or (N m).
    fn force(&self, state: &Self::State) -> R;

    /// Moves `state` on by a step of finite input within the limits of [`Slip`].
    fn advance(&self, state: &mut Self::State, slip: &Slip<R>);

    /// Force at the end of the step, finite for any input bits. Input that is not finite leaves the state
    /// as it is: the force is that of the step before, which is reported.
    #[inline(always)]
    fn step(&self, state: &mut Self::State, slip: &Slip<R>) -> Friction<R> {
        if slip.is_usual([Self::READS_APPLIED, Self::READS_LOAD]) {
            self.advance(state, slip);
            return Friction { force: self.force(state), held: false };
        }
        seldom();
        let limited = slip.limited();
        if let Some(slip) = &limited {
            self.advance(state, slip);
        }
        Friction { force: self.force(state), held: limited.is_none() }
    }
}

/// State of a model without memory: the force that it would hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LastForce<R>(R);

/// Friction of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction<R> {
    /// Force (N) or torque (N m); finite for any input.
    pub force: R,
    /// The input was not finite: `force` is that of the step before and the state is untouched.
    pub held: bool,
}

/// `value` is in 0..=[`GREATEST`].
fn require_level<R: Real>(value: R, name: &'static str) -> Result<(), Error> {
    require((R::ZERO..=R::lit(GREATEST)).contains(&value), name)
}

/// `value` is in [`LEAST`]..=[`GREATEST`]: it may divide.
fn require_divisor<R: Real>(value: R, name: &'static str) -> Result<(), Error> {
    require((R::lit(LEAST)..=R::lit(GREATEST)).contains(&value), name)
}

#[cfg(test)]
mod tests;
