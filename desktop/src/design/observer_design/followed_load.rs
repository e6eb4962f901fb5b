//! How fast a load the filter may follow: no faster than its estimate of one stays apart from the motor's own torque.
//!
//! The filter takes what it does not know of the motor's torque for a load. The disturbance path
//! ([`strainwave::compensator::estimate::disturbance`]) answers a load with a torque of the motor, which is as little known: a loop, with
//! the gain
//!
//! ```text
//! G = A*|Q|*sqrt((c*(1 - m))^2 + (j*m)^2),   m = s*J_wg*n^2*omega^2/K1,   Q = omega_f^2/(i*omega + omega_f)^2
//! ```
//!
//! at the frequency omega. A is the filter's d by 1 N m of the motor's torque, at the output; c and j are the standard deviations of
//! torque constant and rotor's inertia within their tolerances; s and omega_f are the path's. Of its torque 1 holds the load, m turns the
//! motor by the wind-up s. Above the mode of the load on its spring A rises with omega^2, and m above that of the rotor: under a heavy load
//! on a soft gear the path would answer to itself, from limit to limit.
//!
//! With G at most 1 at the frequencies that are looked at a joint does not whose constant and inertia are off by their standard deviations,
//! whatever the phase (small gain). At the ends of both tolerances the gain is up to 2.5 times as large, and friction and the path's
//! dead zone are left out: no margin over the box. The gain falls with the wander of the load that the filter is designed for, so that
//! this is no larger than it may be. Units: rad/s, N m.
//!
//! K. Zhou, J. Doyle, K. Glover, "Robust and optimal control" (1996), chapter 9.

use nalgebra::{Complex, DMatrix, DVector};
use strainwave::compensator::estimate::disturbance::DisturbanceParams;

use super::linearised::{DT, Linearised, Sixth, Unknown, information, optimal};
use super::riccati;
use crate::design::compensation::disturbance_params;
use crate::design::tuned::STANDING_WANDER;
use crate::io::gear_file::GearFile;

/// Frequencies that are looked at, and their range (rad/s): up to where the filter ends.
const FREQUENCIES: u32 = 80;
const RANGE: [f64; 2] = [2.0, 2000.0];
/// Least factor on the wander, and the halvings of the range in which it lies, on a logarithmic scale.
const LEAST: f64 = 1e-3;
const HALVINGS: u32 = 12;

/// As the gains of a gear are designed, for a motor that moves or stands: with a wander of the design that the loop bears, or the file's
/// own.
pub(super) fn designed(file: &GearFile, stands: bool) -> Unknown {
    let known = Unknown::of_file(file);
    let borne = match file.compensation.external_torque_wander {
        Some(_) => 1.0,
        None => wander_factor(file, &known),
    };
    let standing = if stands { STANDING_WANDER.get() } else { 1.0 };
    Unknown { wander: standing * borne * known.wander, ..known }
}

/// Largest factor on the wander of `unknown`, 1e-3..=1, with which the gain of the loop is at most 1; 1e-3 where none has that.
fn wander_factor(file: &GearFile, unknown: &Unknown) -> f64 {
    let path = disturbance_params(file);
    let bears = |factor: f64| {
        let scaled = Unknown { wander: factor * unknown.wander, ..*unknown };
        Follower::design(file, &scaled).is_none_or(|follower| follower.loop_gain(file, &path) <= 1.0)
    };
    if bears(1.0) {
        return 1.0;
    }
    let [mut least, mut most] = [LEAST, 1.0];
    for _ in 0..HALVINGS {
        let middle = f64::sqrt(least * most);
        *(if bears(middle) { &mut least } else { &mut most }) = middle;
    }
    least
}

/// The filter of the motor's encoder alone, as a torque of the motor that it does not know drives its error.
struct Follower {
    /// (1 - l c) A.
    between: DMatrix<Complex<f64>>,
    /// Error after a period with 1 N m of the motor's torque, at the output.
    enters: DVector<Complex<f64>>,
    /// d of a unit of its state (N m).
    load: f64,
}

impl Follower {
    /// `None` when the gear is not observable.
    fn design(file: &GearFile, unknown: &Unknown) -> Option<Self> {
        let model = Linearised::of(file, Sixth::None, unknown);
        let (sensor, size) = (&model.sensors[0], model.units.len());
        let used = information([sensor].into_iter(), size);
        let gain = optimal(sensor, &riccati::covariance(&model.transition, &used, &model.noise)?);
        let left = DMatrix::identity(size, size) - gain * &sensor.row;
        let ratio: f64 = file.gear.signed_ratio().value();
        let speed = DT * ratio / file.inertia.wave_generator;
        let mut enters = DVector::zeros(size);
        (enters[0], enters[1]) = (DT * speed / model.units[0], speed / model.units[1]);
        let complex = |x: f64| Complex::new(x, 0.0);
        Some(Self {
            between: (&left * model.transition).map(complex),
            enters: (&left * enters).map(complex),
            load: model.units[4],
        })
    }

