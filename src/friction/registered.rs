//! Entry of a friction model in the registry: what its file tells about it.

use super::data::FrictionData;
use super::{FrictionModel, FrictionParams};
use crate::error::Error;
use crate::real::Real;

/// Parameters of a model that is chosen by name.
pub trait Registered<R: Real>: FrictionParams<R> + Sized {
    /// Names of the data without which it cannot be built, in groups; [`super::data`] has all names.
    const NEEDS: &'static [&'static [&'static str]];
    /// Names of the data that it reads where they are known.
    const MAY_HAVE: &'static [&'static str] = &[];
    /// Friction of a contact that stands still.
    const STANDSTILL: Standstill;
    /// Friction falls with speed, or with the way after break-away: a body that a spring draws sticks and slips.
    const STICK_SLIP: bool;

    /// Parameters of a contact with these data.
    fn of_data(data: &FrictionData<R>) -> Self;

    /// Runs a test of closed motions with the forms of the model that lose work over any of them, of a `level` (N) and a presliding
    /// `distance` (m). Asked of models with presliding only; one that may give work overrides it and says why.
    fn closed_motions(level: f64, distance: f64, test: &mut impl ClosedMotionTest<R>) {
        test.run(Self::of_data(&FrictionData::falling(level, distance)).build(), ForceOverPath::Smooth);
    }
}

/// Friction of a contact that stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standstill {
    /// There is none.
    Free,
    /// At v = 0 the force jumps between the levels of both directions.
    Jump,
    /// The contact holds against the applied force, up to the static level.
    Static,
    /// The contact yields elastically and remembers its deflection.
    Presliding,
}

/// Shape of the force over the path from one reversal to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceOverPath {
    /// Every derivative exists.
    Smooth,
    /// Straight between places that are eighths of the presliding distance apart.
    Straight,
}

/// Test of the work over closed motions.
pub trait ClosedMotionTest<R: Real> {
    /// Runs with a model, and its force over the path.
    fn run<M: FrictionModel<R>>(&mut self, model: Result<M, Error>, force: ForceOverPath);
}
