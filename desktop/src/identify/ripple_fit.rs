//! Fits the orders of a level's ripple to a map over the wave generator's angle.
//!
//! The map has evenly spaced bins, the first from angle 0 on; each holds the level at its middle. On such
//! bins least squares is the discrete Fourier transform, as long as there are more than two bins an order.

use std::f64::consts::TAU;

use strainwave::friction::Harmonics;

/// Mean and orders 1 to `K` of the bins, in their unit.
///
/// # Panics
/// When the map has 2*K bins or less: then the orders cannot be separated.
pub fn fit<const K: usize>(bins: &[f64]) -> Harmonics<f64, K> {
    assert!(bins.len() > 2 * K, "{} bins are too few for {K} orders", bins.len());
    let count = bins.len() as f64;
    let project = |wave: fn(f64) -> f64, order: usize| {
        let angles = (0..bins.len()).map(|k| order as f64 * TAU * (k as f64 + 0.5) / count);
        2.0 / count * angles.zip(bins).map(|(angle, level)| level * wave(angle)).sum::<f64>()
    };
    Harmonics {
        mean: bins.iter().sum::<f64>() / count,
        cosines: std::array::from_fn(|k| project(f64::cos, k + 1)),
        sines: std::array::from_fn(|k| project(f64::sin, k + 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_of_few_orders_is_found_again() {
        let level =
            |angle: f64| 8.0 + 1.5 * angle.cos() - 0.3 * (2.0 * angle).sin() + 0.1 * (3.0 * angle).cos();
        let bins: Vec<f64> = (0..36).map(|k| level(TAU * (f64::from(k) + 0.5) / 36.0)).collect();
        let found = fit::<3>(&bins);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
        near(found.mean, 8.0);
        [1.5, 0.0, 0.1].into_iter().zip(found.cosines).for_each(|(a, b)| near(a, b));
        [0.0, -0.3, 0.0].into_iter().zip(found.sines).for_each(|(a, b)| near(a, b));
    }

    #[test]
    #[should_panic(expected = "8 bins are too few for 4 orders")]
    fn too_few_bins_are_refused() {
        fit::<4>(&[1.0; 8]);
    }
}
