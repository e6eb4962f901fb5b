//! `verify`: every claimed figure, measured here and now.

use std::panic::resume_unwind;
use std::path::PathBuf;
use std::thread::{self, ScopedJoinHandle};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, value_parser};
use strainwave::Error;
use strainwave_desktop::catalogue::Set;
use strainwave_desktop::design::tuned;
use strainwave_desktop::plant::unknowns::Which;
use strainwave_desktop::verify::bounds;
use strainwave_desktop::verify::faults;
use strainwave_desktop::verify::robustness::Robustness;
use strainwave_desktop::verify::{self, Measured};
use strainwave_desktop::verify::{
    belt, catalogue, compensator, constants, healthy, identify, replay, robot, robustness, stored_map,
};
use strainwave_desktop::{BadInput, Figure, GearFile};
use strainwave_emulator::rerun;
use strainwave_emulator::verify::{self as emulated, Parts};

use crate::figures::{Figures, FiguresArguments, columns, say, table as figures_table};
use crate::files;
use crate::page::PageArguments;
use crate::progress::Progress;

/// The part that is measured in the emulator alone.
const FIRMWARE: &str = "firmware";
/// The part that is measured only when it is named: it takes longer than all others.
const ROBUSTNESS: &str = "robustness";
/// The part that runs joints all over the catalogue, by itself too.
const CATALOGUE: &str = "catalogue";
/// The part that lets healthy joints work for ten hours, by itself too.
const HEALTHY: &str = "healthy";
/// The part that halves and doubles every tuned constant, by itself too.
const CONSTANTS: &str = "constants";
/// The part that identifies measured joints and predicts what did not train, by itself too: it misses bounds.
const IDENTIFY: &str = "identify";
/// The part that injects faults, by itself too.
const FAULTS: &str = "faults";
/// The part that lets robots of two joints draw, by itself too.
const ROBOT: &str = "robot";

/// Measure every accuracy and cost figure that the project claims, with its bound
///
/// For a bound that is the reached value instead of the target, a line above the table names the missed target.
///
/// The parts `firmware` and `flexspline` boot the image in the emulator and run S1-S6, both together once; that takes
/// some minutes, beside all that runs without the emulator; `hysteresis` and `gauges` boot an image of their own. `firmware`
/// executes the images of the real boards too, on emulated chips, and lets the other emulated boards follow the host's build through S1-S6
/// on the condensed plant. Every figure repeats exactly; times by the clock are `bench`'s. The
/// parts `robustness`, `catalogue`, `healthy`, `identify`, `constants` and `robot` are measured only when they are named.
#[derive(Args)]
pub struct Arguments {
    /// Only this part; every part when left out
    #[arg(value_name = "PART", value_parser = part_parser())]
    part: Option<String>,
    /// Plant samples on which the compensator is compared with the baselines; the bounds are for 20
    #[arg(long, alias = "draws", value_name = "COUNT", default_value_t = compensator::SAMPLES, value_parser = value_parser!(u64).range(1..=100_000))]
    samples: u64,
    /// Plant samples with doubled sensor noise on which it must be stable and no worse than the cascade; when left out all 1000 of the box, or
    /// the first 100 where every part is measured
    #[arg(long = "box", value_name = "COUNT", value_parser = value_parser!(u64).range(0..=100_000))]
    box_samples: Option<u64>,
    /// Of `robustness`, only this unknown, such as drive.delay; may be given several times. Of `catalogue` and `healthy`, by what the joints'
    /// plants differ from their gear files; box when left out
    #[arg(long = "row", value_name = "NAME", value_parser = row_parser())]
    rows: Vec<String>,
    /// Of `robustness`, plants of each row (6 when left out, 60 of `all`); of `catalogue` and `healthy`, joints (all 500); of
    /// `constants`, training joints (24, half of them with an output encoder); of `robot`, robots (20); of `identify`, synthetic joints (100)
    #[arg(long, value_name = "COUNT", value_parser = value_parser!(u64).range(1..=100_000))]
    seeds: Option<u64>,
    /// The first plant of `robustness`, robot of `robot` or joint of `catalogue` or `healthy`; 1 to 999 are for choosing gains, from 10000 on for claims.
    /// Of `identify` the first synthetic joint (0); 1000 to 1999 are for choosing its methods, all others for claims
    #[arg(long, value_name = "SEED", value_parser = value_parser!(u64).range(0..=1_000_000_000))]
    first: Option<u64>,
    /// Of `catalogue` and `healthy`, the joints for choosing gains
    #[arg(long)]
    training: bool,
    /// Of `catalogue` and `healthy`, how many joints are named, the worst first
    #[arg(long, value_name = "COUNT", default_value_t = 10)]
    named: usize,
    /// Of `constants`, only this tuned constant, such as FADING_TIME; may be given several times
    ///
    /// Each is halved and doubled, and the default gear with either set of sensors and the training joints run S1-S5 with it. All of them
    /// take 15 minutes of one processor, half of that on two.
    #[arg(long = "constant", value_name = "NAME", value_parser = constant_parser(), hide_possible_values = true)]
    constants: Vec<String>,
    /// Noises on each plant: of `robustness` 1 when left out, of `compensator` 4, with the stored kinematic error told, learnt and
    /// absent 2
    #[arg(long, value_name = "COUNT", value_parser = value_parser!(u32).range(1..=1000))]
    noises: Option<u32>,
    /// Of `robustness`, the joint; the default gear when left out
    #[arg(long, value_name = "GEAR.toml")]
    gear: Option<PathBuf>,
    /// Of `robustness`, plants with the reference mesh: minutes for each
    #[arg(long)]
    reference: bool,
    /// Of `robustness` and `compensator`, run the COUNT worst plants of each claim again: on the reference mesh, with the firmware image in the
    /// emulator in the place of the host's build
    ///
    /// Every rival runs there too, all of them as in the rows: 10 s of work, the scenario, a rest. Of one plant of a row that
    /// is 24 runs, 11 minutes on two processors that others used too. Of `compensator` B0 and B1 run the scenario from rest, as in
    /// its table, and what misses a claim's bound there is missed.
    #[arg(long, value_name = "COUNT", default_value_t = 0, conflicts_with = "reference", value_parser = value_parser!(u64).range(0..=1000))]
    again: u64,
    /// Of `identify`, others on the same splits too, in Python with scipy from PyPI: what is worse than they misses its bound
    #[arg(long)]
    rivals: bool,
    #[command(flatten)]
    page: PageArguments,
    #[command(flatten)]
    figures: FiguresArguments,
}

