//! The figures of the executed image, each with its bound.

use strainwave_desktop::verify::bounds;
use strainwave_desktop::{Figure, GearFile};

use crate::budget::{self, Budget};
use crate::stm32f405::control::{self, second, stopped};
use crate::{firmware, pil};

/// The board.
pub const BOARD: &str = "stm32f405";
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

/// Runs the default gear's image.
///
/// # Errors
/// [`Error`].
pub fn measure() -> Result<Vec<Figure>, Error> {
    let gear = GearFile::default_gear();
    let elf = pil::build(BOARD, &gear)?.elf;
    let (second, stopped) = (second(&elf, &gear)?, stopped(&elf)?);
    let proved = budget::inspect(&Budget::read(BOARD)?, &elf)?.stack;
    let damaged = second.lines.iter().filter(|line| line.contains("damaged")).count();
    let said = second.lines.iter().any(|line| line.starts_with(LOST));
    Ok(vec![
        second.agreement.figure("pil.stm32f405.steps_unlike_host"),
        Figure::reported("pil.stm32f405.steps", second.agreement.steps as f64, "1"),
        bounds::figure("pil.stm32f405.misread", second.misread as f64),
        Figure::reported("pil.stm32f405.start", second.started_after, "s"),
        Figure::reported("pil.stm32f405.planned_after", second.planned_after as f64, "period"),
        bounds::figure("pil.stm32f405.position", second.error),
        Figure::bounded("pil.stm32f405.stack", second.stack as f64, "B", f64::from(proved.total)),
        Figure::reported("pil.stm32f405.telemetry", second.lines.len() as f64, "line"),
        bounds::figure("pil.stm32f405.telemetry.damaged", damaged as f64),
        bounds::figure("pil.stm32f405.encoder_lost.release", second.released_after),
        bounds::figure("pil.stm32f405.encoder_lost.unsaid", f64::from(u8::from(!said))),
        bounds::figure("pil.stm32f405.stopped.release", stopped.released_after),
        bounds::figure("pil.stm32f405.stopped.enabled", stopped.enabled as f64),
    ])
}
