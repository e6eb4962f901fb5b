//! The first four eigenvalues: of the cantilever against the textbook, with payloads against a beam of finite elements.
//!
//! Problem and answer of the latter are `desktop/oracle/link/eigenvalues.csv`, by `beam.py` beside it. lambda follows from the
//! link's frequency, omega = lambda^2*sqrt(EI/(mu*L^4)); payloads are in terms of the beam, M/(mu*L) and J/(mu*L^3).

use serde::Deserialize;
use strainwave::link::LinkParams;

use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

const STORED: &str = include_str!("../../../oracle/link/eigenvalues.csv");
/// Roots of 1 + cosh(lambda)*cos(lambda).
const CANTILEVER: [f64; 4] =
    [1.875_104_068_711_961, 4.694_091_132_974_175, 7.854_757_438_237_613, 10.995_540_734_875_467];

/// A beam with a payload, and its first four eigenvalues.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Row {
    mass: f64,
    inertia: f64,
    lambda_1: f64,
    lambda_2: f64,
    lambda_3: f64,
    lambda_4: f64,
}

pub(super) fn measure() -> Vec<Figure> {
    let cantilever = off(0.0, 0.0, CANTILEVER);
    let stored = largest(stored().iter().map(Row::off));
    vec![
        bounds::figure("link.eigenvalues.cantilever", cantilever),
        bounds::figure("link.eigenvalues.finite_elements", stored),
    ]
}

/// The stored beams.
///
/// # Panics
/// When the embedded file is not the table, which is a mistake in the program.
pub fn stored() -> Vec<Row> {
    let mut reader = csv::Reader::from_reader(STORED.as_bytes());
    reader.deserialize().map(|row| row.expect("eigenvalues.csv is a table of eigenvalues")).collect()
}

impl Row {
    /// Largest relative error of the four.
    pub fn off(&self) -> f64 {
        off(self.mass, self.inertia, [self.lambda_1, self.lambda_2, self.lambda_3, self.lambda_4])
    }

    /// The same of a payload that is this much heavier.
    pub fn off_when_heavier(&self, times: f64) -> f64 {
        Self { mass: self.mass * times, inertia: self.inertia * times, ..*self }.off()
    }
}

fn off(mass: f64, inertia: f64, expected: [f64; 4]) -> f64 {
    // A length and a density that are not 1.
    let (length, density, stiffness) = (0.7, 0.9, 40.0);
    let beam: f64 = density * length;
    let params = LinkParams::<f64, 4> {
        length,
        bending_stiffness: stiffness,
        linear_density: density,
        thickness: 0.005,
        payload_mass: mass * beam,
        payload_inertia: inertia * beam * length * length,
        damping: [0.0; 4],
        gravity: 0.0,
        patch: None,
    };
    let frequencies = params.build(1e-5).expect("the parameters are in range").frequencies();
    let rate = (stiffness / (density * length.powi(4))).sqrt();
    let errors = frequencies.iter().zip(expected).map(|(omega, lambda)| (omega / rate).sqrt() / lambda - 1.0);
    largest(errors)
}
