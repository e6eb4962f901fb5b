//! What a host does at the tuning link of a chip, and what it expects.
//!
//! ```text
//! watched     readings of a stream are those of the host's control, and so are all steps, while the joint is loaded
//! refused     gains out of range; on a chip that stands still while it writes its flash, Keep with the drive on
//! tried       a gain is in force in both controls, and again not after a second of silence
//! faulty      the encoder fails, the drive goes off, what was learnt is kept; a reset with the encoder back leads to control
//! restarted   the store holds what was kept, and the control begins with it
//! ```

use std::time::Duration;

use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::words::LEARNT_LAYOUT;
use strainwave::compensator::{Faults, Mode};
use strainwave_service::store::Owner;
use strainwave_service::tuning::client::{self, Client, Patience};
use strainwave_service::tuning::link::SILENCE;
use strainwave_service::tuning::{Function, Order, Reading, Refusal, StoreState, Trial};

use crate::chips::host::RELEASED;
use crate::chips::line::Port;
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
/// The tried gains of the friction's compensation, and such that are out of range.
const TRIED: [f32; 2] = [0.5, 0.25];
const OUT_OF_RANGE: [f32; 2] = [1.5, 0.5];

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

/// The host's program at a joint that has never been at work: what it found, and whose store the joint has.
///
/// # Errors
/// The client's.
pub fn tried_out(model: &Model, port: &Port) -> Result<(Found, Owner), client::Error> {
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
///
/// # Errors
/// The client's.
pub fn restarted(port: &Port, learnt: &Learnt<f32>, begins: &Learnt<f32>) -> Result<Found, client::Error> {
    let (mut client, mut found) = (Client::connect(port.clone(), PATIENCE)?, Found::default());
    found.expect("the store is sound", client.joint().store == StoreState::Sound);
    let (number, stored) = client.stored()?;
    found.expect("it is still stored", (number, stored.to_words()) == (2, learnt.to_words()));
    found.expect("the control begins with it", client.learnt()?.to_words() == begins.to_words());
    port.wait(SETTLED)?;
    found.expect("it is controlled with it", client.read()?.mode() == Mode::Active && port.drive().1);
    Ok(found)
}
