//! The catalogue's stiffness line: torque over torsion in three straight pieces.
//!
//! ```text
//! tau(phi) = sign(phi) * (k1*a + (k2 - k1)*max(0, a - phi1) + (k3 - k2)*max(0, a - phi2)),   a = |phi|
//! phi1 = T1/k1,   phi2 = phi1 + (T2 - T1)/k2
//! ```
//!
//! Torsion in rad, torque in N m, stiffness in N m/rad; odd, continuous, strictly monotone. The
//! inverse has the same form with compliances over torques. A reduced mesh's law has the same form with up to eight
//! pieces ([`TorsionLaw`]). Reference: the gear makers' definition
//! of K1, K2, K3, T1, T2 (e.g. Harmonic Drive HFUS-2A manual, "torsional stiffness").

use crate::branch::seldom;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::real::Real;

/// Parameters of a three-piece line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffnessLineParams<R> {
    /// Slopes of the pieces, each > 0 (N m/rad).
    pub stiffness: [R; 3],
    /// Torques at which the slope changes, 0 < T1 < T2 (N m).
    pub knee_torque: [R; 2],
}

/// An odd, monotone line of P straight pieces with K = P - 1 knees, and its inverse.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<R, const P: usize, const K: usize> {
    by_torsion: Pieces<R, P, K>,
    by_torque: Pieces<R, P, K>,
}

/// The catalogue's three-piece line.
///
/// The catalogue's line of a gear of size 25 with the ratio 100: wind-up at the rated torque, its inverse, and the
/// stored energy as the work of the torque.
///
/// ```
/// use strainwave::flexspline::stiffness_line::StiffnessLineParams;
///
/// let line = StiffnessLineParams { stiffness: [3.1e4_f64, 5.0e4, 5.7e4], knee_torque: [14.0, 48.0] }.build()?;
/// let rated = line.torsion(67.0);
/// assert!((rated - (14.0 / 3.1e4 + 34.0 / 5.0e4 + 19.0 / 5.7e4)).abs() < 1e-15); // 1.46 mrad
/// assert!((line.torque(rated) - 67.0).abs() < 1e-12);
/// assert_eq!(line.torque(-rated), -line.torque(rated));
/// let step = rated / 1e4;
/// let work: f64 = (0..10_000).map(|k| line.torque((f64::from(k) + 0.5) * step) * step).sum();
/// assert!((work - line.energy(rated)).abs() < 1e-9);
/// # Ok::<(), strainwave::Error>(())
/// ```
pub type StiffnessLine<R> = Line<R, 3, 2>;

/// The line of a reduced mesh: the catalogue's, or as many pieces as hold a curve.
pub type TorsionLaw<R> = Line<R, 8, 7>;

/// Odd and continuous in x: `slope*x + offset*sign(x)` on each piece.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pieces<R, const P: usize, const K: usize> {
    pieces: [Piece<R>; P],
    /// Magnitudes of x where the second piece and those after it begin.
    knee: [R; K],
}

#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece<R> {
    slope: R,
    /// Value of the piece extrapolated to x = 0 from above.
    offset: R,
}

impl<R: Real, const P: usize, const K: usize> Pieces<R, P, K> {
    fn new(slope: [R; P], knee: [R; K]) -> Self {
        let mut pieces = slope.map(|slope| Piece { slope, offset: R::ZERO });
        for (k, knee) in knee.into_iter().enumerate() {
            pieces[k + 1].offset = pieces[k].offset + (slope[k] - slope[k + 1]) * knee;
        }
        Self { pieces, knee }
    }

    fn slopes(&self) -> [R; P] {
        self.pieces.map(|piece| piece.slope)
    }

    #[inline(always)]
    fn value(&self, x: R) -> R {
        self.value_on(self.piece(x), x)
    }

    /// The same, where the index of the piece is at hand.
    #[inline(always)]
    fn value_on(&self, piece: usize, x: R) -> R {
        let Piece { slope, offset } = self.pieces[piece];
        slope * x + if x < R::ZERO { -offset } else { offset }
    }

    #[inline(always)]
    fn slope_at(&self, x: R) -> R {
        self.pieces[self.piece(x)].slope
    }

