//! An emulated board at work that serves its tuning link at a socket: for those who have no hardware at hand, and for tests.
//!
//! The firmware is the program `served` of the board `mps2-an386`, its plant the condensed one of the gear file, which goes through the working
//! motion over and over, no faster than real time. Its flash is a file, which may outlive it.

use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{Input, Output, Status};
use strainwave_app::frame::{decode_output, encode_input};
use strainwave_app::served::{STORE_BYTES, STORE_FILE};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::bench::working_motion::WorkingMotion;
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::plant::divergence::RunError;

use crate::firmware;
use crate::firmware::Program;
use crate::machine::{self, Ending, Machine, Options};
use crate::pil;
use crate::setup;

/// The board that it is.
pub const BOARD: &str = "mps2-an386";
/// Socket of the second UART, in the emulator's folder.
const SOCKET: &str = "tuning.socket";
/// The plant: one that is off what the controller knows, so that there is something to learn.
const SEED: u64 = 1;
/// Longest sleep of a plant that is ahead of the clock, and how far it may be: the emulator serves its serial ports in between two periods.
const AHEAD: Duration = Duration::from_millis(1);
/// What an erased byte of the flash reads.
const ERASED: u8 = 0xff;

/// Why it does not run, or ended.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is no image.
    #[error(transparent)]
    Firmware(#[from] firmware::Error),
    /// There is no emulator.
    #[error(transparent)]
    Setup(#[from] setup::Error),
    /// The machine failed.
    #[error(transparent)]
    Machine(#[from] machine::Error),
    /// The plant cannot be built, or diverged.
    #[error(transparent)]
    Plant(#[from] RunError),
    /// The file of the flash cannot be made.
    #[error("{}: {error}", file.display())]
    Store {
        /// The file.
        file: PathBuf,
        /// Why.
        error: io::Error,
    },
}

/// The board at work, until it is ended or dropped.
pub struct ServedBoard {
    socket: PathBuf,
    stopped: Arc<AtomicBool>,
    /// Bits of the status that the board's next reading has.
    status: Arc<AtomicU32>,
    work: Option<JoinHandle<Result<Ending, Error>>>,
}

impl ServedBoard {
    /// Starts the board for the joint of a gear file; its flash is kept in a file, which is made when missing, or forgotten.
    ///
    /// # Errors
    /// [`Error`].
    pub fn start(gear: &GearFile, store: Option<&Path>) -> Result<Self, Error> {
        let elf = build(gear)?;
        let kept = store.map(flash_in).transpose()?;
        let serial = ["-serial".into(), format!("unix:{SOCKET},server=on,wait=off")];
        let files = kept.into_iter().map(|file| (store_name(), file)).collect();
        let options = Options { arguments: serial.into(), files, ..Options::default() };
        let machine = Machine::boot_with(&elf, &options)?;
        let socket = machine.directory().join(SOCKET);
        let bench = Bench::condensed(gear, &Conditions::of(gear, SEED)).map_err(RunError::from)?;
        let (stopped, status) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU32::new(0)));
        let begun = Instant::now();
        let mut board =
            Firmware { machine, begun, periods: 0, stopped: stopped.clone(), status: status.clone() };
        // The socket is there before the firmware's first step.
        board.exchange(&Input::default())?;
        let work = Some(thread::spawn(move || work(board, bench)));
        Ok(Self { socket, stopped, status, work })
    }

    /// The socket of its link.
    pub fn socket(&self) -> &Path {
        &self.socket
    }

    /// The next reading of the sensors has this status too.
    pub fn report(&self, status: Status) {
        self.status.store(status.0, Ordering::Relaxed);
    }

    /// Ends it, and reads the firmware's report.
    ///
    /// # Errors
    /// [`Error`] when it ended otherwise before.
    pub fn end(mut self) -> Result<Ending, Error> {
        self.stop()
            .unwrap_or_else(|| Err(machine::Error::Io(io::Error::other("it has ended already")).into()))
    }

    fn stop(&mut self) -> Option<Result<Ending, Error>> {
        self.stopped.store(true, Ordering::Relaxed);
        let ended = self.work.take()?.join();
        Some(ended.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    }
}

impl Drop for ServedBoard {
    fn drop(&mut self) {
        // Who wants to know how it ended asks.
        let _ = self.stop();
    }
}

/// The program's image for a joint.
fn build(gear: &GearFile) -> Result<PathBuf, Error> {
    setup::this_emulator()?;
    Ok(pil::build_as(Program::Served, BOARD, gear)?.elf)
}

fn store_name() -> String {
    STORE_FILE.to_string_lossy().into_owned()
}

/// The file of a flash, which is an erased one where there was none.
fn flash_in(file: &Path) -> Result<PathBuf, Error> {
    let failed = |error| Error::Store { file: file.to_owned(), error };
    match OpenOptions::new().write(true).create_new(true).open(file) {
        Ok(mut made) => io::Write::write_all(&mut made, &[ERASED; STORE_BYTES]).map_err(failed)?,
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        Err(error) => return Err(failed(error)),
    }
    if file.metadata().map_err(failed)?.len() != STORE_BYTES as u64 {
        let why = format!("is no flash of the emulated board, which has {STORE_BYTES} bytes");
        return Err(failed(io::Error::other(why)));
    }
    file.canonicalize().map_err(failed)
}

/// Goes through the working motion until it is stopped.
fn work(
    mut board: Firmware,
    mut bench: Bench<impl strainwave::flexspline::Flexspline<f64>>,
) -> Result<Ending, Error> {
    loop {
        match bench.go(&WorkingMotion, &mut board, |_, _, _, _| ()) {
            Ok(()) => {}
            Err(Ended::Stopped) => return Ok(board.machine.finish()?),
            Err(Ended::Failed(error)) => return Err(error),
        }
    }
}

/// Why the work ends.
enum Ended {
    Stopped,
    Failed(Error),
}

impl From<RunError> for Ended {
    fn from(error: RunError) -> Self {
        Self::Failed(error.into())
    }
}

/// The firmware as a controller.
struct Firmware {
    machine: Machine,
    /// Begin of the time that it keeps, and periods since then.
    begun: Instant,
    periods: u32,
    stopped: Arc<AtomicBool>,
    status: Arc<AtomicU32>,
}

impl Firmware {
    fn exchange(&mut self, input: &Input<f32>) -> Result<Output<f32>, machine::Error> {
        Ok(decode_output(&self.machine.exchange(&encode_input(input))?))
    }

    /// Waits for the clock when it is ahead; time that was lost is not made up for.
    fn keep_time(&mut self) {
        self.periods += 1;
        let (due, now) = (Duration::from_secs_f64(CONTROL_PERIOD) * self.periods, self.begun.elapsed());
        if due > now + AHEAD {
            thread::sleep(AHEAD);
        } else if now > due + AHEAD {
            (self.begun, self.periods) = (Instant::now(), 0);
        }
    }
}

impl Controller for Firmware {
    type Error = Ended;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Ended> {
        if self.stopped.load(Ordering::Relaxed) {
            return Err(Ended::Stopped);
        }
        self.keep_time();
        let status = input.status.with(Status(self.status.swap(0, Ordering::Relaxed)));
        self.exchange(&Input { status, ..*input }).map_err(|error| Ended::Failed(error.into()))
    }
}
