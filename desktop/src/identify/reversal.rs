//! Reversals of an input, and inputs that reverse everywhere.
//!
//! First-order reversal curves: from the lower end of the range up to alpha, back to the lower end, for every
//! alpha of the grid: the second differences of what the output does are the weights. A major loop with minor
//! loops between moves the cells too. Both are recorded sequences like any other to the identification.
//!
//! I. Mayergoyz, "Mathematical models of hysteresis and their applications", 2003, section 1.2.

/// Times that `input` turns back by more than `least` from an extremum.
pub fn reversals(input: &[f64], least: f64) -> usize {
    turns(input, least).len()
}

/// Where `input` has its extrema, from which it turns back by more than `least`.
pub fn turns(input: &[f64], least: f64) -> Vec<usize> {
    let (mut low, mut high) = (0, 0);
    let (mut found, mut rising) = (Vec::new(), None);
    for (at, &u) in input.iter().enumerate() {
        if u < input[low] {
            low = at;
        }
        if u > input[high] {
            high = at;
        }
        let turned = match rising {
            None => input[high] - input[low] > least,
            Some(true) => input[high] - u > least,
            Some(false) => u - input[low] > least,
        };
        if turned {
            if let Some(rising) = rising {
                found.push(if rising { high } else { low });
            }
            rising = Some(rising.map_or(u == input[high], |rising: bool| !rising));
            (low, high) = (at, at);
        }
    }
    found
}

/// Paths of `input` upwards and downwards; what is not more than `least` is left out, as noise.
pub fn travel(input: &[f64], least: f64) -> [f64; 2] {
    let [mut up, mut down] = [0.0; 2];
    let mut at = input.first().copied().unwrap_or_default();
    for &u in input {
        if (u - at).abs() > least {
            up += (u - at).max(0.0);
            down += (at - u).max(0.0);
            at = u;
        }
    }
    [up, down]
}

/// First-order reversal curves over +-`half_range` from `levels` edges of the grid, `steps` samples a cell.
pub fn reversal_curves(half_range: f64, levels: usize, steps: usize) -> Vec<f64> {
    let edge = |k: usize| half_range * (2.0 * k as f64 / levels as f64 - 1.0);
    let corners = (1..=levels).rev().flat_map(|k| [edge(k), -half_range]);
    through(half_range, levels, steps, corners)
}

/// A major loop over +-`half_range`, then `minor` ever larger loops from its upper end and as many from its lower.
pub fn loops(half_range: f64, levels: usize, steps: usize, minor: usize) -> Vec<f64> {
    let nested = (1..=minor).flat_map(|k| {
        let shrunk = half_range * (1.0 - k as f64 / (minor + 1) as f64);
        [
            half_range,
            half_range - 2.0 * shrunk,
            half_range,
            -half_range,
            2.0 * shrunk - half_range,
            -half_range,
        ]
    });
    through(half_range, levels, steps, [half_range, -half_range].into_iter().chain(nested))
}

/// From zero through the corners, `steps` samples for each cell of `levels` on the way.
fn through(half_range: f64, levels: usize, steps: usize, corners: impl Iterator<Item = f64>) -> Vec<f64> {
    let longest = 2.0 * half_range / (levels * steps.max(1)) as f64;
    let mut path = vec![0.0];
    let mut at = 0.0;
    for corner in corners {
        let count = ((corner - at) / longest).abs().ceil().max(1.0);
        path.extend((1..=count as usize).map(|k| at + (corner - at) * k as f64 / count));
        at = corner;
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_no_path() {
        let saw = |k: u32| f64::from(k) / 100.0 + if k.is_multiple_of(2) { 0.004 } else { -0.004 };
        let noisy: Vec<_> = (0..=100).chain((50..100).rev()).map(saw).collect();
        let [up, down] = travel(&noisy, 0.02);
        assert!((up - 1.0).abs() < 0.05 && (down - 0.5).abs() < 0.05, "{up} {down}");
    }

    #[test]
    fn a_reversal_is_counted_when_it_is_large_enough() {
        assert_eq!(reversals(&[0.0, 1.0, 2.0], 0.1), 0);
        assert_eq!(reversals(&[0.0, 1.0, 0.95, 2.0], 0.1), 0);
        assert_eq!(reversals(&[0.0, 1.0, 0.8, 2.0, -1.0], 0.1), 3);
        assert_eq!(reversals(&[1.0, -1.0, -0.5], 0.1), 1);
        assert_eq!(reversals(&[], 0.1), 0);
        assert_eq!(turns(&[0.0, 1.0, 0.8, 0.7, 2.0, -1.0], 0.1), [1, 3, 4]);
        assert_eq!(reversals(&reversal_curves(1.0, 4, 3), 0.1), 7);
    }
}
