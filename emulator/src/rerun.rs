//! The worst runs of the robustness rows again: the firmware image in the emulator, the plant with the reference mesh.
//!
//! Every rival runs on the same plant, on the desktop. Nothing is shortened: each run is the 10 s of work, the scenario
//! and the rest of the rows.

pub mod claims;

use std::path::PathBuf;

use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::plant::divergence::RunError;
use strainwave_desktop::verify::compensator::each;
use strainwave_desktop::verify::robustness::{Place, RIVALS, Rerun, RunResult, WorstRun};
use strainwave_desktop::{Figure, GearFile};

use crate::machine::Machine;
use crate::pil::{self, Error};
use crate::target::{self, Agreement, Target};

/// Who controls a run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Who {
    /// The firmware, with these sensors.
    Firmware(SensorSet),
    /// The rival of this place.
    Rival(usize),
}

/// The runs that are made.
#[derive(Default)]
struct Runs(Vec<(Place, Who)>);

impl Runs {
    /// Each once, however many claims ask for it.
    fn of(worst: &[WorstRun]) -> Self {
        let mut runs = Self::default();
        for run in worst {
            runs.add(run.place, Who::Firmware(run.sensors));
            (0..RIVALS.len()).for_each(|rival| runs.add(run.place, Who::Rival(rival)));
        }
        runs
    }

    fn add(&mut self, place: Place, who: Who) {
        if !self.0.contains(&(place, who)) {
            self.0.push((place, who));
        }
    }
}

/// Gear files that the firmware was built for, with its images.
struct Images(Vec<(GearFile, PathBuf)>);

impl Images {
    fn build(board: &str, file: &GearFile, worst: &[WorstRun]) -> Result<Self, Error> {
        let mut images: Vec<(GearFile, PathBuf)> = Vec::new();
        for run in worst {
            let rerun = run.place.again(file).map_err(target::Error::from)?;
            if !images.iter().any(|(known, _)| known == rerun.known()) {
                images.push((rerun.known().clone(), pil::prepare(board, rerun.known())?.elf));
            }
        }
        Ok(Self(images))
    }

    /// The firmware's run; `None` where the plant diverges.
    fn run(
        &self,
        rerun: &Rerun,
        sensors: SensorSet,
    ) -> Result<(Option<RunResult>, Agreement), target::Error> {
        let joint = joint_params(rerun.known())?;
        let image = self.0.iter().find(|(known, _)| known == rerun.known());
        let (_, elf) = image.expect("an image was built for every plant");
        let mut target = Target::new(Machine::boot(elf, &[])?, &joint)?;
        let result = match rerun.result(sensors, &mut target) {
            Ok(result) => Some(result),
            Err(target::Error::Run(RunError::Diverged(_))) => None,
            Err(error) => return Err(error),
        };
        let agreement = target.agreement();
        target.finish()?;
        Ok((result, agreement))
    }
}

/// Makes the runs again with a board's firmware for the joint of `file`. Of each claim its value on the condensed mesh, on the
/// host, and on the reference mesh, with the firmware; and in how many steps that was unlike the host. `progress` is called with
/// the fraction done.
///
/// # Errors
/// When the firmware cannot be built or run, or a rival cannot be built.
pub fn measure(
    board: &str,
    file: &GearFile,
    worst: &[WorstRun],
    mut progress: impl FnMut(f64),
) -> Result<Vec<Figure>, Error> {
    let (images, runs) = (Images::build(board, file, worst)?, Runs::of(worst));
    let run = |(place, who): &(Place, Who)| -> Result<_, target::Error> {
        let rerun = place.again(file)?;
        match *who {
            Who::Firmware(sensors) => images.run(&rerun, sensors),
            Who::Rival(rival) => Ok((rerun.rival(&RIVALS[rival])?, Agreement::default())),
        }
    };
    let done = each(&runs.0, run, &mut progress).into_iter().collect::<Result<Vec<_>, _>>()?;
    let result = |place: Place, who: Who| -> Option<RunResult> {
        let found = runs.0.iter().position(|run| *run == (place, who))?;
        done[found].0.clone()
    };
    let figures = worst.iter().flat_map(|run| {
        let ours = result(run.place, Who::Firmware(run.sensors));
        let rivals: Vec<_> = (0..RIVALS.len()).map(|rival| result(run.place, Who::Rival(rival))).collect();
        let rerun = run.value(ours.as_ref(), &rivals);
        let figure = |what: &str, value| {
            Figure::reported(format!("{}.{what}", run.name()), value, run.unit()).of_seed(run.place.seed)
        };
        [figure("condensed", run.condensed), figure("reference", rerun)]
    });
    let mut figures: Vec<_> = figures.collect();
    let mut agreement = Agreement::default();
    for (_, run) in &done {
        agreement.steps += run.steps;
        agreement.different += run.different;
    }
    figures.push(Figure::reported("robustness.again.steps", agreement.steps as f64, "1"));
    figures.push(agreement.figure("robustness.again.steps_unlike_host"));
    Ok(figures)
}
