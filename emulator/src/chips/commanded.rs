//! A chip whose joint is commanded over CAN, with a master on its bus, a plant at encoder and drive, and the host's build of the same control and
//! node beside it.

use std::path::Path;

use strainwave::Angle;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_app::Compensator;
use strainwave_app::commanded::{BusNode, Commanded, Exchange, Frame, NODE, node};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::task::{Demand, Task};
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::design::joint::joint_params;

use crate::chips::bus_program::{Ask, Found, Look, Master};
use crate::chips::chip::{self, Chip};
use crate::chips::control::{a_period, started};
use crate::chips::encoder;
use crate::chips::host::{self, Host, HostBoard};
use crate::chips::host_bus::HostBus;
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

/// Runs the image, which controls the joint of `gear`, under a master.
///
/// # Errors
/// [`Error`].
pub fn on_the_bus(model: &'static Model, elf: &Path, gear: &GearFile) -> Result<OnTheBus, Error> {
    let joint = joint_params(gear)?;
    let compensator: &Compensator = Box::leak(Box::new(joint.build()?));
    let shift = encoder::BITS - joint.motor_encoder_bits;
    let boot = |count| CommandedChip::boot(model, elf, compensator, shift, count);
    let mut outputs = Vec::new();
    let program = |end| Master::new(end).works();
    let (found, beside) = program::run(gear, &Free, boot, program, |angle| outputs.push(angle))?;
    let found = found.map_err(|error| chip::Error::NotStarted { said: error.to_string() })?;
    let (following, error) = deviations(&found, &outputs);
    let speeds = found.stops.iter().map(|period| speed(&outputs, *period));
    // One that is not known is no number, and above all others.
    let stopped_at = speeds.max_by(f64::total_cmp).unwrap_or(f64::NAN);
    Ok(OnTheBus {
        agreement: Agreement { steps: beside.periods, different: beside.host.different },
        frames: beside.frames(),
        stack: beside.chip.stack()?,
        found,
        following,
        error,
        stopped_at,
    })
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
struct CommandedChip {
    chip: Chip,
    shift: u32,
    /// The motor's peak torque (N m).
    peak: f32,
    host: Host<HostBoard<Commanded>>,
    node: BusNode<HostBus>,
    bus: HostBus,
    /// Frames of the chip.
    sent: Vec<Frame>,
    periods: u64,
}

impl CommandedChip {
    fn boot(
        model: &'static Model,
        elf: &Path,
        compensator: &'static Compensator,
        shift: u32,
        count: u32,
    ) -> Result<Self, Error> {
        let (chip, _) = started(Chip::boot(model, elf)?, count << shift)?;
        let exchange: &'static Exchange = Box::leak(Box::new(Exchange::new()));
        let bus = HostBus::default();
        let never = || chip::Error::NotStarted { said: "there is no such node".into() };
        let node = node(NODE, compensator).ok_or_else(never)?;
        Ok(Self {
            chip,
            shift,
            peak: compensator.limits().motor_torque,
            host: Host::commanded_by(Commanded::new(exchange, compensator), compensator, |board| board),
            node: BusNode::new(node, bus.clone(), exchange),
            bus,
            sent: Vec::new(),
            periods: 0,
        })
    }

    /// Frames, and those unlike the host's; what is on its way at the end counts for neither.
    fn frames(&self) -> Agreement {
        let hosts = self.bus.sent();
        let alike = self.sent.iter().zip(&hosts).filter(|(chip, host)| chip == host).count();
        let steps = self.sent.len().max(hosts.len().saturating_sub(ON_THEIR_WAY)) as u64;
        Agreement { steps, different: steps - (alike as u64).min(steps) }
    }
}

/// Frames that the chip may not have sent yet when the host's node has.
const ON_THEIR_WAY: usize = 3;

impl Beside for CommandedChip {
    type Ask = Ask;
    type Look = Look;

    fn step(&mut self, count: u32, ask: &Ask) -> Result<(f32, Look), Error> {
        for frame in &ask.frames {
            self.chip.bus().put(*frame);
        }
        let drive = a_period(&mut self.chip, count << self.shift, ask.encoder_fails)?;
        let (frames, read) = (self.chip.bus().take(), self.chip.bus().read());
        self.host.compare((!ask.encoder_fails).then_some(count), drive);
        self.bus.put(read);
        self.node.poll();
        self.sent.extend(&frames);
        self.periods += 1;
        Ok((host::torque(drive, self.peak) as f32, Look { frames, drive }))
    }
}
