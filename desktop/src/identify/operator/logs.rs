//! Logs of input and output: which part trains, and the loops that cross-validation leaves out.

use std::ops::Range;

use crate::identify::Error;
use crate::identify::reversal::turns;
use crate::identify::sequence::{REVERSAL, require_finite, require_reversal, span};
use crate::io::log::InputOutput;

impl InputOutput {
    /// Rows that train, of the chosen fraction.
    ///
    /// # Errors
    /// [`Error`] when they are not finite, their input never reverses or their output is constant.
    pub fn training(&self, fraction: f64) -> Result<usize, Error> {
        if !(0.2..=1.0).contains(&fraction) {
            return Err(strainwave::Error::OutOfRange("training").into());
        }
        require_finite(&self.input, &self.output)?;
        let count = (self.input.len() as f64 * fraction) as usize;
        require_reversal("input u", &self.input[..count])?;
        if span(&self.output[..count]) > 0.0 { Ok(count) } else { Err(Error::ConstantOutput) }
    }

    /// Some rows of it.
    pub(super) fn part(&self, rows: Range<usize>) -> (&[f64], &[f64]) {
        (&self.input[rows.clone()], &self.output[rows])
    }

    /// Loops of the first `count` rows: from every other turn of the input to the next of its kind.
    pub(super) fn loops(&self, count: usize) -> Vec<Range<usize>> {
        let input = &self.input[..count];
        let inner = turns(input, REVERSAL * span(input)).into_iter().skip(1).step_by(2);
        let edges: Vec<_> = std::iter::once(0).chain(inner).chain([count]).collect();
        edges.windows(2).map(|pair| pair[0]..pair[1]).filter(|rows| !rows.is_empty()).collect()
    }
}

/// Least and greatest of the first so many inputs of all logs.
pub(super) fn range(logs: &[InputOutput], counts: &[usize]) -> (f64, f64) {
    let inputs = logs.iter().zip(counts).flat_map(|(log, count)| &log.input[..*count]);
    inputs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), u| (low.min(*u), high.max(*u)))
}

/// Span of the first so many outputs of all logs.
pub(super) fn output_span(logs: &[InputOutput], counts: &[usize]) -> f64 {
    let outputs = logs.iter().zip(counts).flat_map(|(log, count)| &log.output[..*count]);
    span(&outputs.copied().collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_is_cut_into_its_loops() {
        let saw = |k: usize| if k % 20 < 10 { k % 20 } else { 20 - k % 20 } as f64;
        let input: Vec<_> = (0..60).map(saw).collect();
        let log = InputOutput { output: input.clone(), input };
        assert_eq!(log.loops(60), [0..20, 20..40, 40..60]);
        assert_eq!(log.loops(5), std::iter::once(0..5).collect::<Vec<_>>());
    }

    #[test]
    fn what_cannot_train_is_refused() {
        let rise: Vec<f64> = (0..100).map(f64::from).collect();
        let there_and_back = || rise.iter().chain(rise.iter().rev()).copied().collect::<Vec<_>>();
        let log = |input: Vec<f64>, output: Vec<f64>| InputOutput { input, output };
        assert_eq!(log(there_and_back(), there_and_back()).training(1.0), Ok(200));
        assert!(matches!(
            log(there_and_back(), there_and_back()).training(0.5),
            Err(Error::NeverReverses { input: "input u", .. })
        ));
        assert!(matches!(log(vec![1.0; 100], rise.clone()).training(1.0), Err(Error::NeverReverses { .. })));
        assert_eq!(log(there_and_back(), vec![1.0; 200]).training(1.0), Err(Error::ConstantOutput));
        assert!(matches!(log(vec![], vec![]).training(1.0), Err(Error::NeverReverses { .. })));
        let gap = [&rise[..7], &[f64::NAN]].concat();
        assert_eq!(log(rise[..8].to_vec(), gap).training(1.0), Err(Error::NotFinite { sample: 7 }));
        assert!(matches!(
            log(rise[..8].to_vec(), vec![]).training(1.0),
            Err(Error::Lengths { inputs: 8, outputs: 0 })
        ));
    }
}
