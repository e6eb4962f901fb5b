//! From one side of a gear file to the parameters of its friction model.
//!
//! A number that the file does not have is none: the model that needs it refuses to be built, by name.

use std::array::from_fn;

use strainwave::Real;
use strainwave::friction::data::{Sliding, StateMatrices};
use strainwave::friction::{
    AnyFrictionParams, FrictionData, Harmonics, JointFrictionOfOrder, JointFrictionParams, LoadFactors,
    RIPPLE_ORDERS,
};

use super::friction::{Friction, StateRow};

/// The parameters of the side's model.
pub fn friction_params<R: Real>(side: &Friction) -> AnyFrictionParams<R> {
    AnyFrictionParams::of_data(side.model, &data(side))
}

/// The parameters of the firmware's block; `None` when the side's model is another one.
pub fn joint_friction_params<R: Real>(side: &Friction) -> Option<JointFrictionParams<R>> {
    match friction_params(side) {
        AnyFrictionParams::BlimanSorine1(JointFrictionOfOrder(params))
        | AnyFrictionParams::BlimanSorine2(JointFrictionOfOrder(params)) => Some(params),
        _ => None,
    }
}

fn data<R: Real>(side: &Friction) -> FrictionData<R> {
    let unknown = FrictionData::unknown();
    FrictionData {
        forward: sliding(side),
        backward: sliding(&side.backwards()),
        presliding: number(side.presliding),
        presliding_ratio: number(side.presliding_ratio),
        dead_band: number(side.dead_band),
        frictional_memory: number(side.frictional_memory),
        dwell: number(side.dwell),
        dahl_exponent: optional(side.dahl_exponent.map(f64::from), unknown.dahl_exponent),
        micro_damping: optional(side.micro_damping, unknown.micro_damping),
        load: LoadFactors {
            driving: optional(side.load_driving, unknown.load.driving),
            driven: optional(side.load_driven, unknown.load.driven),
        },
        state_space: matrices(side.state_space.as_deref().unwrap_or_default()),
    }
}

fn number<R: Real>(number: Option<f64>) -> R {
    R::lit(number.unwrap_or(f64::NAN))
}

/// A number that the model does without.
fn optional<R: Real>(number: Option<f64>, default: R) -> R {
    number.map_or(default, R::lit)
}

fn sliding<R: Real>(side: &Friction) -> Sliding<R> {
    Sliding {
        coulomb: number(side.coulomb),
        static_level: number(side.static_level),
        stribeck_velocity: number(side.stribeck_velocity),
        stribeck_exponent: number(side.stribeck_exponent.map(f64::from)),
        viscous: number(side.viscous),
        ripple: harmonics(side),
    }
}

/// Of a mean of 1; orders that the file does not have are 0.
fn harmonics<R: Real>(side: &Friction) -> Harmonics<R, RIPPLE_ORDERS> {
    let coefficients = |list: &Option<Vec<f64>>| {
        let list = list.as_deref().unwrap_or_default();
        from_fn(|k| optional(list.get(k).copied(), R::ZERO))
    };
    Harmonics {
        mean: R::ONE,
        cosines: coefficients(&side.ripple_cosines),
        sines: coefficients(&side.ripple_sines),
    }
}

/// Matrices of a row for each state; a row of another length has no number.
fn matrices<R: Real>(rows: &[StateRow]) -> StateMatrices<R> {
    let row = |i: usize| rows.get(i).filter(|row| row.a.len() == rows.len());
    StateMatrices {
        order: rows.len(),
        a: from_fn(|i| from_fn(|j| number(row(i).and_then(|row| row.a.get(j).copied())))),
        b: from_fn(|i| number(row(i).map(|row| row.b))),
        c: from_fn(|i| number(row(i).map(|row| row.c))),
    }
}
