//! The master of one drive behind CANopen that takes a torque every cycle of the bus (cyclic synchronous torque, mode 10).
//!
//! ```text
//! RPDO1  0x200 + node   controlword, target torque (0x6071) in thousandths of the rated torque
//! TPDO1  0x180 + node   statusword, position (0x6064) in counts, torque (0x6077) in thousandths of the rated torque
//! heartbeat  0x700 + node   NMT state, 5 is operational
//! ```
//!
//! Little-endian; the drive is configured once with this mapping, TPDO1 sent for every SYNC or RPDO1, mode 10, and a heartbeat
//! more often than the time-out.
//!
//! States of the statusword, and the controlword that leads on (0x06 shutdown, 0x07 switch on, 0x0f enable operation):
//!
//! ```text
//! switch on disabled --0x06--> ready to switch on --0x07--> switched on --0x0f--> operation enabled
//! quick stop active  --0x00--> switch on disabled           fault --0x80--> switch on disabled (rising edge)
//! ```
//!
//! Safe is: controlword 0x00, disable voltage, and no torque, until [`Drive::reset`]. It is entered by name ([`Cause`]) when the drive reports a
//! fault or leaves the enabled state by itself, when its NMT state is not operational, and when neither status nor heartbeat has come for the
//! time-out. A torque is sent in the enabled state only, and none that is not a number.
//!
//! Reference: CiA 402-2 (IEC 61800-7-201), sections "Finite state automaton" and "Controlword", "Statusword"; CiA 301 for NMT.

use embedded_can::{Frame, StandardId};

use super::state::{DISABLE_VOLTAGE, ENABLE_OPERATION, FAULT_RESET, OPERATIONAL, SHUTDOWN, SWITCH_ON, State};
pub use crate::drive::Cause;
use crate::drive::{Guard, standard_id};

/// How the drive was configured.
#[derive(Clone, Copy, Debug)]
pub struct Params {
    /// Node, 1 to 127.
    pub node: u8,
    /// Rated torque of the motor (N m), object 0x6076.
    pub rated_torque: f32,
    /// The largest torque that is commanded (N m).
    pub peak_torque: f32,
    /// Cycles of the bus without status or without heartbeat after which the drive is taken for lost.
    pub timeout: u32,
}

/// Numbers of the messages that the drive has to send.
const STATUS: usize = 0;
const HEARTBEATS: usize = 1;

impl Params {
    /// The drive, safe until [`Drive::reset`].
    ///
    /// `None` when the node is not 1 to 127, a torque is not positive, the peak is more than 32 times the rating, or there is no time-out.
    pub fn build(&self) -> Option<Drive> {
        let Self { node, rated_torque, peak_torque, timeout } = *self;
        let guard = Guard::new(peak_torque, timeout, [Cause::StatusLost, Cause::HeartbeatLost])?;
        let rated = rated_torque > 0.0 && rated_torque.is_finite();
        let torques = rated && peak_torque / rated_torque <= 32.0;
        ((1..=127).contains(&node) && torques).then(|| Drive {
            node: node.into(),
            per_torque: 1000.0 / rated_torque,
            torque_per: rated_torque / 1000.0,
            state: State::NotReady,
            guard,
        })
    }
}

impl State {
    /// The controlword that leads towards the enabled state.
    const fn towards_enabled(self) -> u16 {
        match self {
            Self::SwitchOnDisabled => SHUTDOWN,
            Self::ReadyToSwitchOn => SWITCH_ON,
            Self::SwitchedOn | Self::OperationEnabled => ENABLE_OPERATION,
            Self::NotReady | Self::QuickStopActive | Self::FaultReactionActive | Self::Fault => {
                DISABLE_VOLTAGE
            }
        }
    }
}

/// What the drive measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// Position of its encoder (counts).
    pub position: i32,
    /// Torque of its motor (N m).
    pub torque: f32,
}

/// The drive as the board sees it.
#[derive(Clone, Debug)]
pub struct Drive {
    node: u16,
    /// Thousandths of the rated torque in 1 N m, and the inverse.
    per_torque: f32,
    torque_per: f32,
    state: State,
    guard: Guard<2>,
}

impl Drive {
    /// State by the last statusword.
    pub fn state(&self) -> State {
        self.state
    }

    /// Why there is no torque, if the drive is safe.
    pub fn cause(&self) -> Option<Cause> {
        self.guard.cause()
    }

    /// Leaves safe: a fault is reset and the drive enabled, step by step.
    pub fn reset(&mut self) {
        self.guard.reset();
    }

