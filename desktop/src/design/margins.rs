//! Margins of an open loop L over frequency, for a closed loop 1/(1 + L) that is stable.
//!
//! ```text
//! gain    least 20*|log10|L|| where L crosses the negative real axis, upwards and downwards
//! phase   least angle between L and -1 where |L| = 1
//! delay   least (angle from L clockwise to -1)/w where |L| = 1
//! size    max|L|
//! ```
//!
//! Crossings are interpolated between two frequencies: log|L| and its phase linear. Whether the closed loop is stable is not
//! tested here, but by its poles ([`super::poles`]). Units: dB, rad, s.
//!
//! K. Astrom, R. Murray, "Feedback Systems" (2008), section 9.3.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

/// Margins; infinite where nothing is crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// By how much the gain may rise or fall (dB).
    pub gain: f64,
    /// (rad)
    pub phase: f64,
    /// (s)
    pub delay: f64,
    /// Largest |L|.
    pub size: f64,
    /// Highest frequency with |L| = 1 (rad/s); 0 where there is none.
    pub crossover: f64,
}

/// Angle from L clockwise to -1, 0..2*pi.
fn to_critical(l: Complex<f64>) -> f64 {
    (l.arg() + PI).rem_euclid(TAU)
}

impl Margins {
    const NONE_CROSSED: Self =
        Self { gain: f64::INFINITY, phase: PI, delay: f64::INFINITY, size: 0.0, crossover: 0.0 };

    /// |L| = 1 at w, with this angle to -1.
    fn cross_one(&mut self, omega: f64, critical: f64) {
        self.phase = self.phase.min(critical.min(TAU - critical));
        self.delay = self.delay.min(critical / omega);
        self.crossover = omega;
    }
}

/// Margins of L at rising frequencies (rad/s).
pub fn margins(points: &[(f64, Complex<f64>)]) -> Margins {
    let mut found = Margins::NONE_CROSSED;
    found.size = points.iter().map(|(_, l)| l.norm()).fold(0.0, f64::max);
    for pair in points.windows(2) {
        let ((w, a), (v, b)) = (pair[0], pair[1]);
        let (size, change) = (a.norm().ln(), (b.norm() / a.norm()).ln());
        let rotation = (b / a).arg();
        if size * (size + change) <= 0.0 && change != 0.0 {
            let fraction = -size / change;
            let there = Complex::from_polar(1.0, a.arg() + fraction * rotation);
            found.cross_one(w * (v / w).powf(fraction), to_critical(there));
        }
        let angle = to_critical(a);
        let from = if angle > PI { angle - TAU } else { angle };
        if from * (from + rotation) <= 0.0 && rotation != 0.0 && from.abs() < 0.5 * PI {
            let there = size - from / rotation * change;
            found.gain = found.gain.min(20.0 / 10f64.ln() * there.abs());
        }
    }
    found
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

    /// g/(s+1)^3 has the gain margin 8/g; with g = 20 it is 2.5 downwards.
    #[test]
    fn three_lags_bear_a_gain_of_eight() {
        let third = |g: f64| margins(&grid(|s| g / ((s + 1.0) * (s + 1.0) * (s + 1.0))));
        assert!((third(4.0).gain - 20.0 * 2f64.log10()).abs() < 1e-3);
        assert!((third(20.0).gain - 20.0 * 2.5f64.log10()).abs() < 1e-3);
    }

    /// A delay takes w*T off the phase and leaves the rest.
    #[test]
    fn a_delay_takes_itself_off_the_delay_margin() {
        let late = |time: f64| margins(&grid(|s| 20.0 / s * (-s * time).exp()));
        assert!((late(0.0).delay - late(0.01).delay - 0.01).abs() < 1e-5);
        assert!((late(0.01).gain - 20.0 * (0.5 * PI / 0.2).log10()).abs() < 1e-2);
    }
}
