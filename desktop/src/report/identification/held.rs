//! The page of a held joint's logs: torsion over torque.

use maud::{Markup, html};
use strainwave::hysteresis::table::TABLE_LEVELS;

use super::fit::Fit;
use super::parameters::{Finding, Parameter};
use super::spectrum::Axes;
use super::{Outcome, chapter, correlation, less, next, parameters, spectrum, times};
use crate::design::joint::gear_params;
use crate::identify::joint::{STIFFNESS, TOTAL, offset_name};
use crate::identify::{GearLog, HELD_LOG, IdentifiedGear, Verdict};
use crate::io::gear_file::GearFile;
use crate::report::plot::{Colour, Page, Panel, Series};
use crate::report::{figure, plot};

const BASE: &str = "base gear";
const AXES: Axes = Axes { along: ("frequency", "Hz"), unit: "urad", base: BASE };
/// Fraction of the rated torque that a log should reach.
const REACH: f64 = 0.95;

/// The page of what was identified from logs of a held joint.
pub fn held(outcome: &Outcome, base: &GearFile, logs: &[GearLog], found: &IdentifiedGear) -> String {
    let fits: Vec<_> = (0..logs.len()).map(|log| fit(&outcome.logs[log], &logs[log], log, found)).collect();
    let chapters = vec![
        chapter("fit", "Fit and prediction", html! { @for fit in &fits { (fit.figure()) } }),
        chapter("spectrum", "Spectrum of what is missed", spectra(&fits)),
        chapter("loops", "Loops: torque over torsion", loops(outcome, base, logs, found)),
        chapter("parameters", "Parameters", table(outcome, base, found)),
        chapter("correlation", "Correlation", correlations(found)),
        chapter("next", "What to measure next", next::section(outcome, &advice(base, logs, found))),
    ];
    outcome.page(&base.gear.name, "Stiffness and hysteresis", chapters)
}

/// Fit, loops and parameters alone.
pub(super) fn summary(
    outcome: &Outcome,
    base: &GearFile,
    logs: &[GearLog],
    found: &IdentifiedGear,
) -> Markup {
    html! {
        @if *outcome.verdict != Verdict::Written { p { "Its gear file would be " (outcome.verdict) "." } }
        @for (index, log) in logs.iter().enumerate() { (fit(&outcome.logs[index], log, index, found).figure()) }
        (loops(outcome, base, logs, found)) (table(outcome, base, found))
    }
}

fn fit<'a>(name: &'a str, log: &GearLog, index: usize, found: &IdentifiedGear) -> Fit<'a> {
    Fit {
        log: name,
        along: ("time", "s"),
        at: log.time.clone(),
        trained: found.training[index],
        quantity: ("torsion", "mrad"),
        measured: times(&log.torsion, 1e3),
        identified: times(&found.predicted[index], 1e3),
        base: times(&found.base_predicted[index], 1e3),
        base_name: BASE,
        error: ("urad", 1e3),
    }
}

fn spectra(fits: &[Fit]) -> Markup {
    let panels = fits.iter().flat_map(|fit| {
        let interval = fit.at.get(1).map_or(1.0, |second| second - fit.at[0]);
        spectrum::slow_and_whole(&AXES, fit, interval)
    });
    spectrum::section(
        panels.collect(),
        "Amplitude of predicted - measured torsion over all rows of each log, the slow part apart. What is slow is stiffness and hysteresis; a line \
         is an oscillation that no static law explains.",
    )
}

/// The loop, and the same less the identified line, on which it would be too narrow to be seen.
fn loops(outcome: &Outcome, base: &GearFile, logs: &[GearLog], found: &IdentifiedGear) -> Markup {
    let line = gear_params::<f64>(base).flexspline.line.build().ok();
    let drawn = |(index, log): (usize, &GearLog)| {
        let offset = found.starts[index].offset;
        let curves = [&log.torsion, &found.base_predicted[index], &found.predicted[index]]
            .map(|torsion| torsion.iter().map(|torsion| torsion - offset).collect::<Vec<_>>());
        let axes = |name: &str, unit: &str| Panel::new(name, unit, "torque", "N m");
        let whole = with(axes("torsion", "mrad"), &curves, &log.torque, 1e3);
        let page = Page::slide(outcome.logs[index].as_str()).with(whole);
        let Some(line) = &line else { return page };
        // The factor on the stiffness stretches the line.
        let on_line: Vec<_> =
            log.torque.iter().map(|torque| line.torsion(*torque) / found.stiffness_factor).collect();
        let apart = curves.map(|torsion| less(&torsion, &on_line));
        page.with(with(axes("torsion less that of the identified line", "urad"), &apart, &log.torque, 1e6))
    };
    html! {
        @for page in logs.iter().enumerate().map(drawn) {
            (figure(&plot(&page), &html! {
                "Torque over torsion, and below it over what the identified stiffness line leaves of it: the width is the hysteresis, "
                "a slope of the whole is the base gear's error of the stiffness."
            }))
        }
    }
}

