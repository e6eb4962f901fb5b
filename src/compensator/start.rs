//! Start of the compensator: the state before the first step, and the reset from Safe to Ready.

use crate::angle::Angle;
use crate::compensator::actuate::cascade::FeedbackState;
use crate::compensator::actuate::fallback::FallbackState;
use crate::compensator::actuate::limit_cycle::Swings;
use crate::compensator::actuate::mode::ModeState;
use crate::compensator::actuate::supervisor::SupervisorState;
use crate::compensator::adapt::learning::Learnt;
use crate::compensator::estimate::disturbance::{DisturbanceState, WindUpResponse};
use crate::compensator::estimate::observer::GearCorrection;
use crate::compensator::reference::command::CommanderState;
use crate::compensator::reference::feed_forward::FeedForwardState;
use crate::compensator::reference::measured_feedback::MeasuredFeedbackState;
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::reference::output_feedback::OutputFeedbackState;
use crate::compensator::schedule::{Slot, SlowSlot};
use crate::compensator::sense::encoder::EncoderState;
use crate::compensator::sense::motor_encoder::MotorEncoderState;
use crate::compensator::sense::motor_torque::MotorTorqueState;
use crate::compensator::sense::pulleys::PulleysState;
use crate::compensator::sense::rotor::RotorState;
use crate::compensator::sense::validation::InputGuardState;
use crate::compensator::state::{SensorLatch, SlotFaults};
use crate::compensator::{Compensator, Faults, State};
use crate::real::Real;

impl<R: Real> Compensator<R> {
    /// The state before the first step, with the stored learnt factors and ripple within their bounds.
    #[inline(always)]
    pub fn rest(&self) -> State<R> {
        State {
            slot: Slot::default(),
            guard: InputGuardState::default(),
            motor_encoder: MotorEncoderState::default(),
            pulleys: PulleysState::default(),
            output_encoder: EncoderState::default(),
            latch: SensorLatch::new(),
            output_reading: None,
            output_zero: None,
            frozen_path: R::ZERO,
            frozen_output_path: R::ZERO,
            output_raw: None,
            last_output: None,
            last_motor: Angle::default(),
            motor_moved: false,
            motor_at_output: Angle::default(),
            commander: CommanderState::default(),
            found: None,
            since_plan: R::ZERO,
            observer: self.observer.rest(),
            disturbance: DisturbanceState::default(),
            wind_up: WindUpResponse::default(),
            feed_forward: FeedForwardState::default(),
            motor_reference: MotorReference::default(),
            feedback: FeedbackState::default(),
            followed: R::ONE,
            output_feedback: OutputFeedbackState::default(),
            measured_feedback: MeasuredFeedbackState::default(),
            learning: self.learning.starting_from(&self.learnt),
            gear_correction: GearCorrection::default(),
            load_rate: R::ZERO,
            slow: SlowSlot::RampGains,
            motor_torque: MotorTorqueState::default(),
            rotor: RotorState::default(),
            protection: self.protection.rest(),
            supervisor: SupervisorState::default(),
            swings: Swings::default(),
            gauge: None,
            disabled_sensors: Faults::NONE,
            fallback: FallbackState::default(),
            mode: ModeState::default(),
            faults: SlotFaults::default(),
            reported: Faults::NONE,
            limited: false,
            sound: true,
            backward_has_settled: false,
        }
    }

    /// The same with these learnt factors and ripple, as a store has kept them, within their bounds.
    ///
    /// ```
    /// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
    /// # use joint::JOINT;
    /// let compensator = JOINT.build()?;
    /// let mut learnt = compensator.learnt(&compensator.rest());
    /// learnt.factors.inertia = 1.1;
    /// assert_eq!(compensator.learnt(&compensator.rest_with(&learnt)), learnt);
    /// learnt.factors.inertia = 1e6;
    /// assert!(compensator.learnt(&compensator.rest_with(&learnt)).factors.inertia < 2.0);
    /// # Ok::<(), strainwave::Error>(())
    /// ```
    pub fn rest_with(&self, learnt: &Learnt<R>) -> State<R> {
        State { learning: self.learning.starting_from(learnt), ..self.rest() }
    }
}

impl<R: Real> Compensator<R> {
    /// Resets from Safe to Ready, to be called once the cause is removed: the joint starts from rest, and its encoders
    /// are initialised again. Only the learnt factors and ripple are kept. The reference begins at the output's angle
    /// and moves smoothly to the command.
    pub fn reset(&self, state: &mut State<R>) {
        *state = self.rest_with(&self.learnt(state));
    }
}
