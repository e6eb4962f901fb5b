//! Eq. (8) with general A, B, C, its order known when a program runs.

use super::any_model::any_model;
use super::data::{FrictionData, MOST_STATES, StateMatrices};
use super::registered::{ClosedMotionTest, ForceOverPath, Registered, Standstill};
use super::state_space::StateSpaceParams;
use super::{Error, FrictionParams, Real};

any_model! {
    AnyStateSpaceParams AnyStateSpace AnyStateSpaceState:
    Order1: StateSpaceParams<R, 1>,
    Order2: StateSpaceParams<R, 2>,
    Order3: StateSpaceParams<R, 3>,
    Order4: StateSpaceParams<R, 4>,
}

impl<R: Real> Registered<R> for AnyStateSpaceParams<R> {
    const NEEDS: &'static [&'static [&'static str]] = &[&["state_space"]];
    const STANDSTILL: Standstill = Standstill::Presliding;
    const STICK_SLIP: bool = false;

    fn of_data(data: &FrictionData<R>) -> Self {
        let matrices = &data.state_space;
        match matrices.order {
            1 => Self::Order1(leading(matrices)),
            2 => Self::Order2(leading(matrices)),
            3 => Self::Order3(leading(matrices)),
            MOST_STATES => Self::Order4(leading(matrices)),
            _ => Self::Order1(leading(&StateMatrices::unknown())),
        }
    }

    /// Complex modes, a quarter of the distance long.
    fn closed_motions(level: f64, distance: f64, test: &mut impl ClosedMotionTest<R>) {
        let rate = 1.0 / distance;
        let [a, b, c, d] = [-rate, 4.0 * rate, -4.0 * rate, -2.0 * rate].map(R::lit);
        let params = StateSpaceParams {
            a: [[a, b], [c, d]],
            b: [rate, 0.5 * rate].map(R::lit),
            c: [4.5 * level, 2.25 * level].map(R::lit),
        };
        test.run(params.build(), ForceOverPath::Smooth);
    }
}

/// The leading `P` rows and columns.
fn leading<R: Real, const P: usize>(matrices: &StateMatrices<R>) -> StateSpaceParams<R, P> {
    use core::array::from_fn;
    StateSpaceParams {
        a: from_fn(|i| from_fn(|j| matrices.a[i][j])),
        b: from_fn(|i| matrices.b[i]),
        c: from_fn(|i| matrices.c[i]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::Extremes;
    use std::vec::Vec;

    impl<R: Real> Extremes<R> for AnyStateSpaceParams<R> {
        fn extremes() -> Vec<Self> {
            let [a, b, c, d] = [-1e9, 4e11, -4e11, -2e9].map(R::lit);
            let params = StateSpaceParams {
                a: [[a, b], [c, d]],
                b: [1e9, 0.5e9].map(R::lit),
                c: [1.0, 0.5].map(R::lit),
            };
            std::vec![Self::Order2(params)]
        }
    }
}
