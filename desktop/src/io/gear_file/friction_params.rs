//! From one side of a gear file to the parameters of its friction model.
//!
//! A number that the file does not have is none: the model that needs it refuses to be built, by name.

use std::array::from_fn;

// Every model: a row of the registry names one.
use strainwave::friction::*;
use strainwave::{Error, Real};

use super::any_friction::any_model;
use super::friction::{BRISTLES, Friction, FrictionModel, StateRow};
use super::friction_models::friction_models;

fn needed<R: Real>(number: Option<f64>) -> R {
    R::lit(number.unwrap_or(f64::NAN))
}

/// A number that the model does without.
fn optional<R: Real>(number: Option<f64>, default: f64) -> R {
    R::lit(number.unwrap_or(default))
}

macro_rules! any_friction {
    ($($(#[$doc:meta])* $name:ident = $word:literal needs $needs:expr, $params:ty => $model:ty, |$side:ident| $of:expr;)*) => {
        any_model! { AnyFrictionParams AnyFriction AnyFrictionState: $($name: $params => $model,)* }

        /// The parameters of the side's model.
        pub fn friction_params<R: Real>(side: &Friction) -> AnyFrictionParams<R> {
            match side.model {
                $(FrictionModel::$name => {
                    let $side = side;
                    AnyFrictionParams::$name($of)
                })*
            }
        }
    };
}

friction_models!(any_friction);

any_model! {
    AnyStateSpaceParams AnyStateSpace AnyStateSpaceState:
    Order1: StateSpaceParams<R, 1> => StateSpace<R, 1>,
    Order2: StateSpaceParams<R, 2> => StateSpace<R, 2>,
    Order3: StateSpaceParams<R, 3> => StateSpace<R, 3>,
    Order4: StateSpaceParams<R, 4> => StateSpace<R, 4>,
}

/// The parameters of the firmware's block; `None` when the side's model is another one.
pub fn joint_friction_params<R: Real>(side: &Friction) -> Option<JointFrictionParams<R>> {
    match friction_params(side) {
        AnyFrictionParams::BlimanSorine1(params) | AnyFrictionParams::BlimanSorine2(params) => Some(params),
        _ => None,
    }
}

fn stiction<R: Real>(side: &Friction) -> StaticParams<R> {
    StaticParams { coulomb: needed(side.coulomb), static_level: needed(side.static_level) }
}

fn karnopp<R: Real>(side: &Friction) -> KarnoppParams<R> {
    KarnoppParams { contact: contact(side), dead_band: needed(side.dead_band) }
}

fn armstrong<R: Real>(side: &Friction) -> ArmstrongParams<R> {
    let (coulomb, static_level): (R, R) = (needed(side.coulomb), needed(side.static_level));
    ArmstrongParams {
        stiffness: static_level / needed(side.presliding),
        coulomb,
        viscous: needed(side.viscous),
        stribeck: static_level - coulomb,
        stribeck_velocity: needed(side.stribeck_velocity),
        memory: needed(side.frictional_memory),
        dwell: needed(side.dwell),
    }
}

fn dahl<R: Real>(side: &Friction) -> DahlParams<R> {
    let coulomb: R = needed(side.coulomb);
    DahlParams {
        coulomb,
        stiffness: coulomb / needed(side.presliding),
        exponent: optional(side.dahl_exponent.map(f64::from), 1.0),
    }
}

fn bristle<R: Real>(side: &Friction) -> BristleParams<R, BRISTLES> {
    let presliding: R = needed(side.presliding);
    BristleParams::of_level(needed(side.coulomb), presliding + presliding)
}

fn reset_integrator<R: Real>(side: &Friction) -> ResetIntegratorParams<R> {
    let (coulomb, static_level): (R, R) = (needed(side.coulomb), needed(side.static_level));
    let presliding = needed(side.presliding);
    ResetIntegratorParams {
        stiffness: coulomb / presliding,
        stick_gain: static_level / coulomb - R::ONE,
        damping: optional(side.micro_damping, 0.0),
        reach: presliding,
    }
}

fn lugre<R: Real>(side: &Friction) -> LuGreParams<R> {
    let static_level: R = needed(side.static_level);
    let stiffness = static_level / needed(side.presliding);
    LuGreParams { contact: contact(side), stiffness, damping: optional(side.micro_damping, 0.0) }
}

fn contact<R: Real>(side: &Friction) -> LubricatedContactParams<R> {
    LubricatedContactParams {
        coulomb: needed(side.coulomb),
        static_level: needed(side.static_level),
        stribeck_velocity: needed(side.stribeck_velocity),
        stribeck_exponent: needed(side.stribeck_exponent.map(f64::from)),
        viscous: needed(side.viscous),
    }
}

fn joint<R: Real>(side: &Friction, order: Order) -> JointFrictionParams<R> {
    let backwards = side.backwards();
    JointFrictionParams {
        order,
        forward: contact(side),
        backward: contact(&backwards),
        presliding: needed(side.presliding),
        // Order 1 does without, and the firmware's source has no literal for none.
        presliding_ratio: match order {
            Order::One => optional(side.presliding_ratio, 0.0),
            Order::Two => needed(side.presliding_ratio),
        },
        load: LoadFactors {
            driving: optional(side.load_driving, 0.0),
            driven: optional(side.load_driven, 0.0),
        },
        ripple: RippleParams { forward: harmonics(side), backward: harmonics(&backwards) },
    }
}

/// Of a mean of 1; orders that the file does not have are 0.
fn harmonics<R: Real>(side: &Friction) -> Harmonics<R, RIPPLE_ORDERS> {
    let shares = |list: &Option<Vec<f64>>| {
        let list = list.as_deref().unwrap_or_default();
        from_fn(|k| optional(list.get(k).copied(), 0.0))
    };
    Harmonics { mean: R::ONE, cosines: shares(&side.ripple_cosines), sines: shares(&side.ripple_sines) }
}

fn state_space<R: Real>(side: &Friction) -> AnyStateSpaceParams<R> {
    let rows = side.state_space.as_deref().unwrap_or_default();
    match rows.len() {
        1 => AnyStateSpaceParams::Order1(matrices(rows)),
        2 => AnyStateSpaceParams::Order2(matrices(rows)),
        3 => AnyStateSpaceParams::Order3(matrices(rows)),
        4 => AnyStateSpaceParams::Order4(matrices(rows)),
        _ => AnyStateSpaceParams::Order1(matrices(&[])),
    }
}

/// Matrices of P rows of P numbers; none for any other shape.
fn matrices<R: Real, const P: usize>(rows: &[StateRow]) -> StateSpaceParams<R, P> {
    let row = |i: usize| rows.get(i).filter(|row| row.a.len() == P);
    StateSpaceParams {
        a: from_fn(|i| from_fn(|j| needed(row(i).map(|row| row.a[j])))),
        b: from_fn(|i| needed(row(i).map(|row| row.b))),
        c: from_fn(|i| needed(row(i).map(|row| row.c))),
    }
}
