//! `connect`: a joint at work, over its tuning link.

mod orders;
mod port;
mod quantities;
mod readings;
mod recording;
mod setting;
mod view;

use std::path::PathBuf;

use clap::{Args, value_parser};
use strainwave_desktop::io::file;
use strainwave_desktop::{BadInput, Figure, GearFile};
use strainwave_emulator::interrupt;
use strainwave_service::tuning::client::{Client, Error};

use crate::figures::{Figures, FiguresArguments, say};
use crate::files;
use orders::Expected;
use port::Port;
use readings::{Joint, Readings};
use recording::Curves;
use setting::Setting;
use view::View;

/// Connect to a joint at work: show its readings, try gains, reset its faults, store what it has learnt
///
/// PORT is a serial device such as /dev/ttyUSB0, tcp:HOST:PORT or unix:PATH, behind which a joint's firmware serves the tuning link of the crate
/// strainwave-service. `emulated` starts a board in the emulator that moves the joint of --gear, or the default one, over and over;
/// `emulated:FILE` keeps its flash in this file. Orders are carried out in this sequence: --erase, --reset, --set, the readings, --keep, --stored, --learnt-to. Readings are
/// shown when no order but --set was given, or with --seconds, --log or --plot, until Ctrl-C or for --seconds: a table on a
/// terminal, elsewhere a line each. Gains that are set are in force as long as the command runs; 1 s after its end the
/// joint has its own again.
#[derive(Args)]
pub struct Arguments {
    /// Serial device, tcp:HOST:PORT, unix:PATH, emulated or emulated:FILE
    #[arg(value_name = "PORT")]
    port: Port,
    /// Baud rate of a serial device, 1200 to 12000000; 8 bits, no parity, 1 stop bit
    #[arg(long, value_name = "BAUD", allow_hyphen_values = true, default_value_t = 921_600,
          value_parser = value_parser!(u32).range(1200..=12_000_000))]
    baud: u32,
    /// Gear file that the joint's firmware was built with; another joint is refused
    #[arg(long, value_name = "GEAR.toml")]
    gear: Option<PathBuf>,
    /// Try a gain, 0 to 1, or two for forward and backward motion; may be given more than once
    ///
    /// Names: feedback, inertia, friction, wind-up, kinematic-error, output-feedback, adaptation, ripple. The joint ramps it, by 1 in
    /// 20 ms. What the joint's firmware keeps at 0 stays off.
    #[arg(long, value_name = "NAME=GAIN[,GAIN]")]
    set: Vec<Setting>,
    /// Show no readings while the gains of --set are in force
    #[arg(long, requires = "set")]
    hold: bool,
    /// Reset the faults of a joint that is off for them: from Safe to Ready, once the cause is removed
    #[arg(long)]
    reset: bool,
    /// Store what the joint has learnt so far in its own flash, from which it starts the next time
    #[arg(long)]
    keep: bool,
    /// Print what the joint's store holds
    #[arg(long)]
    stored: bool,
    /// Forget what the joint's store holds, another joint's or layout's too
    #[arg(long)]
    erase: bool,
    /// Write the gear file again, to this file, with what the joint has learnt so far as its [learnt]; needs --gear, and may
    /// be that file
    #[arg(long, value_name = "KEPT.toml", requires = "gear")]
    learnt_to: Option<PathBuf>,
    /// How long to read (s), 0.1 to 1000000, by the joint's clock; until Ctrl-C when left out
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    seconds: Option<f64>,
    /// Readings in a second (Hz), 0.2 to 1000, of 130 bytes each; those that the line has no time for are left out and counted
    #[arg(long, value_name = "HZ", allow_hyphen_values = true, default_value_t = 10.0)]
    rate: f64,
    /// Write every reading to this file (CSV), complete or not at all, once the readings have ended
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
    /// Draw the readings as one self-contained HTML page, its folder made when missing
    #[arg(long, value_name = "FILE.html")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Least and most of `--seconds` (s) and of `--rate` (Hz).
const SECONDS: [f64; 2] = [0.1, 1e6];
const RATE: [f64; 2] = [0.2, 1000.0];

/// Connects, orders and reads.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    arguments.check()?;
    let expected = arguments.gear.as_deref().map(Expected::read).transpose()?;
    let mut joint = arguments.connect(expected.as_ref())?;
    let about = orders::describe(joint.joint());
    if let Some(expected) = &expected {
        expected.require(joint.joint()).map_err(|why| arguments.refused(why))?;
    }
    say(format_args!("{}: {about}", arguments.port));
    arguments.order(&mut joint)?;
    let mut figures = Vec::new();
    if arguments.reads() {
        figures.extend(arguments.read(&mut joint, &about)?);
    }
    figures.extend(arguments.keep(&mut joint, expected.as_ref())?);
    figures.extend(orders::counted(&joint.counts()));
    Ok(Figures::silent(figures, &arguments.figures))
}

