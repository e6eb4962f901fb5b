//! The figures of the executed images, each with its bound.

use std::panic::resume_unwind;
use std::path::Path;
use std::thread;

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_desktop::verify::{Measured, bounds};
use strainwave_desktop::{Figure, GearFile};

use crate::budget::{self, Budget};
use crate::chips::commanded::{OnTheBus, on_the_bus};
use crate::chips::control::{constant_changed, second, stopped};
use crate::chips::model::{MODELS, Model};
use crate::chips::{run_error, served};
use crate::firmware::Program;
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
    Run(#[from] run_error::Error),
}

/// Runs the default gear's images of every board; a note names each check that was not as expected.
///
/// # Errors
/// [`Error`].
pub fn measure() -> Result<Measured, Error> {
    let gear = GearFile::default_gear();
    // Built one by one, as cargo would anyway; run side by side, each on a processor of its own.
    let images = MODELS.iter().map(|model| {
        let build = |program| pil::build_as(program, model.board, &gear).map(|firmware| firmware.elf);
        let commanded = model.has_can.then(|| build(Program::COMMANDED)).transpose()?;
        Ok((model, build(Program::Control)?, build(Program::Served)?, commanded))
    });
    let images = images.collect::<Result<Vec<_>, firmware::Error>>()?;
    thread::scope(|scope| {
        let mut started = Vec::new();
        for (model, alone, with_link, commanded) in &images {
            started.push(scope.spawn(|| of_image(model, alone)));
            started.push(scope.spawn(|| of_served(model, with_link)));
            let commanded = commanded.iter().map(|elf| scope.spawn(|| of_commanded(model, elf)));
            started.extend(commanded);
        }
        let mut measured = Measured::default();
        for run in started {
            measured.add(run.join().unwrap_or_else(|panic| resume_unwind(panic))?);
        }
        Ok(measured)
    })
}

/// The image with a host at its tuning link.
fn of_served(model: &'static Model, elf: &Path) -> Result<Measured, Error> {
    let found = served::serve(model, elf, &GearFile::default_gear())?;
    let name = |what: &str| format!("pil.{}.served.{what}", model.board);
    let judged = |row: &str, value| bounds::figure_as(row.replacen("real", model.board, 1), row, value);
    let time = |periods: u32| f64::from(periods) * CONTROL_PERIOD;
    let notes =
        found.unexpected.iter().map(|what| format!("{}: not as expected: {what}", name("unexpected")));
    let notes = notes.collect();
    let figures = vec![
        found.agreement.figure(name("steps_unlike_host")),
        Figure::reported(name("steps"), found.agreement.steps as f64, "1"),
        judged("pil.real.served.readings_unlike_host", found.readings.different as f64),
        Figure::reported(name("readings"), found.readings.steps as f64, "1"),
        judged("pil.real.served.answer", time(found.answered_after)),
        judged("pil.real.served.damaged", found.damaged as f64),
        judged("pil.real.served.unexpected", found.unexpected.len() as f64),
        Figure::reported(name("expected"), found.expected.into(), "1"),
        Figure::reported(name("keep"), time(found.kept_after), "s"),
    ];
    Ok(Measured { figures, notes })
}

/// The image with a master on its bus.
fn of_commanded(model: &'static Model, elf: &Path) -> Result<Measured, Error> {
    let OnTheBus { found, agreement, frames, following, error, stopped_at, stack } =
        on_the_bus(model, elf, &GearFile::default_gear())?;
    let budget = Budget::read(model.board)?;
    let proved = budget::inspect(&budget.of(Program::COMMANDED).unwrap_or(budget), elf)?.stack;
    let name = |what: &str| format!("pil.{}.can.{what}", model.board);
    let judged = |row: &str, value| bounds::figure_as(row.replacen("real", model.board, 1), row, value);
    let notes =
        found.unexpected.iter().map(|what| format!("{}: not as expected: {what}", name("unexpected")));
    let notes = notes.collect();
    let figures = vec![
        agreement.figure(name("steps_unlike_host")),
        Figure::reported(name("steps"), agreement.steps as f64, "1"),
        judged("pil.real.can.frames_unlike_host", frames.different as f64),
        Figure::reported(name("frames"), frames.steps as f64, "1"),
        judged("pil.real.can.answer", found.answered_after),
        judged("pil.real.can.following", following),
        judged("pil.real.can.position", error),
        judged("pil.real.can.lost.release", found.lost_after),
        judged("pil.real.can.stopped.speed", stopped_at),
        bounds::figure_as(name("encoder_lost.release"), "pil.real.encoder_lost.release", found.failed_after),
        judged("pil.real.can.unexpected", found.unexpected.len() as f64),
        Figure::reported(name("expected"), found.expected.into(), "1"),
        Figure::bounded(name("stack"), stack as f64, "B", f64::from(proved.total)),
    ];
    Ok(Measured { figures, notes })
}

fn of_image(model: &'static Model, elf: &Path) -> Result<Measured, Error> {
    let (gear, board) = (GearFile::default_gear(), model.board);
    let (second, stopped, changed) =
        (second(model, elf, &gear)?, stopped(model, elf)?, constant_changed(model, elf)?);
    let proved = budget::inspect(&Budget::read(board)?, elf)?.stack;
    let damaged = second.lines.iter().filter(|line| line.contains("damaged")).count();
    let said = second.lines.iter().any(|line| line.starts_with(LOST));
    let name = |what: &str| format!("pil.{board}.{what}");
    let judged = |row: &str, value| bounds::figure_as(row.replacen("real", board, 1), row, value);
    let reported = |what: &str, value, unit| Figure::reported(name(what), value, unit);
    let figures = vec![
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
        judged("pil.real.constant_changed.release", changed.released_after),
        judged("pil.real.constant_changed.enabled", changed.enabled as f64),
    ];
    Ok(figures.into())
}
