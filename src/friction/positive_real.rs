//! Whether eq. (8) can give work: the test of its transfer function, for `build` only.
//!
//! ```text
//! G(p) = C (p*I - A)^-1 B = N(p)/D(p)           positive real:  Re G(j*w) >= 0 for all w >= 0
//! ```
//!
//! In the path length s, eq. (8) is a linear system from u = sign(v) to F, and the work lost is the
//! integral of F*u ds. With A Hurwitz, it is not negative from rest for any u exactly where G is positive
//! real (Parseval; Bliman and Sorine 1995). So a model that passes loses work over any motion that starts
//! at rest.
//!
//! N and D follow by Faddeev and LeVerrier's recursion; Re G has the sign of the polynomial q(w^2) = Re
//! N(j*w) D(-j*w) of degree P - 1. With w^2 = t/(1 - t), q >= 0 on 0..=1 is decided in Bernstein form:
//! coefficients that are all at least 0 prove it, a negative end value disproves it, and else the interval
//! is halved. Each coefficient of q is first raised by [`TOLERANCE`] of its terms' magnitude, so that a
//! system that just touches zero passes; what is certified is therefore Re G >= 0 to that fraction of
//! rounding. All in f64.

/// Fraction of the magnitude of a coefficient's terms that is taken for rounding.
pub const TOLERANCE: f64 = 1e-9;
/// Most intervals that are looked at.
const INTERVALS: usize = 10_000;

pub(super) type Matrix<const P: usize> = [[f64; P]; P];

pub(super) fn product<const P: usize>(a: &Matrix<P>, b: &Matrix<P>) -> Matrix<P> {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..P).map(|k| a[i][k] * b[k][j]).sum()))
}

pub(super) fn times<const P: usize>(a: &Matrix<P>, x: &[f64; P]) -> [f64; P] {
    core::array::from_fn(|i| dot(&a[i], x))
}

fn dot<const P: usize>(x: &[f64; P], y: &[f64; P]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Largest sum of magnitudes of a row.
pub(super) fn norm<const P: usize>(a: &Matrix<P>) -> f64 {
    let rows = a.iter().map(|row| row.iter().map(|entry| entry.abs()).sum());
    rows.fold(0.0, f64::max)
}

/// Re G(j*w) >= 0 for all w, for an A that is Hurwitz.
pub(super) fn is_positive_real<const P: usize>(a: &Matrix<P>, b: &[f64; P], c: &[f64; P]) -> bool {
    let scale = norm(a);
    let a = a.map(|row| row.map(|entry| entry / scale));
    let (numerator, denominator) = transfer(&a, b, c);
    is_non_negative(bernstein(real_part(&numerator, &denominator)))
}

/// Coefficients of N and of D by rising power; D has a leading 1 besides.
fn transfer<const P: usize>(a: &Matrix<P>, b: &[f64; P], c: &[f64; P]) -> ([f64; P], [f64; P]) {
    let (mut numerator, mut denominator) = ([0.0; P], [0.0; P]);
    let mut adjugate: Matrix<P> = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(i == j)));
    for power in (0..P).rev() {
        numerator[power] = dot(c, &times(&adjugate, b));
        let mut next = product(a, &adjugate);
        let trace: f64 = (0..P).map(|i| next[i][i]).sum();
        denominator[power] = -trace / (P - power) as f64;
        (0..P).for_each(|i| next[i][i] += denominator[power]);
        adjugate = next;
    }
    (numerator, denominator)
}

/// Coefficients of q, raised by the tolerance.
fn real_part<const P: usize>(numerator: &[f64; P], denominator: &[f64; P]) -> [f64; P] {
    let mut q = [0.0; P];
    for (k, n) in numerator.iter().enumerate() {
        // j^k * (-j)^l is real where k - l is even, and then +-1.
        for l in (k % 2..=P).step_by(2) {
            let term = n * denominator.get(l).unwrap_or(&1.0);
            let sign = if (k + 3 * l) % 4 == 0 { 1.0 } else { -1.0 };
            let (signed, rounding) = (sign * term, TOLERANCE * term.abs());
            q[usize::midpoint(k, l)] += signed + rounding;
        }
    }
    q
}

