//! Two links side by side: eq. (1), the curve of Fig. 4.
//!
//! ```text
//! F_x(dx) = k*(-(L1 - L0)*(a - dx)/L1 + (L2 - L0)*(a + dx)/L2)
//! L1 = sqrt(b^2 + (a - dx)^2),   L2 = sqrt(b^2 + (a + dx)^2)
//! ```
//!
//! Both links reach from a fixed base, at a on either side of the node, over the height b to the node (Fig. 3).
//! dx is the node's displacement along the base (m), F_x the force that holds it there (N): positive with dx while
//! the links pull back. Lengths in m, k in N/m. No state.
//!
//! The links are linear and the curve is not. It is odd, its slope 2*k far out and
//! `2*k*(1 - L0*b^2/L^3)` at rest, L = sqrt(a^2 + b^2). Links that are free of tension at rest, L0 = L, have 2*k*a^2/L^2
//! there, and from there the curve hardens where b > 2*a: d3F/ddx3 = 6*k*L0*b^2*(b^2 - 4*a^2)/L^7.
//!
//! L1 gets shorter up to dx = a, where it is b, and longer from there to 2*a: the paper's "clamped" and
//! "stretched". Being even about dx = a, it is as long as at rest only at 2*a again: links that are free of tension at
//! rest are under pressure until then.
//!
//! In the mesh the 16 links of a node two slices or more from either end are 4 such pairs along the axis, 2 around, and 4 links straight
//! along the axis, each half a pair with a = 0. Displaced by dx along its tangent, the node feels the sum of their
//! F_x, exactly: of a pair that spans the angle c around and the distance s along the axis a = R*sin(c) and
//! b^2 = (R*(1 - cos(c)))^2 + s^2.
//!
//! Two square roots a value: for the desktop, not for the control step.

use crate::error::{Error, require};
use crate::real::Real;

/// Geometry and constants of the two links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLinksParams<R> {
    /// a: how far along the base each link reaches, to either side (m).
    pub reach: R,
    /// b: height of the node over the base (m).
    pub height: R,
    /// L0: length without tension (m).
    pub rest_length: R,
    /// k of each link (N/m).
    pub stiffness: R,
}

/// The built pair.
///
/// Both links are linear springs, the pair is not: far out it has the stiffness of both, at rest hardly any.
///
/// ```
/// use strainwave::flexspline::TwoLinksParams;
///
/// let pair = TwoLinksParams::relaxed(1.0_f64, 3.0, 1000.0).build()?; // m, m, N/m
/// assert!((pair.stiffness() - 2.0 * 1000.0 * 1.0 / 10.0).abs() < 1e-9); // 2*k*a^2/L^2
/// let slope = |at: f64| (pair.force(at + 1e-6) - pair.force(at - 1e-6)) / 2e-6;
/// assert!(slope(1.0) > slope(0.5) && slope(0.5) > slope(0.0)); // it hardens, as b > 2*a
/// assert!((slope(1000.0) - 2000.0).abs() < 1.0);
/// assert!((slope(0.0) - pair.stiffness()).abs() < 1e-3);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLinks<R> {
    params: TwoLinksParams<R>,
}

impl<R: Real> TwoLinksParams<R> {
    /// Links without tension at rest: L0 = sqrt(a^2 + b^2).
    pub fn relaxed(reach: R, height: R, stiffness: R) -> Self {
        Self { reach, height, rest_length: (reach * reach + height * height).sqrt(), stiffness }
    }

    /// # Errors
    /// [`Error::OutOfRange`] `reach` unless finite and not negative; `height`, without which a link would have no
    /// direction at dx = a, `rest_length`, `stiffness` unless finite and positive.
    pub fn build(&self) -> Result<TwoLinks<R>, Error> {
        require(self.reach.is_finite() && self.reach >= R::ZERO, "reach")?;
        require(self.height.is_positive(), "height")?;
        require(self.rest_length.is_positive(), "rest_length")?;
        require(self.stiffness.is_positive(), "stiffness")?;
        Ok(TwoLinks { params: *self })
    }
}

impl<R: Real> TwoLinks<R> {
    /// L1 and L2 at a displacement (m).
    pub fn lengths(&self, displacement: R) -> [R; 2] {
        let TwoLinksParams { reach, height, .. } = self.params;
        [reach - displacement, reach + displacement].map(|along| (height * height + along * along).sqrt())
    }