    /// Takes a frame from the bus; what the drive measures, if it was its status. Frames of others are left alone.
    pub fn receive(&mut self, frame: &impl Frame) -> Option<Feedback> {
        match (standard_id(frame)?.checked_sub(self.node)?, frame.data()) {
            (0x180, &[s0, s1, p0, p1, p2, p3, t0, t1]) => {
                self.status(State::of(u16::from_le_bytes([s0, s1])));
                let position = i32::from_le_bytes([p0, p1, p2, p3]);
                let torque = f32::from(i16::from_le_bytes([t0, t1])) * self.torque_per;
                Some(Feedback { position, torque })
            }
            (0x700, &[state]) => {
                self.guard.heard(HEARTBEATS);
                if state != OPERATIONAL {
                    self.guard.stop(Cause::NotOperational);
                }
                None
            }
            _ => None,
        }
    }

    fn status(&mut self, state: State) {
        self.state = state;
        self.guard.heard(STATUS);
        self.guard.status(match state {
            State::OperationEnabled => Ok(()),
            State::Fault | State::FaultReactionActive => Err(Cause::DriveFault),
            _ => Err(Cause::Disabled),
        });
    }

    /// Once a cycle of the bus: the frame that commands a torque (N m), or what leads there.
    ///
    /// `None` only when the frame's type holds no 4 bytes.
    pub fn step<F: Frame>(&mut self, torque: f32) -> Option<F> {
        self.guard.cycle();
        let controlword = self.controlword();
        let target = self.guard.torque(torque) * self.per_torque;
        let ([c0, c1], [t0, t1]) = (controlword.to_le_bytes(), (target as i16).to_le_bytes());
        F::new(StandardId::new(0x200 + self.node)?, &[c0, c1, t0, t1])
    }

