//! One control period: fetch, one call, store.

use crate::telemetry::{Record, Sender};
use crate::{Compensator, State};
use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{Commanded, Input, Output, Status};

/// Control periods in a second (Hz).
pub const RATE: u32 = (1.0 / CONTROL_PERIOD) as u32;

/// Interface of the control to a board, used once a period.
pub trait Board {
    /// Of how many steps one is reported: as many as the board's telemetry can carry.
    const REPORT_EVERY: u32;

    /// Sets `input` to sensors and setpoint of this period; false when the board has none that can be trusted.
    fn input(&mut self, input: &mut Input<f32>) -> bool;
    /// Puts a step's torque command to the motor (N m).
    fn command(&mut self, torque: f32);
    /// Reports all outputs of the step, computed on request only.
    fn report(&mut self, output: impl FnOnce() -> Output<f32>);
    /// What the step has learnt so far, computed on request only: for a board that stores it.
    fn learnt(&mut self, learnt: impl FnOnce() -> Learnt<f32>) {
        let _ = learnt;
    }
    /// Takes the torque off the motor: there is no input to control it with.
    fn release(&mut self);
    /// Tells the watchdog that this period was completed: the command is out, or the motor released.
    fn feed_watchdog(&mut self);
    /// Whether the next period has already begun.
    fn overran(&mut self) -> bool;
    /// The watchdog or a fault has restarted the controller: it begins in Safe.
    fn restarted(&self) -> bool {
        false
    }
    /// A request to leave Safe, once for each time.
    fn reset_requested(&mut self) -> bool {
        false
    }
    /// The control was reset: it begins from rest, wherever the joint is, and so does what gives it its setpoints.
    fn reset(&mut self) {}
}

/// Everything the control interrupt owns.
pub struct Control<B> {
    board: B,
    compensator: &'static Compensator,
    state: State,
    sender: Sender,
    /// Of this period: here and not on the interrupt's stack.
    input: Input<f32>,
    periods: u32,
    overruns: u32,
    /// Status of the next step.
    status: Status,
    /// Periods without an input since the last step.
    missed: u32,
}

impl<B: Board> Control<B> {
    /// The control of a joint at rest. Inlined, so that it is made where it stays and not on the stack.
    #[inline(always)]
    pub fn new(board: B, compensator: &'static Compensator, sender: Sender) -> Self {
        let status = if board.restarted() { Status::RESTARTED } else { Status::FINE };
        Self {
            board,
            compensator,
            state: compensator.rest(),
            sender,
            input: Input::default(),
            periods: 0,
            overruns: 0,
            status,
            missed: 0,
        }
    }

    /// Begins with what the joint has learnt before, in the place of nothing: before the first period.
    pub fn start_from(&mut self, learnt: &Learnt<f32>) {
        self.state = self.compensator.rest_with(learnt);
    }

    /// One period: called from the board's control interrupt, never blocks on telemetry.
    #[inline]
    pub fn tick(&mut self) {
        if self.board.reset_requested() {
            self.reset();
        }
        if self.board.input(&mut self.input) {
            self.control();
        } else {
            self.missed = self.missed.saturating_add(1);
            self.board.release();
        }
        self.board.feed_watchdog();
        self.periods = self.periods.wrapping_add(1);
    }

    /// A function of its own: the state at rest, which it makes, is not on the stack while the control step is.
    #[cold]
    #[inline(never)]
    fn reset(&mut self) {
        self.compensator.reset(&mut self.state);
        self.board.reset();
    }

    #[inline]
    fn control(&mut self) {
        let input = &mut self.input;
        input.status = input.status.with(self.status);
        if self.missed > 0 && input.elapsed == 0.0 {
            // Up to a second: far beyond what the control goes on from.
            input.elapsed = CONTROL_PERIOD as f32 * (self.missed.min(RATE) + 1) as f32;
        }
        self.missed = 0;
        let commanded = control_step(self.compensator, &mut self.state, input);
        if commanded.mode.drives() {
            self.board.command(commanded.motor_torque);
        } else {
            self.board.release();
        }
        self.report();
    }

    /// Reports the step.
    #[inline]
    fn report(&mut self) {
        self.answer();
        let overran = self.board.overran();
        self.overruns = self.overruns.saturating_add(u32::from(overran));
        self.status = if overran { Status::OVERRUN } else { Status::FINE };
        if self.periods.is_multiple_of(B::REPORT_EVERY) {
            self.record();
        }
    }

    /// The step's output to the board. A function of its own, as the record below: its frame is on the stack neither while the
    /// control step's is nor while that is.
    #[inline(never)]
    fn answer(&mut self) {
        self.board.report(|| self.compensator.output(&self.state));
        self.board.learnt(|| self.compensator.learnt(&self.state));
    }

    /// A record of the step to the telemetry.
    #[inline(never)]
    fn record(&mut self) {
        let output = self.compensator.output(&self.state);
        self.sender.send(Record::new(self.periods, self.overruns, &self.input, &output));
    }
}

/// The step that the budget counts: a symbol of its own in the linked image.
#[inline(never)]
#[cfg_attr(target_os = "none", unsafe(no_mangle))]
pub fn control_step(compensator: &Compensator, state: &mut State, input: &Input<f32>) -> Commanded<f32> {
    compensator.control(state, input)
}
