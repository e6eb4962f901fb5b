//! The friction's chapter: every model with the numbers of one side of the gear, on the same motions.

mod level;
mod models;
mod paper_table;
mod presliding;
mod stick_slip;

use maud::{Markup, html};
use strainwave::friction::ModelName;

use super::{Chapter, figure_table, table};
use crate::io::file::BadInput;
use crate::io::gear_file::{Friction, GearFile};
use crate::report::plot::{Panel, Series};
use crate::verify::Part;
use models::{Model, Models, Numbers};

/// Small panels side by side.
const COLUMNS: usize = 3;

pub(super) fn chapter(gear: &GearFile, progress: &mut dyn FnMut(f64)) -> Result<Chapter, BadInput> {
    let numbers = Numbers::of(&gear.friction.input);
    let models = Models::build(&numbers);
    let level = level::section(&numbers, &models);
    progress(0.1);
    let presliding = presliding::section(&numbers, &models);
    progress(0.2);
    let stick_slip = stick_slip::section(&numbers, &models);
    progress(0.5);
    let (paper_table, told) = paper_table::section(&numbers, &models);
    let mut measured = Part::Friction.measure()?;
    measured.figures.extend(told);
    let body = html! {
        (introduction(gear, &numbers, &models)) (paper_table) (level) (presliding) (stick_slip)
        h3 { "Figures with their bounds" }
        p { "Measured now, on the default gear: " code { "strainwave verify friction" } "." }
        (figure_table(&measured))
    };
    Ok(Chapter { id: "friction", title: "Friction", body, measured })
}

fn introduction(gear: &GearFile, numbers: &Numbers, models: &Models) -> Markup {
    let row = |name: &ModelName| [name.word().into(), needs(*name), name.may_have().join(", ")];
    let rows: Vec<_> = ModelName::ALL.iter().map(row).collect();
    html! {
        p {
            "Every model of the library, as " code { "model" } " under " code { "[friction.input]" } " and "
            code { "[friction.output]" } " of a gear file names it, computed by the library and with the numbers of this "
            "gear's wave generator, whose model is " code { (gear.friction.input.model.word()) } ": "
            (numbers.levels()) ". " (numbers.taken())
        }
        @for note in &models.left_out { p { (note) } }
        div.words { (table(["model", "keys that it needs", "keys that it may have"], &rows)) }
    }
}

/// Steady friction (N m) of a side's own model at speeds (rad/s) other than 0; `None` where its numbers do not build it.
pub(super) fn steady(side: &Friction, speeds: &[f64]) -> Option<Vec<f64>> {
    let (numbers, model) = (Numbers::of(side), Model::of(side)?);
    Some(speeds.iter().map(|speed| level::steady(&numbers, &model, *speed)).collect())
}

fn needs(name: ModelName) -> String {
    name.needs().collect::<Vec<_>>().join(", ")
}

/// A model's curve, and dashed lines of (x, level) beside it; forces in mN m.
fn panel(axes: Panel, name: &str, [x, force]: [&[f64]; 2], levels: &[Vec<(f64, f64)>]) -> Panel {
    let milli = |force: &f64| force * 1e3;
    let curve = Series::line("", x, &force.iter().map(milli).collect::<Vec<_>>());
    levels.iter().fold(axes.titled(name).with(curve), |panel, level| {
        let (x, level): (Vec<_>, Vec<_>) = level.iter().map(|(x, level)| (x, milli(level))).unzip();
        panel.with(Series::dashed("", &x, &level))
    })
}
