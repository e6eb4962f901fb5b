//! Setpoints from a target that an operator moves: the joint follows it in smooth moves from rest to rest.
//!
//! ```text
//! u = t/T,   s(u) = 10 u^3 - 15 u^4 + 6 u^5,   0 <= u <= 1
//! x = x0 + d*s,   v = d*s'/T,   a = d*s''/T^2,   j = d*s'''/T^3,   d4x = d*s''''/T^4
//! ```
//!
//! the polynomial of least jerk between two points at rest (Flash and Hogan 1985). Speed peaks at
//! 1.875*d/T; T is the shortest whole number of control periods that keeps it within [`SPEED`] and
//! is no shorter than [`SHORTEST`]. A target that moves during a move is taken up when that has ended.
//! Angles of the output, from the origin (rad).

use strainwave::Angle;
use strainwave::compensator::Setpoint;

/// Largest speed of a move (rad/s).
pub const SPEED: f32 = 0.5;

/// Shortest move (s).
pub const SHORTEST: f32 = 0.25;

/// Farthest target either way (rad).
pub const FARTHEST: f32 = 1.5;

/// The least-jerk polynomial's peak of s'.
const PEAK: f32 = 1.875;

/// The move that is under way, or was last.
#[derive(Clone, Copy, Debug)]
pub struct Jog {
    origin: Angle<f32>,
    /// Control period (s).
    period: f32,
    start: f32,
    distance: f32,
    /// 1/T (1/s).
    rate: f32,
    elapsed: u32,
    duration: u32,
}

impl Jog {
    /// At rest at `origin`; `period` is the control period (s).
    pub fn at(origin: Angle<f32>, period: f32) -> Self {
        Self { origin, period, start: 0.0, distance: 0.0, rate: 1.0 / SHORTEST, elapsed: 0, duration: 0 }
    }

    /// The setpoint of the next period, on the way to `target` [rad from the origin].
    pub fn step(&mut self, target: f32) -> Setpoint<f32> {
        if self.elapsed >= self.duration {
            self.set_out(target);
        }
        self.elapsed += 1;
        let u = (self.elapsed as f32 * self.period * self.rate).min(1.0);
        let rest = 1.0 - u;
        let r = self.rate;
        Setpoint {
            position: self.origin.plus(self.start + self.distance * path(u)),
            velocity: self.distance * r * 30.0 * u * u * rest * rest,
            acceleration: self.distance * r * r * 60.0 * u * rest * (1.0 - 2.0 * u),
            jerk: self.distance * r * r * r * 60.0 * (1.0 - 6.0 * u * rest),
            snap: self.distance * r * r * r * r * 360.0 * (2.0 * u - 1.0),
        }
    }

    /// Starts the next move where the last one ended.
    fn set_out(&mut self, target: f32) {
        self.start += self.distance;
        self.distance = target.clamp(-FARTHEST, FARTHEST) - self.start;
        if !self.distance.is_finite() {
            self.distance = 0.0;
        }
        let time = (PEAK / SPEED * self.distance.abs()).max(SHORTEST);
        // Truncated, then one more: no shorter than asked. At rest it looks for a target every period.
        self.duration = if self.distance == 0.0 { 0 } else { (time / self.period) as u32 + 1 };
        self.rate = 1.0 / (self.duration.max(1) as f32 * self.period);
        self.elapsed = 0;
    }
}

fn path(u: f32) -> f32 {
    u * u * u * (10.0 + u * (6.0 * u - 15.0))
}
