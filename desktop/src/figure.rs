//! A measured figure beside the bound it is asked to keep.

use serde::Serialize;

/// One measured number. Names are dotted and stable, such as `pil.s2.compensated.rms`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Dotted, stable name.
    pub name: String,
    /// What was measured, in `unit`.
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
        Self { name: name.into(), value, unit: unit.into(), bound: None, at_least: false, holds: true }
    }

    /// The bound for people, its number written by `number`: `-` when there is none.
    pub fn bound_text(&self, number: impl FnOnce(f64) -> String) -> String {
        let sense = if self.at_least { ">= " } else { "" };
        self.bound.map_or_else(|| "-".into(), |bound| format!("{sense}{}", number(bound)))
    }
}
