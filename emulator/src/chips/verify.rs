//! The figures of the executed image, each with its bound.

use strainwave_desktop::verify::bounds;
use strainwave_desktop::{Figure, GearFile};

use crate::budget::{self, Budget};
use crate::chips::control::{self, second, stopped};
use crate::chips::model::{MODELS, Model};
use crate::{firmware, pil};

/// What the firmware says of a lost encoder.
const LOST: &str = "motor encoder lost";

/// Why it could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No image.
    #[error(transparent)]
    Firmware(#[from] firmware::Error),
    /// No budget.
    #[error(transparent)]
    Budget(#[from] budget::Error),
    /// The run.
    #[error(transparent)]
    Run(#[from] control::Error),
}

/// Runs the default gear's image of every board.
///
/// # Errors
/// [`Error`].
pub fn measure() -> Result<Vec<Figure>, Error> {
    let figures = MODELS.iter().map(of_board).collect::<Result<Vec<_>, _>>()?;
    Ok(figures.concat())
}

fn of_board(model: &'static Model) -> Result<Vec<Figure>, Error> {
    let (gear, board) = (GearFile::default_gear(), model.board);
    let elf = pil::build(board, &gear)?.elf;
    let (second, stopped) = (second(model, &elf, &gear)?, stopped(model, &elf)?);
    let proved = budget::inspect(&Budget::read(board)?, &elf)?.stack;
    let damaged = second.lines.iter().filter(|line| line.contains("damaged")).count();
    let said = second.lines.iter().any(|line| line.starts_with(LOST));
    let name = |what: &str| format!("pil.{board}.{what}");
    let judged = |row: &str, value| bounds::figure_as(row.replacen("real", board, 1), row, value);
    let reported = |what: &str, value, unit| Figure::reported(name(what), value, unit);
    Ok(vec![
        second.agreement.figure(name("steps_unlike_host")),
        reported("steps", second.agreement.steps as f64, "1"),
        judged("pil.real.misread", second.misread as f64),
        reported("start", second.started_after, "s"),
        reported("planned_after", second.planned_after as f64, "period"),
        judged("pil.real.position", second.error),
        Figure::bounded(name("stack"), second.stack as f64, "B", f64::from(proved.total)),
        reported("telemetry", second.lines.len() as f64, "line"),
        judged("pil.real.telemetry.damaged", damaged as f64),
        judged("pil.real.encoder_lost.release", second.released_after),
        judged("pil.real.encoder_lost.unsaid", f64::from(u8::from(!said))),
        judged("pil.real.stopped.release", stopped.released_after),
        judged("pil.real.stopped.enabled", stopped.enabled as f64),
    ])
}
