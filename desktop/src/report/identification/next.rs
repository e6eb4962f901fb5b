//! What to measure next: from what was refused, not excited, or not told apart.

use maud::{Markup, html};

use super::Outcome;
use crate::identify::{NotIdentified, Verdict};

/// The list; `advice` has a sentence each.
pub(super) fn section(outcome: &Outcome, advice: &[String]) -> Markup {
    let against = match outcome.verdict {
        Verdict::Written => None,
        Verdict::Forced { why } => Some(format!("Written although {why}.")),
        Verdict::Refused { why, helps } => Some(format!("Not written: {why}. What helps is {helps}.")),
    };
    let open = |one: &NotIdentified| format!("{one}. What shows it is {}.", one.helps);
    let open: Vec<_> = outcome.not_identified.iter().map(open).collect();
    let all: Vec<_> = against.iter().chain(&open).chain(advice).collect();
    html! {
        @if all.is_empty() {
            p { "These logs show all that this form of the command identifies." }
        } @else {
            ul { @for one in all { li { (one) } } }
        }
    }
}

/// Of logs of which nothing was held out.
pub(super) fn nothing_held_out() -> String {
    "Nothing was held out, so nothing tells how well another log is predicted: less than the whole log with --training, or another log."
        .into()
}
