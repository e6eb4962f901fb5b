//! The report: one HTML page that needs nothing but itself, with a chapter for each part of the model.
//!
//! A chapter is a file (or folder) here with one function of the gear file; [`CHAPTERS`] lists them. Pictures are
//! inline SVG, drawn for paper; the style sheet turns their black and white around on a dark screen.

mod flexspline;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::divergence::RunError;
use crate::figure::Figure;
use crate::gear_file::GearFile;
use crate::plot;

const STYLE: &str = include_str!("style.css");

/// How a chapter is made of a gear file; called with the share of it that is done.
type Make = fn(&GearFile, &mut dyn FnMut(f64)) -> Result<Chapter, RunError>;

/// The chapters, in the order of the page.
const CHAPTERS: &[Make] = &[flexspline::chapter];

/// A part of the page.
struct Chapter {
    /// Its anchor.
    id: &'static str,
    title: &'static str,
    body: Markup,
    /// What was measured for it.
    figures: Vec<Figure>,
}

/// The finished report.
pub struct Report {
    /// The page.
    pub html: String,
    /// The figures of all chapters.
    pub figures: Vec<Figure>,
}

/// Measures, draws and writes every chapter; `progress` is called with the share done.
///
/// # Errors
/// A gear that no model can be built from, or a run that diverges.
pub fn build(gear: &GearFile, mut progress: impl FnMut(f64)) -> Result<Report, RunError> {
    let mut chapters = Vec::new();
    for (done, make) in CHAPTERS.iter().enumerate() {
        let mut part = |share: f64| progress((done as f64 + share) / CHAPTERS.len() as f64);
        chapters.push(make(gear, &mut part)?);
    }
    let html = page(gear, &chapters).into_string();
    Ok(Report { html, figures: chapters.into_iter().flat_map(|chapter| chapter.figures).collect() })
}

fn page(gear: &GearFile, chapters: &[Chapter]) -> Markup {
    let title = format!("strainwave: {}", gear.gear.name);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (title) }
                    p {
                        "Ratio " (gear.gear.ratio) ", rated torque " (gear.gear.rated_torque) " N m. "
                        "Written by strainwave " (env!("CARGO_PKG_VERSION")) "."
                    }
                    nav { ul { @for chapter in chapters { li { a href={ "#" (chapter.id) } { (chapter.title) } } } } }
                }
                main {
                    @for chapter in chapters {
                        section id=(chapter.id) { h2 { (chapter.title) } (chapter.body) }
                    }
                }
            }
        }
    }
}

/// A picture and what it shows.
fn figure(picture: &Markup, caption: &Markup) -> Markup {
    html! { figure { (picture) figcaption { (caption) } } }
}

/// Curves as a picture.
fn plot(page: &plot::Page) -> Markup {
    PreEscaped(page.to_svg())
}

/// Rows under a header; all columns but the first hold numbers.
fn table<const K: usize>(header: [&str; K], rows: &[[String; K]]) -> Markup {
    html! {
        div.wide {
            table {
                thead { tr { @for name in header { th { (name) } } } }
                tbody { @for row in rows { tr { @for cell in row { td { (cell) } } } } }
            }
        }
    }
}

/// Figures beside their bounds; one that misses is marked.
fn figure_table(figures: &[Figure]) -> Markup {
    html! {
        div.wide {
            table.figures {
                thead { tr { @for name in Figure::HEADER { th { (name) } } } }
                tbody {
                    @for figure in figures {
                        tr.missed[!figure.holds] { @for cell in figure.cells() { td { (cell) } } }
                    }
                }
            }
        }
    }
}
