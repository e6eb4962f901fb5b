//! `budget`: what the control step costs on the target, against the boards' budget files.

use std::panic::resume_unwind;
use std::path::Path;
use std::thread;

use clap::Args;
use strainwave_desktop::bench::Conditions;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::torque_sensing::Record;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::verify;
use strainwave_desktop::verify::compensator::each;
use strainwave_desktop::{BadInput, Figure, GearFile};
use strainwave_emulator::any_input::{self, AnyInput};
use strainwave_emulator::artifact::Image;
use strainwave_emulator::budget::{self, Budget, Measurement};
use strainwave_emulator::pil;
use strainwave_emulator::{firmware, gauges as emulated_gauges};

use strainwave_emulator::firmware::Program;

use crate::figures::{Figures, FiguresArguments, say};
use crate::files;
use crate::progress::Progress;

/// Plant of the scenarios.
const SEED: u64 = 1;

/// Count instructions and cycles of the control step and of each block in it; flash, RAM and stack
///
/// Runs the firmware through S1-S6 on the condensed plant in the emulator, with the motor's sensors and with both encoders, and a plugin
/// that counts; the host's build closes the loop, and the firmware takes the same steps. Instructions are exact; cycles
/// are a model of a Cortex-M4F with zero wait states, at the pessimistic end, not silicon; on another core there are
/// none, and the runs are those with both encoders alone. Proves on the linked image that no panic and no allocator is in
/// it and that the control step reaches no double-precision routine. Counts the literal mesh of eq. (6), 8 x 3 in f32,
/// in an image of its own beside the reduced flexspline of the control step,
/// hysteresis along the histories that cost most, and four strain gauges in S8; tells one call of each elementary
/// function, ours, micromath's and libm's, beside each other: cycles, bytes and largest error. Then some hundred sequences
/// of any input bits and of disturbed motions, varied where they cost most, look for the most costly control step of all,
/// beside the host's build; that takes some minutes. Boards are judged side by side, as many as there are processors. The column
/// `any path` is the most of any path through the code, where the code shows a bound. Of a real board's image that serves the tuning link,
/// flash, RAM, stack and the proofs are judged, too.
/// Bounds are those of boards/BOARD/budget.toml.
#[derive(Args)]
pub struct Arguments {
    /// Only this board; every board when left out
    #[arg(long, value_name = "BOARD")]
    board: Option<String>,
    /// Write what was measured, plus the headroom, as the new bounds
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Builds, counts and judges.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    files::require_writable(arguments.figures.json.as_deref())?;
    let boards = match &arguments.board {
        Some(board) => vec![board.clone()],
        None => firmware::boards().map_err(BadInput::message)?,
    };
    let judged = each(&boards, |board| judge(board, arguments.overwrite), &mut |_| ());
    let mut figures = Vec::new();
    for judged in judged {
        let (table, judged) = judged?;
        say(format_args!("{table}"));
        figures.extend(judged);
    }
    Ok(Figures::silent(figures, &arguments.figures))
}

/// Table and figures of a board.
fn judge(board: &str, overwrite: bool) -> Result<(String, Vec<Figure>), BadInput> {
    let gear = GearFile::default_gear();
    let firmware = pil::build(board, &gear).map_err(BadInput::message)?;
    let mut budget = Budget::read(board).map_err(BadInput::message)?;
    let (measured, found) = thread::scope(|scope| {
        let found = scope.spawn(|| search(&budget, &firmware.elf, &gear));
        (count(&budget, &firmware.elf, &gear), found.join())
    });
    let mut measured = measured?;
    measured.any_input = found.unwrap_or_else(|panic| resume_unwind(panic))?;
    let others = others(&budget, &gear)?;
    if overwrite {
        budget.overwrite(&measured).map_err(BadInput::message)?;
        for (budget, measured) in &others {
            budget.overwrite(measured).map_err(BadInput::message)?;
        }
        budget = Budget::read(board).map_err(BadInput::message)?;
    }
    let (mut table, mut figures) = (measured.table(&budget), measured.figures(&budget));
    for (other, measured) in others {
        let Some(budget) = budget.of(other.program()) else { continue };
        let which = match other.program() {
            Program::Control | Program::Served => "with its tuning link",
            Program::Commanded { .. } => "on CAN",
            Program::BeforeOdrive { .. } => "on CAN, its drive on a second bus",
        };
        table = format!("{table}\n{which}: {}", measured.table(&budget));
        figures.extend(measured.figures(&budget));
    }
    Ok((table, figures))
}

