//! Curve through the rows of a motion: of all curves through what the rows give, the one of the least squared jerk.
//!
//! ```text
//! integral of (d3x/dt3)^2 dt  least;     between two rows  x = x0 + V0*s + A0/2*s^2 + c3*s^3 + c4*s^4 + c5*s^5
//! s = (t - t0)/h,  V = h*v,  A = h^2*a,  d = x1 - x0
//! c3 =  10*d - 6*V0 - 4*V1 - 1.5*A0 + 0.5*A1
//! c4 = -15*d + 8*V0 + 7*V1 + 1.5*A0 -     A1
//! c5 =   6*d - 3*V0 - 3*V1 - 0.5*A0 + 0.5*A1
//! ```
//!
//! Where the rows give positions alone that is the natural spline of fifth order: derivatives up to the fourth are continuous,
//! the third and the fourth vanish at both ends. Where they give velocities too, the third is continuous; where they give
//! accelerations too, each interval is on its own. Time stamps are as they are: nothing is assumed of their intervals.
//!
//! Rest: over [`REST_ROWS`] rows or more of one position, [`REST`] or more from the first to the last, velocity and acceleration
//! are exactly 0 unless the rows give others. Units: rad, s.

use nalgebra::{Matrix2, Matrix3, Matrix3x4, Matrix4, Vector2, Vector3, Vector4};

/// Least rows of a rest: through three points of one height goes no other parabola.
const REST_ROWS: usize = 3;
/// Shortest rest (s).
const REST: f64 = 0.02;

/// c3, c4, c5 of (V0, A0, V1, A1).
const OF_ENDS: [[f64; 4]; 3] = [[-6.0, -1.5, -4.0, 0.5], [8.0, 1.5, 7.0, -1.0], [-3.0, -0.5, -3.0, 0.5]];
/// c3, c4, c5 of d.
const OF_DISTANCE: [f64; 3] = [10.0, -15.0, 6.0];
/// Integral over s of the squared third derivative, a form of (c3, c4, c5).
const SQUARED_JERK: [[f64; 3]; 3] = [[36.0, 72.0, 120.0], [72.0, 192.0, 360.0], [120.0, 360.0, 720.0]];

/// Position and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Point {
    /// (rad)
    pub position: f64,
    /// (rad/s)
    pub velocity: f64,
    /// (rad/s^2)
    pub acceleration: f64,
    /// (rad/s^3)
    pub jerk: f64,
    /// (rad/s^4)
    pub snap: f64,
}

/// Velocity and acceleration of a row, where it gives them.
type Given = [Option<f64>; 2];

/// The curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    stamps: Vec<f64>,
    /// Position, velocity and acceleration of each row.
    rows: Vec<[f64; 3]>,
}

impl Curve {
    /// Through three rows at least, at strictly increasing time stamps (s).
    pub fn through(
        stamps: &[f64],
        position: &[f64],
        velocity: Option<&[f64]>,
        acceleration: Option<&[f64]>,
    ) -> Self {
        let rests = rests(stamps, position);
        let given: Vec<Given> = (0..position.len())
            .map(|row| {
                let rest = rests[row].then_some(0.0);
                [velocity.map(|v| v[row]).or(rest), acceleration.map(|a| a[row]).or(rest)]
            })
            .collect();
        let motion = least_jerk(stamps, position, &given);
        let rows = position.iter().zip(motion).map(|(position, [v, a])| [*position, v, a]).collect();
        Self { stamps: stamps.to_vec(), rows }
    }

    /// The point at a time (s); at rest in the first row before it, and in the last one from there on.
    pub fn at(&self, time: f64) -> Point {
        let after = self.stamps.partition_point(|stamp| *stamp <= time);
        if after == 0 || after == self.stamps.len() {
            let end = self.rows[after.saturating_sub(1)];
            return Point { position: end[0], ..Point::default() };
        }
        let h = self.stamps[after] - self.stamps[after - 1];
        between(self.rows[after - 1], self.rows[after], h, (time - self.stamps[after - 1]) / h)
    }

