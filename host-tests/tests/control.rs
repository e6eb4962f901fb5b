//! The application's control period, on a board that the test plays.

use std::cell::RefCell;
use std::rc::Rc;
use strainwave::compensator::{CompensationGains, Input, Output, Setpoint};
use strainwave_app::telemetry::CAPACITY;
use strainwave_app::{Board, Compensator, Control, Log, Telemetry, control_step, joint};

/// Events on the board, in order.
#[derive(Clone, Debug, PartialEq)]
enum Event {
    Commanded(f32),
    Reported(Output<f32>),
    Released,
    Fed,
}

/// A board whose inputs are given and whose events are kept.
#[derive(Clone, Default)]
struct Played {
    inputs: Rc<RefCell<Vec<Option<Input<f32>>>>>,
    events: Rc<RefCell<Vec<Event>>>,
    overruns: Rc<RefCell<bool>>,
}

impl Board for Played {
    const REPORT_EVERY: u32 = 1;

    fn input(&mut self, input: &mut Input<f32>) -> bool {
        let next = self.inputs.borrow_mut().remove(0);
        *input = next.unwrap_or_default();
        next.is_some()
    }
    fn command(&mut self, torque: f32) {
        self.events.borrow_mut().push(Event::Commanded(torque));
    }
    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        self.events.borrow_mut().push(Event::Reported(output()));
    }
    fn release(&mut self) {
        self.events.borrow_mut().push(Event::Released);
    }
    fn feed_watchdog(&mut self) {
        self.events.borrow_mut().push(Event::Fed);
    }
    fn overran(&mut self) -> bool {
        *self.overruns.borrow()
    }
}

fn control(board: &Played) -> (Control<Played>, Log) {
    // The queue lives as long as a firmware's would.
    let (sender, log) = Box::leak(Box::new(Telemetry::new())).split();
    (Control::new(board.clone(), compensator(), sender), log)
}

fn compensator() -> &'static Compensator {
    Compensator::from_words(&joint::WORDS).expect("the default joint is sound")
}

fn input(encoder: u32) -> Input<f32> {
    let mut input = Input::default();
    input.sensors.motor_encoder = encoder;
    input.command = Setpoint { velocity: 0.1, ..Setpoint::default() }.into();
    input.gains = CompensationGains { feedback: 1.0, ..CompensationGains::default() }.into();
    input
}

#[test]
fn a_period_is_fetch_step_store_then_the_watchdog() {
    let board = Played::default();
    let (mut control, _log) = control(&board);
    let compensator = compensator();
    let mut state = compensator.rest();
    for encoder in [0, 5_000, 9_000, 12_000] {
        board.inputs.borrow_mut().push(Some(input(encoder)));
        control.tick();
        let torque = control_step(compensator, &mut state, &input(encoder)).motor_torque;
        let expected = compensator.output(&state);
        let events = std::mem::take(&mut *board.events.borrow_mut());
        assert_eq!(events, [Event::Commanded(torque), Event::Reported(expected), Event::Fed]);
    }
}

#[test]
fn without_an_input_the_motor_is_released_and_nothing_is_reported() {
    let board = Played::default();
    let (mut control, mut log) = control(&board);
    board.inputs.borrow_mut().push(None);
    control.tick();
    assert_eq!(*board.events.borrow(), [Event::Released, Event::Fed]);
    assert_eq!(log.take(), None);
}

#[test]
fn each_step_is_reported_in_order() {
    let board = Played::default();
    let (mut control, mut log) = control(&board);
    for encoder in 0..5 {
        board.inputs.borrow_mut().push(Some(input(encoder)));
        *board.overruns.borrow_mut() = encoder >= 3;
        control.tick();
    }
    let records: Vec<_> = std::iter::from_fn(|| log.take()).collect();
    let seen: Vec<_> = records.iter().map(|r| (r.period, r.motor_encoder, r.overruns)).collect();
    assert_eq!(seen, [(0, 0, 0), (1, 1, 0), (2, 2, 0), (3, 3, 1), (4, 4, 2)]);
    assert_eq!(log.dropped(), 0);
}

#[test]
fn a_full_queue_drops_the_newest_and_counts_them() {
    let board = Played::default();
    let (mut control, mut log) = control(&board);
    let lost = 7;
    for encoder in 0..CAPACITY as u32 + lost {
        board.inputs.borrow_mut().push(Some(input(encoder)));
        control.tick();
    }
    assert_eq!(log.dropped(), lost);
    let kept: Vec<_> = std::iter::from_fn(|| log.take()).map(|record| record.motor_encoder).collect();
    assert_eq!(kept, (0..CAPACITY as u32).collect::<Vec<_>>());
}
