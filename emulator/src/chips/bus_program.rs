//! What a master does on the bus of a chip, and what it expects.
//!
//! ```text
//! greeted     boot-up and heartbeat; the drive is off; SDOs read what the joint is, and refuse what it has not
//! moved       switched on step by step, moved through 20 mrad by positions, moved on at a velocity, held without a torque
//! stopped     a quick stop in motion ends at rest in a drive that is off
//! lost        the bus is silent while positions, then while a torque move the joint: it brakes, and is off at rest; the fault is named, goes by a
//!             reset alone, and leaves the position as it is
//! failed      the encoder fails: the drive is off, and the fault is named
//! ```
//!
//! Of a drive on a bus of its own more is in `drive.rs`.

mod drive;

use std::io;

use embedded_can::Frame as _;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_app::commanded::{Frame, NODE};

use crate::chips::host::{Drive, RELEASED};
use crate::chips::line::ProgramEnd;

/// Control periods of a cycle of the bus, 1 ms.
const CYCLE: usize = 10;
/// Counts of the bus in 1 rad.
const COUNTS: f64 = (1_u32 << 26) as f64 / std::f64::consts::TAU;
/// The move (rad), and its length (cycles).
const WAY: f64 = 0.02;
const MOVE: usize = 200;
/// Velocity (rad/s) and how long (cycles).
const VELOCITY: f64 = 0.2;
const TRAVEL: usize = 60;
/// Torque (thousandths of the gear's peak torque) and how long (cycles).
const PULL: i16 = 60;
const PULLS: usize = 50;
/// Cycles until the joint rests, until the observer knows it, and that a state has to be reached in.
const REST: usize = 150;
const WATCHED: usize = 100;
const PATIENCE: usize = 20;
/// Cycles that a stop has at most until the drive is off, and those of silence before one.
const LOST: usize = 400;
const SILENCE: f64 = 0.05;

/// Modes.
const POSITION: i8 = 8;
const SPEED: i8 = 9;
const TORQUE: i8 = 10;

/// Controlwords.
const SHUTDOWN: u16 = 0x06;
const SWITCH_ON: u16 = 0x07;
const ENABLE: u16 = 0x0f;
const QUICK_STOP: u16 = 0x02;
const FAULT_RESET: u16 = 0x80;

/// States, by the bits of the statusword that tell them.
const SWITCH_ON_DISABLED: u16 = 0x40;
const READY: u16 = 0x21;
const SWITCHED_ON: u16 = 0x23;
const ENABLED: u16 = 0x27;
const FAULT: u16 = 0x08;

/// Error codes.
const RPDO_LOST: u16 = 0x8250;
const ENCODER_LOST: u16 = 0x7305;

/// What the master brings a period.
#[derive(Clone, Debug, Default)]
pub struct Ask {
    /// Frames to the joint.
    pub frames: Vec<Frame>,
    /// The motor encoder has no supply.
    pub encoder_fails: bool,
    /// What a drive on a bus of its own has.
    pub failure: Option<Failure>,
}

/// A failure of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Its heartbeats do not come.
    Silent,
    /// It has an error.
    Error,
}

/// What it sees of one.
#[derive(Clone, Debug)]
pub struct Look {
    /// Frames of the joint.
    pub frames: Vec<Frame>,
    /// The drive at its end.
    pub drive: Drive,
}

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Targets of the move, from its start (rad), with the period in which each was sent.
    pub moves: Vec<(usize, f64)>,
    /// Control periods of a cycle of the bus.
    pub cycle: usize,
    /// Longest time from a SYNC to both answers (s).
    pub answered_after: f64,
    /// Longest time from the last SYNC to a drive that is off (s).
    pub lost_after: f64,
    /// Periods in which the drive of a joint that was stopped in motion goes off.
    pub stops: Vec<usize>,
    /// From the failure of the encoder to the same (s).
    pub failed_after: f64,
    /// From the end of a drive's heartbeats to a drive that is off and an error code that is told (s).
    pub silent_after: f64,
    /// From an error of the drive to the same (s).
    pub error_after: f64,
    /// What is otherwise than it has to be, by name.
    pub unexpected: Vec<String>,
    /// How much was looked at for that.
    pub expected: u32,
}

