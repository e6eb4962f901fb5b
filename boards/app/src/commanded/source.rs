//! Commands of the joint from the targets that come over the bus.

use core::f32::consts::TAU;
use strainwave::Angle;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{Command, CompensationGains, Input, Mode, Output, Sensors, Setpoint, Status};
use strainwave::trajectory::{Cyclic, CyclicState};
use strainwave_drivers::cia402::node::{Actual, Target, Wanted};

use crate::command_source::CommandSource;
use crate::commanded::error_code;
use crate::commanded::exchange::{Exchange, Order};
use crate::operated::GAINS;

/// Bits of a count of [`Angle`] below one of the bus, which has 2^26 in a revolution.
const BELOW: u32 = 32 - 26;
/// Counts of the bus in 1 rad, and the inverse.
const COUNTS: f32 = (1 << 26) as f32 / TAU;
const RADIANS: f32 = TAU / (1 << 26) as f32;

/// Farthest first position from where the joint is (rad). One that is farther is not followed, and the joint holds: it would set out at once.
const NEAR: f32 = 5e-3;
/// Speed below which the joint rests (rad/s).
const AT_REST: f32 = 0.01;
/// Age of a command that the joint is to brake from (s): far beyond any that is followed.
const OLD: f32 = 1.0;

/// A joint with a motor encoder alone, whose drive has a current loop of its own: the motor's torque is taken to be the last command.
pub struct Commanded {
    exchange: &'static Exchange,
    /// Of this period.
    order: Order,
    /// Torque of the drive (N m).
    torque: f32,
    /// Interpolation for the bus's cycle, and that (control periods).
    cyclic: Option<Cyclic<f32>>,
    cycle: u32,
    interpolated: CyclicState<f32>,
    /// What the joint follows.
    follows: Follows,
    /// Periods since the last target.
    silent: u32,
    /// Where the joint was when it last followed no position.
    held: Angle<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Follows {
    /// It holds: no target has come yet.
    Nothing,
    /// Positions, of which this was the last: whole counts of the bus.
    Positions(Angle<f32>),
    Velocity(f32),
    Torque(f32),
}

impl Commanded {
    /// A joint whose bus is at the exchange's other end.
    pub fn new(exchange: &'static Exchange) -> Self {
        Self {
            exchange,
            order: Order::default(),
            torque: 0.0,
            cyclic: None,
            cycle: 0,
            interpolated: CyclicState::default(),
            follows: Follows::Nothing,
            silent: 0,
            held: Angle::default(),
        }
    }

    fn take(&mut self, order: Order) {
        if order.cycle != self.cycle {
            (self.cycle, self.interpolated) = (order.cycle, CyclicState::default());
            self.cyclic = Cyclic::build(order.cycle, CONTROL_PERIOD as f32).ok();
        }
        self.silent = self.silent.saturating_add(1);
        if order.wanted == Wanted::Off {
            (self.follows, self.interpolated) = (Follows::Nothing, CyclicState::default());
        } else if let Some(target) = order.target {
            self.follow(target);
        }
        self.order = order;
    }

    fn follow(&mut self, target: Target) {
        self.silent = 0;
        let target = match target {
            Target::Position(counts) => return self.follow_position(counts),
            Target::Velocity(counts) => Follows::Velocity(counts as f32 * RADIANS),
            Target::Torque(torque) => Follows::Torque(torque),
        };
        (self.follows, self.interpolated) = (target, CyclicState::default());
    }

    fn follow_position(&mut self, counts: i32) {
        let (last, is_first) = match self.follows {
            Follows::Positions(last) => (last, false),
            _ => (Angle::from_counts(self.held.counts >> BELOW << BELOW), true),
        };
        let way = counts.wrapping_sub(bus_counts(last));
        if is_first && way.unsigned_abs() > (NEAR * COUNTS) as u32 {
            self.follows = Follows::Nothing;
            return;
        }
        let target = Angle::from_counts(last.counts.wrapping_add(i64::from(way) << BELOW));
        self.follows = Follows::Positions(target);
        if let Some(cyclic) = &self.cyclic {
            cyclic.take(&mut self.interpolated, target);
        }
    }

    /// The command of this period and its age (s).
    fn command(&mut self) -> (Command<f32>, f32) {
        let silence = self.silent.saturating_sub(self.cycle).min(1 << 16) as f32 * CONTROL_PERIOD as f32;
        match self.follows {
            Follows::Nothing => (at_rest(self.held).into(), 0.0),
            Follows::Positions(_) => {
                let setpoint = self.cyclic.as_ref().and_then(|cyclic| cyclic.step(&mut self.interpolated));
                (setpoint.unwrap_or(at_rest(self.held)).into(), silence)
            }
            Follows::Velocity(velocity) => (Command::Velocity { velocity, acceleration: 0.0 }, silence),
            Follows::Torque(torque) => (Command::Torque(torque), silence),
        }
    }
}

fn at_rest(position: Angle<f32>) -> Setpoint<f32> {
    Setpoint { position, ..Setpoint::default() }
}

/// The angle in counts of the bus, of which there are 2^32 before they begin again.
fn bus_counts(angle: Angle<f32>) -> i32 {
    (angle.counts >> BELOW) as i32
}

impl CommandSource for Commanded {
    #[inline(always)]
    fn input(&mut self, count: Option<u32>, input: &mut Input<f32>) {
        let order = self.exchange.take();
        self.take(order);
        let (motor_encoder, mut status) = match count {
            Some(count) => (count, Status::FINE),
            None => (0, Status::MOTOR_ENCODER_INVALID),
        };
        let (command, mut setpoint_age) = self.command();
        let mut gains = GAINS;
        match order.wanted {
            Wanted::On => {}
            Wanted::Brake => setpoint_age = OLD,
            Wanted::Off => {
                (gains, self.torque) = (CompensationGains::default(), 0.0);
                status = status.with(Status::DRIVE_OFF);
            }
        }
        let sensors =
            Sensors { motor_encoder, output_encoder: None, motor_torque: self.torque, output_torque: None };
        *input = Input { sensors, status, command, gains: gains.into(), setpoint_age, ..Input::default() };
    }

    #[inline(always)]
    fn commanded(&mut self, torque: f32) {
        self.torque = torque;
    }

    #[inline(always)]
    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        let order = &self.order;
        if order.wanted == Wanted::On && !order.reads && matches!(self.follows, Follows::Positions(_)) {
            return;
        }
        let output = output();
        if order.wanted == Wanted::Off || !matches!(self.follows, Follows::Nothing) {
            self.held = output.estimate.output_position;
        }
        let velocity = output.estimate.output_velocity;
        self.exchange.give(Actual {
            position: bus_counts(output.estimate.output_position),
            // Saturates.
            velocity: (velocity * COUNTS) as i32,
            torque: output.estimate.transmitted_torque,
            fault: if output.mode == Mode::Safe { error_code::of(output.faults) } else { 0 },
            at_rest: velocity.abs() < AT_REST,
            follows: self.follows != Follows::Nothing,
        });
    }

    fn reset_requested(&mut self) -> bool {
        self.exchange.take_reset()
    }

    fn reset(&mut self) {
        (self.follows, self.interpolated) = (Follows::Nothing, CyclicState::default());
        (self.torque, self.held) = (0.0, Angle::default());
    }
}
