//! The cup in numbers: its two shapes, and strain as a Fourier series of the wave generator's angle.
//!
//! ```text
//! displacement(i, j) = tau*twist_j + ellipse_j at b,    b = a_i - t,    t = theta_wg - theta_fs,    a_i = 2*pi*i/N
//! strain(i, j)       = constant + per_torque*tau + cosine*cos(2*s) + sine*sin(2*s) + cosine_4*cos(4*s) + sine_4*sin(4*s),
//!                      s = t - a_i
//! ```
//!
//! The law of [`Reduced`] and of [`StrainGauge`], in SI units; the page computes both from the numbers here. The cup is
//! alike all around, so that six numbers for each slice hold every node. A node's strain is the mean of the two links of a
//! kind that meet at it, of the one that it has at an end of the cup.

use strainwave::flexspline::reduced::Direction;
use strainwave::flexspline::{FlexsplineParams, Reduced, StrainGauge};
use strainwave::{Angle, Error};

/// Nodes of the drawn mesh.
pub(super) const N: usize = 72;
pub(super) const M: usize = 8;

/// Links that colour the cup, by name.
pub(super) const KINDS: [(&str, Direction); 4] = [
    ("diagonal links, one way", (1, 1)),
    ("diagonal links, the other way", (-1, 1)),
    ("links around", (1, 0)),
    ("links along the axis", (0, 1)),
];

/// Places at which the page checks its own arithmetic, in each kind of link.
const CHECKS: usize = 24;

/// Condensed mesh and its gauges.
pub(super) struct Shape {
    pub reduced: Reduced<f64, N, M>,
    /// Of each kind and slice, at node 0.
    pub gauges: [[StrainGauge<f64>; M]; KINDS.len()],
}

impl Shape {
    pub fn build(params: &FlexsplineParams<f64>, rated_torque: f64) -> Result<Self, Error> {
        let reduced = Reduced::build(params, rated_torque)?;
        let blank = StrainGauge {
            constant: 0.0,
            per_torque: 0.0,
            cosine: 0.0,
            sine: 0.0,
            cosine_4: 0.0,
            sine_4: 0.0,
        };
        let mut gauges = [[blank; M]; KINDS.len()];
        for (kind, (_, direction)) in KINDS.iter().enumerate() {
            for (slice, gauge) in gauges[kind].iter_mut().enumerate() {
                *gauge = at_node(&reduced, slice, *direction)?;
            }
        }
        Ok(Self { reduced, gauges })
    }

    /// Angle of each slice for a torque (rad/(N m)), rim first.
    pub fn twist(&self) -> Vec<f64> {
        self.reduced.twist().to_vec()
    }

    /// Radial, tangential and axial amplitude of each slice (m), rim first.
    pub fn ellipse(&self) -> Vec<f64> {
        self.reduced.ellipse().as_flattened().to_vec()
    }

    /// The six numbers of each slice.
    pub fn series(&self, kind: usize) -> Vec<f64> {
        self.gauges[kind].iter().flat_map(numbers).collect()
    }

    /// Bounds of the strain's magnitude up to a torque (N m): by torque and ellipse, and by the torque alone.
    pub fn scales(&self, kind: usize, torque: f64) -> [f64; 2] {
        let by_torque = |gauge: &StrainGauge<f64>| (gauge.per_torque * torque).abs();
        let by_both = |gauge: &StrainGauge<f64>| {
            gauge.constant.abs()
                + by_torque(gauge)
                + gauge.cosine.hypot(gauge.sine)
                + gauge.cosine_4.hypot(gauge.sine_4)
        };
        let most =
            |of: &dyn Fn(&StrainGauge<f64>) -> f64| self.gauges[kind].iter().map(of).fold(0.0, f64::max);
        [most(&by_both), most(&by_torque)]
    }

    /// Rows of what the model says, for the page to compare with: kind, i, j, torque (N m), t (rad), strain, and radial,
    /// tangential and axial displacement (m).
    pub fn checks(&self, torque: f64) -> Result<Vec<f64>, Error> {
        let mut rows = Vec::new();
        for kind in 0..KINDS.len() {
            for check in 0..CHECKS {
                // Steps without a common factor with the sizes: every slice, and nodes all around.
                let (i, j) = (check * 31 % N, check * 3 % M);
                let tau = torque * (2.0 * check as f64 / (CHECKS as f64 - 1.0) - 1.0);
                let angle = f64::from(0.7 * check as f32);
                let at = Angle::from_radians_f64(angle);
                let strain = strain(&self.reduced, kind, (i, j), tau, at)?;
                let place = self.reduced.displacement((i, j), tau, at)?;
                rows.extend([kind as f64, i as f64, j as f64, tau, angle, strain]);
                rows.extend(place);
            }
        }
        Ok(rows)
    }
}

