//! A chip that serves its tuning link, with a host at it, a plant at encoder and drive, and the host's build of the same control beside it.

use std::path::Path;

use strainwave::compensator::adapt::learning::Learnt;
use strainwave_app::Compensator;
use strainwave_app::served::{Exchange, Served, ServedJoint};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::task::{Demand, Task};
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::design::joint::joint_params;
use strainwave_service::store::{Owner, Store};
use strainwave_service::tuning::{Answer, Joint as _, Order, Reading, client};

use crate::chips::chip::Chip;
use crate::chips::control::{a_period, started};
use crate::chips::encoder;
use crate::chips::flash_image::FlashImage;
use crate::chips::host::{self, Drive, Host, HostBoard};
use crate::chips::host_program::{Found, restarted, tried_out};
use crate::chips::line::{Ask, Look, Port};
use crate::chips::model::Model;
use crate::chips::program::{self, Beside};
use crate::chips::run_error::Error;
use crate::target::Agreement;

/// When the load comes and goes (s), and the load, of the rated torque.
const LOADED: [f64; 2] = [0.25, 0.35];
const LOAD: f64 = 0.3;
/// Longest time from the request of a gain until the control takes it (control periods).
const LATEST: u32 = 20;

/// Runs the image, which serves the link of the joint of `gear`.
///
/// # Errors
/// [`Error`].
pub fn serve(model: &'static Model, elf: &Path, gear: &GearFile) -> Result<Found, Error> {
    let joint = joint_params(gear)?;
    let compensator: &Compensator = Box::leak(Box::new(joint.build()?));
    let run = Run { model, elf, gear, compensator, shift: encoder::BITS - joint.motor_encoder_bits };
    let ((mut found, owner), agreement, store) = run.with(None, move |port| tried_out(model, port))?;
    found.agreement = agreement;
    if model.store.is_some() {
        let learnt = another(compensator);
        let store = with_record(store, owner, &learnt)?;
        let begins = compensator.learnt(&compensator.rest_with(&learnt));
        let restarted = move |port: &Port| restarted(port, &learnt, &begins);
        let (again, ..) = run.with(Some(&store), restarted)?;
        found.expected += again.expected;
        found.unexpected.extend(again.unexpected);
    }
    Ok(found)
}

/// Something else than what a joint begins with.
fn another(compensator: &Compensator) -> Learnt<f32> {
    let mut learnt = compensator.learnt(&compensator.rest());
    learnt.factors.inertia = 1.125;
    learnt.factors.input_friction = 0.75;
    learnt
}

/// The chip's store with one record more.
fn with_record(bytes: Vec<u8>, owner: Owner, learnt: &Learnt<f32>) -> Result<Vec<u8>, Error> {
    let mut image = FlashImage(bytes);
    let region = 0..image.0.len() as u32;
    let mut store = Store::new(&mut image, region, owner).map_err(Error::Store)?;
    store.write(&learnt.to_words()).map_err(Error::Store)?;
    Ok(image.0)
}

/// What runs of an image have in common.
#[derive(Clone, Copy)]
struct Run<'a> {
    model: &'static Model,
    elf: &'a Path,
    gear: &'a GearFile,
    compensator: &'static Compensator,
    /// Left shift of the joint's counts to those of the encoder.
    shift: u32,
}

impl Run<'_> {
    /// Boots the chip, its store as it was kept, and lets it go on as long as a program at its port runs; what that gives, the steps
    /// beside the host's, and the store at the end.
    fn with<T: Send>(
        self,
        kept: Option<&[u8]>,
        program: impl FnOnce(&Port) -> Result<T, client::Error> + Send,
    ) -> Result<(T, Agreement, Vec<u8>), Error> {
        let task = Loaded(LOAD * self.gear.gear.rated_torque);
        let program = move |end| program(&Port::open(end));
        let (found, beside) =
            program::run(self.gear, &task, |count| ServedChip::boot(self, kept, count), program, |_| ())?;
        Ok((found?, beside.agreement(), beside.chip.store()?))
    }
}

/// A joint that holds, and is loaded for a while (N m).
struct Loaded(f64);

impl Task for Loaded {
    // The program ends it.
    fn duration(&self) -> f64 {
        100.0
    }

    fn at(&self, time: f64, _capability: &Capability) -> Demand {
        let loaded = (LOADED[0]..LOADED[1]).contains(&time);
        Demand { load: if loaded { self.0 } else { 0.0 }, ..Demand::default() }
    }
}

/// The chip as the plant's controller, the host's control beside it.
struct ServedChip {
    chip: Chip,
    shift: u32,
    /// The motor's peak torque (N m).
    peak: f32,
    /// The same control as often, each of which takes the program's order a period later than the one before.
    hosts: Vec<ServedHost>,
    periods: u64,
    order: Option<(Order, u64)>,
}

struct ServedHost {
    host: Host<Served<HostBoard>>,
    joint: ServedJoint<FlashImage>,
}

impl ServedHost {
    fn new(compensator: &'static Compensator) -> Self {
        let exchange: &'static Exchange = Box::leak(Box::new(Exchange::new()));
        let (host, _) = Host::new(compensator, |board| Served::new(board, exchange));
        Self { host, joint: ServedJoint::new(exchange, None, true) }
    }
}

impl ServedChip {
    fn boot(run: Run, kept: Option<&[u8]>, count: u32) -> Result<Self, Error> {
        let chip = Chip::boot_with_store(run.model, run.elf, kept)?;
        let (chip, _) = started(chip, count << run.shift)?;
        let hosts = (0..=LATEST).map(|_| ServedHost::new(run.compensator)).collect();
        let peak = run.compensator.limits().motor_torque;
        Ok(Self { chip, shift: run.shift, peak, hosts, periods: 0, order: None })
    }

    /// Of the host that takes the order when the chip does.
    fn agreement(&self) -> Agreement {
        let different = self.hosts.iter().map(|host| host.host.different).min();
        Agreement { steps: self.periods, different: different.unwrap_or_default() }
    }

    fn compare(&mut self, count: u32, drive: Drive, ask: &Ask) -> Option<Reading> {
        self.order = ask.order.map(|order| (order, self.periods)).or(self.order);
        let mut first = None;
        for (after, ServedHost { host, joint }) in (0..).zip(&mut self.hosts) {
            let due = self.order.filter(|(_, since)| since + after == self.periods);
            joint.order(due.map_or(Order::Read, |(order, _)| order));
            host.compare(Some(count), drive);
            let answer = joint.answer();
            if let (0, Some(Answer::Reading(reading))) = (after, answer) {
                first = Some(reading);
            }
        }
        self.periods += 1;
        first
    }
}

impl Beside for ServedChip {
    type Ask = Ask;
    type Look = Look;

    fn step(&mut self, count: u32, ask: &Ask) -> Result<(f32, Look), Error> {
        self.chip.hears(&ask.bytes);
        let drive = a_period(&mut self.chip, count << self.shift, ask.encoder_fails)?;
        let reading = ask.compares.then(|| self.compare(count, drive, ask)).flatten();
        Ok((host::torque(drive, self.peak) as f32, Look { bytes: self.chip.said(), drive, reading }))
    }
}
