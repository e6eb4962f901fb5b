//! The gains of a joint that has another load, or another gear, than that which they were tuned for.
//!
//! ```text
//! f_v' = f_v*(1 + L)/(1 + L'),   L = J_fs/(N^2*J_wg)      k_v stays: above the torsion mode it meets the rotor alone
//! f_p' = f_p*f_v'/f_v,   T_i' = T_i*f_v/f_v'              the loops stay as far apart
//! I' = I*w'/w,   f_l' = f_l*w'/w,   D' = D*w/w'           w = sqrt(K2/J_fs), the torsion's mode
//! ```
//!
//! All others stay, and each stays within its range.
//!
//! The compensator's cascade is B0's, with a faster position loop and a shorter integral time, both slowed down where they would
//! feed the torsion mode. Moved by the gear's torque T, the motor's speed is
//!
//! ```text
//! v = T/(n*k_v) * s^2/(s^2 + (k_p + 1/T_i)*s + w_0^2),     w_0^2 = k_p/T_i,  k_p = 2*pi*f_p
//! Re(v/T) ~ w^2 - w_0^2 at s = i*w
//! ```
//!
//! so that the cascade takes energy out of a mode that is faster than w_0 and puts energy into a slower one. w_0 is at most the torsion's
//! mode with the softest slope of the line.

use std::f64::consts::TAU;

use crate::bench::baseline::gains::torsion_mode;
use crate::bench::baseline::{BaselineGains, Kind};
use crate::io::gear_file::{Baselines, Feedback, GearFile, Stiffness};

/// L.
pub fn load_ratio(file: &GearFile) -> f64 {
    let n = f64::from(file.gear.ratio);
    file.inertia.flexspline / (n * n * file.inertia.wave_generator)
}

impl BaselineGains {
    /// These gains of the joint `from`, for the joint `to`.
    #[must_use]
    pub fn carried_over(&self, kind: Kind, from: &GearFile, to: &GearFile) -> Self {
        let loop_speed = (1.0 + load_ratio(from)) / (1.0 + load_ratio(to));
        let mode = torsion_mode(to) / torsion_mode(from);
        let mut gains = Self {
            position_bandwidth: self.position_bandwidth * loop_speed,
            velocity_bandwidth: self.velocity_bandwidth * loop_speed,
            integral_time: self.integral_time / loop_speed,
            output_integral: self.output_integral * mode,
            output_derivative: self.output_derivative / mode,
            output_low_pass: self.output_low_pass * mode,
            ..*self
        };
        for gain in kind.gains() {
            let place = (gain.place)(&mut gains);
            *place = place.clamp(gain.range[0], gain.range[1]);
        }
        gains
    }
}

/// f_p of the compensator's cascade over that of B0. With feed-forward the position loop need not be slow for the setpoint's
/// steps: it follows a load step better. At 1.9 it oscillates about rest where friction has no presliding.
const POSITION_BANDWIDTH: f64 = 1.5;
/// T_i over that of B0: with feed-forward a step of the setpoint does not overshoot by the integral, which so may take up a
/// load sooner. Chosen on training joints: 140 of 1250 runs are worse than a baseline, with B0's own 188. At 0.55 the default
/// gear's cascade has no phase margin left with half of its load on a link of 20 Hz, here 3.5 degrees, with B0's own 9.
const INTEGRAL_TIME: f64 = 0.65;

/// w_0 of a cascade (rad/s).
fn own_frequency(feedback: &Feedback) -> f64 {
    (TAU * feedback.position_bandwidth / feedback.integral_time).sqrt()
}

/// The torsion's mode with the softest slope of the line (rad/s).
fn softest_mode(file: &GearFile) -> f64 {
    let Stiffness { k1, k2, k3, .. } = file.stiffness;
    (k1.min(k2).min(k3) / file.inertia.flexspline).sqrt()
}

