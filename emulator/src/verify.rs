//! The figures that are measured on the firmware image, each with its bound.

use std::io;
use std::panic::resume_unwind;
use std::path::Path;

use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY};
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState};
use strainwave_desktop::bench::Conditions;
use strainwave_desktop::bench::baseline::Baseline;
use strainwave_desktop::bench::closed_loop;
use strainwave_desktop::bench::closed_loop::Run;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::torque_sensing::Record;
use strainwave_desktop::io::log::MeasuredLog;
use strainwave_desktop::io::{data, gear_file};
use strainwave_desktop::verify::{self, Measured, bounds};
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::any_input;
use crate::artifact::{CONTROL_STEP, Image};
use crate::budget::{self, Budget, TORQUE_GAUGES};
use crate::pil::{TargetRun, Trial};
use crate::target::{self, Agreement};
use crate::{chips, firmware, gauges, pil};

/// Board whose figures these are, but for the rows of every emulated one.
pub const BOARD: &str = "mps2-an386";
/// The real-time flexspline among the blocks of its budget.
const FLEXSPLINE: &str = "flexspline";
/// One side's friction.
const FRICTION: &str = "friction";
/// The real-time hysteresis and its state.
type RealTimeHysteresis = TorsionHysteresis<f32, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>;
type RealTimeHysteresisState = TorsionHysteresisState<f32, HYSTERESIS_MEMORY>;
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
    /// A search that failed.
    #[error(transparent)]
    AnyInput(#[from] any_input::Error),
    /// The image of the real board.
    #[error(transparent)]
    Chips(#[from] chips::verify::Error),
    /// The boards' folder.
    #[error("boards: {0}")]
    Boards(#[from] io::Error),
}

/// The parts of the project that have figures here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// The whole control step.
    Firmware,
    /// The real-time flexspline on the target.
    Flexspline,
    /// Both, over one run of S1-S6.
    Both,
}

/// Every figure of the parts.
///
/// # Errors
/// When an image cannot be built, booted or judged.
pub fn measure(parts: Parts, mut progress: impl FnMut(f64)) -> Result<Measured, Error> {
    let gear = GearFile::default_gear();
    let elf = pil::build(BOARD, &gear)?.elf;
    let mut runs = Vec::new();
    let mut run = |arguments: &[String]| -> Result<(), Error> {
        runs = scenarios(&gear, &elf, arguments, |fraction| progress(0.9 * fraction))?;
        Ok(())
    };
    let costs =
        if parts == Parts::Firmware { run(&[]).map(|()| Vec::new())? } else { flexspline(&elf, run)? };
    if parts == Parts::Flexspline {
        return Ok(costs.into());
    }
    let boards = every_board(&runs)?;
    let mut measured = Measured::from([proofs()?, control_step(&runs)?, boards].concat());
    measured.add(chips::verify::measure()?);
    measured.add(costs.into());
    match data::find(LOG) {
        Some(log) => measured.figures.extend(replay(&MeasuredLog::read(&log)?)?),
        None => measured.notes.push(format!("pil.replay.size_17: skipped: no data ({LOG})")),
    }
    Ok(measured)
}

/// Cost of the real-time flexspline over `workload`, and of the literal mesh that it replaces; NaN without one.
fn flexspline(
    elf: &Path,
    workload: impl FnOnce(&[String]) -> Result<(), Error>,
) -> Result<Vec<Figure>, Error> {
    let budget = Budget::read(BOARD)?;
    let mut measured = budget::measure(&budget, elf, |arguments| Ok(workload(arguments).map(|()| None)?))?;
    if let Some(mesh) = &budget.literal_mesh {
        let program = firmware::build_program(BOARD, &mesh.program)?;
        mesh.measure(&program.elf, &mut measured)?;
    }
    let cycles = measured.counts_of(FLEXSPLINE).and_then(|counts| Some(counts.cycles?.max));
    let ratio = measured.literal_over_reduced(&budget);
    let [cycles, ratio] = [cycles, ratio].map(|count| count.map_or(f64::NAN, |count| count as f64));
    Ok(vec![
        bounds::figure("flexspline.target.cycles", cycles),
        bounds::figure("flexspline.target.literal_over_reduced", ratio),
    ])
}

/// Cycles of the worst-case path through one side's friction on the target: order 2, with load, direction and ripple.
///
/// # Errors
/// When the image cannot be built or judged.
pub fn friction() -> Result<Measured, Error> {
    let budget = Budget::read(BOARD)?;
    let image =
        Image::read(&pil::build(BOARD, &GearFile::default_gear())?.elf).map_err(budget::Error::from)?;
    let worst_case = budget.blocks.get(FRICTION).map(|block| block.worst_case(&image)).transpose()?.flatten();
    let cycles = worst_case.map_or(f64::NAN, |cycles| cycles as f64);
    Ok(vec![bounds::figure("friction.target.cycles", cycles)].into())
}

/// Cost of hysteresis on the target: cycles of the worst-case path through its code, those of the most costly call along
/// the histories that cost most beside it, and bytes.
///
/// # Errors
/// When the image cannot be built, booted or judged.
pub fn hysteresis() -> Result<Measured, Error> {
    let budget = Budget::read(BOARD)?;
    let mut figures = vec![
        bounds::figure("hysteresis.table.bytes", size_of::<RealTimeHysteresis>() as f64),
        bounds::figure("hysteresis.state.bytes", size_of::<RealTimeHysteresisState>() as f64),
    ];
    let Some(worst) = &budget.worst_case else { return Ok(figures.into()) };
    let elf = firmware::build_program(BOARD, &worst.program)?.elf;
    let mut measured = budget::inspect(&budget, &pil::build(BOARD, &GearFile::default_gear())?.elf)?;
    worst.measure(&elf, &mut measured)?;
    for (name, block) in [
        ("hysteresis.cycles.forward", "hysteresis_forward"),
        ("hysteresis.cycles.inverse", "hysteresis_inverse"),
    ] {
        let worst_case = worst.worst_case(&elf, block)?.map_or(f64::NAN, |cycles| cycles as f64);
        let counted = measured
            .counts_of(block)
            .and_then(|counts| counts.cycles)
            .map_or(f64::NAN, |cycles| cycles.max as f64);
        figures.push(bounds::figure(name, worst_case));
        figures.push(Figure::reported(format!("{name}.counted"), counted, "cycle"));
    }
    Ok(figures.into())
}

/// The control step of a wrist on the target, belt and gear: cycles of the most costly one in S1 to S6 and on any input, and steps unlike the
/// host's.
///
/// # Errors
/// When the image cannot be built, booted or counted.
pub fn wrist(mut progress: impl FnMut(f64)) -> Result<Measured, Error> {
    let file = GearFile::wrist();
    let image = pil::build(BOARD, &file)?.elf;
    let mut budget = Budget::read(BOARD)?;
    budget.blocks.clear();
    let mut agreement = Agreement::default();
    let measured = budget::measure(&budget, &image, |arguments| {
        agreement = workload(&file, &image, arguments, |fraction| progress(0.5 * fraction))?;
        Ok(None)
    })?;
    let cycles = measured.counts_of(CONTROL_STEP).and_then(|counts| Some(counts.cycles?.max));
    let found = any_input::search(&image, &file, |fraction| progress(0.5 + 0.5 * fraction))?;
    Ok(vec![
        bounds::figure("belt.wrist.target.cycles", cycles.map_or(f64::NAN, |cycles| cycles as f64)),
        bounds::figure("belt.wrist.target.any_input.cycles", found.worst.cycles as f64),
        agreement.figure("pil.wrist.steps_unlike_host"),
        bounds::figure_as(
            "pil.wrist.any_input.steps_unlike_host",
            "pil.steps_unlike_host",
            found.unlike_host as f64,
        ),
        Figure::reported("pil.wrist.steps", (agreement.steps + found.steps) as f64, "1"),
    ]
    .into())
}

/// Torque by four strain gauges in S8 on the target: error, steps unlike the host's, and cycles.
///
/// # Errors
/// When the plant cannot be run or the image cannot be built, booted or judged.
pub fn gauges() -> Result<Measured, Error> {
    let budget = Budget::read(BOARD)?;
    let Some(row) = &budget.torque_gauges else { return Ok(Measured::default()) };
    let mut measured = budget::inspect(&budget, &pil::build(BOARD, &GearFile::default_gear())?.elf)?;
    let elf = firmware::build_program(BOARD, &row.program)?.elf;
    let record = Record::of(&GearFile::default_gear()).map_err(target::Error::from)?;
    let mut run = None;
    row.measure(&elf, &mut measured, |arguments| {
        run = Some(gauges::run(&elf, arguments, &record, verify::gauges::FIRST)?);
        Ok(())
    })?;
    let cycles = measured.counts_of(TORQUE_GAUGES).and_then(|counts| counts.cycles);
    let mut figures =
        vec![bounds::figure("gauges.target.cycles", cycles.map_or(f64::NAN, |cycles| cycles.max as f64))];
    figures.extend(
        row.step
            .worst_case(&Image::read(&elf).map_err(budget::Error::from)?)?
            .map(|cycles| Figure::reported("gauges.target.any_path.cycles", cycles as f64, "cycle")),
    );
    figures.extend(run.into_iter().flat_map(|run| {
        [
            bounds::figure_as("gauges.target.s8.error", "gauges.s8.error", run.errors.error),
            Figure::reported("gauges.target.steps", run.agreement.steps as f64, "1"),
            run.agreement.figure("gauges.target.steps_unlike_host"),
        ]
    }));
    Ok(figures.into())
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

/// All scenarios on the target.
fn scenarios(
    gear: &GearFile,
    elf: &Path,
    arguments: &[String],
    mut progress: impl FnMut(f64),
) -> Result<Vec<(Scenario, TargetRun)>, Error> {
    let mut runs = Vec::new();
    for (done, scenario) in Scenario::ALL.into_iter().enumerate() {
        let part = |fraction: f64| progress((done as f64 + fraction) / Scenario::ALL.len() as f64);
        let trial = Trial::from_rest(gear, scenario, SEED);
        runs.push((scenario, pil::compensated(elf, arguments, gear, &trial, part)?));
    }
    Ok(runs)
}

/// Target against host in all scenarios, on the condensed plant.
fn workload(
    gear: &GearFile,
    elf: &Path,
    arguments: &[String],
    mut progress: impl FnMut(f64),
) -> Result<Agreement, Error> {
    let conditions = Conditions::of(gear, SEED);
    let mut agreement = Agreement::default();
    for (done, scenario) in Scenario::ALL.into_iter().enumerate() {
        let part = |fraction: f64| progress((done as f64 + fraction) / Scenario::ALL.len() as f64);
        agreement = agreement.and(pil::workload(elf, arguments, gear, (scenario, &conditions), part)?.0);
    }
    Ok(agreement)
}

/// Steps unlike the host's in S1-S6 on every emulated board; those on [`BOARD`] are in `runs`, the others' are on the condensed plant.
fn every_board(runs: &[(Scenario, TargetRun)]) -> Result<Vec<Figure>, Error> {
    let first = runs.iter().fold(Agreement::default(), |all, (_, run)| all.and(run.agreement));
    let mut agreements = vec![(BOARD.to_owned(), first)];
    let others: Vec<_> = budget::emulated_boards()?.into_iter().filter(|board| board != BOARD).collect();
    let gear = GearFile::default_gear();
    // Built one by one, as cargo would anyway; run side by side, each on a processor of its own.
    let images = others.iter().map(|board| Ok((board, pil::build(board, &gear)?.elf)));
    let images = images.collect::<Result<Vec<_>, firmware::Error>>()?;
    std::thread::scope(|scope| {
        let run = |elf| workload(&gear, elf, &[], |_| ());
        let started: Vec<_> =
            images.iter().map(|(board, elf)| (board, scope.spawn(move || run(elf)))).collect();
        for (board, thread) in started {
            let agreed: Result<_, Error> = thread.join().unwrap_or_else(|panic| resume_unwind(panic));
            agreements.push(((*board).clone(), agreed?));
        }
        Ok::<_, Error>(())
    })?;
    let figure = |(board, agreement): &(String, Agreement)| {
        [
            Figure::reported(format!("pil.{board}.steps"), agreement.steps as f64, "1"),
            agreement.figure(format!("pil.{board}.steps_unlike_host")),
        ]
    };
    Ok(agreements.iter().flat_map(figure).collect())
}

/// Figures of the control step in the runs; S2 against its baselines.
fn control_step(runs: &[(Scenario, TargetRun)]) -> Result<Vec<Figure>, Error> {
    let mut figures = Vec::new();
    for (scenario, TargetRun { run, agreement, .. }) in runs {
        let name = |rest: &str| format!("pil.{}.{rest}", scenario.name());
        if *scenario == Scenario::S2 {
            let [b0, b1] = baselines(*scenario)?;
            let trial = Trial::from_rest(&GearFile::default_gear(), *scenario, SEED);
            figures.push(pil::beside_baselines(&trial, run, [&b0, &b1]));
        }
        figures.push(agreement.figure(name("steps_unlike_host")));
        figures.push(bounds::figure_as(name("power_balance"), "plant.power_balance", run.imbalance));
    }
    Ok(figures)
}

/// B0 and B1.
fn baselines(scenario: Scenario) -> Result<[Run; 2], target::Error> {
    let gear = GearFile::default_gear();
    let run = |mut baseline| closed_loop::run(&gear, scenario, SEED, &mut baseline, |_| ());
    Ok([run(Baseline::b0(&gear)?)?, run(Baseline::b1(&gear)?)?])
}

/// The size 17 gear's catalogue line, unfitted, against the measured output encoder.
fn replay(log: &MeasuredLog) -> Result<Vec<Figure>, Error> {
    let gear = GearFile::parse("gears/lara8-j5.toml".as_ref(), gear_file::LARA8_J5.as_bytes())?;
    let elf = pil::build(BOARD, &gear)?.elf;
    let replay = pil::replay(&elf, &gear, log, None, |_| ())?;
    Ok(vec![
        bounds::figure("pil.replay.size_17.rms", replay.judgement.rms),
        Figure::reported("pil.replay.size_17.rigid.rms", replay.judgement.rigid_rms, "rad"),
        replay.agreement.figure("pil.replay.size_17.steps_unlike_host"),
    ])
}
