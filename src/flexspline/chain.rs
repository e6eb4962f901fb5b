//! Torsion of a mesh whose bend links harden: the chain of its slices, settled step by step of torsion.
//!
//! In torsion all nodes of a slice turn by one angle psi_j (harmonic 0 of `condensation.rs`): the shear links join
//! neighbours, the diagonal bend links the next but one, and the others keep their lengths. With d = psi_j - psi_k
//!
//! ```text
//! torque of all shear links of a gap       k*S*d
//! torque of all bend links of two gaps     k*B*(d + H(gamma*d)/gamma),     gamma*d = a bend link's strain
//! ```
//!
//! S and B are sums of squared elongations per rad (m^2), H the hardening from the assembled shape
//! ([`Bend::assembled_tension`]): the ellipse turns no slice, so its strain cancels. The inner slices are at rest between
//! rim and flange; Newton's method follows them from one torsion to the next. The torque is the slope of the energy, which is
//! convex, so that it rises; the law keeps it at [`POINTS`] torsions, joined by straight pieces.
//!
//! What the wave generator's angle adds, products of torsion and ellipse and the links' pre-strain, is of second order; it is
//! zero at rest and `verify flexspline` measures it on the settled literal mesh.
//!
//! Calibration: k gives K1. The bend links saturate where the mesh has K3, so their saturated slope r solves
//! K(r) = K3. In between the mesh follows
//!
//! ```text
//! K1*phi + (K3 - K1)*phi_s*c(phi/phi_s),   c(z) = y^3/3 + z - y,   y = z within +-1
//! ```
//!
//! with the phi_s that keeps the largest distance from the catalogue's line least, up to 1.4*T2. A saturated chain pulls
//! as a linear one with a preload of the bend links, 2/3*(r - 1)*saturation each, and the preload's torque is
//! 2/3*(K3 - K1)*phi_s: hence the saturation.
//!
//! Units: rad, m, N m, N m/rad.

use crate::error::Error;
use crate::flexspline::condensation::Link;
use crate::flexspline::cup::{Cup, DIRECTIONS, is_bend};
use crate::flexspline::shell::Bend;
use crate::flexspline::stiffness_line::{StiffnessLine, StiffnessLineParams, TorsionLaw};
use crate::real::Real;

/// Torsions at which the law keeps the chain's torque.
const POINTS: usize = 7;
/// Newton's steps at a torsion; each starts from the shape at the last one.
const NEWTON_STEPS: usize = 8;
/// Fraction of the gain of stiffness that the law leaves out beyond its last point: with many slices a last bend link
/// saturates late.
const LEFT: f64 = 0.02;
/// Largest slope of the bend links over that of the others.
const STIFFEST_BEND: f64 = 100.0;

/// Angles of the slices (rad), rim first.
type Angles<R, const M: usize> = [R; M];

/// The reduced mesh's law.
pub(super) struct MeshLaw<R, const M: usize> {
    pub line: TorsionLaw<R>,
    /// Angle of each slice over the torsion, and over the torque (rad/(N m)).
    pub by_torsion: Angles<R, M>,
    pub by_torque: Angles<R, M>,
}

/// M slices, and the links between them.
pub(super) struct Chain<R, const M: usize> {
    /// k*S and k*B.
    shear: R,
    bend: R,
    /// gamma (1/rad).
    strain: R,
}

/// What hardening adds to an angle d between the ends of bend links, as an angle, and its slope.
trait Law<R>: Fn(R) -> [R; 2] {}
impl<R, F: Fn(R) -> [R; 2]> Law<R> for F {}

impl<R: Real, const M: usize> Chain<R, M> {
    /// Of n nodes around, links of the constant k (N/m).
    pub fn new(cup: &Cup<R>, n: usize, link_stiffness: R) -> Self {
        let mut chain = Self { shear: R::ZERO, bend: R::ZERO, strain: R::ZERO };
        for direction in DIRECTIONS.into_iter().filter(|(_, along)| *along > 0) {
            let link = Link::new(cup, n, M, direction);
            let turned = [R::ZERO, cup.radius, R::ZERO];
            let gain = link.linear_strain([R::ZERO; 3], turned);
            let elongation = gain * link.length;
            let torque = R::from_i32(n as i32) * link_stiffness * elongation * elongation;
            if is_bend(direction) {
                chain.bend += torque;
                chain.strain = chain.strain.max(gain.abs());
            } else {
                chain.shear += torque;
            }
        }
        chain
    }

