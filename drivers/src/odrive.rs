//! ODrive: a drive on classic CAN that takes a torque (CANSimple, torque control with passed-through input).
//!
//! ```text
//! identifier = node * 32 + command
//! to the drive    0x18 Clear_Errors          u8  0
//!                 0x0b Set_Controller_Mode   u32 1, torque control; u32 1, passthrough
//!                 0x07 Set_Axis_State        u32 1, idle, or 8, closed-loop control
//!                 0x0e Set_Input_Torque      f32 torque (N m)
//! from the drive  0x01 Heartbeat             u32 active errors, u8 axis state, u8 procedure result, u8 trajectory done, -
//!                 0x03 Get_Error             u32 active errors, u32 why it was disarmed
//!                 0x09 Get_Encoder_Estimates f32 position (revolutions), f32 velocity (revolutions/s)
//!                 0x1c Get_Torques           f32 target, f32 estimate (N m)
//! ```
//!
//! Little-endian. The drive is configured once: calibrated, without start-up procedures, its watchdog on, and Heartbeat, Get_Encoder_Estimates and
//! Get_Torques sent more often than the time-out (`<axis>.config.can.heartbeat_msg_rate_ms`, `encoder_msg_rate_ms`, `torques_msg_rate_ms`);
//! Get_Error (`error_msg_rate_ms`) only tells why it was disarmed. Firmware 0.6: that of 0.5 has no Get_Torques, and another message in the place
//! of Get_Error. Where the estimates are not needed ([`Params::estimates`]), Heartbeat alone is, and both firmwares have it.
//!
//! Axis states, and what leads on:
//!
//! ```text
//! any other --Set_Axis_State 1--> idle (1)
//! idle (1) --Clear_Errors, Set_Controller_Mode, Set_Input_Torque 0, Set_Axis_State 8, one a cycle--> closed-loop control (8): torque
//! ```
//!
//! The four are sent once for a reset. A closed loop that was not asked for here is left first: its controller mode is not known, and is to be
//! changed in idle only.
//!
//! Safe is: Set_Axis_State 1 and, in turn with it, Set_Input_Torque 0, which feeds the drive's watchdog, until [`Drive::reset`]. (Estop does the
//! same, and leaves an error behind.) [`Drive::disable`] leads there, and it is entered by name
//! ([`Cause`]) when the drive reports an error or leaves closed-loop control by itself, when it is not in closed-loop control in time, and when no
//! heartbeat, or no estimates of position and torque, have come for the time-out. A torque is sent in closed-loop control only, and none that is
//! not a number. Position and torque are those of the motor.
//!
//! Reference: ODrive documentation, "CAN Protocol" (docs.odriverobotics.com/v/latest/manual/can-protocol.html);
//! odriverobotics/ODriveArduino at f52eef5d, `src/can_simple_messages.hpp` and `src/ODriveEnums.h`; lengths as in odriverobotics/ros_odrive at
//! 8ed510b1, `odrive_node/src/odrive_can_node.cpp`.

use core::mem::take;

use embedded_can::{Frame, StandardId};

pub use crate::drive::{Cause, Feedback};
use crate::drive::{Guard, standard_id};

/// Address, limit and time-outs.
#[derive(Clone, Copy, Debug)]
pub struct Params {
    /// Node, 0 to 62; 63 is the broadcast.
    pub node: u8,
    /// The largest torque that is commanded (N m).
    pub peak_torque: f32,
    /// Cycles without heartbeat or without estimates after which the drive is taken for lost.
    pub timeout: u32,
    /// Cycles that the drive has from the reset's first frame until it is in closed-loop control, more than 4.
    pub enabling: u32,
    /// The drive has to send its estimates of position and torque; else heartbeats do.
    pub estimates: bool,
}

impl Params {
    /// The drive, safe until [`Drive::reset`].
    ///
    /// `None` when the node is above 62, the peak torque is not positive and finite, or there is no time-out or no time for enabling.
    pub fn build(&self) -> Option<Drive> {
        let Self { node, peak_torque, timeout, enabling, estimates: needs_estimates } = *self;
        let guard = Guard::new(peak_torque, timeout, [Cause::HeartbeatLost, Cause::StatusLost])?;
        (node <= 62 && enabling > REQUESTED + 1).then(|| Drive {
            node: u16::from(node) << 5,
            enabling,
            needs_estimates,
            state: None,
            errors: Errors::default(),
            estimates: None,
            torque: None,
            safe: 0,
            clears: false,
            guard,
        })
    }
}

