//! Report: one HTML page that needs nothing but itself, with a chapter for each part of the model; and another of an
//! identification, and one of what a joint has sent.
//!
//! A chapter is a file (or folder) here with one function of the gear file; `CHAPTERS` lists them. Pictures are
//! inline SVG, drawn for paper; the style sheet turns their black and white around on a dark screen.

pub mod controller;
pub mod design;
pub mod figures_page;
mod flexspline;
mod friction;
mod hysteresis;
pub mod identification;
mod paper;
mod picture;
mod pictures;
pub mod plot;
pub mod recording;
mod scenarios;
mod two_port;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::verify::Measured;
pub use pictures::Picture;
use scenarios::Trials;

const STYLE: &str = include_str!("style.css");

/// What a page is of.
struct Subject<'a> {
    gear: &'a GearFile,
    trials: Trials,
}

/// Function that makes a chapter of its subject; it reports the fraction done.
type Make = fn(&Subject<'_>, &mut dyn FnMut(f64)) -> Result<Chapter, BadInput>;

/// The chapters, in the order of the page.
const CHAPTERS: &[Make] = &[
    |_, _| Ok(paper::chapter()),
    |subject, progress| picture::chapter(subject.gear, &subject.trials, progress),
    |subject, progress| flexspline::chapter(subject.gear, progress),
    |subject, progress| friction::chapter(subject.gear, progress),
    |subject, progress| hysteresis::chapter(subject.gear, progress),
    |subject, progress| two_port::chapter(subject.gear, &subject.trials, progress),
    |subject, progress| scenarios::chapter(&subject.trials, progress),
    |_, progress| identification::example::chapter(progress),
];

/// A part of the page.
struct Chapter {
    /// Its anchor.
    id: &'static str,
    title: &'static str,
    body: Markup,
    /// Figures measured for it.
    measured: Measured,
}

/// The finished report.
pub struct Report {
    /// The page.
    pub html: String,
    /// Figures measured for all chapters.
    pub measured: Measured,
    /// Its pictures.
    pub pictures: Vec<Picture>,
}

/// Measures, draws and writes every chapter; `progress` is called with the fraction done.
///
/// # Errors
/// A gear that no model can be built from, or data that are there and cannot be used.
pub fn build(gear: &GearFile, mut progress: impl FnMut(f64)) -> Result<Report, BadInput> {
    // The runs of the scenarios come first: they count as one more chapter.
    let mut part =
        |done: usize, fraction: f64| progress((done as f64 + fraction) / (CHAPTERS.len() + 1) as f64);
    let subject = Subject { gear, trials: Trials::run(gear, |fraction| part(0, fraction))? };
    let mut chapters = Vec::new();
    for (index, make) in CHAPTERS.iter().enumerate() {
        chapters.push(make(&subject, &mut |fraction| part(index + 1, fraction))?);
    }
    let html = of_gear(gear, &chapters).into_string();
    let pictures =
        chapters.iter().flat_map(|chapter| pictures::of_chapter(chapter.id, &chapter.body)).collect();
    let mut measured = Measured::default();
    chapters.into_iter().for_each(|chapter| measured.add(chapter.measured));
    Ok(Report { html, measured, pictures })
}

fn of_gear(gear: &GearFile, chapters: &[Chapter]) -> Markup {
    let head = html! {
        p {
            "Ratio " (gear.gear.ratio) ", rated torque " (gear.gear.rated_torque) " N m. "
            "Written by strainwave " (env!("CARGO_PKG_VERSION")) "."
        }
    };
    page(&format!("strainwave: {}", gear.gear.name), &head, chapters)
}

/// A page of chapters under what stands at its head.
fn page(title: &str, head: &Markup, chapters: &[Chapter]) -> Markup {
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
                    (head)
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

/// Figures with their bounds, one that misses marked, and what was skipped.
fn figure_table(measured: &Measured) -> Markup {
    html! {
        div.wide {
            table.figures {
                thead { tr { @for name in Figure::HEADER { th { (name) } } } }
                tbody {
                    @for figure in &measured.figures {
                        tr class=[(!figure.holds).then_some("missed")] { @for cell in figure.cells() { td { (cell) } } }
                    }
                }
            }
        }
        @for note in &measured.notes { p { (note) } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(gear: &GearFile, figures: Vec<Figure>) -> String {
        let measured = Measured { figures, notes: vec!["b: skipped & said".into()] };
        let body =
            html! { (figure_table(&measured)) (table(["mesh", "links"], &[["8x3".into(), "120".into()]])) };
        of_gear(gear, &[Chapter { id: "one", title: "Chapter one", body, measured }]).into_string()
    }

    #[test]
    fn a_page_has_its_chapters_and_marks_what_is_missed() {
        let figures =
            vec![Figure::bounded("a.kept", 1.0, "m", 1.0), Figure::bounded("a.missed", 2.0, "m", 1.0)];
        let page = written(&GearFile::default_gear(), figures);
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
        assert!(page.contains("<a href=\"#one\">Chapter one</a>") && page.contains("<section id=\"one\">"));
        assert!(
            page.contains("<tr class=\"missed\"><td>a.missed</td><td>2</td><td>m</td><td>1</td><td>NO</td>")
        );
        assert!(page.contains("<p>b: skipped &amp; said</p>"));
        assert!(page.contains("<tr><td>a.kept</td>") && page.contains("<tr><td>8x3</td><td>120</td></tr>"));
    }

    #[test]
    fn a_name_is_text_whatever_it_is() {
        let mut gear = GearFile::default_gear();
        gear.gear.name = "<script>alert(\"1\")</script>&".into();
        let page = written(&gear, Vec::new());
        assert!(!page.contains("<script") && page.contains("&lt;script&gt;"), "{page}");
    }
}
