//! The client against the joint's side of the link.

use std::collections::VecDeque;
use std::string::{String, ToString};

use strainwave::compensator::{Faults, Mode, Status};

use super::*;
use crate::simulation::host::HostEnd;
use crate::tuning::link::{FASTEST, SILENCE};
use crate::tuning::{StoreState, VERSION};

/// The simulated joint answers within some reads, each of which takes no time.
const PATIENCE: Patience =
    Patience { answer: Duration::from_millis(20), flash: Duration::from_millis(20), tries: 4 };

fn connected(end: HostEnd) -> Client<HostEnd> {
    Client::connect(end, PATIENCE).unwrap()
}

#[test]
fn every_request_is_answered() {
    let mut client = connected(HostEnd::default());
    assert_eq!(client.joint().gear(), "hd25-100");
    assert_eq!((client.joint().rate, client.joint().store), (10_000, StoreState::Empty));
    let reading = client.read().unwrap();
    assert_eq!((reading.mode(), reading.faults()), (Mode::Active, Faults::NONE));
    assert_eq!(client.learnt().unwrap(), Learnt::default());
    let empty = client.stored().unwrap_err();
    assert!(matches!(empty, Error::Refused { why: Refusal::Store(StoreState::Empty), .. }));
    assert_eq!(empty.to_string(), "the joint has refused \"stored\": nothing is stored");
    assert_eq!((client.keep().unwrap(), client.keep().unwrap()), (1, 2));
    assert_eq!(client.stored().unwrap(), (2, Learnt::default()));
    assert_eq!(client.hello().unwrap().store, StoreState::Sound);
    client.erase().unwrap();
    assert!(client.port.joint.kept.is_none());
    assert_eq!(client.counts().repeated, 0);
}

#[test]
fn gains_are_in_force_while_the_joint_hears_of_the_host() {
    let mut client = connected(HostEnd::default());
    client.set_gain(Function::Friction, [0.25, 0.5]).unwrap();
    client.set_gain(Function::Inertia, [0.5; 2]).unwrap();
    assert_eq!(client.gains().unwrap(), *client.trial());
    for _ in 0..3 {
        client.port.run(SILENCE / 2);
        client.asked -= QUIET;
        client.keep_alive().unwrap();
        let gains = client.port.joint.gains;
        assert_eq!(
            (gains.forward.friction, gains.backward.friction, gains.forward.inertia),
            (0.25, 0.5, 0.5)
        );
    }
    client.port.run(SILENCE);
    client.asked -= QUIET;
    assert!(matches!(client.keep_alive(), Err(Error::Lost)));
    assert_eq!(client.port.joint.gains.forward.friction, 0.8);
}

#[test]
fn gains_that_another_host_has_left_are_known() {
    let mut before = connected(HostEnd::default());
    before.set_gain(Function::Ripple, [0.5; 2]).unwrap();
    before.stream(FASTEST).unwrap();
    let mut client = connected(before.port);
    assert_eq!(client.trial().of(Function::Ripple), Some([0.5; 2]));
    assert_eq!(client.next_reading(Duration::from_millis(5)).unwrap(), None);
}

#[test]
fn what_is_refused_is_told_with_its_cause() {
    let mut client = connected(HostEnd::default());
    let told = |result: Result<(), Error>| match result {
        Err(Error::Refused { why, .. }) => why,
        other => panic!("{other:?}"),
    };
    assert_eq!(told(client.set_gain(Function::Friction, [0.5, 1.5])), Refusal::OutOfRange);
    assert_eq!(*client.trial(), Trial::NONE);
    assert_eq!(told(client.stream(FASTEST - 1)), Refusal::OutOfRange);
    client.port.joint.may_write = false;
    assert_eq!(told(client.erase()), Refusal::DriveOn);
    client.port.joint.stands_still = true;
    assert_eq!(told(client.read().map(drop)), Refusal::NoStep);
    // Its last order is still there; it is asked as often as one that does not answer.
    let before = client.counts().repeated;
    assert_eq!(told(client.read().map(drop)), Refusal::Busy);
    assert_eq!(client.counts().repeated - before, 3);
}

