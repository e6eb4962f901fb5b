//! Error of the f32 torsion after a million revolutions.

use strainwave::real::RADIANS_PER_COUNT;
use strainwave::{Angle, Ratio};

use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Ratios r = 1/n that are measured: both arrangements, both ends of the range.
const RATIOS: [i32; 5] = [-100, 101, -30, 31, -320];
const REVOLUTIONS: i64 = 1_000_000;
/// Torsion at rated torque of the default gear (rad).
const LARGEST_TORSION: f64 = 1.5e-3;

pub(super) fn measure() -> Vec<Figure> {
    let worst = largest(RATIOS.map(worst_torsion_error));
    vec![bounds::figure("angle.torsion.million_turns", worst)]
}

fn worst_torsion_error(n: i32) -> f64 {
    let ratio = Ratio::one_over(n).expect("the ratio is in range");
    let most = (LARGEST_TORSION / RADIANS_PER_COUNT) as i64;
    largest((0..10_000).map(|k| {
        // Steps that are no divisor of a revolution, so that phases and remainders are all different.
        let wave_generator = (REVOLUTIONS << 32) + k * 4_294_007;
        let torsion = (k - 5_000) * most / 5_000;
        torsion_error(ratio, n, wave_generator, torsion)
    }))
}

/// With the flange `torsion` counts behind the whole counts of `wave_generator / n`, the exact torsion
/// is `torsion` and the remainder of that division.
fn torsion_error(ratio: Ratio, n: i32, wave_generator: i64, torsion: i64) -> f64 {
    let n = i64::from(n);
    let (whole, remainder) = (wave_generator.div_euclid(n), wave_generator.rem_euclid(n));
    let exact = (torsion as f64 + remainder as f64 / n as f64) * RADIANS_PER_COUNT;
    let flange = Angle::<f32>::from_counts(whole - torsion);
    let measured = ratio.apply(Angle::from_counts(wave_generator)).minus(flange);
    (f64::from(measured) - exact).abs()
}
