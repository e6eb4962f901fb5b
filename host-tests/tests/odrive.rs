//! A joint on CAN whose drive is an ODrive on a bus of its own: the firmware's code against frames of that drive, byte by byte as its
//! documentation has them.

use embedded_can::Frame as _;
use strainwave::compensator::{Faults, Mode, Status};
use strainwave_app::command_source::CommandSource as _;
use strainwave_app::commanded::{Drive, Frame, Odrive, Wanted};
use strainwave_app::operated::WATCHING;
use strainwave_app::{Compensator, joint};
use strainwave_emulator::chips::host_bus::HostBus;

use crate::commanded::{Joint, NODE};

/// Number of the drive, and its identifiers.
const DRIVE: u8 = 3;
const FIRST: u16 = 3 << 5;
const IDLE: (u16, &[u8]) = (FIRST + 0x07, &[1, 0, 0, 0]);
const CLOSED_LOOP: (u16, &[u8]) = (FIRST + 0x07, &[8, 0, 0, 0]);
const TORQUE_MODE: (u16, &[u8]) = (FIRST + 0x0b, &[1, 0, 0, 0, 1, 0, 0, 0]);
const CLEAR: (u16, &[u8]) = (FIRST + 0x18, &[0]);
const NO_TORQUE: (u16, &[u8]) = (FIRST + 0x0e, &[0, 0, 0, 0]);
/// Control periods from a heartbeat to the next, and those of three.
const HEARTBEAT: usize = 40;
const SILENCE: usize = 3 * HEARTBEAT;

fn compensator() -> &'static Compensator {
    Compensator::from_words(&joint::WORDS).unwrap()
}

/// The drive of a joint, and a simple end of its bus.
struct Bench {
    joint: Joint<Odrive<HostBus>>,
    bus: HostBus,
    seen: usize,
    errors: u32,
    state: u8,
    silent: bool,
    periods: usize,
}

impl Bench {
    fn new() -> Self {
        let bus = HostBus::default();
        let drive = Odrive::new(DRIVE, bus.clone(), compensator()).unwrap();
        Self { joint: Joint::before(drive), bus, seen: 0, errors: 0, state: 1, silent: false, periods: 0 }
    }

    /// Operational, watched for long enough, the drive heard.
    fn started() -> Self {
        let mut bench = Self::new();
        bench.joint.come(0x000, &[1, 0]);
        bench.periods(WATCHING as usize + 2);
        bench
    }

    fn enabled() -> Self {
        let mut bench = Self::started();
        for controlword in [0x06, 0x07, 0x0f] {
            bench.cycle(controlword);
        }
        bench.cycles(0x0f, 20);
        assert_eq!(bench.status(), 0x27);
        assert!(bench.torques());
        bench
    }

    fn period(&mut self) {
        if self.periods.is_multiple_of(HEARTBEAT) && !self.silent {
            let [e0, e1, e2, e3] = self.errors.to_le_bytes();
            self.bus.put(Frame::of(FIRST + 0x01, &[e0, e1, e2, e3, self.state, 0, 0, 0]));
        }
        self.joint.periods(1);
        self.periods += 1;
        for frame in &self.bus.sent()[self.seen..] {
            match (frame.number(), frame.data()) {
                IDLE => self.state = 1,
                CLOSED_LOOP if self.errors == 0 => self.state = 8,
                CLEAR => self.errors = 0,
                _ => {}
            }
            self.seen += 1;
        }
    }

    fn periods(&mut self, count: usize) {
        (0..count).for_each(|_| self.period());
    }

    fn cycle(&mut self, controlword: u8) {
        let [p0, p1, p2, p3] = 1000_i32.to_le_bytes();
        self.joint.come(0x200 + NODE, &[controlword, 0, 8, p0, p1, p2, p3]);
        self.joint.come(0x080, &[]);
        self.periods(10);
    }

    fn cycles(&mut self, controlword: u8, count: usize) {
        (0..count).for_each(|_| self.cycle(controlword));
    }

    /// State by the statusword.
    fn status(&self) -> u8 {
        self.joint.told(0x180 + NODE)[0] & 0x6f
    }

    fn named(&self) -> u16 {
        let told = self.joint.told(0x080 + NODE);
        u16::from_le_bytes([told[0], told[1]])
    }

    /// The last frames to the drive, but for so many.
    fn frames_from(&self, seen: usize) -> Vec<(u16, Vec<u8>)> {
        self.bus.sent()[seen..].iter().map(|frame| (frame.number(), frame.data().to_vec())).collect()
    }

    /// The last frame to the drive is a torque.
    fn torques(&self) -> bool {
        self.bus.sent().last().is_some_and(|frame| frame.number() == FIRST + 0x0e)
    }

    /// Periods until the drive is told to be idle.
    fn until_idle(&mut self) -> usize {
        let (seen, begin) = (self.seen, self.periods);
        while !self.frames_from(seen).contains(&owned(IDLE)) {
            assert!(self.periods < begin + 10_000);
            self.period();
        }
        self.periods - begin
    }
}

fn owned((id, data): (u16, &[u8])) -> (u16, Vec<u8>) {
    (id, data.to_vec())
}

