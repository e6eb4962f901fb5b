//! What the firmware of one gear costs on its board, as far as seconds show it.
//!
//! Flash, RAM, stack and the proofs are of the image that is flashed. Instructions and cycles of the control step are counted
//! in the emulator, with the gear's own constants; of a board that it does not have, in the image for the board of the
//! same core that the budget names.

use std::path::{Path, PathBuf};

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::Conditions;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::task::Task;

use super::Error;
use crate::artifact::{CONTROL_STEP, Image};
use crate::budget::{self, Budget, Failure, Measurement};
use crate::pil;
use crate::setup;

/// Over which the control step is counted, each from rest: 2.75 s of control.
pub const WORKLOAD: [Scenario; 3] = [Scenario::S1, Scenario::S3, Scenario::S5];

/// The plant of these runs: the nominal one.
const SEED: u64 = 0;

/// Costs of a gear's firmware.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// What was measured.
    pub measured: Measurement,
    /// Where the control step was counted.
    pub counted: Counted,
}

/// Where the control step was counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Counted {
    /// In the image of this board.
    On(String),
    /// Nowhere, for this reason.
    Not(&'static str),
}

/// Judges the image at `elf`, which was built for `gear` and the board of `budget`; `progress` is called with the fraction done.
///
/// # Errors
/// When the image cannot be judged, the other board's image not be built, or a run fails.
pub fn judge(
    budget: &Budget,
    elf: &Path,
    gear: &GearFile,
    progress: impl FnMut(f64),
) -> Result<Judgement, Error> {
    let mut measured = budget::inspect(budget, elf)?;
    let (counted, image) = counting_image(budget, elf, gear)?;
    if let Some(image) = image {
        let blocks = [(CONTROL_STEP, &budget.control_step)];
        let mut deepest = None;
        measured.add_workload(&image, &blocks, |arguments| {
            deepest = Some(run(&image, arguments, gear, progress)?);
            Ok(())
        })?;
        // The stack of another board's image is not this one's.
        measured.stack_mark = deepest.filter(|_| budget.emulated);
    }
    Ok(Judgement { measured, counted })
}

/// The image to be counted, where there is one.
fn counting_image(budget: &Budget, elf: &Path, gear: &GearFile) -> Result<(Counted, Option<PathBuf>), Error> {
    if budget.emulated {
        return Ok((Counted::On(budget.board.clone()), Some(elf.to_owned())));
    }
    let Some(other) = &budget.counted_on else {
        return Ok((
            Counted::Not("the emulator has no such board, and its budget names none in its place"),
            None,
        ));
    };
    // It is not fetched: the board is flashed without it.
    if setup::present_emulator(&setup::ThisHost).is_none() {
        return Ok((Counted::Not("there is no emulator; `strainwave setup` fetches it"), None));
    }
    let image = pil::build(other, gear)?.elf;
    let core = |elf: &Path| Ok::<_, Error>(Image::read(elf).map_err(budget::Error::from)?.core().to_owned());
    let (core, found) = (core(elf)?, core(&image)?);
    if core != found {
        let (board, other) = (budget.board.clone(), other.clone());
        return Err(Error::OtherCore { board, core, other, found });
    }
    Ok((Counted::On(other.clone()), Some(image)))
}

/// Runs the workload; the deepest stack that the firmware reports, in bytes.
fn run(
    elf: &Path,
    arguments: &[String],
    gear: &GearFile,
    mut progress: impl FnMut(f64),
) -> Result<u32, Failure> {
    let whole: f64 = WORKLOAD.iter().map(Task::duration).sum();
    let (mut deepest, mut done) = (0, 0.0);
    for scenario in WORKLOAD {
        let conditions = Conditions::of(gear, SEED);
        let part = |fraction: f64| progress((done + fraction * scenario.duration()) / whole);
        let (_, ending) = pil::workload(elf, arguments, gear, (scenario, &conditions), part)?;
        deepest = deepest.max(ending.stack);
        done += scenario.duration();
    }
    Ok(deepest)
}
