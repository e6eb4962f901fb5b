//! From one side of a gear file to the parameters of its friction model.
//!
//! A number that the file does not have is none: the model that needs it refuses to be built, by name.

use std::array::from_fn;

use strainwave::Real;
use strainwave::friction::{
    ArmstrongParams, BristleParams, CoulombParams, DahlParams, Harmonics, JointFrictionParams, KarnoppParams,
    LoadFactors, LuGreParams, LubricatedContactParams, Order, RIPPLE_ORDERS, ResetIntegratorParams,
    RippleParams, StateSpaceParams, StaticParams, StribeckParams, ViscousParams,
};

use crate::io::gear_file::any_friction::AnyFrictionParams;
use crate::io::gear_file::friction::{Friction, FrictionModel, StateRow};

fn needed<R: Real>(number: Option<f64>) -> R {
    R::lit(number.unwrap_or(f64::NAN))
}

/// A number that the model does without.
fn optional<R: Real>(number: Option<f64>, default: f64) -> R {
    R::lit(number.unwrap_or(default))
}

/// The parameters of the side's model.
pub fn friction_params<R: Real>(side: &Friction) -> AnyFrictionParams<R> {
    let (coulomb, static_level, viscous) =
        (needed(side.coulomb), needed(side.static_level), needed(side.viscous));
    let (presliding, damping) = (needed(side.presliding), optional(side.micro_damping, 0.0));
    match side.model {
        FrictionModel::Coulomb => AnyFrictionParams::Coulomb(CoulombParams { coulomb }),
        FrictionModel::Viscous => AnyFrictionParams::Viscous(ViscousParams { viscous }),
        FrictionModel::Static => AnyFrictionParams::Static(StaticParams { coulomb, static_level }),
        FrictionModel::Stribeck => AnyFrictionParams::Stribeck(StribeckParams { contact: contact(side) }),
        FrictionModel::LubricatedContact => AnyFrictionParams::LubricatedContact(contact(side)),
        FrictionModel::Karnopp => {
            let dead_band = needed(side.dead_band);
            AnyFrictionParams::Karnopp(KarnoppParams { contact: contact(side), dead_band })
        }
        FrictionModel::Armstrong => AnyFrictionParams::Armstrong(ArmstrongParams {
            stiffness: static_level / presliding,
            coulomb,
            viscous,
            stribeck: static_level - coulomb,
            stribeck_velocity: needed(side.stribeck_velocity),
            memory: needed(side.frictional_memory),
            dwell: needed(side.dwell),
        }),
        FrictionModel::Dahl => AnyFrictionParams::Dahl(DahlParams {
            coulomb,
            stiffness: coulomb / presliding,
            exponent: optional(side.dahl_exponent.map(f64::from), 1.0),
        }),
        FrictionModel::Bristle => {
            AnyFrictionParams::Bristle(BristleParams::of_level(coulomb, presliding + presliding))
        }
        FrictionModel::ResetIntegrator => AnyFrictionParams::ResetIntegrator(ResetIntegratorParams {
            stiffness: coulomb / presliding,
            stick_gain: static_level / coulomb - R::ONE,
            damping,
            reach: presliding,
        }),
        FrictionModel::BlimanSorine1 => AnyFrictionParams::Joint(joint(side, Order::One)),
        FrictionModel::BlimanSorine2 => AnyFrictionParams::Joint(joint(side, Order::Two)),
        FrictionModel::LuGre => {
            let stiffness = static_level / presliding;
            AnyFrictionParams::LuGre(LuGreParams { contact: contact(side), stiffness, damping })
        }
        FrictionModel::StateSpace => state_space(side.state_space.as_deref().unwrap_or_default()),
    }
}

/// The parameters of the firmware's block; `None` when the side's model is another one.
pub fn joint_friction_params<R: Real>(side: &Friction) -> Option<JointFrictionParams<R>> {
    match friction_params(side) {
        AnyFrictionParams::Joint(params) => Some(params),
        _ => None,
    }
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

fn state_space<R: Real>(rows: &[StateRow]) -> AnyFrictionParams<R> {
    match rows.len() {
        1 => AnyFrictionParams::StateSpace1(matrices(rows)),
        2 => AnyFrictionParams::StateSpace2(matrices(rows)),
        3 => AnyFrictionParams::StateSpace3(matrices(rows)),
        4 => AnyFrictionParams::StateSpace4(matrices(rows)),
        _ => AnyFrictionParams::StateSpace1(matrices(&[])),
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
