//! Eigenvalues of the chain, from its own steps, against closed forms.
//!
//! ```text
//! fixed ends:  w_j = 2*sqrt(k/m)*sin(j*pi/(2*(N + 1))),  j = 1..N
//! output's pulley:  w = 2*sqrt(k/m)*sin(q/2),  (M/m - 1)*tan(q/2)*tan((N + 1)*q) = 1
//! ```
//!
//! k and m are a link's stiffness and mass. Between fixed ends x_i = sin(i*q) with (N + 1)*q = j*pi. With the motor held and M the mass
//! that moves with the output, half-links included, both spans move alike or against each other. Against each other the pulley rests:
//! the modes are those of fixed ends. Alike, x_i = sin((N + 1 - i)*q), and the pulley's equation -M*w^2*x_0 = 2*k*(x_1 - x_0) is the
//! second line; its left side rises from 0 in every interval ((j - 1)*pi, (j - 1/2)*pi) of (N + 1)*q, so each has one root, found
//! by bisection.
//!
//! Measured: a step without damping from rest changes the speed of node i by dt*a_i; a displacement of one node at a time gives
//! the matrix of a over x, column by column, of which an eigenvalue solver gives -w^2.

use std::array::from_fn;
use std::f64::consts::PI;

use nalgebra::{DMatrix, SymmetricEigen};
use strainwave::belt::{Belt, BeltParams};
use strainwave::friction::{Viscous, ViscousParams};
use strainwave::gear::Motion;

use super::plain;
use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

/// Nodes of a span.
const NODES: usize = 16;
/// Displacement of a node or of the belt on the output's pulley (m): a tenth of the pretension, no link is slack.
const DISPLACEMENT: f64 = 1e-6;

pub(super) fn measure() -> Vec<Figure> {
    let system = System::new();
    let fixed = squares(system.symmetric(&system.columns()[..NODES], NODES));
    let with_pulley = squares(system.symmetric(&system.columns(), 2 * NODES + 1));
    // Against each other and alike.
    let mut expected = [system.fixed(), system.with_pulley()].concat();
    expected.sort_by(f64::total_cmp);
    vec![
        bounds::figure("belt.chain.fixed", difference(&fixed, &system.fixed())),
        bounds::figure("belt.chain.pulley", difference(&with_pulley, &expected)),
    ]
}

/// Largest relative error of w^2.
fn difference(measured: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(measured.len(), expected.len());
    largest(measured.iter().zip(expected).map(|(measured, expected)| measured / expected - 1.0))
}

/// -w^2 of a symmetric matrix as w^2, the lowest first.
fn squares(matrix: DMatrix<f64>) -> Vec<f64> {
    let mut squares: Vec<_> = SymmetricEigen::new(matrix).eigenvalues.iter().map(|value| -value).collect();
    squares.sort_by(f64::total_cmp);
    squares
}

/// The chain and the closed forms' constants.
struct System {
    belt: Belt<f64, Viscous<f64>, NODES>,
    params: BeltParams<f64, ViscousParams<f64>>,
    dt: f64,
}

impl System {
    fn new() -> Self {
        let params = plain(0.0, 0.0);
        let dt = 0.5 * params.stable_step(NODES);
        Self { belt: params.build(dt).expect("the example is in range"), params, dt }
    }

    /// k/m of a link.
    fn link(&self) -> f64 {
        let links = (NODES + 1) as f64;
        links * self.params.span.span_stiffness() / self.params.span.link_mass(NODES)
    }

    /// M/m.
    fn mass_ratio(&self) -> f64 {
        let radius = self.params.radius(&self.params.output);
        let mass = self.params.inertia(&self.params.output, NODES) / (radius * radius);
        mass / self.params.span.link_mass(NODES)
    }

    fn square_at(&self, q: f64) -> f64 {
        4.0 * self.link() * (0.5 * q).sin().powi(2)
    }

    fn fixed(&self) -> Vec<f64> {
        (1..=NODES).map(|j| self.square_at(j as f64 * PI / (NODES + 1) as f64)).collect()
    }

    fn with_pulley(&self) -> Vec<f64> {
        let (links, ratio) = ((NODES + 1) as f64, self.mass_ratio() - 1.0);
        let root = |j: usize| {
            let (mut low, mut high) = (j as f64 * PI / links, (j as f64 + 0.5) * PI / links);
            for _ in 0..100 {
                let middle = f64::midpoint(low, high);
                if ratio * (0.5 * middle).tan() * (links * middle).tan() < 1.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            self.square_at(low)
        };
        (0..=NODES).map(root).collect()
    }

    /// Accelerations over a displacement of each coordinate: the nodes of the forward and of the backward span, the belt on the
    /// output's pulley.
    fn columns(&self) -> Vec<Vec<f64>> {
        (0..=2 * NODES).map(|moved| self.column(moved)).collect()
    }

    fn column(&self, moved: usize) -> Vec<f64> {
        let shifted = |first: usize| from_fn(|i| if first + i == moved { DISPLACEMENT } else { 0.0 });
        let mut state = self.belt.rest();
        state.chain.forward.displacement = shifted(0);
        state.chain.backward.displacement = shifted(NODES);
        let mut output = Motion::default();
        let radius = self.params.radius(&self.params.output);
        if moved == 2 * NODES {
            output.angle = output.angle.plus(DISPLACEMENT / radius);
            // The nodes stay where they are; a state's are counted from the output's pulley.
            let stay = self.belt.torsion(&Motion::default(), &output) * radius;
            state.chain.forward.displacement = [stay; NODES];
            state.chain.backward.displacement = [stay; NODES];
        }
        self.belt.step(&mut state, &mut output, &Motion::default(), 0.0);
        let chain = &state.chain;
        let speeds = chain.forward.velocity.iter().chain(&chain.backward.velocity).copied();
        speeds.chain([radius * output.velocity]).map(|speed| speed / (self.dt * DISPLACEMENT)).collect()
    }

    /// The matrix of the first `size` coordinates, made symmetric by the roots of their masses.
    fn symmetric(&self, columns: &[Vec<f64>], size: usize) -> DMatrix<f64> {
        let ratio = self.mass_ratio().sqrt();
        let root = |coordinate: usize| if coordinate == 2 * NODES { ratio } else { 1.0 };
        DMatrix::from_fn(size, size, |row, column| columns[column][row] * root(row) / root(column))
    }
}
