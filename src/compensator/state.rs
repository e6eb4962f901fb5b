//! What the compensator remembers from step to step: the states of its parts, and what one turn leaves for another.

use crate::angle::Angle;
use crate::compensator::actuate::cascade::FeedbackState;
use crate::compensator::actuate::fallback::FallbackState;
use crate::compensator::actuate::mode::{Mode, ModeState};
use crate::compensator::actuate::protection::ProtectionState;
use crate::compensator::adapt::learning::LearningState;
use crate::compensator::estimate::disturbance::{DisturbanceState, WindUpResponse};
use crate::compensator::estimate::observer::{Known, ObserverState};
use crate::compensator::reference::command::CommanderState;
use crate::compensator::reference::feed_forward::FeedForwardState;
use crate::compensator::reference::motor_reference::Course;
use crate::compensator::reference::output_feedback::OutputFeedbackState;
use crate::compensator::schedule::{Slot, SlowSlot};
use crate::compensator::sense::encoder::EncoderState;
use crate::compensator::sense::motor_encoder::MotorEncoderState;
use crate::compensator::sense::motor_torque::MotorTorqueState;
use crate::compensator::sense::rotor::RotorState;
use crate::compensator::sense::validation::InputGuardState;
use crate::compensator::{Compensator, Faults};
use crate::real::Real;

/// What the compensator remembers from step to step.
#[derive(Clone, Debug)]
pub struct State<R: Real> {
    pub(super) turn: Slot,
    pub(super) guard: InputGuardState<R>,
    pub(super) motor_encoder: MotorEncoderState,
    pub(super) output_encoder: EncoderState,
    pub(super) heard: Heard<R>,
    /// Raw count of the output encoder at the observer's last step, and its age (control periods).
    pub(super) output_reading: Option<(u32, u32)>,
    /// Output encoder's angle where the observer's output angle is zero.
    pub(super) output_zero: Option<Angle<R>>,
    pub(super) frozen_path: R,
    pub(super) frozen_output_path: R,
    /// Of the output encoder since its standstill was looked for, and when it was.
    pub(super) output_raw: Option<u32>,
    pub(super) last_output: Option<u32>,
    pub(super) last_motor: Angle<R>,
    pub(super) commander: CommanderState<R>,
    pub(super) observer: ObserverState<R>,
    pub(super) disturbance: DisturbanceState<R>,
    pub(super) wind_up: WindUpResponse<R>,
    pub(super) feed_forward: FeedForwardState<R>,
    pub(super) course: Course<R>,
    pub(super) feedback: FeedbackState<R>,
    pub(super) output_feedback: OutputFeedbackState<R>,
    pub(super) learning: LearningState<R>,
    pub(super) known: Known<R>,
    /// By how much its load changes until the observer's next turn but one (N m).
    pub(super) load_rate: R,
    /// Whose turn it is among what is slow.
    pub(super) slow: SlowSlot,
    pub(super) motor_torque: MotorTorqueState<R>,
    pub(super) rotor: RotorState<R>,
    pub(super) protection: ProtectionState<R>,
    /// Torque through the flexspline that the gauge said last (N m).
    pub(super) gauge: Option<R>,
    /// Sensors that are not used until a reset.
    pub(super) off: Faults,
    pub(super) fallback: FallbackState<R>,
    pub(super) mode: ModeState,
    /// By how much the motor's reference was ahead of it in the last step (rad), and the feed-forward (N m).
    pub(super) sent: [R; 2],
    /// What the last turns found wrong, and what was reported.
    pub(super) faults: SlotFaults,
    pub(super) reported: Faults,
    pub(super) limited: bool,
    /// Nothing has been wrong since the factors' last turn.
    pub(super) sound: bool,
}

/// What the sensors have said since the observer's last turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Heard<R> {
    /// Sum of the motor's torque over the steps since then (N m), and the time since then (s).
    pub(super) motor_torque: R,
    pub(super) time: R,
    /// Raw count of the output encoder, and how many control periods ago it was.
    pub(super) output: Option<u32>,
    pub(super) age: u32,
    /// Strain gauge (N m).
    pub(super) output_torque: Option<R>,
}

/// What is wrong, by who has found it in its last turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SlotFaults {
    pub(super) observer: Faults,
    /// All but the observer's.
    slow: Faults,
    pub(super) plan: Faults,
    pub(super) standstill: Faults,
    pub(super) shares: Faults,
    pub(super) rotor: Faults,
}

impl SlotFaults {
    /// All of them.
    #[inline(always)]
    pub(super) fn all(&self) -> Faults {
        self.observer.with(self.slow)
    }

    /// At the end of the slots of what is learnt and of the checks.
    #[inline(always)]
    pub(super) fn collect(&mut self) {
        self.slow = self.plan.with(self.standstill).with(self.shares).with(self.rotor);
    }
}

impl<R: Real> Compensator<R> {
    /// The state before the first step: what was learnt before, within its bounds.
    pub fn rest(&self) -> State<R> {
        State {
            turn: Slot::default(),
            guard: InputGuardState::default(),
            motor_encoder: MotorEncoderState::default(),
            output_encoder: EncoderState::default(),
            heard: Heard::default(),
            output_reading: None,
            output_zero: None,
            frozen_path: R::ZERO,
            frozen_output_path: R::ZERO,
            output_raw: None,
            last_output: None,
            last_motor: Angle::default(),
            commander: CommanderState::default(),
            observer: self.observer.rest(),
            disturbance: DisturbanceState::default(),
            wind_up: WindUpResponse::default(),
            feed_forward: FeedForwardState::default(),
            course: Course::default(),
            feedback: FeedbackState::default(),
            output_feedback: OutputFeedbackState::default(),
            learning: self.learning.starting_from(&self.learnt),
            known: Known::default(),
            load_rate: R::ZERO,
            slow: SlowSlot::Lead,
            motor_torque: MotorTorqueState::default(),
            rotor: RotorState::default(),
            protection: ProtectionState::default(),
            gauge: None,
            off: Faults::NONE,
            fallback: FallbackState::default(),
            mode: ModeState::default(),
            sent: [R::ZERO; 2],
            faults: SlotFaults::default(),
            reported: Faults::NONE,
            limited: false,
            sound: true,
        }
    }
}

impl<R: Real> Compensator<R> {
    /// From Safe back to Ready, by whoever has looked after the cause: the joint starts from rest, and its encoders
    /// are found again. Of what was before only what has been learnt stays. The reference begins where the output is
    /// found, and goes on smoothly to what is commanded.
    pub fn reset(&self, state: &mut State<R>) {
        let learning = self.learning.starting_from(&self.learnt(state));
        *state = State { learning, ..self.rest() };
    }
}

impl<R: Real> State<R> {
    /// Whether the drive may be on.
    pub fn mode(&self) -> Mode {
        self.mode.mode()
    }

    /// What ended in [`Mode::Safe`].
    pub fn cause(&self) -> Faults {
        self.mode.cause()
    }

    /// What is learnt may rest on this round.
    #[inline(always)]
    pub(super) fn learns(&self) -> bool {
        self.sound && self.guard.shares().adaptation > R::ZERO && self.course.output_torque.is_none()
    }
}
