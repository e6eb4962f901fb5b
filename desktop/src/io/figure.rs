//! A measured figure with its bound.

use serde::Serialize;

/// One measured number. Names are dotted and stable, such as `pil.s2.compensated.rms`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Dotted, stable name.
    pub name: String,
    /// Measured value, in `unit`.
    pub value: f64,
    /// SI unit or "1".
    pub unit: String,
    /// Largest allowed value, smallest when `at_least`; `None` when the figure is only reported.
    pub bound: Option<f64>,
    /// The value must not be below its bound, instead of not above. In JSON only where it is so.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub at_least: bool,
    /// The value is within its bound, or has none.
    pub holds: bool,
    /// Of the worst of many samples of the plant, the seed. In JSON only where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Which noise on that plant, where it is another than the seed's own. In JSON only there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<u32>,
    /// Name of its row in the table of bounds, where it has one. Not in JSON.
    #[serde(skip)]
    pub row: Option<&'static str>,
}

impl Figure {
    /// A figure that must not exceed `bound`; NaN never holds.
    pub fn bounded(name: impl Into<String>, value: f64, unit: impl Into<String>, bound: f64) -> Self {
        Self { bound: Some(bound), holds: value <= bound, ..Self::reported(name, value, unit) }
    }

    /// A figure that must not be below `bound`; NaN never holds.
    pub fn at_least(name: impl Into<String>, value: f64, unit: impl Into<String>, bound: f64) -> Self {
        Self {
            bound: Some(bound),
            at_least: true,
            holds: value >= bound,
            ..Self::reported(name, value, unit)
        }
    }

    /// A figure without a bound.
    pub fn reported(name: impl Into<String>, value: f64, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value,
            unit: unit.into(),
            bound: None,
            at_least: false,
            holds: true,
            seed: None,
            noise: None,
            row: None,
        }
    }

    /// The same, only reported: it is not measured as its row says, and is no value of it.
    #[must_use]
    pub fn without_bound(self) -> Self {
        Self { bound: None, at_least: false, holds: true, row: None, ..self }
    }

    /// The same, of the sample of this seed.
    #[must_use]
    pub fn of_seed(self, seed: u64) -> Self {
        Self { seed: Some(seed), ..self }
    }

    /// The same, with this noise on the sample: 0 is the seed's own.
    #[must_use]
    pub fn of_noise(self, realisation: u32) -> Self {
        Self { noise: (realisation > 0).then_some(realisation), ..self }
    }

    /// Headings of the cells of a printed row.
    pub const HEADER: [&str; 5] = ["name", "value", "unit", "bound", "holds"];

    /// The row for people; `-` for a bound that there is not.
    pub fn cells(&self) -> [String; 5] {
        let holds = match (self.bound, self.holds) {
            (None, _) => "-",
            (Some(_), true) => "yes",
            (Some(_), false) => "NO",
        };
        let bound = self.bound_text(number);
        [self.name.clone(), number(self.value), self.unit.clone(), bound, holds.into()]
    }

    /// The bound for people, its number written by `number`: `-` when there is none.
    pub fn bound_text(&self, number: impl FnOnce(f64) -> String) -> String {
        let sense = if self.at_least { ">= " } else { "" };
        self.bound.map_or_else(|| "-".into(), |bound| format!("{sense}{}", number(bound)))
    }
}

/// Four digits, in powers of ten when far from 1; whole numbers as they are.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value.fract() == 0.0 && size < 1e9 {
        format!("{value}")
    } else if (1e-2..1e5).contains(&size) {
        let decimals = (3.0 - size.log10().floor()).clamp(0.0, 5.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let cases = [
            (0.0, "0"),
            (828.0, "828"),
            (1.23456, "1.235"),
            (-0.0123456, "-0.01235"),
            (1.2e-10, "1.200e-10"),
        ];
        for (value, expected) in cases {
            assert_eq!(number(value), expected);
        }
        assert_eq!(
            (number(123.456), number(99_999.9), number(f64::NAN)),
            ("123.5".into(), "100000".into(), "NaN".into())
        );
    }
}
