//! `setup`: makes the compiler for the boards and the emulator ready.

use clap::Args;
use strainwave_desktop::BadInput;
use strainwave_emulator::firmware;
use strainwave_emulator::setup::{self, ThisHost};

use crate::figures::{Figures, FiguresArguments, say};

/// Make ready what the firmware is compiled with and runs in, and name it
///
/// Every other subcommand does so by itself. What is there is used; what is missing is announced and fetched without
/// changing the system: the targets by `rustup target add`, else Debian packages, which are unpacked in
/// $STRAINWAVE_CACHE, $XDG_CACHE_HOME/strainwave or $HOME/.cache/strainwave.
#[derive(Args)]
pub struct Arguments {
    /// Only the compiler, as lines for a shell, after which any cargo command in boards/ uses it:
    /// eval "$(strainwave setup --shell)"
    #[arg(long)]
    shell: bool,
    /// Only for this board; for every board when left out
    #[arg(long, value_name = "BOARD")]
    board: Option<String>,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Fetches what is missing.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let targets = match &arguments.board {
        Some(board) => firmware::target(board).map(|target| vec![target]),
        None => firmware::targets(),
    };
    let targets = targets.map_err(BadInput::message)?;
    let compilers = targets.iter().map(|target| setup::compiler(&ThisHost, target));
    let compilers = compilers.collect::<Result<Vec<_>, _>>().map_err(BadInput::message)?;
    if arguments.shell {
        compilers.iter().for_each(|compiler| say(format_args!("{}", compiler.shell_lines().trim_end())));
    } else {
        let emulator = setup::emulator(&ThisHost).map_err(BadInput::message)?;
        for compiler in &compilers {
            let (rustc, version) = (compiler.rustc.display(), &compiler.version);
            say(format_args!("compiler for {}: {rustc}, {version}", compiler.target));
        }
        say(format_args!("emulator: {}, {}", emulator.program.display(), emulator.version));
    }
    Ok(Figures::silent(Vec::new(), &arguments.figures))
}