fn numbers(gauge: &StrainGauge<f64>) -> [f64; 6] {
    [gauge.constant, gauge.per_torque, gauge.cosine, gauge.sine, gauge.cosine_4, gauge.sine_4]
}

/// Either way along a kind of links.
fn both_ways((around, along): Direction) -> [Direction; 2] {
    [(around, along), (-around, -along)]
}

/// Mean of the gauges at node 0 of a slice.
fn at_node(
    reduced: &Reduced<f64, N, M>,
    slice: usize,
    direction: Direction,
) -> Result<StrainGauge<f64>, Error> {
    let gauges = both_ways(direction).map(|direction| StrainGauge::build(reduced, (0, slice), direction));
    let [one, other] = match gauges {
        [Ok(one), Ok(other)] => [one, other],
        [Ok(only), Err(_)] | [Err(_), Ok(only)] => [only, only],
        [Err(error), Err(_)] => return Err(error),
    };
    let [one, other] = [numbers(&one), numbers(&other)];
    let [constant, per_torque, cosine, sine, cosine_4, sine_4] =
        std::array::from_fn(|k| 0.5 * (one[k] + other[k]));
    Ok(StrainGauge { constant, per_torque, cosine, sine, cosine_4, sine_4 })
}

/// Strain at a node by the model itself, without the series.
fn strain(
    reduced: &Reduced<f64, N, M>,
    kind: usize,
    node: (usize, usize),
    torque: f64,
    wave_generator: Angle<f64>,
) -> Result<f64, Error> {
    let found =
        both_ways(KINDS[kind].1).map(|direction| reduced.strain(node, direction, torque, wave_generator));
    match found {
        [Ok(one), Ok(other)] => Ok(0.5 * (one + other)),
        [one, other] => one.or(other),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;
    use crate::design::joint::gear_params;
    use crate::io::gear_file::GearFile;

    fn shape() -> Shape {
        let params = gear_params::<f64>(&GearFile::default_gear());
        Shape::build(&params.flexspline, params.rated_torque).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Six numbers a slice hold every node, at any angle and torque.
        #[test]
        fn the_colour_of_a_node_is_the_models_strain(
            kind in 0..KINDS.len(), i in 0..N, j in 0..M, torque in -157.0..157.0f64, angle in -50.0..50.0f64,
        ) {
            let shape = shape();
            let exact = strain(&shape.reduced, kind, (i, j), torque, Angle::from_radians_f64(angle)).unwrap();
            let seen = angle - TAU * i as f64 / N as f64;
            let drawn = shape.gauges[kind][j].strain(torque, Angle::from_radians_f64(seen));
            prop_assert!((drawn - exact).abs() < 1e-6, "{} against {}", drawn, exact);
            let [both, _] = shape.scales(kind, 157.0);
            prop_assert!(drawn.abs() <= both, "{} beyond the scale {}", drawn, both);
        }

        /// Two shapes hold every displacement.
        #[test]
        fn a_nodes_place_follows_from_two_shapes(
            i in 0..N, j in 0..M, torque in -157.0..157.0f64, angle in -50.0..50.0f64,
        ) {
            let shape = shape();
            let [radial, tangential, axial] = [0, 1, 2].map(|part| shape.ellipse()[3 * j + part]);
            let (sine, cosine) = (2.0 * (TAU * i as f64 / N as f64 - angle)).sin_cos();
            let radius = gear_params::<f64>(&GearFile::default_gear()).flexspline.cup.radius;
            let drawn = [radial * cosine, tangential * sine + torque * radius * shape.twist()[j], axial * cosine];
            let exact = shape.reduced.displacement((i, j), torque, Angle::from_radians_f64(angle)).unwrap();
            for (drawn, exact) in drawn.iter().zip(exact) {
                prop_assert!((drawn - exact).abs() < 1e-11, "{} against {}", drawn, exact);
            }
        }
    }

    #[test]
    fn the_checks_cover_every_kind_and_slice() {
        let checks = shape().checks(67.0).unwrap();
        let rows: Vec<_> = checks.chunks(9).collect();
        assert_eq!(rows.len(), CHECKS * KINDS.len());
        for kind in 0..KINDS.len() {
            for slice in 0..M {
                assert!(rows.iter().any(|row| row[0] == kind as f64 && row[2] == slice as f64));
            }
        }
        assert!(rows.iter().any(|row| row[5].abs() > 1e-4) && rows.iter().any(|row| row[6].abs() > 1e-4));
    }
}
