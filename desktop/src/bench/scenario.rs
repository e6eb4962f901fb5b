//! The scenarios S1-S6: demand on the joint and load.

use std::f64::consts::PI;

use crate::bench::task::{Demand, Task, integral_of_smooth, rest_to_rest, smooth};
use crate::design::capability::{Capability, FAST_MOVE, FAST_MOVE_DISTANCE};

/// One of the six scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Scenario {
    /// Repeated small steps under -50 N m (the paper's Fig. 9).
    S1,
    /// Output sine 0.05 rad, 0.2 Hz.
    S2,
    /// 0.5 rad in 0.25 s, rest to rest.
    S3,
    /// Constant 0.1 rad/s at the output.
    S4,
    /// Hold, load 0 -> 40 N m at once.
    S5,
    /// Quasi-static torque loop, wave generator held by a brake: it shows the plant. A joint with a motor encoder alone
    /// sees nothing of this load, and its estimates stay where they were.
    S6,
}

/// A time within a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// (s)
    pub from: f64,
    /// (s)
    pub to: f64,
}

/// When the load of S5 comes (s).
pub const LOAD_STEP_AT: f64 = 0.3;
/// The steps of S1: the first (s), from one to the next (s), and how long each moves (s).
const STEPS: (f64, f64, f64) = (0.4, 0.1, 0.02);
impl Scenario {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::S1, Self::S2, Self::S3, Self::S4, Self::S5, Self::S6];

    /// The name, as in `s2`.
    pub fn name(self) -> &'static str {
        ["s1", "s2", "s3", "s4", "s5", "s6"][self as usize]
    }

    /// One line for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::S1 => "step: repeated small steps, load -50 N m",
            Self::S2 => "reversal: output sine 0.05 rad, 0.2 Hz",
            Self::S3 => "fast move: 0.5 rad in 0.25 s, rest to rest",
            Self::S4 => "crawl: constant 0.1 rad/s at the output",
            Self::S5 => "load step: hold, 0 -> 40 N m at once",
            Self::S6 => "loop: quasi-static +-67 N m, wave generator blocked",
        }
    }

    /// Length (s).
    pub fn duration(self) -> f64 {
        match self {
            Self::S1 => 1.0,
            Self::S2 => 5.0,
            Self::S3 => 0.75,
            Self::S4 => 1.5,
            Self::S5 => 1.0,
            Self::S6 => 4.0,
        }
    }

    /// From here on the error counts: the approach is over (s).
    pub fn judged_from(self) -> f64 {
        match self {
            Self::S1 => 0.3,
            Self::S2 => 1.0,
            Self::S3 => FAST_MOVE,
            Self::S4 => 0.5,
            Self::S5 => 0.2,
            Self::S6 => 0.0,
        }
    }

    /// Stretches of rest after a move.
    pub fn rests(self) -> Vec<Stretch> {
        let (first, every, moving) = STEPS;
        match self {
            Self::S1 => (0..((self.duration() - first) / every).round() as usize)
                .map(|step| first + every * step as f64)
                .map(|start| Stretch { from: start + moving, to: start + every })
                .collect(),
            Self::S3 => vec![Stretch { from: FAST_MOVE, to: self.duration() }],
            _ => Vec::new(),
        }
    }

    /// The wave generator is held by a brake.
    pub fn blocked(self) -> bool {
        self == Self::S6
    }

    /// Demand at `time` (s) on a joint of this capability.
    pub fn at(self, time: f64, capability: &Capability) -> Demand {
        match self {
            Self::S1 => steps(time, capability),
            Self::S2 => sine(time),
            Self::S3 => rest_to_rest(time, FAST_MOVE_DISTANCE, FAST_MOVE).scaled(capability),
            Self::S4 => crawl(time),
            Self::S5 => {
                let load = if time < LOAD_STEP_AT { 0.0 } else { capability.load(40.0) };
                Demand { load, ..Demand::default() }
            }
            Self::S6 => {
                let load = torque_loop(time, self.duration(), capability.rated_torque);
                Demand { load, ..Demand::default() }
            }
        }
    }
}

impl Task for Scenario {
    fn duration(&self) -> f64 {
        Self::duration(*self)
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        Self::at(*self, time, capability)
    }

    fn blocked(&self) -> bool {
        Self::blocked(*self)
    }
}

/// Time in which a joint stops (s).
const STOP: f64 = 0.2;

/// The end of a run: from where it has come the joint stops smoothly, and rests under the load that it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Last demand.
    pub from: Demand,
    /// Natural period of the load on the gear (s).
    pub natural_period: f64,
}

