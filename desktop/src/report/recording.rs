//! Page of readings that a joint has sent over its tuning link.

use maud::html;

use super::plot::{Page, Panel, Series};
use super::{Chapter, figure, plot};
use crate::verify::Measured;

/// Readings of a joint.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// Name of the joint.
    pub joint: &'a str,
    /// What else is told of it, a line each.
    pub lines: &'a [String],
    /// Times of the readings (s).
    pub time: &'a [f64],
    /// What was read.
    pub curves: &'a [Curve],
}

/// A quantity over time.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its name, words joined by underscores.
    pub name: &'static str,
    /// `rad`, `rad_s`, `nm`, or `1`.
    pub unit: &'static str,
    /// Its values.
    pub values: Vec<f64>,
    /// Standard deviations, of an estimate.
    pub deviations: Option<Vec<f64>>,
}

/// The chapters: anchor, title, unit of its quantities, and that as it is written.
const CHAPTERS: [(&str, &str, &str, &str); 4] = [
    ("angles", "Angles", "rad", "rad"),
    ("speed", "Speed", "rad_s", "rad/s"),
    ("torques", "Torques", "nm", "N m"),
    ("factors", "Learnt factors", "1", "1"),
];

impl Recording<'_> {
    /// One self-contained HTML page.
    pub fn page(&self) -> String {
        let chapters: Vec<_> = CHAPTERS.iter().map(|chapter| self.chapter(*chapter)).collect();
        let head = html! {
            @for line in self.lines { p { (line) } }
            p { "Written by strainwave " (env!("CARGO_PKG_VERSION")) "." }
        };
        super::page(&format!("Readings of {}", self.joint), &head, &chapters).into_string()
    }

    fn chapter(&self, (id, title, unit, written): (&'static str, &'static str, &str, &str)) -> Chapter {
        let curves = self.curves.iter().filter(|curve| curve.unit == unit);
        let page = if unit == "1" {
            // All are about 1: one pair of axes shows them beside each other.
            Page::slide(title).with(
                curves.fold(Panel::new("time", "s", "factor", written), |panel, curve| {
                    panel.with(Series::line(words(curve.name), self.time, &curve.values))
                }),
            )
        } else {
            curves.fold(Page::slide(title), |page, curve| page.with(self.panel(curve, written)))
        };
        let caption = html! { "Shaded: three standard deviations of an estimate." };
        let body = figure(&plot(&page), &caption);
        Chapter { id, title, body, measured: Measured::default() }
    }

    fn panel(&self, curve: &Curve, unit: &str) -> Panel {
        let name = words(curve.name);
        let panel = Panel::new("time", "s", &name, unit);
        let panel = match &curve.deviations {
            None => panel,
            Some(deviations) => {
                let shifted = |by: f64| -> Vec<f64> {
                    curve.values.iter().zip(deviations).map(|(value, d)| value + by * d).collect()
                };
                let band = Series::band("3 deviations", self.time, [&shifted(-3.0), &shifted(3.0)]);
                panel.with(band)
            }
        };
        panel.with(Series::line(name, self.time, &curve.values))
    }
}

fn words(name: &str) -> String {
    name.replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_asks_for_no_other_and_has_every_quantity() {
        let time: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
        let curve = |name, unit, deviations: bool| Curve {
            name,
            unit,
            values: time.iter().map(|t| t.sin()).collect(),
            deviations: deviations.then(|| vec![0.1; time.len()]),
        };
        let curves = [
            curve("output_position", "rad", true),
            curve("output_velocity", "rad_s", true),
            curve("motor_torque", "nm", false),
            curve("inertia_factor", "1", false),
        ];
        let lines = ["<b> at unix:joint".to_owned()];
        let page = Recording { joint: "hd25-100", lines: &lines, time: &time, curves: &curves }.page();
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
        for text in
            ["Readings of hd25-100", "&lt;b&gt; at unix:joint", "output position [rad]", "inertia factor"]
        {
            assert!(page.contains(text), "{text}");
        }
        assert!(!page.contains("src=") && !page.contains("<script") && !page.contains("NaN"));
    }
}