/// State of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Without torque.
    Idle,
    /// It follows the torque.
    ClosedLoopControl,
    /// One that nobody here has asked for.
    Other(u8),
}

impl State {
    /// The state that a heartbeat tells.
    pub const fn of(state: u8) -> Self {
        match state {
            1 => Self::Idle,
            8 => Self::ClosedLoopControl,
            other => Self::Other(other),
        }
    }
}

/// Errors as bits, `ODriveError` of the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Errors {
    /// Those that are there now.
    pub active: u32,
    /// Those that have taken the torque off; 0 where the drive does not send Get_Error.
    pub disarm_reason: u32,
}

const HEARTBEAT: u16 = 0x01;
const GET_ERROR: u16 = 0x03;
const SET_AXIS_STATE: u16 = 0x07;
const GET_ENCODER_ESTIMATES: u16 = 0x09;
const SET_CONTROLLER_MODE: u16 = 0x0b;
const SET_INPUT_TORQUE: u16 = 0x0e;
const CLEAR_ERRORS: u16 = 0x18;
const GET_TORQUES: u16 = 0x1c;

const IDLE: u32 = 1;
const CLOSED_LOOP_CONTROL: u32 = 8;
/// Torque control, passthrough.
const TORQUE_PASSTHROUGH: [u8; 8] = [1, 0, 0, 0, 1, 0, 0, 0];

/// Cycles from the first frame of enabling to the one that asks for closed-loop control.
const REQUESTED: u32 = 3;

/// The drive as the board sees it.
#[derive(Clone, Debug)]
pub struct Drive {
    /// The first identifier of its node.
    node: u16,
    enabling: u32,
    needs_estimates: bool,
    state: Option<State>,
    errors: Errors,
    /// Position and velocity, torque: of this pair, if it has come.
    estimates: Option<(f32, f32)>,
    torque: Option<f32>,
    /// Cycles since the drive is to be idle.
    safe: u32,
    /// Errors are to be cleared in idle.
    clears: bool,
    guard: Guard<2>,
}

impl Drive {
    /// State by the last heartbeat since the last reset.
    pub fn state(&self) -> Option<State> {
        self.state
    }

    /// Why there is no torque, if the drive is safe.
    pub fn cause(&self) -> Option<Cause> {
        self.guard.cause()
    }

    /// Errors as last told.
    pub fn errors(&self) -> Errors {
        self.errors
    }

    /// The drive follows the torque.
    pub fn is_enabled(&self) -> bool {
        self.guard.drives()
    }

    /// What is missing for longer than the time-out, in the safe state too.
    pub fn lost(&self) -> Option<Cause> {
        self.guard.lost()
    }

    /// Goes to safe, without a fault.
    pub fn disable(&mut self) {
        self.guard.disable();
    }

    /// Errors of a drive that is safe are to be cleared: what it has told before does not count any more.
    pub fn clear(&mut self) {
        (self.state, self.errors, self.clears) = (None, Errors::default(), true);
    }

    /// Leaves safe: errors are cleared and the drive enabled, step by step.
    pub fn reset(&mut self) {
        // One from before may have been left by the safe frames since.
        self.state = None;
        self.guard.reset();
    }

    /// Takes a frame from the bus; what the drive measures, once estimates of position and of torque have both come. Frames of others are left
    /// alone.
    pub fn receive(&mut self, frame: &impl Frame) -> Option<Feedback> {
        let command = standard_id(frame)?.checked_sub(self.node)?;
        let &[a0, a1, a2, a3, b0, b1, b2, b3] = frame.data() else { return None };
        let (first, second) = ([a0, a1, a2, a3], [b0, b1, b2, b3]);
        match command {
            HEARTBEAT => self.heartbeat(u32::from_le_bytes(first), State::of(b0)),
            GET_ERROR => {
                self.errors =
                    Errors { active: u32::from_le_bytes(first), disarm_reason: u32::from_le_bytes(second) };
            }
            GET_ENCODER_ESTIMATES => {
                self.estimates = Some((f32::from_le_bytes(first), f32::from_le_bytes(second)));
            }
            GET_TORQUES => self.torque = Some(f32::from_le_bytes(second)),
            _ => {}
        }
        self.feedback()
    }

