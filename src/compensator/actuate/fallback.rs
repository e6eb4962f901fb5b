//! Fallback to the cascade while the model cannot be trusted, without a step of the torque.
//!
//! ```text
//! fault of the model's inputs  ->  all gains but the feedback's are ramped to 0, by the guard's ramp (7 ms)
//! T_q = 0.5 s without one      ->  they return, by the same ramp
//! |tau_k - tau_(k-1)| <= 2*tau_max*dt/T_r,   T_r = 8 ms
//! ```
//!
//! With these gains at 0 torque and reference of the motor are those of the motor-side cascade alone. The last line,
//! the ramp of the motor's torque, holds from the first fault or a switch of the kind of command on, until the torque
//! has reached its target for T_r; else the torque is limited by tau_max and the gear's protection alone. The protection goes before the
//! ramp: where it lowers its bound the torque follows at once. Faults that follow while the model is not
//! trusted do not restart it: a cascade that is ramped all the time limit-cycles. Units: s, N m at the motor.
//!
//! Faults without which no control is possible switch the drive off instead ([`crate::compensator::actuate::mode`]).

use crate::branch::seldom;
use crate::compensator::Faults;
use crate::compensator::actuate::protection::ProtectionState;
use crate::compensator::tuned::{FADING_TIME, TRANSIENT_TIME, Tuned};
use crate::constants::constants;
use crate::real::Real;

/// Faults that invalidate the model's inputs.
pub const UNTRUSTED: Faults = Faults::INPUT_NOT_FINITE
    .with(Faults::OUTPUT_ENCODER_JUMP)
    .with(Faults::OUTPUT_ENCODER_FROZEN)
    .with(Faults::OBSERVER_RESET)
    .with(Faults::TORSION_BEYOND_RANGE);

/// The built fallback.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fallback<R> {
    /// T_q/dt.
    quiet: u32,
    /// T_r/dt.
    ramp: u32,
    /// Largest change of the torque in a period while it is ramped (N m).
    change: R,
}

/// State of the fallback.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FallbackState<R> {
    /// Periods until the model is trusted again.
    untrusted: u32,
    /// Periods of the torque's ramp.
    ramped: u32,
    torque: R,
}

impl<R: Real> FallbackState<R> {
    /// The model may be used.
    pub fn trusted(&self) -> bool {
        self.untrusted == 0
    }

    /// The last command (N m).
    pub fn torque(&self) -> R {
        self.torque
    }

    /// The command (N m) that was sent in the place of the last one.
    #[inline(always)]
    pub fn sent(&mut self, torque: R) {
        self.torque = torque;
    }
}

impl<R: Real> Fallback<R> {
    /// For a motor of this peak torque (N m) and the control period dt (s), both positive.
    pub fn build(peak_torque: R, dt: R) -> Self {
        let periods = |time: Tuned| (R::lit(time.get()) / dt).to_i32().unsigned_abs() + 1;
        let range = R::lit(2.0) * peak_torque;
        let change = (range * dt * R::lit(1.0 / TRANSIENT_TIME.get())).min(range);
        Self { quiet: periods(FADING_TIME), ramp: periods(TRANSIENT_TIME), change }
    }

    /// The kind of command has changed: the torque goes on by the ramp.
    pub fn begin_ramp(&self, state: &mut FallbackState<R>) {
        state.ramped = self.ramp;
    }

    /// The torque for a target (N m) that is one of the `allowed` torques; so is one on the way to it, which is limited, and
    /// said to be, where the bounds have come closer than the ramp goes.
    #[inline(always)]
    pub fn step(
        &self,
        state: &mut FallbackState<R>,
        target: R,
        faults: &mut Faults,
        allowed: &ProtectionState<R>,
    ) -> R {
        if faults.intersects(UNTRUSTED) {
            seldom();
            if state.untrusted == 0 {
                state.ramped = self.ramp;
            }
            state.untrusted = self.quiet;
        } else if state.untrusted > 0 {
            seldom();
            state.untrusted -= 1;
        }
        if state.ramped > 0 {
            seldom();
            let change = target - state.torque;
            if !change.is_within(self.change) {
                state.torque = allowed.limit(state.torque + self.change.copysign(change), faults);
                return state.torque;
            }
            state.ramped -= 1;
        }
        state.torque = target;
        target
    }
}