/// The joint by its last frames.
#[derive(Clone, Debug, Default)]
struct Told {
    status: u16,
    mode: i8,
    position: i32,
    boots: u32,
    heartbeats: u32,
    errors: Vec<u16>,
    answer: Option<[u8; 8]>,
    /// Periods from the last SYNC to what answers it, while one is missing.
    waited: Option<usize>,
    answers: u8,
}

/// A controller above the joint.
pub struct Master {
    end: ProgramEnd<Ask, Look>,
    periods: usize,
    encoder_fails: bool,
    failure: Option<Failure>,
    drive: Drive,
    /// When it last went off.
    off_since: usize,
    told: Told,
    /// What the next cycles bring.
    controlword: u16,
    mode: i8,
    target: i32,
    velocity: i32,
    torque: i16,
    found: Found,
}

impl Master {
    /// On the bus.
    pub fn new(end: ProgramEnd<Ask, Look>) -> Self {
        Self {
            end,
            periods: 0,
            encoder_fails: false,
            failure: None,
            drive: RELEASED,
            off_since: 0,
            told: Told::default(),
            controlword: 0,
            mode: POSITION,
            target: 0,
            velocity: 0,
            torque: 0,
            found: Found { cycle: CYCLE, ..Found::default() },
        }
    }

    /// Does it all.
    ///
    /// # Errors
    /// When the chip does not go on.
    pub fn works(mut self) -> io::Result<Found> {
        self.commands()?;
        self.failed()?;
        Ok(self.found)
    }

    fn commands(&mut self) -> io::Result<()> {
        self.greeted()?;
        self.moved()?;
        self.stopped()?;
        self.moves(POSITION)?;
        self.lost()?;
        self.moves(TORQUE)?;
        self.lost()
    }

    fn greeted(&mut self) -> io::Result<()> {
        self.wait(PATIENCE * CYCLE)?;
        self.expect("it boots once", self.told.boots == 1);
        self.reads("device type", 0x1000, 0, 0x0002_0192)?;
        self.reads("supported modes", 0x6502, 0, 1 << 7 | 1 << 8 | 1 << 9)?;
        self.reads("counts of a revolution", 0x608f, 1, 1 << 26)?;
        let missing = self.asks([0x40, 0x00, 0x20, 0x00, 0, 0, 0, 0])?;
        self.expect(
            "an object that is not there is refused",
            missing.is_some_and(|answer| answer[0] == 0x80),
        );
        self.put(vec![frame(0x000, &[1, NODE])])?;
        self.cycles(WATCHED)?;
        self.expect("heartbeats come", self.told.heartbeats > 0);
        self.expect("it waits", self.state(SWITCH_ON_DISABLED));
        self.expect("the drive is off", self.drive == RELEASED);
        Ok(())
    }

    /// Switches the joint on where it is.
    fn enabled(&mut self) -> io::Result<()> {
        (self.mode, self.target) = (POSITION, self.told.position);
        for (controlword, state) in [(SHUTDOWN, READY), (SWITCH_ON, SWITCHED_ON), (ENABLE, ENABLED)] {
            let off = self.drive == RELEASED;
            self.expect("the drive is off before it is switched on", off);
            self.controlword = controlword;
            let reached = self.until(PATIENCE, |joint| joint.state(state))?;
            self.expect(&format!("state {state:#04x} is reached"), reached);
        }
        let on = self.until(PATIENCE, |joint| joint.drive.1)?;
        self.expect("the drive is on", on);
        Ok(())
    }

    fn moved(&mut self) -> io::Result<()> {
        self.enabled()?;
        let start = self.target;
        for cycle in 0..MOVE + REST {
            let part = (cycle as f64 / MOVE as f64).min(1.0);
            let way = WAY * part.powi(3) * (10.0 - part * (15.0 - 6.0 * part));
            self.found.moves.push((self.periods, way));
            self.target = start + (way * COUNTS).round() as i32;
            self.cycle()?;
        }
        (self.mode, self.velocity) = (SPEED, (VELOCITY * COUNTS) as i32);
        let before = self.told.position;
        self.cycles(TRAVEL)?;
        let way = f64::from(self.told.position - before) / COUNTS / (VELOCITY * TRAVEL as f64 * 1e-3);
        self.expect("it moves at the velocity", (0.8..1.2).contains(&way));
        self.velocity = 0;
        self.cycles(2 * PATIENCE)?;
        self.expect("it says its mode", self.told.mode == SPEED);
        (self.mode, self.target) = (POSITION, self.told.position);
        self.cycles(PATIENCE)?;
        self.expect("it is enabled throughout", self.state(ENABLED) && self.drive.1);
        self.expect("it follows", self.told.status & 1 << 12 != 0);
        self.expect("no error was named", self.told.errors.is_empty());
        Ok(())
    }

