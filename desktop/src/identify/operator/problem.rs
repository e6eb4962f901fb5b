//! The least squares of an operator on one grid.
//!
//! Unknowns, the output's span being 1: the line's two, the rest of each log, densities of the cells. The rest of a log is
//!
//! ```text
//! r[u] = unknown * f(apart)
//! ```
//!
//! with the fraction of the triangle that is in an unknown state, and f, its mean state times weight, linear between whole numbers of
//! cells that the highest and the lowest input are apart.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::grid::{Grid, unit_weight};
use super::history::History;
use super::logs::output_span;
use super::model::{Operator, Point};
use crate::identify::Error;
use crate::identify::choice::{BLOCKS, Preference, Problem, Smoothing};
use crate::identify::least_squares::{Factor, Reduction};
use crate::identify::sequence::pieces_of_time;
use crate::identify::smoothness::{add_difference, penalty_of_cells};
use crate::io::log::InputOutput;

/// Unknowns of the line.
const LINE: usize = 2;
/// Factor of the differences across the diagonal where the penalty prefers densities that are even along it.
const ACROSS: f64 = 0.1;
/// Square of f beside its differences: what no row tells is none.
const REST_ITSELF: f64 = 1e-2;

/// Input and output of some rows of a log.
type Rows<'a> = (&'a [f64], &'a [f64]);

/// The rows of all logs, reduced piece by piece.
pub(super) struct Prepared {
    grid: Grid,
    sign: Option<f64>,
    /// Unknowns of the rest of each log.
    knots: Vec<usize>,
    /// Output in the middle of its span, and its span.
    output: (f64, f64),
    pieces: Vec<Factor>,
}

/// An operator, with how it was found.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    pub operator: Operator,
    /// f of each log at its knots, in units of the output.
    rests: Vec<Vec<f64>>,
    pub along_diagonal: bool,
    /// lambda
    pub smoothing: f64,
    /// Mean square of the pieces left out, in spans.
    pub validation: f64,
    /// Sum of squares of what trained, in spans.
    pub squares: f64,
}

impl Prepared {
    /// From the first so many rows of each log; the weights have this sign, or either.
    pub fn of(grid: Grid, logs: &[InputOutput], counts: &[usize], sign: Option<f64>) -> Self {
        let parts: Vec<_> = logs.iter().zip(counts).map(|(log, count)| log.part(0..*count)).collect();
        let knots: Vec<_> = parts.iter().map(|(input, _)| knots(&grid, input)).collect();
        let span = output_span(logs, counts);
        let least = parts.iter().flat_map(|(_, output)| *output).copied().fold(f64::INFINITY, f64::min);
        let mut prepared = Self { grid, sign, knots, output: (least + 0.5 * span, span), pieces: Vec::new() };
        prepared.pieces = prepared.reduce(&parts, &cuts(logs, counts));
        prepared
    }

    /// The rows of the logs, whose `cuts` are dealt out to the pieces in turn.
    fn reduce(&self, parts: &[Rows], cuts: &[Vec<Range<usize>>]) -> Vec<Factor> {
        let mut pieces: Vec<_> = (0..BLOCKS).map(|_| Reduction::new(self.size() + 1)).collect();
        let mut dealt = 0;
        for (log, (part, cuts)) in parts.iter().zip(cuts).enumerate() {
            let mut rows = self.rows(log, *part);
            for cut in cuts {
                rows.by_ref().take(cut.len()).for_each(|row| pieces[dealt % BLOCKS].push(row));
                dealt += 1;
            }
        }
        pieces.into_iter().map(Reduction::finish).collect()
    }

    /// Rows [1, u, rests, densities | y] of a log.
    fn rows<'a>(&'a self, log: usize, (input, output): Rows<'a>) -> impl Iterator<Item = Vec<f64>> + 'a {
        let (sign, size) = (self.sign.unwrap_or(1.0), self.size());
        let units: Vec<_> = self.grid.cells().map(|cell| sign * unit_weight(&self.grid, cell)).collect();
        let first = LINE + self.knots[..log].iter().sum::<usize>();
        let cells = size - units.len();
        let mut history = History::new(self.grid);
        input.iter().zip(output).map(move |(u, y)| {
            let mut row = vec![0.0; size + 1];
            for ((entry, state), unit) in row[cells..].iter_mut().zip(history.step(*u)).zip(&units) {
                *entry = state * unit;
            }
            let (unknown, apart) = history.unknown();
            for knot in (0..self.knots[log]).filter(|_| unknown > 0.0) {
                row[first + knot] = unknown * (1.0 - (apart - knot as f64).abs()).max(0.0);
            }
            row[0] = 1.0;
            row[1] = (u - self.grid.middle()) / self.grid.half_range();
            row[size] = (y - self.output.0) / self.output.1;
            row
        })
    }

