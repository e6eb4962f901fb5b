//! A chip that serves its tuning link, with a host at it, a plant at encoder and drive, and the host's build of the same control beside it.
//!
//! ```text
//! watched     readings of a stream are those of the host's control, and so are all steps, while the joint is loaded
//! refused     gains out of range; on a chip that stands still while it writes its flash, Keep with the drive on
//! tried       a gain is in force in both controls, and again not after a second of silence
//! faulty      the encoder fails, the drive goes off, what was learnt is kept; a reset with the encoder back leads to control
//! restarted   the store holds what was kept, and the control begins with it
//! ```

use std::panic::resume_unwind;
use std::path::Path;
use std::time::Duration;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::words::LEARNT_LAYOUT;
use strainwave::compensator::{Faults, Input, Mode, Output};
use strainwave_app::Compensator;
use strainwave_app::served::{Exchange, Served, ServedJoint};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::bench::task::{Demand, Task};
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::plant::divergence::RunError;
use strainwave_service::store::{self, Owner, Store};
use strainwave_service::tuning::client::{self, Client, Patience};
use strainwave_service::tuning::link::SILENCE;
use strainwave_service::tuning::{Answer, Function, Joint as _, Order, Reading, Refusal, StoreState, Trial};

use crate::chips::chip::{self, Chip};
use crate::chips::control::{SEED, period, started};
use crate::chips::encoder;
use crate::chips::host::{self, Drive, Host, HostBoard, RELEASED};
use crate::chips::line::{Ask, ChipEnd, Look, Port, line};
use crate::chips::model::Model;
use crate::target::Agreement;

/// A request has one try, of more time than the emulation of its answer takes.
const PATIENCE: Patience =
    Patience { answer: Duration::from_secs(120), flash: Duration::from_secs(300), tries: 1 };
/// Control periods until the joint holds, with some to spare, and until a fault has shown.
const SETTLED: u32 = 2000;
const FAULTY: u32 = 300;
/// Readings of the stream, and control periods from one to the next.
const READINGS: u64 = 40;
const EVERY: u16 = 50;
/// Readings that are asked for.
const ASKED: u32 = 10;
/// When the load comes and goes (s), and the load, of the rated torque.
const LOADED: [f64; 2] = [0.25, 0.35];
const LOAD: f64 = 0.3;
/// Longest time from the request of a gain until the control takes it (control periods).
const LATEST: u32 = 20;
/// The tried gains of the friction's compensation, and such that are out of range.
const TRIED: [f32; 2] = [0.5, 0.25];
const OUT_OF_RANGE: [f32; 2] = [1.5, 0.5];

