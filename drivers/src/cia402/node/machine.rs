//! State machine of the power: commands, faults, braking to a stop.
//!
//! ```text
//! not ready --joint ready--> switch on disabled
//! switch on disabled --shutdown--> ready to switch on --switch on--> switched on --enable operation--> operation enabled
//! operation enabled --disable operation--> switched on --shutdown--> ready to switch on
//! operation enabled --shutdown--> ready to switch on
//! operation enabled --disable voltage--> switch on disabled
//! operation enabled --quick stop--> quick stop active --at rest, too long, disable voltage--> switch on disabled
//! operation enabled --bus lost--> fault reaction active --at rest, too long--> fault
//! ready to switch on, switched on --disable voltage, quick stop, NMT state not operational--> switch on disabled
//! ready to switch on, switched on --joint not ready--> switch on disabled
//! switched on, the drive not powered yet --bus lost--> switch on disabled
//! any --fault of the joint--> fault --fault reset, joint ready without a fault--> switch on disabled
//! fault, of the bus only --fault reset--> switch on disabled
//! ```
//!
//! Enable operation in ready to switch on only switches on; the next controlword enables. Of a drive that is not powered yet it is awaited in
//! switched on that it is. Shutdown of a joint that is not ready leads
//! nowhere. The first fault is the one that is told until the reset, but the joint's own takes the place of one of the bus, with an
//! emergency message for both.
//!
//! Reference: CiA 402-2 (IEC 61800-7-201), section "Finite state automaton", its transitions by number in the code; quick stop option code 2.

use super::Actual;
use super::emergency::Emergencies;
use crate::cia402::state::{Command, FAULT_RESET, State};

/// Control periods in which the joint, once told to reset, has to be ready without a fault.
const RESET_PERIODS: u32 = 2000;

/// Bit 4 of the statusword.
const VOLTAGE_ENABLED: u16 = 1 << 4;
/// Bit 10 of the statusword.
const TARGET_REACHED: u16 = 1 << 10;

#[derive(Clone, Debug, PartialEq)]
enum Reset {
    Idle,
    /// By the master.
    Requested,
    /// By the joint, so many control periods ago.
    Taken(u32),
}

#[derive(Clone, Debug)]
pub(super) struct Machine {
    state: State,
    controlword: u16,
    /// Object 0x603f.
    error: u16,
    /// The error is one of the bus, not of the joint.
    of_bus: bool,
    emergencies: Emergencies,
    /// By the last values.
    ready: bool,
    powered: bool,
    /// Operation is to be enabled when the drive is powered.
    enabling: bool,
    /// Control periods since the joint began to brake.
    braking: u32,
    /// By the last values since the joint began to brake.
    at_rest: bool,
    reset: Reset,
}

impl Machine {
    pub(super) const fn new() -> Self {
        Self {
            state: State::NotReady,
            controlword: 0,
            error: 0,
            of_bus: false,
            emergencies: Emergencies::new(),
            ready: false,
            powered: false,
            enabling: false,
            braking: 0,
            at_rest: false,
            reset: Reset::Idle,
        }
    }

    pub(super) fn state(&self) -> State {
        self.state
    }

    pub(super) fn enabled(&self) -> bool {
        self.state == State::OperationEnabled
    }

    /// It awaits a powered drive.
    pub(super) fn enabling(&self) -> bool {
        self.enabling
    }

    pub(super) fn brakes(&self) -> bool {
        matches!(self.state, State::QuickStopActive | State::FaultReactionActive)
    }

    pub(super) fn controlword(&self) -> u16 {
        self.controlword
    }

    pub(super) fn error(&self) -> u16 {
        self.error
    }

    pub(super) fn take_emergency(&mut self) -> Option<u16> {
        self.emergencies.take()
    }

    pub(super) fn statusword(&self) -> u16 {
        let voltage = if self.state == State::NotReady { 0 } else { VOLTAGE_ENABLED };
        let stopped = self.state == State::QuickStopActive && self.at_rest;
        self.state.statusword() | voltage | if stopped { TARGET_REACHED } else { 0 }
    }

    /// Once a control period.
    pub(super) fn tick(&mut self, longest_stop: u32) {
        if self.brakes() {
            self.braking = self.braking.saturating_add(1);
            if self.at_rest || self.braking >= longest_stop {
                self.stopped();
            }
        }
        if let Reset::Taken(periods) = &mut self.reset {
            *periods = periods.saturating_add(1);
        }
    }

    /// Transitions 12 and 14.
    fn stopped(&mut self) {
        self.enter(match self.state {
            State::FaultReactionActive => State::Fault,
            _ => State::SwitchOnDisabled,
        });
    }

    /// A controlword takes effect.
    pub(super) fn command(&mut self, controlword: u16) {
        let rising = controlword & !self.controlword;
        self.controlword = controlword;
        if self.state == State::Fault && rising & FAULT_RESET != 0 {
            self.reset_fault();
        } else {
            self.obey(Command::of(controlword));
            self.require_ready();
        }
    }

