//! A chip whose joint is commanded over CAN, with a master on its bus, a plant at encoder and drive, and the host's build of the same control and
//! node beside it; the drive at its wires, or an ODrive on its second bus.

use std::io;
use std::path::Path;

use strainwave::Angle;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_app::Compensator;
use strainwave_app::commanded::{BusNode, Commanded, Exchange, NODE, node};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::task::{Demand, Task};
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::design::joint::joint_params;

use crate::chips::bus_program::{Ask, Found, Look, Master};
use crate::chips::chip::{self, Chip};
use crate::chips::control::{PHASE, a_period, started};
use crate::chips::drive_end::{ControlBeside, DriveEnd, OdriveEnd, WiredEnd};
use crate::chips::encoder;
use crate::chips::host::Host;
use crate::chips::host_bus::{self, HostBus};
use crate::chips::model::Model;
use crate::chips::program::{self, Beside};
use crate::chips::run_error::Error;
use crate::target::Agreement;

/// What was found on the bus, and of the chip beside the host.
#[derive(Clone, Debug, Default)]
pub struct OnTheBus {
    /// What the master found.
    pub found: Found,
    /// Steps beside the host's.
    pub agreement: Agreement,
    /// Frames beside those of the host's node.
    pub frames: Agreement,
    /// Largest distance of the output from the interpolated targets in the move (rad).
    pub following: f64,
    /// The same at rest after it.
    pub error: f64,
    /// Fastest output when a joint in motion was stopped and its drive goes off (rad/s).
    pub stopped_at: f64,
    /// Most bytes of stack in use at once.
    pub stack: u64,
}

/// What was found of an ODrive.
#[derive(Clone, Debug, Default)]
pub struct BeforeOdrive {
    /// As without it, but for the steps: their torques are in the frames to the drive.
    pub on_the_bus: OnTheBus,
    /// Frames to the drive beside those of the host's build.
    pub frames: Agreement,
    /// Longest time from a control interrupt until its torque, or a newer one, is at the drive (s).
    pub delay: f64,
}

/// Runs the image, which controls the joint of `gear`, under a master.
///
/// # Errors
/// [`Error`].
pub fn on_the_bus(model: &'static Model, elf: &Path, gear: &GearFile) -> Result<OnTheBus, Error> {
    Ok(commanded::<WiredEnd>(model, elf, gear, Master::works)?.0)
}

/// The same of one whose drive is an ODrive, which fails, too.
///
/// # Errors
/// [`Error`].
pub fn before_odrive(model: &'static Model, elf: &Path, gear: &GearFile) -> Result<BeforeOdrive, Error> {
    let (on_the_bus, drive) = commanded::<OdriveEnd>(model, elf, gear, Master::works_before_drive)?;
    Ok(BeforeOdrive { on_the_bus, frames: drive.bus.agreement(), delay: drive.delay() })
}

fn commanded<D: DriveEnd>(
    model: &'static Model,
    elf: &Path,
    gear: &GearFile,
    works: fn(Master) -> io::Result<Found>,
) -> Result<(OnTheBus, D), Error> {
    let joint = joint_params(gear)?;
    let compensator: &Compensator = Box::leak(Box::new(joint.build()?));
    let shift = encoder::BITS - joint.motor_encoder_bits;
    let boot = |count| CommandedChip::<D>::boot(model, elf, compensator, shift, count);
    let mut outputs = Vec::new();
    let program = |end| works(Master::new(end));
    let (found, beside) = program::run(gear, &Free, boot, program, |angle| outputs.push(angle))?;
    let found = found.map_err(|error| chip::Error::NotStarted { said: error.to_string() })?;
    let (following, error) = deviations(&found, &outputs);
    let speeds = found.stops.iter().map(|period| speed(&outputs, *period));
    // One that is not known is no number, and above all others.
    let stopped_at = speeds.max_by(f64::total_cmp).unwrap_or(f64::NAN);
    let on_the_bus = OnTheBus {
        agreement: Agreement { steps: beside.periods, different: beside.host.different },
        frames: beside.bus.agreement(),
        stack: beside.chip.stack()?,
        found,
        following,
        error,
        stopped_at,
    };
    Ok((on_the_bus, beside.drive))
}