    fn stopped(&mut self) -> io::Result<()> {
        self.moves(SPEED)?;
        self.controlword = QUICK_STOP;
        let stopped = self.until(LOST, |joint| joint.state(SWITCH_ON_DISABLED) && joint.drive == RELEASED)?;
        self.expect("a quick stop ends in a drive that is off", stopped);
        self.found.stops.push(self.off_since);
        self.enabled()
    }

    /// In motion, in this mode.
    fn moves(&mut self, mode: i8) -> io::Result<()> {
        let before = self.told.position;
        (self.mode, self.velocity, self.torque) = (mode, (VELOCITY * COUNTS) as i32, PULL);
        for _ in 0..if mode == TORQUE { PULLS } else { TRAVEL } {
            self.target += (VELOCITY * COUNTS * 1e-3) as i32;
            self.cycle()?;
        }
        let moved = f64::from(self.told.position - before) / COUNTS;
        self.expect("the joint is in motion", moved > 0.5 * VELOCITY * PULLS as f64 * 1e-3);
        Ok(())
    }

    fn lost(&mut self) -> io::Result<()> {
        let (last, named) = (self.periods - CYCLE + 1, self.told.errors.len());
        for _ in 0..LOST * CYCLE {
            if self.drive == RELEASED {
                break;
            }
            self.wait(1)?;
        }
        let after = self.off_after(last);
        self.found.lost_after = self.found.lost_after.max(after);
        self.found.stops.push(self.off_since);
        self.expect("a silent bus ends in a drive that is off", self.drive == RELEASED);
        self.expect("its silence is borne for as long as is said", after > SILENCE);
        self.cycles(PATIENCE)?;
        self.expect("the silence is named once", self.told.errors[named..] == [RPDO_LOST]);
        self.leaves_fault()
    }

    /// A fault in which the joint does not move: it stays until it is reset, and the position stays as it is.
    fn leaves_fault(&mut self) -> io::Result<()> {
        self.expect("the fault stays", self.state(FAULT) && self.drive == RELEASED);
        let position = self.told.position;
        self.controlword = 0;
        self.cycles(PATIENCE)?;
        self.controlword = FAULT_RESET;
        let reset = self.until(PATIENCE, |joint| joint.state(SWITCH_ON_DISABLED))?;
        self.expect("a reset ends it", reset && self.told.errors.last() == Some(&0));
        let moved = f64::from(self.told.position - position).abs() / COUNTS;
        self.expect("the position stays as it is", moved < 1e-3);
        self.enabled()
    }

    fn failed(&mut self) -> io::Result<()> {
        self.cycles(PATIENCE)?;
        self.encoder_fails = true;
        let last = self.periods;
        for _ in 0..PATIENCE {
            self.put(self.frames())?;
            self.wait(CYCLE - 1)?;
        }
        self.found.failed_after = self.off_after(last);
        self.expect("the failure is named", self.told.errors.last() == Some(&ENCODER_LOST));
        self.expect("the failure is a fault", self.state(FAULT));
        Ok(())
    }

    /// From a period to the drive's release (s); infinite without one.
    fn off_after(&self, last: usize) -> f64 {
        if self.drive == RELEASED { (self.off_since - last) as f64 * CONTROL_PERIOD } else { f64::INFINITY }
    }

    fn expect(&mut self, what: &str, holds: bool) {
        self.found.expected += 1;
        if !holds {
            let Told { status, errors, .. } = &self.told;
            self.found.unexpected.push(format!("{what}; status {status:#06x}, errors {errors:x?}"));
        }
    }

    fn state(&self, state: u16) -> bool {
        let mask = if matches!(state, SWITCH_ON_DISABLED | FAULT) { 0x4f } else { 0x6f };
        self.told.status & mask == state
    }

