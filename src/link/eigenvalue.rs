//! Eigenvalues lambda of a beam that is clamped at one end and carries a payload at the other.
//!
//! ```text
//! 1 + C*c + m*lambda*(c*S - s*C) - j*lambda^3*(c*S + s*C) + m*j*lambda^4*(1 - c*C) = 0
//! c, s = cos, sin(lambda)    C, S = cosh, sinh(lambda)    m = M/(mu*L)    j = J/(mu*L^3)
//! omega = lambda^2*sqrt(EI/(mu*L^4))
//! ```
//!
//! Roots may lie close to each other, so that none is looked for by a change of sign. Wittrick and Williams count the
//! eigenvalues below any lambda without a miss:
//!
//! ```text
//! count = (those of the beam clamped at both ends) + (negative eigenvalues of the tip's dynamic stiffness)
//! k_ww = lambda^3*(s*C + c*S)/(1 - c*C) - m*lambda^4        det k = lambda^4*(characteristic function)/(1 - c*C)
//! ```
//!
//! and bisection of the count finds each to rounding. All without unit, divided by C, so that no lambda overflows.
//!
//! W. Wittrick, F. Williams, "A general algorithm for computing natural frequencies of elastic structures", Quarterly
//! Journal of Mechanics and Applied Mathematics 24 (1971).

use core::f64::consts::PI;

use crate::elementary::double;

/// Below the first eigenvalue of any payload that a link may have: lambda^-4 <= m/3 + j + 0.081.
const LEAST: f64 = 0.1;
/// Halvings of an interval: to the last bit from any width.
const HALVINGS: usize = 80;

/// Payload in terms of the beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Payload {
    /// m.
    pub mass: f64,
    /// j.
    pub inertia: f64,
}

/// The eigenvalue of a mode, counted from 0.
pub(super) fn eigenvalue(mode: usize, payload: Payload) -> f64 {
    // The cantilever's own, which no payload raises, are below (mode + 1)*pi.
    let (mut low, mut high) = (LEAST, PI * (mode + 1) as f64);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if below(middle, payload) > mode { high = middle } else { low = middle }
    }
    high
}

/// Eigenvalues below `lambda`.
fn below(lambda: f64, Payload { mass: m, inertia: j }: Payload) -> usize {
    let e = double::exp(-lambda);
    let inverse = 1.0 / (1.0 + e * e);
    let (sech, tanh) = (2.0 * e * inverse, (1.0 - e * e) * inverse);
    let (sin, cos) = double::sin_cos(lambda);
    let clamped = sech - cos;
    let square = lambda * lambda;
    let characteristic = sech + cos + m * lambda * (cos * tanh - sin)
        - j * square * lambda * (cos * tanh + sin)
        + m * j * square * square * clamped;
    let stiffness = sin + cos * tanh - m * lambda * clamped;
    clamped_below(lambda, clamped) + negatives(stiffness * clamped, characteristic * clamped)
}

/// Eigenvalues of the beam clamped at both ends, the roots of 1 - c*C; there is one in each interval of pi but the first.
fn clamped_below(lambda: f64, clamped: f64) -> usize {
    let whole = (lambda / PI) as usize;
    let passed = (clamped > 0.0) == whole.is_multiple_of(2);
    whole - usize::from(whole > 0 && !passed)
}

/// Negative eigenvalues of a symmetric matrix of order 2 with a corner and a determinant of these signs.
fn negatives(corner: f64, determinant: f64) -> usize {
    match (determinant < 0.0, corner < 0.0) {
        (true, _) => 1,
        (false, true) => 2,
        (false, false) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cantilever without payload, and one whose tip a large payload clamps.
    #[test]
    fn the_ends_of_the_range_are_the_textbook_s() {
        let of = |mode, mass, inertia| eigenvalue(mode, Payload { mass, inertia });
        let free =
            [1.875_104_068_711_961, 4.694_091_132_974_175, 7.854_757_438_237_613, 10.995_540_734_875_467];
        for (mode, expected) in free.into_iter().enumerate() {
            assert!((of(mode, 0.0, 0.0) / expected - 1.0).abs() < 1e-14, "{mode}");
        }
        // Clamped at both ends; the payload itself has the first two.
        assert!((of(2, 1e3, 1e3) / 4.730_040_744_862_704 - 1.0).abs() < 1e-3);
        // Mass alone: clamped and pinned.
        assert!((of(1, 1e3, 0.0) / 3.926_602_312_047_919 - 1.0).abs() < 1e-3);
        // A massless beam with a mass: omega^2 = 3*EI/(M*L^3).
        assert!((of(0, 1e3, 0.0).powi(4) / (3.0 / (1e3 + 33.0 / 140.0)) - 1.0).abs() < 1e-5);
    }

    /// Every eigenvalue is a root, they rise with the mode and fall with the payload.
    #[test]
    fn each_is_a_root_and_no_payload_raises_it() {
        let sizes = [0.0, 1e-3, 0.03, 0.2, 1.0, 7.0, 100.0, 1e3];
        for (m, j) in sizes.into_iter().flat_map(|m| sizes.map(|j| (m, j))) {
            let found: [f64; 8] =
                core::array::from_fn(|mode| eigenvalue(mode, Payload { mass: m, inertia: j }));
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{m} {j}: {found:?}");
            for (mode, lambda) in found.into_iter().enumerate() {
                let (s, c) = libm::sincos(lambda);
                let (sinh, cosh) = (lambda.sinh(), lambda.cosh());
                let terms = [
                    1.0 + cosh * c,
                    m * lambda * (c * sinh - s * cosh),
                    -j * lambda.powi(3) * (c * sinh + s * cosh),
                    m * j * lambda.powi(4) * (1.0 - c * cosh),
                ];
                // What each term is the difference of.
                let size = cosh * (1.0 + m * lambda) * (1.0 + j * lambda.powi(3));
                assert!(terms.iter().sum::<f64>().abs() < 1e-14 * size * lambda, "{m} {j} {mode}: {terms:?}");
                let heavier = eigenvalue(mode, Payload { mass: 1.1 * m + 1e-4, inertia: 1.1 * j + 1e-4 });
                assert!(heavier < lambda, "{m} {j} {mode}");
            }
        }
    }
}