impl Arguments {
    /// Plant samples of the box.
    fn box_samples(&self) -> u64 {
        let usual =
            if self.part.is_some() { compensator::BOX_SAMPLES } else { compensator::FIRST_BOX_SAMPLES };
        self.box_samples.unwrap_or(usual)
    }
}

fn row_parser() -> impl TypedValueParser<Value = String> {
    let rows = Which::every().map(|row| PossibleValue::new(row.name()).help(row.what()));
    PossibleValuesParser::new(rows).map(String::from)
}

fn constant_parser() -> impl TypedValueParser<Value = String> {
    let constants = tuned::every().map(|constant| PossibleValue::new(constant.name).help(constant.why));
    PossibleValuesParser::new(constants).map(String::from)
}

fn part_parser() -> impl TypedValueParser<Value = String> {
    let names = verify::Part::ALL.map(verify::Part::name);
    PossibleValuesParser::new(
        names
            .into_iter()
            .chain([FIRMWARE, ROBUSTNESS, CATALOGUE, HEALTHY, IDENTIFY, FAULTS, CONSTANTS, ROBOT]),
    )
    .map(String::from)
}

/// Measures the requested parts, and renews the page of figures.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let (json, page) = (arguments.figures.json.as_deref(), arguments.page.markdown.as_deref());
    files::require_distinct(&[
        ("--gear", arguments.gear.as_deref()),
        ("--markdown", page),
        ("--json", json),
    ])?;
    files::require_writable(json)?;
    arguments.page.require_renewable()?;
    let figures = measure(arguments)?;
    arguments.page.renew(figures.measured())?;
    Ok(figures)
}