/// Why a run ended.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The chip.
    #[error(transparent)]
    Chip(#[from] chip::Error),
    /// The plant.
    #[error(transparent)]
    Plant(#[from] RunError),
    /// A parameter that no model can be built from.
    #[error(transparent)]
    Parameter(#[from] strainwave::Error),
    /// The host's end of the link.
    #[error(transparent)]
    Client(#[from] client::Error),
    /// What the chip has stored.
    #[error("emulated chip: {}", .0.reason())]
    Store(store::Error),
}

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Steps beside the host's while the link was served.
    pub agreement: Agreement,
    /// Readings, and those unlike the host's.
    pub readings: Agreement,
    /// Longest time from a request of a reading to it (control periods).
    pub answered_after: u32,
    /// Frames that were damaged on their way to the host.
    pub damaged: u64,
    /// From the request to keep what was learnt to its answer, with an erasure (control periods); 0 without a store.
    pub kept_after: u32,
    /// What is otherwise than it has to be, by name.
    pub unexpected: Vec<&'static str>,
    /// How much was looked at for that.
    pub expected: u32,
}

impl Found {
    fn expect(&mut self, what: &'static str, holds: bool) {
        self.expected += 1;
        if !holds {
            self.unexpected.push(what);
        }
    }

    fn compare(&mut self, port: &Port, reading: &Reading) {
        self.readings.steps += 1;
        let alike = port.reading(reading.period) == Some(reading.with_left_out(0));
        self.readings.different += u64::from(!alike);
    }
}

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

/// The host's program at a joint that has never been at work.
fn tried_out(model: &Model, port: &Port) -> Result<(Found, Owner), client::Error> {
    port.from_now_on(|ask| ask.compares = true);
    let (mut client, mut found) = (Client::connect(port.clone(), PATIENCE)?, Found::default());
    let owner = Owner { layout: LEARNT_LAYOUT, joint: client.joint().joint };
    let empty = if model.store.is_some() { StoreState::Empty } else { StoreState::Missing };
    found.expect("the store is empty", client.joint().store == empty);
    watched(port, &mut client, &mut found)?;
    refused(model, &mut client, &mut found);
    tried(port, &mut client, &mut found)?;
    faulty(model, port, &mut client, &mut found)?;
    found.damaged = client.counts().damaged;
    Ok((found, owner))
}

fn watched(port: &Port, client: &mut Client<Port>, found: &mut Found) -> Result<(), client::Error> {
    port.wait(SETTLED)?;
    found.expect("the drive is on", port.drive().1);
    client.stream(EVERY)?;
    for _ in 0..READINGS {
        let reading = client.next_reading(PATIENCE.answer)?;
        found.expect("a reading has come", reading.is_some());
        reading.iter().for_each(|reading| found.compare(port, reading));
    }
    client.stream(0)?;
    for _ in 0..ASKED {
        let asked = port.periods();
        let reading = client.read()?;
        found.answered_after = found.answered_after.max(port.periods() - asked);
        found.compare(port, &reading);
        found.expect("the joint is controlled", reading.mode() == Mode::Active);
    }
    Ok(())
}

fn refused(model: &Model, client: &mut Client<Port>, found: &mut Found) {
    let gains = client.set_gain(Function::Friction, OUT_OF_RANGE);
    found.expect("gains out of range are refused", why(gains) == Some(Refusal::OutOfRange));
    let kept = client.keep();
    match (model.store, model.writes_beside) {
        (None, _) => {
            let missing = Some(Refusal::Store(StoreState::Missing));
            found.expect("there is no store", why(kept) == missing);
        }
        (_, true) => found.expect("it is kept beside the control", kept.is_ok()),
        (_, false) => found.expect("the drive is on: not kept", why(kept) == Some(Refusal::DriveOn)),
    }
}

fn why<T>(answer: Result<T, client::Error>) -> Option<Refusal> {
    match answer {
        Err(client::Error::Refused { why, .. }) => Some(why),
        _ => None,
    }
}

fn tried(port: &Port, client: &mut Client<Port>, found: &mut Found) -> Result<(), client::Error> {
    let trial = Trial::NONE.with(Function::Friction, TRIED).unwrap_or(Trial::NONE);
    port.from_now_on(|ask| ask.order = Some(Order::Try(trial)));
    client.set_gain(Function::Friction, TRIED)?;
    port.wait(SETTLED)?;
    found.expect("a gain is tried", client.gains()? == trial);
    port.from_now_on(|ask| ask.compares = false);
    port.wait(SILENCE)?;
    found.expect("silence ends it", client.gains()? == Trial::NONE);
    Ok(())
}

fn faulty(
    model: &Model,
    port: &Port,
    client: &mut Client<Port>,
    found: &mut Found,
) -> Result<(), client::Error> {
    let safe = |reading: &Reading| {
        reading.mode() == Mode::Safe && reading.faults().contains(Faults::MOTOR_ENCODER_LOST)
    };
    port.from_now_on(|ask| ask.encoder_fails = true);
    port.wait(FAULTY)?;
    found.expect("the encoder is lost", safe(&client.read()?) && port.drive() == RELEASED);
    if model.store.is_some() {
        kept(port, client, found)?;
    }
    client.reset()?;
    port.wait(FAULTY)?;
    found.expect("it is still lost", safe(&client.read()?) && port.drive() == RELEASED);
    port.from_now_on(|ask| ask.encoder_fails = false);
    client.reset()?;
    port.wait(SETTLED)?;
    let reading = client.read()?;
    found.expect("it is controlled again", reading.mode() == Mode::Active && port.drive().1);
    Ok(())
}

fn kept(port: &Port, client: &mut Client<Port>, found: &mut Found) -> Result<(), client::Error> {
    let learnt = client.learnt()?;
    client.erase()?;
    let asked = port.periods();
    found.expect("what was learnt is kept", client.keep()? == 1);
    found.kept_after = port.periods() - asked;
    let (number, stored) = client.stored()?;
    found.expect("it is stored", (number, stored.to_words()) == (1, learnt.to_words()));
    found.expect("the drive is still off", port.drive() == RELEASED);
    Ok(())
}

/// The host's program at a joint that has been at work before.
fn restarted(port: &Port, learnt: &Learnt<f32>, begins: &Learnt<f32>) -> Result<Found, client::Error> {
    let (mut client, mut found) = (Client::connect(port.clone(), PATIENCE)?, Found::default());
    found.expect("the store is sound", client.joint().store == StoreState::Sound);
    let (number, stored) = client.stored()?;
    found.expect("it is still stored", (number, stored.to_words()) == (2, learnt.to_words()));
    found.expect("the control begins with it", client.learnt()?.to_words() == begins.to_words());
    port.wait(SETTLED)?;
    found.expect("it is controlled with it", client.read()?.mode() == Mode::Active && port.drive().1);
    Ok(found)
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
        let conditions = Conditions { sensors: SensorSet::Motor, ..Conditions::of(self.gear, SEED) };
        let mut bench = Bench::condensed(self.gear, &conditions).map_err(RunError::from)?;
        let (end, program_end) = line();
        std::thread::scope(|scope| {
            let program = scope.spawn(move || program(&Port::open(program_end)));
            let mut booting = Booting { run: self, kept, end, beside: None };
            let task = Loaded(LOAD * self.gear.gear.rated_torque);
            let ended = bench.go(&task, &mut booting, |_, _, _, _| ());
            let Booting { end, beside, .. } = booting;
            // The program ends when the chip has.
            drop(end);
            let found = program.join().unwrap_or_else(|panic| resume_unwind(panic));
            if let Err(Ended::Failed(error)) = ended {
                return Err(error);
            }
            let never = || chip::Error::NotStarted { said: "no period was run".into() };
            let beside = beside.ok_or_else(never)?;
            Ok((found?, beside.agreement(), beside.chip.store()?))
        })
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

/// Why the plant stands still.
enum Ended {
    Program,
    Failed(Error),
}

impl From<RunError> for Ended {
    fn from(error: RunError) -> Self {
        Self::Failed(error.into())
    }
}

/// Boots the chip with the plant's first reading.
struct Booting<'a> {
    run: Run<'a>,
    kept: Option<&'a [u8]>,
    end: ChipEnd,
    beside: Option<Beside>,
}

impl Controller for Booting<'_> {
    type Error = Ended;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Ended> {
        let count = input.sensors.motor_encoder;
        let Some(ask) = self.end.ask() else { return Err(Ended::Program) };
        if self.beside.is_none() {
            self.beside = Some(Beside::boot(self.run, self.kept, count).map_err(Ended::Failed)?);
        }
        let Some(beside) = &mut self.beside else { return Err(Ended::Program) };
        let (drive, reading) = beside.step(count, &ask).map_err(|error| Ended::Failed(error.into()))?;
        self.end.show(Look { bytes: beside.chip.said(), drive, reading });
        let motor_torque = host::torque(drive, self.run.compensator.limits().motor_torque) as f32;
        Ok(Output { motor_torque, ..Output::default() })
    }
}

/// The chip as the plant's controller, the host's control beside it.
struct Beside {
    chip: Chip,
    shift: u32,
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

impl Beside {
    fn boot(run: Run, kept: Option<&[u8]>, count: u32) -> Result<Self, Error> {
        let chip = Chip::boot_with_store(run.model, run.elf, kept)?;
        let (chip, _) = started(chip, count << run.shift)?;
        let hosts = (0..=LATEST).map(|_| ServedHost::new(run.compensator)).collect();
        Ok(Self { chip, shift: run.shift, hosts, periods: 0, order: None })
    }

    /// Of the host that takes the order when the chip does.
    fn agreement(&self) -> Agreement {
        let different = self.hosts.iter().map(|host| host.host.different).min();
        Agreement { steps: self.periods, different: different.unwrap_or_default() }
    }

    /// The drive at the end of a period, and what the host says of it.
    fn step(&mut self, count: u32, ask: &Ask) -> Result<(Drive, Option<Reading>), chip::Error> {
        self.chip.magnet().answers(!ask.encoder_fails);
        self.chip.magnet().put(count << self.shift);
        self.chip.hears(&ask.bytes);
        self.chip.run(period())?;
        let drive = self.chip.drive()?;
        Ok((drive, ask.compares.then(|| self.compare(count, drive, ask)).flatten()))
    }

    fn compare(&mut self, count: u32, drive: Drive, ask: &Ask) -> Option<Reading> {
        self.order = ask.order.map(|order| (order, self.periods)).or(self.order);
        let mut first = None;
        for (after, ServedHost { host, joint }) in (0..).zip(&mut self.hosts) {
            let due = self.order.filter(|(_, since)| since + after == self.periods);
            joint.order(due.map_or(Order::Read, |(order, _)| order));
            host.compare(count, drive);
            let answer = joint.answer();
            if let (0, Some(Answer::Reading(reading))) = (after, answer) {
                first = Some(reading);
            }
        }
        self.periods += 1;
        first
    }
}

/// A flash in the memory of the host.
struct FlashImage(Vec<u8>);

impl ErrorType for FlashImage {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for FlashImage {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        bytes.copy_from_slice(&self.0[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for FlashImage {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 32;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        self.0[offset as usize..].iter_mut().zip(bytes).for_each(|(old, new)| *old &= new);
        Ok(())
    }
}
