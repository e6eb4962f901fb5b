//! A joint that a controller commands over CAN: from frames on its bus to the input of the control step, and back.

use std::time::Duration;

use embedded_can::{Frame as _, StandardId};
use strainwave::Angle;
use strainwave::compensator::actuate::mode::UNSAFE;
use strainwave::compensator::{Command, CompensationGains, Faults, Mode, Setpoint, Status};
use strainwave_app::command_source::CommandSource;
use strainwave_app::commanded::{BusNode, Commanded, Drive, Exchange, Frame, Wired, node};
use strainwave_app::operated::WATCHING;
use strainwave_app::{Compensator, Input, Output, joint};
use strainwave_desktop::GearFile;
use strainwave_emulator::chips::host_bus::HostBus;
use strainwave_emulator::chips::{Chip, MODELS};
use strainwave_emulator::firmware::Program;
use strainwave_emulator::pil;

/// Number of the node, and counts of the bus in those of an angle.
pub const NODE: u16 = 5;
const COUNT: i64 = 64;
/// Control periods of a cycle of the bus, and of the silence that ends in braking.
const CYCLE: usize = 10;
const TIMEOUT: usize = 500;

/// The joint with its node and the drive behind it, and a master that sends a cycle of targets again and again.
pub struct Joint<D = Wired> {
    pub source: Commanded,
    node: BusNode<HostBus, D>,
    bus: HostBus,
    pub output: Output<f32>,
    pub input: Input<f32>,
}

impl Joint {
    fn new() -> Self {
        Self::before(Wired)
    }

    /// Operational, off, watched for long enough.
    fn started() -> Self {
        let mut joint = Self::new();
        joint.come(0x000, &[1, 0]);
        joint.periods(WATCHING as usize + 2);
        joint
    }

    /// Switched on where it is.
    fn enabled() -> Self {
        let mut joint = Self::started();
        joint.switch_on(1000);
        assert!(!joint.input.status.contains(Status::DRIVE_OFF));
        joint
    }
}

impl<D: Drive> Joint<D> {
    pub fn before(drive: D) -> Self {
        let exchange: &'static Exchange = Box::leak(Box::new(Exchange::new()));
        let compensator = Compensator::from_words(&joint::WORDS).unwrap();
        let bus = HostBus::default();
        let mut output = Output { mode: Mode::Ready, ..Output::default() };
        output.estimate.output_position = Angle::from_counts(1000 * COUNT);
        Self {
            source: Commanded::new(exchange, compensator),
            node: BusNode::new(node(NODE as u8, compensator).unwrap(), bus.clone(), drive, exchange),
            bus,
            output,
            input: Input::default(),
        }
    }

    pub fn switch_on(&mut self, target: i32) {
        for controlword in [0x06, 0x07, 0x0f] {
            self.cycle(controlword, 8, target);
        }
    }

    pub fn come(&mut self, id: u16, data: &[u8]) {
        self.bus.put(Frame::of(id, data));
    }

    pub fn periods(&mut self, count: usize) {
        for _ in 0..count {
            self.source.input(Some(7), &mut self.input);
            let output = self.output;
            self.source.report(|| output);
            self.node.poll();
        }
    }

    pub fn cycle(&mut self, controlword: u8, mode: i8, target: i32) {
        let [p0, p1, p2, p3] = target.to_le_bytes();
        self.come(0x200 + NODE, &[controlword, 0, mode.cast_unsigned(), p0, p1, p2, p3]);
        self.come(0x080, &[]);
        self.periods(CYCLE);
    }

    /// Data of the last frame of this kind.
    pub fn told(&self, id: u16) -> Vec<u8> {
        self.bus.sent().iter().rfind(|frame| frame.number() == id).unwrap().data().to_vec()
    }

    fn position(&self) -> Setpoint<f32> {
        let Command::Position(setpoint) = self.input.command else { panic!("{:?}", self.input.command) };
        setpoint
    }
}

fn counts(angle: Angle<f32>) -> f64 {
    (angle.counts as f64 + f64::from(angle.rest)) / COUNT as f64
}

