//! The one table of bounds: what each claimed figure may be at most, and why.
//!
//! Tests and `strainwave verify` read the same rows. A row that nothing measures, and a bound that has
//! become [`LOOSE`] times too loose, fail a test.

use crate::figure::Figure;

/// The largest value that a figure may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The figure's name, dotted and stable.
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
        why: "f32 torsion up to 1.5 mrad after 10^6 wave-generator turns: a 24-bit difference, 1 unit of which \
              is 1.2e-10 rad; the observer needs 1e-6",
    },
    Bound {
        name: "plant.power_balance",
        value: 1e-6,
        unit: "1",
        why: "what the reference plant's micro-steps leave unaccounted of the energy moved; 1e-4 is asked",
    },
    Bound {
        name: "pil.replay.size_17.rms",
        value: 6e-5,
        unit: "rad",
        why: "a measured gear's output predicted with the catalogue's line alone; a rigid gear misses by 2.4e-4",
    },
    Bound {
        name: "pil.steps_unlike_host",
        value: 0.0,
        unit: "1",
        why: "one generic code, and IEEE arithmetic on both processors: every bit of every output",
    },
    Bound {
        name: "flexspline.8x3.k1",
        value: 2e-3,
        unit: "1",
        why: "relative error of the coarse mesh's small-torsion stiffness against K1, with the ellipse between nodes",
    },
    Bound {
        name: "flexspline.36x4.k1",
        value: 2e-4,
        unit: "1",
        why: "the same of the reference mesh: what the ellipse's pre-strain adds to the links' stiffness",
    },
    Bound {
        name: "flexspline.8x3.line",
        value: 2e-5,
        unit: "1",
        why: "distance from the catalogue's line up to rated torque, as a share of it; the contact has the knees",
    },
    Bound {
        name: "flexspline.36x4.line",
        value: 2e-4,
        unit: "1",
        why: "the same of the reference mesh; 3e-2 is asked",
    },
    Bound {
        name: "flexspline.oracle.mujoco",
        value: 5e-14,
        unit: "m",
        why: "distance of any node of a free shell from MuJoCo's over 1000 steps, strained by up to 0.53 %, where \
              the link law's series ends; 1e-12 is asked",
    },
    Bound {
        name: "flexspline.8x3.reduced.strain",
        value: 4e-5,
        unit: "1",
        why: "strain that any gauge on the reduced mesh lacks: the inner slices' displacement of second order in w0/R; \
              the ellipse alone strains by 4.8e-3",
    },
    Bound {
        name: "flexspline.36x4.reduced.strain",
        value: 8e-5,
        unit: "1",
        why: "the same of the reference mesh; its ellipse strains by 2.3e-3",
    },
    Bound {
        name: "flexspline.8x3.reduced.strain_by_torque",
        value: 6e-6,
        unit: "1",
        why: "what torque times ellipse adds to a strain; rated torque strains by 1.6e-4",
    },
    Bound {
        name: "flexspline.36x4.reduced.strain_by_torque",
        value: 8e-6,
        unit: "1",
        why: "the same of the reference mesh; rated torque strains by 1.9e-4",
    },
    Bound {
        name: "friction.closed_form",
        value: 1e-14,
        unit: "1",
        why: "steps are exact in the path length, whatever their size: rounding is left",
    },
    Bound {
        name: "friction.f32",
        value: 5e-6,
        unit: "1",
        why: "share of the Coulomb level that f32 loses over 10^6 steps of random motion; 1e-4 is asked",
    },
    Bound {
        name: "hysteresis.staircase_against_relays",
        value: 1e-14,
        unit: "1",
        why: "two realisations of one operator on the grid: rounding is left",
    },
    Bound {
        name: "hysteresis.default_gear.width",
        value: 5e-3,
        unit: "1",
        why: "relative error of the catalogue's 1 arcmin; the grid of 24 levels rounds the branches off",
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
    /// The figure `value` beside this bound.
    pub fn figure(&self, value: f64) -> Figure {
        Figure::bounded(self.name, value, self.unit, self.value)
    }

    /// The bound is so far above `value` that it would not notice a loss of accuracy.
    pub fn is_loose(&self, value: f64) -> bool {
        value * LOOSE < self.value
    }
}

/// The row of a name.
pub fn find(name: &str) -> Option<&'static Bound> {
    BOUNDS.iter().find(|bound| bound.name == name)
}

/// The measured `value` under a name of its own, beside the bound of the row `row`.
///
/// # Panics
/// As [`figure`].
pub fn figure_as(name: impl Into<String>, row: &str, value: f64) -> Figure {
    Figure { name: name.into(), ..figure(row, value) }
}

/// The measured `value` beside the bound of that name.
///
/// # Panics
/// When the table has no such row, which is a mistake in the program: a measured claim has a bound.
pub fn figure(name: &str, value: f64) -> Figure {
    let bound = find(name).unwrap_or_else(|| panic!("no bound is named {name}"));
    bound.figure(value)
}
