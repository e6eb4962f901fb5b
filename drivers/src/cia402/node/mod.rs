//! The device side of CiA 402: a joint as a CANopen node, which an arm's controller (the master) commands in every cycle of the bus.
//!
//! ```text
//! NMT        0x000          command (1 start, 2 stop, 0x80 pre-operational, 0x81 reset node, 0x82 reset communication), node or 0
//! SYNC       0x080          no data, or a counter u8 that does not count
//! EMCY       0x080 + node   error code u16, error register u8, 5 bytes 0; once for each fault, in order, error code 0 for its reset
//! RPDO1      0x200 + node   controlword (0x6040) u16, mode of operation (0x6060) i8, target position (0x607a) i32
//! RPDO2      0x300 + node   target velocity (0x60ff) i32, target torque (0x6071) i16
//! TPDO1      0x180 + node   statusword (0x6041) u16, mode display (0x6061) i8, position (0x6064) i32
//! TPDO2      0x280 + node   velocity (0x606c) i32, torque (0x6077) i16
//! SDO        0x600 + node   request, 0x580 + node answer; expedited transfers only
//! heartbeat  0x700 + node   NMT state: 0 boot-up, once at the start and after a reset by NMT; 4 stopped, 5 operational, 0x7f pre-operational
//! ```
//!
//! Little-endian. Frames of another length, remote frames and those with 29-bit identifiers are ignored.
//!
//! Position in counts of 2^-26 of a revolution of the output, which wraps after 32 of them to either side; velocity in counts/s;
//! torque (0x6071, 0x6077) in thousandths of the rated torque, which object 0x6076 gives in mN m as [`Params::rated_torque`] has it. What
//! torque that is and where it acts, at the output or elsewhere, is what the caller defines by that rated torque, [`Actual::torque`] and
//! what it does with [`Target::Torque`]. Object 0x608f, the counts of a revolution, is of the output, not of the motor. Signs are the joint's.
//!
//! All PDOs are synchronous: what RPDOs carried takes effect at the next SYNC, and every SYNC in NMT operational sends both TPDOs with
//! values read after it. Modes: 8 cyclic synchronous position, 9 velocity, 10 torque. Another mode is refused: the display stays at the
//! last valid one, 0 before the first. The period of the bus is object 0x60c2, value * 10^index s; each write to it has to give a whole
//! number of control periods, 2 to 1000, and at most half of the time-out.
//!
//! PDOs are fixed. Their parameters, and the identifiers of SYNC and EMCY, take the value that they have, and in pre-operational the
//! disabling of a PDO and of a mapping too, without effect: masters that configure PDOs when they start succeed. What PDOs carry to the
//! joint (0x6040, 0x607a, 0x60ff, 0x6071) is read only for SDOs; the mode 0x6060 is not. `drivers/strainwave.eds` describes all objects.
//!
//! A SYNC in operation enabled gives a target if the mode's data are new: RPDO1, in modes 9 and 10 RPDO2 too. The SYNC that enables gives
//! none. Statusword beyond the state: bit 4 voltage enabled, always once the joint is ready; bit 9 remote, in NMT operational; bit 10 target
//! reached, a quick stop at rest; bit 12 the last SYNC gave a target, and the joint follows it.
//!
//! The bus is lost in operation enabled, by error code:
//!
//! ```text
//! 0x8100  the NMT state is operational no more, by command
//! 0x8130  no heartbeat of the master for the time in object 0x1016 (node << 16 | ms; off by default), counted from the write on
//! 0x8250  no SYNC with new data for the time-out
//! 0x8700  the SYNC has another period than object 0x60c2: five intervals in a row of half of it or less, or more than 3/2
//! ```
//!
//! The joint then brakes ([`Wanted::Brake`]) until it is at rest or has braked for the longest stop, and is off in the state fault until
//! a rising edge of bit 7 of the controlword, which leads to switch on disabled at once: the joint itself need not be reset. A fault of the
//! joint goes to fault at once and takes the place of one of the bus; it ends when the joint, reset, is ready without a fault. A quick stop
//! brakes in the same way, to switch on disabled; so does a reset by NMT of a joint in operation. Such a reset clears a fault of the bus,
//! not one of the joint.
//!
//! A drive that has to be powered first ([`Wanted::Standby`], [`Actual::powered`]) stays in switched on until it is.
//!
//! A joint that is not ready ([`Actual::ready`]) cannot be switched on: at the start the state is not ready until it is, later switch on
//! disabled. In operation enabled its faults alone count.
//!
//! | file | |
//! | --- | --- |
//! | `params` | parameters |
//! | `joint` | what passes between the node and the joint |
//! | `machine` | states of the power, faults, braking |
//! | `emergency` | emergency messages that wait |
//! | `nmt` | states of the node on the bus |
//! | `heartbeat` | ours and the master's |
//! | `demand` | RPDOs, mode and target |
//! | `period`, `sync` | period of the bus, and whether SYNCs keep it |
//! | `sdo`, `objects`, `pdo` | SDO server and what it reads and writes |
//! | `outbox` | frames that wait to be sent |
//!
//! zencan-node 0.0.5 and canopen-rs 0.6.1 are CiA 301 without CiA 402, and panic where a slice's length or an `expect` does not hold.
//!
//! Reference: CiA 301; CiA 402-2 (IEC 61800-7-201), sections "Finite state automaton" and "Cyclic synchronous position mode", and those of
//! velocity and torque.

