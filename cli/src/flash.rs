//! `flash`: brings a joint onto a board.

use std::path::{Path, PathBuf};

use clap::Args;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::{BadInput, Figure, GearFile};
use strainwave_emulator::budget::Budget;
use strainwave_emulator::firmware::Program;
use strainwave_emulator::flash::{self, Counted, DRIVE_DELAY, Judgement, WORKLOAD, Way};
use strainwave_emulator::{firmware, pil};

use crate::check;
use crate::figures::{Figures, FiguresArguments, complain, say, table};
use crate::files;
use crate::progress::Progress;

/// Bring a joint onto a board: check its gear file, build its firmware, judge it against the board's budget, flash it
///
/// Refuses a gear file as `check` does. Builds the board's image with the joint's constants and judges it, in seconds, by
/// boards/BOARD/budget.toml: flash, RAM, the deepest stack of any chain of calls, that no panic, no allocator and no double
/// precision is in it, and instructions and cycles of the control step with this gear in S1, S3 and S5. Of a board that the emulator
/// does not have, these are counted in the image of another one with the same core. Not judged are any other input,
/// for which there is `budget`, and wait states. A missed bound is named, nothing is flashed, and the exit code is 1.
/// With `--served` all of this is the image with the tuning link, which `connect` reaches, and a store in the chip's flash; with `--can` the one
/// of a node on CAN, with `--drive` too whose torque goes to a drive on a second CAN bus.
/// Then a real board's chip is flashed through its debug probe by probe-rs and started; an emulated board's image runs in
/// QEMU for a second of control, which must raise no fault.
#[derive(Args)]
pub struct Arguments {
    /// Gear file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    /// Which board; a folder of boards/
    #[arg(long, value_name = "BOARD")]
    board: String,
    /// Flash the program that serves the tuning link on the board's serial port, in the place of telemetry and keys; only a real board
    #[arg(long)]
    served: bool,
    /// Flash the program that a controller commands over CAN, as CiA 402 has it, in which the joint is this node, 1 to 127; only a board with CAN
    #[arg(long, value_name = "NODE", conflicts_with = "served", value_parser = clap::value_parser!(u8).range(1..=127))]
    can: Option<u8>,
    /// Send the torque to this drive on the board's second CAN bus, in the place of a voltage: an ODrive with this number there, 0 to 62. The gear
    /// file has to declare its delay, `drive.delay_periods` of at least 4
    #[arg(long, value_name = "odrive:NODE", requires = "can", value_parser = odrive)]
    drive: Option<u8>,
    /// Judge by this budget in the place of the board's own
    #[arg(long, value_name = "BUDGET.toml")]
    budget: Option<PathBuf>,
    /// Flash an image that misses a bound, too; the exit code stays 1
    #[arg(long)]
    force: bool,
    /// Build and judge, then print the commands that flash in the place of running them; needs neither probe nor probe-rs
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Checks, builds, judges and flashes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    let (gear, board) = (&arguments.gear, arguments.board.as_str());
    files::require_distinct(&[
        ("GEAR.toml", Some(gear)),
        ("--budget", arguments.budget.as_deref()),
        ("--json", json),
    ])?;
    let gear = checked(gear, arguments.drive.is_some())?;
    firmware::require_known(board).map_err(BadInput::message)?;
    let budget = match &arguments.budget {
        Some(file) => Budget::read_file(board, file),
        None => Budget::read(board),
    };
    let budget = image_budget(&budget.map_err(BadInput::message)?, arguments.program())?;
    let way = Way::of(&budget).map_err(BadInput::message)?;
    files::require_writable(json)?;
    let elf = build(arguments, &way, &gear)?;
    let judgement = judge(&budget, &elf, &gear)?;
    tell(&budget, &judgement);
    let mut figures = judgement.measured.figures(&budget);
    if put_on(arguments, &figures) {
        figures.extend(flash(arguments, &way, &elf, &gear)?);
    }
    Ok(Figures::silent(figures, &arguments.figures))
}

impl Arguments {
    /// What is flashed.
    fn program(&self) -> Program {
        match (self.can, self.drive) {
            (Some(node), Some(drive)) => Program::BeforeOdrive { node, drive },
            (Some(node), None) => Program::Commanded { node },
            (None, _) if self.served => Program::Served,
            (None, _) => Program::Control,
        }
    }
}

/// The budget of the image that is flashed.
fn image_budget(budget: &Budget, program: Program) -> Result<Budget, BadInput> {
    budget.of(program).ok_or_else(|| {
        let (option, without) = match program {
            Program::Commanded { .. } => ("--can", "as a node on CAN"),
            Program::BeforeOdrive { .. } => ("--drive", "with a drive on a second CAN bus"),
            Program::Control | Program::Served => ("--served", "with a tuning link"),
        };
        let board = &budget.board;
        let others = boards_with(program).join(", ");
        BadInput::message(format!(
            "{option}: {board} is not flashed {without}: no [{}image] in its budget, allowed: {others}",
            program.prefix()
        ))
    })
}

