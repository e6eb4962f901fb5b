//! Processor in the loop: a board's firmware against the reference plant, or against a measured log.

use std::panic::resume_unwind;
use std::path::Path;
use std::thread::ScopedJoinHandle;

use strainwave::compensator::Faults;
use strainwave::gear::GearParams;
use strainwave_desktop::bench::baseline::Baseline;
use strainwave_desktop::bench::closed_loop;
use strainwave_desktop::bench::closed_loop::{Row, Run};
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::task::Task;
use strainwave_desktop::bench::working_motion::WorkingMotion;
use strainwave_desktop::bench::{Bench, Conditions, Motion, periods};
use strainwave_desktop::design::export::Export;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::identify::replay::{self, Judgement, ReplayRow};
use strainwave_desktop::identify::torque_loop::{Sample, TorqueLoop};
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::io::gear_file::{KinematicError, Learnt};
use strainwave_desktop::io::log::MeasuredLog;
use strainwave_desktop::plant::divergence::RunError;
use strainwave_desktop::plant::payload::Payload;
use strainwave_desktop::verify::bounds;
use strainwave_desktop::verify::compensator::{CLAIMS, Claim};
use strainwave_desktop::verify::judge::faults::Raised;
use strainwave_desktop::verify::judge::{Judge, Metric};
use strainwave_desktop::verify::robustness::{Judged, metrics};
use strainwave_desktop::{Figure, GearFile};

use crate::artifact::CONTROL_STEP;
use crate::artifact::{self, Image};
use crate::budget;
use crate::counting::{self, Counting, Counts};
use crate::firmware::{self, Firmware, Program};
use crate::machine::{Ending, Machine};
use crate::scratch::Scratch;
use crate::setup;
use crate::target::{self, Agreement, Follower, Target};