#[test]
fn a_reset_ends_safe() {
    let mut client = connected(HostEnd::default());
    client.port.joint.status = Status::RESTARTED;
    let reading = client.read().unwrap();
    assert!(reading.mode() == Mode::Safe && reading.faults().contains(Faults::RESTARTED));
    client.reset().unwrap();
    client.port.run(10);
    assert_eq!(client.read().unwrap().mode(), Mode::Active);
}

#[test]
fn a_stream_comes_beside_other_requests() {
    let mut client = connected(HostEnd::default());
    client.stream(20).unwrap();
    let mut readings = Vec::new();
    for number in 0..200 {
        readings.extend(client.next_reading(Duration::from_millis(20)).unwrap());
        if number % 10 == 0 {
            client.gains().unwrap();
        }
    }
    assert_eq!(readings.len(), 200);
    assert!(readings.windows(2).all(|pair| pair[0].period < pair[1].period));
    // A reading every 20 periods, but for those in whose place another reply was sent.
    let periods = readings[199].period - readings[0].period;
    assert!((199 * 20..240 * 20).contains(&periods), "{periods}");
}

/// With one byte of 300 lost and one of 300 damaged more than half of the readings do not come through at once.
#[test]
fn a_noisy_line_takes_longer() {
    let patience = Patience { tries: 30, ..PATIENCE };
    let mut client = Client::connect(HostEnd::noisy(1.0 / 300.0, 1.0 / 300.0, 1), patience).unwrap();
    for number in 0..50 {
        let gain = number as f32 / 50.0;
        client.set_gain(Function::Friction, [gain, 1.0 - gain]).unwrap();
        assert_eq!((client.gains().unwrap(), *client.port.link.trial()), (client.trial, client.trial));
        client.read().unwrap();
    }
    let Counts { requests, repeated, damaged } = client.counts();
    assert!((20..200).contains(&repeated) && damaged > 10, "{requests} {repeated} {damaged}");
}

#[test]
fn a_joint_that_is_silent_is_given_up() {
    let mut end = HostEnd::default();
    end.cut = true;
    let begun = Instant::now();
    let Err(error) = Client::connect(end, PATIENCE) else { panic!("nobody has answered") };
    assert!(begun.elapsed() >= 4 * PATIENCE.answer);
    assert!(
        error.to_string().starts_with("no answer to \"hello\", sent 4 times with 0.02 s each: "),
        "{error}"
    );
}

/// A port with fixed bytes to be read.
#[derive(Debug)]
struct Fixed(VecDeque<u8>);

impl Read for Fixed {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.read(bytes)
    }
}

impl Write for Fixed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn error_on(bytes: &[u8]) -> String {
    Client::connect(Fixed(bytes.iter().copied().collect()), PATIENCE).unwrap_err().to_string()
}

#[test]
fn another_version_is_told() {
    let refused = Sealed::with_version(VERSION + 1, 1, &Reply::Refused(Refusal::Version));
    let expected = "the joint has version 2 of the tuning link, this program has version 1";
    assert_eq!(error_on(refused.bytes()), expected);
}

#[test]
fn a_port_that_is_closed_and_another_reply_are_told() {
    assert_eq!(error_on(&[]), "the connection failed: the other end has closed it");
    // What is no frame is dropped.
    let expected = "the connection failed: the other end has closed it";
    assert_eq!(error_on(b"\0login: \0\0\x05abc\0"), expected);
    let other = Sealed::of(1, &Reply::Done);
    assert_eq!(error_on(other.bytes()), "the joint has answered \"hello\" with the reply to another request");
    // The reply to a request that was given up is not taken for this one's.
    assert_eq!(error_on(Sealed::of(9, &Reply::Done).bytes()), expected);
}