    /// F_x1 and F_x2 at a displacement (m): what each link adds to the force (N).
    pub fn forces(&self, displacement: R) -> [R; 2] {
        let TwoLinksParams { reach, rest_length, stiffness, .. } = self.params;
        let [first, second] = self.lengths(displacement);
        [
            -stiffness * (first - rest_length) * (reach - displacement) / first,
            stiffness * (second - rest_length) * (reach + displacement) / second,
        ]
    }

    /// F_x at a displacement (m), by eq. (1) (N).
    pub fn force(&self, displacement: R) -> R {
        let [first, second] = self.forces(displacement);
        first + second
    }

    /// Slope of the force at rest, 2*k*(1 - L0*b^2/L^3) (N/m).
    pub fn stiffness(&self) -> R {
        let TwoLinksParams { height, rest_length, stiffness, .. } = self.params;
        let [length, _] = self.lengths(R::ZERO);
        let across = rest_length * height * height / (length * length * length);
        R::lit(2.0) * stiffness * (R::ONE - across)
    }

    /// Energy stored in both links at a displacement (m), of which the force is the slope (J).
    pub fn energy(&self, displacement: R) -> R {
        let TwoLinksParams { rest_length, stiffness, .. } = self.params;
        let square = |length: R| (length - rest_length) * (length - rest_length);
        let [first, second] = self.lengths(displacement);
        R::lit(0.5) * stiffness * (square(first) + square(second))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;
    use crate::flexspline::cup::DIRECTIONS;
    use crate::flexspline::shell::{Bend, Shell, ShellParams};
    use proptest::prelude::*;

    fn pair(reach: f64, height: f64, rest_length: f64) -> TwoLinks<f64> {
        TwoLinksParams { reach, height, rest_length, stiffness: 1e6 }.build().unwrap()
    }

    fn relaxed(reach: f64, height: f64) -> TwoLinks<f64> {
        TwoLinksParams::relaxed(reach, height, 1e6).build().unwrap()
    }

    /// Relaxed, under tension and under pressure.
    fn any_pair() -> impl Strategy<Value = TwoLinks<f64>> {
        (0.0..0.02f64, 1e-3..0.02f64, 0.5..1.5f64)
            .prop_map(|(reach, height, tension)| pair(reach, height, tension * reach.hypot(height)))
    }

    proptest! {
        #[test]
        fn it_is_odd_and_zero_at_rest(pair in any_pair(), displacement in -0.05..0.05f64) {
            prop_assert_eq!(pair.force(0.0), 0.0);
            prop_assert_eq!(pair.force(-displacement), -pair.force(displacement));
            prop_assert_eq!(pair.energy(-displacement), pair.energy(displacement));
        }

        #[test]
        fn force_is_the_slope_of_the_energy(pair in any_pair(), displacement in -0.05..0.05f64) {
            let slope = (pair.energy(displacement + 1e-7) - pair.energy(displacement - 1e-7)) / 2e-7;
            prop_assert!((slope - pair.force(displacement)).abs() < 0.1, "{} {}", slope, pair.force(displacement));
        }

        #[test]
        fn the_slope_at_rest_has_its_closed_form(pair in any_pair()) {
            let slope = pair.force(1e-7) / 1e-7;
            prop_assert!((slope - pair.stiffness()).abs() < 1e-3 * 2e6, "{} {}", slope, pair.stiffness());
        }

        #[test]
        fn a_relaxed_pair_has_the_tangents_share_of_both_links(reach in 0.0..0.02f64, height in 1e-3..0.02f64) {
            let expected = 2e6 * reach * reach / (reach * reach + height * height);
            prop_assert!((relaxed(reach, height).stiffness() - expected).abs() < 1e-8);
        }

        /// The paper: L2 is stretched for any displacement forwards; L1 is clamped up to a, stretched from there to 2*a.
        #[test]
        fn the_first_link_shortens_up_to_a_and_lengthens_from_there(
            reach in 1e-3..0.02f64, height in 1e-3..0.02f64, fraction in 0.01..1.98f64,
        ) {
            prop_assume!((fraction - 1.0).abs() > 1e-3);
            let pair = relaxed(reach, height);
            let rest = pair.lengths(0.0);
            let [[before, _], [first, second], [after, _]] =
                [fraction - 0.01, fraction, fraction + 0.01].map(|fraction| pair.lengths(fraction * reach));
            prop_assert!(second > rest[1]);
            prop_assert!(first >= height && first < rest[0]);
            prop_assert_eq!(after > before, fraction > 1.0);
            // Until then it pushes back, from there on forwards.
            prop_assert_eq!(pair.forces(fraction * reach)[0] < 0.0, fraction > 1.0);
        }

        /// From rest the curve hardens exactly where b > 2*a.
        #[test]
        fn a_tall_pair_hardens_and_a_flat_one_softens(reach in 1e-3..5e-3f64, ratio in 0.2..8.0f64) {
            prop_assume!((ratio - 2.0).abs() > 0.05);
            let pair = relaxed(reach, ratio * reach);
            let secant = pair.force(1e-2 * reach) / (1e-2 * reach);
            prop_assert_eq!(secant > pair.stiffness(), ratio > 2.0);
        }
    }

    #[test]
    fn the_first_link_is_shortest_over_its_foot_and_as_at_rest_at_2a() {
        let pair = relaxed(3e-3, 4e-3);
        assert_eq!(pair.lengths(3e-3)[0], 4e-3);
        assert_eq!(pair.forces(3e-3)[0], 0.0);
        assert!((pair.lengths(6e-3)[0] - 5e-3).abs() < 1e-18);
    }

    /// The pairs that the links of an inner node make, each with its weight: a link along the axis is half of one.
    fn pairs(params: &ShellParams<f64>, n: usize, spacing: f64) -> std::vec::Vec<(TwoLinks<f64>, f64)> {
        let radius = params.cup.radius;
        let of = |(around, along): (i32, usize)| {
            let angle = core::f64::consts::TAU * f64::from(around) / n as f64;
            let (reach, sagitta) = (radius * angle.sin(), radius * (1.0 - angle.cos()));
            let height = sagitta.hypot(spacing * along as f64);
            TwoLinksParams::relaxed(reach, height, params.link_stiffness).build().unwrap()
        };
        // A direction and its mirror image are one pair towards the rim and one towards the flange.
        let unique = DIRECTIONS.into_iter().filter(|(around, _)| *around >= 0);
        unique
            .map(|direction| (of(direction), if direction.0 > 0 && direction.1 > 0 { 2.0 } else { 1.0 }))
            .collect()
    }

    /// All 16 links of a node in the middle of five slices, which is displaced along its tangent: the sum of eq. (1) over
    /// their pairs.
    #[test]
    fn a_node_of_the_mesh_feels_the_sum_of_its_pairs() {
        const N: usize = 12;
        let params =
            ShellParams { cup: SIZE_25.cup, link_stiffness: 1e6, link_damping: 0.0, bend: Bend::LINEAR };
        let dt = 1e-9;
        let shell = Shell::<f64, N, 5>::build(&params, dt).unwrap();
        let pairs = pairs(&params, N, params.cup.length / 4.0);
        for displacement in [-4e-4, -1e-5, 1e-5, 2e-4, 4e-4] {
            let mut state = shell.round();
            // Node 0 stands on the x axis: its tangent is y.
            state.position[2][1].set_node(0, displacement);
            shell.step(&mut state);
            let force = -state.velocity(0, 2)[1] * params.node_mass(N, 5) / dt;
            let expected: f64 = pairs.iter().map(|(pair, weight)| weight * pair.force(displacement)).sum();
            assert!(
                (force / expected - 1.0).abs() < 1e-6,
                "{force} N against {expected} N at {displacement} m"
            );
        }
    }

    #[test]
    fn single_precision_gives_the_same_curve() {
        let single = TwoLinksParams::relaxed(3e-3f32, 4e-3, 1e6).build().unwrap();
        let double = relaxed(3e-3, 4e-3);
        for k in -50..=50i8 {
            let (a, b) = (single.force(2e-4 * f32::from(k)), double.force(2e-4 * f64::from(k)));
            assert!((f64::from(a) - b).abs() < 1e-2, "{a} against {b}");
        }
    }

    #[test]
    fn what_is_no_pair_is_refused_by_name() {
        let good = TwoLinksParams { reach: 0.003, height: 0.004, rest_length: 0.005, stiffness: 1.0 };
        for (params, name) in [
            (TwoLinksParams { reach: -1.0, ..good }, "reach"),
            (TwoLinksParams { height: 0.0, ..good }, "height"),
            (TwoLinksParams { rest_length: f64::NAN, ..good }, "rest_length"),
            (TwoLinksParams { stiffness: 0.0, ..good }, "stiffness"),
        ] {
            assert_eq!(params.build(), Err(Error::OutOfRange(name)));
        }
    }
}