/// Measured, base, identified.
fn with(panel: Panel, [measured, base, identified]: &[Vec<f64>; 3], torque: &[f64], unit: f64) -> Panel {
    panel
        .with(Series::broad("measured", &times(measured, unit), torque).coloured(Colour::SkyBlue))
        .with(Series::dashed(BASE, &times(base, unit), torque).coloured(Colour::Vermilion))
        .with(Series::line("identified", &times(identified, unit), torque).coloured(Colour::Blue))
}

fn table(outcome: &Outcome, base: &GearFile, found: &IdentifiedGear) -> Markup {
    let note = match found.table {
        Some(_) => {
            "Intervals are those of the least squares in which stiffness, weights and offsets are found together, with the \
             smoothness as knowledge; rows within 0.2 s count as one witness."
        }
        None => {
            "The interval of the stiffness is that of its own least squares, the hysteresis being that of the base gear; rows within \
             0.2 s count as one witness. Offsets without an interval are means of the rows that trained."
        }
    };
    parameters::section(
        &rows(outcome, base, found),
        BASE,
        &[
            note,
            "The width of the loop has none: it follows from all weights, not in proportion. Extreme torques before a log have none: \
             they are the best of a number of candidates.",
        ],
    )
}

fn rows(outcome: &Outcome, base: &GearFile, found: &IdentifiedGear) -> Vec<Parameter> {
    let error = |name: &str| found.covariance.standard_error(name);
    let stiffness = |(key, before, now): (&str, f64, f64)| {
        let row = Parameter::new(format!("stiffness.{key}_nm_per_rad"), "N m/rad", Some(before), now);
        let ends = if found.limits().is_empty() { Finding::Identified } else { Finding::AtLimit };
        row.within(error(STIFFNESS).map(|deviation| before * deviation)).found(ends)
    };
    let (before, now) = (base.stiffness, found.gear.stiffness);
    let line = [("k1", before.k1, now.k1), ("k2", before.k2, now.k2), ("k3", before.k3, now.k3)];
    let shown = if found.table.is_some() { Finding::Identified } else { Finding::Kept };
    let hysteresis = |name: &str, unit: &'static str, before, now| {
        Parameter::new(format!("hysteresis.{name}"), unit, before, now).found(shown)
    };
    let width = hysteresis(
        "width_arcmin",
        "arcmin",
        Some(base.hysteresis.width_arcmin),
        found.gear.hysteresis.width_arcmin,
    );
    let total = found.gear.hysteresis.weights.as_ref().map(|rows| rows.iter().flatten().sum());
    let total =
        total.map(|now| hysteresis("weights_nm, sum", "N m", total_of(base), now).within(error(TOTAL)));
    let starts = found.starts.iter().zip(outcome.logs).enumerate().flat_map(|(index, (start, log))| {
        let offset = Parameter::new(format!("{log}: offset of the angles"), "rad", None, start.offset)
            .within(error(&offset_name(index)));
        let extreme =
            Parameter::new(format!("{log}: extreme torque before it"), "N m", None, start.extreme_torque);
        [offset, extreme].map(|row| row.found(Finding::Beside))
    });
    line.map(stiffness).into_iter().chain([width]).chain(total).chain(starts).collect()
}

/// Sum of a gear's weights (N m).
fn total_of(gear: &GearFile) -> Option<f64> {
    gear_params::<f64>(gear).hysteresis_weights::<TABLE_LEVELS>().ok().map(|(_, weights)| weights.total())
}

fn correlations(found: &IdentifiedGear) -> Markup {
    match found.table {
        Some(_) => correlation::section(&found.covariance, "Correlation of what was identified together."),
        None => html! { p { "Only the stiffness was identified." } },
    }
}

