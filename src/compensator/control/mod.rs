//! Control step: each stage writes its part of the state and reads those of the others.

mod actuate;
mod adapt;
mod estimate;
mod reference;
mod sense;

use zerocopy::KnownLayout;

use crate::angle::Angle;
use crate::branch::seldom;
use crate::compensator::actuate::braking::Braking;
use crate::compensator::actuate::cascade::Feedback;
use crate::compensator::actuate::fallback::Fallback;
use crate::compensator::actuate::protection::Protection;
use crate::compensator::actuate::supervisor::Supervisor;
use crate::compensator::adapt::learning::{Learning, Learnt};
use crate::compensator::estimate::disturbance::Disturbance;
use crate::compensator::estimate::observer::Observer;
use crate::compensator::reference::command::Commander;
use crate::compensator::reference::feed_forward::FeedForward;
use crate::compensator::reference::measured_feedback::MeasuredFeedback;
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::reference::output_feedback::OutputFeedback;
use crate::compensator::schedule::Slot;
use crate::compensator::sense::clock::Clock;
use crate::compensator::sense::encoder::Encoder;
use crate::compensator::sense::motor_encoder::MotorEncoder;
use crate::compensator::sense::motor_torque::MotorTorque;
use crate::compensator::sense::output_zero::OutputZero;
use crate::compensator::sense::pulleys::Pulleys;
use crate::compensator::sense::rotor::Rotor;
use crate::compensator::sense::validation::{FrozenEncoder, InputGuard};
use crate::compensator::{Commanded, Faults, Input, Limits, Output, RealTimeGear, State};
use crate::constants::constants;
use crate::real::Real;

/// The built compensator of a joint.
///
/// Called every control period with the sensors and the command, it answers with the motor's torque. The joint below
/// rests, then its setpoint leaves while the motor is blocked, so that its encoder stands still:
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::Angle;
/// use strainwave::compensator::{CompensationGains, Faults, Input, Mode, Sensors, Setpoint};
///
/// let compensator = JOINT.build()?; // every parameter is checked once
/// let mut state = compensator.rest();
/// let mut input = Input { gains: CompensationGains::ALL.into(), ..Input::default() };
/// for _ in 0..1000 {
///     let commanded = compensator.control(&mut state, &input);
///     assert_eq!((commanded.mode, commanded.faults), (Mode::Active, Faults::NONE));
///     assert!(commanded.motor_torque.abs() < 1e-3); // it is where it should be
/// }
/// // 50 urad forwards at the output: the motor has to turn backwards, for the ratio is negative.
/// input.command = Setpoint { position: Angle::from_radians(5e-5), ..Setpoint::default() }.into();
/// for _ in 0..20 {
///     input.sensors.motor_torque = compensator.control(&mut state, &input).motor_torque;
/// }
/// assert!(input.sensors.motor_torque < 0.0);
/// // A torque measurement that is not a number is named; its last value is held.
/// let broken = Sensors { motor_torque: f32::NAN, ..input.sensors };
/// let commanded = compensator.control(&mut state, &Input { sensors: broken, ..input });
/// assert!(commanded.faults.contains(Faults::INPUT_NOT_FINITE) && commanded.motor_torque.is_finite());
/// // Torque beyond friction, and the encoder does not move: within 100 ms the drive is off, until a reset.
/// for _ in 0..1000 {
///     input.sensors.motor_torque = compensator.control(&mut state, &input).motor_torque;
/// }
/// assert_eq!((state.mode(), input.sensors.motor_torque), (Mode::Safe, 0.0));
/// assert!(state.cause().contains(Faults::MOTOR_ENCODER_FROZEN));
/// compensator.reset(&mut state);
/// assert_eq!(state.mode(), Mode::Ready);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Debug, PartialEq, KnownLayout)]
pub struct Compensator<R: Real> {
    // First what every step reads: a Cortex-M4F loads a float within 1020 bytes of an address by one instruction.
    pub(super) dt: R,
    /// Time from the observer's torques to the plan (s).
    pub(super) behind: R,
    /// Half a count of the motor's encoder (rad).
    pub(super) rounding: R,
    /// The speed of a resting motor is the observer's.
    pub(super) estimates_speed: bool,
    /// Control periods without a reading after which the output encoder is lost.
    pub(super) output_lost: u32,
    pub(super) clock: Clock<R>,
    pub(super) guard: InputGuard<R>,
    pub(super) motor_encoder: MotorEncoder<R>,
    pub(super) output_encoder: Encoder,
    pub(super) frozen_encoder: FrozenEncoder<R>,
    pub(super) frozen_output: FrozenEncoder<R>,
    pub(super) output_zero: OutputZero,
    pub(super) fallback: Fallback<R>,
    pub(super) braking: Braking<R>,
    pub(super) feedback: Feedback<R>,
    pub(super) motor_torque: MotorTorque<R>,
    pub(super) limits: Limits<R>,
    pub(super) protection: Protection<R>,
    pub(super) rotor: Rotor<R>,
    pub(super) supervisor: Supervisor<R>,
    pub(super) disturbance: Disturbance<R>,
    pub(super) output_feedback: OutputFeedback<R>,
    pub(super) measured_feedback: MeasuredFeedback<R>,
    pub(super) feed_forward: FeedForward<R>,
    pub(super) commander: Commander<R>,
    pub(super) learning: Learning<R>,
    pub(super) observer: Observer<R>,
    pub(super) gear: RealTimeGear<R>,
    pub(super) pulleys: Pulleys<R>,
    /// Stored factors and ripple that the state starts from.
    pub(super) learnt: Learnt<R>,
}

