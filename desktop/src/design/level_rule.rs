//! The rule for the levels: how much of each function has margins on top of the cascade.
//!
//! The functions are added one by one in the order of [`FUNCTIONS`], each at the first of the levels 1, 1/2, 1/4 with which
//! every loop of its sensors has its margins over the box and the disturbance path's |L| stays below 1, together with those
//! before it; at none of them it is off, and with it what rests on it. Where the cascade alone misses a margin already, no function may make it worse.

use super::cascade_rule::Required;
use super::corners::Corner;
use super::judge::{Judged, Unstable, judge, unstable};
use super::levels::{FUNCTIONS, Function, Levels};
use super::loops::{Break, Loop};
use super::parts::Parts;
use super::variant::Variant;
use crate::design::required;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;

/// Levels in the order in which they are tried.
pub const LEVELS: [f64; 3] = [1.0, 0.5, 0.25];
/// Of the corners every so many have their poles looked at.
const LOOKED_AT: usize = 7;

/// Largest loss, by a function, of a margin that the cascade alone misses, relative to it: rounding between sets of
/// sensors.
const ROUNDING: f64 = 1e-3;

/// The margins that the functions must leave: the bounds, or those of the cascade alone where they are less.
fn floors(file: &GearFile, parts: &Parts) -> Required {
    let alone = Loop { set: SensorSet::Motor, broken: Break::Torque, passes: false };
    let [cascade] = judge(file, &Levels::NONE.apply(parts), &[alone], 1, |_| ())[..] else {
        unreachable!("one loop is judged")
    };
    let bounds = Required::BOUNDS;
    Required {
        gain: bounds.gain.min((1.0 - ROUNDING) * cascade.gain.value),
        phase: bounds.phase.min((1.0 - ROUNDING) * cascade.phase.value),
        delay: bounds.delay.min((1.0 - ROUNDING) * cascade.delay.value),
    }
}

/// A margin that a function leaves none of.
#[derive(Clone, Debug)]
pub struct Miss {
    /// Loop and margin.
    pub what: String,
    /// (dB), (degrees), (control periods), |L| or growth (1/s).
    pub value: f64,
    /// In which corner.
    pub at: Option<(Variant, Corner)>,
}

fn missed(judged: &Judged, floors: &Required) -> Option<Miss> {
    let margins: &[_] = match judged.of.broken {
        Break::Disturbance => &[("largest |L|", judged.size, judged.size.value < required::SIZE)],
        Break::Torque => &[
            ("gain [dB]", judged.gain, judged.gain.value >= floors.gain),
            ("phase [deg]", judged.phase, judged.phase.value >= floors.phase),
            ("delay [period]", judged.delay, judged.delay.value >= floors.delay),
        ],
    };
    let (what, worst, _) = margins.iter().find(|(_, _, holds)| !holds)?;
    Some(Miss { what: format!("{} {what}", judged.of.name()), value: worst.value, at: worst.at })
}

/// The first margin that is missed with these parts.
fn first_missed(file: &GearFile, parts: &Parts, function: &Function, floors: &Required) -> Option<Miss> {
    let loops: Vec<_> = function.sets.iter().flat_map(|set| Loop::all(*set)).collect();
    let judged = judge(file, parts, &loops, 1, |_| ());
    judged.iter().find_map(|judged| missed(judged, floors)).or_else(|| {
        let unstable = unstable(file, parts, &loops, LOOKED_AT, |_| ());
        let growth = |unstable: &&Unstable| unstable.growth.unwrap_or(f64::INFINITY);
        let worst = unstable.iter().max_by(|a, b| growth(a).total_cmp(&growth(b)))?;
        let at = Some((worst.variant, worst.corner));
        Some(Miss { what: "unstable, growth [1/s]".into(), value: growth(&worst), at })
    })
}

/// Levels by the rule.
pub struct Allowed {
    /// The levels.
    pub levels: Levels,
    /// Of a function that is off, what it misses at the least level.
    pub misses: [Option<Miss>; FUNCTIONS.len()],
}

/// The levels of a joint with these parts; `progress` is called with the fraction done.
pub fn levels(file: &GearFile, parts: &Parts, mut progress: impl FnMut(f64)) -> Allowed {
    let floors = floors(file, parts);
    let mut found = Allowed { levels: Levels::NONE, misses: Default::default() };
    for (place, function) in FUNCTIONS.iter().enumerate() {
        if function.needs.is_none_or(|needed| found.levels.0[needed] > 0.0) {
            for level in LEVELS {
                let mut tried = found.levels;
                tried.0[place] = level;
                found.misses[place] = first_missed(file, &tried.apply(parts), function, &floors);
                if found.misses[place].is_none() {
                    found.levels = tried;
                    break;
                }
            }
        }
        progress((place + 1) as f64 / FUNCTIONS.len() as f64);
    }
    found
}
