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
    /// Largest allowed value; `None` when the figure is only reported.
    pub bound: Option<f64>,
    /// The value is within its bound, or has none.
    pub holds: bool,
}

impl Figure {
    /// A figure that must not exceed `bound`; NaN never holds.
    pub fn bounded(name: impl Into<String>, value: f64, unit: impl Into<String>, bound: f64) -> Self {
        Self { name: name.into(), value, unit: unit.into(), bound: Some(bound), holds: value <= bound }
    }

    /// A figure without a bound.
    pub fn reported(name: impl Into<String>, value: f64, unit: impl Into<String>) -> Self {
        Self { name: name.into(), value, unit: unit.into(), bound: None, holds: true }
    }
}
