//! The mesh's settled shape from its ends: one harmonic of the ring at a time, the inner slices condensed.
//!
//! A node that is displaced by (radial, tangential, axial) lengthens its links; to first order in the
//! displacement a link of half angle a, length L and unit vector (tangential t, axial z) gains
//!
//! ```text
//! e = t*((r_far + r_near)*sin(a) + (t_far - t_near)*cos(a)) + z*(z_far - z_near)
//! ```
//!
//! Every link is the same all around, so eq. (6) at rest is block-circulant and a discrete Fourier transform
//! decouples its harmonics. In harmonic m the displacement of slice j at the angle b from the main axis is
//!
//! ```text
//! radial A_j*cos(m*b),   tangential B_j*sin(m*b),   axial C_j*cos(m*b)
//! ```
//!
//! (the mirrored forms, sin for cos, are the same shape turned by a quarter of a wave: a ring of n > 2*m nodes
//! separates them, whatever its n). A link whose middle stands at b then gains `p*cos(m*b) + q*sin(m*b)`
//! with p and q linear in the three amplitudes of its two slices, and the energy of the n links of a direction
//! is k*n/4*(p^2 + q^2), twice that for m = 0. That leaves 3 unknowns a slice; those of the inner slices are
//! eliminated (static condensation, R. Guyan, "Reduction of stiffness and mass matrices", AIAA Journal 3,
//! 1965), with the rim's prescribed and the flange's zero.
//!
//! Torsion is the tangential part of harmonic 0, which the mirror symmetry of the ring keeps apart from the
//! radial and axial parts; the wave generator's ellipse is harmonic 2. Lengths in m. For `build` only:
//! Gauss-Jordan, (3*(m - 2))^2*3*m multiplications and a matrix of 9*m^2 values; m here counts slices.

use crate::angle::Angle;
use crate::flexspline::cup::{Cup, DIRECTIONS, is_bend, link_length};
use crate::flexspline::shell::link_law::Bend;
use crate::real::Real;

/// Radial, tangential and axial displacement (m), or its amplitudes A, B, C.
pub(super) type Displacement<R> = [R; 3];

/// Amplitudes of every slice.
pub(super) type Shape<R, const M: usize> = [Displacement<R>; M];

/// Force on a slice, by component, per displacement of every slice, by component; in units of k.
pub(super) type Stiffness<R, const M: usize> = [[Shape<R, M>; 3]; M];

/// A link of the round, unloaded ring.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link<R> {
    around: i32,
    along: usize,
    pub(super) length: R,
    /// Sine and cosine of half the angle that it spans.
    half: (R, R),
    /// Its unit vector, in the frame that stands at its middle.
    tangential: R,
    axial: R,
}

impl<R: Real> Link<R> {
    /// A link of one of the [`DIRECTIONS`] in a mesh of n nodes around and m slices.
    pub(super) fn new(cup: &Cup<R>, n: usize, m: usize, (around, along): (i32, usize)) -> Self {
        let spacing = cup.length / R::from_i32(m as i32 - 1);
        let length = link_length(cup, n, spacing, (around, along));
        let half = Angle::from_turn_fraction(around, 2 * n as i32).sin_cos();
        Self {
            around,
            along,
            length,
            half,
            tangential: R::lit(2.0) * cup.radius * half.0 / length,
            axial: spacing * R::from_i32(along as i32) / length,
        }
    }

    /// Displacement of the far node less that of the near one, in the frame at the link's middle.
    fn relative(&self, near: Displacement<R>, far: Displacement<R>) -> Displacement<R> {
        let (sine, cosine) = self.half;
        [
            (far[0] - near[0]) * cosine - (far[1] + near[1]) * sine,
            (far[0] + near[0]) * sine + (far[1] - near[1]) * cosine,
            far[2] - near[2],
        ]
    }

    /// Elongation of the link, to first order (m).
    fn elongation(&self, near: Displacement<R>, far: Displacement<R>) -> R {
        let [_, tangential, axial] = self.relative(near, far);
        self.tangential * tangential + self.axial * axial
    }

