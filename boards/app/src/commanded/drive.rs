//! The drive behind the node.
//!
//! One that the control commands itself, in its interrupt, is [`Wired`]. One on a bus of its own is served in the interrupt of the node, below
//! the control's: it has the torque of the control step that has just ended.

use strainwave_drivers::cia402::node::{Actual, Wanted};

/// Why a drive is off, with its error code (CiA 301, table "Emergency error codes").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum DriveFault {
    /// It reports an error, is off by itself, or is not powered in time: device hardware, output stages.
    Error = 0x5400,
    /// It is not heard, or does not take what is sent: additional modules, communication.
    Silent = 0x7500,
}

/// What a drive says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveReport {
    /// It has been heard: it can be powered.
    pub ready: bool,
    /// It follows its torque.
    pub powered: bool,
    /// Why it does not.
    pub fault: Option<DriveFault>,
}

impl DriveReport {
    /// What joint and drive together are: a fault of the joint counts first.
    pub(super) fn joined(&self, joint: Actual) -> Actual {
        let fault = if joint.fault == 0 { self.fault.map_or(0, |fault| fault as u16) } else { joint.fault };
        Actual { ready: joint.ready && self.ready, powered: joint.powered && self.powered, fault, ..joint }
    }
}

/// A drive, polled once in a control period, from one place; never waits.
pub trait Drive {
    /// Takes what has come since the last poll, so many control periods ago.
    fn listen(&mut self, passed: u32) -> DriveReport;
    /// What its power is to do, and the torque (N m) of the control step since the last poll, if there was one.
    fn command(&mut self, wanted: Wanted, torque: Option<f32>);
    /// Its faults are to be left.
    fn reset(&mut self);
}

/// A drive that the control commands itself: it is powered as soon as it has a torque.
pub struct Wired;

impl Drive for Wired {
    fn listen(&mut self, _passed: u32) -> DriveReport {
        DriveReport { ready: true, powered: true, fault: None }
    }

    fn command(&mut self, _wanted: Wanted, _torque: Option<f32>) {}

    fn reset(&mut self) {}
}
