//! What is missed of logs, beside a straight line.

use crate::io::log::InputOutput;

/// Errors over some rows, as fractions of the span of the trained outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Rows.
    pub rows: usize,
    /// Rms.
    pub rms: f64,
    /// Largest magnitude.
    pub max: f64,
    /// Rms of the straight line.
    pub line_rms: f64,
    /// Largest magnitude of the straight line's.
    pub line_max: f64,
}

/// Straight line through what trains, by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Mean input.
    middle: f64,
    /// Mean output.
    offset: f64,
    slope: f64,
}

/// Input and output of some rows of a log, and what is predicted.
type Rows<'a> = ((&'a [f64], &'a [f64]), &'a [f64]);

impl Line {
    /// Through the first so many rows of logs.
    pub(super) fn of(logs: &[InputOutput], counts: &[usize]) -> Self {
        let parts = || logs.iter().zip(counts).map(|(log, count)| log.part(0..*count));
        let rows = || parts().flat_map(|(u, y)| u.iter().zip(y));
        let count = rows().count() as f64;
        let middle = rows().map(|(u, _)| u).sum::<f64>() / count;
        let offset = rows().map(|(_, y)| y).sum::<f64>() / count;
        let moment = rows().map(|(u, y)| (u - middle) * (y - offset)).sum::<f64>();
        let square = rows().map(|(u, _)| (u - middle).powi(2)).sum::<f64>();
        Self { middle, offset, slope: moment / square }
    }

    /// Output over input.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// Output at an input.
    pub fn at(&self, u: f64) -> f64 {
        self.offset + self.slope * (u - self.middle)
    }
}

impl Errors {
    /// Over the rows of all parts; `None` without any.
    pub(super) fn of<'a>(parts: impl Iterator<Item = Rows<'a>>, line: &Line, span: f64) -> Option<Self> {
        let (mut rows, mut squares, mut most) = (0, [0.0; 2], [0.0_f64; 2]);
        for ((inputs, outputs), predicted) in parts {
            for ((u, y), predicted) in inputs.iter().zip(outputs).zip(predicted) {
                rows += 1;
                for (k, error) in [predicted - y, line.at(*u) - y].into_iter().enumerate() {
                    squares[k] += error * error;
                    most[k] = most[k].max(error.abs());
                }
            }
        }
        let [rms, line_rms] = squares.map(|sum| (sum / rows as f64).sqrt() / span);
        let [max, line_max] = most.map(|most| most / span);
        (rows > 0).then_some(Self { rows, rms, max, line_rms, line_max })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_what_is_off_it_counts() {
        let input: Vec<f64> = (0..11).map(f64::from).collect();
        let output: Vec<f64> = input.iter().map(|u| 3.0 - 2.0 * u).collect();
        let log = InputOutput { input, output: output.clone() };
        let line = Line::of(std::slice::from_ref(&log), &[6]);
        let mut predicted = output;
        predicted[10] += 5.0;
        let parts = || std::iter::once((log.part(1..11), &predicted[1..]));
        let errors = Errors::of(parts(), &line, 20.0).unwrap();
        assert_eq!((errors.rows, errors.max), (10, 0.25));
        assert!((errors.rms - 2.5f64.sqrt() / 20.0).abs() < 1e-12 && errors.line_max < 1e-12);
        assert_eq!(Errors::of(std::iter::empty(), &line, 1.0), None);
    }
}