    /// Cycles of the bus until `reached`, so many at most.
    fn until(&mut self, most: usize, reached: impl Fn(&Self) -> bool) -> io::Result<bool> {
        for _ in 0..most {
            self.cycle()?;
            if reached(self) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn cycles(&mut self, count: usize) -> io::Result<()> {
        (0..count).try_for_each(|_| self.cycle())
    }

    /// A cycle of the bus: what is commanded, the SYNC, and the time until the next one.
    fn cycle(&mut self) -> io::Result<()> {
        self.put(self.frames())?;
        self.wait(CYCLE - 1)?;
        let answered = self.told.answers == 0b11;
        self.expect("a SYNC is answered by both TPDOs", answered);
        Ok(())
    }

    fn frames(&self) -> Vec<Frame> {
        let [c0, c1] = self.controlword.to_le_bytes();
        let [p0, p1, p2, p3] = self.target.to_le_bytes();
        let [v0, v1, v2, v3] = self.velocity.to_le_bytes();
        let [t0, t1] = self.torque.to_le_bytes();
        let mut frames = vec![frame(0x200 + node(), &[c0, c1, self.mode.cast_unsigned(), p0, p1, p2, p3])];
        if self.mode != POSITION {
            frames.push(frame(0x300 + node(), &[v0, v1, v2, v3, t0, t1]));
        }
        frames.push(frame(0x080, &[]));
        frames
    }

    /// What an SDO reads, beside what it has to.
    fn reads(&mut self, what: &str, index: u16, sub: u8, value: u32) -> io::Result<()> {
        let [low, high] = index.to_le_bytes();
        let answer = self.asks([0x40, low, high, sub, 0, 0, 0, 0])?;
        let read = answer.map(|[_, _, _, _, value @ ..]| u32::from_le_bytes(value));
        self.expect(&format!("the {what} is read"), read == Some(value));
        Ok(())
    }

    fn asks(&mut self, request: [u8; 8]) -> io::Result<Option<[u8; 8]>> {
        self.told.answer = None;
        self.put(vec![frame(0x600 + node(), &request)])?;
        self.wait(CYCLE)?;
        Ok(self.told.answer)
    }

    fn wait(&mut self, periods: usize) -> io::Result<()> {
        (0..periods).try_for_each(|_| self.put(Vec::new()))
    }

    /// A period at whose begin these frames have come.
    fn put(&mut self, frames: Vec<Frame>) -> io::Result<()> {
        if frames.iter().any(|frame| frame.number() == 0x080) {
            (self.told.waited, self.told.answers) = (Some(0), 0);
        }
        let look =
            self.end.go_on(Ask { frames, encoder_fails: self.encoder_fails, failure: self.failure })?;
        self.periods += 1;
        if look.drive == RELEASED && self.drive != RELEASED {
            self.off_since = self.periods;
        }
        self.drive = look.drive;
        self.told.waited = self.told.waited.map(|periods| periods + 1);
        look.frames.iter().for_each(|frame| self.take(frame));
        Ok(())
    }

    fn take(&mut self, frame: &Frame) {
        let told = &mut self.told;
        match (frame.number().wrapping_sub(node()), frame.data()) {
            (0x080, &[low, high, ..]) => told.errors.push(u16::from_le_bytes([low, high])),
            (0x180, &[s0, s1, mode, p0, p1, p2, p3]) => {
                told.status = u16::from_le_bytes([s0, s1]);
                (told.mode, told.position) = (mode.cast_signed(), i32::from_le_bytes([p0, p1, p2, p3]));
                told.answers |= 0b01;
            }
            (0x280, &[..]) => told.answers |= 0b10,
            (0x580, data) => told.answer = data.try_into().ok(),
            (0x700, &[0]) => told.boots += 1,
            (0x700, &[_]) => told.heartbeats += 1,
            _ => {}
        }
        if told.answers == 0b11
            && let Some(periods) = told.waited.take()
        {
            let after = periods as f64 * CONTROL_PERIOD;
            self.found.answered_after = self.found.answered_after.max(after);
        }
    }
}

fn node() -> u16 {
    NODE.into()
}

/// A frame of 11 bits and 8 bytes at most, as all of these are.
fn frame(id: u16, data: &[u8]) -> Frame {
    Frame::of(id, data).unwrap_or_else(|| unreachable!("{id:#x}, {data:?}"))
}
