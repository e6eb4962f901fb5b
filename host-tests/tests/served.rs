//! A control that the tuning link serves, on a board that the test plays: orders reach the step, answers the host.

use std::cell::RefCell;
use std::rc::Rc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::{CompensationGains, Directions, Input, Mode, Output, Sensors, Status};
use strainwave_app::served::{Exchange, Served, ServedJoint};
use strainwave_app::{Board, Compensator, Control, Telemetry, joint};
use strainwave_service::simulation::flash::{Flash, PAGE};
use strainwave_service::simulation::joint::Line;
use strainwave_service::tuning::frame::{Collector, Opened, Sealed};
use strainwave_service::tuning::link::PATIENCE;
use strainwave_service::tuning::{Function, Refusal, Reply, Request, StoreState, TuningLink};

/// A board whose inputs are given and whose torques are kept.
#[derive(Clone, Default)]
struct Played {
    input: Rc<RefCell<Option<Input<f32>>>>,
    torques: Rc<RefCell<Vec<f32>>>,
    output: Rc<RefCell<Output<f32>>>,
}

impl Board for Played {
    const REPORT_EVERY: u32 = 1000;

    fn input(&mut self, input: &mut Input<f32>) -> bool {
        let next = *self.input.borrow();
        *input = next.unwrap_or_default();
        next.is_some()
    }
    fn command(&mut self, torque: f32) {
        self.torques.borrow_mut().push(torque);
    }
    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        *self.output.borrow_mut() = output();
    }
    fn release(&mut self) {}
    fn feed_watchdog(&mut self) {}
    fn overran(&mut self) -> bool {
        false
    }
}

fn control<B: Board>(board: B) -> Control<B> {
    let (sender, _) = Box::leak(Box::new(Telemetry::new())).split();
    let compensator = Compensator::from_words(&joint::WORDS).expect("the default joint is sound");
    Control::new(board, compensator, sender)
}

/// A motor that turns to and fro, with torque.
fn moving(period: usize) -> Input<f32> {
    let angle = 0.5 * (period as f64 * 1e-3).sin();
    let counts = (angle / std::f64::consts::TAU * 2f64.powi(19)).round() as i64;
    let motor_encoder = counts.rem_euclid(1 << 19) as u32;
    let sensors = Sensors { motor_encoder, motor_torque: 0.05, ..Sensors::default() };
    Input { sensors, gains: CompensationGains::ALL.into(), ..Input::default() }
}

/// The control with its link, and the host's end of the line.
struct Joint<'a> {
    board: Played,
    control: Control<Served<Played>>,
    served: ServedJoint<&'a mut Flash>,
    link: TuningLink,
    line: Line,
    period: usize,
}

fn flash() -> Flash {
    Flash::new(2, &[0xff], ChaCha8Rng::seed_from_u64(1))
}

impl<'a> Joint<'a> {
    fn new(flash: &'a mut Flash, writes_beside: bool) -> Self {
        let board = Played::default();
        let exchange: &'static Exchange = Box::leak(Box::new(Exchange::new()));
        let mut served = ServedJoint::new(exchange, Some((flash, 0..2 * PAGE as u32)), writes_beside);
        let mut control = control(Served::new(board.clone(), exchange));
        if let Some(learnt) = served.learnt_before() {
            control.start_from(&learnt);
        }
        Self { board, control, served, link: TuningLink::default(), line: Line::default(), period: 0 }
    }

    fn step(&mut self, input: Option<Input<f32>>) {
        *self.board.input.borrow_mut() = input;
        self.control.tick();
        self.period += 1;
        self.link.poll(&mut self.line, &mut self.served);
    }

    /// So many periods of the motion.
    fn run(&mut self, periods: usize) {
        for _ in 0..periods {
            self.step(Some(moving(self.period)));
        }
    }

    /// Sends a request and runs until it is answered.
    fn asks(&mut self, request: Request) -> Reply {
        self.line.there.extend(Sealed::of(42, &request).bytes());
        let mut collector = Collector::default();
        for _ in 0..2 * PATIENCE {
            self.run(1);
            for byte in self.line.back.drain(..) {
                if collector.take(byte) {
                    let Opened::Message(42, reply) = collector.open() else { panic!("{request:?}") };
                    return reply;
                }
            }
        }
        panic!("{request:?} is not answered")
    }
}