/// The cascade that the compensator has: that of B0, its position loop half as fast again, its integral time shorter; both slower by
/// the same factor where w_0 were above the torsion's mode.
pub(super) fn feedback(file: &GearFile) -> Feedback {
    let gains = BaselineGains::of(file, Kind::B0);
    let fast = Feedback {
        position_bandwidth: POSITION_BANDWIDTH * gains.position_bandwidth,
        velocity_bandwidth: gains.velocity_bandwidth,
        integral_time: INTEGRAL_TIME * gains.integral_time,
    };
    let slower = (softest_mode(file) / own_frequency(&fast)).min(1.0);
    Feedback {
        position_bandwidth: slower * fast.position_bandwidth,
        integral_time: fast.integral_time / slower,
        ..fast
    }
}

/// The joint `to` with the baselines of the joint `from`, and the cascade of its B0.
fn with_gains_of(from: &GearFile, mut to: GearFile) -> GearFile {
    let mut baselines = Baselines::default();
    for kind in Kind::ALL {
        baselines.set(kind, &BaselineGains::of(from, kind).carried_over(kind, from, &to));
    }
    to.baselines = Some(baselines);
    to.feedback = feedback(&to);
    to
}

/// The joint of a gear file with another load (kg m^2), its cascade and baselines by the rule.
pub fn with_load(file: &GearFile, inertia: f64) -> GearFile {
    let mut joint = file.clone();
    joint.inertia.flexspline = inertia;
    with_gains_of(file, joint)
}

/// A gear file that nobody has tuned, with the cascade and baselines of the default gear by the rule.
pub fn untuned(file: GearFile) -> GearFile {
    with_gains_of(&GearFile::default_gear(), file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_load_has_the_same_gains() {
        let file = GearFile::default_gear();
        assert_eq!(with_load(&file, file.inertia.flexspline).baselines, file.baselines);
    }

    /// Below its own frequency the cascade would feed the mode; where it is slow enough it is as it was.
    #[test]
    fn the_cascade_feeds_no_torsion_mode() {
        let default = GearFile::default_gear();
        let mut slowed = 0;
        for load in [0.3, 1.2, 6.0, 24.0] {
            let joint = with_load(&default, load);
            let faster = POSITION_BANDWIDTH * BaselineGains::of(&joint, Kind::B0).position_bandwidth;
            let (own, mode) = (own_frequency(&joint.feedback), softest_mode(&joint));
            assert!(own <= (1.0 + 1e-12) * mode, "{load}: {own} {mode}");
            if own < (1.0 - 1e-12) * mode {
                assert_eq!(joint.feedback.position_bandwidth, faster, "{load}");
            } else {
                slowed += 1;
            }
        }
        for file in crate::catalogue::FILES.iter().map(|file| file.gear()) {
            let (own, mode) = (own_frequency(&file.feedback), softest_mode(&file));
            assert!(own <= (1.0 + 1e-12) * mode, "{}: {own} {mode}", file.gear.name);
            slowed += usize::from(own > (1.0 - 1e-12) * mode);
        }
        assert!(slowed > 5, "{slowed}");
    }

    /// The real part of the motor's speed by the gear's torque, as the cascade's equation gives it.
    #[test]
    fn a_cascade_takes_energy_from_modes_above_its_own_frequency_alone() {
        let feedback = GearFile::default_gear().feedback;
        let (position_gain, integral_time) = (TAU * feedback.position_bandwidth, feedback.integral_time);
        let mobility = |omega: f64| {
            let s = nalgebra::Complex::new(0.0, omega);
            let error = position_gain / s + 1.0;
            (error * (1.0 + 1.0 / (integral_time * s))).inv().re
        };
        let own = own_frequency(&feedback);
        for above in [1.01, 1.5, 4.0] {
            assert!(mobility(above * own) > 0.0 && mobility(own / above) < 0.0, "{above}");
        }
    }

    /// The gain from speed to torque, k_v = 2 pi f_v (J_wg + J_fs/N^2), is that of before.
    #[test]
    fn the_velocity_gain_stays() {
        let file = GearFile::default_gear();
        let gain = |file: &GearFile| file.feedback.velocity_bandwidth * (1.0 + load_ratio(file));
        for load in [0.3, 1.2, 6.0] {
            let joint = with_load(&file, load);
            assert!((gain(&joint) / gain(&file) - 1.0).abs() < 1e-12, "{load}");
            assert!(joint.check().is_ok());
        }
    }
}
