//! A strain gauge on the cup, in real time: one link of the reduced mesh, as a function of torque and angle.
//!
//! ```text
//! strain = constant + per_torque*tau + cosine*cos(2*t) + sine*sin(2*t) + cosine_4*cos(4*t) + sine_4*sin(4*t)
//! ```
//!
//! tau is the torque through the shell (N m), t = theta_wg - theta_fs the wave generator's angle seen from
//! the cup, which the gauge rotates with. Strain without unit, positive when the link is longer than in the round,
//! unloaded cup. No state; one sine and cosine a reading.
//!
//! The torque's part is linear; the ellipse displaces the link's ends by harmonic 2 ([`super::reduced`]), but the
//! link's length is not linear in that. With d the ends' relative displacement and l the link's direction,
//!
//! ```text
//! L/L0 - 1 = l.d/L0 + (|d|^2 - (l.d)^2)/(2*L0^2) + ...
//! ```
//!
//! the square gives a mean and a 4th harmonic. Size 25, largest over all links: 4.8e-3 by the ellipse, 1.9e-4 by
//! rated torque, 2.6e-4 mean, 5e-5 4th harmonic; without the square the strain's error is 1.0e-4, half of what
//! the rated torque makes. The five terms are the discrete Fourier series of [`Reduced::strain`]
//! over 8 angles, so that they hold all of it but the harmonics from the 6th on, below 1e-6.
//!
//! Neglected, against the settled literal mesh: the second-order displacement of the inner slices, which the
//! reduced mesh has not, 2.7e-5 (8 x 3) and 5.0e-5 (36 x 4), none of it along the rim; and the product of
//! torque and ellipse: rated torque takes 0.12 % off the ellipse's strain, 4e-6 (`verify flexspline`). In gauges a quarter of a
//! revolution apart that products have opposite signs, as the ellipse's 2nd harmonic has.

use crate::angle::Angle;
use crate::error::Error;
use crate::flexspline::Reduced;
use crate::flexspline::reduced::{Direction, Node};
use crate::real::Real;

/// Angles of the Fourier series over one period of the ellipse, half a revolution.
const SAMPLES: usize = 8;

/// The built gauge.
///
/// A gauge on the cup as a torque sensor: what is left when the strain by the ellipse has been taken off is the torque's.
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::Angle;
/// use strainwave::flexspline::{Reduced, StrainGauge};
///
/// let cup = Reduced::<f32, 36, 4>::build(&JOINT.gear.flexspline, JOINT.gear.rated_torque)?;
/// let gauge = StrainGauge::build(&cup, (0, 1), (1, 1))?;
/// for angle in [0.0, 0.4, 1.3, 2.9] {
///     let wave_generator = Angle::from_radians(angle);
///     let read = gauge.strain(30.0, wave_generator); // strain, without unit
///     let torque = (read - gauge.strain(0.0, wave_generator)) / gauge.per_torque;
///     assert!((torque - 30.0).abs() < 0.01);
/// }
/// assert!(gauge.cosine.hypot(gauge.sine) > (gauge.per_torque * 67.0).abs()); // the ellipse strains it more
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainGauge<R> {
    /// Mean strain without torque, by the ellipse.
    pub constant: R,
    /// Strain per torque (1/(N m)).
    pub per_torque: R,
    /// Amplitude of cos(2*t).
    pub cosine: R,
    /// Amplitude of sin(2*t).
    pub sine: R,
    /// Amplitude of cos(4*t).
    pub cosine_4: R,
    /// Amplitude of sin(4*t).
    pub sine_4: R,
}

impl<R: Real> StrainGauge<R> {
    /// A gauge along the link from `node` (i, j) of the cup that spans `direction` (around, along), either way.
    ///
    /// # Errors
    /// As [`Reduced::strain`].
    pub fn build<const N: usize, const M: usize>(
        cup: &Reduced<R, N, M>,
        node: Node,
        direction: Direction,
    ) -> Result<Self, Error> {
        let mut gauge = Self {
            constant: R::ZERO,
            per_torque: cup.strain_per_torque(node, direction)?,
            cosine: R::ZERO,
            sine: R::ZERO,
            cosine_4: R::ZERO,
            sine_4: R::ZERO,
        };
        for k in 0..SAMPLES as i32 {
            let angle = Angle::from_turn_fraction(k, 2 * SAMPLES as i32);
            gauge.add_sample(angle, cup.strain(node, direction, R::ZERO, angle)?);
        }
        Ok(gauge)
    }

