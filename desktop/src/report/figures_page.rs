//! The page of figures: every row of [`crate::verify::bounds`] beside what was last measured of it, as Markdown.
//!
//! What stands between the two markers is generated; the rest of the page is left as it is. A row keeps its value until
//! it is measured again, so that each command renews the rows that it measures. A row of which several figures are
//! measured, one for each scenario say, shows the worst of them.

use std::collections::HashMap;
use std::fmt::Write;

use crate::io::figure::{Figure, number};
use crate::verify::bounds::{BOUNDS, Bound, FLOORS, TARGETS, is_floor};

/// The line before what is generated.
pub const BEGIN: &str = "<!-- figures: begin -->";
/// The line behind it.
pub const END: &str = "<!-- figures: end -->";

const HEADER: &str = "| figure | value | unit | target | bound | | what it is, and why this bound |";
const RULE: &str = "| --- | ---: | --- | ---: | ---: | --- | --- |";

/// A part of the page: the first words of its rows' names, and the command that measures them.
struct Part {
    title: &'static str,
    prefixes: &'static [&'static str],
    command: &'static str,
}

/// A row belongs to the first part that has its prefix.
const PARTS: &[Part] = &[
    Part {
        title: "Flexspline and gear",
        prefixes: &["flexspline.", "gear."],
        command: "strainwave verify flexspline",
    },
    Part { title: "Friction", prefixes: &["friction."], command: "strainwave verify friction" },
    Part { title: "Hysteresis", prefixes: &["hysteresis."], command: "strainwave verify hysteresis" },
    Part { title: "Tooth-belt gear", prefixes: &["belt."], command: "strainwave verify belt" },
    Part { title: "Arm link", prefixes: &["link."], command: "strainwave verify link" },
    Part { title: "PZT patch", prefixes: &["piezo."], command: "strainwave verify piezo" },
    Part { title: "Sensors", prefixes: &["sensor."], command: "strainwave verify sensor" },
    Part { title: "Strain gauges", prefixes: &["gauges."], command: "strainwave verify gauges" },
    Part { title: "Identification", prefixes: &["identify."], command: "strainwave verify identify" },
    Part {
        title: "Compensator",
        prefixes: &["compensator.", "angle."],
        command: "strainwave verify compensator",
    },
    Part {
        title: "Condensed plant",
        prefixes: &["plant.condensed."],
        command: "cargo test -p strainwave-host-tests condensed_plant",
    },
    Part {
        title: "One scenario with the firmware",
        prefixes: &["pil.faults", "pil.limited", "pil.worse_marks"],
        command: "strainwave pil",
    },
    Part { title: "Firmware", prefixes: &["pil.", "plant."], command: "strainwave verify firmware" },
    Part {
        title: "Margins of the default gear",
        prefixes: &["design."],
        command: "strainwave design gears/hd25-100.toml",
    },
    Part { title: "Injected faults", prefixes: &["faults."], command: "strainwave verify faults" },
    Part { title: "Robots", prefixes: &["robot."], command: "strainwave verify robot" },
    Part { title: "Unknown plants", prefixes: &["robustness."], command: "strainwave verify robustness" },
    Part {
        title: "Joints of the catalogue, of which little is known",
        prefixes: &["catalogue.unknown."],
        command: "strainwave verify catalogue --row all",
    },
    Part {
        title: "Joints of the catalogue",
        prefixes: &["catalogue."],
        command: "strainwave verify catalogue",
    },
    Part {
        title: "Healthy joints at work, of which little is known",
        prefixes: &["healthy.unknown."],
        command: "strainwave verify healthy --row all",
    },
    Part { title: "Healthy joints at work", prefixes: &["healthy."], command: "strainwave verify healthy" },
    Part { title: "Tuned constants", prefixes: &["constants."], command: "strainwave verify constants" },
];

/// Why a page cannot be renewed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the lines `{BEGIN}` and `{END}` are missing or not in this order; the figures stand between them")]
pub struct NoMarkers;

/// The page with what was measured, and with the rows that the table of bounds has now.
///
/// # Errors
/// A page without the markers.
pub fn renewed(page: &str, measured: &[Figure]) -> Result<String, NoMarkers> {
    let (before, rest) = page.split_once(BEGIN).ok_or(NoMarkers)?;
    let (kept, after) = rest.split_once(END).ok_or(NoMarkers)?;
    let mut values: HashMap<&str, f64> = kept.lines().filter_map(kept_value).collect();
    for row in rows() {
        let found = measured.iter().filter(|figure| figure.row == Some(row.name)).map(|figure| figure.value);
        if let Some(worst) = found.reduce(|a, b| if is_worse(row, b, a) { b } else { a }) {
            values.insert(row.name, worst);
        }
    }
    Ok(format!("{before}{BEGIN}\n\n{}{END}{after}", tables(&values)))
}

/// Ceilings and floors.
fn rows() -> impl Iterator<Item = &'static Bound> {
    BOUNDS.into_iter().flatten().chain(FLOORS)
}

/// NaN is worse than any number.
fn is_worse(row: &Bound, a: f64, b: f64) -> bool {
    a.is_nan() || if is_floor(row.name) { a < b } else { a > b }
}

/// Name and value of a generated line.
fn kept_value(line: &str) -> Option<(&str, f64)> {
    let mut cells = line.strip_prefix("| `")?.split(" | ");
    let name = cells.next()?.strip_suffix('`')?;
    Some((name, cells.next()?.parse().ok()?))
}

/// Bound or target of the row.
fn target(row: &Bound) -> f64 {
    TARGETS.iter().find(|(name, _)| *name == row.name).map_or(row.value, |(_, target)| *target)
}

