//! Measured and predicted over the rows of a log, the part that trained marked.

use maud::{Markup, html};

use super::{less, times};
use crate::io::figure::number;
use crate::report::plot::{Colour, Page, Panel, Series};
use crate::report::{figure, plot};

/// Name of the marked part in the legends.
pub(super) const TRAINED: &str = "trained";

/// A log and what is predicted of it.
pub(super) struct Fit<'a> {
    /// Name of the log.
    pub log: &'a str,
    /// What the rows count by, and its unit.
    pub along: (&'static str, &'static str),
    /// The rows' places.
    pub at: Vec<f64>,
    /// Rows that trained, from the first.
    pub trained: usize,
    /// What was measured, and its unit.
    pub quantity: (&'static str, &'static str),
    /// In that unit.
    pub measured: Vec<f64>,
    /// As predicted by what was identified.
    pub identified: Vec<f64>,
    /// As predicted without.
    pub base: Vec<f64>,
    /// What predicts without.
    pub base_name: &'static str,
    /// Unit of errors, and how many of them the quantity's unit is.
    pub error: (&'static str, f64),
}

impl Fit<'_> {
    /// Errors without and with what was identified, in their unit.
    pub fn errors(&self) -> [Vec<f64>; 2] {
        [&self.base, &self.identified].map(|predicted| times(&less(predicted, &self.measured), self.error.1))
    }

    /// The picture of both.
    pub fn figure(&self) -> Markup {
        let [base, identified] = self.errors();
        let (name, unit) = self.along;
        let axes = |y: &str, y_unit: &str| Panel::new(name, unit, y, y_unit);
        let values = self
            .marked(axes(self.quantity.0, self.quantity.1), &[&self.measured, &self.identified, &self.base])
            .with(Series::broad("measured", &self.at, &self.measured).coloured(Colour::SkyBlue))
            .with(self.of_base(&self.base))
            .with(self.of_identified(&self.identified));
        let errors = self
            .marked(axes("predicted - measured", self.error.0), &[&identified, &base])
            .with(self.of_base(&base))
            .with(self.of_identified(&identified));
        let part = match self.trained {
            0 => "None of it trained.".to_owned(),
            count if count == self.at.len() => "All of it trained; nothing was held out.".to_owned(),
            count => {
                format!("The shaded part, up to {}, trained; the rest was held out.", self.place(count - 1))
            }
        };
        figure(
            &plot(&Page::slide(self.log).with(values).with(errors)),
            &html! { (self.log) ": " (self.quantity.0) ", and below it what the predictions miss. " (part) },
        )
    }

    /// Where a row is, for people.
    fn place(&self, row: usize) -> String {
        let at = number(self.at[row]);
        match self.along {
            (name, "") => format!("{name} {at}"),
            (_, unit) => format!("{at} {unit}"),
        }
    }

    /// The panel with the part that trained shaded over the range of the curves.
    fn marked(&self, panel: Panel, curves: &[&[f64]]) -> Panel {
        let values = || curves.iter().copied().flatten().copied().filter(|value| value.is_finite());
        let ends = [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)];
        match self.at.get(..self.trained) {
            Some(&[first, .., last]) => {
                let [low, high] = ends.map(|end| [end; 2]);
                panel.with(Series::band(TRAINED, &[first, last], [&low, &high]).coloured(Colour::Orange))
            }
            _ => panel,
        }
    }

    fn of_base(&self, y: &[f64]) -> Series {
        Series::dashed(self.base_name, &self.at, y).coloured(Colour::Vermilion)
    }

    fn of_identified(&self, y: &[f64]) -> Series {
        Series::line("identified", &self.at, y).coloured(Colour::Blue)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(trained: usize) -> Fit<'static> {
        let at: Vec<f64> = (0..100).map(f64::from).collect();
        Fit {
            log: "a.csv",
            along: ("time", "s"),
            trained,
            quantity: ("torsion", "mrad"),
            measured: at.clone(),
            identified: times(&at, 1.1),
            base: times(&at, 0.5),
            base_name: "base gear",
            error: ("urad", 1e3),
            at,
        }
    }

    #[test]
    fn errors_are_what_is_predicted_less_what_was_measured() {
        let [base, identified] = fit(50).errors();
        assert!((base[10] + 5e3).abs() < 1e-9 && (identified[10] - 1e3).abs() < 1e-9);
    }

    /// A shaded polygon in either panel, its sample in either legend, and where it ends.
    #[test]
    fn the_part_that_trained_is_marked() {
        let drawn = fit(50).figure().into_string();
        assert_eq!(drawn.matches("<polygon").count(), 2, "{drawn}");
        assert_eq!(drawn.matches(&format!("\n{TRAINED}\n")).count(), 2, "{drawn}");
        assert!(drawn.contains("The shaded part, up to 49 s, trained; the rest was held out."));
        assert_eq!(Fit { along: ("row", ""), ..fit(50) }.place(49), "row 49");
        let held_out = fit(0).figure().into_string();
        assert!(!held_out.contains("<polygon") && held_out.contains("None of it trained."));
        assert!(fit(100).figure().into_string().contains("nothing was held out"));
    }
}
