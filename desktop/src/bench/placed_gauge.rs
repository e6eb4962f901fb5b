//! A strain gauge as it is glued onto a cup: somewhat off its place and direction, with a gain and an offset of its own.
//!
//! ```text
//! reading = gain*(strain where it is) + offset + noise
//! ```
//!
//! The literal mesh has strain along its links only. Between them it is linear in place: around towards the next node, along towards
//! the next slice. In direction it is that of a plane, with the strains around and along, x and z, and the shear that the
//! link itself shows:
//!
//! ```text
//! strain(a) = x*cos(a)^2 + z*sin(a)^2 + shear*sin(a)*cos(a)          a = the angle to the circumference
//! d strain/da = (z - x)*sin(2a) + shear*cos(2a)
//! ```
//!
//! so that a reading is a sum of strains of [`LINKS`] links. Strain without unit, lengths in m, angles in rad.

use rand::{Rng, RngExt};
use strainwave::flexspline::Cup;
use strainwave::flexspline::reduced::{Direction, Node};

use crate::plant::NODES;
use crate::plant::two_port::Gauge;

/// Largest error of the gain.
pub const GAIN: f64 = 0.1;
/// Largest misplacement around and along (m).
pub const MISPLACED: f64 = 0.2e-3;
/// Largest error of the direction (rad): 1 degree.
pub const TURNED: f64 = 0.017_453_3;
/// Largest offset (strain): half of what rated torque strains.
pub const OFFSET: f64 = 1e-4;
/// Standard deviation of the noise of a reading (strain).
pub const NOISE: f64 = 1e-6;

/// Links whose strains make a reading: the gauge's own, the same a node further around and a slice further along, and the
/// two that lie around and along at its node.
pub const LINKS: usize = 5;

/// What is wrong with a gauge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flaws {
    /// Gain.
    pub gain: f64,
    /// Offset (strain).
    pub offset: f64,
    /// Weights of the links' strains, of [`links`].
    weights: [f64; LINKS],
}

/// The links of a gauge that spans (1, 1) or (-1, 1) from `node`; the slice beyond it is on the cup.
pub fn links((i, j): Node, direction: Direction) -> [Gauge; LINKS] {
    let gauge = |node, direction| Gauge { node, direction };
    [
        gauge((i, j), direction),
        gauge(((i + 1) % NODES.0, j), direction),
        gauge((i, j + 1), direction),
        gauge((i, j), (1, 0)),
        gauge((i, j), (0, 1)),
    ]
}

impl Flaws {
    /// No flaw.
    pub const NONE: Self = Self { gain: 1.0, offset: 0.0, weights: [1.0, 0.0, 0.0, 0.0, 0.0] };

    /// Draws what is wrong with a gauge of this direction.
    pub fn draw(cup: &Cup<f64>, direction: Direction, random: &mut impl Rng) -> Self {
        let mut within = |largest: f64| random.random_range(-largest..largest);
        let (gain, offset) = (1.0 + within(GAIN), within(OFFSET));
        let (around, along, turned) = (within(MISPLACED), within(MISPLACED), within(TURNED));
        Self { gain, offset, weights: weights(cup, direction, [around, along], turned) }
    }

    /// The reading, without noise.
    pub fn reading(&self, strains: &[f64]) -> f64 {
        let strain = self.weights.iter().zip(strains).map(|(weight, strain)| weight * strain).sum::<f64>();
        self.gain * strain + self.offset
    }
}

/// Weights of the links for a gauge that is off its place around and along, and turned.
fn weights(cup: &Cup<f64>, direction: Direction, [around, along]: [f64; 2], turned: f64) -> [f64; LINKS] {
    let slice = cup.length / (NODES.1 - 1) as f64;
    let node = 2.0 * cup.radius * (std::f64::consts::PI / NODES.0 as f64).sin();
    let (around, along) = (around / node, along / slice);
    let angle = slice.atan2(node * f64::from(direction.0));
    let (sine, cosine) = angle.sin_cos();
    let ((double_sine, double_cosine), mixed) = ((2.0 * angle).sin_cos(), sine * cosine);
    // Shear is what the link shows beyond x and z.
    let of_link = double_cosine / mixed;
    let of_around = -double_sine - cosine * cosine * of_link;
    let of_along = double_sine - sine * sine * of_link;
    [1.0 - around - along + turned * of_link, around, along, turned * of_around, turned * of_along]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::gear_params;
    use crate::io::gear_file::GearFile;

    #[test]
    fn a_turned_gauge_reads_a_plane_strain_in_its_direction() {
        let cup = gear_params::<f64>(&GearFile::default_gear()).flexspline.cup;
        let [x, z, shear] = [3e-4, -1e-4, 5e-4];
        let strain = |a: f64| x * a.cos().powi(2) + z * a.sin().powi(2) + shear * a.sin() * a.cos();
        let slice = cup.length / 3.0;
        let node = 2.0 * cup.radius * (std::f64::consts::PI / 36.0).sin();
        for direction in [(1, 1), (-1, 1)] {
            let angle = slice.atan2(node * f64::from(direction.0));
            let strains = [strain(angle), strain(angle), strain(angle), x, z];
            let turned = 1e-4;
            let weights = weights(&cup, direction, [0.1e-3, -0.2e-3], turned);
            let read: f64 = weights.iter().zip(strains).map(|(weight, strain)| weight * strain).sum();
            assert!((read - strain(angle + turned)).abs() < 1e-11, "{direction:?}");
        }
    }
}
