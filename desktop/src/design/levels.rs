//! How much of each function has margins.
//!
//! Levels are 0..=1, factors on what the rules of [`crate::compensation`] give. They are added one by one, damping, fast part,
//! integral: each at the largest level with which every margin is at least its bound, or as good as without any function.

use std::collections::HashMap;
use std::sync::{LazyLock, Mutex};

use strainwave::Error;

use super::{Break, Judged, judge, parts};
use crate::bench::SensorSet;
use crate::bounds;
use crate::gear_file::GearFile;

/// The gains follow from the levels that have margins; otherwise all are 1, and `design` only prints what it found.
pub const APPLIED: bool = false;

/// Steps of a bisection: to 1/16.
const STEPS: u32 = 4;
/// Of the corners every so many are looked at while levels are sought.
const COARSE: usize = 37;

/// Factors on the functions, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Disturbance path's fast part: its share and its corner.
    pub fast_share: f64,
    /// Output feedback's b.
    pub damping: f64,
    /// Output feedback's k.
    pub integral: f64,
}

impl Levels {
    /// As the rules have them.
    pub const FULL: Self = Self { fast_share: 1.0, damping: 1.0, integral: 1.0 };
    /// None.
    pub const NONE: Self = Self { fast_share: 0.0, damping: 0.0, integral: 0.0 };

    /// Each with its name, in the order in which they are added.
    pub fn named(&self) -> [(&'static str, f64); 3] {
        [
            ("output feedback: damping", self.damping),
            ("disturbance path: fast part", self.fast_share),
            ("output feedback: integral", self.integral),
        ]
    }

    fn of(&mut self, function: usize) -> &mut f64 {
        match function {
            0 => &mut self.damping,
            1 => &mut self.fast_share,
            _ => &mut self.integral,
        }
    }
}

/// Values of a judgement that are asked for, the more the better.
fn values(judged: &[Judged]) -> Vec<(f64, f64)> {
    judged
        .iter()
        .flat_map(|j| match j.broken {
            Break::Torque => vec![
                (j.gain.value, bounds::DESIGN_GAIN),
                (j.phase.value, bounds::DESIGN_PHASE),
                (j.delay.value, bounds::DESIGN_DELAY),
            ],
            Break::Disturbance => vec![(-j.size.value, -bounds::DESIGN_SIZE)],
        })
        .collect()
}

/// Levels that have margins, and the function that each lower one is for; kept for a file that is asked for again.
pub fn levels(file: &GearFile) -> Levels {
    static KNOWN: LazyLock<Mutex<HashMap<String, Levels>>> = LazyLock::new(Mutex::default);
    if !APPLIED {
        return Levels::FULL;
    }
    let key = file.to_toml();
    if let Some(levels) = KNOWN.lock().ok().and_then(|known| known.get(&key).copied()) {
        return levels;
    }
    let levels = sought(file).unwrap_or(Levels::NONE);
    if let Ok(mut known) = KNOWN.lock() {
        known.insert(key, levels);
    }
    levels
}

/// The levels that a joint's margins allow.
///
/// # Errors
/// As [`parts`].
pub fn sought(file: &GearFile) -> Result<Levels, Error> {
    let parts = parts(file, &Levels::NONE)?;
    let look = |levels: &Levels| values(&judge(file, &parts.at(file, levels), &SensorSet::ALL, COARSE));
    let bare = look(&Levels::NONE);
    let holds = |levels: &Levels| {
        let found = look(levels);
        // As good as without: to a thousandth of the bound.
        found
            .iter()
            .zip(&bare)
            .all(|((x, bound), (without, _))| *x >= bound.min(*without) - 1e-3 * bound.abs())
    };
    if holds(&Levels::FULL) {
        return Ok(Levels::FULL);
    }
    let mut levels = Levels::NONE;
    for function in 0..3 {
        let with = |level: f64| {
            let mut tried = levels;
            *tried.of(function) = level;
            tried
        };
        let (mut least, mut most) = (0.0, 1.0);
        if holds(&with(1.0)) {
            least = 1.0;
        } else {
            for _ in 0..STEPS {
                let middle = 0.5 * (least + most);
                if holds(&with(middle)) {
                    least = middle;
                } else {
                    most = middle;
                }
            }
        }
        levels = with(least);
    }
    Ok(levels)
}