mod demand;
mod emergency;
mod heartbeat;
mod joint;
mod machine;
mod nmt;
mod objects;
mod outbox;
mod params;
mod pdo;
mod period;
mod sdo;
mod sync;
#[cfg(test)]
mod tests;

use core::mem::take;

use embedded_can::Frame;

use self::demand::{Demand, Received, Rpdo1, Rpdo2};
use self::heartbeat::{Consumer, Producer};
pub use self::joint::{Actual, Target, Wanted};
use self::machine::Machine;
use self::nmt::{Command, Nmt};
use self::outbox::Outbox;
pub use self::params::Params;
use self::period::Period;
use self::sync::Intervals;
pub use crate::cia402::State;
use crate::drive::standard_id;

const NMT: u16 = 0x000;
const SYNC: u16 = 0x080;
const EMCY: u16 = 0x080;
const TPDO1: u16 = 0x180;
const RPDO1: u16 = 0x200;
const TPDO2: u16 = 0x280;
const RPDO2: u16 = 0x300;
const ANSWER: u16 = 0x580;
const REQUEST: u16 = 0x600;
const HEARTBEAT: u16 = 0x700;

/// Error code: the NMT state is operational no more.
const NOT_OPERATIONAL: u16 = 0x8100;
/// Error code: no heartbeat of the master.
const HEARTBEAT_LOST: u16 = 0x8130;
/// Error code: no SYNC with new data.
const RPDO_LOST: u16 = 0x8250;
/// Error code: the SYNC has another period.
const SYNC_CONTROLLER: u16 = 0x8700;

/// Bit 9 of the statusword: the controlword is obeyed.
const REMOTE: u16 = 1 << 9;
/// Bit 12 of the statusword: the drive follows the command value.
const FOLLOWS: u16 = 1 << 12;

/// Default of object 0x1017 (ms).
const HEARTBEAT_TIME: u16 = 100;

/// The joint as the bus sees it.
#[derive(Clone, Debug)]
pub struct Node {
    params: Params,
    node: u16,
    /// Control periods in 1 ms.
    per_ms: u32,
    nmt: Nmt,
    machine: Machine,
    producer: Producer,
    consumer: Consumer,
    period: Period,
    intervals: Intervals,
    received: Received,
    demand: Demand,
    target: Option<Target>,
    /// The last SYNC gave a target.
    follows: bool,
    /// Control periods since a SYNC had new data.
    silent: u32,
    actual: Actual,
    /// A SYNC awaits values.
    reading_wanted: bool,
    outbox: Outbox,
}

impl Node {
    fn new(params: Params) -> Self {
        let per_ms = params.rate / 1000;
        Self {
            params,
            node: params.node.into(),
            per_ms,
            nmt: Nmt::PreOperational,
            machine: Machine::new(),
            producer: Producer::new(HEARTBEAT_TIME),
            consumer: Consumer::default(),
            period: Period::millisecond(per_ms),
            intervals: Intervals::default(),
            received: Received::default(),
            demand: Demand::default(),
            target: None,
            follows: false,
            silent: 0,
            actual: Actual::default(),
            reading_wanted: false,
            outbox: Outbox { boot_up: true, ..Outbox::default() },
        }
    }

    /// Once a control period, before [`Self::receive`]: heartbeat, time-outs, the end of braking.
    pub fn tick(&mut self) {
        self.outbox.heartbeat |= self.producer.tick(self.per_ms);
        self.consumer.tick();
        self.intervals.tick();
        self.silent = self.silent.saturating_add(1);
        self.machine.tick(self.params.longest_stop);
        if self.consumer.lost(self.per_ms) {
            self.machine.lose(HEARTBEAT_LOST);
        } else if self.silent >= self.params.timeout {
            self.machine.lose(RPDO_LOST);
        }
    }

    /// Takes a frame from the bus. Frames of others are left alone.
    pub fn receive(&mut self, frame: &impl Frame) {
        let Some(id) = standard_id(frame) else { return };
        match (id, frame.data()) {
            (NMT, &[command, node]) if node == 0 || node == self.params.node => self.manage(command),
            (SYNC, [] | [_]) if self.operational() => self.sync(),
            (0x701..=0x77f, [_]) => self.consumer.heard(id ^ HEARTBEAT),
            (_, data) => self.receive_own(id ^ self.node, data),
        }
    }