    /// Number of unknowns.
    fn size(&self) -> usize {
        LINE + self.knots.iter().sum::<usize>() + self.grid.size()
    }

    /// The operator that fits best.
    ///
    /// # Errors
    /// The solver ends without a solution.
    pub fn solve(&self, along_diagonal: bool, smoothing: Smoothing) -> Result<Solution, Error> {
        let problem = self.problem(along_diagonal);
        let (smoothing, validation) = problem.choose(&self.pieces, smoothing, Preference::Least)?;
        let rows = Factor::joined(self.pieces.iter());
        let x = problem.solve(&rows, smoothing)?;
        let (middle, span) = self.output;
        let (line, rest) = x.split_at(LINE);
        let (mut knots, densities) = rest.split_at(rest.len() - self.grid.size());
        let sign = self.sign.unwrap_or(1.0) * span;
        let cells = self.grid.cells().zip(densities);
        let weights = cells.map(|(cell, density)| sign * density * unit_weight(&self.grid, cell)).collect();
        let slope = line[1] * span / self.grid.half_range();
        let operator = Operator::build(self.grid, middle + line[0] * span, slope, weights)?;
        let rests = self.knots.iter().map(|count| {
            let (of_log, others) = knots.split_at(*count);
            knots = others;
            of_log.iter().map(|rest| rest * span).collect()
        });
        let rests = rests.collect();
        Ok(Solution { operator, rests, along_diagonal, smoothing, validation, squares: rows.squares(&x) })
    }

    fn problem(&self, along_diagonal: bool) -> Problem {
        let (size, free) = (self.size(), self.size() - self.grid.size());
        let [along, across] = if along_diagonal { [1.0, ACROSS] } else { [0.0, 1.0] };
        let mut penalty = DMatrix::zeros(size, size);
        let cells = penalty_of_cells(self.grid.levels, along, across);
        penalty.view_mut((free, free), (cells.nrows(), cells.ncols())).copy_from(&cells);
        let mut at = LINE;
        for count in &self.knots {
            for knot in at..at + count {
                penalty[(knot, knot)] += REST_ITSELF;
                add_difference(&mut penalty, (knot > at).then(|| knot - 1), Some(knot), 1.0);
            }
            at += count;
        }
        let bounded = if self.sign.is_some() { free } else { size };
        Problem { penalty, prior: DVector::zeros(size), bounded }
    }
}

impl Solution {
    /// y along the logs that it was found from, the rows that did not train too.
    pub fn predicted(&self, logs: &[InputOutput]) -> Vec<Vec<f64>> {
        let predict = |(log, rest): (&InputOutput, &Vec<f64>)| {
            let points = self.operator.points(&log.input);
            points.iter().map(|point| point.output + at(rest, point)).collect()
        };
        logs.iter().zip(&self.rests).map(predict).collect()
    }
}

/// Rest of a log at a point; beyond the last knot f stays.
fn at(rest: &[f64], point: &Point) -> f64 {
    let Some(last) = rest.len().checked_sub(1) else { return 0.0 };
    let apart = point.apart.min(last as f64);
    let (knot, fraction) = ((apart as usize).min(last), apart.fract());
    let next = rest[(knot + 1).min(last)];
    point.unknown * (rest[knot] + fraction * (next - rest[knot]))
}

/// Unknowns of the rest of a log with this input.
fn knots(grid: &Grid, input: &[f64]) -> usize {
    let mut history = History::new(*grid);
    let known_at = |u: &f64| {
        history.step(*u);
        Some(history.unknown()).filter(|(unknown, _)| *unknown > 0.0).map(|(_, apart)| apart)
    };
    input.iter().map_while(known_at).last().map_or(0, |apart| apart.ceil() as usize + 1)
}

/// Where each log is cut: into its loops, or where they are too few in all into pieces of time.
fn cuts(logs: &[InputOutput], counts: &[usize]) -> Vec<Vec<Range<usize>>> {
    let loops: Vec<_> = logs.iter().zip(counts).map(|(log, count)| log.loops(*count)).collect();
    if loops.iter().flatten().count() >= BLOCKS {
        return loops;
    }
    counts.iter().map(|count| pieces_of_time(0..*count).collect()).collect()
}
