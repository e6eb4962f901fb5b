//! State of the compensator: the states of its parts, and the quantities that one slot passes to another.

use crate::angle::Angle;
use crate::compensator::Faults;
use crate::compensator::actuate::cascade::FeedbackState;
use crate::compensator::actuate::fallback::FallbackState;
use crate::compensator::actuate::limit_cycle::Swings;
use crate::compensator::actuate::mode::{Mode, ModeState};
use crate::compensator::actuate::protection::ProtectionState;
use crate::compensator::actuate::supervisor::SupervisorState;
use crate::compensator::adapt::learning::LearningState;
use crate::compensator::estimate::disturbance::{DisturbanceState, WindUpResponse};
use crate::compensator::estimate::observer::{GearCorrection, ObserverState};
use crate::compensator::reference::command::{CommanderState, Found};
use crate::compensator::reference::feed_forward::FeedForwardState;
use crate::compensator::reference::measured_feedback::MeasuredFeedbackState;
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::reference::output_feedback::OutputFeedbackState;
use crate::compensator::schedule::{OBSERVER_PERIODS, Slot, SlowSlot};
use crate::compensator::sense::encoder::EncoderState;
use crate::compensator::sense::motor_encoder::MotorEncoderState;
use crate::compensator::sense::motor_torque::MotorTorqueState;
use crate::compensator::sense::pulleys::PulleysState;
use crate::compensator::sense::rotor::RotorState;
use crate::compensator::sense::validation::InputGuardState;
use crate::real::Real;

/// State of the compensator.
#[derive(Clone, Debug)]
pub struct State<R: Real> {
    pub(super) slot: Slot,
    pub(super) guard: InputGuardState<R>,
    pub(super) motor_encoder: MotorEncoderState<R>,
    pub(super) output_encoder: EncoderState,
    pub(super) latch: SensorLatch<R>,
    /// Raw count of the output encoder at the observer's last step, and its age (control periods).
    pub(super) output_reading: Option<(u32, u32)>,
    /// Output encoder's angle where the observer's output angle is zero.
    pub(super) output_zero: Option<Angle<R>>,
    pub(super) frozen_path: R,
    pub(super) frozen_output_path: R,
    /// Raw counts of the output encoder: the newest since the last test for standstill, and that of the test.
    pub(super) output_raw: Option<u32>,
    pub(super) last_output: Option<u32>,
    /// Motor's angle when it was last tested for a standstill, and that it has been at another one since.
    pub(super) last_motor: Angle<R>,
    pub(super) motor_moved: bool,
    /// Motor's angle when the output encoder was last tested for a standstill.
    pub(super) motor_at_output: Angle<R>,
    pub(super) commander: CommanderState<R>,
    /// Target that took the period in which it was found, and is followed from the next on.
    pub(super) found: Option<Found<R>>,
    /// Time of the observer's slots since the plan's last one (s).
    pub(super) since_plan: R,
    pub(super) observer: ObserverState<R>,
    pub(super) disturbance: DisturbanceState<R>,
    pub(super) wind_up: WindUpResponse<R>,
    pub(super) feed_forward: FeedForwardState<R>,
    pub(super) motor_reference: MotorReference<R>,
    pub(super) feedback: FeedbackState<R>,
    /// Fraction of the position error that the cascade follows.
    pub(super) followed: R,
    pub(super) output_feedback: OutputFeedbackState<R>,
    pub(super) measured_feedback: MeasuredFeedbackState<R>,
    pub(super) learning: LearningState<R>,
    pub(super) gear_correction: GearCorrection<R>,
    /// Change of the correction's load from one slot of the observer to the next (N m).
    pub(super) load_rate: R,
    /// The next slow slot.
    pub(super) slow: SlowSlot,
    pub(super) motor_torque: MotorTorqueState<R>,
    pub(super) rotor: RotorState<R>,
    pub(super) protection: ProtectionState<R>,
    pub(super) supervisor: SupervisorState<R>,
    pub(super) swings: Swings,
    /// Newest reading of the strain gauge: torque through the flexspline (N m).
    pub(super) gauge: Option<R>,
    /// Sensors that are disabled until a reset.
    pub(super) disabled_sensors: Faults,
    pub(super) fallback: FallbackState<R>,
    pub(super) mode: ModeState,
    /// Faults of the last slots, and the reported ones.
    pub(super) faults: SlotFaults,
    pub(super) reported: Faults,
    pub(super) limited: bool,
    /// No fault since the factors' last slot.
    pub(super) sound: bool,
    /// Every gain equals its command of the backward direction, as of the last `ObserveOutput`.
    pub(super) backward_has_settled: bool,
    pub(super) pulleys: PulleysState,
}