    /// A at a frequency (rad/s).
    fn apparent_load(&self, omega: f64) -> f64 {
        let mut left = -self.between.clone();
        (0..left.nrows()).for_each(|k| left[(k, k)] += Complex::from_polar(1.0, omega * DT));
        // A pole on the circle at just this frequency: no bound.
        let error = left.lu().solve(&self.enters);
        error.map_or(f64::INFINITY, |error| error[4].norm() * self.load)
    }

    /// Largest G.
    fn loop_gain(&self, file: &GearFile, path: &DisturbanceParams<f64>) -> f64 {
        let n = f64::from(file.gear.ratio);
        let rotor = (file.stiffness.k1 / file.inertia.wave_generator).sqrt() / n;
        let [constant, inertia] =
            [file.drive.torque_constant, file.tolerances.rotor_inertia].map(|span| span / 3f64.sqrt());
        let gain = |omega: f64| {
            let moving = path.wind_up_fraction * (omega / rotor).powi(2);
            let unknown = (constant * (1.0 - moving)).hypot(inertia * moving);
            self.apparent_load(omega) * unknown / (1.0 + (omega / path.fast_corner).powi(2))
        };
        let [from, to] = RANGE;
        let frequency = |k: u32| from * (to / from).powf(f64::from(k) / f64::from(FREQUENCIES - 1));
        (0..FREQUENCIES).map(|k| gain(frequency(k))).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::load::with_load;

    fn gain(file: &GearFile, factor: f64) -> f64 {
        let unknown = Unknown::of_file(file);
        let scaled = Unknown { wander: factor * unknown.wander, ..unknown };
        Follower::design(file, &scaled).unwrap().loop_gain(file, &disturbance_params(file))
    }

    /// The default gear with a rotor and a load so many times as heavy.
    fn heavy(rotor: f64, load: f64) -> GearFile {
        let mut file = GearFile::default_gear();
        file.inertia.wave_generator *= rotor;
        let load = load * file.inertia.flexspline;
        with_load(&file, load)
    }

    #[test]
    fn a_constant_torque_is_taken_for_as_large_a_load() {
        for file in [heavy(1.0, 1.0), heavy(4.0, 8.0)] {
            let follower = Follower::design(&file, &Unknown::of_file(&file)).unwrap();
            let apparent = follower.apparent_load(1e-3);
            assert!((apparent - 1.0).abs() < 1e-3, "{apparent}");
        }
    }

    /// Load and motor on a spring: what turns the load is seen through it, (J_fs*s^2 + K1)/K1 times as large.
    #[test]
    fn above_the_mode_of_the_load_it_is_taken_for_a_larger_one() {
        let file = heavy(1.0, 30.0);
        let mode = (file.stiffness.k1 / file.inertia.flexspline).sqrt();
        let follower = Follower::design(&file, &Unknown::of_file(&file)).unwrap();
        let expected = 2f64.powi(2) - 1.0;
        let apparent = follower.apparent_load(2.0 * mode);
        assert!((0.6 * expected..1.5 * expected).contains(&apparent), "{apparent}");
    }

    #[test]
    fn what_has_a_margin_is_left_as_it_is() {
        let file = GearFile::default_gear();
        assert!(gain(&file, 1.0) < 1.0);
        assert_eq!(wander_factor(&file, &Unknown::of_file(&file)), 1.0);
    }

    #[test]
    fn a_heavy_joint_follows_as_fast_as_its_loop_bears() {
        for file in [heavy(8.0, 1.0), heavy(8.0, 10.0)] {
            let factor = wander_factor(&file, &Unknown::of_file(&file));
            assert!(factor < 0.8 && gain(&file, 1.0) > 1.0, "{factor}");
            let there = gain(&file, factor);
            assert!((0.98..=1.0).contains(&there), "{there}");
        }
    }

    /// What is known exactly closes no loop.
    #[test]
    fn the_better_the_motor_is_known_the_faster() {
        let mut file = heavy(8.0, 10.0);
        let before = wander_factor(&file, &Unknown::of_file(&file));
        (file.drive.torque_constant, file.tolerances.rotor_inertia) = (0.01, 0.01);
        assert!(wander_factor(&file, &Unknown::of_file(&file)) > 2.0 * before);
    }
}
