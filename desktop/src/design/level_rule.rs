//! The rule for the levels: how much of each function has margins on top of the cascade.
//!
//! The functions are added one by one in the order of [`FUNCTIONS`], each at the first of the levels 1, 1/2, 1/4 with which
//! every loop of its sensors has its margins over the box and the disturbance path's |L| stays below 1, together with those
//! before it; at none of them it is off. Where the cascade alone misses a margin already, no function may make it worse.

use super::judge::{Judged, judge, unstable};
use super::levels::{FUNCTIONS, Function, Levels};
use super::loops::{Break, Loop};
use super::parts::Parts;
use crate::bench::SensorSet;
use crate::bounds;
use crate::design::cascade_rule::Required;
use crate::gear_file::GearFile;

/// Levels in the order in which they are tried.
pub const LEVELS: [f64; 3] = [1.0, 0.5, 0.25];
/// Of the corners every so many have their poles looked at.
const LOOKED_AT: usize = 7;

/// The margins that the functions must leave: the bounds, or those of the cascade alone where they are less.
fn floors(file: &GearFile, parts: &Parts) -> Required {
    let alone = Loop { set: SensorSet::Motor, broken: Break::Torque, passes: false };
    let [cascade] = judge(file, &Levels::NONE.apply(parts), &[alone], 1, |_| ())[..] else {
        unreachable!("one loop is judged")
    };
    let bounds = Required::BOUNDS;
    Required {
        gain: bounds.gain.min(cascade.gain.value),
        phase: bounds.phase.min(cascade.phase.value),
        delay: bounds.delay.min(cascade.delay.value),
    }
}

fn has(judged: &Judged, floors: &Required) -> bool {
    match judged.of.broken {
        Break::Disturbance => judged.size.value < bounds::DESIGN_SIZE,
        Break::Torque => {
            judged.gain.value >= floors.gain
                && judged.phase.value >= floors.phase
                && judged.delay.value >= floors.delay
        }
    }
}

fn holds(file: &GearFile, parts: &Parts, function: &Function, floors: &Required) -> bool {
    let loops: Vec<_> = function.sets.iter().flat_map(|set| Loop::all(*set)).collect();
    judge(file, parts, &loops, 1, |_| ()).iter().all(|judged| has(judged, floors))
        && unstable(file, parts, &loops, LOOKED_AT, |_| ()).is_empty()
}

/// The levels of a joint with these parts; `progress` is told the share that is done.
pub fn levels(file: &GearFile, parts: &Parts, mut progress: impl FnMut(f64)) -> Levels {
    let floors = floors(file, parts);
    let mut found = Levels::NONE;
    for (place, function) in FUNCTIONS.iter().enumerate() {
        let with = |level: f64| {
            let mut tried = found;
            tried.0[place] = level;
            tried
        };
        let level = LEVELS
            .into_iter()
            .find(|level| holds(file, &with(*level).apply(parts), function, &floors))
            .unwrap_or(0.0);
        found = with(level);
        progress((place + 1) as f64 / FUNCTIONS.len() as f64);
    }
    found
}
