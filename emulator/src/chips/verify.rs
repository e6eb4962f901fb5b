//! The figures of the executed images, each with its bound.

use std::panic::resume_unwind;
use std::path::Path;
use std::thread;

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_desktop::verify::{Measured, bounds};
use strainwave_desktop::{Figure, GearFile};

use crate::artifact::{self, Image};
use crate::budget::{self, Budget};
use crate::chips::commanded::{BeforeOdrive, OnTheBus, before_odrive, on_the_bus};
use crate::chips::control::{constant_changed, second, stopped};
use crate::chips::model::{MODELS, Model};
use crate::chips::{run_error, served};
use crate::counting::worst_path::worst_case_path;
use crate::firmware::Program;
use crate::flash::DRIVE_DELAY;
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
    /// An image whose code cannot be read.
    #[error(transparent)]
    Image(#[from] artifact::Error),
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
        let of = |program, gear| pil::build_as(program, model.board, gear).map(|firmware| firmware.elf);
        let build = |program| of(program, &gear);
        let commanded = model.has_can.then(|| build(Program::COMMANDED)).transpose()?;
        let late = late_drive();
        let odrive = model.has_can.then(|| of(Program::BEFORE_ODRIVE, &late)).transpose()?;
        Ok((model, build(Program::Control)?, build(Program::Served)?, commanded, odrive))
    });
    let images = images.collect::<Result<Vec<_>, firmware::Error>>()?;
    thread::scope(|scope| {
        let mut started = Vec::new();
        for (model, alone, with_link, commanded, odrive) in &images {
            started.push(scope.spawn(|| of_image(model, alone)));
            started.push(scope.spawn(|| of_served(model, with_link)));
            let commanded = commanded.iter().map(|elf| scope.spawn(|| of_commanded(model, elf)));
            started.extend(commanded);
            started.extend(odrive.iter().map(|elf| scope.spawn(|| of_odrive(model, elf))));
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
    let run = on_the_bus(model, elf, &GearFile::default_gear())?;
    let rows = Rows { board: model.board, program: "can" };
    let mut figures = vec![
        run.agreement.figure(rows.name("steps_unlike_host")),
        rows.judged("frames_unlike_host", "pil.real.can.frames_unlike_host", run.frames.different as f64),
        rows.judged("answer", "pil.real.can.answer", run.found.answered_after),
        rows.judged("following", "pil.real.can.following", run.following),
        rows.judged("position", "pil.real.can.position", run.error),
        rows.judged("lost.release", "pil.real.can.lost.release", run.found.lost_after),
        rows.judged("encoder_lost.release", "pil.real.encoder_lost.release", run.found.failed_after),
    ];
    figures.extend(rows.of_both(&run, Program::COMMANDED, elf)?);
    Ok(Measured { figures, notes: rows.notes(&run) })
}

/// The image with a master on its bus and an ODrive on the second one.
fn of_odrive(model: &'static Model, elf: &Path) -> Result<Measured, Error> {
    let BeforeOdrive { on_the_bus: run, frames, delay } = before_odrive(model, elf, &late_drive())?;
    let image = Image::read(elf)?;
    let worst = |method: &str| {
        let method = format!("strainwave_app::commanded::odrive::Odrive::{method}");
        let paths = image.find(&method)?.into_iter().map(|function| worst_case_path(&image, function));
        // One without a bound is no number.
        Ok::<_, Error>(paths.map(|cycles| cycles.map_or(f64::NAN, |cycles| cycles as f64)).sum())
    };
    let [listen, command]: [f64; 2] = [worst("listen")?, worst("command")?];
    let rows = Rows { board: model.board, program: "odrive" };
    let different = run.frames.and(frames).different as f64;
    let mut figures = vec![
        rows.judged("frames_unlike_host", "pil.real.odrive.frames_unlike_host", different),
        Figure::reported(rows.name("frames_to_drive"), frames.steps as f64, "1"),
        rows.judged("answer", "pil.real.odrive.answer", run.found.answered_after),
        rows.judged("following", "pil.real.odrive.following", run.following),
        rows.judged("position", "pil.real.odrive.position", run.error),
        rows.judged("delay", "pil.real.odrive.delay", delay),
        rows.judged("cycles", "pil.real.odrive.cycles", listen + command),
        rows.judged("silent.release", "pil.real.odrive.silent.release", run.found.silent_after),
        rows.judged("error.named", "pil.real.odrive.error.named", run.found.error_after),
        rows.judged("lost.release", "pil.real.odrive.lost.release", run.found.lost_after),
        rows.judged("encoder_lost.release", "pil.real.odrive.encoder_lost.release", run.found.failed_after),
    ];
    figures.extend(rows.of_both(&run, Program::BEFORE_ODRIVE, elf)?);
    Ok(Measured { figures, notes: rows.notes(&run) })
}

/// The default gear with a drive behind CAN.
fn late_drive() -> GearFile {
    let mut gear = GearFile::default_gear();
    gear.drive.delay = DRIVE_DELAY;
    gear
}

/// Rows of a program that a master commands.
struct Rows {
    board: &'static str,
    program: &'static str,
}

impl Rows {
    fn name(&self, what: &str) -> String {
        format!("pil.{}.{}.{what}", self.board, self.program)
    }

    fn judged(&self, what: &str, row: &str, value: f64) -> Figure {
        bounds::figure_as(self.name(what), row, value)
    }

    /// What is not as expected.
    fn notes(&self, run: &OnTheBus) -> Vec<String> {
        let name = self.name("unexpected");
        run.found.unexpected.iter().map(|what| format!("{name}: not as expected: {what}")).collect()
    }

    /// What has the same bound whatever the drive is.
    fn of_both(&self, run: &OnTheBus, program: Program, elf: &Path) -> Result<Vec<Figure>, Error> {
        let budget = Budget::read(self.board)?;
        let proved = budget::inspect(&budget.of(program).unwrap_or(budget), elf)?.stack;
        Ok(vec![
            Figure::reported(self.name("steps"), run.agreement.steps as f64, "1"),
            Figure::reported(self.name("frames"), run.frames.steps as f64, "1"),
            self.judged("stopped.speed", "pil.real.can.stopped.speed", run.stopped_at),
            self.judged("unexpected", "pil.real.can.unexpected", run.found.unexpected.len() as f64),
            Figure::reported(self.name("expected"), run.found.expected.into(), "1"),
            Figure::bounded(self.name("stack"), run.stack as f64, "B", f64::from(proved.total)),
        ])
    }
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