    /// Strain L/L0 - 1, to first order.
    pub(super) fn linear_strain(&self, near: Displacement<R>, far: Displacement<R>) -> R {
        self.elongation(near, far) / self.length
    }

    /// Strain L/L0 - 1, exact: with L^2 = L0^2*(1 + q) it is q/(1 + sqrt(1 + q)), which loses no digits.
    pub(super) fn strain(&self, near: Displacement<R>, far: Displacement<R>) -> R {
        let square = self.relative(near, far).into_iter().fold(R::ZERO, |sum, d| sum + d * d);
        let growth = R::lit(2.0) * self.elongation(near, far) * self.length + square;
        let q = growth / (self.length * self.length);
        q / (R::ONE + (R::ONE + q).sqrt())
    }

    /// p and q of a harmonic, each per amplitude of the near and of the far slice.
    fn rows(&self, n: usize, order: i32) -> [[Displacement<R>; 2]; 2] {
        // The near node stands half the link's angle before the middle, the far one as much past it.
        let (sine, cosine) = Angle::from_turn_fraction(order * self.around, 2 * n as i32).sin_cos();
        [
            self.row([cosine, -sine, cosine], [cosine, sine, cosine]),
            self.row([sine, cosine, sine], [-sine, cosine, -sine]),
        ]
    }

    /// Largest elongation, around the ring, of these links in a harmonic of these amplitudes (m).
    fn amplitude(&self, n: usize, order: i32, near: Displacement<R>, far: Displacement<R>) -> R {
        let square = |[near_row, far_row]: [Displacement<R>; 2]| {
            let sum = (0..3).fold(R::ZERO, |sum, c| sum + near_row[c] * near[c] + far_row[c] * far[c]);
            sum * sum
        };
        self.rows(n, order).map(square).into_iter().fold(R::ZERO, |sum, part| sum + part).sqrt()
    }

    /// Elongation per amplitude when the two ends are displaced by these fractions of it.
    fn row(&self, near: Displacement<R>, far: Displacement<R>) -> [Displacement<R>; 2] {
        let still = [R::ZERO; 3];
        [
            core::array::from_fn(|c| self.elongation(component(near, c), still)),
            core::array::from_fn(|c| self.elongation(still, component(far, c))),
        ]
    }
}

/// One component of a displacement, alone.
fn component<R: Real>(displacement: Displacement<R>, c: usize) -> Displacement<R> {
    core::array::from_fn(|k| if k == c { displacement[k] } else { R::ZERO })
}

/// The links of the 8 directions.
fn links<R: Real>(cup: &Cup<R>, n: usize, m: usize) -> [Link<R>; 8] {
    DIRECTIONS.map(|direction| Link::new(cup, n, m, direction))
}

/// Amplitudes of every slice at rest in a harmonic, the rim displaced by `rim`, the flange not.
#[inline(never)] // For two harmonics, once at start-up: small rather than fast.
pub(super) fn settled<R: Real, const M: usize>(
    cup: &Cup<R>,
    n: usize,
    order: i32,
    rim: Displacement<R>,
) -> Shape<R, M> {
    condense(stiffness(cup, n, order), rim)
}

/// Torsional stiffness of an n x M mesh whose links all have the constant 1 N/m (N m/rad): twice the energy
/// of its shape when the rim is turned by 1 rad.
///
/// Bend links that harden stand at the ellipse's strain, which is several times that of torsion: each counts with
/// its mean slope there.
pub fn unit_stiffness<R: Real, const M: usize>(cup: &Cup<R>, n: usize, bend: &Bend<R>) -> R {
    let oval: Shape<R, M> = settled(cup, n, 2, [cup.ellipse, R::lit(-0.5) * cup.ellipse, R::ZERO]);
    let slope = |link: &Link<R>, near: usize| {
        let strain = link.amplitude(n, 2, oval[near], oval[near + link.along]) / link.length;
        if is_bend((link.around, link.along)) { mean_slope(bend, strain) } else { R::ONE }
    };
    let shape: Shape<R, M> = condense(weighted(cup, n, 0, slope), [R::ZERO, cup.radius, R::ZERO]);
    let mut squares = R::ZERO;
    for link in links(cup, n, M) {
        for (near, ends) in shape.iter().zip(shape.iter().skip(link.along)).enumerate() {
            let elongation = link.elongation(*ends.0, *ends.1);
            squares += slope(&link, near) * elongation * elongation;
        }
    }
    R::from_i32(n as i32) * squares
}

