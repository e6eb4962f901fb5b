//! Taylor coefficients of a quantity about an instant: its value, and what its first four derivatives make of it.
//!
//! ```text
//! x(t + h) = sum_k x_k*h^k,     d^k x/dt^k = k!*x_k,     k = 0..4
//! k*cos_k = -sum_j j*x_j*sin_(k-j),     k*sin_k = sum_j j*x_j*cos_(k-j)          of cos(x) and sin(x)
//! ```
//!
//! Reference: A. Griewank, A. Walther, Evaluating Derivatives, 2nd edition, SIAM 2008, chapter 13.

/// Coefficients that are kept.
pub const ORDERS: usize = 5;
/// k!
const FACTORIALS: [f64; ORDERS] = [1.0, 1.0, 2.0, 6.0, 24.0];

/// x_k.
pub type Jet = [f64; ORDERS];

/// The jet of a value and its derivatives.
pub fn of_derivatives(derivatives: Jet) -> Jet {
    std::array::from_fn(|k| derivatives[k] / FACTORIALS[k])
}

/// Value and derivatives of a jet.
pub fn derivatives(jet: &Jet) -> Jet {
    std::array::from_fn(|k| FACTORIALS[k] * jet[k])
}

/// Cosine and sine of a jet.
pub fn cosine_and_sine(x: &Jet) -> [Jet; 2] {
    let (mut cosine, mut sine) = ([0.0; ORDERS], [0.0; ORDERS]);
    (sine[0], cosine[0]) = x[0].sin_cos();
    for k in 1..ORDERS {
        let by = |other: &Jet| (1..=k).map(|j| j as f64 * x[j] * other[k - j]).sum::<f64>() / k as f64;
        (cosine[k], sine[k]) = (-by(&sine), by(&cosine));
    }
    [cosine, sine]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of x = 0.3 + 2*t - t^2.
    #[test]
    fn the_jet_of_a_sine_is_its_taylor_series() {
        let x = [0.3, 2.0, -1.0, 0.0, 0.0];
        let [cosine, sine] = cosine_and_sine(&x);
        for h in [1e-2, -2e-2] {
            let sum = |jet: &Jet| jet.iter().rev().fold(0.0, |sum, term| sum * h + term);
            let exact = sum(&x);
            // The first term that is left out.
            let left: f64 = 10.0 * f64::abs(h).powi(5);
            assert!((sum(&cosine) - exact.cos()).abs() < left && (sum(&sine) - exact.sin()).abs() < left);
        }
    }

    #[test]
    fn derivatives_and_jet_are_inverse() {
        let values = [1.0, -2.0, 3.0, -4.0, 5.0];
        assert_eq!(derivatives(&of_derivatives(values)), values);
        assert_eq!(of_derivatives(values)[4], 5.0 / 24.0);
    }
}