/// Bernstein coefficients on 0..=1 of (1 - t)^(P - 1) * q(t/(1 - t)).
fn bernstein<const P: usize>(mut q: [f64; P]) -> [f64; P] {
    let mut binomial = 1.0;
    for (k, coefficient) in q.iter_mut().enumerate() {
        *coefficient /= binomial;
        binomial *= (P - 1 - k) as f64 / (k + 1) as f64;
    }
    q
}

/// Halves of a polynomial in Bernstein form, by de Casteljau.
fn halves<const P: usize>(mut right: [f64; P]) -> [[f64; P]; 2] {
    let mut rest = P;
    let left = core::array::from_fn(|_| {
        let first = right[0];
        rest -= 1;
        (0..rest).for_each(|i| right[i] = f64::midpoint(right[i], right[i + 1]));
        first
    });
    [left, right]
}

/// Depth first: the intervals that wait are the right halves of those above, at most one a depth.
fn is_non_negative<const P: usize>(whole: [f64; P]) -> bool {
    const DEPTH: usize = 100;
    let mut waiting = [[0.0; P]; DEPTH];
    let (mut count, mut piece) = (0, whole);
    for _ in 0..INTERVALS {
        if piece[0] < 0.0 || piece[P - 1] < 0.0 {
            return false;
        }
        if piece.iter().all(|&coefficient| coefficient >= 0.0) {
            if count == 0 {
                return true;
            }
            count -= 1;
            piece = waiting[count];
        } else if count < DEPTH {
            let [left, right] = halves(piece);
            waiting[count] = right;
            count += 1;
            piece = left;
        } else {
            return false;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn diagonal<const P: usize>(distances: [f64; P], levels: [f64; P]) -> bool {
        let a = core::array::from_fn(|i| {
            core::array::from_fn(|j| if i == j { -1.0 / distances[i] } else { 0.0 })
        });
        let b = core::array::from_fn(|i| levels[i] / distances[i]);
        is_positive_real(&a, &b, &[1.0; P])
    }

    proptest! {
        /// Re G = f1/(1 + (eta*w)^2) - f2/(1 + w^2) is positive exactly where f1 > f2 and f1 > f2*eta^2.
        #[test]
        fn order_2_passes_exactly_where_its_closed_form_does(
            f1 in 0.1..2.0f64, f2 in 0.1..2.0f64, eta in 0.01..1.5f64, eps in 1e-6..1e3f64,
        ) {
            prop_assume!((f1 - f2).abs() > 1e-6 && (f1 - f2 * eta * eta).abs() > 1e-6);
            prop_assert_eq!(diagonal([eta * eps, eps], [f1, -f2]), f1 > f2 && f1 > f2 * eta * eta);
        }

        /// Three lags against a plain search over frequency.
        #[test]
        fn order_3_agrees_with_a_search(levels in prop::array::uniform3(-2.0..2.0f64)) {
            let distances = [1.0, 0.1, 0.01];
            let lag = |i: usize, w: f64| levels[i] / (1.0 + (w * distances[i]).powi(2));
            let frequencies = (-400..400).map(|k| 10f64.powf(f64::from(k) / 80.0));
            let real = frequencies.map(|w| (0..3).map(|i| lag(i, w)).sum::<f64>() * (1.0 + w * w));
            let least = real.fold(levels.iter().sum(), f64::min);
            prop_assume!(least.abs() > 1e-3);
            prop_assert_eq!(diagonal(distances, levels), least > 0.0);
        }
    }

    #[test]
    fn a_resonance_is_positive_real_from_its_velocity_only() {
        let a = [[0.0, 1.0], [-1.0, -0.1]];
        assert!(is_positive_real(&a, &[0.0, 1.0], &[0.0, 1.0]));
        assert!(!is_positive_real(&a, &[0.0, 1.0], &[1.0, 0.0]));
    }
}