/// What the images of the other programs cost that the board is flashed with, each with its budget.
fn others(budget: &Budget, gear: &GearFile) -> Result<Vec<(Budget, Measurement)>, BadInput> {
    let programs = [Program::Served, Program::COMMANDED, Program::BEFORE_ODRIVE];
    let budgets = programs.into_iter().filter_map(|program| budget.of(program));
    let judged = budgets.map(|budget| {
        let elf = pil::build_as(budget.program(), &budget.board, gear).map_err(BadInput::message)?.elf;
        let measured = budget::inspect(&budget, &elf).map_err(BadInput::message)?;
        Ok((budget, measured))
    });
    judged.collect()
}

/// The most costly control step of all; it takes as long as all else of a board together.
fn search(budget: &Budget, elf: &Path, gear: &GearFile) -> Result<Option<AnyInput>, BadInput> {
    if budget.any_input.is_none() || !budget.emulated {
        return Ok(None);
    }
    let mut progress = Progress::new(1000, "any input");
    let found = any_input::search(elf, gear, |fraction| progress.set((fraction * 1e3) as u64));
    found.map(Some).map_err(BadInput::message)
}

/// All else: the scenarios, and what has images of its own.
fn count(budget: &Budget, elf: &Path, gear: &GearFile) -> Result<Measurement, BadInput> {
    let board = &budget.board;
    let mut measured = in_the_scenarios(budget, elf, gear)?;
    if !budget.emulated {
        return Ok(measured);
    }
    if let Some(mesh) = &budget.literal_mesh {
        let program = firmware::build_program(board, &mesh.program).map_err(BadInput::message)?;
        mesh.measure(&program.elf, &mut measured).map_err(BadInput::message)?;
    }
    if let Some(worst) = &budget.worst_case {
        let program = firmware::build_program(board, &worst.program).map_err(BadInput::message)?;
        worst.measure(&program.elf, &mut measured).map_err(BadInput::message)?;
    }
    if let Some(gauges) = &budget.torque_gauges {
        let program = firmware::build_program(board, &gauges.program).map_err(BadInput::message)?;
        let record = Record::of(gear).map_err(BadInput::message)?;
        let seed = verify::gauges::FIRST;
        gauges
            .measure(&program.elf, &mut measured, |arguments| {
                emulated_gauges::run(&program.elf, arguments, &record, seed)?;
                Ok(())
            })
            .map_err(BadInput::message)?;
    }
    if let Some(functions) = &budget.elementary_functions {
        let program = firmware::build_program(board, &functions.program).map_err(BadInput::message)?;
        measured.elementary_functions = functions.measure(&program.elf).map_err(BadInput::message)?;
    }
    Ok(measured)
}

/// The image, and where it is emulated its costs over S1-S6.
fn in_the_scenarios(budget: &Budget, elf: &Path, gear: &GearFile) -> Result<Measurement, BadInput> {
    let image = Image::read(elf).map_err(BadInput::message)?;
    // What takes minutes is for the cycles' sake.
    let sensors: &[SensorSet] = if image.has_cycle_model() { &SensorSet::ALL } else { &[SensorSet::Both] };
    let run_all = |arguments: &[String]| {
        let mut deepest = None;
        let runs =
            sensors.iter().copied().flat_map(|sensors| Scenario::ALL.map(|scenario| (sensors, scenario)));
        for (sensors, scenario) in runs {
            let mut progress = Progress::new(1000, scenario.title());
            let conditions = Conditions { sensors, ..Conditions::of(gear, SEED) };
            let (_, ending) = pil::workload(elf, arguments, gear, (scenario, &conditions), |fraction| {
                progress.set((fraction * 1e3) as u64)
            })?;
            deepest = deepest.max(Some(ending.stack));
        }
        Ok(deepest)
    };
    budget::measure(budget, elf, run_all).map_err(BadInput::message)
}