    fn controlword(&mut self) -> u16 {
        if self.guard.cause().is_some() {
            return DISABLE_VOLTAGE;
        }
        if self.state != State::Fault {
            return self.state.towards_enabled();
        }
        // One rising edge: the word before it and those behind it are without the bit.
        match self.guard.attempt(self.guard.timeout(), Cause::DriveFault) {
            Some(0) => FAULT_RESET,
            _ => DISABLE_VOLTAGE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Sent, frame};
    use embedded_can::Id;
    use proptest::prelude::*;

    const PARAMS: Params = Params { node: 5, rated_torque: 2.0, peak_torque: 5.0, timeout: 10 };

    fn status(word: u16) -> Sent {
        frame(0x185, &[word.to_le_bytes().as_slice(), &[0x40, 0xe2, 0x01, 0x00, 0x0c, 0xfe]].concat())
    }

    fn heartbeat() -> Sent {
        frame(0x705, &[OPERATIONAL])
    }

    /// One period in which the drive has this status: controlword and torque that are sent.
    fn period(drive: &mut Drive, word: u16, torque: f32) -> (u16, i16) {
        drive.receive(&heartbeat());
        drive.receive(&status(word));
        sent(drive, torque)
    }

    fn sent(drive: &mut Drive, torque: f32) -> (u16, i16) {
        let Sent(id, data) = drive.step(torque).unwrap();
        assert_eq!(id, Id::Standard(StandardId::new(0x205).unwrap()));
        let [c0, c1, t0, t1] = data[..] else { panic!("{data:?}") };
        (u16::from_le_bytes([c0, c1]), i16::from_le_bytes([t0, t1]))
    }

    fn enabled() -> Drive {
        let mut drive = PARAMS.build().unwrap();
        drive.reset();
        for word in [0x0250, 0x0231, 0x0233, 0x0237] {
            period(&mut drive, word, 1.0);
        }
        assert_eq!((drive.state(), drive.cause()), (State::OperationEnabled, None));
        drive
    }

    #[test]
    fn it_is_enabled_step_by_step_and_only_then_driven() {
        let mut drive = PARAMS.build().unwrap();
        assert_eq!(period(&mut drive, 0x0250, 1.0), (0x00, 0));
        assert_eq!(drive.cause(), Some(Cause::NotStarted));
        drive.reset();
        assert_eq!(period(&mut drive, 0x0250, 1.0), (0x06, 0));
        assert_eq!(period(&mut drive, 0x0231, 1.0), (0x07, 0));
        assert_eq!(period(&mut drive, 0x0233, 1.0), (0x0f, 0));
        assert_eq!(period(&mut drive, 0x0237, 1.0), (0x0f, 500));
        assert_eq!(period(&mut drive, 0x0237, -9.0), (0x0f, -2500));
        assert_eq!(period(&mut drive, 0x0237, f32::INFINITY), (0x0f, 2500));
        assert_eq!(period(&mut drive, 0x0237, f32::NAN), (0x0f, 0));
    }

    #[test]
    fn a_fault_is_reset_by_one_edge_when_it_is_asked_for() {
        let mut drive = enabled();
        assert_eq!(period(&mut drive, 0x021f, 1.0), (0x00, 0));
        assert_eq!(period(&mut drive, 0x0218, 1.0), (0x00, 0));
        assert_eq!(drive.cause(), Some(Cause::DriveFault));
        drive.reset();
        assert_eq!(period(&mut drive, 0x0218, 1.0), (0x80, 0));
        assert_eq!(period(&mut drive, 0x0218, 1.0), (0x00, 0));
        assert_eq!(period(&mut drive, 0x0250, 1.0), (0x06, 0));
        assert_eq!(drive.cause(), None);
    }

    #[test]
    fn a_fault_that_stays_is_named() {
        let mut drive = PARAMS.build().unwrap();
        drive.reset();
        assert_eq!(period(&mut drive, 0x0218, 1.0), (0x80, 0));
        for _ in 0..PARAMS.timeout {
            assert_eq!(drive.cause(), None);
            assert_eq!(period(&mut drive, 0x0218, 1.0), (0x00, 0));
        }
        assert_eq!(drive.cause(), Some(Cause::DriveFault));
    }

    #[test]
    fn what_the_drive_does_by_itself_makes_safe_until_a_reset() {
        for (word, cause) in
            [(0x0250, Cause::Disabled), (0x0217, Cause::Disabled), (0x0218, Cause::DriveFault)]
        {
            let mut drive = enabled();
            assert_eq!(period(&mut drive, word, 1.0), (0x00, 0));
            assert_eq!(period(&mut drive, 0x0237, 1.0), (0x00, 0));
            assert_eq!(drive.cause(), Some(cause), "{word:#06x}");
        }
        let mut drive = enabled();
        drive.receive(&frame(0x705, &[0x00]));
        assert_eq!(period(&mut drive, 0x0237, 1.0), (0x00, 0));
        assert_eq!(drive.cause(), Some(Cause::NotOperational));
    }

    #[test]
    fn a_status_from_before_a_reset_drives_nothing() {
        let mut drive = enabled();
        drive.reset();
        assert_eq!(sent(&mut drive, 1.0), (0x0f, 0));
        assert_eq!(period(&mut drive, 0x0237, 1.0), (0x0f, 500));
    }

    #[test]
    fn silence_is_noticed_after_the_timeout_and_not_before() {
        let silent = |heard: Sent, cause| {
            let mut drive = enabled();
            for _ in 1..PARAMS.timeout {
                drive.receive(&heard);
                assert_eq!(sent(&mut drive, 1.0), (0x0f, 500));
            }
            drive.receive(&heard);
            assert_eq!(sent(&mut drive, 1.0), (0x00, 0));
            assert_eq!(drive.cause(), Some(cause));
        };
        silent(heartbeat(), Cause::StatusLost);
        silent(status(0x0237), Cause::HeartbeatLost);
        silent(frame(0x186, &[0; 8]), Cause::StatusLost);
    }

    #[test]
    fn what_it_measures_is_scaled() {
        let mut drive = PARAMS.build().unwrap();
        let feedback = drive.receive(&status(0x0237));
        assert_eq!(feedback, Some(Feedback { position: 123_456, torque: -1.0 }));
        assert_eq!(drive.receive(&frame(0x185, &[0x37, 0x02])), None);
        assert_eq!(drive.receive(&frame(0x001, &[1, 5])), None);
    }

    #[test]
    fn parameters_out_of_range_build_no_drive() {
        let bad = [
            Params { node: 0, ..PARAMS },
            Params { node: 128, ..PARAMS },
            Params { rated_torque: 0.0, ..PARAMS },
            Params { rated_torque: f32::INFINITY, ..PARAMS },
            Params { peak_torque: f32::NAN, ..PARAMS },
            Params { peak_torque: 65.0, ..PARAMS },
            Params { timeout: 0, ..PARAMS },
        ];
        assert!(bad.iter().all(|params| params.build().is_none()));
    }

    proptest! {
        #[test]
        fn any_frames_leave_the_torque_bounded(
            frames in prop::collection::vec((0_u16..0x800, prop::collection::vec(any::<u8>(), 0..9)), 0..60),
            torque in prop::num::f32::ANY,
        ) {
            let mut drive = PARAMS.build().unwrap();
            drive.reset();
            for (id, data) in frames {
                drive.receive(&frame(id, &data));
                let (word, target) = sent(&mut drive, torque);
                prop_assert!(target.unsigned_abs() <= 2500);
                prop_assert!(target == 0 || word == 0x0f);
            }
        }
    }
}