fn measure(arguments: &Arguments) -> Result<Figures, BadInput> {
    if arguments.part.as_deref() == Some(ROBUSTNESS) {
        return against_unknowns(arguments);
    }
    if arguments.part.as_deref() == Some(CATALOGUE) {
        return across_the_catalogue(arguments);
    }
    if arguments.part.as_deref() == Some(HEALTHY) {
        return at_work(arguments);
    }
    if arguments.part.as_deref() == Some(IDENTIFY) {
        return identified(arguments);
    }
    if arguments.part.as_deref() == Some(ROBOT) {
        return robots(arguments);
    }
    if arguments.part.as_deref() == Some(CONSTANTS) {
        return with_scaled_constants(arguments);
    }
    if arguments.part.as_deref() == Some(FAULTS) {
        return crate::faults::inject(arguments.gear.as_deref(), 0, faults::COUNT, &arguments.figures);
    }
    Ok(told(measure_parts(arguments)?, arguments))
}

/// The figures, below their notes and the targets that they miss.
fn told(measured: Measured, arguments: &Arguments) -> Figures {
    let missed = measured.figures.iter().filter_map(bounds::misses_target);
    for note in measured.notes.iter().cloned().chain(missed) {
        say(format_args!("{note}"));
    }
    Figures::new(measured.figures, &arguments.figures)
}

/// The requested parts on the desktop, and beside them, on threads of their own, what runs in the emulator: the wrist, and all else.
fn measure_parts(arguments: &Arguments) -> Result<Measured, BadInput> {
    let is_requested = |name: &str| arguments.part.as_ref().is_none_or(|part| part == name);
    let parts: Vec<_> = verify::Part::ALL.into_iter().filter(|part| is_requested(part.name())).collect();
    let firmware = is_requested(FIRMWARE);
    let (measured, emulated) = thread::scope(|scope| {
        let emulated =
            [scope.spawn(|| in_the_emulator(&parts, firmware)), scope.spawn(|| wrist_on_the_target(&parts))];
        (on_the_desktop(arguments, &parts), emulated.map(ScopedJoinHandle::join))
    });
    let mut measured = measured?;
    for emulated in emulated {
        measured.add(emulated.unwrap_or_else(|panic| resume_unwind(panic))?);
    }
    Ok(measured)
}

fn on_the_desktop(arguments: &Arguments, parts: &[verify::Part]) -> Result<Measured, BadInput> {
    let mut measured = Measured::default();
    let mut progress = Progress::new(parts.len() as u64, "measuring");
    for (done, part) in parts.iter().enumerate() {
        progress.set(done as u64);
        measured.add(part.measure()?);
    }
    drop(progress);
    if parts.contains(&verify::Part::Belt) {
        measured.add(wrist()?);
    }
    if parts.contains(&verify::Part::Compensator) {
        measured.add(replay::measure()?);
        measured.add(against_baselines(arguments)?);
        measured.add(with_the_map(arguments)?);
    }
    Ok(measured)
}

/// What of the parts, and of the whole control step with `firmware`, runs in the emulator.
fn in_the_emulator(parts: &[verify::Part], firmware: bool) -> Result<Measured, BadInput> {
    let mut measured = Measured::default();
    if parts.contains(&verify::Part::Friction) {
        measured.add(emulated::friction().map_err(BadInput::message)?);
    }
    if parts.contains(&verify::Part::Hysteresis) {
        measured.add(emulated::hysteresis().map_err(BadInput::message)?);
    }
    if parts.contains(&verify::Part::Gauges) {
        measured.add(emulated::gauges().map_err(BadInput::message)?);
    }
    if let Some(parts) = emulated_parts(firmware, parts.contains(&verify::Part::Flexspline)) {
        measured.add(measure_emulated(parts)?);
    }
    Ok(measured)
}

/// The wrist against the baselines.
fn wrist() -> Result<Measured, BadInput> {
    let mut progress = Progress::new(1000, "wrist");
    let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
    belt::wrist::measure(fraction).map_err(BadInput::message)
}

fn wrist_on_the_target(parts: &[verify::Part]) -> Result<Measured, BadInput> {
    if !parts.contains(&verify::Part::Belt) {
        return Ok(Measured::default());
    }
    let mut progress = Progress::new(1000, "wrist on the target");
    let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
    emulated::wrist(fraction).map_err(BadInput::message)
}

