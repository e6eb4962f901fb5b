//! Table of bounds: the largest allowed value of each claimed figure, and its reason.
//!
//! Tests and `strainwave verify` read the same rows, a file for each part; nearly all are upper bounds, [`FLOORS`] are
//! lower ones. A row that nothing measures fails a test; a bound that has become [`LOOSE`] times too loose fails in `verify`.

mod belt;
mod catalogue;
mod compensator;
mod constants;
mod design;
mod faults;
mod flexspline;
mod friction;
mod gauges;
mod healthy;
mod hysteresis;
mod identify;
mod joint;
mod link;
mod piezo;
mod robot;
mod robustness;
mod sensor;
mod stored_map;

use crate::io::figure::Figure;

/// The largest value that a figure may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The figure's name, dotted and stable.
    pub name: &'static str,
    /// Largest allowed value, in `unit`.
    pub value: f64,
    /// SI unit, what is counted, or "1".
    pub unit: &'static str,
    /// Reason of the value.
    pub why: &'static str,
}

/// Ratio of a bound to its figure above which it is too loose.
pub const LOOSE: f64 = 10.0;

/// Every bound, by part.
pub const BOUNDS: [&[Bound]; 19] = [
    joint::ROWS,
    belt::ROWS,
    catalogue::ROWS,
    compensator::ROWS,
    constants::ROWS,
    design::ROWS,
    faults::ROWS,
    flexspline::ROWS,
    friction::ROWS,
    gauges::ROWS,
    healthy::ROWS,
    hysteresis::ROWS,
    identify::ROWS,
    link::ROWS,
    piezo::ROWS,
    robot::ROWS,
    robustness::ROWS,
    sensor::ROWS,
    stored_map::ROWS,
];

/// Targets of the figures whose bound is the reached value instead, by name.
pub const TARGETS: &[(&str, f64)] = &[
    ("gear.steps.wind_up", 2e-2),
    ("friction.target.cycles", 150.0),
    ("hysteresis.cycles.forward", 150.0),
    ("compensator.motor.s1.vibration_to_b0", 0.1),
    ("compensator.both.s1.vibration_to_b0", 0.05),
    ("compensator.both.s3.vibration_to_b0", 0.2),
    ("compensator.both.s4.ripple_to_b0", 0.05),
    ("compensator.motor.s5.peak_to_b0", 0.6),
    ("compensator.both.s5.peak_to_b0", 0.55),
    ("compensator.motor.s5.steady_to_b0", 0.2),
    ("compensator.motor.map_told.s2.rms_to_b0", 0.15),
    ("compensator.motor.map_learnt.s2.rms_to_b0", 0.15),
    ("compensator.motor.map_absent.s2.rms_to_b0", 0.15),
    ("compensator.both.map_learnt.s2.rms_to_b0", 0.05),
    ("compensator.both.map_absent.s2.rms_to_b0", 0.05),
    ("compensator.motor.map_told.s2.rms_to_best", 0.7),
    ("compensator.motor.map_learnt.s2.rms_to_best", 0.7),
    ("compensator.motor.map_absent.s2.rms_to_best", 0.7),
    ("compensator.both.map_absent.s2.rms_to_best", 0.7),
    ("compensator.motor.map_told.s3.vibration_to_b0", 0.25),
    ("compensator.motor.map_learnt.s3.vibration_to_b0", 0.25),
    ("compensator.motor.map_absent.s3.vibration_to_b0", 0.25),
    ("compensator.both.map_told.s3.vibration_to_b0", 0.2),
    ("compensator.both.map_learnt.s3.vibration_to_b0", 0.2),
    ("compensator.both.map_absent.s3.vibration_to_b0", 0.2),
    ("compensator.motor.map_learnt.s3.vibration_to_best", 0.7),
    ("compensator.motor.map_absent.s3.vibration_to_best", 0.7),
    ("compensator.both.map_learnt.s3.vibration_to_best", 0.7),
    ("compensator.both.map_absent.s3.vibration_to_best", 0.7),
    ("compensator.motor.map_told.s4.ripple_to_b0", 0.02),
    ("compensator.motor.map_learnt.s4.ripple_to_b0", 0.02),
    ("compensator.motor.map_absent.s4.ripple_to_b0", 0.02),
    ("compensator.both.map_learnt.s4.ripple_to_b0", 0.05),
    ("compensator.both.map_absent.s4.ripple_to_b0", 0.05),
    ("compensator.motor.map_told.s4.ripple_to_best", 0.7),
    ("compensator.motor.map_learnt.s4.ripple_to_best", 0.7),
    ("compensator.motor.map_absent.s4.ripple_to_best", 0.7),
    ("compensator.both.map_absent.s4.ripple_to_best", 0.7),
    ("compensator.replay.joints_at_half", 6.0),
    ("pil.real.can.answer", 5e-4),
    ("pil.real.can.position", 1e-5),
    ("pil.real.can.lost.release", 0.1),
    ("pil.real.odrive.answer", 5e-4),
    ("pil.real.odrive.position", 1e-5),
    ("pil.real.odrive.delay", 4e-4),
    ("pil.real.odrive.cycles", 400.0),
    ("pil.real.odrive.lost.release", 0.1),
];

