//! The `strainwave` command, thin over the desktop and emulator libraries.
//!
//! Exit code 0 when every figure holds, 1 when one misses its bound, 2 when the command could not be
//! carried out: then one line on the error stream says why, and nothing has been written. 128 + the signal
//! when it was interrupted.

mod bench;
mod budget;
mod check;
mod connect;
mod design;
mod experiment;
mod export;
mod faults;
mod figures;
mod files;
mod flash;
mod identification_page;
mod identification_verdict;
mod identify;
mod logs;
mod new;
mod operator;
mod page;
mod payload;
mod pil;
mod pil_plots;
mod predict;
mod progress;
mod report;
mod robot;
mod robot_picture;
mod series;
mod setup;
mod sim;
mod tune;
mod usage;
mod verify;

use std::panic::{self, PanicHookInfo};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use strainwave_desktop::BadInput;
use strainwave_emulator::interrupt;

use crate::figures::{Figures, complain};

/// A figure misses its bound.
const MISSED: u8 = 1;
/// The command could not be carried out.
const REFUSED: u8 = 2;

/// Harmonic-drive torsion, friction and hysteresis: simulate, verify and measure.
///
/// Exit code: 0 every figure holds, 1 a figure misses its bound, 2 bad input.
#[derive(Parser)]
#[command(name = "strainwave", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Bench(bench::Arguments),
    Budget(budget::Arguments),
    Check(check::Arguments),
    Connect(connect::Arguments),
    Design(design::Arguments),
    Experiment(experiment::Arguments),
    Export(export::Arguments),
    Faults(faults::Arguments),
    Flash(flash::Arguments),
    Identify(identify::Arguments),
    New(new::Arguments),
    Pil(pil::Arguments),
    Predict(predict::Arguments),
    Report(report::Arguments),
    Robot(robot::Arguments),
    Setup(setup::Arguments),
    Sim(sim::Arguments),
    Tune(tune::Arguments),
    Verify(verify::Arguments),
}

fn run(command: Command) -> Result<Figures, BadInput> {
    match command {
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Budget(arguments) => budget::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Connect(arguments) => connect::run(&arguments),
        Command::Design(arguments) => design::run(&arguments),
        Command::Experiment(arguments) => experiment::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Faults(arguments) => faults::run(&arguments),
        Command::Flash(arguments) => flash::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Pil(arguments) => pil::run(&arguments),
        Command::Predict(arguments) => predict::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Robot(arguments) => robot::run(&arguments),
        Command::Setup(arguments) => setup::run(&arguments),
        Command::Sim(arguments) => sim::run(&arguments),
        Command::Tune(arguments) => tune::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
    }
}

fn main() -> ExitCode {
    panic::set_hook(Box::new(internal_error));
    interrupt::end_in_order();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage::answer(&error),
    };
    match panic::catch_unwind(|| run(cli.command).and_then(Figures::publish)) {
        Ok(Ok(true)) => ExitCode::SUCCESS,
        Ok(Ok(false)) => ExitCode::from(MISSED),
        Ok(Err(error)) => {
            interrupt::hold_if_ending();
            complain(format_args!("error: {error}"));
            ExitCode::from(REFUSED)
        }
        // The hook has said what and where.
        Err(_) => ExitCode::from(REFUSED),
    }
}

/// A mistake of ours: one line, whatever RUST_BACKTRACE says.
fn internal_error(panic: &PanicHookInfo) {
    let place = panic.location().map_or(String::new(), |at| format!(" ({}:{})", at.file(), at.line()));
    let payload = panic.payload();
    let literal = payload.downcast_ref::<&str>().copied();
    let message =
        literal.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    let line = BadInput::message(format_args!("error: internal: {message}{place}"));
    complain(format_args!("{line}"));
}
