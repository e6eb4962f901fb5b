//! Control on the chip with a plant at its encoder and drive, and the host's build of the same control beside it.
//!
//! A period of the plant begins 0.06 ms after the chip's control interrupt: the encoder is put where the plant is, the chip runs for
//! 0.1 ms, in which it reads it and answers, and its answer is the plant's torque in this period.

use std::path::Path;
use std::time::Duration;

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{Input, Output};
use strainwave_app::Compensator;
use strainwave_app::jog::Planner;
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::bench::task::{Demand, Task};
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::plant::divergence::RunError;

use crate::chips::chip::{self, Chip};
use crate::chips::encoder;
use crate::chips::host::{self, Drive, Host, HostBoard, RELEASED};
use crate::chips::model::Model;
use crate::chips::run_error::Error;
use crate::target::Agreement;

/// From the start of the timer to that of the first period: the interrupts are then 0.04 ms after a period's begin.
pub(super) const PHASE: Duration = Duration::from_micros(60);
/// Longest time from reset to the start of the timer.
const START: Duration = Duration::from_millis(200);
/// Steps of waiting for it.
const GLANCE: Duration = Duration::from_micros(10);
/// The plant of the runs.
pub(super) const SEED: u64 = 1;
/// The operator's step of the target, as the firmware counts it [mrad].
const STEP: f32 = 10.0;
/// When the operator presses the key, and when the load comes (s).
const KEY_AT: f64 = 0.3;
const LOAD_AT: f64 = 0.7;
/// The load, of the rated torque.
const LOAD: f64 = 0.3;
/// Longest time until the idle loop, which also reports, has planned the move (control periods).
const LATEST: u32 = 20;
/// Length (s).
const DURATION: f64 = 1.0;
/// Where constants are changed, as a share of them: in each half, of which one is checked next and the other last.
const CHANGED: [f64; 2] = [0.3, 0.7];
/// Periods for which a stopped control is watched: 0.2 s.
const AFTERWARDS: u32 = 2000;

/// A second of control.
#[derive(Clone, Debug, PartialEq)]
pub struct Second {
    /// From reset to the control's start (s).
    pub started_after: f64,
    /// Periods, and those in which the drive's code or its enable differed from the host's.
    pub agreement: Agreement,
    /// From the operator's key to the first period of the move (control periods).
    pub planned_after: usize,
    /// Periods in which the encoder was not read exactly once.
    pub misread: u64,
    /// Distance of the output from the operator's target before the load comes (rad).
    pub error: f64,
    /// Most bytes of stack in use at once.
    pub stack: u64,
    /// From the encoder's failure to the drive's release (s).
    pub released_after: f64,
    /// Its telemetry.
    pub lines: Vec<String>,
}

/// Boots the image, which controls the joint of `gear`, lets an operator move it, loads it, and takes its encoder away.
///
/// # Errors
/// [`Error`].
pub fn second(model: &'static Model, elf: &Path, gear: &GearFile) -> Result<Second, Error> {
    let conditions = Conditions { sensors: SensorSet::Motor, ..Conditions::of(gear, SEED) };
    let mut bench = Bench::condensed(gear, &conditions).map_err(RunError::from)?;
    let mut booting = Booting { model, elf, gear, beside: None };
    let (mut start, mut error) = (None, f64::NAN);
    bench.go(&Operator { load: LOAD * gear.gear.rated_torque }, &mut booting, |period, _, plant, _| {
        let output = plant.output().angle;
        let moved = output.minus(*start.get_or_insert(output));
        if period as f64 * CONTROL_PERIOD < LOAD_AT {
            error = moved - f64::from(STEP * 1e-3);
        }
    })?;
    let never = || chip::Error::NotStarted { said: "no period was run".into() };
    let mut beside = booting.beside.ok_or_else(never)?;
    beside.chip.magnet().fail();
    let released_after = until_released(&mut beside.chip)?;
    // What it says of it is on its way.
    beside.chip.run(Duration::from_millis(20))?;
    let (agreement, planned_after) = beside.agreement();
    Ok(Second {
        started_after: beside.started_after,
        agreement,
        planned_after,
        misread: beside.misread,
        error: error.abs(),
        stack: beside.chip.stack()?,
        released_after,
        lines: beside.chip.telemetry()?,
    })
}