#[test]
fn a_frame_of_a_word_is_that_of_its_bytes() {
    let bytes = [1, 2, 3, 4, 5, 6, 7, 8];
    for length in 0..=8 {
        let word = Frame::of_word(StandardId::new(0x123).unwrap(), length as u8, u64::from_le_bytes(bytes));
        assert_eq!(Some(word), Frame::of(0x123, &bytes[..length]));
        assert_eq!(word.word().to_le_bytes()[..length], bytes[..length]);
    }
}

#[test]
fn it_is_off_until_it_is_switched_on_and_then_holds_where_it_is() {
    let mut joint = Joint::started();
    assert!(joint.input.status.contains(Status::DRIVE_OFF));
    assert_eq!(joint.input.gains, CompensationGains::default().into());
    joint.output.estimate.output_position = Angle::from_counts(1234 * COUNT);
    for controlword in [0x06, 0x07, 0x0f] {
        assert!(joint.input.status.contains(Status::DRIVE_OFF));
        joint.cycle(controlword, 8, 1234);
    }
    assert_eq!((joint.input.status, joint.input.setpoint_age), (Status::FINE, 0.0));
    assert!((counts(joint.position().position) - 1234.0).abs() < 1e-3);
    assert_ne!(joint.input.gains, CompensationGains::default().into());
}

#[test]
fn a_first_target_that_is_far_away_moves_nothing() {
    let mut joint = Joint::enabled();
    let far = 1000 + (6e-3 / std::f64::consts::TAU * f64::from(1 << 26)) as i32;
    for _ in 0..20 {
        joint.cycle(0x0f, 8, far);
        assert!((counts(joint.position().position) - 1000.0).abs() < 1e-3);
    }
    let follows = |joint: &Joint| joint.told(0x180 + NODE)[1] & 1 << 4 != 0;
    assert!(!follows(&joint));
    // One that is near does.
    (0..20).for_each(|_| joint.cycle(0x0f, 8, 1100));
    assert!(follows(&joint));
    assert!((counts(joint.position().position) - 1100.0).abs() < 1e-3);
    // From there on the joint's top speed counts: 5 mrad is less than it does in two cycles, 0.1 rad is more.
    (0..20).for_each(|_| joint.cycle(0x0f, 8, 1100 + far / 2));
    assert!(follows(&joint));
    (0..20).for_each(|_| joint.cycle(0x0f, 8, 1100 + 20 * far));
    assert!(!follows(&joint));
    assert!((counts(joint.position().position) - 1000.0).abs() < 1e-3, "it holds where it is");
}

#[test]
fn targets_are_interpolated_and_wrap() {
    let mut joint = Joint::enabled();
    let (mut target, step) = (1000_i32, 20_000_000 / 1000);
    for cycle in 0..400 {
        target = target.wrapping_add(step);
        joint.cycle(0x0f, 8, target);
        if cycle > 10 {
            let velocity = f64::from(joint.position().velocity);
            let expected = f64::from(step) * 1e3 * std::f64::consts::TAU / f64::from(1 << 26);
            assert!((velocity / expected - 1.0).abs() < 1e-3, "{velocity} {expected}");
        }
    }
    // Over the end of the counts, as the joint's own angle goes on.
    let mut joint = Joint::started();
    joint.output.estimate.output_position = Angle::from_counts(i64::from(i32::MAX) * COUNT);
    joint.switch_on(i32::MAX);
    (0..20).for_each(|_| joint.cycle(0x0f, 8, i32::MIN + 9));
    assert!((counts(joint.position().position) - f64::from(i32::MAX) - 10.0).abs() < 1e-3);
}

#[test]
fn a_silent_bus_ages_the_target_then_brakes_and_then_switches_off() {
    let mut joint = Joint::enabled();
    (0..20).for_each(|_| joint.cycle(0x0f, 8, 1000));
    joint.output.estimate.output_velocity = 1.0;
    joint.periods(2 * CYCLE);
    // The last target came a cycle before, which none is missing.
    assert!((joint.input.setpoint_age - 1.9e-3).abs() < 2e-4, "{}", joint.input.setpoint_age);
    joint.periods(TIMEOUT);
    assert_eq!((joint.input.setpoint_age, joint.input.status), (1.0, Status::FINE));
    // Through a reversal it goes on braking.
    joint.output.estimate.output_velocity = 1e-4;
    joint.periods(50);
    joint.output.estimate.output_velocity = -1.0;
    joint.periods(50);
    assert_eq!(joint.input.status, Status::FINE);
    joint.output.estimate.output_velocity = 1e-4;
    joint.periods(103);
    assert!(joint.input.status.contains(Status::DRIVE_OFF));
    assert_eq!(joint.told(0x080 + NODE)[..2], 0x8250_u16.to_le_bytes());
}

