//! Where all nodes of the mesh are, in real time: displacement from torque and wave-generator angle.
//!
//! ```text
//! radial     A_j*cos(2b_i)
//! tangential B_j*sin(2b_i) + T_j*tau + P_j*phi     b_i = 2*pi*i/N - (theta_wg - theta_fs)
//! axial      C_j*cos(2b_i)
//! ```
//!
//! tau (N m) is the torque through the shell, phi (rad) the torsion, of which P_j is 0 but where the bend links harden; node i of slice j counted from the rim, lengths in m, from the round,
//! unloaded cup, seen from the flange: [`Reduced::displacement`] for every node at once.
//!
//! One sine and cosine in all: from a node to the next 2b grows by 4*pi/N, a rotation by a fixed angle, four
//! multiplications. Its rounding grows with the nodes passed, below N units in the last place of the ellipse. No state.

use crate::angle::Angle;
use crate::flexspline::Reduced;
use crate::real::Real;

/// The shapes of a condensed N x M mesh, and the rotation from one node to the next.
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::Angle;
/// use strainwave::flexspline::{DisplacementField, Reduced};
///
/// let cup = Reduced::<f32, 8, 3>::build(&JOINT.gear.flexspline, JOINT.gear.rated_torque)?;
/// let field = DisplacementField::build(&cup).at(40.0, cup.torsion(40.0), Angle::from_radians(0.0));
/// let [radial, ..] = field[0][0]; // the rim's node on the major axis
/// assert!((radial - JOINT.gear.flexspline.cup.ellipse).abs() < 1e-9); // m
/// assert_eq!(field[2][5], [0.0; 3]); // the flange is rigid
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplacementField<R, const N: usize, const M: usize> {
    /// Tangential displacement of every slice per torque (m/(N m)).
    twist: [R; M],
    /// The same per torsion (m/rad).
    leading: [R; M],
    /// A, B, C of every slice (m).
    ellipse: [[R; 3]; M],
    /// Sine and cosine of 4*pi/N.
    next: (R, R),
}

impl<R: Real, const N: usize, const M: usize> DisplacementField<R, N, M> {
    /// The field of this mesh.
    pub fn build(cup: &Reduced<R, N, M>) -> Self {
        let twist = cup.twist.map(|[_, tangential, _]| tangential);
        let leading = cup.leading();
        Self {
            twist,
            leading,
            ellipse: cup.ellipse(),
            next: Angle::from_turn_fraction(2, N as i32).sin_cos(),
        }
    }

    /// Radial, tangential and axial displacement of node i of slice j (m), by `[j][i]`, at a torque (N m), a torsion
    /// (rad) and a wave-generator angle, seen from the flange.
    #[inline(never)] // The timing budget counts it by its symbol.
    pub fn at(&self, torque: R, torsion: R, wave_generator: Angle<R>) -> [[[R; 3]; N]; M] {
        let turned: [R; M] = core::array::from_fn(|j| self.twist[j] * torque + self.leading[j] * torsion);
        let (sine, cosine) = R::sin_cos_phase(wave_generator.phase().wrapping_mul(2));
        let mut twice = (-sine, cosine);
        let mut field = [[[R::ZERO; 3]; N]; M];
        for i in 0..N {
            let (sine, cosine) = twice;
            for ((slice, ellipse), turned) in field.iter_mut().zip(&self.ellipse).zip(&turned) {
                let [radial, tangential, axial] = *ellipse;
                slice[i] = [radial * cosine, tangential * sine + *turned, axial * cosine];
            }
            twice = rotated(twice, self.next);
        }
        field
    }
}

/// Sine and cosine of the sum of two angles.
#[inline(always)]
fn rotated<R: Real>((sine, cosine): (R, R), (by_sine, by_cosine): (R, R)) -> (R, R) {
    (sine * by_cosine + cosine * by_sine, cosine * by_cosine - sine * by_sine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;
    use crate::flexspline::{FlexsplineParams, Hardening};
    use proptest::prelude::*;

    /// Largest distance of a coordinate from the node's own displacement (m).
    fn worst<const N: usize, const M: usize>(hardening: Hardening, torque: f64, counts: i64) -> f64 {
        let params = FlexsplineParams { hardening, ..SIZE_25 };
        let cup = Reduced::<f64, N, M>::build(&params, 67.0).unwrap();
        let angle = Angle::from_counts(counts);
        let field = DisplacementField::build(&cup).at(torque, cup.torsion(torque), angle);
        let nodes = (0..M).flat_map(|j| (0..N).map(move |i| (i, j)));
        nodes.fold(0.0, |worst, (i, j)| {
            let alone = cup.displacement((i, j), torque, angle).unwrap();
            field[j][i].iter().zip(alone).fold(worst, |worst: f64, (a, b)| worst.max((a - b).abs()))
        })
    }

    proptest! {
        #[test]
        fn it_is_every_nodes_own_displacement(torque in -300.0..300.0f64, counts: i64) {
            for hardening in [Hardening::Contact, Hardening::Bends] {
                prop_assert!(worst::<8, 3>(hardening, torque, counts) < 1e-17);
                // A 36th of a revolution is no whole number of counts, to which a node alone rounds: 2*1.5e-9 rad of the ellipse.
                prop_assert!(worst::<36, 4>(hardening, torque, counts) < 1e-12);
            }
        }

        /// Neither the ellipse nor its rotation turns the rim in the mean: that is the torque's part.
        #[test]
        fn the_mean_rotation_is_the_torques(torque in -300.0..300.0f64, counts: i64) {
            let cup = Reduced::<f64, 8, 3>::build(&SIZE_25, 67.0).unwrap();
            let field = DisplacementField::build(&cup).at(torque, cup.torsion(torque), Angle::from_counts(counts));
            for (slice, twist) in field.iter().zip(cup.twist()) {
                let mean = slice.iter().map(|[_, tangential, _]| tangential).sum::<f64>() / 8.0;
                prop_assert!((mean - twist * torque * SIZE_25.cup.radius).abs() < 1e-17);
            }
        }
    }
}
