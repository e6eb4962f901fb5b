//! What is measured on the flexspline of a run, strains and the forces on its ends, and the flexsplines that have it.
//!
//! A gauge is a link of the mesh: node (i, j), i of n counted from the zero angle of the flexspline, j of m from the
//! rim, and how far the link reaches around and along. It turns with the flexspline. Strain L/L0 - 1, positive when
//! longer than in the round, unloaded cup.

use std::fmt;
use std::str::FromStr;

use strainwave::flexspline::cup::DIRECTIONS;
use strainwave::flexspline::reduced::{Direction, Node};
use strainwave::flexspline::{Ends, Flexspline, Mesh, NodeForce, Reaction, Reduced, Strained};
use strainwave::{Angle, Error, Real};

use crate::plant::vectorised::Vectorised;

/// A strain gauge along one link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gauge {
    /// (i, j).
    pub node: Node,
    /// (around, along), one of the 16.
    pub direction: Direction,
}

impl Gauge {
    /// The name of its column: `strain_I_J_AROUND_ALONG`.
    pub fn column(&self) -> String {
        format!("strain_{}", self.to_string().replace(',', "_"))
    }

    /// # Errors
    /// One line that names what an n x m mesh does not have, and what it has.
    pub fn require_on(&self, (n, m): (usize, usize)) -> Result<(), String> {
        let ((i, j), (_, along)) = (self.node, self.direction);
        let within = |name: &str, value: i64, count: usize| {
            if (0..count as i64).contains(&value) {
                Ok(())
            } else {
                let most = count - 1;
                Err(format!("{name} = {value} is out of range; allowed: 0 to {most} on the {n}x{m} mesh"))
            }
        };
        within("i", i as i64, n)?;
        within("j", j as i64, m)?;
        within("j + along", j as i64 + i64::from(along), m)
    }
}

impl fmt::Display for Gauge {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((i, j), (around, along)) = (self.node, self.direction);
        write!(formatter, "{i},{j},{around},{along}")
    }
}

impl FromStr for Gauge {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<i32>> = text.split(',').map(|part| part.parse().ok()).collect();
        let Some(&[i, j, around, along]) = numbers.as_deref() else {
            return Err("not I,J,AROUND,ALONG; allowed: four whole numbers".into());
        };
        let node = |name: &str, value: i32| {
            usize::try_from(value)
                .map_err(|_| format!("{name} = {value} is out of range; allowed: 0 or more"))
        };
        let node = (node("I", i)?, node("J", j)?);
        let linked = DIRECTIONS.iter().map(|(a, s)| (*a, *s as i32));
        if !linked.clone().any(|(a, s)| (a, s) == (around, along) || (-a, -s) == (around, along)) {
            let allowed: Vec<_> = linked.map(|(around, along)| format!("{around},{along}")).collect();
            let allowed = allowed.join(" ");
            return Err(format!(
                "direction {around},{along} is out of range; allowed, either way: {allowed}"
            ));
        }
        Ok(Self { node, direction: (around, along) })
    }
}

/// Forces on the nodes 0..n of the rim, then of the flange, as [`Mesh::end_forces`] has them.
pub type EndForces<R> = [Vec<NodeForce<R>>; 2];

/// A flexspline that strain gauges can be put on.
pub trait Gauged<R: Real>: Flexspline<R> {
    /// At rest like [`Flexspline::rest`], but with the wave generator at an angle.
    fn rest_at(&self, wave_generator: Angle<R>) -> Self::State;

    /// Strain at a gauge while the ends are there.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a gauge that is not on its mesh, see [`Gauge::require_on`].
    fn strain(&self, state: &Self::State, ends: &Ends<R>, gauge: &Gauge) -> Result<R, Error>;

    /// Forces that hold rim and flange while the ends are there; `None` of a flexspline without nodes.
    fn end_forces(&self, state: &Self::State, ends: &Ends<R>) -> Option<EndForces<R>>;
}

impl<R: Real, const N: usize, const M: usize> Gauged<R> for Vectorised<Mesh<R, N, M>> {
    fn rest_at(&self, wave_generator: Angle<R>) -> Self::State {
        self.model().rest_at(wave_generator)
    }

    fn strain(&self, state: &Self::State, ends: &Ends<R>, gauge: &Gauge) -> Result<R, Error> {
        let mesh = self.model();
        mesh.shell().strain(mesh.placed(state, ends).shell(), gauge.node, gauge.direction)
    }

    fn end_forces(&self, state: &Self::State, ends: &Ends<R>) -> Option<EndForces<R>> {
        let mesh = self.model();
        Some(mesh.end_forces(&mesh.placed(state, ends)).map(|end| end.to_vec()))
    }
}

impl<R: Real, const N: usize, const M: usize> Gauged<R> for Reduced<R, N, M> {
    fn rest_at(&self, _wave_generator: Angle<R>) -> Self::State {}

    fn strain(&self, _state: &Self::State, ends: &Ends<R>, gauge: &Gauge) -> Result<R, Error> {
        let torque = self.torque(ends.drive.minus(ends.flange), ends.drive_rate - ends.flange_rate);
        let wave_generator = ends.wave_generator.less(ends.flange);
        Reduced::strain(self, gauge.node, gauge.direction, torque, wave_generator)
    }

    fn end_forces(&self, _state: &Self::State, _ends: &Ends<R>) -> Option<EndForces<R>> {
        None
    }
}

/// A flexspline whose wave generator is counted from an angle of its own.
#[derive(Clone, Debug)]
pub struct Turned<R, F> {
    /// The flexspline.
    pub model: F,
    /// The angle, as counted, at which the wave generator's major axis stands over the flexspline's zero.
    pub zero: Angle<R>,
}

impl<R: Real, F> Turned<R, F> {
    fn turned(&self, ends: &Ends<R>) -> Ends<R> {
        Ends { wave_generator: ends.wave_generator.less(self.zero), ..*ends }
    }
}

impl<R: Real, F: Gauged<R>> Turned<R, F> {
    /// As [`Gauged::strain`].
    ///
    /// # Errors
    /// As [`Gauged::strain`].
    pub fn strain(&self, state: &F::State, ends: &Ends<R>, gauge: &Gauge) -> Result<R, Error> {
        self.model.strain(state, &self.turned(ends), gauge)
    }

    /// As [`Gauged::end_forces`].
    pub fn end_forces(&self, state: &F::State, ends: &Ends<R>) -> Option<EndForces<R>> {
        self.model.end_forces(state, &self.turned(ends))
    }
}

impl<R: Real, F: Gauged<R>> Flexspline<R> for Turned<R, F> {
    type State = F::State;

    fn rest(&self) -> Self::State {
        self.model.rest_at(Angle::default().less(self.zero))
    }

    fn step(&self, state: &mut Self::State, ends: &Ends<R>) -> Reaction<R> {
        self.model.step(state, &self.turned(ends))
    }

    fn energy(&self, state: &Self::State, ends: &Ends<R>) -> R {
        self.model.energy(state, &self.turned(ends))
    }

    fn largest_strain(&self, state: &Self::State) -> Option<Strained<R>> {
        self.model.largest_strain(state)
    }
}