#[test]
fn a_reading_is_that_of_the_step() {
    let mut flash = flash();
    let mut joint = Joint::new(&mut flash, true);
    joint.run(20);
    let Reply::Reading(reading) = joint.asks(Request::Read) else { panic!("no reading") };
    // The reading was made two periods ago at most: run the same motion beside it.
    let mut other = self::flash();
    let mut beside = Joint::new(&mut other, true);
    beside.run(reading.period as usize);
    let output = *beside.board.output.borrow();
    assert_eq!(reading.output_position(), output.estimate.output_position);
    assert_eq!((reading.floats()[0], reading.mode()), (output.motor_torque, output.mode));
    assert!(output.motor_torque != 0.0 && reading.mode() == Mode::Active);
}

#[test]
fn a_tried_gain_goes_through_the_ramp_of_the_step() {
    let mut flash = flash();
    let mut joint = Joint::new(&mut flash, true);
    let begun = 20;
    joint.run(begun);
    assert_eq!(joint.asks(Request::SetGain(Function::Feedback, [0.25, 0.5])), Reply::Done);
    joint.run(80);
    let torques = joint.board.torques.borrow();
    // Those of a control whose board has these gains from a period on.
    let with = |feedback| CompensationGains { feedback, ..CompensationGains::ALL };
    let tried = Directions { forward: with(0.25), backward: with(0.5) };
    let torques_of = |first: usize| {
        let board = Played::default();
        let mut control = control(board.clone());
        for period in 0..torques.len() {
            let gains = if period < first { CompensationGains::ALL.into() } else { tried };
            *board.input.borrow_mut() = Some(Input { gains, ..moving(period) });
            control.tick();
        }
        board.torques.take()
    };
    assert!((begun..begun + 4).any(|first| torques_of(first) == *torques));
    assert_ne!(torques_of(torques.len()), *torques);
}

#[test]
fn a_reset_leads_out_of_safe() {
    let mut flash = flash();
    let mut joint = Joint::new(&mut flash, true);
    joint.run(10);
    joint.step(Some(Input { status: Status::RESTARTED, ..moving(joint.period) }));
    joint.run(10);
    assert_eq!(joint.board.output.borrow().mode, Mode::Safe);
    assert_eq!(joint.asks(Request::Reset), Reply::Done);
    joint.run(10);
    assert_eq!(joint.board.output.borrow().mode, Mode::Active);
}

#[test]
fn without_sensors_an_order_stays_and_is_told() {
    let mut flash = flash();
    let mut joint = Joint::new(&mut flash, true);
    joint.line.there.extend(Sealed::of(5, &Request::Read).bytes());
    for _ in 0..2 * PATIENCE {
        joint.step(None);
    }
    let expected = Sealed::of(5, &Reply::Refused(Refusal::NoStep));
    assert_eq!(joint.line.back, expected.bytes());
}

#[test]
fn what_is_kept_is_where_the_next_start_begins() {
    let mut flash = flash();
    let mut joint = Joint::new(&mut flash, true);
    assert_eq!(joint.asks(Request::Stored), Reply::Refused(Refusal::Store(StoreState::Empty)));
    let learnt = {
        let mut learnt = Learnt::<f32>::default();
        learnt.factors.inertia = 1.1;
        joint.control.start_from(&learnt);
        learnt
    };
    assert_eq!(joint.asks(Request::Keep), Reply::Kept(1));
    let Reply::Stored(1, words) = joint.asks(Request::Stored) else { panic!("nothing stored") };
    assert_eq!(words[0], learnt.factors.inertia);
    let Reply::Hello(hello) = joint.asks(Request::Hello) else { panic!("no hello") };
    assert_eq!((hello.store, hello.gear()), (StoreState::Sound, joint::GEAR));

    // The same flash after a restart.
    let mut again = Joint::new(&mut flash, true);
    let Reply::Learnt(words) = again.asks(Request::Learnt) else { panic!("nothing learnt") };
    assert_eq!(words[0], 1.1);
    assert_eq!(again.asks(Request::Erase), Reply::Done);
    assert_eq!(again.asks(Request::Stored), Reply::Refused(Refusal::Store(StoreState::Empty)));
}

#[test]
fn flash_that_holds_the_control_up_is_written_with_the_drive_off_only() {
    let mut flash = flash();
    let mut joint = Joint::new(&mut flash, false);
    joint.run(10);
    assert_eq!(joint.asks(Request::Keep), Reply::Refused(Refusal::DriveOn));
    joint.step(Some(Input { status: Status::RESTARTED, ..moving(joint.period) }));
    assert_eq!(joint.asks(Request::Keep), Reply::Kept(1));
}