    /// Integral of `value` from 0 to x.
    fn integral(&self, x: R) -> R {
        let mut twice = self.pieces[0].slope * x * x;
        for (knee, pair) in self.knee.iter().zip(self.pieces.windows(2)) {
            let excess = (x.abs() - *knee).max(R::ZERO);
            twice += (pair[1].slope - pair[0].slope) * excess * excess;
        }
        R::lit(0.5) * twice
    }

    /// Index of the piece that holds x: the first three, which is all that most gears have, cost what a line of three costs.
    #[inline(always)]
    fn piece(&self, x: R) -> usize {
        let magnitude = x.abs();
        let beyond = |k: usize| usize::from(magnitude > self.knee[k]);
        let inner = beyond(0) + beyond(1);
        if K == 2 || inner < 2 || beyond(2) == 0 {
            return inner;
        }
        seldom();
        // The bound is no more than a proof to the compiler.
        (3 + (3..K).map(beyond).sum::<usize>()).min(K)
    }
}

impl<R: Real> Pieces<R, 3, 2> {
    /// Slope just above x, and where that slope ends.
    #[inline(always)]
    fn piece_from(&self, x: R) -> (R, R) {
        let ([inner, middle, outer], [near, far]) = (self.slopes(), self.knee);
        if x < -far {
            (outer, -far)
        } else if x < -near {
            (middle, -near)
        } else if x < near {
            (inner, near)
        } else if x < far {
            (middle, far)
        } else {
            (outer, R::MAX)
        }
    }
}

impl<R: Real> StiffnessLineParams<R> {
    /// Checks the parameters and precomputes both directions.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `stiffness` unless every slope is finite and positive, `knee_torque`
    /// unless 0 < T1 < T2.
    pub fn build(&self) -> Result<StiffnessLine<R>, Error> {
        let [t1, t2] = self.knee_torque;
        require(self.stiffness.iter().all(|k| k.is_finite() && *k > R::ZERO), "stiffness")?;
        require(t2.is_finite() && R::ZERO < t1 && t1 < t2, "knee_torque")?;
        let [k1, k2, _] = self.stiffness;
        let knee_torsion = [t1 / k1, t1 / k1 + (t2 - t1) / k2];
        Ok(StiffnessLine {
            by_torsion: Pieces::new(self.stiffness, knee_torsion),
            by_torque: Pieces::new(self.stiffness.map(|k| R::ONE / k), self.knee_torque),
        })
    }

    /// The same line, and how the slope goes on is of no account: pieces that are never reached follow the last.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn build_law(&self) -> Result<TorsionLaw<R>, Error> {
        let StiffnessLine { by_torsion, by_torque } = self.build()?;
        Ok(TorsionLaw { by_torsion: padded(&by_torsion), by_torque: padded(&by_torque) })
    }

    /// The line that is left when a linear spring in series with it is taken out: compliances subtract.
    #[must_use]
    pub fn without_series(&self, stiffness: R) -> Self {
        Self {
            stiffness: self.stiffness.map(|k| R::ONE / (R::ONE / k - R::ONE / stiffness)),
            knee_torque: self.knee_torque,
        }
    }

    /// The line in series with a linear spring: compliances add.
    #[must_use]
    pub fn in_series(&self, stiffness: R) -> Self {
        Self {
            stiffness: self.stiffness.map(|k| R::ONE / (R::ONE / k + R::ONE / stiffness)),
            knee_torque: self.knee_torque,
        }
    }
}

/// The same pieces and knees, the last piece repeated beyond knees that no x reaches.
fn padded<R: Real>(three: &Pieces<R, 3, 2>) -> Pieces<R, 8, 7> {
    Pieces {
        pieces: core::array::from_fn(|k| three.pieces[k.min(2)]),
        knee: core::array::from_fn(|k| if k < 2 { three.knee[k] } else { R::MAX }),
    }
}

impl<R: Real> StiffnessLine<R> {
    /// Slope of the piece that goes on from a torsion upwards (N m/rad), and the torsion where that ends (rad).
    #[inline(always)]
    pub fn piece_from(&self, torsion: R) -> (R, R) {
        self.by_torsion.piece_from(torsion)
    }
}

