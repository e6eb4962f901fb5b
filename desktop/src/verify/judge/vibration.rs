//! The part of a torsion that rings.
//!
//! ```text
//! v(t) = phi(t) - 1/T * integral of phi from t - T/2 to t + T/2
//! ```
//!
//! T is the natural period (s). Of a sine of frequency f the mean keeps sinc(f*T): nothing at 1/T and its
//! multiples, all where f*T is small. Half a period at both ends of a stretch has no mean and is left out.

use crate::bench::closed_loop::Row;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// The torsion's vibration over a stretch of rows (rad), for a natural period (s).
pub fn vibration(rows: &[Row], period: f64) -> Vec<f64> {
    without_slow_part(&rows.iter().map(|row| row.torsion).collect::<Vec<_>>(), period)
}

/// Values less their running mean over `period` (s), which is an odd number of control periods; half of it is missing
/// at both ends.
pub fn without_slow_part(values: &[f64], period: f64) -> Vec<f64> {
    let half = (0.5 * period / CONTROL_PERIOD).round() as usize;
    let whole = 2 * half + 1;
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(values.iter().scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        }))
        .collect();
    sums.iter()
        .zip(sums.iter().skip(whole))
        .zip(values.iter().skip(half))
        .map(|((before, after), value)| value - (after - before) / whole as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn the_slow_part_goes_and_the_natural_frequency_stays() {
        let period = 0.0301;
        let values: Vec<f64> = (0..2000)
            .map(|k| f64::from(k) * CONTROL_PERIOD)
            .map(|t| 5.0 + 3.0 * t + (TAU * t / period).sin())
            .collect();
        let left = without_slow_part(&values, period);
        assert_eq!(left.len(), 2000 - 300);
        for (k, value) in left.iter().enumerate() {
            let expected = (TAU * (k as f64 + 150.0) * CONTROL_PERIOD / period).sin();
            assert!((value - expected).abs() < 1e-9, "{k}: {value} {expected}");
        }
        assert!(without_slow_part(&values[..300], period).is_empty());
    }
}