    /// The bend links' law in this chain.
    fn hardening(&self, bend: &Bend<R>) -> impl Law<R> {
        let (strain, bend) = (self.strain, *bend);
        move |d| [bend.assembled_tension(strain * d) / strain, bend.assembled_slope(strain * d)]
    }

    /// The inner slices at rest, from where they are.
    fn settle(&self, angles: &mut Angles<R, M>, law: &impl Law<R>) {
        for _ in 0..NEWTON_STEPS {
            let (force, matrix) = self.forces(angles, law);
            let step = solved(matrix, force);
            for (angle, step) in angles.iter_mut().zip(step).take(M - 1).skip(1) {
                *angle += step;
            }
        }
    }

    /// Torque of the links on each slice, and its slopes' negative.
    fn forces(&self, angles: &Angles<R, M>, law: &impl Law<R>) -> (Angles<R, M>, [Angles<R, M>; M]) {
        let (mut force, mut matrix) = ([R::ZERO; M], [[R::ZERO; M]; M]);
        let mut join = |j: usize, k: usize, torque: R, slope: R| {
            force[j] -= torque;
            force[k] += torque;
            for (row, column, slope) in [(j, j, slope), (k, k, slope), (j, k, -slope), (k, j, -slope)] {
                matrix[row][column] += slope;
            }
        };
        for j in 0..M - 1 {
            join(j, j + 1, self.shear * (angles[j] - angles[j + 1]), self.shear);
        }
        for j in 0..M - 2 {
            let d = angles[j] - angles[j + 2];
            let [added, slope] = law(d);
            join(j, j + 2, self.bend * (d + added), self.bend * (R::ONE + slope));
        }
        (force, matrix)
    }

    /// Angles and stiffness of a linear chain whose bend links are `factor` times as stiff as the others, the rim turned by 1 rad.
    fn linear(&self, factor: R) -> (Angles<R, M>, R) {
        let law = |d: R| [(factor - R::ONE) * d, factor - R::ONE];
        let mut angles = rim_turned(R::ONE);
        self.settle(&mut angles, &law);
        (angles, -self.forces(&angles, &law).0[0])
    }

    /// The hardening with which the chain follows a line; none when that is out of its reach.
    pub fn following(&self, line: &StiffnessLineParams<R>) -> Option<Bend<R>> {
        let [k1, _, k3] = line.stiffness;
        let [mut soft, mut stiff] = [R::ONE, R::lit(STIFFEST_BEND)];
        if M < 3 || k3 <= k1 || self.linear(stiff).1 < k3 {
            return None;
        }
        for _ in 0..R::MANTISSA_DIGITS + 8 {
            let middle = R::lit(0.5) * (soft + stiff);
            if self.linear(middle).1 < k3 { soft = middle } else { stiff = middle }
        }
        let (angles, _) = self.linear(stiff);
        let differences = angles.iter().zip(&angles[2..]).fold(R::ZERO, |sum, (a, b)| sum + (*a - *b).abs());
        let gain = stiff - R::ONE;
        let preload = (k3 - k1) * following_torsion(line)? / (self.bend * gain * differences);
        let saturation = self.strain * preload;
        Some(Bend { hardening: gain / (R::lit(3.0) * saturation * saturation), saturation })
    }

    /// Torque over torsion up to where the bend links are all but saturated, or `largest` is reached (N m), and the shapes.
    ///
    /// # Errors
    /// As [`TorsionLaw::through`].
    pub fn law(&self, bend: &Bend<R>, largest: R) -> Result<MeshLaw<R, M>, Error> {
        let law = self.hardening(bend);
        let [first, last] = [R::ONE, R::ONE + law(R::MAX.sqrt())[1]].map(|factor| self.linear(factor));
        let end = self.end(bend, largest);
        let mut angles = [R::ZERO; M];
        let points = core::array::from_fn(|k| {
            let torsion = end * R::from_i32(k as i32 + 1) / R::lit(POINTS as f64);
            let torque = self.torque(&mut angles, torsion, &law);
            // Small torsion has the mesh's own stiffness there; the cubic adds little up to the first point.
            (torsion, if k == 0 { first.1 * torsion } else { torque })
        });
        // A*torsion + B*torque: as the chain turns at first, and once it is saturated.
        let by_torque: Angles<R, M> = core::array::from_fn(|j| (first.0[j] - last.0[j]) / (first.1 - last.1));
        let by_torsion = core::array::from_fn(|j| first.0[j] - by_torque[j] * first.1);
        Ok(MeshLaw { line: TorsionLaw::through(points, last.1)?, by_torsion, by_torque })
    }