impl<R: Real> Compensator<R> {
    /// Learnt factors and ripple, to be stored.
    pub fn learnt(&self, state: &State<R>) -> Learnt<R> {
        state.learning.learnt()
    }

    /// Limits of motor and gear.
    pub fn limits(&self) -> Limits<R> {
        self.pulleys.limits_at_motor(&self.limits)
    }

    /// Top speed of the output's reference (rad/s).
    pub fn setpoint_speed(&self) -> R {
        self.commander.speed()
    }

    /// Resolution of the motor encoder, 2^bits counts a revolution.
    pub fn motor_encoder_bits(&self) -> u32 {
        self.motor_encoder.bits()
    }

    /// One control step with all of its outputs: [`Self::control`] and [`Self::output`].
    pub fn step(&self, state: &mut State<R>, input: &Input<R>) -> Output<R> {
        self.control(state, input);
        self.output(state)
    }

    /// One control step.
    #[inline(always)] // Firmware's own function around it is the symbol that the timing budget counts.
    pub fn control(&self, state: &mut State<R>, input: &Input<R>) -> Commanded<R> {
        let mut faults = Faults::NONE;
        let elapsed = self.clock.step(input.elapsed, &mut faults);
        let (motor, usual) = self.read(state, input, &elapsed, &mut faults);
        faults = faults.with(state.faults.all());
        let same_mode =
            state.mode.stays(faults, input.status) || self.step_mode(state, &mut faults, input.status);
        let drives = state.mode.mode().drives();
        let observes = state.slot.observes();
        if same_mode && usual && self.run_slot(state, input, motor.angle) {
            state.slot = state.slot.next();
        } else {
            seldom();
            state.latch.wait();
            if !observes {
                state.measured_feedback.leave_out();
            }
        }
        let motor_torque = if drives {
            self.drive(state, &elapsed, !observes, &mut faults)
        } else {
            self.without_torque(state, faults)
        };
        state.sound &= faults == Faults::NONE && !state.limited;
        state.reported = faults;
        let motor_torque = self.pulleys.at_motor(motor_torque);
        Commanded { motor_torque, faults, mode: state.mode.mode() }
    }

    /// Runs the slot of this period; false where only a part of it is done, and it goes on in the next.
    #[inline(always)]
    fn run_slot(&self, state: &mut State<R>, input: &Input<R>, motor: Angle<R>) -> bool {
        match state.slot {
            Slot::Plan => return self.plan(state, input, motor),
            Slot::Check => return self.check(state),
            Slot::Learn => self.learn(state, &input.gains, motor),
            Slot::Model => {
                self.model(state, motor);
                self.supervise(state);
                state.mode.forget();
            }
            Slot::Observe | Slot::ObserveSecond | Slot::ObserveOutput | Slot::ObserveLast => {
                self.observe(state, &input.gains, motor);
            }
        }
        true
    }

    /// Command, references and estimates of the last step; separate from the control step, so that callers pay only on
    /// request.
    #[inline(never)] // The timing budget counts it by its symbol.
    pub fn output(&self, state: &State<R>) -> Output<R> {
        let MotorReference { position_error, torque: feed_forward, .. } = state.motor_reference;
        let driven = state.mode.mode().drives();
        let mut estimate = self.observer.estimate(&state.observer, &state.gear_correction);
        // The learnt gravity is an external torque, too.
        let external_torque = estimate.external_torque + state.learning.gravity_torque();
        estimate.external_torque = external_torque.limit(self.limits.output_torque);
        Output {
            motor_torque: self.pulleys.at_motor(state.fallback.torque()),
            feed_forward_torque: if driven {
                self.pulleys.at_motor(feed_forward.limit(self.limits.motor_torque))
            } else {
                R::ZERO
            },
            motor_reference: state.motor_encoder.angle().plus(self.pulleys.angle_at_motor(position_error)),
            estimate,
            // The observer's slot takes the time since its last one.
            observed: state.latch.time == R::ZERO,
            factors: *state.learning.applied(),
            faults: state.reported,
            mode: state.mode.mode(),
        }
    }
}