impl Rest {
    /// The least time in which a vibration decays, and in which an oscillation that is kept up shows (s).
    const LEAST: f64 = 0.3;
    /// Natural periods for the first, in which a damping ratio of 0.05 leaves 4 % of a vibration, and for the second.
    const PERIODS: [f64; 2] = [10.0, 2.0];

    /// From here on the joint should be at rest (s).
    pub fn judged_from(&self) -> f64 {
        Self::LEAST.max(Self::PERIODS[0] * self.natural_period)
    }
}

impl Task for Rest {
    fn duration(&self) -> f64 {
        self.judged_from() + Self::LEAST.max(Self::PERIODS[1] * self.natural_period)
    }

    fn at(&self, time: f64, _ability: &Capability) -> Demand {
        let Demand { position, velocity: speed, load, .. } = self.from;
        let x = (time / STOP).min(1.0);
        let (w, w1, w2, w3, _) = smooth(x);
        Demand {
            position: position + speed * STOP * (x - integral_of_smooth(x)),
            velocity: speed * (1.0 - w),
            acceleration: -speed * w1 / STOP,
            jerk: -speed * w2 / (STOP * STOP),
            snap: -speed * w3 / STOP.powi(3),
            load,
        }
    }
}

/// -50 N m on the default gear from the start, then 0.2 mrad more every 0.1 s from 0.4 s on, each a 20 ms move.
fn steps(time: f64, capability: &Capability) -> Demand {
    const HEIGHT: f64 = 2e-4;
    let (first, every, moving) = STEPS;
    let elapsed = (time - first).max(0.0);
    let done = (elapsed / every).floor();
    let mut demand = rest_to_rest(elapsed - every * done, HEIGHT, moving);
    demand.position += HEIGHT * done;
    demand.load = capability.load(-50.0) * smooth(time / 0.1).0;
    demand
}

/// A sine whose amplitude grows smoothly over the first 0.8 s.
fn sine(time: f64) -> Demand {
    let omega = 2.0 * PI * 0.2;
    let (sine, cosine) = (omega * time).sin_cos();
    let (w, w1, w2, w3, w4) = smooth(time / 0.8);
    let (w1, w2, w3, w4) = (w1 / 0.8, w2 / 0.8f64.powi(2), w3 / 0.8f64.powi(3), w4 / 0.8f64.powi(4));
    let (s, s1, s2, s3) = (sine, omega * cosine, -omega * omega * sine, -omega.powi(3) * cosine);
    let s4 = omega.powi(4) * sine;
    Demand {
        position: 0.05 * w * s,
        velocity: 0.05 * (w1 * s + w * s1),
        acceleration: 0.05 * (w2 * s + 2.0 * w1 * s1 + w * s2),
        jerk: 0.05 * (w3 * s + 3.0 * w2 * s1 + 3.0 * w1 * s2 + w * s3),
        snap: 0.05 * (w4 * s + 4.0 * w3 * s1 + 6.0 * w2 * s2 + 4.0 * w1 * s3 + w * s4),
        load: 0.0,
    }
}

/// Smooth start over 0.2 s, then constant speed.
fn crawl(time: f64) -> Demand {
    const SPEED: f64 = 0.1;
    const START: f64 = 0.2;
    let x = (time / START).min(1.0);
    let (w, w1, w2, w3, _) = smooth(x);
    let path = START * integral_of_smooth(x);
    Demand {
        position: SPEED * (path + (time - START).max(0.0)),
        velocity: SPEED * w,
        acceleration: SPEED * w1 / START,
        jerk: SPEED * w2 / (START * START),
        snap: SPEED * w3 / START.powi(3),
        load: 0.0,
    }
}

