//! The gear's block by name: order 1 and order 2.

use super::params::{JointFrictionParams, Order};
use super::{BlimanSorine, JointFriction};
use crate::error::Error;
use crate::friction::FrictionParams;
use crate::friction::data::{CURVE, FrictionData, PRESLIDING};
use crate::friction::load_dependence::LoadFactors;
use crate::friction::lubricated_contact::LubricatedContactParams;
use crate::friction::registered::{ClosedMotionTest, ForceOverPath, Registered, Standstill};
use crate::friction::ripple::{Harmonics, RippleParams};
use crate::real::Real;

/// eta of the block whose closed motions are tested.
const ETA: f64 = 0.3;

/// Parameters of order `P`, 1 or 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFrictionOfOrder<R, const P: usize>(pub JointFrictionParams<R>);

impl<R: Real, const P: usize> JointFrictionOfOrder<R, P> {
    const ORDER: Order = if P == 1 { Order::One } else { Order::Two };

    /// A block whose level moves with speed, direction, load and angle, of a greatest `level` (N m) without them and a presliding
    /// `distance` (rad).
    pub fn varying(level: f64, distance: f64) -> Self {
        let lit = R::lit;
        let contact = LubricatedContactParams {
            coulomb: lit(level / 1.5),
            static_level: lit(level),
            stribeck_velocity: lit(0.1),
            stribeck_exponent: R::ONE,
            viscous: R::ZERO,
        };
        let harmonics = Harmonics { mean: R::ONE, cosines: [lit(0.3), lit(-0.1)], sines: [lit(0.2); 2] };
        Self(JointFrictionParams {
            backward: LubricatedContactParams { coulomb: lit(level), ..contact },
            load: LoadFactors { driving: lit(0.2), driven: lit(0.4) },
            ripple: RippleParams { forward: harmonics, ..RippleParams::NONE },
            ..JointFrictionParams::symmetric(Self::ORDER, contact, lit(distance), lit(ETA))
        })
    }
}

impl<R: Real, const P: usize> FrictionParams<R> for JointFrictionOfOrder<R, P> {
    type Model = JointFriction<R>;

    /// # Errors
    /// As [`JointFrictionParams`].
    fn build(&self) -> Result<JointFriction<R>, Error> {
        self.0.build()
    }
}

impl<R: Real, const P: usize> Registered<R> for JointFrictionOfOrder<R, P> {
    const NEEDS: &'static [&'static [&'static str]] = match Self::ORDER {
        Order::One => &[CURVE, PRESLIDING],
        Order::Two => &[CURVE, PRESLIDING, &["presliding_ratio"]],
    };
    const MAY_HAVE: &'static [&'static str] =
        &["load_driving", "load_driven", "ripple_cosines", "ripple_sines", "backward"];
    const STANDSTILL: Standstill = Standstill::Presliding;
    const STICK_SLIP: bool = true;

    fn of_data(data: &FrictionData<R>) -> Self {
        let [forward, backward] = [&data.forward, &data.backward].map(LubricatedContactParams::of_sliding);
        Self(JointFrictionParams {
            order: Self::ORDER,
            forward,
            backward,
            presliding: data.presliding,
            // Order 1 does without, and the firmware's source has no literal for none.
            presliding_ratio: match Self::ORDER {
                Order::One => data.presliding_ratio.finite_or(R::ZERO),
                Order::Two => data.presliding_ratio,
            },
            load: data.load,
            ripple: RippleParams { forward: data.forward.ripple, backward: data.backward.ripple },
        })
    }

    /// The block, and for order 2 its presliding alone.
    fn closed_motions(level: f64, distance: f64, test: &mut impl ClosedMotionTest<R>) {
        test.run(Self::varying(level, distance).build(), ForceOverPath::Smooth);
        if Self::ORDER == Order::Two {
            let [f1, f2, eps, eta] = [1.5 * level, 0.5 * level, distance, ETA].map(R::lit);
            test.run(BlimanSorine::order_2(f1, f2, eps, eta), ForceOverPath::Smooth);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::tests::{Extremes, contact};
    use std::vec;
    use std::vec::Vec;

    impl<R: Real, const P: usize> Extremes<R> for JointFrictionOfOrder<R, P> {
        fn extremes() -> Vec<Self> {
            let lit = R::lit;
            let contact = LubricatedContactParams { stribeck_exponent: lit(2.0), ..contact() };
            let harmonics = Harmonics { mean: R::ONE, cosines: [lit(0.3); 2], sines: [lit(0.1); 2] };
            vec![Self(JointFrictionParams {
                load: LoadFactors { driving: lit(10.0), driven: lit(0.1) },
                ripple: RippleParams { forward: harmonics, backward: harmonics },
                ..JointFrictionParams::symmetric(Self::ORDER, contact, lit(1e-9), lit(0.01))
            })]
        }
    }
}
