//! The part of a torsion that rings.
//!
//! ```text
//! v(t) = phi(t) - 1/T * integral of phi from t - T/2 to t + T/2
//! ```
//!
//! T is the natural period (s). Of a sine of frequency f the mean keeps sinc(f*T): nothing at 1/T and its
//! multiples, all where f*T is small. Half a period at both ends of a stretch has no mean and is left out.

use std::f64::consts::TAU;

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

/// Lines of a spectrum in one resolution.
const LINES: f64 = 8.0;

/// Amplitude of values over frequency up to `highest` (Hz), eight lines a resolution: Hann window, so that a sine
/// keeps its amplitude and leaks no further than two resolutions. Pairs of frequency and amplitude.
pub fn spectrum(values: &[f64], highest: f64) -> Vec<(f64, f64)> {
    let count = values.len() as f64;
    let resolution = 1.0 / (count * CONTROL_PERIOD);
    let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    let amplitude = |frequency: f64| {
        let (sine, cosine) = values.iter().enumerate().fold((0.0, 0.0), |(sine, cosine), (k, value)| {
            let (s, c) = (TAU * frequency * k as f64 * CONTROL_PERIOD).sin_cos();
            (sine + window(k) * value * s, cosine + window(k) * value * c)
        });
        2.0 / count * f64::hypot(sine, cosine)
    };
    let lines = (LINES * highest / resolution) as usize;
    (1..=lines).map(|line| resolution / LINES * line as f64).map(|f| (f, amplitude(f))).collect()
}

#[cfg(test)]
mod tests {
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

    #[test]
    fn a_sine_stands_in_the_spectrum_with_its_amplitude() {
        let values: Vec<f64> =
            (0..5000).map(|k| 2e-5 * (TAU * 40.0 * f64::from(k) * CONTROL_PERIOD).sin()).collect();
        let lines = spectrum(&values, 100.0);
        let (frequency, amplitude) = lines.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!((frequency - 40.0).abs() < 1e-9 && (amplitude / 2e-5 - 1.0).abs() < 1e-3);
        let far = lines.iter().filter(|(frequency, _)| (frequency - 40.0).abs() > 10.0);
        assert!(far.map(|(_, amplitude)| *amplitude).fold(0.0, f64::max) < 1e-7);
    }
}
