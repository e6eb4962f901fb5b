//! The board as the control sees it.

use core::marker::PhantomData;
use strainwave_app::command_source::CommandSource;
use strainwave_app::operated::Operated;
use strainwave_app::{Input, Output};
use strainwave_drivers::Encoder;

use crate::idle::JOG;
use crate::{Chip, MotorEncoder, Timer, Watchdog};

/// The motor's drive.
pub trait Drive {
    /// Commands a torque at the motor's shaft (N m).
    fn command(&mut self, torque: f32);
    /// Takes the torque off and disables the drive.
    fn release(&mut self);
}

/// A motor encoder and a drive on a chip, and where the joint's commands come from: an operator, if nobody else.
pub struct Board<C, E, D, S = Operated> {
    encoder: MotorEncoder<E>,
    drive: D,
    source: S,
    restarted: bool,
    chip: PhantomData<C>,
}

impl<C: Chip, E: Encoder, D: Drive> Board<C, E, D> {
    /// `restarted`: the chip was reset by a watchdog or the firmware itself, so that nobody has looked after the cause.
    pub fn new(encoder: MotorEncoder<E>, drive: D, restarted: bool) -> Self {
        Self { encoder, drive, source: Operated::new(&JOG), restarted, chip: PhantomData }
    }

    /// The same with other commands.
    #[cfg(feature = "can")]
    pub fn commanded_by<S>(self, source: S) -> Board<C, E, D, S> {
        let Self { encoder, drive, restarted, chip, .. } = self;
        Board { encoder, drive, source, restarted, chip }
    }
}

impl<C: Chip, E: Encoder, D: Drive, S: CommandSource> strainwave_app::Board for Board<C, E, D, S> {
    fn restarted(&self) -> bool {
        self.restarted
    }

    // 1000 reports a second, of 40 bytes at most, fit through 921600 Bd twice over.
    const REPORT_EVERY: u32 = 10;

    // A function of its own: what reads the encoder and goes through a move is not on the stack while the control step is.
    #[inline(never)]
    fn input(&mut self, input: &mut Input<f32>) -> bool {
        self.source.input(self.encoder.count(), input);
        true
    }

    fn command(&mut self, torque: f32) {
        self.source.commanded(torque);
        self.drive.command(torque);
    }

    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        self.source.report(output);
    }

    fn release(&mut self) {
        self.drive.release();
    }

    fn feed_watchdog(&mut self) {
        C::Watchdog::feed();
    }

    fn overran(&mut self) -> bool {
        C::Timer::waiting()
    }

    fn reset_requested(&mut self) -> bool {
        self.source.reset_requested()
    }

    fn reset(&mut self) {
        self.source.reset();
    }
}
