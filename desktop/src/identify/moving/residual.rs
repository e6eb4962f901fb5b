//! Output encoder against the motor's: offset, kinematic error and scale error by regularised least squares.
//!
//! ```text
//! min  sum of (what is left of a row - rho*what is left of the row before)^2/(sigma^2 (1 - rho^2) + q^2) + priors
//! rho = exp(-path/PATH_ALIKE - time/TIME_ALIKE)
//! ```
//!
//! path (rad) and time (s) are those from row to row: what no column explains is alike along a short piece of either, with
//! the standard deviation sigma = [`LEFT`], in addition to the encoders' own noise q = [`READING`]. Without it the rows of a
//! fraction of a revolution would be taken for thousands of witnesses.
//!
//! Priors (standard deviations): an order k of e has [`ORDER_2`]*(2/k)^2, order 1 a quarter of it; order k of E has
//! [`ECCENTRICITY`]/k^2.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::super::Error;
use super::super::covariance::Covariance;
use super::super::least_squares::Factor;
use super::super::sequence::span;
use super::EVERY;
use crate::identify::replay::ReplayRow;
use crate::io::gear_file::{GearFile, Harmonic};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Orders of the kinematic error, a revolution of the motor.
pub const ORDERS: [u32; 6] = [1, 2, 4, 6, 8, 10];
/// The order of the wave generator's two lobes: every harmonic drive has it.
const LOBES: u32 = 2;
/// Orders of the output encoder's scale, a revolution of the output.
const SCALE_ORDERS: [u32; 2] = [1, 2];
/// Periods of an order that a path must show.
const PERIODS: f64 = 0.5;
/// Beats between the two kinds of orders that a path must show.
pub const BEATS: f64 = 0.5;
/// Of a sine and of a cosine of order 2 (rad): the catalogue's positioning accuracy is 2.9e-4 rad from peak to peak.
const ORDER_2: f64 = 8e-5;
/// Of a sine and of a cosine of order 1 a revolution of the output (rad): 80 seconds of arc, a ring of 100 mm radius that is
/// mounted 40 um off centre.
const ECCENTRICITY: f64 = 4e-4;
/// Of c (rad).
pub(crate) const OFFSET: f64 = 1e-2;
/// Of a factor on the torsion: a catalogue's stiffness is that of the gear alone, and the load's inertia is a guess.
pub(super) const TORSION: f64 = 0.5;
/// sigma (rad): the size of orders that have no column.
const LEFT: f64 = 2e-5;
/// q (rad): two counts of a 19-bit encoder, a tenth of it by averaging.
const READING: f64 = 2e-6;
/// Path over which what is left is alike (rad): a period of order 5, which like 3 and 7 has no column.
const PATH_ALIKE: f64 = TAU / 5.0;
/// Time over which it is alike (s): a period of an arm's sway.
const TIME_ALIKE: f64 = 0.2;

/// Standard deviation of a sine and of a cosine of the kinematic error before anything was measured (rad).
pub(crate) fn error_prior(order: u32) -> f64 {
    let k = f64::from(order);
    if order == 1 { ORDER_2 / 4.0 } else { ORDER_2 * 4.0 / (k * k) }
}

/// Which angle an order counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// theta
    Case,
    /// theta - r*theta
    Flexspline,
    /// r*theta
    Scale,
}

impl Kind {
    fn angle(self, row: &ReplayRow) -> f64 {
        match self {
            Self::Case => row.motor,
            Self::Flexspline => row.motor - row.rigid,
            Self::Scale => row.rigid,
        }
    }

    fn prior(self, order: u32) -> f64 {
        let k = f64::from(order);
        match self {
            Self::Scale => ECCENTRICITY / (k * k),
            Self::Case | Self::Flexspline => error_prior(order),
        }
    }

    /// Key of its orders in the gear file.
    pub fn key(self) -> &'static str {
        match self {
            Self::Case => "kinematic_error.wave_generator",
            Self::Flexspline => "kinematic_error.flexspline",
            Self::Scale => "sensors.output_encoder_error",
        }
    }

    /// Names of sine and cosine of an order in the covariance (rad).
    pub fn coefficients(self, order: u32) -> [String; 2] {
        ["sine", "cosine"].map(|part| format!("{} order {order} {part}", self.key()))
    }
}

/// Result of the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// Sum of squares, with those of the priors.
    pub squares: f64,
    /// Rms residual of the rows (rad).
    pub rms: f64,
    /// Of c, sines and cosines (rad).
    pub covariance: Option<Covariance>,
    terms: Vec<(Kind, Harmonic)>,
}

/// Over so many revolutions of the motor the order of the two lobes shows.
pub(super) fn shows_errors(revolutions: f64) -> bool {
    revolutions >= PERIODS / f64::from(LOBES)
}

/// Revolutions that the motor's angle spans.
pub(super) fn revolutions(rows: &[ReplayRow]) -> f64 {
    span(&rows.iter().map(|row| row.motor).collect::<Vec<_>>()) / TAU
}

impl Residual {
    /// The least squares of rows that the observer of `gear` was fed with. Its kinematic error is none where the rows show
    /// errors; else the offset alone is solved for.
    pub(crate) fn solve(gear: &GearFile, rows: &[ReplayRow]) -> Result<Self, Error> {
        let rows: Vec<_> = rows.iter().step_by(EVERY).copied().collect();
        let problem = Problem { columns: columns(gear, revolutions(&rows)), torsion: false };
        let (unknowns, equations) = (problem.unknowns(), problem.equations(&rows));
        let (factor, x) = solved(&equations, &rows)?;
        let left = equations.columns(0, unknowns) * &x - equations.column(unknowns);
        Ok(Self {
            squares: factor.squares(x.as_slice()) + x.norm_squared(),
            rms: (left.norm_squared() / rows.len() as f64).sqrt(),
            covariance: problem.covariance(&factor),
            terms: problem.terms(&x),
        })
    }