/// Line for a figure that misses its target.
pub fn misses_target(figure: &Figure) -> Option<String> {
    let Figure { name, value, row, .. } = figure;
    let (row, target) = TARGETS.iter().find(|(target, _)| *target == row.unwrap_or(name))?;
    let met = if is_floor(row) { value >= target } else { value <= target };
    let [_, shown, ..] = figure.cells();
    (!met).then(|| format!("{name} is {shown}: target {target}, missed"))
}

/// Smallest allowed values, by name.
pub const FLOORS: &[Bound] = &[
    design::FLOORS[0],
    design::FLOORS[1],
    design::FLOORS[2],
    design::FLOORS[3],
    design::FLOORS[4],
    design::FLOORS[5],
    gauges::FLOORS[0],
    Bound {
        name: "compensator.replay.joints_at_half",
        value: 3.0,
        unit: "1",
        why: "measured joints of six whose output is predicted from the motor side with at most half of a rigid gear's \
              error, after the first third of their motion, with the stiffness of the catalogue; target 6, all of them",
    },
    Bound {
        name: "flexspline.target.literal_over_reduced",
        value: 2000.0,
        unit: "1",
        why: "instructions of the literal 8 x 3 mesh in 0.1 ms over those of its reduction; target 300",
    },
];

impl Bound {
    /// The figure `value` with this bound.
    pub fn figure(&self, value: f64) -> Figure {
        Figure { row: Some(self.name), ..Figure::bounded(self.name, value, self.unit, self.value) }
    }

    /// The figure `value` with this lower bound.
    fn figure_at_least(&self, value: f64) -> Figure {
        Figure { row: Some(self.name), ..Figure::at_least(self.name, value, self.unit, self.value) }
    }

    /// The bound is so far above `value` that it would not notice a loss of accuracy.
    pub fn is_loose(&self, value: f64) -> bool {
        value * LOOSE < self.value
    }
}

/// The row of that name is a lower bound.
pub fn is_floor(name: &str) -> bool {
    FLOORS.iter().any(|floor| floor.name == name)
}

/// The row of a name, an upper bound.
pub fn find(name: &str) -> Option<&'static Bound> {
    BOUNDS.into_iter().flatten().find(|bound| bound.name == name)
}

/// The measured `value` under a name of its own, with the bound of the row `row`.
///
/// # Panics
/// As [`figure`].
pub fn figure_as(name: impl Into<String>, row: &str, value: f64) -> Figure {
    Figure { name: name.into(), ..figure(row, value) }
}

/// The measured `value` with the bound of that name.
///
/// # Panics
/// When the table has no such row, which is a mistake in the program: a measured claim has a bound.
pub fn figure(name: &str, value: f64) -> Figure {
    let floor = || FLOORS.iter().find(|floor| floor.name == name);
    let figure =
        find(name).map(|bound| bound.figure(value)).or_else(|| floor().map(|f| f.figure_at_least(value)));
    figure.unwrap_or_else(|| panic!("no bound is named {name}"))
}