/// Why a firmware could not be run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The board is real only.
    #[error("board {board}: the emulator has no such machine, the boards that it has are {}", emulated.join(", "))]
    NotEmulated {
        /// Requested board.
        board: String,
        /// Emulated boards.
        emulated: Vec<String>,
    },
    /// No board of that name, or no image.
    #[error(transparent)]
    Firmware(#[from] firmware::Error),
    /// No emulator.
    #[error(transparent)]
    Setup(#[from] setup::Error),
    /// The budget file, which says whether a board is emulated.
    #[error(transparent)]
    Budget(#[from] budget::Error),
    /// The run failed.
    #[error(transparent)]
    Run(#[from] target::Error),
    /// The image cannot be read.
    #[error(transparent)]
    Image(#[from] artifact::Error),
    /// The control step could not be counted.
    #[error(transparent)]
    Counting(#[from] counting::Error),
}

/// Trial on the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial<'a> {
    /// Which motion.
    pub motion: Motion<'a>,
    /// On which plant, with which sensors.
    pub conditions: Conditions,
    /// Payload that the compensator is not told.
    pub payload: Payload,
    /// The compensator goes through the working motion first, as what is claimed of it asks.
    pub worked: bool,
}

impl<'a> Trial<'a> {
    /// A motion from rest on the plant of `seed`, with the sensors of a gear file and no payload.
    pub fn from_rest(file: &GearFile, motion: impl Into<Motion<'a>>, seed: u64) -> Self {
        let conditions = Conditions::of(file, seed);
        Self { motion: motion.into(), conditions, payload: Payload::NONE, worked: false }
    }

    /// The joint on the bench.
    pub(crate) fn bench(&self, file: &GearFile) -> Result<Bench, strainwave::Error> {
        Bench::loaded(file, &self.conditions, &self.payload.counted_from(self.motion.zero()))
    }

    /// The compensator has no stored kinematic error of the gear: it has to learn it in operation.
    pub fn learns_ripple(&self) -> bool {
        let learns = self.motion.scenario() == Some(Scenario::S4);
        self.worked && learns && self.conditions.sensors == SensorSet::Both
    }

    /// Gear file of the compensator.
    pub fn controller_gear(&self, file: &GearFile) -> GearFile {
        let mut known = file.clone();
        if self.learns_ripple() {
            known.kinematic_error = KinematicError::default();
        }
        known
    }

    /// Values of the compensator's claims in this motion, from its run and those of B0 and B1 on `plant`; there are none of a trajectory.
    ///
    /// # Errors
    /// A plant whose stiffness line is none.
    pub(crate) fn claimed(
        &self,
        file: &GearFile,
        plant: &GearParams<f64>,
        runs: [&Run; 3],
    ) -> Result<Vec<(&'static Claim, f64)>, strainwave::Error> {
        let Some(scenario) = self.motion.scenario() else { return Ok(Vec::new()) };
        let judges = runs.map(|run| Judge::new(scenario, plant, &run.trace));
        let value = |claim: &'static Claim| {
            let [ours, b0, b1] = judges.each_ref().map(|judge| judge.metric(claim.metric));
            Ok((claim, claim.relative(ours?, [b0?, b1?], file.gear.rated_torque)))
        };
        CLAIMS.iter().filter(|claim| claim.metric.is_of(scenario)).map(value).collect()
    }

    /// As its figures are named: `s2` from rest, `motor.s2` where the compensator has worked before.
    pub fn name(&self) -> String {
        let motion = self.motion.name();
        if self.worked { format!("{}.{motion}", self.conditions.sensors.name()) } else { motion.into() }
    }
}

/// Result of one trial.
pub struct TrialRun<'a> {
    /// Which.
    pub trial: Trial<'a>,
    /// The plant that it ran on, with the payload.
    pub plant: GearParams<f64>,
    /// The firmware's compensator.
    pub target: TargetRun,
    /// The baselines that the sensors allow, by name, B0 and B1 first.
    pub baselines: Vec<(&'static str, Run)>,
    /// Cost of the control step on the target.
    pub control_step: Counts,
}

/// Result of the firmware alone.
pub struct TargetRun {
    /// Its run of the motion.
    pub run: Run,
    /// Faults that it raised, while it worked before too.
    pub faults: Raised,
    /// Target against host.
    pub agreement: Agreement,
    /// Its report.
    pub ending: Ending,
    /// Its learnt factors and ripple.
    pub learnt: Learnt,
}

impl TrialRun<'_> {
    /// The output error against the baselines'.
    pub fn beside_baselines(&self) -> Figure {
        beside_baselines(&self.trial, &self.target.run, self.b0_and_b1())
    }

    fn b0_and_b1(&self) -> [&Run; 2] {
        [0, 1].map(|place| &self.baselines[place].1)
    }

    /// Faults by name, time at the torque limit, and how many metrics are worse than each baseline's: of a joint without a
    /// fault, none. That the torque was limited is judged by the time at the limit, and only reported among the faults.
    ///
    /// # Errors
    /// A plant whose stiffness line is none.
    pub fn health(&self, file: &GearFile) -> Result<Vec<Figure>, strainwave::Error> {
        let (judged, motion) = (Judged::of(file, &self.plant), self.trial.motion);
        let judged_part = |run: &Run| judged.without_rest(motion, &run.trace);
        let (name, ours) =
            (|rest: &str| format!("pil.{}.{rest}", self.trial.name()), judged_part(&self.target.run)?);
        let faults = || self.target.faults.times();
        let counted = faults().filter(|(fault, ..)| *fault != Faults::TORQUE_LIMITED).count();
        let mut figures = vec![bounds::figure_as(name("faults"), "pil.faults", counted as f64)];
        let time = |(_, fault, time): (Faults, &str, f64)| {
            Figure::reported(name(&format!("fault.{}", fault.replace(' ', "_"))), time, "s")
        };
        figures.extend(faults().map(time));
        figures.push(bounds::figure_as(name("limited"), "pil.limited", ours.limited));
        let compared = if metrics(motion).is_empty() { &[] } else { &self.baselines[..] };
        for (baseline, run) in compared {
            let theirs = judged_part(run)?;
            let worse = ours.worse_metrics(&theirs) as f64;
            figures.push(bounds::figure_as(name(&format!("{baseline}.worse")), "pil.worse_marks", worse));
            let ratio = |(metric, (ours, theirs)): (&Metric, (&f64, &f64))| {
                Figure::reported(name(&format!("{}.to_{baseline}", metric.name())), ours / theirs, "1")
            };
            figures.extend(metrics(motion).iter().zip(ours.metrics.iter().zip(&theirs.metrics)).map(ratio));
        }
        Ok(figures)
    }

    /// Claims of the compensator in this motion, on this plant; bounded where it has worked before. There are none of a trajectory,
    /// nor with a payload.
    ///
    /// # Errors
    /// A plant whose stiffness line is none.
    pub fn claims(&self, file: &GearFile) -> Result<Vec<Figure>, strainwave::Error> {
        let Trial { conditions, worked, payload, .. } = self.trial;
        if payload != Payload::NONE {
            return Ok(Vec::new());
        }
        let [b0, b1] = self.b0_and_b1();
        let values = self.trial.claimed(file, &self.plant, [&self.target.run, b0, b1])?;
        let figure = |(claim, value): (&Claim, f64)| {
            let figure = claim.of_target(conditions.sensors, value).of_seed(conditions.seed);
            let figure = figure.of_noise(conditions.realisation);
            if worked { figure } else { figure.without_bound() }
        };
        Ok(values.into_iter().map(figure).collect())
    }

    /// Width and stiffness of the loop of S6, each with the value by the plant's parameters; none in other scenarios.
    ///
    /// # Errors
    /// A plant whose stiffness line is none.
    pub fn loop_figures(&self) -> Result<Vec<Figure>, strainwave::Error> {
        let sample = |row: &Row| Sample { torsion: row.torsion, torque: row.transmitted };
        let samples: Vec<_> = self.target.run.trace.iter().map(sample).collect();
        let (Some(Scenario::S6), Some(found)) = (self.trial.motion.scenario(), TorqueLoop::of(&samples))
        else {
            return Ok(Vec::new());
        };
        let target = found.chord_stiffness_of(&self.plant.flexspline.line.build()?);
        Ok(vec![
            Figure::reported("pil.s6.loop.width", found.width, "rad"),
            Figure::reported("pil.s6.loop.width_asked", self.plant.hysteresis_width, "rad"),
            Figure::reported("pil.s6.chord_stiffness", found.chord_stiffness(), "N m/rad"),
            Figure::reported("pil.s6.chord_stiffness_asked", target, "N m/rad"),
        ])
    }
}

/// The compensated output error; in S2 it must be below both baselines on the same plant.
pub fn beside_baselines(trial: &Trial<'_>, compensated: &Run, [b0, b1]: [&Run; 2]) -> Figure {
    let name = format!("pil.{}.compensated.rms", trial.name());
    match trial.motion {
        Motion::Scenario(Scenario::S2) => Figure::bounded(name, compensated.rms, "rad", b0.rms.min(b1.rms)),
        _ => Figure::reported(name, compensated.rms, "rad"),
    }
}

/// Makes everything ready for runs of a board's firmware: the emulator, and the image for the joint of a gear
/// file. A board that cannot be run is refused before anything is installed or built.
///
/// # Errors
/// [`Error::Firmware`], [`Error::NotEmulated`], [`Error::Setup`].
pub fn prepare(board: &str, file: &GearFile) -> Result<Firmware, Error> {
    require_emulated(board)?;
    setup::this_emulator()?;
    Ok(build(board, file)?)
}

fn require_emulated(board: &str) -> Result<(), Error> {
    firmware::require_known(board)?;
    if budget::Budget::read(board)?.emulated {
        return Ok(());
    }
    Err(Error::NotEmulated { board: board.into(), emulated: budget::emulated_boards()? })
}

/// Builds a board's firmware for the joint of a gear file.
///
/// # Errors
/// As [`firmware::build`]; a gear that no compensator can be built from.
pub fn build(board: &str, file: &GearFile) -> Result<Firmware, firmware::Error> {
    with_joint_file(file, |joint| firmware::build(board, Some(joint)))
}

/// Builds one of a board's programs that control the joint.
///
/// # Errors
/// As [`build`].
pub fn build_as(program: Program, board: &str, file: &GearFile) -> Result<Firmware, firmware::Error> {
    with_joint_file(file, |joint| firmware::build_as(program, board, joint))
}

/// Builds with a file of the joint's constants.
fn with_joint_file(
    file: &GearFile,
    build: impl FnOnce(&Path) -> Result<Firmware, firmware::Error>,
) -> Result<Firmware, firmware::Error> {
    let export = Export::of(file).map_err(std::io::Error::other)?;
    let folder = Scratch::new("joint")?;
    let generated = folder.path().join("joint.rs");
    std::fs::write(&generated, export.rust())?;
    build(&generated)
}

/// Runs a trial with the firmware and, from rest, every baseline that its sensors allow side by side, and counts what the control step costs
/// on the target. The firmware was built for what [`Trial::controller_gear`] has of the gear.
///
/// # Errors
/// When the machine or the count fails, or a parameter is out of range.
pub fn run<'a>(
    elf: &Path,
    file: &GearFile,
    trial: &Trial<'a>,
    progress: impl FnMut(f64),
) -> Result<TrialRun<'a>, Error> {
    std::thread::scope(|scope| {
        let start = |(name, mut baseline): (&'static str, Baseline)| {
            let run = scope.spawn(move || {
                let mut bench = trial.bench(file)?;
                closed_loop::go_on(&mut bench, trial.motion, &mut baseline, |_| ())
            });
            (name, run)
        };
        let baselines = Baseline::all(file, trial.conditions.sensors).map_err(target::Error::from)?;
        let image = Image::read(elf)?;
        let counting = Counting::prepare(&image, &image.find(CONTROL_STEP)?)?;
        let baselines: Vec<_> = baselines.into_iter().map(start).collect();
        let target = compensated(elf, &counting.arguments(), file, trial, progress)?;
        let control_step = counting.results(&image)?.counts.into_iter().next().flatten();
        let baselines = baselines.into_iter().map(|(name, run)| Ok((name, joined(run)?)));
        let baselines = baselines.collect::<Result<_, target::Error>>()?;
        let control_step = control_step.ok_or(counting::Error::NoResult)?;
        let plant = trial.payload.on(&trial.conditions.plant(file).map_err(target::Error::from)?);
        Ok(TrialRun { trial: *trial, plant, target, baselines, control_step })
    })
}