/// A drive that went off because something is wrong with the chip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopped {
    /// From there to the drive's release (s).
    pub released_after: f64,
    /// Periods in which the drive is enabled, of the 0.2 s after it.
    pub enabled: u64,
}

/// What the watchdog does when the control of a joint at rest stops.
///
/// # Errors
/// [`Error`].
pub fn stopped(model: &'static Model, elf: &Path) -> Result<Stopped, Error> {
    let mut chip = at_rest(model, elf)?;
    chip.stop_timer()?;
    let released_after = until_released(&mut chip)?;
    Ok(Stopped { released_after, enabled: enabled_afterwards(&mut chip)? })
}

/// What a changed bit of the joint's constants in RAM does: the least significant one of a word, in either half of them; the worse.
///
/// # Errors
/// [`Error`].
pub fn constant_changed(model: &'static Model, elf: &Path) -> Result<Stopped, Error> {
    let mut worst = Stopped { released_after: 0.0, enabled: 0 };
    for share in CHANGED {
        let mut chip = at_rest(model, elf)?;
        chip.change_constant(share)?;
        worst.released_after = worst.released_after.max(until_disabled(&mut chip)?);
        worst.enabled += enabled_afterwards(&mut chip)?;
    }
    Ok(worst)
}

/// A joint at rest, controlled for 0.3 s.
fn at_rest(model: &'static Model, elf: &Path) -> Result<Chip, Error> {
    let (mut chip, _) = start(model, elf, 0)?;
    chip.run(Duration::from_millis(300))?;
    if chip.drive()?.1 {
        Ok(chip)
    } else {
        Err(chip::Error::NotStarted { said: "the drive is not enabled".into() }.into())
    }
}

fn enabled_afterwards(chip: &mut Chip) -> Result<u64, Error> {
    let mut enabled = 0;
    for _ in 0..AFTERWARDS {
        chip.run(period())?;
        enabled += u64::from(chip.drive()?.1);
    }
    Ok(enabled)
}

/// Boots an image, up to the first period.
fn start(model: &'static Model, elf: &Path, count: u32) -> Result<(Chip, f64), Error> {
    Ok(started(Chip::boot(model, elf)?, count)?)
}

/// A chip in reset, up to the first period; how long that takes (s).
///
/// # Errors
/// [`chip::Error::NotStarted`].
pub(super) fn started(mut chip: Chip, count: u32) -> Result<(Chip, f64), chip::Error> {
    chip.magnet().put(count);
    let mut waited = Duration::ZERO;
    while !chip.controls()? {
        if waited > START {
            let said = chip.telemetry()?.pop().unwrap_or_else(|| "it said nothing".into());
            return Err(chip::Error::NotStarted { said });
        }
        chip.run(GLANCE)?;
        waited += GLANCE;
    }
    chip.run(PHASE)?;
    Ok((chip, waited.as_secs_f64()))
}

/// Time until the drive has neither torque nor enable (s), in periods; infinite when it keeps one for 0.1 s.
fn until_released(chip: &mut Chip) -> Result<f64, Error> {
    for periods in 1..=1000 {
        chip.run(period())?;
        if chip.drive()? == RELEASED {
            return Ok(f64::from(periods) * CONTROL_PERIOD);
        }
    }
    Ok(f64::INFINITY)
}

/// Time until the drive is not enabled (s), to 10 us; infinite when it is for 0.1 s.
fn until_disabled(chip: &mut Chip) -> Result<f64, Error> {
    for glances in 1..=10_000 {
        chip.run(GLANCE)?;
        if !chip.drive()?.1 {
            return Ok((GLANCE * glances).as_secs_f64());
        }
    }
    Ok(f64::INFINITY)
}