impl Arguments {
    /// Refuses what could not be done at the end.
    fn check(&self) -> Result<(), BadInput> {
        let outputs = [
            ("--log", self.log.as_deref()),
            ("--plot", self.plot.as_deref()),
            ("--learnt-to", self.learnt_to.as_deref()),
            ("--json", self.figures.json.as_deref()),
        ];
        files::require_distinct(&outputs)?;
        // Only the gear file itself may be written anew.
        let beside = outputs.into_iter().filter(|(name, _)| *name != "--learnt-to");
        files::require_distinct(
            &[("--gear", self.gear.as_deref())].into_iter().chain(beside).collect::<Vec<_>>(),
        )?;
        for (name, value, [least, most], unit) in [
            ("--seconds", self.seconds.unwrap_or(SECONDS[0]), SECONDS, "s"),
            ("--rate", self.rate, RATE, "Hz"),
        ] {
            if !(least..=most).contains(&value) {
                let allowed = format_args!(
                    "{name} {value} is out of range; allowed: a number from {least} to {most} {unit}"
                );
                return Err(BadInput::message(allowed));
            }
        }
        for (name, path) in outputs.into_iter().filter(|(name, _)| *name != "--json") {
            if path.is_some_and(file::is_stream) {
                return Err(BadInput::message(format_args!("{name} - is not possible; allowed: a file")));
            }
        }
        for path in [self.log.as_deref(), self.learnt_to.as_deref(), self.figures.json.as_deref()] {
            files::require_writable(path)?;
        }
        self.plot.as_deref().map_or(Ok(()), files::require_page)
    }

    fn connect(&self, expected: Option<&Expected>) -> Result<Joint, BadInput> {
        let gear = expected.map_or_else(GearFile::default_gear, |expected| expected.gear().clone());
        let transport = self.port.open(self.baud, &gear).map_err(|why| self.refused(why))?;
        Client::connect(transport, self.port.patience()).map_err(|error| self.failed(error))
    }

    fn refused(&self, why: impl std::fmt::Display) -> BadInput {
        BadInput::message(format_args!("{}: {why}", self.port))
    }

    fn failed(&self, error: Error) -> BadInput {
        self.refused(error)
    }

    /// What comes before the readings.
    fn order(&self, joint: &mut Joint) -> Result<(), BadInput> {
        let failed = |error| self.failed(error);
        if self.erase {
            joint.erase().map_err(failed)?;
            say(format_args!("erased"));
        }
        if self.reset {
            joint.reset().map_err(failed)?;
            say(format_args!("reset"));
        }
        for Setting { function, gains } in &self.set {
            joint.set_gain(*function, *gains).map_err(failed)?;
        }
        if !self.set.is_empty() {
            say(format_args!("gains: {}", setting::describe(joint.trial())));
        }
        Ok(())
    }

    /// Whether readings are taken.
    fn reads(&self) -> bool {
        let recorded = self.seconds.is_some() || self.log.is_some() || self.plot.is_some();
        let ordered = self.erase || self.reset || self.keep || self.stored || self.learnt_to.is_some();
        recorded || !self.set.is_empty() || !ordered
    }

    /// Shows and records the readings.
    fn read(&self, joint: &mut Joint, about: &str) -> Result<Vec<Figure>, BadInput> {
        let head = format!("{}: {about}\ngains: {}", self.port, setting::describe(joint.trial()));
        let lines: Vec<_> = head.lines().map(str::to_owned).collect();
        let name = joint.joint().gear().to_owned();
        let mut view = if self.hold { View::Nowhere } else { View::of_output(head) };
        let seconds = self.seconds.unwrap_or(f64::INFINITY);
        let mut readings = Readings::begin(joint, self.rate, seconds, interrupt::first_stops())
            .map_err(|error| self.failed(error))?;
        let (mut curves, mut last) = (Curves::default(), Vec::new());
        let rows = readings.by_ref().map(|read| {
            let (time, reading) = read?;
            let row = quantities::row(time, &reading);
            view.show(&reading, &row);
            if self.plot.is_some() {
                curves.push(&row);
            }
            last.clone_from(&row);
            Ok(row)
        });
        recording::log(self.log.as_deref(), rows, |error| self.failed(error))?;
        if let Some(path) = &self.plot {
            curves.write(path, &name, &lines)?;
        }
        let (count, missing) = readings.end().map_err(|error| self.failed(error))?;
        say(format_args!("{count} readings, {missing} missing"));
        Ok(orders::read(count, missing, &last))
    }

    /// What comes after the readings.
    fn keep(&self, joint: &mut Joint, expected: Option<&Expected>) -> Result<Vec<Figure>, BadInput> {
        let failed = |error| self.failed(error);
        let mut figures = Vec::new();
        if self.keep {
            let number = joint.keep().map_err(failed)?;
            say(format_args!("kept: record {number}"));
            figures.push(Figure::reported("connect.kept", number.into(), "1"));
        }
        if self.stored {
            orders::require_layout(joint.joint()).map_err(|why| self.refused(why))?;
            let (number, learnt) = joint.stored().map_err(failed)?;
            say(format_args!("stored: record {number}\n{}", orders::listed(&learnt)));
            figures.extend(orders::stored(number, &learnt));
        }
        if let (Some(path), Some(expected)) = (&self.learnt_to, expected) {
            let learnt = joint.learnt().map_err(failed)?;
            expected.keep(&learnt, path)?;
            say(format_args!("learnt: {}", path.display()));
        }
        Ok(figures)
    }
}