/// Slope of a bend link's law, the mean over a wave of strain of this amplitude; 1 without hardening.
fn mean_slope<R: Real>(bend: &Bend<R>, amplitude: R) -> R {
    const POINTS: i32 = 16;
    let strain = |k| amplitude * Angle::from_turn_fraction(k, POINTS).sin_cos().0;
    (0..POINTS).fold(R::ZERO, |sum, k| sum + bend.slope(strain(k))) / R::from_i32(POINTS)
}

/// Stiffness of a harmonic's amplitudes, in units of k*n/2 (of k*n for harmonic 0).
pub(super) fn stiffness<R: Real, const M: usize>(cup: &Cup<R>, n: usize, order: i32) -> Stiffness<R, M> {
    weighted(cup, n, order, |_, _| R::ONE)
}

/// The same with a factor for each link, by its near slice.
fn weighted<R: Real, const M: usize>(
    cup: &Cup<R>,
    n: usize,
    order: i32,
    factor: impl Fn(&Link<R>, usize) -> R,
) -> Stiffness<R, M> {
    let mut stiffness = [[[[R::ZERO; 3]; M]; 3]; M];
    for link in links(cup, n, M) {
        for row in link.rows(n, order) {
            for ends in (0..M).zip(link.along..M) {
                let gains = gains(ends, row);
                let factor = factor(&link, ends.0);
                for (force, gain) in stiffness.as_flattened_mut().iter_mut().zip(gains.as_flattened()) {
                    add(force, factor * *gain, &gains);
                }
            }
        }
    }
    stiffness
}

/// Elongation per amplitude of every slice, of a link that joins two of them.
fn gains<R: Real, const M: usize>((near, far): (usize, usize), row: [Displacement<R>; 2]) -> Shape<R, M> {
    core::array::from_fn(|slice| {
        core::array::from_fn(|c| {
            let of = |end, part: &Displacement<R>| if slice == end { part[c] } else { R::ZERO };
            of(near, &row[0]) + of(far, &row[1])
        })
    })
}

/// Solves for the inner slices: no force is left on them. The matrix is positive definite: no pivoting.
fn condense<R: Real, const M: usize>(mut stiffness: Stiffness<R, M>, rim: Displacement<R>) -> Shape<R, M> {
    for j in 1..M - 1 {
        for c in 0..3 {
            let pivot = stiffness[j][c];
            let inverse = R::ONE / pivot[j][c];
            for (slice, rows) in stiffness.iter_mut().enumerate().take(M - 1).skip(1) {
                for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| (slice, *k) != (j, c)) {
                    add(row, -(row[j][c] * inverse), &pivot);
                }
            }
        }
    }
    let mut shape = [[R::ZERO; 3]; M];
    shape[0] = rim;
    for j in 1..M - 1 {
        shape[j] = core::array::from_fn(|c| {
            let row = &stiffness[j][c];
            -(row[0][0] * rim[0] + row[0][1] * rim[1] + row[0][2] * rim[2]) / row[j][c]
        });
    }
    shape
}