/// 0 -> +rated -> -rated -> +rated -> 0, a cosine of the time between the turning points.
fn torque_loop(time: f64, duration: f64, rated: f64) -> f64 {
    let part = time / duration * 6.0;
    let eased = |x: f64| 0.5 - 0.5 * (PI * x).cos();
    let (from, to, x) = match part {
        x if x < 1.0 => (0.0, 1.0, x),
        x if x < 3.0 => (1.0, -1.0, (x - 1.0) / 2.0),
        x if x < 5.0 => (-1.0, 1.0, (x - 3.0) / 2.0),
        x => (1.0, 0.0, (x - 5.0).min(1.0)),
    };
    rated * (from + (to - from) * eased(x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::firmware_gear_params;
    use crate::io::gear_file::GearFile;

    /// It goes on where it came from, is one motion, and rests.
    #[test]
    fn a_joint_comes_to_rest_smoothly() {
        let from = Scenario::S4.at(1.5, &Capability::default());
        let rest = Rest { from, natural_period: 0.4 };
        let start = rest.at(0.0, &Capability::default());
        assert_eq!((start.position, start.velocity), (from.position, from.velocity));
        for k in 1..600 {
            let at = |offset: f64| rest.at(f64::from(k) * 1e-3 + offset, &Capability::default());
            assert!(((at(1e-6).position - at(-1e-6).position) / 2e-6 - at(0.0).velocity).abs() < 1e-6);
        }
        assert_eq!(rest.at(rest.judged_from(), &Capability::default()).velocity, 0.0);
        let of = |natural_period| Rest { natural_period, ..rest };
        assert_eq!((rest.duration(), of(0.1).duration(), of(0.02).duration()), (4.8, 1.3, 0.6));
    }

    /// Largest magnitude of a quantity over a scenario.
    fn largest(scenario: Scenario, of: fn(&Demand) -> f64) -> f64 {
        (0..=5000)
            .map(|k| scenario.duration() * f64::from(k) / 5000.0)
            .map(|time| of(&scenario.at(time, &Capability::default())).abs())
            .fold(0.0, f64::max)
    }

    /// Each derivative is the slope of the one before.
    #[test]
    fn derivatives_are_consistent() {
        type Of = fn(&Demand) -> f64;
        let pairs: [(Of, Of); 4] = [
            (|d| d.position, |d| d.velocity),
            (|d| d.velocity, |d| d.acceleration),
            (|d| d.acceleration, |d| d.jerk),
            (|d| d.jerk, |d| d.snap),
        ];
        let h = 1e-6;
        for scenario in Scenario::ALL {
            for (of, derivative) in pairs {
                let scale = largest(scenario, derivative);
                for k in 1..1000 {
                    let t = scenario.duration() * (f64::from(k) + 0.37) / 1001.0;
                    let [before, now, after] =
                        [t - h, t, t + h].map(|t| scenario.at(t, &Capability::default()));
                    let slope = (of(&after) - of(&before)) / (2.0 * h);
                    let error = (slope - derivative(&now)).abs();
                    assert!(error <= 1e-4 * scale, "{scenario:?} at {t}: {error} of {scale}");
                }
            }
        }
    }

    /// The default joint is capable of the demand: speed, torque through the gear and at the motor.
    #[test]
    fn the_default_joint_can_follow() {
        let file = GearFile::default_gear();
        let (n, inertia) = (f64::from(file.gear.ratio), &file.inertia);
        for scenario in Scenario::ALL {
            let speed = n * largest(scenario, |d| d.velocity);
            assert!(speed < file.motor.rotor_speed_limit, "{scenario:?}: {speed} rad/s");
            let acceleration = largest(scenario, |d| d.acceleration);
            let gear = firmware_gear_params::<f64>(&file).unwrap();
            let (rotor, friction) = (gear.input_friction.forward, gear.output_friction.forward);
            let output = inertia.flexspline * acceleration
                + largest(scenario, |d| d.load)
                + friction.static_level
                + friction.viscous * speed / n;
            assert!(output < file.gear.peak_torque, "{scenario:?}: {output} N m");
            let motor = inertia.wave_generator * n * acceleration
                + rotor.static_level
                + rotor.viscous * speed
                + output / n;
            assert!(motor < file.motor.peak_torque, "{scenario:?}: {motor} N m");
        }
    }

    /// Each scenario has its title's numbers, and a judged part.
    #[test]
    fn scenarios_ask_what_their_titles_say() {
        assert!((largest(Scenario::S1, |d| d.load) - 50.0).abs() < 1e-9);
        assert!((largest(Scenario::S2, |d| d.position) - 0.05).abs() < 1e-6);
        assert!((Scenario::S3.at(0.25, &Capability::default()).position - 0.5).abs() < 1e-12);
        assert!((Scenario::S4.at(1.0, &Capability::default()).velocity - 0.1).abs() < 1e-12);
        assert_eq!([0.29, 0.31].map(|time| Scenario::S5.at(time, &Capability::default()).load), [0.0, 40.0]);
        let loads = (0..=4000).map(|k| Scenario::S6.at(f64::from(k) * 1e-3, &Capability::default()).load);
        let (least, greatest) = loads.fold((0.0f64, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
        assert!((least + 67.0).abs() < 1e-3 && (greatest - 67.0).abs() < 1e-3);
        for scenario in Scenario::ALL {
            assert!(scenario.judged_from() < scenario.duration());
        }
    }
}