    /// A frame by its identifier without our node.
    fn receive_own(&mut self, function: u16, data: &[u8]) {
        match function {
            RPDO1 if self.operational() => {
                self.received.first = data.try_into().ok().map(Rpdo1::of).or(self.received.first);
            }
            RPDO2 if self.operational() => {
                self.received.second = data.try_into().ok().map(Rpdo2::of).or(self.received.second);
            }
            REQUEST if self.nmt != Nmt::Stopped => {
                if let Ok(request) = data.try_into() {
                    self.outbox.answer = sdo::answer(self, request);
                }
            }
            _ => {}
        }
    }

    fn operational(&self) -> bool {
        self.nmt == Nmt::Operational
    }

    fn manage(&mut self, command: u8) {
        match Command::of(command) {
            Some(Command::Enter(nmt)) => self.enter(nmt),
            Some(Command::Reset) => self.restart(),
            None => {}
        }
    }

    fn enter(&mut self, nmt: Nmt) {
        self.nmt = nmt;
        if nmt != Nmt::Operational {
            self.machine.disconnect(NOT_OPERATIONAL);
            (self.received, self.reading_wanted) = (Received::default(), false);
            (self.outbox.tpdo1, self.outbox.tpdo2) = (None, None);
        }
        if nmt == Nmt::Stopped {
            self.outbox.answer = None;
        }
    }

    fn restart(&mut self) {
        let mut machine = self.machine.clone();
        machine.restart(self.actual.fault);
        *self = Self { machine, actual: self.actual, ..Self::new(self.params) };
    }

    fn sync(&mut self) {
        let regular = self.intervals.end(self.period.periods(), self.machine.enabled());
        if !regular {
            self.machine.lose(SYNC_CONTROLLER);
        }
        let enabled = self.machine.enabled();
        let received = take(&mut self.received);
        if let Some(Rpdo1 { controlword, .. }) = received.first {
            self.machine.command(controlword);
        }
        let new = self.demand.take(received);
        // The time-out begins when the joint is enabled.
        if new || !enabled {
            self.silent = 0;
        }
        // Data that came with the command to enable are from before it.
        let follows = new && enabled && self.machine.enabled();
        self.target = self.demand.target(self.params.rated_torque).filter(|_| follows);
        self.follows = self.target.is_some();
        self.reading_wanted = true;
    }

    /// What the joint's power is to do; [`Wanted::On`] in operation enabled only.
    pub fn wanted(&self) -> Wanted {
        match self.machine.state() {
            State::OperationEnabled => Wanted::On,
            State::SwitchedOn if self.machine.enabling() => Wanted::Standby,
            State::QuickStopActive | State::FaultReactionActive => Wanted::Brake,
            _ => Wanted::Off,
        }
    }

    /// The target of the last SYNC, once, if that had new data and the joint is still enabled.
    pub fn target(&mut self) -> Option<Target> {
        self.target.take().filter(|_| self.machine.enabled())
    }

    /// Period of the bus (control periods).
    pub fn period(&self) -> u32 {
        self.period.periods()
    }

    /// A SYNC has come and awaits [`Self::read`].
    pub fn reading_wanted(&self) -> bool {
        self.reading_wanted
    }

    /// The joint's values, at any time. Those of a step that knew of the SYNC answer it (`answers`); others leave it waiting.
    pub fn read(&mut self, actual: &Actual, answers: bool) {
        self.actual = *actual;
        self.machine.read(actual);
        if answers && take(&mut self.reading_wanted) {
            let [s0, s1] = self.statusword().to_le_bytes();
            let [mode] = self.demand.display().to_le_bytes();
            let [p0, p1, p2, p3] = actual.position.to_le_bytes();
            let [v0, v1, v2, v3] = actual.velocity.to_le_bytes();
            let [t0, t1] = self.actual_torque().to_le_bytes();
            self.outbox.tpdo1 = Some([s0, s1, mode, p0, p1, p2, p3]);
            self.outbox.tpdo2 = Some([v0, v1, v2, v3, t0, t1]);
        }
    }

    /// The joint is to leave its own fault; true once for each request of the master. It has 2000 control periods until it is ready without a
    /// fault, else the state stays fault.
    pub fn reset_requested(&mut self) -> bool {
        self.machine.take_reset()
    }

    /// State of the power.
    pub fn state(&self) -> State {
        self.machine.state()
    }

    fn statusword(&self) -> u16 {
        let remote = if self.operational() { REMOTE } else { 0 };
        let follows = if self.follows && self.actual.follows && self.machine.enabled() { FOLLOWS } else { 0 };
        self.machine.statusword() | remote | follows
    }

    /// Thousandths of the rated torque, 0 of what is not a number.
    fn actual_torque(&self) -> i16 {
        (self.actual.torque / self.params.rated_torque * 1000.0) as i16
    }
}