#[test]
fn frames_of_enabling_are_those_of_the_documentation() {
    let mut bench = Bench::started();
    let frames = bench.frames_from(0);
    assert_eq!(frames[..4], [IDLE, NO_TORQUE, IDLE, NO_TORQUE].map(owned));
    // A frame every 0.3 ms.
    assert_eq!(frames.len(), (WATCHING as usize + 2).div_ceil(3));
    for controlword in [0x06, 0x07] {
        bench.cycle(controlword);
    }
    let seen = bench.seen;
    bench.cycle(0x0f);
    // Not before the drive's heartbeat says that it is in closed-loop control.
    assert_eq!((bench.status(), bench.joint.input.status.contains(Status::DRIVE_OFF)), (0x23, true));
    bench.cycles(0x0f, 20);
    assert_eq!((bench.status(), bench.joint.input.status.contains(Status::DRIVE_OFF)), (0x27, false));
    let frames = bench.frames_from(seen);
    let begin = frames.iter().position(|frame| *frame == owned(CLEAR)).unwrap();
    assert_eq!(frames[begin..begin + 4], [CLEAR, TORQUE_MODE, NO_TORQUE, CLOSED_LOOP].map(owned));
    assert!(frames[begin + 4..].iter().all(|(id, _)| *id == FIRST + 0x0e));
}

#[test]
fn a_torque_is_sent_every_third_period_and_not_for_long() {
    let (bus, mut sent) = (HostBus::default(), 0);
    let mut drive = Odrive::new(DRIVE, bus.clone(), compensator()).unwrap();
    let mut period = |wanted, torque: Option<f32>, state: u8| {
        bus.put(Frame::of(FIRST + 0x01, &[0, 0, 0, 0, state, 0, 0, 0]));
        let report = drive.listen(1);
        drive.command(wanted, torque);
        let frames = bus.sent()[sent..].to_vec();
        sent += frames.len();
        (report, frames)
    };
    (0..16).for_each(|_| _ = period(Wanted::Standby, Some(0.0), 1));
    let mut torques = Vec::new();
    for k in 0..30 {
        let (report, frames) = period(Wanted::On, (k < 9).then_some(k as f32), 8);
        assert!(report.powered && report.ready && report.fault.is_none());
        assert!(frames.len() <= 1);
        torques.extend(frames.iter().map(|frame| {
            assert_eq!(frame.number(), FIRST + 0x0e);
            f32::from_le_bytes(frame.data().try_into().unwrap())
        }));
    }
    assert_eq!(torques.len(), 10);
    let peak = compensator().limits().motor_torque;
    assert!(torques[..3].windows(2).all(|pair| pair[1] == (pair[0] + 3.0).min(peak)), "{torques:?}");
    // Older than 0.5 ms there is none.
    assert!(torques[5..].iter().all(|torque| *torque == 0.0), "{torques:?}");
}

#[test]
fn a_silent_drive_is_off_within_three_heartbeats_and_named() {
    let mut bench = Bench::enabled();
    bench.silent = true;
    let after = bench.until_idle();
    assert!((SILENCE - HEARTBEAT..SILENCE + 10).contains(&after), "{after}");
    bench.periods(2);
    assert_eq!(bench.named(), 0x7500);
    assert!(bench.joint.input.status.contains(Status::DRIVE_OFF));
    // Without a heartbeat a reset leads nowhere; with one it does, and the control is not reset.
    bench.cycles(0x80, 300);
    assert_eq!(bench.status() & 0x4f, 0x08);
    bench.silent = false;
    bench.cycle(0x00);
    bench.cycles(0x80, 20);
    assert_eq!((bench.status() & 0x4f, bench.named()), (0x40, 0));
    assert!(!bench.joint.source.reset_requested());
}

#[test]
fn an_error_of_the_drive_is_named_and_cleared_by_a_reset() {
    for (errors, state) in [(0x1000, 1), (0x1000, 8), (0, 1)] {
        let mut bench = Bench::enabled();
        (bench.errors, bench.state) = (errors, state);
        assert!(bench.until_idle() <= HEARTBEAT + 1);
        bench.periods(2);
        assert_eq!(bench.named(), 0x5400);
        let seen = bench.seen;
        bench.cycles(0x00, 10);
        assert!(!bench.frames_from(seen).contains(&owned(CLEAR)));
        bench.cycles(0x80, 20);
        assert!(bench.frames_from(seen).contains(&owned(CLEAR)));
        assert_eq!((bench.status() & 0x4f, bench.named()), (0x40, 0), "{errors:#x}");
        assert!(!bench.joint.source.reset_requested());
    }
}

#[test]
fn a_drive_with_an_error_or_unheard_is_not_switched_on() {
    let mut bench = Bench::new();
    bench.silent = true;
    bench.joint.come(0x000, &[1, 0]);
    bench.periods(WATCHING as usize + 300);
    bench.cycle(0x06);
    // No fault: it may start later.
    assert_eq!(bench.status(), 0x00);
    // Heard, but it still starts.
    (bench.silent, bench.errors) = (false, 0x01);
    bench.cycles(0x00, 10);
    assert_eq!(bench.status(), 0x00);
    bench.errors = 0;
    bench.cycles(0x00, 10);
    assert_eq!(bench.status() & 0x4f, 0x40);
    bench.errors = 0x40;
    bench.cycles(0x00, 10);
    assert_eq!((bench.status() & 0x4f, bench.named()), (0x08, 0x5400));
}

#[test]
fn a_joint_in_safe_or_switched_off_makes_the_drive_idle_at_once() {
    let mut bench = Bench::enabled();
    (bench.joint.output.mode, bench.joint.output.faults) = (Mode::Safe, Faults::MOTOR_ENCODER_LOST);
    assert!(bench.until_idle() <= 1);
    bench.periods(2);
    assert_eq!(bench.named(), 0x7305);
    let mut bench = Bench::enabled();
    bench.joint.come(0x200 + NODE, &[0x06, 0, 8, 0, 0, 0, 0]);
    bench.joint.come(0x080, &[]);
    assert!(bench.until_idle() <= 2);
}

#[test]
fn numbers_out_of_range_are_no_drive() {
    let of = |number| Odrive::new(number, HostBus::default(), compensator());
    assert!(of(62).is_some() && of(63).is_none());
}
