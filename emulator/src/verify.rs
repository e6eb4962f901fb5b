//! The figures that are measured on the firmware image, each beside its bound.

use std::io;

use strainwave_desktop::log::MeasuredLog;
use strainwave_desktop::scenario::Scenario;
use strainwave_desktop::{BadInput, Figure, GearFile, bounds, data, gear_file};

use crate::budget::{self, Budget};
use crate::{firmware, pil, target};

/// Board that the emulator has.
const BOARD: &str = "mps2-an386";
/// Log of a held joint that winds up under another one's swinging payload.
const LOG: &str = "lara8/joint/jog_j2_mass.j5.csv";
/// Plant of the runs.
const SEED: u64 = 1;

/// Why the firmware could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No image.
    #[error(transparent)]
    Firmware(#[from] firmware::Error),
    /// A run that failed.
    #[error(transparent)]
    Run(#[from] pil::Error),
    /// The same without baselines.
    #[error(transparent)]
    Target(#[from] target::Error),
    /// An image that cannot be judged.
    #[error(transparent)]
    Budget(#[from] budget::Error),
    /// A log or gear file.
    #[error(transparent)]
    Input(#[from] BadInput),
    /// The boards' folder.
    #[error("boards: {0}")]
    Boards(#[from] io::Error),
}

/// Every figure of the firmware, and what was skipped and why.
///
/// # Errors
/// When an image cannot be built, booted or judged.
pub fn measure(mut progress: impl FnMut(f64)) -> Result<(Vec<Figure>, Option<String>), Error> {
    let mut figures = proofs()?;
    figures.extend(scenarios(|share| progress(0.95 * share))?);
    let Some(log) = data::find(LOG) else {
        return Ok((figures, Some(format!("pil.replay.size_17: skipped: no data ({LOG})"))));
    };
    figures.extend(replay(&MeasuredLog::read(&log)?)?);
    Ok((figures, None))
}

/// Panics, allocators and double precision in the images of all boards.
fn proofs() -> Result<Vec<Figure>, Error> {
    let mut figures = Vec::new();
    for board in firmware::boards()? {
        let elf = firmware::build(&board, None)?.elf;
        let budget = Budget::read(&board)?;
        figures.extend(budget::inspect(&budget, &elf)?.proof_figures(&budget));
    }
    Ok(figures)
}

/// All scenarios on the target; S2 beside its baselines.
fn scenarios(mut progress: impl FnMut(f64)) -> Result<Vec<Figure>, Error> {
    let gear = GearFile::default_gear();
    let elf = pil::build(BOARD, &gear)?.elf;
    let mut figures = Vec::new();
    for (done, scenario) in Scenario::ALL.into_iter().enumerate() {
        let name = |rest: &str| format!("pil.{}.{rest}", scenario.name());
        let mut part = |share: f64| progress((done as f64 + share) / Scenario::ALL.len() as f64);
        let (run, agreement) = if scenario == Scenario::S2 {
            let run = pil::run(&elf, &gear, scenario, SEED, &mut part)?;
            figures.push(run.beside_baselines());
            (run.compensated, run.agreement)
        } else {
            let (run, agreement, _) = pil::compensated(&elf, &[], &gear, scenario, SEED, &mut part)?;
            (run, agreement)
        };
        figures.push(agreement.figure(name("steps_unlike_host")));
        figures.push(bounds::figure_as(name("power_balance"), "plant.power_balance", run.imbalance));
    }
    Ok(figures)
}

/// The size 17 gear's catalogue line, unfitted, against the measured output encoder.
fn replay(log: &MeasuredLog) -> Result<Vec<Figure>, Error> {
    let gear = GearFile::parse("gears/lara8-j5.toml".as_ref(), gear_file::LARA8_J5.as_bytes())?;
    let elf = pil::build(BOARD, &gear)?.elf;
    let replay = pil::replay(&elf, &gear, log, |_| ())?;
    Ok(vec![
        bounds::figure("pil.replay.size_17.rms", replay.rms),
        Figure::reported("pil.replay.size_17.rigid.rms", replay.rigid_rms, "rad"),
        replay.agreement.figure("pil.replay.size_17.steps_unlike_host"),
    ])
}
