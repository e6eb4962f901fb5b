//! The page of logs of any actuator: output over input.

use maud::{Markup, html};

use super::fit::Fit;
use super::parameters::Parameter;
use super::spectrum::Axes;
use super::{Outcome, chapter, next, parameters, spectrum};
use crate::identify::{IdentifiedOperator, OPERATOR_LOG};
use crate::io::log::InputOutput;
use crate::report::plot::{Colour, Page, Panel, Series};
use crate::report::{figure, plot};

const BASE: &str = "straight line";
const AXES: Axes = Axes { along: ("frequency", "1/1000 rows"), unit: "% of span", base: BASE };

/// The page of what was identified from logs of input and output, those that trained and those held out.
pub fn operator(
    outcome: &Outcome,
    trained: &[InputOutput],
    held_out: &[InputOutput],
    found: &IdentifiedOperator,
) -> String {
    let logs: Vec<_> = trained.iter().chain(held_out).collect();
    let fits: Vec<_> = (0..logs.len()).map(|log| fit(&outcome.logs[log], logs[log], log, found)).collect();
    let chapters = vec![
        chapter("fit", "Fit and prediction", html! { @for fit in &fits { (fit.figure()) } }),
        chapter("spectrum", "Spectrum of what is missed", spectra(&fits)),
        chapter("loops", "Loops: output over input", loops(&logs, &fits)),
        chapter("parameters", "Parameters", table(found)),
        chapter("next", "What to measure next", next::section(outcome, &advice(found))),
    ];
    outcome.page("operator", "A Preisach operator", chapters)
}

fn fit<'a>(name: &'a str, log: &InputOutput, index: usize, found: &IdentifiedOperator) -> Fit<'a> {
    Fit {
        log: name,
        along: ("row", ""),
        at: (0..log.input.len()).map(|row| row as f64).collect(),
        trained: found.counts[index],
        quantity: ("y", ""),
        measured: log.output.clone(),
        identified: found.predicted[index].clone(),
        base: log.input.iter().map(|u| found.line.at(*u)).collect(),
        base_name: BASE,
        error: ("% of span", 100.0 / found.span),
    }
}

fn spectra(fits: &[Fit]) -> Markup {
    let panels = fits.iter().flat_map(|fit| spectrum::slow_and_whole(&AXES, fit, 1e-3));
    spectrum::section(
        panels.collect(),
        "Amplitude of predicted - measured y over all rows of each log, the slow part apart, over their number: an operator knows no time. What stands out \
         depends on how fast the input moved, or comes from beside it.",
    )
}

fn loops(logs: &[&InputOutput], fits: &[Fit]) -> Markup {
    let drawn = |(log, fit): (&&InputOutput, &Fit)| {
        let panel = Panel::new("u", "", "y", "")
            .with(Series::broad("measured", &log.input, &fit.measured).coloured(Colour::SkyBlue))
            .with(Series::dashed(BASE, &log.input, &fit.base).coloured(Colour::Vermilion))
            .with(Series::line("identified", &log.input, &fit.identified).coloured(Colour::Blue));
        figure(&plot(&Page::slide(fit.log).with(panel)), &html! { (fit.log) ": y over u." })
    };
    html! { @for picture in logs.iter().zip(fits).map(drawn) { (picture) } }
}

fn table(found: &IdentifiedOperator) -> Markup {
    let (operator, line) = (&found.operator, &found.line);
    let middle = operator.grid().middle();
    let rows = [
        Parameter::new("operator.offset", "of y", Some(line.at(middle)), operator.offset()),
        Parameter::new("operator.slope", "of y over u", Some(line.slope()), operator.slope()),
        Parameter::new("operator.weights, sum", "of y", Some(0.0), operator.weights().iter().sum()),
        Parameter::new("operator.input_low", "of u", None, operator.grid().low),
        Parameter::new("operator.input_high", "of u", None, operator.grid().high),
    ];
    parameters::section(
        &rows,
        BASE,
        &[
            "There are no intervals and no correlations: of an actuator of any kind nothing tells the noise of y, nor over how many rows what the \
           operator misses is alike. What it is worth is what it predicts of the rows held out.",
        ],
    )
}

fn advice(found: &IdentifiedOperator) -> Vec<String> {
    let mut advice = Vec::new();
    if found.excited < 1.0 {
        advice.push(format!(
            "{:.0} % of the cells were not moved: only the smoothness gives their weights. What moves them is {OPERATOR_LOG}.",
            100.0 * (1.0 - found.excited)
        ));
    }
    if found.held_out.is_none() {
        advice.push(next::nothing_held_out());
    }
    let grid = found.operator.grid();
    advice.push(format!(
        "Inputs below {} and above {} move the line alone: nothing is known of what switches there.",
        grid.low, grid.high
    ));
    advice
}

#[cfg(test)]
mod tests {
    use super::super::tests::check;
    use super::*;
    use crate::identify::{OperatorOptions, Smoothing, Verdict, identify_operator};
    use crate::io::figure::Figure;

    /// Legs of a play of half-width 1.
    fn log(turns: &[f64]) -> InputOutput {
        let mut play = 0.0_f64;
        let leg = |pair: &[f64]| {
            let (from, to) = (pair[0], pair[1]);
            (0..50).map(move |k| from + (to - from) * f64::from(k) / 50.0)
        };
        let input: Vec<_> = turns.windows(2).flat_map(leg).collect();
        let output = input.iter().map(|u| {
            play = play.clamp(u - 1.0, u + 1.0);
            play
        });
        InputOutput { output: output.collect(), input }
    }

    #[test]
    fn the_page_has_every_log_the_loops_and_no_interval() {
        let (trained, held_out) = (log(&[0.0, 4.0, -4.0, 3.0, -3.0, 2.0, -2.0]), log(&[4.0, -1.0, 2.0]));
        let options = OperatorOptions {
            training: 0.8,
            levels: Some(6),
            smoothing: Smoothing::Given(1e-6),
            signed: false,
        };
        let (trained, held_out) = ([trained], [held_out]);
        let found = identify_operator(&trained, &held_out, &options, |_| ()).unwrap();
        let figures = [Figure::reported("identify.operator.levels", 6.0, "1")];
        let logs = ["loops.csv", "nested.csv"].map(String::from);
        let outcome = Outcome {
            logs: &logs,
            output: "op.toml",
            verdict: &Verdict::Written,
            described: Some("weights on 6 levels"),
            not_identified: &[],
            figures: &figures,
        };
        let page = operator(&outcome, &trained, &held_out, &found);
        check(&page, &outcome);
        for name in ["operator.offset", "operator.slope", "operator.weights, sum", "operator.input_low"] {
            assert!(page.contains(&format!("<td>{name}</td>")), "{name}");
        }
        assert!(
            page.contains("The shaded part, up to row 239, trained") && page.contains("None of it trained.")
        );
        assert!(page.contains("There are no intervals") && !page.contains("aria-label=\"Correlations\""));
        assert!(found.excited > 0.5 && found.counts == [240, 0]);
    }
}
