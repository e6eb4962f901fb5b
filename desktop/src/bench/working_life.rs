//! Working life of a healthy joint: moves, rests and loads within its ratings, drawn at random.
//!
//! | drawn, in units of the default gear | range |
//! | --- | --- |
//! | distance of a move | 1 mrad to 1 rad, even over the logarithm, between -1 and 1 rad |
//! | its duration | once to ten times the shortest, even over the logarithm |
//! | rest after it | 0.05 to 1 s |
//! | load from the start of the rest on, in every second on average | -40 to 40 N m, at once, or within 0.1 s and before the next move |
//!
//! The shortest duration is that in which speed and acceleration are those of S3, 50 ms at least. Loads and moves scale with the
//! joint as those of the scenarios ([`crate::design::capability`]).

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::bench::task::{Demand, Task, rest_to_rest, smooth};
use crate::design::capability::{Capability, FAST_MOVE, FAST_MOVE_DISTANCE};

/// Ends of the distance of a move (rad).
const DISTANCES: [f64; 2] = [1e-3, 1.0];
/// Farthest from the zero angle (rad).
const FARTHEST: f64 = 1.0;
/// The shortest move (s).
const SHORTEST: f64 = 0.05;
/// The slowest move's duration over the shortest.
const SLOWEST: f64 = 10.0;
/// Ends of a rest (s).
const RESTS: [f64; 2] = [0.05, 1.0];
/// Largest load (N m), and the time in which one that does not come at once comes (s).
const LOAD: (f64, f64) = (40.0, 0.1);

/// A move and the rest after it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    /// (s)
    start: f64,
    /// Angle (rad) before and after.
    from: f64,
    to: f64,
    /// Of the move (s).
    duration: f64,
    /// Load (N m) during the move, and from the rest on.
    loads: [f64; 2],
    /// Time in which the load changes (s).
    ramp: f64,
}

/// The working life of one joint; it ends at rest, under a load.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkingLife {
    steps: Vec<Step>,
    duration: f64,
}

impl WorkingLife {
    /// Of at least `duration` (s); the same for the same seed.
    pub fn of(seed: u64, duration: f64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut life = Self { steps: Vec::new(), duration: 0.0 };
        let (mut angle, mut load) = (0.0, 0.0);
        while life.duration < duration {
            let step = Step::drawn(&mut random, life.duration, angle, load);
            (angle, load) = (step.to, step.loads[1]);
            life.duration += step.duration + random.random_range(RESTS[0]..RESTS[1]);
            life.steps.push(step);
        }
        life
    }
}

impl Step {
    fn drawn(random: &mut ChaCha8Rng, start: f64, from: f64, load: f64) -> Self {
        let distance = DISTANCES[0] * (DISTANCES[1] / DISTANCES[0]).powf(random.random_range(0.0..1.0));
        let forward = if (from + distance).abs() > FARTHEST {
            false
        } else {
            (from - distance).abs() > FARTHEST || random.random_bool(0.5)
        };
        let to = if forward { from + distance } else { from - distance };
        let duration = shortest(distance) * SLOWEST.powf(random.random_range(0.0..1.0));
        let next = if random.random_bool(0.5) { random.random_range(-LOAD.0..LOAD.0) } else { load };
        let ramp = if random.random_bool(0.5) { LOAD.1 } else { 0.0 };
        Self { start, from, to, duration, loads: [load, next], ramp }
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        let elapsed = time - self.start;
        let moved = rest_to_rest(elapsed, self.to - self.from, self.duration);
        let [before, after] = self.loads;
        let rest = elapsed - self.duration;
        let share = if rest < 0.0 {
            0.0
        } else if rest < self.ramp {
            smooth(rest / self.ramp).0
        } else {
            1.0
        };
        let load = capability.load(before + (after - before) * share);
        Demand { position: self.from + moved.position, load, ..moved }.scaled(capability)
    }
}

/// Duration of a move with the speed or acceleration of S3 (s).
fn shortest(distance: f64) -> f64 {
    let share = distance / FAST_MOVE_DISTANCE;
    (FAST_MOVE * share).max(FAST_MOVE * share.sqrt()).max(SHORTEST)
}

impl Task for WorkingLife {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        let begun = self.steps.partition_point(|step| step.start <= time);
        self.steps.get(begun.saturating_sub(1)).map_or_else(Demand::default, |step| step.at(time, capability))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::task::tests::require_one_motion;

    fn rows(life: &WorkingLife) -> Vec<Demand> {
        let periods = (life.duration() * 1e3) as u32;
        (0..periods).map(|k| life.at(f64::from(k) * 1e-3, &Capability::default())).collect()
    }

    #[test]
    fn it_stays_within_the_joint_and_uses_it() {
        let rows = rows(&WorkingLife::of(1, 300.0));
        let largest = |of: fn(&Demand) -> f64| rows.iter().map(|demand| of(demand).abs()).fold(0.0, f64::max);
        let (position, velocity) = (largest(|demand| demand.position), largest(|demand| demand.velocity));
        let (acceleration, load) = (largest(|demand| demand.acceleration), largest(|demand| demand.load));
        assert!(position <= FARTHEST && position > 0.5, "{position}");
        assert!(velocity <= 4.375 + 1e-9 && velocity > 1.0, "{velocity}");
        assert!(acceleration <= 60.11 && acceleration > 20.0, "{acceleration}");
        assert!(load <= LOAD.0 && load > 30.0, "{load}");
    }

    #[test]
    fn it_is_one_motion() {
        require_one_motion(&WorkingLife::of(2, 20.0), 1e-4);
    }

    #[test]
    fn a_seed_has_one_life() {
        assert_eq!(WorkingLife::of(3, 5.0), WorkingLife::of(3, 5.0));
        assert_ne!(WorkingLife::of(3, 5.0), WorkingLife::of(4, 5.0));
        assert_eq!(WorkingLife::of(3, 5.0).at(0.0, &Capability::default()).position, 0.0);
    }
}