    /// Torsion at which the chain has all but [`LEFT`] of what its stiffness gains, or that of `largest` torque (rad).
    fn end(&self, bend: &Bend<R>, largest: R) -> R {
        let law = self.hardening(bend);
        let mut angles = [R::ZERO; M];
        let (mut torsion, mut before) = (bend.saturation / self.strain, R::ZERO);
        let [soft, stiff] = [R::ONE, R::ONE + law(R::MAX.sqrt())[1]].map(|factor| self.linear(factor).1);
        for _ in 0..1000 {
            let torque = self.torque(&mut angles, torsion, &law);
            let stiffness = (torque - before) / (torsion * R::lit(1.0 - 1.0 / 1.02));
            if torque >= largest || (before > R::ZERO && stiff - stiffness < R::lit(LEFT) * (stiff - soft)) {
                break;
            }
            before = torque;
            torsion *= R::lit(1.02);
        }
        torsion
    }

    /// Torque at a torsion (N m), the slices led there from `angles`.
    fn torque(&self, angles: &mut Angles<R, M>, torsion: R, law: &impl Law<R>) -> R {
        angles[0] = torsion;
        self.settle(angles, law);
        -self.forces(angles, law).0[0]
    }
}

/// phi_s (rad); none when the line cannot be built.
fn following_torsion<R: Real>(params: &StiffnessLineParams<R>) -> Option<R> {
    const SEARCH: i32 = 40;
    let line = params.build().ok()?;
    let [near, far] = params.knee_torque.map(|torque| line.torsion(torque));
    let (mut low, mut high) = (near, R::lit(4.0) * far);
    for _ in 0..SEARCH {
        let third = (high - low) * R::lit(1.0 / 3.0);
        let [a, b] = [low + third, high - third];
        if distance(params, &line, a) < distance(params, &line, b) { high = b } else { low = a }
    }
    Some(low)
}

/// Largest distance of the curve that saturates at a torsion from the line, up to 1.4*T2 (N m).
fn distance<R: Real>(params: &StiffnessLineParams<R>, line: &StiffnessLine<R>, saturation: R) -> R {
    const GRID: i32 = 50;
    let ([k1, _, k3], end) = (params.stiffness, line.torsion(R::lit(1.4) * params.knee_torque[1]));
    (1..=GRID).fold(R::ZERO, |largest, k| {
        let torsion = end * R::from_i32(k) / R::from_i32(GRID);
        let z = torsion / saturation;
        let inside = z.limit(R::ONE);
        let curve = inside * inside * inside * R::lit(1.0 / 3.0) + z - inside;
        largest.max((k1 * torsion + (k3 - k1) * saturation * curve - line.torque(torsion)).abs())
    })
}

/// The rim turned by an angle, all else at zero.
fn rim_turned<R: Real, const M: usize>(angle: R) -> Angles<R, M> {
    core::array::from_fn(|j| if j == 0 { angle } else { R::ZERO })
}