fn verdict(row: &Bound, value: Option<f64>) -> &'static str {
    let Some(value) = value else { return "not measured" };
    let keeps = |limit: f64| if is_floor(row.name) { value >= limit } else { value <= limit };
    match (keeps(target(row)), keeps(row.value)) {
        (true, _) => "met",
        (false, true) => "**missed**",
        (false, false) => "**missed, beyond its bound**",
    }
}

fn tables(values: &HashMap<&str, f64>) -> String {
    let mut text = String::new();
    let verdicts: Vec<_> = rows().map(|row| verdict(row, values.get(row.name).copied())).collect();
    let count = |wanted: &str| verdicts.iter().filter(|verdict| verdict.contains(wanted)).count();
    let [met, missed, open] = ["met", "**missed", "not measured"].map(count);
    let _ = writeln!(
        text,
        "Of {} figures {met} meet their target, {missed} miss it, {open} are not measured.\n",
        verdicts.len()
    );
    let part_of =
        |name: &str| PARTS.iter().position(|part| part.prefixes.iter().any(|p| name.starts_with(p)));
    for (index, part) in PARTS.iter().enumerate() {
        let _ = writeln!(text, "### {}\n\nMeasured by `{}`.\n\n{HEADER}\n{RULE}", part.title, part.command);
        for row in rows().filter(|row| part_of(row.name) == Some(index)) {
            text.push_str(&line(row, values.get(row.name).copied()));
        }
        text.push('\n');
    }
    text
}

/// The value as it is shown again when it is read from the page: 1.0003 is 1.
fn shown(value: f64) -> String {
    let digits = number(value);
    digits.parse().map_or(digits, number)
}

fn line(row: &Bound, value: Option<f64>) -> String {
    let sense = if is_floor(row.name) { ">= " } else { "" };
    let shown = value.map_or_else(|| "-".into(), shown);
    let [target, bound] = [target(row), row.value].map(|limit| format!("{sense}{}", number(limit)));
    let why = row.why.replace('|', "\\|");
    format!(
        "| `{}` | {shown} | {} | {target} | {bound} | {} | {why} |\n",
        row.name,
        row.unit,
        verdict(row, value)
    )
}

/// An empty page.
pub fn empty() -> String {
    format!("{BEGIN}\n{END}\n")
}

/// Rows that no part takes.
pub fn without_part() -> Vec<&'static str> {
    let has_part = |name: &str| PARTS.iter().any(|part| part.prefixes.iter().any(|p| name.starts_with(p)));
    rows().map(|row| row.name).filter(|name| !has_part(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::bounds;

    const ROW: &str = "friction.f32";

    fn cells(page: &str, name: &str) -> Vec<String> {
        let line = page.lines().find(|line| line.starts_with(&format!("| `{name}`"))).unwrap();
        line.split(" | ").map(str::to_owned).collect()
    }

    #[test]
    fn a_value_stays_until_it_is_measured_again() {
        let page = renewed(&format!("# Figures\n\n{}\nThe end.\n", empty()), &[]).unwrap();
        assert_eq!(
            cells(&page, ROW)[1..],
            ["-", "1", "1.000e-5", "1.000e-5", "not measured", &cells(&page, ROW)[6]]
        );
        let measured = renewed(&page, &[bounds::figure(ROW, 4.4e-6)]).unwrap();
        assert_eq!((&*cells(&measured, ROW)[1], &*cells(&measured, ROW)[5]), ("4.400e-6", "met"));
        assert_eq!(renewed(&measured, &[]).unwrap(), measured);
        let nearly_one = renewed(&page, &[bounds::figure(ROW, 1.0003)]).unwrap();
        assert_eq!(cells(&nearly_one, ROW)[1], "1");
        assert_eq!(renewed(&nearly_one, &[]).unwrap(), nearly_one);
        let reported = bounds::figure(ROW, 5.5e-6).without_bound();
        assert_eq!(renewed(&measured, &[reported]).unwrap(), measured);
        let other = renewed(&measured, &[bounds::figure("friction.work.f32", 1.0)]).unwrap();
        assert_eq!(cells(&other, ROW), cells(&measured, ROW));
        assert_eq!(cells(&other, "friction.work.f32")[5], "**missed, beyond its bound**");
        assert!(other.starts_with("# Figures\n\n<!--") && other.ends_with("-->\n\nThe end.\n"));
    }

    #[test]
    fn the_worst_of_several_figures_is_shown() {
        let of = |row: &str, values: [f64; 3]| {
            let figures = values.map(|value| bounds::figure_as("x.y", row, value));
            cells(&renewed(&empty(), &figures).unwrap(), row)[1].clone()
        };
        assert_eq!(of("pil.steps_unlike_host", [0.0, 3.0, 1.0]), "3");
        assert_eq!(of("design.motor.torque.gain", [9.0, 3.0, 7.0]), "3");
        assert_eq!(of(ROW, [0.0, f64::NAN, 1.0]), "NaN");
    }

    /// A target that lies below the bound is what the figure is judged by.
    #[test]
    fn a_missed_target_is_named_within_the_bound_too() {
        let (name, target) = TARGETS[0];
        let bound = bounds::find(name).unwrap().value;
        let of = |value| cells(&renewed(&empty(), &[bounds::figure(name, value)]).unwrap(), name)[5].clone();
        assert_eq!(of(target), "met");
        assert_eq!(of(bound), "**missed**");
        assert_eq!(of(2.0 * bound), "**missed, beyond its bound**");
    }

    #[test]
    fn every_row_has_its_place_and_a_page_its_markers() {
        assert_eq!(without_part(), Vec::<&str>::new());
        assert_eq!(renewed("# Figures", &[]), Err(NoMarkers));
        assert_eq!(renewed(&format!("{END}\n{BEGIN}"), &[]), Err(NoMarkers));
    }
}