    /// Adds a sample's term of the Fourier series.
    fn add_sample(&mut self, angle: Angle<R>, strain: R) {
        let weighted = strain * R::lit(1.0 / SAMPLES as f64);
        let ([cosine, sine], [cosine_4, sine_4]) = waves(angle);
        self.constant += weighted;
        for (amplitude, wave) in [
            (&mut self.cosine, cosine),
            (&mut self.sine, sine),
            (&mut self.cosine_4, cosine_4),
            (&mut self.sine_4, sine_4),
        ] {
            *amplitude += R::lit(2.0) * weighted * wave;
        }
    }

    /// Strain at a torque (N m) and a wave-generator angle, both seen from the cup.
    #[inline]
    pub fn strain(&self, torque: R, wave_generator: Angle<R>) -> R {
        let ([cosine, sine], [cosine_4, sine_4]) = waves(wave_generator);
        self.constant
            + self.per_torque * torque
            + self.cosine * cosine
            + self.sine * sine
            + self.cosine_4 * cosine_4
            + self.sine_4 * sine_4
    }
}

/// Cosine and sine of two and of four times an angle.
#[inline(always)]
fn waves<R: Real>(angle: Angle<R>) -> ([R; 2], [R; 2]) {
    let (sine, cosine) = R::sin_cos_phase(angle.phase().wrapping_mul(2));
    ([cosine, sine], [cosine * cosine - sine * sine, R::lit(2.0) * sine * cosine])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;
    use proptest::prelude::*;

    proptest! {
        /// The series holds the reduced mesh's strain but for its harmonics from the 6th on.
        #[test]
        fn the_series_is_the_strain_of_the_reduced_mesh(
            i in 0..36usize,
            j in 0..4usize,
            direction in (-2..=2i32, -2..=2i32),
            torque in -67.0..67.0f64,
            counts: i64,
        ) {
            let cup = Reduced::<f64, 36, 4>::build(&SIZE_25, 67.0).unwrap();
            let angle = Angle::from_counts(counts);
            let Ok(exact) = cup.strain((i, j), direction, torque, angle) else { return Ok(()) };
            let series = StrainGauge::build(&cup, (i, j), direction).unwrap().strain(torque, angle);
            prop_assert!((series - exact).abs() < 1e-6, "{} against {}", series, exact);
        }

        #[test]
        fn it_repeats_every_half_turn_of_the_wave_generator(counts in 0..1i64 << 40, torque in -300.0..300.0f64) {
            let cup = Reduced::<f64, 8, 3>::build(&SIZE_25, 67.0).unwrap();
            let gauge = StrainGauge::build(&cup, (3, 0), (1, 1)).unwrap();
            let at = |counts| gauge.strain(torque, Angle::from_counts(counts));
            prop_assert_eq!(at(counts), at(counts + (1 << 31)));
        }
    }

    #[test]
    fn opposite_diagonals_feel_torque_alike_with_opposite_signs() {
        let cup = Reduced::<f64, 8, 3>::build(&SIZE_25, 67.0).unwrap();
        let [right, left] =
            [(1, 1), (-1, 1)].map(|d| StrainGauge::build(&cup, (2, 0), d).unwrap().per_torque);
        assert!(right < 0.0 && (right + left).abs() < 1e-15, "{right} {left}");
        let back = StrainGauge::build(&cup, (3, 1), (-1, -1)).unwrap().per_torque;
        assert_eq!(back, right, "a link has two ends and one strain");
        let around = StrainGauge::build(&cup, (2, 1), (1, 0)).unwrap();
        assert_eq!(around.per_torque, 0.0);
    }

    #[test]
    fn a_gauge_that_is_not_on_the_cup_is_refused_by_name() {
        let cup = Reduced::<f64, 8, 3>::build(&SIZE_25, 67.0).unwrap();
        let refused = |node, direction| StrainGauge::build(&cup, node, direction).err();
        assert_eq!(refused((8, 0), (1, 0)), Some(Error::OutOfRange("node")));
        assert_eq!(refused((0, 3), (1, 0)), Some(Error::OutOfRange("node")));
        assert_eq!(refused((0, 2), (0, 1)), Some(Error::OutOfRange("direction")));
        assert_eq!(refused((0, 0), (0, -1)), Some(Error::OutOfRange("direction")));
        for direction in [(3, 0), (0, 0), (1, 2), (i32::MIN, i32::MAX)] {
            assert_eq!(refused((0, 0), direction), Some(Error::OutOfRange("direction")));
        }
    }
}