    /// Into the gear that the observer had.
    pub(super) fn put_into(&self, gear: &mut GearFile) {
        let of = |kind| self.terms.iter().filter(|term| term.0 == kind).map(|term| term.1).collect();
        gear.kinematic_error.wave_generator = of(Kind::Case);
        gear.kinematic_error.flexspline = of(Kind::Flexspline);
        gear.sensors.output_encoder_error = of(Kind::Scale);
    }
}

/// The unknowns that equations give, and the factor of their [`whitened`] rows.
pub(super) fn solved(equations: &DMatrix<f64>, rows: &[ReplayRow]) -> Result<(Factor, DVector<f64>), Error> {
    let (factor, unknowns) = (Factor::of(whitened(equations, rows)), equations.ncols() - 1);
    let x = factor.solve(&DMatrix::identity(unknowns, unknowns), &DVector::zeros(unknowns), unknowns)?;
    Ok((factor, DVector::from_vec(x)))
}

/// The orders that a path of so many revolutions shows.
pub(super) fn columns(gear: &GearFile, revolutions: f64) -> Vec<(Kind, u32)> {
    if !shows_errors(revolutions) {
        return Vec::new();
    }
    let shown = ORDERS.into_iter().filter(move |order| revolutions * f64::from(*order) >= PERIODS);
    let apart = revolutions >= BEATS * f64::from(gear.gear.signed_ratio().n().abs());
    let scale = SCALE_ORDERS.into_iter().map(|order| (Kind::Scale, order));
    let flexspline = shown.clone().map(|order| (Kind::Flexspline, order));
    scale.chain(flexspline).chain(shown.filter(|_| apart).map(|order| (Kind::Case, order))).collect()
}

/// Unknowns: c, sine and cosine of each column, where asked for what the torsion is too large by; each in units of its prior.
pub(super) struct Problem {
    pub columns: Vec<(Kind, u32)>,
    pub torsion: bool,
}

impl Problem {
    pub fn unknowns(&self) -> usize {
        1 + 2 * self.columns.len() + usize::from(self.torsion)
    }

    /// Rows [unknowns | theta_out - r*theta_motor + phi] (rad).
    pub fn equations(&self, rows: &[ReplayRow]) -> DMatrix<f64> {
        let unknowns = self.unknowns();
        DMatrix::from_fn(rows.len(), unknowns + 1, |row, column| {
            let row = &rows[row];
            match column {
                0 => OFFSET,
                k if self.torsion && k == unknowns - 1 => TORSION * (row.rigid - row.predicted),
                k if k < unknowns => self.sine_or_cosine(k - 1, row),
                _ => row.measured - row.predicted,
            }
        })
    }

    /// Sines stand before their cosines.
    fn sine_or_cosine(&self, index: usize, row: &ReplayRow) -> f64 {
        let (kind, order) = self.columns[index / 2];
        let (sine, cosine) = (f64::from(order) * kind.angle(row)).sin_cos();
        kind.prior(order) * if index.is_multiple_of(2) { sine } else { cosine }
    }

    /// Of the unknowns themselves; [`whitened`] rows have unit noise.
    fn covariance(&self, factor: &Factor) -> Option<Covariance> {
        let count = self.unknowns();
        let unknowns =
            factor.covariance(&DMatrix::identity(count, count), &(0..count).collect::<Vec<_>>())?;
        let priors = self.columns.iter().flat_map(|(kind, order)| [kind.prior(*order); 2]);
        let priors = DVector::from_iterator(count, std::iter::once(OFFSET).chain(priors));
        let named = self.columns.iter().flat_map(|(kind, order)| kind.coefficients(*order));
        let names = std::iter::once("offset".to_owned()).chain(named).collect();
        Some(Covariance::of_sums(names, &DMatrix::from_diagonal(&priors), &unknowns))
    }

    fn terms(&self, x: &DVector<f64>) -> Vec<(Kind, Harmonic)> {
        let term = |(index, (kind, order)): (usize, &(Kind, u32))| {
            let (sine, cosine) = (x[1 + 2 * index], x[2 + 2 * index]);
            let amplitude = kind.prior(*order) * sine.hypot(cosine);
            (*kind, Harmonic { order: *order, amplitude, phase: cosine.atan2(sine) })
        };
        self.columns.iter().enumerate().map(term).collect()
    }
}

/// rho of a row after a path of the motor (rad), and the standard deviation of what the row adds (rad).
pub(crate) fn alike(path: f64) -> (f64, f64) {
    let rho = (-path / PATH_ALIKE - EVERY as f64 * CONTROL_PERIOD / TIME_ALIKE).exp();
    (rho, (LEFT * LEFT * (1.0 - rho * rho) + READING * READING).sqrt())
}

/// Rows of unit noise each: what a row adds to the one before.
fn whitened(equations: &DMatrix<f64>, rows: &[ReplayRow]) -> DMatrix<f64> {
    let mut white = equations.clone();
    white.row_mut(0).scale_mut(1.0 / LEFT.hypot(READING));
    for k in 1..rows.len() {
        let path = (rows[k].motor - rows[k - 1].motor).abs();
        let (rho, noise) = alike(path);
        white.set_row(k, &((equations.row(k) - equations.row(k - 1) * rho) / noise));
    }
    white
}