/// The drive after a control period in which the encoder is at `count`, or fails.
///
/// # Errors
/// As [`Chip::run`].
pub(super) fn a_period(chip: &mut Chip, count: u32, encoder_fails: bool) -> Result<Drive, chip::Error> {
    chip.magnet().answers(!encoder_fails);
    chip.magnet().put(count);
    chip.run(period())?;
    chip.drive()
}

/// A control period.
fn period() -> Duration {
    Duration::from_secs_f64(CONTROL_PERIOD)
}

/// A joint that holds, is moved by a key, and then loaded.
struct Operator {
    /// (N m)
    load: f64,
}

impl Task for Operator {
    fn duration(&self) -> f64 {
        DURATION
    }

    fn at(&self, time: f64, _capability: &Capability) -> Demand {
        Demand { load: if time < LOAD_AT { 0.0 } else { self.load }, ..Demand::default() }
    }
}

/// The chip as the plant's controller, the host's control beside it.
struct Beside {
    chip: Chip,
    /// From reset to the control's start (s).
    started_after: f64,
    /// The same control as often, each of which takes up the operator's move a period later than the one before.
    hosts: Vec<(Host<HostBoard>, Planner)>,
    /// Left shift of the joint's counts to those of the encoder.
    shift: u32,
    /// The motor's peak torque (N m).
    peak: f32,
    periods: u32,
    misread: u64,
}

impl Beside {
    /// Both at rest, where the encoder shows `count` of the joint's resolution.
    fn boot(model: &'static Model, elf: &Path, gear: &GearFile, count: u32) -> Result<Self, Error> {
        let joint = joint_params(gear)?;
        let shift = encoder::BITS - joint.motor_encoder_bits;
        let (chip, started_after) = start(model, elf, count << shift)?;
        let compensator: &Compensator = Box::leak(Box::new(joint.build()?));
        let hosts = (0..=LATEST).map(|_| operated(compensator)).collect::<Result<_, _>>()?;
        let peak = compensator.limits().motor_torque;
        Ok(Self { chip, started_after, hosts, shift, peak, periods: 0, misread: 0 })
    }

    /// Of the host that takes the move up when the chip does, and how many periods after the key that is.
    fn agreement(&self) -> (Agreement, usize) {
        let steps = self.periods.into();
        let different = |(host, _): &(Host<HostBoard>, Planner)| host.different;
        let best = self.hosts.iter().map(different).enumerate().min_by_key(|(_, different)| *different);
        let (after, different) = best.unwrap_or_default();
        (Agreement { steps, different }, after)
    }

    fn step(&mut self, count: u32) -> Result<f64, Error> {
        let after_key = self.periods.checked_sub((KEY_AT / CONTROL_PERIOD) as u32);
        if after_key == Some(0) {
            self.chip.press(b'+');
        }
        self.periods += 1;
        let readings = self.chip.magnet().readings();
        let drive = a_period(&mut self.chip, count << self.shift, false)?;
        self.misread += u64::from(self.chip.magnet().readings() != readings + 1);
        for (after, (host, planner)) in self.hosts.iter_mut().enumerate() {
            if after_key == Some(after as u32) {
                planner.plan(STEP * 1e-3);
            }
            host.compare(Some(count), drive);
        }
        Ok(host::torque(drive, self.peak))
    }
}

/// The firmware's control on the host, with the planner of its moves.
fn operated(compensator: &'static Compensator) -> Result<(Host<HostBoard>, Planner), strainwave::Error> {
    let (host, jog) = Host::new(compensator, |board| board);
    Ok((host, Planner::new(jog)?))
}

/// Boots the chip with the plant's first reading.
struct Booting<'a> {
    model: &'static Model,
    elf: &'a Path,
    gear: &'a GearFile,
    beside: Option<Beside>,
}

impl Controller for Booting<'_> {
    type Error = Error;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Error> {
        let count = input.sensors.motor_encoder;
        let beside = match &mut self.beside {
            Some(beside) => beside,
            none => none.insert(Beside::boot(self.model, self.elf, self.gear, count)?),
        };
        let motor_torque = beside.step(count)? as f32;
        Ok(Output { motor_torque, ..Output::default() })
    }
}