    fn obey(&mut self, command: Command) {
        let next = after(self.state, command);
        self.enabling = next == State::OperationEnabled && self.state == State::SwitchedOn;
        if !self.enabling {
            self.enter(next);
        }
        self.enable();
    }

    /// Transition 4, of a powered drive.
    fn enable(&mut self) {
        if self.enabling && self.powered {
            self.enter(State::OperationEnabled);
        }
    }

    /// The joint has no part in a fault of the bus: it keeps what it knows, its position among it.
    fn reset_fault(&mut self) {
        if self.of_bus {
            self.leave_fault();
        } else {
            self.reset = Reset::Requested;
        }
    }

    /// Transition 15.
    fn leave_fault(&mut self) {
        self.report(0, false);
        self.enter(State::SwitchOnDisabled);
    }

    /// The joint's values: transitions 1, 13, 14 and 15.
    pub(super) fn read(&mut self, actual: &Actual) {
        (self.ready, self.powered, self.at_rest) = (actual.ready, actual.powered, actual.at_rest);
        if self.state == State::NotReady && self.ready {
            self.enter(State::SwitchOnDisabled);
        }
        self.require_ready();
        self.judge(actual.fault);
        self.judge_reset(actual.fault);
        self.enable();
    }

    fn judge(&mut self, fault: u16) {
        if fault != 0 && (self.state != State::Fault || self.of_bus) {
            self.report(fault, false);
            self.enter(State::Fault);
        }
    }

    fn require_ready(&mut self) {
        if !self.ready {
            self.unprepare();
        }
    }

    /// What the master prepared is forgotten.
    fn unprepare(&mut self) {
        if matches!(self.state, State::ReadyToSwitchOn | State::SwitchedOn) {
            self.enter(State::SwitchOnDisabled);
        }
    }

    fn judge_reset(&mut self, fault: u16) {
        let Reset::Taken(periods) = self.reset else { return };
        if fault == 0 && self.ready {
            self.leave_fault();
        } else if periods >= RESET_PERIODS {
            self.reset = Reset::Idle;
            // Another one than that which was to be reset.
            if fault != 0 && fault != self.error {
                self.report(fault, false);
            }
        }
    }

    /// The joint is to leave its fault: told once for each request.
    pub(super) fn take_reset(&mut self) -> bool {
        let requested = self.reset == Reset::Requested;
        if requested {
            self.reset = Reset::Taken(0);
        }
        requested
    }

    /// The bus is lost, for this error code: an enabled joint brakes, and no other is powered any more.
    pub(super) fn lose(&mut self, code: u16) {
        if self.enabled() {
            self.report(code, true);
            self.enter(State::FaultReactionActive);
        } else if self.enabling {
            self.unprepare();
        }
    }

    /// The NMT state is operational no more: what the master prepared is forgotten, an enabled joint brakes.
    pub(super) fn disconnect(&mut self, code: u16) {
        self.lose(code);
        self.unprepare();
    }

    /// Starts again with the joint's own fault only; a joint that may move brakes first.
    pub(super) fn restart(&mut self, fault: u16) {
        self.enter(match self.state {
            State::NotReady => State::NotReady,
            State::OperationEnabled | State::QuickStopActive | State::FaultReactionActive => {
                State::QuickStopActive
            }
            _ => State::SwitchOnDisabled,
        });
        (self.controlword, self.error, self.of_bus) = (0, 0, false);
        self.emergencies = Emergencies::new();
        self.judge(fault);
    }

    fn report(&mut self, code: u16, of_bus: bool) {
        (self.error, self.of_bus) = (code, of_bus);
        self.emergencies.push(code);
    }

    fn enter(&mut self, state: State) {
        if state == self.state {
            return;
        }
        // The longest stop is one, however often its reason changes.
        if !self.brakes() {
            (self.braking, self.at_rest) = (0, false);
        }
        (self.state, self.reset, self.enabling) = (state, Reset::Idle, false);
    }
}

/// The state after a command, by the numbers of the standard's transitions.
const fn after(state: State, command: Command) -> State {
    use Command::{DisableVoltage, EnableOperation, QuickStop, Shutdown, SwitchOn};
    use State::{OperationEnabled, QuickStopActive, ReadyToSwitchOn, SwitchOnDisabled, SwitchedOn};
    match (state, command) {
        // 2, 6, 8
        (SwitchOnDisabled | SwitchedOn | OperationEnabled, Shutdown) => ReadyToSwitchOn,
        // 3
        (ReadyToSwitchOn, SwitchOn | EnableOperation) => SwitchedOn,
        // 4
        (SwitchedOn, EnableOperation) => OperationEnabled,
        // 5
        (OperationEnabled, SwitchOn) => SwitchedOn,
        // 7, 10
        (ReadyToSwitchOn | SwitchedOn, QuickStop | DisableVoltage) => SwitchOnDisabled,
        // 9, 12
        (OperationEnabled | QuickStopActive, DisableVoltage) => SwitchOnDisabled,
        // 11
        (OperationEnabled, QuickStop) => QuickStopActive,
        _ => state,
    }
}