fn against_baselines(arguments: &Arguments) -> Result<Measured, BadInput> {
    let mut progress = Progress::new(1000, "compensator and baselines");
    let gear = GearFile::default_gear();
    let request = compensator::Request {
        samples: arguments.samples,
        noises: arguments.noises.unwrap_or(compensator::NOISES),
        box_samples: arguments.box_samples(),
    };
    let judgement =
        compensator::against_baselines(&gear, &request, |fraction| progress.set((fraction * 1e3) as u64));
    drop(progress);
    let judgement = judgement.map_err(BadInput::message)?;
    let samples =
        compensator::worst_samples(&judgement.samples, gear.gear.rated_torque, arguments.again as usize);
    let mut figures = judgement.figures;
    if !samples.is_empty() {
        let mut progress = Progress::new(1000, "reference mesh and firmware");
        let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
        let again = rerun::claims::measure(emulated::BOARD, &gear, &samples, fraction);
        drop(progress);
        figures.extend(again.map_err(BadInput::message)?);
    }
    Ok(figures.into())
}

/// The claims with the stored kinematic error told, learnt and absent.
fn with_the_map(arguments: &Arguments) -> Result<Measured, BadInput> {
    let mut progress = Progress::new(1000, "stored kinematic error");
    let noises = arguments.noises.unwrap_or(stored_map::NOISES);
    let figures = stored_map::measure(&GearFile::default_gear(), arguments.samples, noises, |fraction| {
        progress.set((fraction * 1e3) as u64)
    });
    drop(progress);
    Ok(figures.map_err(BadInput::message)?.into())
}

/// On plants that the controllers do not know; its table is one line a row.
fn against_unknowns(arguments: &Arguments) -> Result<Figures, BadInput> {
    let request = robustness::Request {
        rows: requested_unknowns(arguments, || Which::every().collect()),
        first: arguments.first.unwrap_or(robustness::FIRST),
        seeds: arguments.seeds,
        noises: arguments.noises.unwrap_or(1),
        reference: arguments.reference,
    };
    let mut progress = Progress::new(1000, "judged plants");
    let gear = arguments.gear.as_deref().map_or_else(|| Ok(GearFile::default_gear()), GearFile::read)?;
    let measured = robustness::measure(&gear, &request, |fraction| {
        progress.set((fraction * 1e3) as u64);
    });
    drop(progress);
    let found = measured.map_err(BadInput::message)?;
    say(format_args!("{}", columns(&found.table())));
    let measured = found.measured();
    for note in &measured.notes {
        say(format_args!("{note}"));
    }
    let rerun = if arguments.again > 0 { again(arguments, &gear, &found)? } else { Vec::new() };
    Ok(Figures::silent([measured.figures, rerun].concat(), &arguments.figures))
}

/// The worst plants again, on the reference mesh with the firmware; a line each claim and plant.
fn again(arguments: &Arguments, gear: &GearFile, found: &Robustness) -> Result<Vec<Figure>, BadInput> {
    let worst = found.worst_runs(arguments.again as usize);
    let mut progress = Progress::new(1000, "reference mesh and firmware");
    let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
    let figures = rerun::measure(emulated::BOARD, gear, &worst, fraction).map_err(BadInput::message)?;
    drop(progress);
    say(format_args!("\n{}", figures_table(&figures)));
    Ok(figures)
}

/// On joints of the catalogue; its table is one line a scenario.
fn across_the_catalogue(arguments: &Arguments) -> Result<Figures, BadInput> {
    for_each_unknown(arguments, |request| {
        let mut progress = Progress::new(1000, "joints of the catalogue");
        let measured = catalogue::measure(request, |fraction| progress.set((fraction * 1e3) as u64));
        drop(progress);
        let found = measured?;
        say(format_args!("{}", columns(&found.table())));
        Ok(found.measured(arguments.named))
    })
}

/// Healthy joints of the catalogue at work, ten hours in all.
fn at_work(arguments: &Arguments) -> Result<Figures, BadInput> {
    for_each_unknown(arguments, |request| {
        let mut progress = Progress::new(1000, "joints at work");
        let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
        Ok(healthy::measure(request, healthy::DURATION, fraction)?.measured(arguments.named))
    })
}

/// Measures the requested joints on plants of each requested unknown.
fn for_each_unknown(
    arguments: &Arguments,
    measure: impl Fn(&catalogue::Request) -> Result<Measured, Error>,
) -> Result<Figures, BadInput> {
    let mut figures = Vec::new();
    for unknown in requested_unknowns(arguments, || vec![Which::BOX]) {
        let measured = measure(&requested_joints(arguments, unknown)?).map_err(BadInput::message)?;
        for note in &measured.notes {
            say(format_args!("{note}"));
        }
        figures.extend(measured.figures);
    }
    Ok(Figures::new(figures, &arguments.figures))
}

