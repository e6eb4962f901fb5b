//! Margins of an open loop L over frequency, for a closed loop 1 + L that is stable.
//!
//! ```text
//! gain    20*log10|1/L| where L crosses the negative real axis: the nearest with |L| < 1 upwards, with |L| > 1 downwards
//! phase   least angle between L and -1 where |L| = 1
//! delay   least (angle from L clockwise to -1)/w where |L| = 1
//! modulus 1/max|S| = min|1 + L|
//! ```
//!
//! Crossings are interpolated between two frequencies: log|L| and its phase linear. Whether the closed loop is stable is not
//! asked here: its poles say so ([`super::poles`]). Units: dB, rad, s.
//!
//! K. Astrom, R. Murray, "Feedback Systems" (2008), section 9.3.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

/// Margins; infinite where nothing is crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// By how much the gain may rise (dB).
    pub gain: f64,
    /// By how much it may fall (dB).
    pub gain_down: f64,
    /// (rad)
    pub phase: f64,
    /// (s)
    pub delay: f64,
    /// Least |1 + L|.
    pub modulus: f64,
    /// Highest frequency with |L| = 1 (rad/s); 0 where there is none.
    pub crossover: f64,
}

/// Angle from L clockwise to -1, 0..2*pi.
fn to_critical(l: Complex<f64>) -> f64 {
    (l.arg() + PI).rem_euclid(TAU)
}

/// Margins of L at rising frequencies (rad/s).
pub fn margins(points: &[(f64, Complex<f64>)]) -> Margins {
    let infinite = f64::INFINITY;
    let mut m = Margins {
        gain: infinite,
        gain_down: infinite,
        phase: PI,
        delay: infinite,
        modulus: infinite,
        crossover: 0.0,
    };
    for (_, l) in points {
        m.modulus = m.modulus.min((1.0 + l).norm());
    }
    for pair in points.windows(2) {
        let ((w, a), (v, b)) = (pair[0], pair[1]);
        let (size, change) = (a.norm().ln(), (b.norm() / a.norm()).ln());
        let turn = (b / a).arg();
        if size * (size + change) <= 0.0 && change != 0.0 {
            let share = -size / change;
            let (omega, critical) =
                (w * (v / w).powf(share), to_critical(Complex::from_polar(1.0, a.arg() + share * turn)));
            m.phase = m.phase.min(critical.min(TAU - critical));
            m.delay = m.delay.min(critical / omega);
            m.crossover = omega;
        }
        let from = to_critical(a);
        let from = if from > PI { from - TAU } else { from };
        if from * (from + turn) <= 0.0 && turn != 0.0 && from.abs() < 0.5 * PI {
            let gain = -20.0 / 10f64.ln() * (size - from / turn * change);
            if gain >= 0.0 {
                m.gain = m.gain.min(gain);
            } else {
                m.gain_down = m.gain_down.min(-gain);
            }
        }
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(l: impl Fn(Complex<f64>) -> Complex<f64>) -> Vec<(f64, Complex<f64>)> {
        (0..2000)
            .map(|k| 0.1 * 10f64.powf(f64::from(k) * 0.0025))
            .map(|w| (w, l(Complex::new(0.0, w))))
            .collect()
    }

    /// (k + d*s)/s^2: |L| = 1 at w^2 = (d^2 + sqrt(d^4 + 4 k^2))/2, phase margin atan(d*w/k); no gain makes it unstable.
    #[test]
    fn a_double_integrator_with_pd_has_its_textbook_margins() {
        let (k, d) = (400.0f64, 28.0f64);
        let found = margins(&grid(|s| (k + d * s) / (s * s)));
        let omega = ((d * d + (d.powi(4) + 4.0 * k * k).sqrt()) / 2.0).sqrt();
        let phase = (d * omega / k).atan();
        assert!((found.crossover / omega - 1.0).abs() < 1e-4, "{found:?}");
        assert!((found.phase - phase).abs() < 1e-4);
        assert!((found.delay - phase / omega).abs() < 1e-4 * phase / omega);
        assert_eq!(found.gain, f64::INFINITY);
    }

    /// g/(s+1)^3 has the gain margin 8/g; with g = 20 the closed loop is unstable, and 2.5 less would do.
    #[test]
    fn three_lags_bear_a_gain_of_eight() {
        let third = |g: f64| margins(&grid(|s| g / ((s + 1.0) * (s + 1.0) * (s + 1.0))));
        assert!((third(4.0).gain - 20.0 * 2f64.log10()).abs() < 1e-3);
        assert!((third(20.0).gain_down - 20.0 * 2.5f64.log10()).abs() < 1e-3);
    }

    /// A delay turns the phase by w*T and leaves the rest.
    #[test]
    fn a_delay_takes_itself_off_the_delay_margin() {
        let late = |time: f64| margins(&grid(|s| 20.0 / s * (-s * time).exp()));
        assert!((late(0.0).delay - late(0.01).delay - 0.01).abs() < 1e-5);
        assert!((late(0.01).gain - 20.0 * (0.5 * PI / 0.2).log10()).abs() < 1e-2);
    }
}
