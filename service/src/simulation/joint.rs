//! A joint at rest behind a line: the compensator of the default gear, which takes an order in each period.

use std::collections::VecDeque;
use std::vec::Vec;

use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{ErrorType, Read, Write};
use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::words::{self, LAYOUT};
use strainwave::compensator::{CompensationGains, Compensator, Directions, Input, State, Status};

use crate::tuning::{Answer, Hello, Joint, Order, Reading, StoreState, Trial, TuningLink};

mod parameters {
    include!("../../../examples/joint/hd25_100.rs");
}

/// The compensator of the default gear.
///
/// # Panics
/// Never with the gear as it is.
pub fn default_joint() -> Compensator<f32> {
    parameters::JOINT.build().expect("the default gear can be built")
}

/// Bytes on their way in either direction.
#[derive(Debug, Default)]
pub struct Line {
    /// To the joint.
    pub there: VecDeque<u8>,
    /// From the joint.
    pub back: Vec<u8>,
    /// Bytes that the joint can still send.
    pub room: Option<usize>,
}

impl ErrorType for Line {
    type Error = embedded_hal_nb::serial::ErrorKind;
}

impl Read<u8> for Line {
    fn read(&mut self) -> nb::Result<u8, Self::Error> {
        self.there.pop_front().ok_or(nb::Error::WouldBlock)
    }
}

impl Write<u8> for Line {
    fn write(&mut self, byte: u8) -> nb::Result<(), Self::Error> {
        match &mut self.room {
            Some(0) => return Err(nb::Error::WouldBlock),
            Some(room) => *room -= 1,
            None => {}
        }
        self.back.push(byte);
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), Self::Error> {
        Ok(())
    }
}

/// The joint.
pub struct RestingJoint {
    compensator: Compensator<f32>,
    state: State<f32>,
    period: u32,
    order: Option<Order>,
    answer: Option<Answer>,
    /// What it stores.
    pub kept: Option<(u32, Learnt<f32>)>,
    /// The drive may be written under.
    pub may_write: bool,
    /// Its sensors give nothing: it takes no order.
    pub stands_still: bool,
    /// What its board reports with the next step.
    pub status: Status,
    /// Gains of its last step.
    pub gains: Directions<f32>,
    trial: Trial,
    /// Everything that it was made to do.
    pub did: Vec<Order>,
}

impl Default for RestingJoint {
    fn default() -> Self {
        let compensator = default_joint();
        let state = compensator.rest();
        Self {
            compensator,
            state,
            period: 0,
            order: None,
            answer: None,
            kept: None,
            may_write: true,
            stands_still: false,
            status: Status::FINE,
            gains: Directions::default(),
            trial: Trial::NONE,
            did: Vec::new(),
        }
    }
}

impl RestingJoint {
    /// A control period.
    pub fn step(&mut self) {
        self.period = self.period.wrapping_add(1);
        if self.stands_still {
            return;
        }
        self.gains =
            self.trial.in_place_of(CompensationGains { friction: 0.8, ..CompensationGains::ALL }.into());
        let status = std::mem::take(&mut self.status);
        let input = Input { gains: self.gains, status, ..Input::default() };
        let output = self.compensator.step(&mut self.state, &input);
        match self.order.take() {
            Some(Order::Read) => self.answer = Some(Answer::Reading(Reading::new(self.period, &output))),
            Some(Order::Learnt) => {
                self.answer = Some(Answer::Learnt(self.compensator.learnt(&self.state)));
            }
            Some(Order::Try(trial)) => self.trial = trial,
            Some(Order::Reset) => self.compensator.reset(&mut self.state),
            None => {}
        }
    }

    /// So many control periods, the link polled once in each.
    pub fn run(&mut self, link: &mut TuningLink, line: &mut Line, periods: u32) {
        for _ in 0..periods {
            self.step();
            link.poll(line, self);
        }
    }
}

impl Joint for RestingJoint {
    fn hello(&mut self) -> Hello {
        let store = if self.kept.is_some() { StoreState::Sound } else { StoreState::Empty };
        let joint = words::identity(&self.compensator.to_words());
        Hello { gear: Hello::name("hd25-100"), layout: LAYOUT, joint, rate: 10_000, store }
    }

    fn now(&self) -> u32 {
        self.period
    }

    fn order(&mut self, order: Order) -> bool {
        let free = self.order.is_none();
        if free {
            self.order = Some(order);
            self.did.push(order);
        }
        free
    }

    fn answer(&mut self) -> Option<Answer> {
        self.answer.take()
    }

    fn may_write(&self) -> bool {
        self.may_write
    }

    fn stored(&mut self) -> Result<(u32, Learnt<f32>), StoreState> {
        self.kept.ok_or(StoreState::Empty)
    }

    fn keep(&mut self, learnt: &Learnt<f32>) -> Result<u32, StoreState> {
        let number = self.kept.map_or(1, |(number, _)| number + 1);
        self.kept = Some((number, *learnt));
        Ok(number)
    }