/// Result of a thread; its panic is resumed here.
fn joined<T>(thread: ScopedJoinHandle<'_, Result<T, RunError>>) -> Result<T, target::Error> {
    Ok(thread.join().unwrap_or_else(|panic| resume_unwind(panic))?)
}

/// Runs a trial with the firmware alone, which was built for what [`Trial::controller_gear`] has of the gear.
///
/// # Errors
/// When the machine fails, or a parameter is out of range.
pub fn compensated(
    elf: &Path,
    qemu_arguments: &[String],
    file: &GearFile,
    trial: &Trial<'_>,
    mut progress: impl FnMut(f64),
) -> Result<TargetRun, target::Error> {
    let mut target =
        Target::new(Machine::boot(elf, qemu_arguments)?, &joint_params(&trial.controller_gear(file))?)?;
    let mut bench = trial.bench(file)?;
    let work = if trial.worked { WorkingMotion.duration() } else { 0.0 };
    let whole = work + trial.motion.duration();
    let mut faults = Raised::default();
    if trial.worked {
        let count = periods(&WorkingMotion) as f64;
        bench.go(&WorkingMotion, &mut target, |k, _, _, answer| {
            faults.add(answer.faults);
            progress(k as f64 / count * work / whole);
        })?;
    }
    let part = |fraction: f64| progress((work + fraction * trial.motion.duration()) / whole);
    let run = closed_loop::go_on(&mut bench, trial.motion, &mut target, part)?;
    run.trace.iter().for_each(|row| faults.add(row.answer.faults));
    let (agreement, learnt) = (target.agreement(), Learnt::of(&target.learnt()));
    Ok(TargetRun { run, faults, agreement, ending: target.finish()?, learnt })
}

