//! An ODrive on a bus of its own ([`strainwave_drivers::odrive`]).
//!
//! ```text
//! to the drive    a frame every third control period: the torque of the last control step; until the drive is in closed-loop control what leads
//!                 there; when it is to be off, at once and again and again, that it is to be idle, in turn with a torque of 0
//! from the drive  its heartbeat: state and errors
//! ```
//!
//! The drive is on from when the node awaits it ([`Wanted::Standby`]). It is silent when no heartbeat has come for [`TIMEOUT`], or its bus has
//! no room for [`UNSENT`] frames in a row; before its first heartbeat since the start or a reset, and while it starts itself, it is not ready,
//! which is no fault. A torque is sent for [`LONGEST_AGE`] at most.

use embedded_can::nb::Can;
use strainwave_drivers::cia402::node::Wanted;
use strainwave_drivers::odrive::{Cause, Drive as Protocol, Params};

use crate::Compensator;
use crate::commanded::drive::{Drive, DriveFault, DriveReport};

/// The drive's number on its bus: that of the build.
pub const ODRIVE: u8 = match u8::from_str_radix(env!("STRAINWAVE_ODRIVE_NUMBER"), 10) {
    Ok(number) => number,
    Err(_) => panic!("the build script has checked it"),
};

/// Control periods from one frame to the next. The longest and a heartbeat, 135 bits each, take less.
const EVERY: u32 = 3;
/// Frames of silence: 12 ms, three heartbeats of 4 ms.
const TIMEOUT: u32 = 40;
/// Frames until a drive is in closed-loop control, at most: 0.5 s.
const ENABLING: u32 = 1667;
/// Frames in a row without room that are borne.
const UNSENT: u32 = 5;
/// Error with which a drive is that has not started yet (`ODriveError` of firmware 0.6).
const INITIALIZING: u32 = 1 << 0;
/// Control periods for which a torque is sent that no newer one replaces.
const LONGEST_AGE: u32 = 5;

/// The drive on its bus.
pub struct Odrive<C> {
    protocol: Protocol<1>,
    can: C,
    /// A heartbeat has come since the start or a reset.
    heard: bool,
    /// The drive is to be on.
    on: bool,
    /// (N m)
    torque: f32,
    /// Control periods since that came, and since the last frame.
    age: u32,
    since_sent: u32,
    /// Frames in a row for which there was no room.
    unsent: u32,
}

impl<C: Can> Odrive<C> {
    /// The drive `number`, 0 to 62, of the motor of a compensator.
    pub fn new(number: u8, can: C, compensator: &Compensator) -> Option<Self> {
        let protocol = Params {
            node: number,
            peak_torque: compensator.limits().motor_torque,
            timeout: TIMEOUT,
            enabling: ENABLING,
        };
        Some(Self {
            protocol: protocol.build_of_heartbeats()?,
            can,
            heard: false,
            on: false,
            torque: 0.0,
            age: LONGEST_AGE,
            since_sent: EVERY,
            unsent: 0,
        })
    }

    fn is_lost(&self) -> bool {
        self.protocol.lost().is_some() || self.unsent > UNSENT
    }

    fn starts(&self) -> bool {
        !self.on && self.protocol.errors().active == INITIALIZING
    }

    fn fault(&self, is_lost: bool) -> Option<DriveFault> {
        if self.heard && is_lost {
            return Some(DriveFault::Silent);
        }
        if self.starts() {
            return None;
        }
        match self.protocol.cause() {
            Some(Cause::HeartbeatLost) => Some(DriveFault::Silent),
            None | Some(Cause::NotStarted) if self.protocol.errors().active == 0 => None,
            _ => Some(DriveFault::Error),
        }
    }

    /// What was wanted before does not wait.
    fn switch(&mut self, on: bool) {
        if on {
            self.protocol.reset();
        } else {
            self.protocol.disable();
        }
        (self.on, self.since_sent) = (on, EVERY);
    }

    /// A frame for which there is no room is dropped: the next one is newer.
    fn send(&mut self) {
        let torque = if self.age < LONGEST_AGE { self.torque } else { 0.0 };
        let sent =
            self.protocol.step::<C::Frame>(torque).is_some_and(|frame| self.can.transmit(&frame).is_ok());
        self.unsent = if sent { 0 } else { self.unsent.saturating_add(1) };
        self.since_sent = 0;
    }
}

// Functions of their own, as what they cost is counted.
impl<C: Can> Drive for Odrive<C> {
    #[inline(never)]
    fn listen(&mut self, passed: u32) -> DriveReport {
        self.age = self.age.saturating_add(passed);
        self.since_sent = self.since_sent.saturating_add(passed);
        // The bus carries no more than one in a period.
        if let Ok(frame) = self.can.receive() {
            self.protocol.receive(&frame);
            self.heard |= self.protocol.state().is_some();
        }
        let is_lost = self.is_lost();
        DriveReport {
            ready: self.heard && !is_lost && !self.starts(),
            powered: self.protocol.is_enabled(),
            fault: self.fault(is_lost),
        }
    }

    #[inline(never)]
    fn command(&mut self, wanted: Wanted, torque: Option<f32>) {
        if let Some(torque) = torque {
            (self.torque, self.age) = (torque, 0);
        }
        let on = wanted != Wanted::Off;
        if on != self.on {
            self.switch(on);
        }
        if self.since_sent >= EVERY {
            self.send();
        }
    }

    fn reset(&mut self) {
        self.protocol.clear();
        (self.heard, self.unsent) = (false, 0);
    }
}
