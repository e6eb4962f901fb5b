//! Amplitude of evenly spaced values over frequency, over time or over an angle.

use std::f64::consts::TAU;

/// Lines of a spectrum in one resolution.
const LINES: f64 = 8.0;

/// Amplitude of values that are `interval` apart over frequency up to `highest`, in the interval's inverse, eight lines a resolution:
/// Hann window, so that a sine keeps its amplitude and leaks no further than two resolutions. Pairs of frequency and amplitude.
pub fn spectrum(values: &[f64], interval: f64, highest: f64) -> Vec<(f64, f64)> {
    let count = values.len() as f64;
    let resolution = 1.0 / (count * interval);
    let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    let windowed: Vec<_> = values.iter().enumerate().map(|(k, value)| window(k) * value).collect();
    let lines = (LINES * highest / resolution) as usize;
    let frequencies = (1..=lines).map(|line| resolution / LINES * line as f64);
    frequencies.map(|frequency| (frequency, 2.0 / count * size(&windowed, frequency * interval))).collect()
}

/// Magnitude of the sum of values times a wave of `frequency` periods a value.
fn size(values: &[f64], frequency: f64) -> f64 {
    let (sine_step, cosine_step) = (TAU * frequency).sin_cos();
    let (mut sine, mut cosine) = (0.0, 1.0);
    let mut sums = [0.0; 2];
    for value in values {
        sums[0] += value * sine;
        sums[1] += value * cosine;
        // Turned on by one step: a sine and a cosine for each value would take most of the time.
        (sine, cosine) = (sine * cosine_step + cosine * sine_step, cosine * cosine_step - sine * sine_step);
    }
    f64::hypot(sums[0], sums[1])
}

/// The highest frequency, up to half of one over the interval, to which the spectrum of so many values takes at most `most` products.
pub fn affordable(count: usize, interval: f64, most: f64) -> f64 {
    let lines = most / count.max(1) as f64;
    (lines / LINES / (count as f64 * interval)).min(0.5 / interval)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_stands_in_the_spectrum_with_its_amplitude() {
        let interval = 1e-4;
        let values: Vec<f64> =
            (0..5000).map(|k| 2e-5 * (TAU * 40.0 * f64::from(k) * interval).sin()).collect();
        let lines = spectrum(&values, interval, 100.0);
        let (frequency, amplitude) = lines.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!((frequency - 40.0).abs() < 1e-9 && (amplitude / 2e-5 - 1.0).abs() < 1e-3);
        let far = lines.iter().filter(|(frequency, _)| (frequency - 40.0).abs() > 10.0);
        assert!(far.map(|(_, amplitude)| *amplitude).fold(0.0, f64::max) < 1e-7);
    }

    #[test]
    fn a_long_log_has_a_spectrum_of_as_many_products_as_a_short_one() {
        assert_eq!(affordable(100, 0.01, 1e6), 50.0);
        let highest = affordable(20_000, 0.01, 4e6);
        let lines = spectrum(&vec![0.0; 20_000], 0.01, highest).len();
        assert!((lines as f64 - 200.0).abs() <= 1.0, "{lines} {highest}");
    }
}
