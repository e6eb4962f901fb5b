//! The one table of bounds: what each claimed figure may be at most, and why.
//!
//! Tests and `strainwave verify` read the same rows. A row that nothing measures, and a bound that has
//! become [`LOOSE`] times too loose, fail a test.

use crate::figure::Figure;

/// The largest value that a figure may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The figure's name, dotted and stable; a part `*` stands for any one part, as in a row for all scenarios.
    pub name: &'static str,
    /// Largest allowed value, in `unit`.
    pub value: f64,
    /// SI unit or "1".
    pub unit: &'static str,
    /// What the value follows from.
    pub why: &'static str,
}

/// A bound this many times its figure says nothing any more.
pub const LOOSE: f64 = 10.0;

/// Every bound, by name.
pub const BOUNDS: &[Bound] = &[
    Bound {
        name: "angle.torsion.million_turns",
        value: 2e-10,
        unit: "rad",
        why: "f32 torsion up to 1.5 mrad after 10^6 wave-generator turns: a 24-bit difference, 1 unit of which is \
          1.2e-10 rad; the observer needs 1e-6",
    },
    Bound {
        name: "pil.*.power_balance",
        value: 1e-4,
        unit: "1",
        why: "what the reference plant's micro-steps may leave unaccounted of the energy moved",
    },
    Bound {
        name: "gear.real_time.output_position.max",
        value: 2e-6,
        unit: "rad",
        why: "a sixth of a 19-bit encoder's count, 1.2e-5 rad",
    },
    Bound {
        name: "gear.real_time.torsion.max",
        value: 2e-6,
        unit: "rad",
        why: "0.14 % of the torsion at rated torque",
    },
    Bound {
        name: "gear.real_time.transmitted_torque.max",
        value: 0.1,
        unit: "N m",
        why: "0.15 % of rated torque",
    },
    Bound {
        name: "gear.real_time.wave_generator_torque.max",
        value: 4e-3,
        unit: "N m",
        why: "a ninth of the Coulomb friction at the wave generator",
    },
];

impl Bound {
    /// The figure `name` with `value` beside this bound.
    fn figure(&self, name: &str, value: f64) -> Figure {
        Figure::bounded(name, value, self.unit, self.value)
    }

    /// The row is about the figure `name`.
    fn covers(&self, name: &str) -> bool {
        let (ours, theirs) = (self.name.split('.'), name.split('.'));
        ours.clone().count() == theirs.clone().count()
            && ours.zip(theirs).all(|(ours, theirs)| ours == "*" || ours == theirs)
    }

    /// The bound is so far above `value` that it would not notice a loss of accuracy.
    pub fn is_loose(&self, value: f64) -> bool {
        value * LOOSE < self.value
    }
}

/// The row of a name; one that has it in full comes before one with a `*`.
pub fn find(name: &str) -> Option<&'static Bound> {
    let exact = BOUNDS.iter().find(|bound| bound.name == name);
    exact.or_else(|| BOUNDS.iter().find(|bound| bound.covers(name)))
}

/// The measured `value` beside the bound of that name.
///
/// # Panics
/// When the table has no such row, which is a mistake in the program: a measured claim has a bound.
pub fn figure(name: &str, value: f64) -> Figure {
    let bound = find(name).unwrap_or_else(|| panic!("no bound is named {name}"));
    bound.figure(name, value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUND: Bound = Bound { name: "a.*.b", value: 2.0, unit: "1", why: "an example" };

    #[test]
    fn a_figure_holds_up_to_its_bound_and_nan_never() {
        let holds = |value| BOUND.figure("a.x.b", value).holds;
        assert!(holds(2.0) && !holds(2.1) && !holds(f64::NAN));
        assert_eq!(BOUND.figure("a.x.b", 1.0).name, "a.x.b");
        assert!(BOUND.is_loose(0.19) && !BOUND.is_loose(0.21));
    }

    #[test]
    fn a_star_is_one_part() {
        assert!(BOUND.covers("a.s1.b") && BOUND.covers("a.s2.b"));
        assert!(!BOUND.covers("a.b") && !BOUND.covers("a.s1.x.b") && !BOUND.covers("a.s1.c"));
    }
}