/// Largest distance of the output from where the targets of the move were two cycles of the bus before, and that of the last one.
fn deviations(found: &Found, outputs: &[Angle<f64>]) -> (f64, f64) {
    let Some(start) = found.moves.first().and_then(|(period, _)| outputs.get(*period)) else {
        return (f64::NAN, f64::NAN);
    };
    let distances = found.moves.iter().filter_map(|(period, target)| {
        let output = outputs.get(period + 2 * found.cycle)?;
        Some((output.minus(*start) - target).abs())
    });
    let distances: Vec<_> = distances.collect();
    let most = distances.iter().copied().max_by(f64::total_cmp);
    (most.unwrap_or(f64::NAN), distances.last().copied().unwrap_or(f64::NAN))
}

/// Mean speed of the output (rad/s) in the 5 ms before a period.
fn speed(outputs: &[Angle<f64>], period: usize) -> f64 {
    const BEFORE: usize = 50;
    let [then, now] = [period.saturating_sub(BEFORE), period].map(|period| outputs.get(period));
    let way = now.zip(then).map_or(f64::NAN, |(now, then)| now.minus(*then));
    way.abs() / (BEFORE as f64 * CONTROL_PERIOD)
}

/// A joint without a load.
struct Free;

impl Task for Free {
    // The program ends it.
    fn duration(&self) -> f64 {
        100.0
    }

    fn at(&self, _time: f64, _capability: &Capability) -> Demand {
        Demand::default()
    }
}

/// The chip as the plant's controller, the host's control and node beside it.
struct CommandedChip<D: DriveEnd> {
    chip: Chip,
    shift: u32,
    host: ControlBeside,
    node: BusNode<HostBus, D::Behind>,
    bus: host_bus::Beside,
    drive: D,
    periods: u64,
}

impl<D: DriveEnd> CommandedChip<D> {
    fn boot(
        model: &'static Model,
        elf: &Path,
        compensator: &'static Compensator,
        shift: u32,
        count: u32,
    ) -> Result<Self, Error> {
        let (chip, waited) = started(Chip::boot(model, elf)?, count << shift)?;
        let exchange: &'static Exchange = Box::leak(Box::new(Exchange::new()));
        let bus = host_bus::Beside::default();
        let never = || chip::Error::NotStarted { said: "there is no such node".into() };
        let node = node(NODE, compensator).ok_or_else(never)?;
        let (drive, behind) = D::begin(waited + PHASE.as_secs_f64(), compensator)?;
        Ok(Self {
            chip,
            shift,
            host: Host::commanded_by(Commanded::new(exchange, compensator), compensator, |board| board),
            node: BusNode::new(node, bus.host.clone(), behind, exchange),
            bus,
            drive,
            periods: 0,
        })
    }
}

impl<D: DriveEnd> Beside for CommandedChip<D> {
    type Ask = Ask;
    type Look = Look;

    fn step(&mut self, count: u32, ask: &Ask) -> Result<(f32, Look), Error> {
        for frame in &ask.frames {
            self.chip.bus().put(*frame);
        }
        self.drive.before(&self.chip, ask);
        a_period(&mut self.chip, count << self.shift, ask.encoder_fails)?;
        let count = (!ask.encoder_fails).then_some(count);
        let (torque, drive) = self.drive.after(&self.chip, &mut self.host, count)?;
        let (frames, read) = (self.chip.bus().take(), self.chip.bus().read());
        self.bus.host.put(read);
        self.node.poll();
        self.drive.polled();
        self.bus.sent.extend(&frames);
        self.periods += 1;
        Ok((torque, Look { frames, drive }))
    }
}
