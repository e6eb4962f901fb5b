//! Report of `identify`: one HTML page that tells what was identified, how well it predicts, and what to measure next.
//!
//! | file | |
//! | --- | --- |
//! | `held` | the page of a held joint's logs |
//! | `moving` | of a moving joint's log |
//! | `operator` | of logs of any actuator |
//! | `fit` | measured and predicted over a log, the part that trained marked |
//! | `spectrum` | what is missed over frequency, and over the orders of a revolution |
//! | `friction_map` | motor torque over speed beside the friction's curve |
//! | `parameters` | table of what was identified, with intervals |
//! | `correlation` | heat map of a covariance |
//! | `next` | what to measure next |
//! | `example` | the chapter of `strainwave report`, with the example logs |
//!
//! A page is drawn from the result of the identification and from the figures that the command prints; nothing is
//! computed anew of either. It is written also where the identified file is not: then it tells why.

mod correlation;
pub(super) mod example;
mod fit;
mod friction_map;
mod held;
mod moving;
mod next;
mod operator;
mod parameters;
mod spectrum;

use maud::{Markup, html};

use super::{Chapter, figure_table};
use crate::identify::{NotIdentified, Verdict};
use crate::io::figure::Figure;
use crate::verify::Measured;
pub use held::held;
pub use moving::moving;
pub use operator::operator;

/// What the command tells of an identification beside its result.
#[derive(Clone, Copy, Debug)]
pub struct Outcome<'a> {
    /// Names of the logs, those that trained first.
    pub logs: &'a [String],
    /// Name of the file for what was identified.
    pub output: &'a str,
    /// Whether it was written.
    pub verdict: &'a Verdict,
    /// A line about what was identified.
    pub described: Option<&'a str>,
    /// What was not.
    pub not_identified: &'a [NotIdentified],
    /// The printed figures.
    pub figures: &'a [Figure],
}

impl Outcome<'_> {
    /// The page of `subject`, of which the chapters tell; `what` was identified.
    fn page(&self, subject: &str, what: &str, mut chapters: Vec<Chapter>) -> String {
        let measured = Measured::from(self.figures.to_vec());
        let body = html! {
            p { "As the command prints them." }
            (figure_table(&measured))
        };
        chapters.push(chapter("figures", "Figures", body));
        let verdict = match self.verdict {
            Verdict::Written => format!("{}: written.", self.output),
            other => format!("{}: {other}.", self.output),
        };
        let head = html! {
            p class=[(*self.verdict != Verdict::Written).then_some("refused")] {
                (what) " from " (self.logs.join(", ")) ". " (verdict)
            }
            @if let Some(line) = self.described { p { (line) } }
            p { "Written by strainwave " (env!("CARGO_PKG_VERSION")) "." }
        };
        super::page(&format!("Identified: {subject}"), &head, &chapters).into_string()
    }
}

fn chapter(id: &'static str, title: &'static str, body: Markup) -> Chapter {
    Chapter { id, title, body, measured: Measured::default() }
}

/// Numbers times a factor.
fn times(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| value * factor).collect()
}

/// Differences of two rows of numbers.
fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What every page must be: one file that asks for no other, with all printed figures and chapters.
    pub(super) fn check(page: &str, outcome: &Outcome) {
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
        for outside in ["src=", "<script", "<link", "@import", "url(", "https://"] {
            assert!(!page.contains(outside), "{outside}");
        }
        let addresses = page.matches("http://").count();
        assert_eq!(
            addresses,
            page.matches("http://www.w3.org/2000/svg").count(),
            "names of a namespace only"
        );
        assert!(page.matches("href=").count() == page.matches("href=\"#").count());
        for figure in outcome.figures {
            assert!(page.contains(&format!("<td>{}</td>", figure.name)), "{}", figure.name);
        }
        for name in ["Fit", "Spectrum", "Parameters", "What to measure next", "Figures"] {
            assert!(page.contains(&format!("<h2>{name}")), "{name}");
        }
        assert!(outcome.logs.iter().all(|log| page.contains(log.as_str())));
        assert!(!page.contains("NaN"), "a number that is none");
    }

    #[test]
    fn the_head_tells_what_from_which_logs_and_why_nothing_was_written() {
        let helps = crate::identify::HELD_LOG;
        let refused = Verdict::Refused { why: "it predicts <worse>".into(), helps };
        let logs = ["a.csv".to_owned(), "b.csv".to_owned()];
        let outcome = Outcome {
            logs: &logs,
            output: "new.toml",
            verdict: &refused,
            described: None,
            not_identified: &[],
            figures: &[],
        };
        let page = outcome.page("gear", "Stiffness", Vec::new());
        let expected = format!(
            "<p class=\"refused\">Stiffness from a.csv, b.csv. new.toml: not written: it predicts &lt;worse&gt;; what helps is {helps}.</p>"
        );
        assert!(page.contains(&expected), "{page}");
        let written = Outcome { verdict: &Verdict::Written, ..outcome }.page("gear", "Stiffness", Vec::new());
        assert!(written.contains("new.toml: written.</p>") && !written.contains("<p class=\"refused\">"));
    }
}