    fn heartbeat(&mut self, active: u32, state: State) {
        self.errors.active = active;
        self.state = Some(state);
        self.guard.heard(Cause::HeartbeatLost);
        if !self.needs_estimates {
            self.guard.heard(Cause::StatusLost);
        }
        let requested = self.guard.attempted() >= Some(REQUESTED);
        self.guard.status(match (active, state) {
            (0, State::ClosedLoopControl) if requested => Ok(()),
            (0, _) => Err(Cause::Disabled),
            _ => Err(Cause::DriveFault),
        });
    }

    /// Of a whole pair, which is taken; not of one that is no number.
    fn feedback(&mut self) -> Option<Feedback> {
        let ((position, velocity), torque) = self.estimates.zip(self.torque)?;
        (self.estimates, self.torque) = (None, None);
        let feedback = Feedback::new(position, velocity, torque)?;
        self.guard.heard(Cause::StatusLost);
        Some(feedback)
    }

    /// Once a cycle of the bus: the frame that commands a torque (N m), or what leads there.
    ///
    /// `None` only when the frame's type holds no 8 bytes.
    pub fn step<F: Frame>(&mut self, torque: f32) -> Option<F> {
        self.guard.cycle();
        let since_idle = if self.guard.drives() { Some(u32::MAX) } else { self.since_idle() };
        self.safe = if since_idle.is_none() { self.safe.wrapping_add(1) } else { 0 };
        match since_idle {
            Some(0) => self.frame(CLEAR_ERRORS, &[0]),
            Some(1) => self.frame(SET_CONTROLLER_MODE, &TORQUE_PASSTHROUGH),
            Some(REQUESTED) => self.frame(SET_AXIS_STATE, &CLOSED_LOOP_CONTROL.to_le_bytes()),
            // 0 before it is enabled.
            Some(_) => self.input_torque(torque),
            None => self.idle(),
        }
    }

    /// Idle first.
    fn idle<F: Frame>(&mut self) -> Option<F> {
        match self.safe % 2 {
            1 => self.frame(SET_AXIS_STATE, &IDLE.to_le_bytes()),
            _ if take(&mut self.clears) => self.frame(CLEAR_ERRORS, &[0]),
            _ => self.input_torque(0.0),
        }
    }

    /// Cycles since enabling began, which is in idle; `None` before, and in the safe state.
    fn since_idle(&mut self) -> Option<u32> {
        if self.guard.attempted().is_none() && self.state != Some(State::Idle) {
            return None;
        }
        let failed = if self.errors.active == 0 { Cause::Refused } else { Cause::DriveFault };
        self.guard.attempt(self.enabling, failed)
    }

    fn input_torque<F: Frame>(&self, torque: f32) -> Option<F> {
        self.frame(SET_INPUT_TORQUE, &self.guard.torque(torque).to_le_bytes())
    }

    fn frame<F: Frame>(&self, command: u16, data: &[u8]) -> Option<F> {
        F::new(StandardId::new(self.node + command)?, data)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Sent, frame};
    use embedded_can::Id;
    use proptest::prelude::*;

    const PARAMS: Params = Params { node: 5, peak_torque: 2.5, timeout: 10, enabling: 20, estimates: true };
    /// The first identifier of node 5.
    const NODE: u16 = 0xa0;

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Command {
        Clear,
        Mode,
        Request,
        Idle,
        Torque(f32),
    }

    fn heartbeat(active: u32, state: u8) -> Sent {
        frame(NODE + 0x01, &[&active.to_le_bytes()[..], &[state, 0, 0, 0]].concat())
    }

    fn pair(command: u16, first: f32, second: f32) -> Sent {
        frame(NODE + command, &[first.to_le_bytes(), second.to_le_bytes()].concat())
    }