/// Solution for the inner slices of a positive definite matrix: no pivoting.
fn solved<R: Real, const M: usize>(mut matrix: [Angles<R, M>; M], mut right: Angles<R, M>) -> Angles<R, M> {
    for j in 1..M - 1 {
        let (pivot, right_of_pivot) = (matrix[j], right[j]);
        for k in (1..M - 1).filter(|k| *k != j) {
            let factor = matrix[k][j] / pivot[j];
            for (entry, above) in matrix[k].iter_mut().zip(pivot) {
                *entry -= factor * above;
            }
            right[k] -= factor * right_of_pivot;
        }
    }
    core::array::from_fn(|j| if j == 0 || j == M - 1 { R::ZERO } else { right[j] / matrix[j][j] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle::Angle;
    use crate::flexspline::calibration::tests::SIZE_25;
    use crate::flexspline::{Ends, Flexspline, FlexsplineParams, Hardening, Mesh, Reduced};
    use std::vec::Vec;

    const RATED: f64 = 67.0;

    fn bends() -> FlexsplineParams<f64> {
        FlexsplineParams { hardening: Hardening::Bends, ..SIZE_25 }
    }

    /// Torques of the settled literal mesh at torsions, with the ellipse between two nodes.
    fn literal<const N: usize, const M: usize>(params: &FlexsplineParams<f64>, torsions: &[f64]) -> Vec<f64> {
        let dt = 0.9 * Mesh::<f64, N, M>::stable_step(params);
        let mesh = Mesh::<f64, N, M>::build(params, dt).unwrap();
        let mut state = mesh.rest();
        let at = |torsion| Ends {
            drive: Angle::from_radians(torsion),
            wave_generator: Angle::from_radians(0.3),
            ..Ends::default()
        };
        let mut torque = |torsion: &f64| {
            mesh.relax(&mut state, &at(*torsion), 6000);
            mesh.step(&mut state, &at(*torsion)).flange
        };
        torsions.iter().map(&mut torque).collect()
    }

    fn against_literal<const N: usize, const M: usize>(params: &FlexsplineParams<f64>, bound: f64) {
        let reduced = Reduced::<f64, N, M>::build(params, RATED).unwrap();
        let torsions = [1e-5, -2e-4, 4.5e-4, 8e-4, -1.1e-3, 1.46e-3, 3e-3];
        for (torsion, torque) in torsions.iter().zip(literal::<N, M>(params, &torsions)) {
            let law = reduced.torque(*torsion, 0.0);
            assert!((law - torque).abs() < bound * RATED, "{N} x {M}: {torque} against {law} at {torsion}");
        }
    }

    #[test]
    fn the_law_is_that_of_the_settled_literal_mesh() {
        against_literal::<8, 3>(&bends(), 5e-3);
        against_literal::<12, 4>(&bends(), 5e-3);
        against_literal::<36, 4>(&bends(), 5e-3);
        let own = Bend { hardening: 3e7, saturation: 2e-4 };
        against_literal::<8, 3>(&FlexsplineParams { bend: own, ..bends() }, 5e-3);
    }

    /// Largest change of torque up to rated torque (N m), and of a slice's or the ellipse's place.
    fn change<const N: usize, const M: usize, const P: usize, const Q: usize>(
        other: &FlexsplineParams<f64>,
    ) -> (f64, f64) {
        let a = Reduced::<f64, N, M>::build(&bends(), RATED).unwrap();
        let b = Reduced::<f64, P, Q>::build(other, RATED).unwrap();
        let torque = (1..=30).map(|k| 5e-5 * f64::from(k)).fold(0.0, |largest: f64, torsion| {
            largest.max((a.torque(torsion, 0.0) - b.torque(torsion, 0.0)).abs())
        });
        let shape = (a.angles(40.0)[1] / b.angles(40.0)[1] - 1.0).abs();
        let ellipse = (a.ellipse()[1][0] / b.ellipse()[1][0] - 1.0).abs();
        (torque, shape.max(ellipse))
    }

    #[test]
    fn law_or_shapes_follow_nodes_slices_ellipse_and_hardening() {
        let slices = change::<8, 3, 8, 6>(&bends());
        assert!(slices.0 > 0.1 && slices.1 > 0.1, "{slices:?}");
        let nodes = change::<8, 3, 12, 3>(&bends());
        assert!(nodes.1 > 0.01, "{nodes:?}");
        let cup = Cup { ellipse: 0.4e-3, ..SIZE_25.cup };
        let ellipse = change::<8, 3, 8, 3>(&FlexsplineParams { cup, ..bends() });
        assert!(ellipse.1 > 0.2, "{ellipse:?}");
        let own = Bend { hardening: 3e7, saturation: 2e-4 };
        let hardening = change::<8, 3, 8, 3>(&FlexsplineParams { bend: own, ..bends() });
        assert!(hardening.0 > 1.0, "{hardening:?}");
    }

    /// 3 % of the rated torque, for every mesh.
    #[test]
    fn the_law_follows_the_catalogue_whatever_the_mesh() {
        fn check<const N: usize, const M: usize>() {
            let line = SIZE_25.line.build().unwrap();
            let reduced = Reduced::<f64, N, M>::build(&bends(), RATED).unwrap();
            let k1 = reduced.torque(1e-6, 0.0) / 1e-6;
            assert!((k1 / 3.1e4 - 1.0).abs() < 1e-9, "{N} x {M}: {k1}");
            for torque in (1..=67).map(f64::from) {
                let off = reduced.torque(line.torsion(torque), 0.0) - torque;
                assert!(off.abs() < 0.03 * RATED, "{N} x {M}: {off} at {torque}");
                assert!((reduced.torque(reduced.torsion(torque), 0.0) - torque).abs() < 1e-9);
            }
        }
        check::<8, 3>();
        check::<9, 3>();
        check::<16, 4>();
        check::<36, 4>();
        check::<48, 6>();
        check::<72, 8>();
    }

    #[test]
    fn single_precision_finds_the_same_law() {
        let double = Reduced::<f64, 8, 3>::build(&bends(), RATED).unwrap();
        let line = crate::flexspline::stiffness_line::StiffnessLineParams {
            stiffness: SIZE_25.line.stiffness.map(|k| k as f32),
            knee_torque: SIZE_25.line.knee_torque.map(|torque| torque as f32),
        };
        let params = FlexsplineParams {
            cup: single_cup(),
            line,
            damping_ratio: 0.02,
            inertia: 1.2,
            hardening: Hardening::Bends,
            bend: Bend::LINEAR,
        };
        let single = Reduced::<f32, 8, 3>::build(&params, RATED as f32).unwrap();
        for torsion in (-30..=30).map(|k| 1e-4 * f64::from(k)) {
            let (a, b) = (single.torque(torsion as f32, 0.0), double.torque(torsion, 0.0));
            assert!((f64::from(a) - b).abs() < 1e-3 * RATED, "{a} against {b} at {torsion}");
        }
    }

    fn single_cup() -> Cup<f32> {
        let cup = SIZE_25.cup;
        Cup {
            radius: cup.radius as f32,
            length: cup.length as f32,
            wall: cup.wall as f32,
            ellipse: cup.ellipse as f32,
            youngs_modulus: cup.youngs_modulus as f32,
            poisson_ratio: cup.poisson_ratio as f32,
            density: cup.density as f32,
        }
    }

    /// Driven around under torsion: work at the ports is stored or lost, the hardening's torque on the wave generator included.
    #[test]
    fn the_literal_mesh_keeps_its_energy() {
        let params = FlexsplineParams { damping_ratio: 0.0, ..bends() };
        let dt = 0.3 * Mesh::<f64, 8, 3>::stable_step(&params);
        let mesh = Mesh::<f64, 8, 3>::build(&params, dt).unwrap();
        let mut state = mesh.rest();
        let ends = |k: i32| {
            let time = dt * f64::from(k);
            Ends {
                drive: Angle::from_radians(1.0 * time),
                drive_rate: 1.0,
                wave_generator: Angle::from_radians(200.0 * time),
                wave_generator_rate: 200.0,
                ..Ends::default()
            }
        };
        let before = mesh.energy(&state, &ends(0));
        let (mut work, steps) = (0.0, (1.5e-3 / dt) as i32);
        for k in 0..steps {
            let reaction = mesh.step(&mut state, &ends(k));
            let half = if k == 0 { 0.5 } else { 1.0 };
            work += half * dt * (reaction.contact - 200.0 * reaction.ellipse);
        }
        let gained = mesh.energy(&state, &ends(steps)) - before;
        assert!(gained > 0.01 && (work / gained - 1.0).abs() < 0.03, "{work} J in, {gained} J more");
    }

    #[test]
    fn what_bend_links_cannot_follow_is_refused_by_name() {
        let softening = |k3: f64| {
            let line = crate::flexspline::stiffness_line::StiffnessLineParams {
                stiffness: [3.1e4, 3.1e4, k3],
                ..SIZE_25.line
            };
            Reduced::<f64, 36, 4>::build(&FlexsplineParams { line, ..bends() }, RATED).err()
        };
        assert_eq!(softening(3.1e4), Some(Error::OutOfRange("stiffness")));
        assert_eq!(softening(1.2e5), Some(Error::OutOfRange("stiffness")));
        assert_eq!(softening(6e4), None);
        assert_eq!(Mesh::<f64, 8, 2>::build(&bends(), 1e-9).err(), Some(Error::OutOfRange("m")));
    }
}