/// Adds `factor` times `other`.
#[inline(never)] // As `settled`.
fn add<R: Real, const M: usize>(sum: &mut Shape<R, M>, factor: R, other: &Shape<R, M>) {
    for (entry, added) in sum.as_flattened_mut().iter_mut().zip(other.as_flattened()) {
        *entry += factor * *added;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;
    use proptest::prelude::*;

    /// Largest force that the links leave on a node of an inner slice, and the torque on the flange, when every
    /// node of the ring is displaced as `at(i, j)`; links of 1 N/m, node by node, without any harmonic.
    fn forces<const N: usize, const M: usize>(at: impl Fn(usize, usize) -> Displacement<f64>) -> (f64, f64) {
        let mut force = [[[0.0; 3]; N]; M];
        for link in links(&SIZE_25.cup, N, M) {
            for near in 0..M - link.along {
                for i in 0..N {
                    let (far, k) =
                        (near + link.along, (i as i32 + link.around).rem_euclid(N as i32) as usize);
                    let tension = link.elongation(at(i, near), at(k, far));
                    let (sine, cosine) = link.half;
                    let (outward, tangential) = (link.tangential * sine, link.tangential * cosine);
                    for (c, (pull, back)) in
                        [(-outward, outward), (tangential, tangential), (link.axial, link.axial)]
                            .into_iter()
                            .enumerate()
                    {
                        force[near][i][c] += tension * pull;
                        force[far][k][c] -= tension * back;
                    }
                }
            }
        }
        let inner = force[1..M - 1].as_flattened().as_flattened();
        let largest = inner.iter().fold(0.0, |largest: f64, f| largest.max(f.abs()));
        (largest, force[M - 1].iter().map(|f| f[1]).sum::<f64>() * SIZE_25.cup.radius)
    }

    fn ellipse_is_at_rest<const N: usize, const M: usize>(turned: f64) {
        let cup = &SIZE_25.cup;
        let shape: Shape<f64, M> = settled(cup, N, 2, [cup.ellipse, -0.5 * cup.ellipse, 0.0]);
        let (left, torque) = forces::<N, M>(|i, j| {
            let (sine, cosine) = (2.0 * (core::f64::consts::TAU * i as f64 / N as f64 - turned)).sin_cos();
            [shape[j][0] * cosine, shape[j][1] * sine, shape[j][2] * cosine]
        });
        assert!(left < 1e-11 * cup.ellipse, "{N} x {M}: {left}");
        assert!(torque.abs() < 1e-11 * cup.ellipse * cup.radius, "{N} x {M}: {torque}");
    }

    proptest! {
        #[test]
        fn the_ellipse_leaves_no_force_on_any_inner_node(turned in -7.0..7.0f64) {
            ellipse_is_at_rest::<5, 3>(turned);
            ellipse_is_at_rest::<8, 3>(turned);
            ellipse_is_at_rest::<36, 4>(turned);
            ellipse_is_at_rest::<12, 7>(turned);
        }
    }

    fn twist_is_at_rest<const N: usize, const M: usize>() {
        let cup = &SIZE_25.cup;
        let shape: Shape<f64, M> = settled(cup, N, 0, [0.0, cup.radius, 0.0]);
        let (left, torque) = forces::<N, M>(|_, j| shape[j]);
        let stiffness: f64 = unit_stiffness::<f64, M>(cup, N, &Bend::LINEAR);
        assert!(left * cup.radius < 1e-12 * stiffness, "{N} x {M}: {left}");
        assert!((torque / stiffness - 1.0).abs() < 1e-12, "{N} x {M}: {torque} against {stiffness}");
        assert!(shape.iter().all(|[radial, _, axial]| (*radial, *axial) == (0.0, 0.0)));
    }

    #[test]
    fn a_turned_rim_leaves_no_force_and_the_flange_feels_the_stiffness() {
        twist_is_at_rest::<5, 3>();
        twist_is_at_rest::<8, 3>();
        twist_is_at_rest::<36, 4>();
        twist_is_at_rest::<12, 7>();
    }

    #[test]
    fn single_precision_condenses_as_well() {
        let cup = crate::flexspline::Cup {
            radius: 0.031f32,
            length: 0.037,
            wall: 0.40e-3,
            ellipse: 0.30e-3,
            youngs_modulus: 206e9,
            poisson_ratio: 0.3,
            density: 7850.0,
        };
        let single: Shape<f32, 6> = settled(&cup, 8, 2, [1.0, -0.5, 0.0]);
        let double: Shape<f64, 6> = settled(&SIZE_25.cup, 8, 2, [1.0, -0.5, 0.0]);
        for (a, b) in single.as_flattened().iter().zip(double.as_flattened()) {
            assert!((f64::from(*a) - b).abs() < 3e-6, "{a} against {b}");
        }
    }
}