    fn sent(drive: &mut Drive, torque: f32) -> Command {
        let Sent(id, data) = drive.step(torque).unwrap();
        let Id::Standard(id) = id else { panic!("{id:?}") };
        match (id.as_raw() - NODE, &data[..]) {
            (0x18, [0]) => Command::Clear,
            (0x0b, [1, 0, 0, 0, 1, 0, 0, 0]) => Command::Mode,
            (0x07, [8, 0, 0, 0]) => Command::Request,
            (0x07, [1, 0, 0, 0]) => Command::Idle,
            (0x0e, &[t0, t1, t2, t3]) => Command::Torque(f32::from_le_bytes([t0, t1, t2, t3])),
            other => panic!("{other:02x?}"),
        }
    }

    fn measures(drive: &mut Drive) {
        drive.receive(&pair(0x09, -1.25, 0.5));
        drive.receive(&pair(0x1c, 0.0, 0.75));
    }

    /// One period in which the drive has this state, without errors: what is sent.
    fn period(drive: &mut Drive, state: u8, torque: f32) -> Command {
        measures(drive);
        drive.receive(&heartbeat(0, state));
        sent(drive, torque)
    }

    fn reset() -> Drive {
        let mut drive = PARAMS.build().unwrap();
        drive.reset();
        drive
    }

    fn enabled() -> Drive {
        let mut drive = reset();
        for state in [1, 1, 1, 1, 8] {
            period(&mut drive, state, 1.0);
        }
        assert_eq!((drive.state(), drive.cause()), (Some(State::ClosedLoopControl), None));
        drive
    }

    /// The next two frames are the safe ones.
    fn is_safe(drive: &mut Drive) -> bool {
        [sent(drive, 1.0), sent(drive, 1.0)] == [Command::Idle, Command::Torque(0.0)]
    }

    #[test]
    fn identifiers_are_those_of_the_documentation() {
        // "An Axis ID of 0x01 with a command of 0x0C would result in 0x2C": docs/can-protocol.rst of odriverobotics/ODrive.
        let drive = Params { node: 1, ..PARAMS }.build().unwrap();
        assert_eq!(drive.frame(0x0c, &[]), Some(frame(0x2c, &[])));
        // Closed-loop control is asked for with struct.pack('<I', 8): examples/can_simple.py of odriverobotics/ODriveResources.
        let request = drive.frame(SET_AXIS_STATE, &CLOSED_LOOP_CONTROL.to_le_bytes());
        assert_eq!(request, Some(frame(0x27, &[8, 0, 0, 0])));
    }