    /// Row that is nearest in time.
    pub fn nearest_row(&self, time: f64) -> usize {
        let after = self.stamps.partition_point(|stamp| *stamp <= time).min(self.stamps.len() - 1);
        let before = after.saturating_sub(1);
        if time - self.stamps[before] < self.stamps[after] - time { before } else { after }
    }

    /// Velocity in the first row (rad/s).
    pub fn first_velocity(&self) -> f64 {
        self.rows[0][1]
    }
}

/// The polynomial between two rows, `h` (s) apart, at the fraction `s` of the way.
fn between([x0, v0, a0]: [f64; 3], [x1, v1, a1]: [f64; 3], h: f64, s: f64) -> Point {
    let ends = Vector4::new(h * v0, h * h * a0, h * v1, h * h * a1);
    let c = matrix(OF_ENDS) * ends + Vector3::from(OF_DISTANCE) * (x1 - x0);
    let (c3, c4, c5) = (c[0], c[1], c[2]);
    Point {
        position: x0 + s * (ends[0] + s * (0.5 * ends[1] + s * (c3 + s * (c4 + s * c5)))),
        velocity: (ends[0] + s * (ends[1] + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h,
        acceleration: (ends[1] + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / h.powi(2),
        jerk: (6.0 * c3 + s * (24.0 * c4 + s * 60.0 * c5)) / h.powi(3),
        snap: (24.0 * c4 + s * 120.0 * c5) / h.powi(4),
    }
}

fn matrix(rows: [[f64; 4]; 3]) -> Matrix3x4<f64> {
    Matrix3x4::from_fn(|row, column| rows[row][column])
}

/// Rows of a rest.
fn rests(stamps: &[f64], position: &[f64]) -> Vec<bool> {
    let (mut resting, mut start) = (vec![false; position.len()], 0);
    for run in position.chunk_by(|a, b| a == b) {
        let rows = start..start + run.len();
        if run.len() >= REST_ROWS && stamps[rows.end - 1] - stamps[rows.start] >= REST {
            resting[rows.clone()].fill(true);
        }
        start = rows.end;
    }
    resting
}

/// Velocity and acceleration of every row: the given ones, and those of the least squared jerk.
///
/// The integral is a quadratic form of them that couples neighbours alone; its minimum is the solution of a block
/// tridiagonal system, found by elimination from the first row to the last. Velocities and accelerations count
/// there in units of the mean interval, for the sake of the numbers' range.
fn least_jerk(stamps: &[f64], position: &[f64], given: &[Given]) -> Vec<[f64; 2]> {
    let count = position.len();
    let unit = (stamps[count - 1] - stamps[0]) / (count - 1) as f64;
    let scaled: Vec<Given> =
        given.iter().map(|[v, a]| [v.map(|v| v * unit), a.map(|a| a * unit * unit)]).collect();
    let mut system = System::new(&scaled);
    for (row, (t, x)) in stamps.windows(2).zip(position.windows(2)).enumerate() {
        system.add(row, (t[1] - t[0]) / unit, x[1] - x[0], &scaled);
    }
    system.solve().into_iter().map(|solved| [solved[0] / unit, solved[1] / (unit * unit)]).collect()
}

/// A symmetric block tridiagonal system: a block of velocity and acceleration for each row.
struct System {
    diagonal: Vec<Matrix2<f64>>,
    /// From each row to the next one.
    coupling: Vec<Matrix2<f64>>,
    right: Vec<Vector2<f64>>,
}

impl System {
    /// Says of what is given that it is what is given.
    fn new(given: &[Given]) -> Self {
        let block = |row: &Given| Matrix2::from_diagonal(&Vector2::from(row.map(|g| f64::from(g.is_some()))));
        Self {
            diagonal: given.iter().map(block).collect(),
            coupling: vec![Matrix2::zeros(); given.len() - 1],
            right: given.iter().map(|row| Vector2::from(row.map(Option::unwrap_or_default))).collect(),
        }
    }

    /// Adds the squared jerk between a row and the next one, `h` apart, over the distance `d`.
    fn add(&mut self, row: usize, h: f64, d: f64, given: &[Given]) {
        let scale = Matrix4::from_diagonal(&Vector4::new(h, h * h, h, h * h));
        let of_ends = matrix(OF_ENDS) * scale;
        let form = Matrix3::from_fn(|i, j| SQUARED_JERK[i][j]) / h.powi(5);
        let mut curvature = of_ends.transpose() * form * of_ends;
        let mut right = -(of_ends.transpose() * form * Vector3::from(OF_DISTANCE) * d);
        let known = [given[row], given[row + 1]].concat();
        for (place, value) in known.iter().enumerate().filter_map(|(place, value)| Some((place, (*value)?))) {
            right -= curvature.column(place) * value;
            curvature.column_mut(place).fill(0.0);
            curvature.row_mut(place).fill(0.0);
        }
        for (place, _) in known.iter().enumerate().filter(|(_, value)| value.is_some()) {
            right[place] = 0.0;
        }
        self.diagonal[row] += curvature.fixed_view::<2, 2>(0, 0);
        self.diagonal[row + 1] += curvature.fixed_view::<2, 2>(2, 2);
        self.coupling[row] += curvature.fixed_view::<2, 2>(0, 2);
        self.right[row] += right.fixed_rows::<2>(0);
        self.right[row + 1] += right.fixed_rows::<2>(2);
    }

    fn solve(mut self) -> Vec<Vector2<f64>> {
        let inverse = |block: &Matrix2<f64>| block.try_inverse().expect("the form is positive definite");
        for row in 1..self.diagonal.len() {
            let factor = self.coupling[row - 1].transpose() * inverse(&self.diagonal[row - 1]);
            let (block, right) = (factor * self.coupling[row - 1], factor * self.right[row - 1]);
            self.diagonal[row] -= block;
            self.right[row] -= right;
        }
        let mut solved = self.right;
        for row in (0..solved.len()).rev() {
            if row + 1 < solved.len() {
                let next = self.coupling[row] * solved[row + 1];
                solved[row] -= next;
            }
            solved[row] = inverse(&self.diagonal[row]) * solved[row];
        }
        solved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stamps every 5 ms that jitter by up to 2 ms.
    fn stamps() -> Vec<f64> {
        (0..400).map(|k| 0.005 * f64::from(k) + 0.002 * (f64::from(k * k % 17) / 17.0)).collect()
    }

    /// Position and four derivatives of a sine of 8 rad/s.
    fn sine(t: f64) -> [f64; 5] {
        let (s, c) = (8.0 * t).sin_cos();
        [s, 8.0 * c, -64.0 * s, -512.0 * c, 4096.0 * s]
    }

    fn column(stamps: &[f64], derivative: usize) -> Vec<f64> {
        stamps.iter().map(|t| sine(*t)[derivative]).collect()
    }

    fn numbers(point: &Point) -> [f64; 5] {
        [point.position, point.velocity, point.acceleration, point.jerk, point.snap]
    }

    /// Whatever the file gives, and however its clock jitters, the curve is the motion; away from the ends, where nothing
    /// tells the higher derivatives.
    #[test]
    fn a_smooth_motion_is_found_with_its_derivatives() {
        let stamps = stamps();
        let [x, v, a] = [0, 1, 2].map(|derivative| column(&stamps, derivative));
        for (velocity, acceleration) in [(None, None), (Some(&v[..]), None), (Some(&v[..]), Some(&a[..]))] {
            let curve = Curve::through(&stamps, &x, velocity, acceleration);
            for k in 0..15_000 {
                let time = 0.25 + 1e-4 * f64::from(k);
                let found = numbers(&curve.at(time));
                // In the amplitude of each derivative.
                for (order, most) in [1e-9, 1e-7, 1e-5, 1e-3, 1e-1].into_iter().enumerate() {
                    let off = (found[order] - sine(time)[order]).abs() / 8f64.powi(order as i32);
                    assert!(off < most, "{order} at {time}: {off}");
                }
            }
        }
    }

    /// Every row is met; derivatives go on from one interval to the next as far as they are not given.
    #[test]
    fn the_curve_meets_its_rows_and_goes_on_there() {
        let stamps = stamps();
        let rough: Vec<f64> = (0..stamps.len()).map(|k| (k * k * 31 % 97) as f64 * 1e-4).collect();
        let given: Vec<f64> = (0..stamps.len()).map(|k| (k * 7 % 13) as f64 * 1e-2).collect();
        for (velocity, continuous) in [(None, 5), (Some(&given[..]), 4)] {
            let curve = Curve::through(&stamps, &rough, velocity, None);
            for row in 1..stamps.len() - 1 {
                let [before, after] = [row - 1, row].map(|k| {
                    between(curve.rows[k], curve.rows[k + 1], stamps[k + 1] - stamps[k], {
                        if k == row { 0.0 } else { 1.0 }
                    })
                });
                assert!((after.position - rough[row]).abs() < 1e-15);
                let scales = [1e-2, 10.0, 1e4, 1e7, 1e10];
                let jumps = numbers(&after).into_iter().zip(numbers(&before)).map(|(a, b)| (a - b).abs());
                for (order, (jump, scale)) in jumps.zip(scales).take(continuous).enumerate() {
                    assert!(jump / scale < 1e-7, "{order} in row {row}: {jump}");
                }
                if let Some(velocity) = velocity {
                    assert!((after.velocity - velocity[row]).abs() < 1e-15);
                }
            }
        }
    }

    /// No other curve through the rows has less: any change of velocities and accelerations adds squared jerk.
    #[test]
    fn no_other_curve_has_less_jerk() {
        let stamps = &stamps()[..12];
        let x: Vec<f64> = (0..12).map(|k| f64::from(k * k % 5)).collect();
        let jerk = |curve: &Curve| {
            let steps = 20_000;
            let dt = (stamps[11] - stamps[0]) / f64::from(steps);
            let at = |k: u32| curve.at(stamps[0] + (f64::from(k) + 0.5) * dt).jerk;
            (0..steps).map(|k| at(k).powi(2) * dt).sum::<f64>()
        };
        let least = Curve::through(stamps, &x, None, None);
        for (row, place, change) in [(0, 1, 1.0), (3, 1, -1.0), (5, 2, 300.0), (8, 2, -300.0), (11, 2, 300.0)]
        {
            let mut other = least.clone();
            other.rows[row][place] += change;
            assert!(jerk(&other) > jerk(&least), "{row} {place}");
        }
    }

    /// A rest is exactly one, a slow top of a sine is none.
    #[test]
    fn rows_of_one_position_rest() {
        let stamps: Vec<f64> = (0..200).map(|k| 0.001 * f64::from(k)).collect();
        let x: Vec<f64> = stamps.iter().map(|t| (t - 0.1).max(0.0).powi(4)).collect();
        let curve = Curve::through(&stamps, &x, None, None);
        assert_eq!(curve.at(0.05), Point::default());
        assert_eq!(curve.at(-1.0), Point::default());
        assert!((curve.at(0.15).velocity - 4.0 * 0.05f64.powi(3)).abs() < 1e-9);
        // Symmetric about a row: two or three rows of one position, 2 ms.
        let top: Vec<f64> = stamps.iter().map(|t| (((t - 0.1) * 10.0).cos() * 1e6).round() * 1e-6).collect();
        assert!(Curve::through(&stamps, &top, None, None).at(0.1).acceleration < -50.0);
        let last = curve.at(1.0);
        assert_eq!((last.position, last.velocity, last.acceleration), (x[199], 0.0, 0.0));
    }
}