/// Sensor latch: readings since the observer's last slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SensorLatch<R> {
    /// Sums of the motor's commanded and of its measured torque over the steps since then (N m), and the time since then (s).
    pub(super) commanded: R,
    pub(super) measured: R,
    pub(super) time: R,
    /// Steps by which the observer's slot is late, and the inverse of how many it then is of.
    pub(super) late: u32,
    pub(super) per_step: R,
    /// Newest raw count of the output encoder, its age (control periods), and that the observer has not had it.
    pub(super) output: u32,
    pub(super) age: u32,
    pub(super) output_is_new: bool,
    /// The observer has not had the newest reading of the strain gauge.
    pub(super) gauge_is_new: bool,
}

/// Faults of each slot that tests for them, as of its last run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SlotFaults {
    pub(super) observer: Faults,
    /// All but the observer's.
    slow: Faults,
    pub(super) plan: Faults,
    pub(super) standstill: Faults,
    pub(super) gains: Faults,
    pub(super) rotor: Faults,
    pub(super) supervisor: Faults,
}

impl<R: Real> SensorLatch<R> {
    /// Before the first reading.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            commanded: R::ZERO,
            measured: R::ZERO,
            time: R::ZERO,
            late: 0,
            per_step: R::lit(1.0 / OBSERVER_PERIODS as f64),
            output: 0,
            age: 0,
            output_is_new: false,
            gauge_is_new: false,
        }
    }

    /// The slot of this period waits for the next: the observer's next one is of one step more.
    #[inline(always)]
    pub(super) fn wait(&mut self) {
        self.late = self.late.saturating_add(1);
        self.per_step = R::ONE / R::from_i32(OBSERVER_PERIODS.saturating_add(self.late).cast_signed());
    }

    /// Takes the means of the motor's commanded and of its measured torque (N m), and the time (s) that they are of.
    #[inline(always)]
    pub(super) fn take_torques(&mut self) -> ([R; 2], R) {
        let taken = ([self.per_step * self.commanded, self.per_step * self.measured], self.time);
        (self.commanded, self.measured, self.time) = (R::ZERO, R::ZERO, R::ZERO);
        (self.late, self.per_step) = (0, R::lit(1.0 / OBSERVER_PERIODS as f64));
        taken
    }
}

impl SlotFaults {
    /// All of them.
    #[inline(always)]
    pub(super) fn all(&self) -> Faults {
        self.observer.with(self.slow)
    }

    /// Collects the faults at the end of the slots `Learn` and `Check`.
    #[inline(always)]
    pub(super) fn collect(&mut self) {
        self.slow = self.plan.with(self.standstill).with(self.gains).with(self.rotor).with(self.supervisor);
    }
}

impl<R: Real> State<R> {
    /// The slot that is next.
    pub fn slot(&self) -> Slot {
        self.slot
    }

    /// Whether the drive may be on.
    pub fn mode(&self) -> Mode {
        self.mode.mode()
    }

    /// Faults that led to [`Mode::Safe`].
    pub fn cause(&self) -> Faults {
        self.mode.cause()
    }

    /// Adaptation is enabled in this round.
    #[inline(always)]
    pub(super) fn learns(&self) -> bool {
        self.sound && self.guard.gains().adaptation > R::ZERO && self.motor_reference.output_torque.is_none()
    }
}
