//! Family of motions from which a plan is made, each from rest to rest at the zero angle, and [`PART`] s long.
//!
//! | kind | members |
//! | --- | --- |
//! | triangles | up and down at one slow speed, three amplitudes, of which the last is three times the first; 0.03 to 0.2 of the top speed |
//! | speeds | three speeds both ways, the slowest a quarter of the fastest; 0.2 to 1 of the top speed |
//! | chirp | a sine whose frequency rises from a tenth of its end; to 0.5 to 2 Hz |
//! | pendulum | to one side, to the other and back; 0.2 to 1 of the way that the top speed allows |
//!
//! Top speed v (rad/s at the output):
//!
//! ```text
//! v = min(0.9*0.95*omega_max, 0.25*sqrt(K1/J_fs))/abs n
//! ```
//!
//! The order 2 of the kinematic error, twice the motor's speed, then stays below half of the joint's own frequency, which it would
//! excite. A member that leaves its range, or takes more than half of what the gear or the motor can give, is made smaller; one that is then like
//! another of its kind, within a tenth, is left out.

use std::f64::consts::TAU;

use crate::bench::Trajectory;
use crate::bench::task::{integral_of_smooth, rest_to_rest, smooth};
use crate::io::gear_file::GearFile;
use crate::io::log::{CommandedMotion, Time};

/// Length of a part (s).
pub(super) const PART: f64 = 8.0;
/// Interval of its rows (s).
pub(super) const INTERVAL: f64 = 0.01;
/// Rest at its end (s).
const REST: f64 = 0.2;
/// Longest time from rest to speed (s).
const START: f64 = 0.3;
/// Fraction of torques that a member may take, of speed too.
const SHARE: [f64; 2] = [0.5, 0.9];
/// Members of one kind that differ by less than this fraction of the farther one's way are one.
const ALIKE: f64 = 0.1;
/// Factor by which a member that takes more is made smaller, and how often.
const SMALLER: (f64, usize) = (0.7, 30);

/// Kind of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Triangles,
    Speeds,
    Chirp,
    Pendulum,
}

impl Kind {
    pub const ALL: [Self; 4] = [Self::Triangles, Self::Speeds, Self::Chirp, Self::Pendulum];

    pub fn name(self) -> &'static str {
        ["triangles", "speeds", "chirp", "pendulum"][self as usize]
    }

    /// Its members' sizes: fractions of the top speed, or frequencies (Hz).
    fn sizes(self) -> &'static [f64] {
        match self {
            Self::Triangles => &[0.03, 0.06, 0.1, 0.15, 0.2],
            Self::Speeds => &[0.2, 0.4, 0.6, 0.8, 1.0],
            Self::Chirp => &[0.5, 0.75, 1.0, 1.5, 2.0],
            Self::Pendulum => &[0.2, 0.4, 0.6, 0.8, 1.0],
        }
    }

    /// Angle at a time (rad), with this top speed (rad/s).
    fn at(self, size: f64, top: f64, time: f64) -> f64 {
        let moving = PART - REST;
        match self {
            Self::Triangles => {
                let third = size * top * moving / 24.0;
                legs(
                    time,
                    &[1.0, -2.0, 3.0, -4.0, 5.0, -6.0, 3.0].map(|d| (third * d, moving * f64::abs(d) / 24.0)),
                )
            }
            Self::Speeds => {
                let way = |fraction: f64| size * top * fraction * (moving / 6.0 - START);
                let ways = [way(0.25), -way(0.25), -way(0.5), way(0.5), way(1.0), -way(1.0)];
                legs(time, &ways.map(|way| (way, moving / 6.0)))
            }
            Self::Chirp => {
                let (end, x) = (size, time / moving);
                let phase = TAU * end * moving * (0.1 * x + 0.45 * x * x);
                let envelope = smooth(time).0 * smooth(moving - time).0;
                top / (TAU * end) * envelope * phase.sin()
            }
            Self::Pendulum => {
                let way = size * top * moving / 8.75;
                let quarter = 0.25 * moving;
                rest_to_rest(time, way, quarter).position
                    + rest_to_rest(time - quarter, -2.0 * way, 2.0 * quarter).position
                    + rest_to_rest(time - 3.0 * quarter, way, quarter).position
            }
        }
    }
}

/// A member of the family.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub kind: Kind,
    /// Angles (rad), every [`INTERVAL`], without the last one, which is the first one of the next part.
    pub position: Vec<f64>,
}

impl Part {
    fn of(kind: Kind, size: f64, top: f64, scale: f64) -> Self {
        let rows = (PART / INTERVAL).round() as usize;
        let at = |row: usize| {
            let time = row as f64 * INTERVAL;
            if time < PART - REST { scale * kind.at(size, top, time) } else { 0.0 }
        };
        Self { kind, position: (0..rows).map(at).collect() }
    }

    /// As a task of the joint.
    pub fn trajectory(&self) -> Trajectory {
        let position: Vec<_> = self.position.iter().copied().chain([0.0]).collect();
        let time = Time::every(INTERVAL, position.len());
        Trajectory::of(&CommandedMotion { time, position, velocity: None, acceleration: None, load: None })
    }

    /// For people.
    pub fn title(&self) -> String {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
        let way = largest(&mut self.position.iter().copied());
        let speed = largest(&mut self.position.windows(2).map(|pair| (pair[1] - pair[0]) / INTERVAL));
        format!("{}, {way:.4} rad either way, up to {speed:.4} rad/s", self.kind.name())
    }

