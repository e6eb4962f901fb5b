//! A joint without a controller above it: the observer watches it, then it holds the position that it has, and an operator moves that.

use strainwave::compensator::{CompensationGains, Input, Output, Setpoint};

use crate::command_source::{CommandSource, sensors};
use crate::jog::Jog;

/// Gains once the joint holds: all 1, but the friction's below that which could drive it.
pub(crate) const GAINS: CompensationGains<f32> =
    CompensationGains { friction: 0.8, ..CompensationGains::ALL };

/// Periods in which the observer only watches, before the joint holds where it then is: 0.1 s.
pub const WATCHING: u32 = 1000;

/// An operated joint with a motor encoder alone, whose drive has a current loop of its own: the motor's torque is taken to be the last
/// command.
pub struct Operated {
    jog: &'static Jog,
    /// The last torque command (N m).
    torque: f32,
    watched: u32,
    /// Angle of the output, at rest.
    here: Setpoint<f32>,
}

impl Operated {
    /// A joint at rest, with the moves that its operator wants.
    pub fn new(jog: &'static Jog) -> Self {
        Self { jog, torque: 0.0, watched: 0, here: Setpoint::default() }
    }
}

impl CommandSource for Operated {
    #[inline(always)]
    fn input(&mut self, count: Option<u32>, input: &mut Input<f32>) {
        let (sensors, status) = sensors(count, self.torque);
        let (setpoint, gains) = match self.jog.step() {
            Some(setpoint) => (setpoint, GAINS),
            None => (self.here, CompensationGains::default()),
        };
        let (command, gains) = (setpoint.into(), gains.into());
        *input = Input { sensors, status, command, gains, ..Input::default() };
    }

    /// Watches the joint again, before it holds where it then is: it may have been moved without a drive.
    fn reset(&mut self) {
        self.jog.forget();
        *self = Self::new(self.jog);
    }

    #[inline(always)]
    fn commanded(&mut self, torque: f32) {
        self.torque = torque;
    }

    /// Takes a step's outputs: only before it holds is it asked where the output is.
    #[inline(always)]
    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        if self.watched == WATCHING {
            return;
        }
        self.here.position = output().estimate.output_position;
        self.watched += 1;
        if self.watched == WATCHING {
            self.jog.hold(self.here.position);
        }
    }
}