/// The joint in Safe by this fault, without a SYNC since then: what it names.
fn named(fault: Faults) -> u16 {
    let mut joint = Joint::enabled();
    (joint.output.mode, joint.output.faults) = (Mode::Safe, fault);
    joint.periods(2);
    assert!(joint.input.status.contains(Status::DRIVE_OFF));
    let told = joint.told(0x080 + NODE);
    u16::from_le_bytes([told[0], told[1]])
}

#[test]
fn every_fault_that_leads_to_safe_has_its_error_code_at_once() {
    let codes = [
        (Faults::MOTOR_ENCODER_LOST, 0x7305),
        (Faults::MOTOR_ENCODER_FROZEN, 0x7305),
        (Faults::GEAR_OVERLOAD, 0x8311),
        (Faults::DRIVE_NOT_FOLLOWING, 0x8300),
        (Faults::LIMIT_CYCLE, 0x8300),
        (Faults::OVERSPEED, 0x8400),
        (Faults::FOLLOWING_ERROR, 0x8611),
        (Faults::PERIOD_OUT_OF_RANGE, 0x6100),
        (Faults::RESTARTED, 0x6010),
    ];
    let all = codes.iter().fold(Faults::NONE, |all, (fault, _)| all.with(*fault));
    assert_eq!(all, UNSAFE);
    for (fault, code) in codes {
        assert_eq!(named(fault), code, "{:?}", fault.names().collect::<Vec<_>>());
    }
    assert_eq!(named(Faults::CONTROL_OVERRUN), 0x6100);
}

#[test]
fn a_fault_of_the_joint_is_reset_when_the_joint_is_ready_again() {
    let mut joint = Joint::enabled();
    (joint.output.mode, joint.output.faults) = (Mode::Safe, Faults::MOTOR_ENCODER_LOST);
    joint.cycle(0x0f, 8, 1000);
    assert!(!joint.source.reset_requested());
    joint.cycle(0x00, 8, 1000);
    joint.come(0x200 + NODE, &[0x80, 0, 8, 0, 0, 0, 0]);
    joint.come(0x080, &[]);
    joint.periods(1);
    assert!(joint.source.reset_requested() && !joint.source.reset_requested());
    joint.source.reset();
    (joint.output.mode, joint.output.faults) = (Mode::Ready, Faults::NONE);
    joint.periods(WATCHING as usize - 10);
    assert_eq!(joint.told(0x080 + NODE)[..2], 0x7305_u16.to_le_bytes());
    joint.periods(20);
    assert_eq!(joint.told(0x080 + NODE)[..2], [0, 0]);
}

#[test]
fn a_fault_of_the_bus_leaves_the_joint_s_angle_alone() {
    let mut joint = Joint::enabled();
    (0..20).for_each(|_| joint.cycle(0x0f, 8, 1000));
    joint.periods(TIMEOUT + 200);
    joint.cycle(0x00, 8, 1000);
    joint.cycle(0x80, 8, 1000);
    joint.cycle(0x00, 8, 1000);
    assert_eq!(joint.told(0x080 + NODE)[..2], [0, 0]);
    assert!(!joint.source.reset_requested());
    joint.switch_on(1000);
    assert!(!joint.input.status.contains(Status::DRIVE_OFF));
}