fn advice(base: &GearFile, logs: &[GearLog], found: &IdentifiedGear) -> Vec<String> {
    let mut advice = Vec::new();
    let trained = logs.iter().zip(&found.training).flat_map(|(log, count)| &log.torque[..*count]);
    let reached = trained.fold(0.0_f64, |most, torque| most.max(torque.abs()));
    let rated = base.gear.rated_torque;
    if reached < REACH * rated {
        advice.push(format!(
            "The torque that trained reaches {reached:.3} N m of the rated {rated} N m. What shows the rest is {HELD_LOG}."
        ));
    }
    let moved = found.table.as_ref().map_or(1.0, |table| table.excitation.fraction());
    if moved < 1.0 {
        advice.push(format!(
            "{:.0} % of the weights' cells were not moved and tend to the base gear's. What moves them is {HELD_LOG}.",
            100.0 * (1.0 - moved)
        ));
    }
    advice.extend(correlation::alike(&found.covariance));
    if found.held_out_rms.is_none() {
        advice.push(next::nothing_held_out());
    }
    advice
}

#[cfg(test)]
mod tests {
    use super::super::tests::check;
    use super::*;
    use crate::identify::law::{Law, torques};
    use crate::identify::{GearOptions, Smoothing, identify_gear};
    use crate::io::figure::Figure;

    /// Loops of a gear that is softer by a tenth than the base gear, every 10 ms.
    fn log(corners: &[f64]) -> GearLog {
        let mut law = Law::<TABLE_LEVELS>::of(&gear_params(&GearFile::default_gear())).unwrap();
        law.factor = 1.0 / 0.9;
        let torque: Vec<_> = torques(corners).step_by(2).map(|fraction| 60.0 * fraction).collect();
        let torsion = law.torsions(&torque).iter().map(|on| on.torsion + 1e-3).collect();
        let time = (0..torque.len()).map(|k| 0.01 * k as f64).collect();
        GearLog { time, torque, torsion, motor_travel: 0.0 }
    }

    fn identified(log: &GearLog) -> IdentifiedGear {
        let options =
            GearOptions { levels: Some(6), smoothing: Smoothing::Given(1e-4), ..GearOptions::default() };
        identify_gear(&GearFile::default_gear(), std::slice::from_ref(log), &options, |_| ()).unwrap()
    }

    fn drawn(log: &GearLog, found: &IdentifiedGear, verdict: &Verdict) -> String {
        let figures = [Figure::reported("identify.stiffness_factor", found.stiffness_factor, "1")];
        let logs = ["held <1>.csv".to_owned()];
        let outcome = Outcome {
            logs: &logs,
            output: "new.toml",
            verdict,
            described: Some("weights on 6 levels"),
            not_identified: &found.not_identified(),
            figures: &figures,
        };
        let page = held(&outcome, &GearFile::default_gear(), std::slice::from_ref(log), found);
        let logs = ["held &lt;1&gt;.csv".to_owned()];
        check(&page, &Outcome { logs: &logs, ..outcome });
        page
    }

    #[test]
    fn the_page_has_every_parameter_with_the_stiffness_s_interval_and_the_part_that_trained() {
        let log = log(&[0.0, 1.0, -1.0, 1.0, -0.5, 0.7, -1.0, 1.0, -1.0, 0.5, -0.6, 0.2]);
        let found = identified(&log);
        let page = drawn(&log, &found, &Verdict::Written);
        for name in [
            "stiffness.k1_nm_per_rad",
            "stiffness.k3_nm_per_rad",
            "hysteresis.width_arcmin",
            "hysteresis.weights_nm, sum",
        ] {
            assert!(page.contains(&format!("<td>{name}</td>")), "{name}");
        }
        assert!(page.contains("trained; the rest was held out") && page.contains("<polygon"));
        assert!(page.contains("aria-label=\"Correlations\"") && page.contains("offset of log 1"));
        // What was built in lies within four standard errors, which are neither nothing nor all.
        let error = found.covariance.standard_error(STIFFNESS).unwrap();
        assert!(
            (found.stiffness_factor - 0.9).abs() < 4.0 * error + 0.01,
            "{} {error}",
            found.stiffness_factor
        );
        assert!(error > 1e-5 && error < 0.3, "{error}");
        assert!(error > 0.5 * found.stiffness_deviation * found.stiffness_factor, "{error}");
    }

    #[test]
    fn what_was_not_shown_is_kept_and_asked_for() {
        let log = log(&[0.0, 0.3, 0.28, 0.6]);
        let found = identified(&log);
        assert!(found.table.is_none());
        let refused = Verdict::Refused { why: "it is worse".into(), helps: HELD_LOG };
        let page = drawn(&log, &found, &refused);
        assert!(page.contains("kept: not identified") && page.contains("Only the stiffness was identified"));
        assert!(page.contains(&format!("<li>Not written: it is worse. What helps is {HELD_LOG}.</li>")));
        assert!(page.contains("N m of the rated"));
        assert!(
            page.contains("<li>hysteresis: not identified, the torque does not go both ways far enough;")
        );
    }
}
