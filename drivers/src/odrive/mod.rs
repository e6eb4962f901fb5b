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
//! of Get_Error. Where the estimates are not needed ([`Params::build_of_heartbeats`]), Heartbeat alone is, and both firmwares have it.
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
}

impl Params {
    /// The drive, safe until [`Drive::reset`]. It has to send heartbeats and its estimates of position and torque.
    ///
    /// `None` when the node is above 62, the peak torque is not positive and finite, or there is no time-out or no time for enabling.
    pub fn build(&self) -> Option<Drive> {
        self.guarded([Cause::HeartbeatLost, Cause::StatusLost])
    }

    /// The same of a drive that has to send its heartbeats alone; estimates are not taken.
    ///
    /// `None` as of [`Self::build`].
    pub fn build_of_heartbeats(&self) -> Option<Drive<1>> {
        self.guarded([Cause::HeartbeatLost])
    }

    fn guarded<const MESSAGES: usize>(&self, lost: [Cause; MESSAGES]) -> Option<Drive<MESSAGES>> {
        let Self { node, peak_torque, timeout, enabling } = *self;
        let guard = Guard::new(peak_torque, timeout, lost)?;
        (node <= 62 && enabling > REQUESTED + 1).then(|| Drive {
            node: u16::from(node) << 5,
            enabling,
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

/// Numbers of the messages that the drive has to send.
const HEARTBEATS: usize = 0;
const ESTIMATES: usize = 1;

/// The drive as the board sees it, of which so many messages are needed: 1, heartbeats, or 2, the estimates too.
#[derive(Clone, Debug)]
pub struct Drive<const MESSAGES: usize = 2> {
    /// The first identifier of its node.
    node: u16,
    enabling: u32,
    state: Option<State>,
    errors: Errors,
    /// Position and velocity, torque: of this pair, if it has come.
    estimates: Option<(f32, f32)>,
    torque: Option<f32>,
    /// Cycles since the drive is to be idle.
    safe: u32,
    /// Errors are to be cleared in idle.
    clears: bool,
    guard: Guard<MESSAGES>,
}

impl<const MESSAGES: usize> Drive<MESSAGES> {
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
            GET_ENCODER_ESTIMATES if MESSAGES > ESTIMATES => {
                self.estimates = Some((f32::from_le_bytes(first), f32::from_le_bytes(second)));
            }
            GET_TORQUES if MESSAGES > ESTIMATES => self.torque = Some(f32::from_le_bytes(second)),
            _ => {}
        }
        if MESSAGES > ESTIMATES { self.feedback() } else { None }
    }

    fn heartbeat(&mut self, active: u32, state: State) {
        self.errors.active = active;
        self.state = Some(state);
        self.guard.heard(HEARTBEATS);
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
        self.guard.heard(ESTIMATES);
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
mod tests;
