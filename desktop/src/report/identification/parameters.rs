//! Table of what was identified: base value, identified value, interval, and what it comes to.

use maud::{Markup, html};

use crate::io::figure::number;

/// Standard errors in an interval of 95 %.
const INTERVAL: f64 = 1.96;

/// A row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parameter {
    /// As the file names it, where it is in the file.
    pub name: String,
    pub unit: &'static str,
    pub base: Option<f64>,
    pub identified: f64,
    /// Standard error.
    pub deviation: Option<f64>,
    /// Ends of an interval of 95 % that is not about the identified value.
    ends: Option<[f64; 2]>,
    /// The least that it can be.
    least: f64,
    pub finding: Finding,
}

/// What a row comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    /// As its interval says.
    Identified,
    /// The search would have gone on.
    AtLimit,
    /// The base gear's stays.
    Kept,
    /// It belongs to a log or to the observer's design, not to the gear.
    Beside,
}

impl Parameter {
    /// Identified, without a standard error.
    pub fn new(name: impl Into<String>, unit: &'static str, base: Option<f64>, identified: f64) -> Self {
        Self {
            name: name.into(),
            unit,
            base,
            identified,
            deviation: None,
            ends: None,
            least: f64::NEG_INFINITY,
            finding: Finding::Identified,
        }
    }

    /// The same of what cannot be negative.
    pub fn not_negative(self) -> Self {
        Self { least: 0.0, ..self }
    }

    /// The same with a standard error, where there is one.
    pub fn within(self, deviation: Option<f64>) -> Self {
        Self { deviation, ..self }
    }

    /// The same with the ends of its interval.
    pub fn between(self, ends: [f64; 2]) -> Self {
        Self { ends: Some(ends), ..self }
    }

    /// The same, which comes to something else.
    pub fn found(self, finding: Finding) -> Self {
        Self { finding, ..self }
    }

    /// Ends of the interval of 95 %.
    fn interval(&self) -> Option<[f64; 2]> {
        let half = self.deviation.map(|deviation| INTERVAL * deviation);
        let ends = self.ends.or(half.map(|half| [self.identified - half, self.identified + half]));
        ends.filter(|_| self.finding != Finding::AtLimit).map(|[low, high]| [low.max(self.least), high])
    }

    fn verdict(&self) -> &'static str {
        match (self.finding, self.interval(), self.base) {
            (Finding::AtLimit, ..) => "at the limit of its search",
            (Finding::Kept, ..) => "kept: not identified",
            (Finding::Beside, ..) => "identified; not a property of the gear",
            (Finding::Identified, Some([low, high]), Some(base)) if (low..=high).contains(&base) => {
                "not told from the base value"
            }
            (Finding::Identified, Some(_), Some(_)) => "differs from the base value",
            (Finding::Identified, ..) => "identified",
        }
    }

    fn cells(&self) -> [String; 6] {
        let shown = |value: Option<f64>| value.map_or_else(|| "-".into(), number);
        let interval = self.interval().map(|ends| ends.map(number).join(" to "));
        [
            self.name.clone(),
            self.unit.into(),
            shown(self.base),
            number(self.identified),
            interval.unwrap_or_else(|| "-".into()),
            self.verdict().into(),
        ]
    }
}

/// The table; `base` is what the base values are of, the `notes` tell where the intervals come from and why there is none.
pub(super) fn section(rows: &[Parameter], base: &str, notes: &[&str]) -> Markup {
    let header = ["parameter", "unit", base, "identified", "95 % interval", "verdict"];
    html! {
        div.wide {
            table.parameters {
                thead { tr { @for name in header { th { (name) } } } }
                tbody {
                    @for row in rows {
                        tr class=[(row.finding == Finding::AtLimit).then_some("missed")] {
                            @for cell in row.cells() { td { (cell) } }
                        }
                    }
                }
            }
        }
        @for note in notes { p { (note) } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_tells_whether_a_value_differs_and_none_is_a_dash() {
        let of = |deviation: Option<f64>| Parameter::new("a", "1", Some(1.0), 1.1).within(deviation);
        assert_eq!(of(Some(0.1)).verdict(), "not told from the base value");
        assert_eq!(of(Some(0.01)).verdict(), "differs from the base value");
        assert_eq!(of(Some(0.01)).cells()[4], "1.080 to 1.120");
        assert_eq!(of(Some(0.1)).between([1.05, 1.4]).cells()[4], "1.050 to 1.400");
        assert_eq!(of(Some(1.0)).not_negative().cells()[4], "0 to 3.060");
        assert_eq!((of(None).cells()[4].as_str(), of(None).verdict()), ("-", "identified"));
        let limit = of(Some(0.1)).found(Finding::AtLimit);
        assert_eq!((limit.cells()[4].as_str(), limit.verdict()), ("-", "at the limit of its search"));
    }

    #[test]
    fn the_table_has_every_row_and_marks_what_is_at_a_limit() {
        let rows = [
            Parameter::new("k1", "N m/rad", Some(2.0), 20.0).found(Finding::AtLimit),
            Parameter::new("width", "arcmin", None, 3.0),
        ];
        let drawn = section(&rows, "base gear", &["why"]).into_string();
        assert!(
            drawn.contains("<tr class=\"missed\"><td>k1</td><td>N m/rad</td><td>2</td><td>20</td><td>-</td>")
        );
        assert!(
            drawn.contains("<td>width</td><td>arcmin</td><td>-</td><td>3</td>")
                && drawn.contains("<p>why</p>")
        );
    }
}