    /// It is of the same kind, and nearly as far all the time.
    fn is_like(&self, other: &Self) -> bool {
        let (mut apart, mut farthest) = (0.0f64, 0.0f64);
        for (a, b) in self.position.iter().zip(&other.position) {
            apart = apart.max((a - b).abs());
            farthest = farthest.max(a.abs()).max(b.abs());
        }
        self.kind == other.kind && apart < ALIKE * farthest
    }

    fn is_within(&self, range: f64, gear: &GearFile) -> bool {
        self.position.iter().all(|angle| angle.abs() <= range)
            && self.trajectory().require_within(gear).is_ok()
    }
}

/// Every member that this joint can do within `range` (rad) either way.
pub(super) fn family(gear: &GearFile, range: f64) -> Vec<Part> {
    let (top, share) = (top_speed(gear), share(gear));
    let member = |kind: Kind, size: f64| {
        let scales = (0..SMALLER.1).map(|times| SMALLER.0.powi(times as i32));
        scales.map(|scale| Part::of(kind, size, top, scale)).find(|part| part.is_within(range, &share))
    };
    let mut family: Vec<Part> = Vec::new();
    for kind in Kind::ALL {
        for part in kind.sizes().iter().filter_map(|size| member(kind, *size)) {
            if !family.iter().any(|other| part.is_like(other)) {
                family.push(part);
            }
        }
    }
    family
}

/// The joint with what a member may take of it.
fn share(gear: &GearFile) -> GearFile {
    let mut share = gear.clone();
    share.gear.peak_torque *= SHARE[0];
    share.motor.peak_torque *= SHARE[0];
    share.motor.rotor_speed_limit *= SHARE[1];
    share
}

/// v
fn top_speed(gear: &GearFile) -> f64 {
    let own = (gear.stiffness.k1 / gear.inertia.flexspline).sqrt();
    let motor = (SHARE[1] * 0.95 * gear.motor.rotor_speed_limit).min(0.25 * own);
    motor / f64::from(gear.gear.signed_ratio().n().unsigned_abs())
}

/// Ways (rad) in times (s), one after the other, each from rest to a constant speed and to rest again.
fn legs(time: f64, legs: &[(f64, f64)]) -> f64 {
    let (mut from, mut elapsed) = (0.0, time);
    for (way, duration) in legs {
        if elapsed < *duration {
            let start = START.min(0.5 * duration);
            let speed = way / (duration - start);
            let ramp = |time: f64| speed * start * integral_of_smooth((time / start).clamp(0.0, 1.0));
            let rest = (duration - elapsed).min(start);
            let steady = speed * (elapsed.min(duration - start) - start).max(0.0);
            // The second ramp is the first one, mirrored in time.
            return from + ramp(elapsed) + steady + (ramp(start) - ramp(rest));
        }
        (from, elapsed) = (from + way, elapsed - duration);
    }
    from
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A leg ends where it should, at a constant speed in between, and goes on there.
    #[test]
    fn legs_are_ways_at_a_constant_speed() {
        let ways = [(0.2, 1.0), (-0.3, 2.0)];
        let at = |time: f64| legs(time, &ways);
        assert!((at(1.0) - 0.2).abs() < 1e-12 && (at(3.0) + 0.1).abs() < 1e-12 && at(0.0) == 0.0);
        assert!((at(1.0 - 1e-9) - 0.2).abs() < 1e-9 && (at(3.0 - 1e-9) + 0.1).abs() < 1e-9);
        let speed = |time: f64| (at(time + 1e-4) - at(time - 1e-4)) / 2e-4;
        for time in [0.35, 0.5, 0.65] {
            assert!((speed(time) - 0.2 / 0.7).abs() < 1e-9, "{time}: {}", speed(time));
        }
        assert!(speed(1.0).abs() < 1e-3 && speed(3.0 - 1e-3).abs() < 1e-3);
    }

    /// Each member is one smooth motion from zero to zero, no faster than the top speed.
    #[test]
    fn members_stay_within_speed_and_range() {
        for gear in [GearFile::default_gear(), slow()] {
            for range in [0.05, 10.0] {
                let found = family(&gear, range);
                assert!(found.len() >= 12 && (range < 1.0 || found.len() == 20), "{}", found.len());
                for part in found {
                    let top = 1.01 * top_speed(&gear);
                    let fastest = part.position.windows(2).map(|pair| (pair[1] - pair[0]).abs() / INTERVAL);
                    let fastest = fastest.fold(0.0, f64::max);
                    assert!(fastest < top && fastest > 0.0, "{}: {fastest} of {top}", part.title());
                    assert!(part.position.iter().all(|angle| angle.abs() <= range), "{}", part.title());
                    assert_eq!((part.position[0], part.position[part.position.len() - 1]), (0.0, 0.0));
                    let jump = part
                        .position
                        .windows(3)
                        .map(|x| (x[2] - 2.0 * x[1] + x[0]).abs())
                        .fold(0.0, f64::max);
                    assert!(jump < 0.3 * top * INTERVAL, "{}: {jump}", part.title());
                }
            }
        }
    }

    /// Its motor limits the speed, not its own frequency.
    fn slow() -> GearFile {
        let mut gear = GearFile::default_gear();
        gear.motor.rotor_speed_limit = 10.0;
        gear
    }
}