    fn erase(&mut self) -> Result<(), StoreState> {
        self.kept = None;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tuning::frame::{Collector, Opened, Sealed};
    use crate::tuning::link::{FASTEST, PATIENCE, SILENCE};
    use crate::tuning::{Function, QUANTITIES, Refusal, Reply, Request};
    use strainwave::compensator::{Faults, Mode};

    /// A joint with its link, and the host's end of the line.
    #[derive(Default)]
    struct Bench {
        joint: RestingJoint,
        link: TuningLink,
        line: Line,
    }

    impl Bench {
        fn run(&mut self, periods: u32) -> Vec<(u8, Reply)> {
            self.joint.run(&mut self.link, &mut self.line, periods);
            let mut collector = Collector::default();
            let mut replies = Vec::new();
            for byte in self.line.back.drain(..) {
                if collector.take(byte) {
                    match collector.open() {
                        Opened::Message(id, reply) => replies.push((id, reply)),
                        other => panic!("{other:?}"),
                    }
                }
            }
            replies
        }

        fn sends(&mut self, frame: &Sealed) -> Vec<(u8, Reply)> {
            self.line.there.extend(frame.bytes());
            self.run(8)
        }

        /// The one reply to a request.
        fn asks(&mut self, request: Request) -> Reply {
            match self.sends(&Sealed::of(42, &request))[..] {
                [(42, reply)] => reply,
                ref replies => panic!("{request:?}: {replies:?}"),
            }
        }
    }

    #[test]
    fn every_request_has_its_reply() {
        let mut bench = Bench::default();
        assert_eq!(bench.asks(Request::Hello), Reply::Hello(bench.joint.hello()));
        let Reply::Reading(reading) = bench.asks(Request::Read) else { panic!("no reading") };
        assert_eq!((reading.mode(), reading.faults()), (Mode::Active, Faults::NONE));
        assert_eq!(reading.floats().len(), QUANTITIES.len());
        let Reply::Learnt(learnt) = bench.asks(Request::Learnt) else { panic!("nothing learnt") };
        assert_eq!(crate::tuning::link::learnt_of(&learnt), Learnt::default());
        assert_eq!(bench.asks(Request::Stored), Reply::Refused(Refusal::Store(StoreState::Empty)));
        assert_eq!(bench.asks(Request::Keep), Reply::Kept(1));
        assert_eq!(bench.asks(Request::Stored), Reply::Stored(1, learnt));
        assert_eq!(bench.asks(Request::Erase), Reply::Done);
        assert_eq!(bench.asks(Request::Reset), Reply::Done);
        assert!(bench.joint.did.contains(&Order::Reset) && bench.joint.kept.is_none());
    }

    #[test]
    fn a_quantity_is_found_by_its_name() {
        let mut bench = Bench::default();
        let Reply::Reading(reading) = bench.asks(Request::Read) else { panic!("no reading") };
        let of = |name: &str| QUANTITIES.iter().position(|(named, _)| *named == name).unwrap();
        assert_eq!(reading.floats()[of("inertia_factor")], 1.0);
        assert!(reading.floats()[of("torsion_deviation")] > 0.0);
        for (place, (name, _)) in QUANTITIES.iter().enumerate() {
            assert!(QUANTITIES[..place].iter().all(|(other, _)| other != name), "{name}");
        }
    }

    #[test]
    fn a_gain_is_tried_until_the_link_is_silent() {
        let mut bench = Bench::default();
        assert_eq!(bench.asks(Request::SetGain(Function::Friction, [0.25, 0.5])), Reply::Done);
        let Reply::Gains(trial) = bench.asks(Request::Gains) else { panic!("no gains") };
        assert_eq!(trial.of(Function::Friction), Some([0.25, 0.5]));
        bench.run(SILENCE - 20);
        assert_eq!((bench.joint.gains.forward.friction, bench.joint.gains.backward.friction), (0.25, 0.5));
        bench.run(20);
        assert_eq!((bench.joint.gains.forward.friction, bench.joint.gains.backward.friction), (0.8, 0.8));
        assert_eq!(*bench.link.trial(), Trial::NONE);
    }

    #[test]
    fn what_is_out_of_range_is_refused_and_changes_nothing() {
        let mut bench = Bench::default();
        for gain in [-1e-3, 1.001, f32::NAN, f32::INFINITY] {
            let refused = Reply::Refused(Refusal::OutOfRange);
            assert_eq!(bench.asks(Request::SetGain(Function::Inertia, [0.5, gain])), refused, "{gain}");
        }
        for every in 1..FASTEST {
            assert_eq!(bench.asks(Request::Stream(every)), Reply::Refused(Refusal::OutOfRange));
        }
        assert!(bench.joint.did.is_empty());
    }

    #[test]
    fn another_version_is_refused_and_changes_nothing() {
        let mut bench = Bench::default();
        let version = crate::tuning::VERSION + 1;
        let frame = Sealed::with_version(version, 9, &Request::SetGain(Function::Inertia, [0.5; 2]));
        assert_eq!(bench.sends(&frame), [(9, Reply::Refused(Refusal::Version))]);
        assert!(bench.joint.did.is_empty());
    }

    #[test]
    fn a_frame_with_any_bit_turned_is_dropped() {
        let frame = Sealed::of(1, &Request::SetGain(Function::Inertia, [0.5; 2]));
        for place in 0..frame.bytes().len() - 1 {
            for bit in 0..8 {
                let mut bench = Bench::default();
                let mut bytes = frame.bytes().to_vec();
                bytes[place] ^= 1 << bit;
                bench.line.there.extend(bytes);
                assert!(bench.run(8).is_empty() && bench.joint.did.is_empty(), "byte {place}, bit {bit}");
                // The next one is heard: a turned bit may have hidden the end of this one.
                bench.line.there.push_back(0);
                assert!(matches!(bench.asks(Request::Hello), Reply::Hello(_)));
            }
        }
    }

    #[test]
    fn the_store_is_not_written_while_the_drive_is_on() {
        let mut bench = Bench::default();
        bench.joint.may_write = false;
        for request in [Request::Keep, Request::Erase] {
            assert_eq!(bench.asks(request), Reply::Refused(Refusal::DriveOn));
        }
    }

    #[test]
    fn a_drive_that_is_switched_on_meanwhile_leaves_the_store_as_it_is() {
        let mut bench = Bench::default();
        bench.joint.stands_still = true;
        assert!(bench.sends(&Sealed::of(5, &Request::Keep)).is_empty());
        (bench.joint.stands_still, bench.joint.may_write) = (false, false);
        assert_eq!(bench.run(3), [(5, Reply::Refused(Refusal::DriveOn))]);
    }

    #[test]
    fn a_control_without_a_step_is_told() {
        let mut bench = Bench::default();
        bench.joint.stands_still = true;
        assert!(bench.sends(&Sealed::of(5, &Request::Read)).is_empty());
        assert_eq!(bench.run(PATIENCE), [(5, Reply::Refused(Refusal::NoStep))]);
        // Its order has not been taken yet.
        assert_eq!(bench.asks(Request::Read), Reply::Refused(Refusal::Busy));
        assert!(matches!(bench.asks(Request::Hello), Reply::Hello(_)));
    }

    #[test]
    fn a_stream_goes_on_until_the_host_ends_it_or_is_silent() {
        let mut bench = Bench::default();
        assert_eq!(bench.asks(Request::Stream(100)), Reply::Done);
        let readings = bench.run(5000);
        assert!((49..=51).contains(&readings.len()), "{}", readings.len());
        assert!(readings.iter().all(|(id, reply)| *id == 0 && matches!(reply, Reply::Reading(_))));
        bench.run(SILENCE - 5000);
        assert!(bench.run(1000).is_empty());
        bench.asks(Request::Stream(100));
        bench.asks(Request::Stream(0));
        assert!(bench.run(1000).is_empty());
    }

    #[test]
    fn readings_that_find_no_room_are_counted() {
        let mut bench = Bench::default();
        bench.asks(Request::Stream(20));
        bench.line.room = Some(0);
        bench.run(1010);
        bench.line.room = None;
        let left_out: Vec<_> = bench
            .run(200)
            .into_iter()
            .map(|(_, reply)| match reply {
                Reply::Reading(reading) => reading.left_out,
                other => panic!("{other:?}"),
            })
            .collect();
        assert!(left_out.len() > 5 && left_out.last().is_some_and(|count| (45..=50).contains(count)));
    }

    /// Sizes on the wire, as the book tells them.
    #[test]
    fn frames_have_their_sizes() {
        let length = |request: &Request| Sealed::of(1, request).bytes().len();
        assert_eq!(length(&Request::Read), 9);
        assert_eq!(length(&Request::SetGain(Function::Ripple, [0.5; 2])), 18);
        assert_eq!(length(&Request::Stream(10)), 11);
        let mut bench = Bench::default();
        let requests = [
            (Request::Hello, 46),
            (Request::Gains, 17),
            (Request::Read, 130),
            (Request::Learnt, 97),
            (Request::Keep, 13),
            (Request::Stored, 101),
            (Request::Reset, 9),
        ];
        for (request, expected) in requests {
            assert_eq!(Sealed::of(42, &bench.asks(request)).bytes().len(), expected, "{request:?}");
        }
    }

    /// So many bytes in a call: the longest frame and what follows it take several.
    #[test]
    fn a_call_takes_and_sends_a_bounded_number_of_bytes() {
        let mut bench = Bench::default();
        bench.line.there.extend(std::iter::repeat_n(1, 1000));
        for call in 1..=10 {
            bench.joint.run(&mut bench.link, &mut bench.line, 1);
            assert_eq!(bench.line.there.len(), 1000 - 64 * call);
        }
        bench.line.there.clear();
        bench.line.there.push_back(0);
        bench.line.there.extend(Sealed::of(1, &Request::Read).bytes());
        for _ in 0..8 {
            let before = bench.line.back.len();
            bench.joint.run(&mut bench.link, &mut bench.line, 1);
            assert!(bench.line.back.len() - before <= 64);
        }
        assert!(bench.line.back.len() > 64);
    }
}
