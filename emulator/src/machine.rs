//! The emulated board, in lockstep with the host.
//!
//! The firmware opens two FIFOs in QEMU's working directory and blocks in each control period until
//! the host has sent the sensors; under `-icount` its clock stands still meanwhile. [`Machine::exchange`]
//! is one such period. Both FIFOs are opened here for reading and writing before QEMU starts: an open
//! then never blocks, on either side, whichever dies first.

use crate::artifact::{self, Image};
use crate::process::Process;
use crate::scratch::Scratch;
use crate::{setup, telemetry};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{CWD, Mode, OFlags, mkfifoat};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::unix::fs::{OpenOptionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::sync::Arc;
use std::time::Duration;
use strainwave_app::frame::{INPUT_BYTES, OUTPUT_BYTES};

/// Emulated time per instruction is `2^shift` ns: 8 ns, or 12 500 instructions in a control period. The
/// STM32F405 has 16 800 cycles in one.
pub const SHIFT: u8 = 3;

/// Longest time of a control period on the host before it counts as hung.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// Most control periods that may be sent ahead of their answers: neither side may wait for the other to empty a FIFO, and a user who has many
/// gets one of no more than a page.
pub const AHEAD: usize = 4096 / if INPUT_BYTES > OUTPUT_BYTES { INPUT_BYTES } else { OUTPUT_BYTES };

/// Interval at which a waiting host checks that QEMU still runs.
const GLANCE: Duration = Duration::from_millis(50);

/// Why the lockstep ended.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// QEMU is missing.
    #[error(transparent)]
    Setup(#[from] setup::Error),
    /// The file is no image.
    #[error(transparent)]
    Image(#[from] artifact::Error),
    /// The image is for no machine of the emulator.
    #[error("{}: the emulator has no machine that it is for, an emulated board's image is needed", image.display())]
    NotEmulated {
        /// The image.
        image: PathBuf,
    },
    /// The host's side failed.
    #[error("emulator link: {0}")]
    Io(#[from] io::Error),
    /// The emulator ended.
    #[error("the emulator ended with {status}: {said}")]
    Ended {
        /// Its exit status.
        status: ExitStatus,
        /// Last output of it and the firmware.
        said: String,
    },
    /// The firmware hangs.
    #[error("the firmware did not answer within {} s: {said}", patience.as_secs_f32())]
    Hung {
        /// Time that it had.
        patience: Duration,
        /// Its last output.
        said: String,
    },
    /// The telemetry is unreadable.
    #[error(transparent)]
    Telemetry(#[from] telemetry::Error),
    /// The firmware left without its final report.
    #[error("the firmware ended without its final report: {said}")]
    NoReport {
        /// Its last output.
        said: String,
    },
}

/// Options of an emulated board.
#[derive(Clone, Debug)]
pub struct Options {
    /// Emulated time per instruction, `2^shift` ns.
    pub shift: u8,
    /// Longest time of a control period on the host.
    pub patience: Duration,
    /// More arguments for QEMU, such as a plugin.
    pub arguments: Vec<String>,
    /// Files that the image opens by a name of its own, by their absolute path.
    pub files: Vec<(String, PathBuf)>,
}

impl Default for Options {
    fn default() -> Self {
        Self { shift: SHIFT, patience: PATIENCE, arguments: Vec::new(), files: Vec::new() }
    }
}

/// Report of a firmware when its run ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ending {
    /// Every line of telemetry.
    pub telemetry: Vec<String>,
    /// Most bytes of stack in use at once, measured.
    pub stack: u32,
    /// Telemetry records that were dropped because the queue was full.
    pub dropped: u32,
}

/// A booted board.
pub struct Machine {
    // Closed before QEMU is killed, in this order.
    sensors: File,
    command: File,
    process: Arc<Process>,
    elf: PathBuf,
    patience: Duration,
}

impl Machine {
    /// Boots an image on the machine that it names; `arguments` go to QEMU as they are.
    ///
    /// # Errors
    /// [`Error::Setup`] without QEMU, [`Error::Image`] or [`Error::NotEmulated`] for another file,
    /// [`Error::Io`] when QEMU cannot be started.
    pub fn boot(elf: &Path, arguments: &[String]) -> Result<Self, Error> {
        Self::boot_with(elf, &Options { arguments: arguments.to_vec(), ..Options::default() })
    }

    /// Boots an image.
    ///
    /// # Errors
    /// As [`Machine::boot`].
    pub fn boot_with(elf: &Path, options: &Options) -> Result<Self, Error> {
        let (program, arguments) = command(elf, options)?;
        let elf = elf.canonicalize().map_err(|error| named(elf, &error))?;
        let directory = Scratch::new("machine")?;
        let sensors = fifo(&directory.path().join("sensors.fifo"))?;
        let command = fifo(&directory.path().join("command.fifo"))?;
        for (name, file) in &options.files {
            symlink(file, directory.path().join(name))?;
        }
        let process = Process::start(&program, &arguments, directory)?;
        Ok(Self { sensors, command, process, elf, patience: options.patience })
    }

    /// One control period: the sensors in, the command out.
    ///
    /// # Errors
    /// As [`Machine::send`] and [`Machine::receive`].
    pub fn exchange(&mut self, input: &[u8; INPUT_BYTES]) -> Result<[u8; OUTPUT_BYTES], Error> {
        self.exchange_frame(input)
    }

    /// The same of a program whose frames are others.
    ///
    /// # Errors
    /// As [`Machine::send`] and [`Machine::receive`].
    pub fn exchange_frame<const I: usize, const O: usize>(
        &mut self,
        input: &[u8; I],
    ) -> Result<[u8; O], Error> {
        self.send(input)?;
        self.receive()
    }

    /// The sensors of a control period, of which the answer is received later: [`AHEAD`] periods at most may be sent before.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn send<const I: usize>(&mut self, input: &[u8; I]) -> Result<(), Error> {
        Ok(self.sensors.write_all(input)?)
    }

    /// The command of the first control period whose answer was not received yet.
    ///
    /// # Errors
    /// [`Error::Ended`] when the firmware or QEMU ended, [`Error::Hung`] when no answer came in time.
    pub fn receive<const O: usize>(&mut self) -> Result<[u8; O], Error> {
        let mut output = [0; O];
        let (mut filled, mut waited) = (0, Duration::ZERO);
        while filled < O {
            match self.command.read(&mut output[filled..]) {
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => self.wait(&mut waited)?,
                Err(error) => return Err(error.into()),
            }
        }
        Ok(output)
    }

    /// Closes the link, waits for the firmware to end, and reads its report.
    ///
    /// # Errors
    /// [`Error`] when it does not end as it should.
    pub fn finish(self) -> Result<Ending, Error> {
        let (elf, process) = self.wait_for_end()?;
        report(&elf, &process)
    }

    /// Waits for a program that ends by itself, and reads its telemetry.
    ///
    /// # Errors
    /// [`Error`] when it does not end as it should.
    pub fn end(self) -> Result<Vec<String>, Error> {
        let (elf, process) = self.wait_for_end()?;
        Ok(telemetry::decode(&elf, &uart(&process))?)
    }

    fn wait_for_end(self) -> Result<(PathBuf, Arc<Process>), Error> {
        let Self { sensors, command, process, elf, patience } = self;
        drop(sensors);
        let status = process.wait(patience);
        drop(command);
        match status {
            Some(status) if status.success() => Ok((elf, process)),
            Some(status) => Err(Error::Ended { status, said: last_words(&elf, &process) }),
            None => Err(Error::Hung { patience, said: last_words(&elf, &process) }),
        }
    }

    /// Process id of the emulator.
    pub fn id(&self) -> u32 {
        self.process.id()
    }

    /// The folder that the emulator works in; gone with the machine.
    pub fn directory(&self) -> &Path {
        self.process.directory()
    }

    /// Every line of telemetry so far.
    ///
    /// # Errors
    /// [`Error::Telemetry`] when the image is not one that logs.
    pub fn telemetry(&self) -> Result<Vec<String>, Error> {
        Ok(telemetry::decode(&self.elf, &uart(&self.process))?)
    }

    /// Returns when there may be something to read, or after a glance, which counts as `waited`: a host that has stood still
    /// meanwhile has not waited.
    fn wait(&self, waited: &mut Duration) -> Result<(), Error> {
        let mut answer = [PollFd::new(&self.command, PollFlags::IN)];
        let glance = Timespec { tv_sec: 0, tv_nsec: GLANCE.subsec_nanos().into() };
        if poll(&mut answer, Some(&glance)).map_err(io::Error::from)? > 0 {
            return Ok(());
        }
        *waited += GLANCE;
        let said = || last_words(&self.elf, &self.process);
        if let Some(status) = self.process.ended() {
            return Err(Error::Ended { status, said: said() });
        }
        if *waited > self.patience {
            return Err(Error::Hung { patience: self.patience, said: said() });
        }
        Ok(())
    }
}

/// What an image is booted with: the emulator and its arguments.
///
/// # Errors
/// As [`Machine::boot`].
pub fn command(elf: &Path, options: &Options) -> Result<(PathBuf, Vec<String>), Error> {
    let emulator = setup::this_emulator()?;
    let elf = elf.canonicalize().map_err(|error| named(elf, &error))?;
    let image = Image::read(&elf)?;
    let machine = image.machine().ok_or_else(|| Error::NotEmulated { image: elf.clone() })?;
    Ok((emulator.program.clone(), arguments(&elf, machine, options)))
}

fn named(path: &Path, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

/// A new FIFO, open at both ends.
fn fifo(path: &Path) -> io::Result<File> {
    mkfifoat(CWD, path, Mode::RUSR | Mode::WUSR)?;
    let flags = OFlags::NONBLOCK.bits().cast_signed();
    OpenOptions::new().read(true).write(true).custom_flags(flags).open(path)
}

fn arguments(elf: &Path, machine: &str, options: &Options) -> Vec<String> {
    let icount = format!("shift={},sleep=off", options.shift);
    let kernel = elf.display().to_string();
    let fixed = [
        ["-machine", machine],
        ["-display", "none"],
        ["-monitor", "none"],
        ["-serial", "file:uart.bin"],
        ["-semihosting-config", "enable=on,target=native"],
        ["-icount", &icount],
        ["-kernel", &kernel],
    ];
    fixed.concat().into_iter().map(str::to_owned).chain(options.arguments.iter().cloned()).collect()
}

fn uart(process: &Process) -> Vec<u8> {
    std::fs::read(process.directory().join("uart.bin")).unwrap_or_default()
}

/// The console, and the last line of telemetry.
fn last_words(elf: &Path, process: &Process) -> String {
    let console = process.said();
    let telemetry = telemetry::decode(elf, &uart(process)).unwrap_or_default();
    let last = telemetry.last().map(|line| format!("last telemetry: {line}"));
    let words: Vec<String> = console.lines().map(str::to_owned).chain(last).collect();
    if words.is_empty() { "it said nothing".into() } else { words.join("; ") }
}

fn report(elf: &Path, process: &Process) -> Result<Ending, Error> {
    let telemetry = telemetry::decode(elf, &uart(process))?;
    let figures = telemetry.last().and_then(|line| final_figures(line));
    let (stack, dropped) = figures.ok_or_else(|| Error::NoReport { said: last_words(elf, process) })?;
    Ok(Ending { telemetry, stack, dropped })
}

/// The figures in the firmware's last line: `stack 1234 dropped 0`.
fn final_figures(line: &str) -> Option<(u32, u32)> {
    let (stack, dropped) = line.strip_prefix("stack ")?.split_once(" dropped ")?;
    Some((stack.parse().ok()?, dropped.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_holds_the_figures() {
        assert_eq!(final_figures("stack 1234 dropped 5"), Some((1234, 5)));
        assert_eq!(final_figures("period 7 encoder 0"), None);
        assert_eq!(final_figures("stack 1234"), None);
    }

    #[test]
    fn more_arguments_come_after_the_fixed_ones() {
        let options = Options { arguments: vec!["-plugin".into(), "x".into()], ..Options::default() };
        let arguments = arguments(Path::new("/image"), "mps2-an386", &options);
        assert_eq!(&arguments[arguments.len() - 2..], ["-plugin", "x"]);
        assert!(arguments.contains(&"shift=3,sleep=off".to_owned()));
    }
}