/// The unknowns that are named, or others where none is.
fn requested_unknowns(arguments: &Arguments, others: impl Fn() -> Vec<Which>) -> Vec<Which> {
    match arguments.rows.as_slice() {
        [] => others(),
        names => names.iter().filter_map(|name| Which::named(name)).collect(),
    }
}

/// The joints of the catalogue that are asked for.
fn requested_joints(arguments: &Arguments, unknown: Which) -> Result<catalogue::Request, BadInput> {
    let set = if arguments.training { Set::Training } else { Set::Judged };
    let first = arguments.first.unwrap_or(set.first());
    let count = arguments.seeds.unwrap_or(set.seeds().end.saturating_sub(first));
    if !set.seeds().contains(&first) || first + count > set.seeds().end {
        let all = set.seeds();
        return Err(BadInput::message(format!(
            "--first {first} --seeds {count}: no such joints; allowed: within {}..{}",
            all.start,
            all.end - 1
        )));
    }
    Ok(catalogue::Request { set, first, count, unknown })
}

/// Robots of two joints that draw a circle, and the rigid arm.
fn robots(arguments: &Arguments) -> Result<Figures, BadInput> {
    let (first, count) = (arguments.first.unwrap_or(robot::FIRST), arguments.seeds.unwrap_or(robot::ROBOTS));
    let mut progress = Progress::new(1000, "robots");
    let measured = robot::measure(first, count, |fraction| progress.set((fraction * 1e3) as u64))?;
    drop(progress);
    Ok(told(measured, arguments))
}

/// With every tuned constant halved and doubled; its table is one line a constant.
fn with_scaled_constants(arguments: &Arguments) -> Result<Figures, BadInput> {
    let is_named = |name: &str| arguments.constants.iter().any(|named| named == name);
    let all = arguments.constants.is_empty();
    let requested: Vec<_> = tuned::every().filter(|constant| all || is_named(constant.name)).collect();
    let seeds = arguments.seeds.unwrap_or(constants::SEEDS);
    if seeds > constants::MOST_SEEDS {
        let most = constants::MOST_SEEDS;
        return Err(BadInput::message(format!(
            "--seeds {seeds}: no such training joints; allowed: 1..{most}"
        )));
    }
    let mut progress = Progress::new(1000, "tuned constants");
    let measured = constants::measure(&requested, seeds, |fraction| progress.set((fraction * 1e3) as u64));
    drop(progress);
    let found = measured.map_err(BadInput::message)?;
    say(format_args!("{}", columns(&found.table())));
    let Measured { figures, notes } = found.measured(all);
    let bounded: Vec<_> = figures.iter().filter(|figure| figure.bound.is_some()).cloned().collect();
    for note in notes.iter().cloned().chain(bounded.iter().filter_map(bounds::misses_target)) {
        say(format_args!("{note}"));
    }
    say(format_args!("\n{}", figures_table(&bounded)));
    Ok(Figures::silent(figures, &arguments.figures))
}

/// On measured joints; what is not judged is noted above the table.
fn identified(arguments: &Arguments) -> Result<Figures, BadInput> {
    let mut progress = Progress::new(1000, "identifying joints");
    let first = arguments.first.unwrap_or_default();
    let joints = first..first + arguments.seeds.unwrap_or(identify::friction::JOINTS);
    let measured =
        identify::measure(arguments.rivals, joints, |fraction| progress.set((fraction * 1e3) as u64))?;
    drop(progress);
    for note in &measured.notes {
        say(format_args!("{note}"));
    }
    Ok(Figures::new(measured.figures, &arguments.figures))
}

fn emulated_parts(firmware: bool, flexspline: bool) -> Option<Parts> {
    match (firmware, flexspline) {
        (true, true) => Some(Parts::Both),
        (true, false) => Some(Parts::Firmware),
        (false, true) => Some(Parts::Flexspline),
        (false, false) => None,
    }
}

fn measure_emulated(parts: Parts) -> Result<Measured, BadInput> {
    let mut progress = Progress::new(1000, "emulator");
    emulated::measure(parts, |fraction| progress.set((fraction * 1e3) as u64)).map_err(BadInput::message)
}