/// The boards that are flashed with a program.
fn boards_with(program: Program) -> Vec<String> {
    let boards = firmware::boards().unwrap_or_default().into_iter();
    boards.filter(|board| Budget::read(board).is_ok_and(|budget| budget.of(program).is_some())).collect()
}

/// The number of an ODrive.
fn odrive(text: &str) -> Result<u8, String> {
    let number = text.strip_prefix("odrive:").and_then(|number| number.parse().ok());
    number.filter(|number| *number <= 62).ok_or_else(|| "allowed: odrive:0 to odrive:62".to_owned())
}

/// A gear that the firmware can be built for; of another all faults are told. A drive behind CAN is late.
fn checked(path: &Path, behind_can: bool) -> Result<GearFile, BadInput> {
    let gear = check::faultless(path)?;
    buildable(&gear).map_err(|why| BadInput::new(path, why))?;
    let delay = gear.drive.delay;
    if behind_can && delay < DRIVE_DELAY {
        return Err(BadInput::new(
            path,
            format!("drive.delay_periods = {delay}, allowed with --drive: from {DRIVE_DELAY} to 20"),
        ));
    }
    Ok(gear)
}

/// The image; before minutes are spent on it, what flashes it is looked for.
fn build(arguments: &Arguments, way: &Way, gear: &GearFile) -> Result<PathBuf, BadInput> {
    let board = &arguments.board;
    let firmware = match way {
        Way::Emulator => pil::prepare(board, gear).map_err(BadInput::message)?,
        Way::Probe(probe) => {
            if !arguments.dry_run {
                probe.require_program().map_err(BadInput::message)?;
            }
            pil::build_as(arguments.program(), board, gear).map_err(BadInput::message)?
        }
    };
    Ok(firmware.elf)
}

fn judge(budget: &Budget, elf: &Path, gear: &GearFile) -> Result<Judgement, BadInput> {
    let mut progress = Progress::new(1000, "control step");
    flash::judge(budget, elf, gear, |fraction| progress.set((fraction * 1e3) as u64))
        .map_err(BadInput::message)
}

/// The costs, and what was and was not judged.
fn tell(budget: &Budget, judgement: &Judgement) {
    say(format_args!("{}", judgement.measured.table(budget).trim_end()));
    let image = "flash, RAM, stack, panics, allocators, double precision";
    let workload = WORKLOAD.map(Scenario::name).join(", ").to_uppercase();
    match &judgement.counted {
        Counted::On(board) => {
            say(format_args!("judged: {image}; the control step with this gear in {workload}, on {board}"));
            say(format_args!(
                "not judged: any other input (`strainwave budget`), wait states, the chip itself"
            ));
        }
        Counted::Not(why) => {
            say(format_args!("judged: {image}"));
            say(format_args!("not judged: the control step ({why}), wait states, the chip itself"));
        }
    }
}

/// Whether the image is put onto the board; a line for each bound that it misses.
fn put_on(arguments: &Arguments, figures: &[Figure]) -> bool {
    let missed: Vec<_> = figures.iter().filter(|figure| !figure.holds).collect();
    for figure in &missed {
        let [name, value, unit, bound, ..] = figure.cells();
        complain(format_args!("missed: {name} is {value} {unit}, bound {bound}"));
    }
    if !missed.is_empty() && !arguments.force {
        complain(format_args!("not flashed; --force flashes it nevertheless"));
    }
    missed.is_empty() || arguments.force
}

/// Flashes a real board, starts an emulated one; the figures of the latter's first second.
fn flash(arguments: &Arguments, way: &Way, elf: &Path, gear: &GearFile) -> Result<Vec<Figure>, BadInput> {
    for command in way.commands(elf).map_err(BadInput::message)? {
        let words: Vec<_> = command.iter().map(|word| quoted(word)).collect();
        say(format_args!("{}", words.join(" ")));
    }
    match way {
        _ if arguments.dry_run => Ok(Vec::new()),
        Way::Probe(probe) => {
            probe.flash(elf).map_err(BadInput::message)?;
            say(format_args!("{} is on {}, and started", gear.gear.name, probe.chip()));
            Ok(Vec::new())
        }
        Way::Emulator => {
            let figures =
                flash::control_for_a_second(&arguments.board, elf, gear).map_err(BadInput::message)?;
            say(format_args!("{} has started and controlled for 1 s\n{}", gear.gear.name, table(&figures)));
            Ok(figures)
        }
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
