//! Median and quartiles of samples.

/// Median and quartiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// A quarter of the samples is below.
    pub lower_quartile: f64,
    /// Half of the samples is below.
    pub median: f64,
    /// Three quarters of the samples are below.
    pub upper_quartile: f64,
}

impl Spread {
    /// Of samples, at least one: each value is the sample whose rank is next to its fraction.
    pub(super) fn of(samples: &[f64]) -> Self {
        let mut sorted = samples.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |fraction: f64| sorted[(fraction * (sorted.len() - 1) as f64).round() as usize];
        Self { lower_quartile: at(0.25), median: at(0.5), upper_quartile: at(0.75) }
    }

    /// In another unit, of which one of this spread has `factor`.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let Self { lower_quartile, median, upper_quartile } = self;
        Self {
            lower_quartile: factor * lower_quartile,
            median: factor * median,
            upper_quartile: factor * upper_quartile,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_slow_sample_moves_no_quartile() {
        let spread = Spread::of(&[3.0, 1.0, 1e9, 2.0, 4.0]);
        assert_eq!(spread, Spread { lower_quartile: 2.0, median: 3.0, upper_quartile: 4.0 });
        assert_eq!(Spread::of(&[7.0]).times(2.0).median, 14.0);
    }
}
