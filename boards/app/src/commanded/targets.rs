//! What the joint follows, and the command of each period that it makes.
//!
//! ```text
//! Holds      until the first target, and when a position is out of reach
//! Positions  interpolated; the next may be as far as the joint goes in two cycles at its top speed
//! Velocity, Torque
//! ```
//!
//! A first position has to be within [`NEAR`], and what the joint moves in two cycles, of where it is: it would set out at once.

use core::f32::consts::TAU;
use strainwave::Angle;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::tuned::SETTLED_TIME;
use strainwave::compensator::{Command, Setpoint};
use strainwave::trajectory::{Cyclic, CyclicState};
use strainwave_drivers::cia402::node::Target;

/// Bits of a count of [`Angle`] below one of the bus, which has 2^26 in a revolution.
const BELOW: u32 = 32 - 26;
/// Counts of the bus in 1 rad, and the inverse.
const COUNTS: f32 = (1 << 26) as f32 / TAU;
const RADIANS: f32 = TAU / (1 << 26) as f32;

/// Farthest first position from where the joint is (rad).
const NEAR: f32 = 5e-3;
/// Age of a command that the joint is to brake from (s): far beyond any that is followed.
const OLD: f32 = 1.0;

/// Where the output is, as estimated.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Here {
    pub position: Angle<f32>,
    /// (rad/s)
    pub velocity: f32,
}

impl Here {
    /// In counts of the bus, of which there are 2^32 before they begin again.
    pub fn counts(&self) -> i32 {
        bus_counts(self.position)
    }

    /// In counts of the bus a second; saturates.
    pub fn counts_per_second(&self) -> i32 {
        (self.velocity * COUNTS) as i32
    }
}

/// What the joint follows.
pub(super) struct Targets {
    /// Top speed of the output (rad/s).
    speed: f32,
    /// Interpolation for the bus's cycle, and that (control periods).
    cyclic: Option<Cyclic<f32>>,
    cycle: u32,
    interpolated: CyclicState<f32>,
    follows: Follows,
    /// Periods since the last target.
    silent: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Follows {
    Holds(Angle<f32>),
    /// This was the last: whole counts of the bus.
    Positions(Angle<f32>),
    /// (rad/s)
    Velocity(f32),
    /// (N m)
    Torque(f32),
}

impl Targets {
    /// Of a joint whose output has this top `speed` (rad/s).
    pub fn new(speed: f32) -> Self {
        Self {
            speed,
            cyclic: None,
            cycle: 0,
            interpolated: CyclicState::default(),
            follows: Follows::Holds(Angle::default()),
            silent: 0,
        }
    }

    /// A control period passes, of a bus with this cycle (control periods).
    pub fn pass(&mut self, cycle: u32) {
        if cycle != self.cycle {
            (self.cycle, self.interpolated) = (cycle, CyclicState::default());
            self.cyclic = Cyclic::build(cycle, CONTROL_PERIOD as f32).ok();
        }
        self.silent = self.silent.saturating_add(1);
    }

    /// Holds where the output is.
    pub fn hold(&mut self, here: &Here) {
        self.follow(Follows::Holds(here.position));
    }

    /// A target has come.
    pub fn take(&mut self, target: Target, here: &Here) {
        self.silent = 0;
        match target {
            Target::Position(counts) => self.take_position(counts, here),
            Target::Velocity(counts) => self.follow(Follows::Velocity(counts as f32 * RADIANS)),
            Target::Torque(torque) => self.follow(Follows::Torque(torque)),
        }
    }

    /// Follows the last target, and no position that is out of reach.
    pub fn follows(&self) -> bool {
        !matches!(self.follows, Follows::Holds(_))
    }

    /// Command of this period and its age (s).
    pub fn command(&mut self, brakes: bool) -> (Command<f32>, f32) {
        let silence = self.silent.saturating_sub(self.cycle).min(1 << 16) as f32 * CONTROL_PERIOD as f32;
        let age = if brakes { OLD } else { silence };
        match self.follows {
            Follows::Holds(position) => (at_rest(position), if brakes { OLD } else { 0.0 }),
            Follows::Positions(last) => {
                let setpoint = self.cyclic.as_ref().and_then(|cyclic| cyclic.step(&mut self.interpolated));
                (setpoint.map_or(at_rest(last), Command::from), age)
            }
            Follows::Velocity(velocity) => (Command::Velocity { velocity, acceleration: 0.0 }, age),
            // Without a torque the joint would go on as it moves: it is stopped, when no other command would be followed any more.
            Follows::Torque(_) if age > SETTLED_TIME.get() as f32 => {
                (Command::Velocity { velocity: 0.0, acceleration: 0.0 }, age)
            }
            Follows::Torque(torque) => (Command::Torque(torque), age),
        }
    }

    fn take_position(&mut self, counts: i32, here: &Here) {
        let two_cycles = 2.0 * self.cycle as f32 * CONTROL_PERIOD as f32;
        let first = NEAR + here.velocity.abs() * two_cycles;
        let (last, reach) = match self.follows {
            Follows::Positions(last) => (last, self.speed * two_cycles),
            Follows::Holds(position) => (whole(position), first),
            Follows::Velocity(_) | Follows::Torque(_) => (whole(here.position), first),
        };
        let way = counts.wrapping_sub(bus_counts(last));
        if way.unsigned_abs() as f32 > reach * COUNTS {
            return self.hold(here);
        }
        let target = Angle::from_counts(last.counts.wrapping_add(i64::from(way) << BELOW));
        if !matches!(self.follows, Follows::Positions(_)) {
            self.interpolated = CyclicState::default();
        }
        self.follows = Follows::Positions(target);
        if let Some(cyclic) = &self.cyclic {
            cyclic.take(&mut self.interpolated, target);
        }
    }

    fn follow(&mut self, what: Follows) {
        (self.follows, self.interpolated) = (what, CyclicState::default());
    }
}

fn at_rest(position: Angle<f32>) -> Command<f32> {
    Setpoint { position, ..Setpoint::default() }.into()
}

/// Without what is below a count of the bus.
fn whole(angle: Angle<f32>) -> Angle<f32> {
    Angle::from_counts(angle.counts >> BELOW << BELOW)
}

fn bus_counts(angle: Angle<f32>) -> i32 {
    (angle.counts >> BELOW) as i32
}