/// Lets the firmware follow the host's build through a scenario on the condensed plant: for what a control step costs, or its bits beside the
/// host's, to which the accuracy of the plant adds nothing, while the reference mesh takes longer than all else. Target against host,
/// and the firmware's report.
///
/// # Errors
/// When the machine fails, or a parameter is out of range.
pub fn workload(
    elf: &Path,
    qemu_arguments: &[String],
    file: &GearFile,
    (scenario, conditions): (Scenario, &Conditions),
    mut progress: impl FnMut(f64),
) -> Result<(Agreement, Ending), target::Error> {
    let machine = Machine::boot(elf, qemu_arguments)?;
    let mut target = Follower::new(machine, &joint_params(file)?, |_| ())?;
    let mut bench = Bench::condensed(file, conditions)?;
    let count = periods(&scenario) as f64;
    bench.go(&scenario, &mut target, |k, _, _, _| progress(k as f64 / count))?;
    target.finish()
}

/// Result of a replay.
pub struct Replay {
    /// One row a control period.
    pub rows: Vec<ReplayRow>,
    /// Predicted against measured output.
    pub judgement: Judgement,
    /// Target against host.
    pub agreement: Agreement,
    /// The firmware's report.
    pub ending: Ending,
}

/// Feeds a measured log through the firmware's observer; the output encoder is kept from it. Judged are the rows after the
/// time `learnt` (s), all of them when there is none.
///
/// # Errors
/// When the machine fails, or a parameter is out of range.
pub fn replay(
    elf: &Path,
    file: &GearFile,
    log: &MeasuredLog,
    learnt: Option<f64>,
    progress: impl FnMut(f64),
) -> Result<Replay, target::Error> {
    let mut target = Target::new(Machine::boot(elf, &[])?, &joint_params(file)?)?;
    let rows = replay::replay(&mut target, file, log, f64::INFINITY, progress)?;
    let judgement = Judgement::of(&rows, learnt.unwrap_or(f64::NEG_INFINITY));
    let agreement = target.agreement();
    Ok(Replay { rows, judgement, agreement, ending: target.finish()? })
}
