//! The firmware's control on the host, on a board that is wires: a count goes in, the drive's code and enable come out.

use std::cell::Cell;
use std::rc::Rc;

use strainwave::compensator::{Input, Output};
use strainwave_app::command_source::CommandSource;
use strainwave_app::jog::Jog;
use strainwave_app::operated::Operated;
use strainwave_app::{Board, Compensator, Control, Telemetry};

/// Code of no torque, and from there to the peak torque.
const NEUTRAL: i32 = 2048;
const SPAN: i32 = 2047;

/// The drive's code, and that it is enabled.
pub type Drive = (u32, bool);

/// A drive that was released.
pub const RELEASED: Drive = (NEUTRAL.cast_unsigned(), false);

/// Torque of a drive whose largest is `peak` (N m).
pub fn torque((code, enabled): Drive, peak: f32) -> f64 {
    if enabled { f64::from(peak) / f64::from(SPAN) * f64::from(code.cast_signed() - NEUTRAL) } else { 0.0 }
}

/// The control.
pub struct Host<B: Board> {
    control: Control<B>,
    wires: Rc<Wires>,
    /// Steps unlike the chip's.
    pub different: u64,
}

impl<B: Board> Host<B> {
    /// On a board around the host's, with the moves of its joint.
    pub fn new(
        compensator: &'static Compensator,
        around: impl FnOnce(HostBoard) -> B,
    ) -> (Self, &'static Jog) {
        let jog = Box::leak(Box::new(Jog::new()));
        (Self::commanded_by(Operated::new(jog), compensator, around), jog)
    }

    /// On a board around the host's, with these commands of its joint.
    pub fn commanded_by<S: CommandSource>(
        source: S,
        compensator: &'static Compensator,
        around: impl FnOnce(HostBoard<S>) -> B,
    ) -> Self {
        let scale = SPAN as f32 / compensator.limits().motor_torque;
        let wires = Rc::new(Wires { scale, ..Wires::default() });
        let board = around(HostBoard { wires: wires.clone(), source });
        let (sender, _) = Box::leak(Box::new(Telemetry::new())).split();
        Self { control: Control::new(board, compensator, sender), wires, different: 0 }
    }

    /// One period, with the encoder at `count`, `None` where it is not read.
    pub fn step(&mut self, count: Option<u32>) {
        self.wires.count.set(count);
        self.control.tick();
    }

    /// The same beside that of a chip which drives so.
    pub fn compare(&mut self, count: Option<u32>, drive: Drive) {
        self.step(count);
        self.different += u64::from(drive != self.wires.drive.get());
    }
}

/// What the host's board is connected to.
#[derive(Default)]
struct Wires {
    count: Cell<Option<u32>>,
    /// Steps of the drive's code per torque (1/(N m)).
    scale: f32,
    drive: Cell<Drive>,
}

/// The board as it is on the host.
pub struct HostBoard<S = Operated> {
    wires: Rc<Wires>,
    source: S,
}

impl<S: CommandSource> Board for HostBoard<S> {
    const REPORT_EVERY: u32 = 10;

    fn input(&mut self, input: &mut Input<f32>) -> bool {
        self.source.input(self.wires.count.get(), input);
        true
    }

    fn command(&mut self, torque: f32) {
        self.source.commanded(torque);
        let steps = (torque * self.wires.scale) as i32;
        self.wires.drive.set(((NEUTRAL + steps.clamp(-SPAN, SPAN)).cast_unsigned(), true));
    }

    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        self.source.report(output);
    }

    fn release(&mut self) {
        self.wires.drive.set(RELEASED);
    }

    fn feed_watchdog(&mut self) {}

    fn overran(&mut self) -> bool {
        false
    }

    fn reset_requested(&mut self) -> bool {
        self.source.reset_requested()
    }

    fn reset(&mut self) {
        self.source.reset();
    }
}