impl<R: Real> TorsionLaw<R> {
    /// Through the points (torsion, torque), from zero, each above the last, and on with `slope` (N m/rad).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `stiffness` unless every piece rises and is finite.
    pub fn through(points: [(R, R); 7], slope: R) -> Result<Self, Error> {
        let mut slopes = [slope; 8];
        let mut last = (R::ZERO, R::ZERO);
        for (slope, point) in slopes.iter_mut().zip(points) {
            *slope = (point.1 - last.1) / (point.0 - last.0);
            last = point;
        }
        require(slopes.iter().all(|slope| slope.is_positive()), "stiffness")?;
        Ok(Self {
            by_torsion: Pieces::new(slopes, points.map(|(torsion, _)| torsion)),
            by_torque: Pieces::new(slopes.map(|slope| R::ONE / slope), points.map(|(_, torque)| torque)),
        })
    }
}

impl<R: Real, const P: usize, const K: usize> Line<R, P, K> {
    /// Torque for a torsion (N m).
    #[inline(always)]
    pub fn torque(&self, torsion: R) -> R {
        self.by_torsion.value(torsion)
    }

    /// Torque for a torsion (N m), and the index of the piece that it lies on.
    #[inline(always)]
    pub fn torque_and_piece(&self, torsion: R) -> (R, usize) {
        let piece = self.by_torsion.piece(torsion);
        (self.by_torsion.value_on(piece, torsion), piece)
    }

    /// Torsion for a torque (rad).
    #[inline(always)]
    pub fn torsion(&self, torque: R) -> R {
        self.by_torque.value(torque)
    }

    /// Slope of the torsion over the torque (rad/(N m)).
    #[inline(always)]
    pub fn compliance(&self, torque: R) -> R {
        self.by_torque.slope_at(torque)
    }

    /// Its least slope (N m/rad).
    pub fn least_stiffness(&self) -> R {
        self.by_torsion.slopes().into_iter().fold(R::MAX, R::min)
    }

    /// Stored energy (J).
    pub fn energy(&self, torsion: R) -> R {
        self.by_torsion.integral(torsion)
    }

    /// Index of the piece that a torsion lies on.
    #[inline(always)]
    pub fn piece(&self, torsion: R) -> usize {
        self.by_torsion.piece(torsion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE_25: StiffnessLineParams<f64> =
        StiffnessLineParams { stiffness: [3.1e4, 5.0e4, 5.7e4], knee_torque: [14.0, 48.0] };

    #[test]
    fn reproduces_the_makers_worked_example() {
        // HFUS-2A manual: size 32, ratio 100, 60 N m gives 7.15e-4 rad.
        let size_32 = StiffnessLineParams { stiffness: [6.7e4, 1.1e5, 1.2e5], knee_torque: [29.0, 108.0] };
        assert!((size_32.build().unwrap().torsion(60.0) - 7.15e-4).abs() < 1e-6);
    }

    #[test]
    fn refuses_what_is_not_monotone_by_name() {
        let bad = StiffnessLineParams { stiffness: [3.1e4, -1.0, 5.7e4], ..SIZE_25 };
        assert_eq!(bad.build(), Err(Error::OutOfRange("stiffness")));
        let bad = StiffnessLineParams { knee_torque: [48.0, 14.0], ..SIZE_25 };
        assert_eq!(bad.build(), Err(Error::OutOfRange("knee_torque")));
    }

    proptest! {
        #[test]
        fn torsion_undoes_torque(torsion in -1e-2..1e-2f64) {
            let line = SIZE_25.build().unwrap();
            prop_assert!((line.torsion(line.torque(torsion)) - torsion).abs() <= 1e-15);
        }

        #[test]
        fn torque_is_odd_and_is_the_slope_of_the_energy(torsion in -1e-2..1e-2f64) {
            let line = SIZE_25.build().unwrap();
            prop_assert_eq!(line.torque(-torsion), -line.torque(torsion));
            let slope = (line.energy(torsion + 1e-7) - line.energy(torsion - 1e-7)) / 2e-7;
            prop_assert!((slope - line.torque(torsion)).abs() < 2e-3);
        }

        #[test]
        fn a_series_spring_taken_out_and_put_back_changes_nothing(stiffness in 6e4..1e6f64) {
            let again = SIZE_25.without_series(stiffness).in_series(stiffness);
            for (a, b) in again.stiffness.iter().zip(SIZE_25.stiffness) {
                prop_assert!((a / b - 1.0).abs() < 1e-9);
            }
        }
    }
}