#[test]
fn without_a_torque_the_joint_is_stopped_and_does_not_coast() {
    let mut joint = Joint::enabled();
    joint.come(0x300 + NODE, &[0, 0, 0, 0, 0x10, 0]);
    joint.cycle(0x0f, 10, 0);
    assert!(matches!(joint.input.command, Command::Torque(_)));
    // Before the bus is taken for lost.
    joint.periods(250);
    let stopped = Command::Velocity { velocity: 0.0, acceleration: 0.0 };
    assert_eq!(joint.input.command, stopped);
    // A quick stop, too.
    joint.come(0x300 + NODE, &[0, 0, 0, 0, 0x10, 0]);
    joint.cycle(0x0f, 10, 0);
    assert!(matches!(joint.input.command, Command::Torque(_)));
    joint.output.estimate.output_velocity = 1.0;
    joint.cycle(0x02, 10, 0);
    assert_eq!((joint.input.command, joint.input.status), (stopped, Status::FINE));
}

#[test]
fn without_its_node_the_joint_is_off() {
    let mut joint = Joint::enabled();
    for _ in 0..101 {
        joint.source.input(Some(7), &mut joint.input);
    }
    assert!(joint.input.status.contains(Status::DRIVE_OFF));
}

#[test]
fn it_is_not_switched_on_before_it_was_watched_and_not_without_its_encoder() {
    let mut joint = Joint::new();
    joint.come(0x000, &[1, 0]);
    joint.periods(WATCHING as usize / 2);
    joint.switch_on(1000);
    assert!(joint.input.status.contains(Status::DRIVE_OFF));
    joint.source.input(None, &mut joint.input);
    joint.periods(WATCHING as usize - 100);
    joint.switch_on(1000);
    assert!(joint.input.status.contains(Status::DRIVE_OFF));
    joint.periods(100);
    joint.switch_on(1000);
    assert!(!joint.input.status.contains(Status::DRIVE_OFF));
}

#[test]
fn velocity_and_torque_are_commanded_as_such() {
    let mut joint = Joint::enabled();
    joint.come(0x300 + NODE, &[0, 0, 0, 1, 0, 0]);
    joint.cycle(0x0f, 9, 0);
    let velocity = std::f64::consts::TAU / 4.0;
    let Command::Velocity { velocity: commanded, .. } = joint.input.command else { panic!() };
    assert!((f64::from(commanded) / velocity - 1.0).abs() < 1e-6);
    joint.come(0x300 + NODE, &[0, 0, 0, 0, 0xf4, 0x01]);
    joint.cycle(0x0f, 10, 0);
    let rated = Compensator::from_words(&joint::WORDS).unwrap().limits().output_torque;
    let Command::Torque(torque) = joint.input.command else { panic!() };
    assert!((torque / (0.5 * rated) - 1.0).abs() < 1e-6);
}

/// Frames of an executed node in so many milliseconds.
fn frames(chip: &mut Chip, milliseconds: u64) -> Vec<Frame> {
    chip.run(Duration::from_millis(milliseconds)).unwrap();
    chip.bus().take()
}

#[test]
fn an_executed_node_drops_what_nobody_takes_and_joins_again() {
    let gear = GearFile::default_gear();
    let model = MODELS.iter().find(|model| model.has_can).unwrap();
    let elf = pil::build_as(Program::Commanded { node: NODE as u8 }, model.board, &gear).unwrap().elf;
    let mut chip = Chip::boot(model, &elf).unwrap();
    // Boot-up, and a heartbeat every 100 ms.
    let heartbeats = |frames: &[Frame]| frames.iter().filter(|frame| frame.number() == 0x700 + NODE).count();
    assert_eq!(heartbeats(&frames(&mut chip, 250)), 3);
    chip.bus().answers(false);
    assert_eq!(frames(&mut chip, 350), []);
    // Of the three heartbeats meanwhile none is left, but what is sent by then.
    chip.bus().answers(true);
    assert!(frames(&mut chip, 5).len() <= 1);
    assert_eq!(heartbeats(&frames(&mut chip, 200)), 2);
    chip.bus().set_bus_off();
    assert_eq!(heartbeats(&frames(&mut chip, 200)), 2);
    chip.bus().put(Frame::of(0x600 + NODE, &[0x40, 0x00, 0x10, 0, 0, 0, 0, 0]).unwrap());
    let answers = frames(&mut chip, 2);
    let answer = Frame::of(0x580 + NODE, &[0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00]).unwrap();
    assert!(answers.contains(&answer), "{answers:x?}");
}