    #[test]
    fn it_is_enabled_step_by_step_and_only_then_driven() {
        let mut drive = PARAMS.build().unwrap();
        assert_eq!(period(&mut drive, 1, 1.0), Command::Idle);
        assert_eq!(period(&mut drive, 1, 1.0), Command::Torque(0.0));
        assert_eq!(drive.cause(), Some(Cause::NotStarted));
        drive.reset();
        assert_eq!(sent(&mut drive, 1.0), Command::Idle);
        for command in [Command::Clear, Command::Mode, Command::Torque(0.0), Command::Request] {
            assert_eq!(period(&mut drive, 1, 1.0), command);
        }
        // The request is not repeated: it may be under way.
        assert_eq!(period(&mut drive, 1, 1.0), Command::Torque(0.0));
        assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(1.0));
        assert_eq!(period(&mut drive, 8, -9.0), Command::Torque(-2.5));
        assert_eq!(period(&mut drive, 8, f32::INFINITY), Command::Torque(2.5));
        assert_eq!(period(&mut drive, 8, f32::NAN), Command::Torque(0.0));
    }

    #[test]
    fn a_state_that_was_left_behind_is_left_first() {
        for state in [3, 8, 11, 99] {
            let mut drive = reset();
            assert_eq!(period(&mut drive, state, 1.0), Command::Idle);
            assert_eq!(period(&mut drive, state, 1.0), Command::Torque(0.0));
            assert_eq!(period(&mut drive, 1, 1.0), Command::Clear);
            // Not the closed loop that was asked for.
            for command in [Command::Mode, Command::Torque(0.0), Command::Request] {
                assert_eq!(period(&mut drive, 8, 1.0), command);
            }
            assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(1.0));
            assert_eq!(drive.cause(), None);
        }
    }

    #[test]
    fn errors_are_cleared_once_and_named_when_they_stay() {
        for (active, cause) in [(0, Cause::Refused), (0x0400_0000, Cause::DriveFault)] {
            let mut drive = reset();
            for cycle in 0..=PARAMS.enabling {
                assert_eq!(drive.cause(), None);
                measures(&mut drive);
                drive.receive(&heartbeat(active, 1));
                let command = sent(&mut drive, 1.0);
                assert_eq!(command == Command::Clear, cycle == 0);
                assert_eq!(command == Command::Request, cycle == 3);
            }
            assert_eq!(drive.cause(), Some(cause));
            assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(0.0));
        }
    }

    #[test]
    fn what_the_drive_does_by_itself_makes_safe_until_a_reset() {
        for (active, state, cause) in [
            (0, 1, Cause::Disabled),
            (0, 3, Cause::Disabled),
            (0x0100_0000, 1, Cause::DriveFault),
            (0x0000_0200, 8, Cause::DriveFault),
        ] {
            let mut drive = enabled();
            drive.receive(&heartbeat(active, state));
            assert_eq!(drive.errors(), Errors { active, disarm_reason: 0 });
            assert_eq!(sent(&mut drive, 1.0), Command::Idle);
            assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(0.0));
            assert_eq!(period(&mut drive, 8, 1.0), Command::Idle);
            assert_eq!(drive.cause(), Some(cause), "{active:#x} {state}");
        }
    }

    #[test]
    fn why_it_was_disarmed_is_told() {
        let mut drive = enabled();
        drive.receive(&frame(NODE + 0x03, &[0, 0, 0, 0, 0, 0, 0, 0x04]));
        assert_eq!(drive.errors(), Errors { active: 0, disarm_reason: 0x0400_0000 });
        assert_eq!(period(&mut drive, 1, 1.0), Command::Idle);
        assert_eq!(drive.cause(), Some(Cause::Disabled));
    }

    #[test]
    fn silence_is_noticed_after_the_timeout_and_not_before() {
        let estimates = pair(0x09, -1.25, 0.5);
        let torques = pair(0x1c, 0.0, 0.75);
        let silent = |heard: &[&Sent], cause| {
            let mut drive = enabled();
            let hear = |drive: &mut Drive| {
                for frame in heard {
                    drive.receive(*frame);
                }
            };
            for _ in 1..PARAMS.timeout {
                hear(&mut drive);
                assert_eq!(sent(&mut drive, 1.0), Command::Torque(1.0));
            }
            hear(&mut drive);
            assert_eq!(sent(&mut drive, 1.0), Command::Idle);
            assert_eq!(drive.cause(), Some(cause));
        };
        let alive = heartbeat(0, 8);
        silent(&[&estimates, &torques], Cause::HeartbeatLost);
        silent(&[&alive], Cause::StatusLost);
        silent(&[&alive, &estimates], Cause::StatusLost);
        silent(&[&alive, &torques], Cause::StatusLost);
        silent(&[&alive, &torques, &pair(0x09, f32::NAN, 0.0)], Cause::StatusLost);
        silent(&[&alive, &torques, &frame(0xc9, &[0; 8])], Cause::StatusLost);
    }

    #[test]
    fn a_drive_of_heartbeats_alone_needs_no_estimates() {
        let mut drive = Params { estimates: false, ..PARAMS }.build().unwrap();
        drive.reset();
        for state in [1, 1, 1, 1, 8] {
            drive.receive(&heartbeat(0, state));
            sent(&mut drive, 1.0);
        }
        for _ in 0..3 * PARAMS.timeout {
            drive.receive(&heartbeat(0, 8));
            assert_eq!(sent(&mut drive, 1.0), Command::Torque(1.0));
        }
        (1..PARAMS.timeout).for_each(|_| _ = sent(&mut drive, 1.0));
        assert_eq!((drive.cause(), drive.lost()), (None, None));
        assert_eq!(sent(&mut drive, 1.0), Command::Idle);
        assert_eq!((drive.cause(), drive.lost()), (Some(Cause::HeartbeatLost), Some(Cause::HeartbeatLost)));
    }

    #[test]
    fn it_is_disabled_without_a_fault_and_enabled_again() {
        let mut drive = enabled();
        assert!(drive.is_enabled());
        drive.disable();
        assert!(!drive.is_enabled() && is_safe(&mut drive) && is_safe(&mut drive));
        assert_eq!(drive.cause(), Some(Cause::NotStarted));
        drive.reset();
        // What was told before may be from before the last frames.
        assert_eq!(sent(&mut drive, 1.0), Command::Idle);
        for command in [Command::Clear, Command::Mode, Command::Torque(0.0), Command::Request] {
            assert_eq!(period(&mut drive, 1, 1.0), command);
        }
        assert_eq!(period(&mut drive, 8, 1.0), Command::Torque(1.0));
    }

    #[test]
    fn errors_are_cleared_in_the_safe_state_when_that_is_asked_for() {
        let mut drive = PARAMS.build().unwrap();
        drive.receive(&heartbeat(0x40, 1));
        assert_eq!(drive.errors().active, 0x40);
        drive.clear();
        assert_eq!((drive.errors(), drive.state()), (Errors::default(), None));
        assert_eq!([sent(&mut drive, 1.0), sent(&mut drive, 1.0)], [Command::Idle, Command::Clear]);
        assert!(is_safe(&mut drive));
    }

    #[test]
    fn what_it_measures_is_told_in_whole_pairs() {
        let mut drive = PARAMS.build().unwrap();
        let feedback = Feedback { position: -1.25, velocity: 0.5, torque: 0.75 };
        assert_eq!(drive.receive(&pair(0x09, -1.25, 0.5)), None);
        assert_eq!(drive.receive(&pair(0x1c, 9.0, 0.75)), Some(feedback));
        assert_eq!(drive.receive(&pair(0x1c, 9.0, 0.75)), None);
        assert_eq!(drive.receive(&frame(NODE + 0x09, &[0; 4])), None);
        assert_eq!(drive.receive(&frame(0x001, &[0; 8])), None);
        assert_eq!(drive.receive(&pair(0x09, -1.25, 0.5)), Some(feedback));
    }

    #[test]
    fn parameters_out_of_range_build_no_drive() {
        let bad = [
            Params { node: 63, ..PARAMS },
            Params { peak_torque: f32::NAN, ..PARAMS },
            Params { timeout: 0, ..PARAMS },
            Params { enabling: 4, ..PARAMS },
        ];
        assert!(bad.iter().all(|params| params.build().is_none()));
        assert!(Params { node: 0, ..PARAMS }.build().is_some());
    }

    /// Any frame, or a heartbeat that is in order.
    fn any_frame() -> impl Strategy<Value = Sent> {
        let data = prop::collection::vec(any::<u8>(), 0..9);
        prop_oneof![
            (0_u16..0x800, data.clone()).prop_map(|(id, data)| frame(id, &data)),
            (NODE..NODE + 32, data).prop_map(|(id, data)| frame(id, &data)),
            (0_u8..16).prop_map(|state| heartbeat(0, state)),
            Just(heartbeat(0, 1)),
            Just(heartbeat(0, 8)),
        ]
    }

    proptest! {
        #[test]
        fn any_frames_leave_the_torque_bounded_and_safe_latched(
            frames in prop::collection::vec(any_frame(), 0..60),
            torque in prop::num::f32::ANY,
        ) {
            let mut drive = reset();
            let mut latched = None;
            for frame in frames {
                drive.receive(&frame);
                let command = sent(&mut drive, torque);
                if let Command::Torque(sent) = command {
                    prop_assert!(sent.abs() <= 2.5);
                    prop_assert!(sent == 0.0 || drive.state() == Some(State::ClosedLoopControl));
                }
                latched = latched.or(drive.cause());
                prop_assert_eq!(drive.cause(), latched);
                prop_assert!(latched.is_none() || matches!(command, Command::Idle | Command::Torque(0.0)));
            }
        }
    }
}
