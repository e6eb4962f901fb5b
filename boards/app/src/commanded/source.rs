//! The joint's end of the exchange: orders of the bus in, the joint's state out.

use strainwave::compensator::{CompensationGains, Input, Mode, Output, Status};
use strainwave_drivers::cia402::node::{Actual, Wanted};

use crate::Compensator;
use crate::command_source::{CommandSource, sensors};
use crate::commanded::error_code;
use crate::commanded::exchange::{Exchange, Given, Order};
use crate::commanded::targets::{Here, Targets};
use crate::operated::{GAINS, WATCHING};

/// Speed below which the joint rests (rad/s), and for how many periods: 10 ms, longer than a reversal.
const AT_REST: f32 = 0.01;
const RESTING: u32 = 100;

/// A joint with a motor encoder alone, whose drive has a current loop of its own: the motor's torque is taken to be the last command.
pub struct Commanded {
    exchange: &'static Exchange,
    targets: Targets,
    /// Of this period.
    order: Order,
    /// Torque of the drive (N m); none in a period in which it is released.
    torque: Option<f32>,
    here: Here,
    /// Periods in which the observer has watched the joint, and in which that has rested.
    watched: u32,
    rested: u32,
}

impl Commanded {
    /// A joint whose bus is at the exchange's other end.
    pub fn new(exchange: &'static Exchange, compensator: &Compensator) -> Self {
        Self {
            exchange,
            targets: Targets::new(compensator.setpoint_speed()),
            order: Order::default(),
            torque: None,
            here: Here::default(),
            watched: 0,
            rested: 0,
        }
    }
}

impl CommandSource for Commanded {
    #[inline(always)]
    fn input(&mut self, count: Option<u32>, input: &mut Input<f32>) {
        let order = self.exchange.take();
        self.order = order;
        self.targets.pass(order.cycle);
        let (sensors, mut status) = sensors(count, self.torque.take().unwrap_or_default());
        let is_off = matches!(order.wanted, Wanted::Off | Wanted::Standby);
        if is_off {
            self.targets.hold(&self.here);
            status = status.with(Status::DRIVE_OFF);
        } else if let Some(target) = order.target {
            self.targets.take(target, &self.here);
        }
        // An encoder that is lost is found out within a few readings, and the joint is off then.
        self.watched = if is_off && count.is_none() { 0 } else { (self.watched + 1).min(WATCHING) };
        let (command, setpoint_age) = self.targets.command(order.wanted == Wanted::Brake);
        let gains = if is_off { CompensationGains::default() } else { GAINS };
        *input = Input { sensors, status, command, gains: gains.into(), setpoint_age, ..Input::default() };
    }

    #[inline(always)]
    fn commanded(&mut self, torque: f32) {
        self.torque = Some(torque);
    }

    #[inline(always)]
    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        let output = output();
        let estimate = &output.estimate;
        self.here = Here { position: estimate.output_position, velocity: estimate.output_velocity };
        let rests = estimate.output_velocity.abs() < AT_REST;
        self.rested = if rests { (self.rested + 1).min(RESTING) } else { 0 };
        let actual = Actual {
            position: self.here.counts(),
            velocity: self.here.counts_per_second(),
            torque: estimate.transmitted_torque,
            fault: if output.mode == Mode::Safe { error_code::of(output.faults) } else { 0 },
            ready: self.watched == WATCHING,
            powered: true,
            at_rest: self.rested == RESTING,
            follows: self.targets.follows(),
        };
        self.exchange.give(Given {
            actual,
            answers: self.order.reads,
            torque: self.torque.unwrap_or_default(),
        });
    }

    fn reset_requested(&mut self) -> bool {
        self.exchange.take_reset()
    }

    fn reset(&mut self) {
        (self.here, self.torque) = (Here::default(), None);
        (self.watched, self.rested) = (0, 0);
        self.targets.hold(&self.here);
    }
}
