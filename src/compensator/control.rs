//! Control step: each stage writes its part of the state and reads those of the others.

use crate::angle::Angle;
use crate::branch::seldom;
use crate::compensator::actuate::cascade::{CascadeInput, Feedback};
use crate::compensator::actuate::fallback::Fallback;
use crate::compensator::actuate::protection::Protection;
use crate::compensator::adapt::learning::{Learning, Learnt};
use crate::compensator::adapt::parameters::{Factors, Observed};
use crate::compensator::estimate::disturbance::{Disturbance, DisturbanceInput};
use crate::compensator::estimate::observer::{Measurement, Observer, OutputReading};
use crate::compensator::reference::command::{CommandStatus, Commander};
use crate::compensator::reference::feed_forward::FeedForward;
use crate::compensator::reference::measured_feedback::{MeasuredError, MeasuredFeedback};
use crate::compensator::reference::motor_reference::MotorReference;
use crate::compensator::reference::output_feedback::{OutputError, OutputFeedback};
use crate::compensator::schedule::{OBSERVER_PERIODS, Slot, SlowSlot};
use crate::compensator::sense::clock::{Clock, Elapsed};
use crate::compensator::sense::encoder::{Encoder, Reading};
use crate::compensator::sense::motor_encoder::MotorEncoder;
use crate::compensator::sense::motor_torque::MotorTorque;
use crate::compensator::sense::rotor::{Rotor, RotorInput};
use crate::compensator::sense::validation::{self, FrozenEncoder, InputGuard};
use crate::compensator::{
    Commanded, Directions, Faults, Input, Limits, Output, RealTimeGear, Sensors, Setpoint, State, Status,
};
use crate::real::{RADIANS_PER_COUNT, Real};

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
#[derive(Clone, Debug)]
pub struct Compensator<R: Real> {
    pub(super) gear: RealTimeGear<R>,
    pub(super) clock: Clock<R>,
    pub(super) guard: InputGuard<R>,
    pub(super) motor_encoder: MotorEncoder<R>,
    pub(super) output_encoder: Encoder,
    pub(super) frozen_encoder: FrozenEncoder<R>,
    pub(super) frozen_output: FrozenEncoder<R>,
    pub(super) commander: Commander<R>,
    pub(super) observer: Observer<R>,
    pub(super) disturbance: Disturbance<R>,
    pub(super) feed_forward: FeedForward<R>,
    pub(super) feedback: Feedback<R>,
    pub(super) output_feedback: OutputFeedback<R>,
    pub(super) measured_feedback: MeasuredFeedback<R>,
    pub(super) learning: Learning<R>,
    /// Stored factors and ripple that the state starts from.
    pub(super) learnt: Learnt<R>,
    pub(super) motor_torque: MotorTorque<R>,
    pub(super) rotor: Rotor<R>,
    pub(super) protection: Protection<R>,
    pub(super) fallback: Fallback<R>,
    pub(super) limits: Limits<R>,
    pub(super) dt: R,
    /// Control periods without a reading after which the output encoder is lost.
    pub(super) output_lost: u32,
    /// Time from the observer's torques to the plan (s).
    pub(super) behind: R,
    /// Half a count of the motor's encoder (rad).
    pub(super) rounding: R,
}

impl<R: Real> Compensator<R> {
    /// Learnt factors and ripple, to be stored.
    pub fn learnt(&self, state: &State<R>) -> Learnt<R> {
        state.learning.learnt()
    }

    /// One control step with all of its outputs: [`Self::control`] and [`Self::output`].
    pub fn step(&self, state: &mut State<R>, input: &Input<R>) -> Output<R> {
        self.control(state, input);
        self.output(state)
    }

    /// One control step.
    #[inline(never)] // The timing budget counts it by its symbol.
    pub fn control(&self, state: &mut State<R>, input: &Input<R>) -> Commanded<R> {
        let mut faults = Faults::NONE;
        let sensors = self.guard.sensors(&mut state.guard, &input.sensors, &mut faults);
        let elapsed = self.clock.step(input.elapsed, &mut faults);
        let motor = self.read(state, &sensors, input.status, &elapsed, &mut faults);
        match state.slot {
            Slot::Plan => self.plan(state, input, motor.angle),
            Slot::Learn => self.learn(state, &input.gains, motor.angle),
            Slot::ObserveOutput => {
                let age = state.latch.age;
                let reading = state.latch.output.take().filter(|_| age == 0 || self.observer.looks_back());
                state.output_reading = reading.map(|raw| (raw, age));
                self.observe(state, motor.angle, state.output_reading.is_some());
            }
            Slot::Check => self.check(state),
            Slot::Model => self.model(state, motor.angle),
            Slot::Observe | Slot::ObserveSecond | Slot::ObserveLast => {
                self.observe(state, motor.angle, false);
            }
        }
        state.slot = state.slot.next();
        faults = faults.with(state.faults.all());
        let mut motor_torque = self.drive(state, &motor, &elapsed, &mut faults);
        if !state.mode.stays_active(faults, input.status) {
            motor_torque = self.change_mode(state, &mut faults, input.status, motor_torque);
        }
        state.sound &= faults == Faults::NONE && !state.limited;
        state.reported = faults;
        Commanded { motor_torque, faults, mode: state.mode.mode() }
    }

    /// Command, references and estimates of the last step; separate from the control step, so that callers pay only on
    /// request.
    #[inline(never)] // The timing budget counts it by its symbol.
    pub fn output(&self, state: &State<R>) -> Output<R> {
        let [position_error, feed_forward] = state.sent;
        let driven = state.mode.mode().drives();
        let mut estimate = self.observer.estimate(&state.observer, &state.gear_correction);
        // The learnt gravity is an external torque, too.
        let external_torque = estimate.external_torque + state.learning.gravity_torque();
        estimate.external_torque = external_torque.limit(self.limits.output_torque);
        Output {
            motor_torque: state.fallback.torque(),
            feed_forward_torque: if driven { feed_forward.limit(self.limits.motor_torque) } else { R::ZERO },
            motor_reference: state.motor_encoder.angle().plus(position_error),
            estimate,
            observed: !state.slot.observes(),
            factors: *state.learning.applied(),
            faults: state.reported,
            mode: state.mode.mode(),
        }
    }

    /// Torque in the mode after this step: none where the drive is off or is switched on with this step; then the
    /// reference begins at the output's angle.
    #[cold]
    #[inline(never)]
    fn change_mode(&self, state: &mut State<R>, faults: &mut Faults, status: Status, torque: R) -> R {
        let before = state.mode.mode();
        let mode = state.mode.step(faults, status);
        if before.drives() && mode.drives() {
            return torque;
        }
        state.fallback.sent(R::ZERO);
        state.limited = true;
        if mode.drives() {
            state.commander = Default::default();
            state.feedback = Default::default();
            state.output_feedback = Default::default();
            state.measured_feedback = Default::default();
            state.motor_reference = Default::default();
        }
        R::ZERO
    }

    /// Reads the sensors, in every period.
    #[inline(always)]
    fn read(
        &self,
        state: &mut State<R>,
        sensors: &Sensors<R>,
        status: Status,
        elapsed: &Elapsed<R>,
        faults: &mut Faults,
    ) -> Reading<R> {
        let sound = !status.contains(Status::MOTOR_ENCODER_INVALID);
        let (motor, lost) =
            self.motor_encoder.step(&mut state.motor_encoder, sensors.motor_encoder, sound, elapsed);
        faults.raise_if(!motor.accepted, Faults::MOTOR_ENCODER_JUMP);
        faults.raise_if(lost, Faults::MOTOR_ENCODER_LOST);
        let (commanded, feedback) = (state.fallback.torque(), state.guard.gains().feedback);
        let latch = &mut state.latch;
        latch.motor_torque +=
            self.motor_torque.step(&mut state.motor_torque, commanded, feedback, sensors.motor_torque);
        latch.time += elapsed.time;
        if sensors.output_encoder.is_some() && !status.contains(Status::OUTPUT_ENCODER_INVALID) {
            (latch.output, latch.age) = (sensors.output_encoder, 0);
            latch.output_phase = sensors.output_encoder.map_or(0, |raw| self.output_encoder.phase(raw));
        } else {
            latch.age = latch.age.saturating_add(1);
        }
        if sensors.output_torque.is_some() {
            latch.output_torque = sensors.output_torque;
            state.gauge = sensors.output_torque;
        }
        state.motor_reference.advance(state.wind_up.velocity, elapsed.time);
        state.motor_reference.position_error -= motor.moved;
        motor
    }

    /// The observer's slot.
    #[inline(never)] // The timing budget counts this slot by its symbol.
    fn observe(&self, state: &mut State<R>, motor: Angle<R>, reads_output: bool) {
        let mut faults = Faults::NONE;
        state.rotor.torques += state.latch.motor_torque;
        state.rotor.time += state.latch.time;
        let gauge = state.latch.output_torque.take();
        let measured = Measurement {
            motor,
            reads_output,
            period: state.latch.time,
            motor_torque: R::lit(1.0 / OBSERVER_PERIODS as f64) * state.latch.motor_torque,
            output_torque: gauge.filter(|_| !state.disabled_sensors.contains(Faults::TORQUE_SENSOR_OFF)),
        };
        (state.latch.motor_torque, state.latch.time) = (R::ZERO, R::ZERO);
        self.observer.step(
            &self.gear,
            &mut state.observer,
            &measured,
            &state.gear_correction,
            state.motor_reference.rests,
            &mut faults,
        );
        state.gear_correction.load += state.load_rate;
        self.disturbance.step_fast(&mut state.disturbance, state.observer.external_torque());
        state.wind_up = self.disturbance.wind_up(&state.disturbance);
        state.faults.observer = faults;
    }

    /// Corrects the observer by the output encoder's reading of its last step.
    #[inline(always)]
    fn read_output(&self, state: &mut State<R>, faults: &mut Faults) {
        let Some((raw, age)) = state.output_reading.take() else {
            return;
        };
        let Reading { angle, accepted, .. } = self.output_encoder.step::<R>(&mut state.output_encoder, raw);
        faults.raise_if(!accepted, Faults::OUTPUT_ENCODER_JUMP);
        state.output_raw = Some(raw);
        // The two encoders are mounted at any angle to each other: the first readings that are both
        // accepted are their zero, with the torsion of that moment.
        if state.output_zero.is_none() && accepted && state.motor_encoder.is_accepted() {
            let then = self.observer.output_at_reading(&self.gear, &state.observer, age);
            state.output_zero = then.map(|then| angle.less(then));
        }
        let unsound = Faults::OUTPUT_ENCODER_FROZEN.with(Faults::OUTPUT_ENCODER_OFF);
        let frozen = state.faults.standstill.with(state.disabled_sensors).intersects(unsound);
        if let Some(zero) = state.output_zero.filter(|_| accepted && !frozen) {
            let reading = OutputReading { angle: angle.less(zero), age };
            self.observer.correct_output(&mut state.observer, &reading, &state.gear_correction, faults);
        }
    }

    /// The feed-forward's slot.
    #[inline(never)] // The timing budget counts this slot by its symbol.
    fn plan(&self, state: &mut State<R>, input: &Input<R>, motor: Angle<R>) {
        let mut faults = Faults::NONE;
        let command = self.guard.command(&mut state.guard, &input.command, &mut faults);
        let status =
            CommandStatus { age: input.setpoint_age, readable: !faults.contains(Faults::INPUT_NOT_FINITE) };
        let now = || self.observer.estimate(&state.observer, &state.gear_correction);
        let target = self.commander.step(&mut state.commander, &command, status, now, &mut faults);
        state.faults.plan = faults;
        let setpoint = &target.setpoint;
        let gains = state.guard.gains();
        let rests = setpoint.velocity == R::ZERO;
        let load = self.disturbance.compensated_load(&state.disturbance);
        let correction = self.learning.correction(&state.learning, load, gains);
        let demand =
            self.feed_forward.step(&self.gear, &mut state.feed_forward, setpoint, gains, &correction);
        let position_error = demand.motor.angle.minus(motor);
        // Extrapolates the estimate of a period ago. Its speed is that of the middle of the observer's period.
        let speed_behind = R::lit(1.0 + 0.5 * OBSERVER_PERIODS as f64) * self.dt;
        let velocity = state.observer.output_velocity() + speed_behind * setpoint.acceleration;
        let position = demand.link_offset
            + self.observer.output_offset(&state.observer, &state.gear_correction, position_error, self.dt);
        let reads = self.observer.output_innovation(&state.observer).is_some();
        let newest = self.measured_error(state, setpoint).filter(|_| reads);
        let measured = newest.map(|newest| newest.error);
        let error = OutputError {
            position,
            velocity: velocity - setpoint.velocity,
            setpoint_velocity: setpoint.velocity,
            torque: self.observer.transmitted(&state.observer)
                - state.observer.output_friction()
                - (demand.accelerating - self.behind * demand.accelerating_rate)
                + self.disturbance.whole_load(&state.disturbance)
                + state.learning.gravity_torque(),
            measured,
        };
        let shift = self.output_feedback.step(&mut state.output_feedback, &error);
        let gain = gains.output_feedback * R::from_i32(self.gear.ratio().n());
        let followed = newest.filter(|_| self.output_feedback.is_slow(setpoint.velocity));
        self.measured_feedback.plan(&mut state.measured_feedback, followed, setpoint.velocity, gain);
        if target.switched {
            seldom();
            self.fallback.begin_ramp(&mut state.fallback);
        }
        state.motor_reference = MotorReference {
            position_error: position_error + gain * shift.angle,
            velocity: demand.motor.velocity + gain * shift.rate,
            acceleration: demand.acceleration,
            jerk: demand.jerk,
            acceleration_gain: gains.wind_up,
            torque: demand.torque,
            torque_rate: demand.torque_rate,
            transmission: demand.transmission,
            wind_up_compliance: demand.wind_up_compliance,
            output_torque: target.torque,
            rests: rests && target.torque.is_none(),
            switched: target.switched,
            planned: true,
            closed: target.torque.is_none(),
        };
        self.learning.follow(&mut state.learning, &demand.excitation, measured);
    }

    /// Output encoder's newest reading less the setpoint of its time, where it is near the last accepted one.
    #[inline(always)]
    fn measured_error(&self, state: &State<R>, setpoint: &Setpoint<R>) -> Option<MeasuredError<R>> {
        let phase = state.latch.output_phase;
        let zero = state.output_zero.filter(|_| self.output_encoder.is_near(&state.output_encoder, phase))?;
        let counts = phase.wrapping_sub(zero.phase()).wrapping_sub(setpoint.position.phase()).cast_signed();
        let late = R::from_i32((state.latch.age + self.observer.output_delay()).cast_signed()) * self.dt;
        let error = R::from_i32(counts) * R::lit(RADIANS_PER_COUNT) + late * setpoint.velocity;
        Some(MeasuredError { phase, error })
    }

    /// The slot of the slow disturbance estimate, of the feed-forward's line and hysteresis, and of the adaptation.
    #[inline(always)]
    fn learn(&self, state: &mut State<R>, gains: &Directions<R>, motor: Angle<R>) {
        let joint = DisturbanceInput {
            motor_torque: state.motor_reference.torque,
            rests: state.commander.velocity() == R::ZERO,
            compliance: state.motor_reference.wind_up_compliance,
            gain: state.guard.gains().wind_up,
        };
        let external_torque = state.observer.external_torque();
        self.disturbance.step_slow(&mut state.disturbance, external_torque, &joint);
        self.feed_forward.step_torsion(&self.gear, &mut state.feed_forward, state.learning.applied());
        if state.learns() {
            self.learning.learn_ripple(&mut state.learning);
        }
        (state.gear_correction, state.load_rate) =
            self.learning.gear_correction(&state.learning, state.guard.gains());
        let trusted = state.fallback.trusted();
        let mut settled = true;
        let falls_back = !trusted && !self.guard.model_is_off(&state.guard);
        match if falls_back { SlowSlot::RampGains } else { state.slow } {
            SlowSlot::Adapt => self.adapt(state),
            SlowSlot::StandardDeviations => {
                self.shape(state);
                self.observer.step_standard_deviations(&mut state.observer);
                if state.learns() {
                    let external_torque = state.observer.external_torque();
                    self.learning.learn_gravity(&mut state.learning, external_torque);
                }
                self.notice_standstill(state, motor);
                settled = self.guard.gains_have_settled(&state.guard, gains, trusted);
                state.faults.gains = Faults::NONE;
            }
            SlowSlot::RampGains => {
                let motion = validation::CommandedMotion { velocity: state.commander.velocity(), trusted };
                let mut faults = Faults::NONE;
                self.guard.ramp_gains(&mut state.guard, gains, motion, &mut faults);
                state.faults.gains = faults;
            }
        }
        state.slow = state.slow.next(settled);
        state.faults.collect();
    }

    /// The slot of the feed-forward's models.
    #[inline(always)]
    fn model(&self, state: &mut State<R>, motor: Angle<R>) {
        let reference = state.motor_reference.reference(motor);
        let factors = state.learning.applied();
        self.feed_forward.step_models(&self.gear, &mut state.feed_forward, reference, factors);
        let (position, gains) = (state.commander.position(), state.guard.gains());
        self.learning.step_models(&mut state.learning, reference, position, gains);
    }

    /// Compares the balance of the rotor with its reference, the drive and the sensors at the output.
    #[inline(always)]
    fn check(&self, state: &mut State<R>) {
        let mut faults = Faults::NONE;
        self.output_feedback.integrate(&mut state.output_feedback, !state.limited);
        self.read_output(state, &mut faults);
        let reference = &state.motor_reference;
        // With a feedback gain below 1 another controller moves the motor.
        let controlled = reference.planned && reference.output_torque.is_none();
        let driven = state.mode.mode().drives() && state.guard.gains().feedback == R::ONE;
        let input = RotorInput {
            motor: state.observer.motor(),
            commanded: state.fallback.torque(),
            drive_error: state.motor_torque.drive_error(),
            reference: controlled.then_some([reference.position_error, reference.velocity]),
            driven,
        };
        self.rotor.step(&mut state.rotor, &input, &mut faults);
        let [torque, rate, friction] = state.rotor.gear();
        self.protection.follow(&mut state.protection, torque, rate, friction);
        if state.output_zero.is_some() {
            if let Some(innovation) = self.observer.output_innovation(&state.observer) {
                let torsion = state.observer.torsion() - innovation;
                state.disabled_sensors =
                    state.disabled_sensors.with(self.rotor.torsion_disagrees(&mut state.rotor, torsion));
            }
            faults.raise_if(state.latch.age > self.output_lost, Faults::OUTPUT_ENCODER_LOST);
        }
        if let Some(gauge) = state.gauge {
            state.disabled_sensors =
                state.disabled_sensors.with(self.rotor.gauge_disagrees(&mut state.rotor, gauge));
        }
        state.faults.rotor = faults.with(state.disabled_sensors);
        state.faults.collect();
    }

    /// Raises the faults of encoders that stand still while a motion is commanded. A joint that a brake holds against
    /// its load is detected too: the shift of the output feedback is a commanded motion.
    #[inline(always)]
    fn notice_standstill(&self, state: &mut State<R>, motor: Angle<R>) {
        let mut faults = Faults::NONE;
        let velocity = state.motor_reference.commanded_velocity();
        let stood_still = motor == state.last_motor;
        state.last_motor = motor;
        let frozen = self.frozen_encoder.step(&mut state.frozen_path, stood_still, velocity);
        faults.raise_if(frozen && state.mode.mode().drives(), Faults::MOTOR_ENCODER_FROZEN);
        if let Some(raw) = state.output_raw.take() {
            let stood_still = state.last_output.replace(raw) == Some(raw);
            self.frozen_output.step(&mut state.frozen_output_path, stood_still, velocity);
        }
        faults
            .raise_if(self.frozen_output.is_frozen(state.frozen_output_path), Faults::OUTPUT_ENCODER_FROZEN);
        state.faults.standstill = faults;
    }

    /// The factors' slot.
    #[inline(always)]
    fn adapt(&self, state: &mut State<R>) {
        let observed = Observed {
            external_torque: state.observer.external_torque(),
            torsion: state.observer.torsion(),
            output_innovation: self.observer.moving_output_innovation(&state.observer),
            stiffness_torque: state.observer.stiffness_torque(),
        };
        let gains = state.guard.gains();
        let learns = state.learns();
        let presliding = self.feed_forward.presliding(&self.gear, &state.feed_forward);
        self.learning.adapt(&mut state.learning, presliding, &observed, gains, learns);
        state.sound = true;
    }

    /// Sets the learnt shape and stiffness of the friction's presliding.
    #[inline(always)]
    fn shape(&self, state: &mut State<R>) {
        let Factors { presliding, presliding_stiffness, .. } = *state.learning.applied();
        let stiffening = presliding_stiffness - R::ONE;
        self.feed_forward.shape(&self.gear, &mut state.feed_forward, presliding, stiffening);
        self.observer.shape(&self.gear, &mut state.observer, presliding, stiffening);
    }

    /// Torque command of the cascade, in every period.
    #[inline(always)]
    fn drive(
        &self,
        state: &mut State<R>,
        motor: &Reading<R>,
        elapsed: &Elapsed<R>,
        faults: &mut Faults,
    ) -> R {
        let phase = (state.latch.age == 0).then_some(state.latch.output_phase);
        let shift = self.measured_feedback.step(&mut state.measured_feedback, phase, elapsed.time);
        let (reference, wind_up) = (&state.motor_reference, &state.wind_up);
        let input = CascadeInput {
            position_error: reference.followed_error(shift, self.rounding),
            velocity: reference.velocity + wind_up.velocity,
            acceleration: reference.acceleration_gain * reference.acceleration + wind_up.acceleration,
        };
        let held = state.limited || !reference.closed;
        let feedback = self.feedback.step(&mut state.feedback, motor.moved * elapsed.inverse, &input, held)
            + wind_up.torque;
        let closed = if reference.closed {
            state.guard.gains().feedback * self.taken_over(state, feedback)
        } else {
            seldom();
            let torque = reference.transmission * reference.output_torque.unwrap_or_default();
            state.motor_reference.switched = false;
            torque
        };
        let torque = self.command(state, state.motor_reference.torque + closed, faults);
        state.sent = [state.motor_reference.position_error, state.motor_reference.torque];
        torque
    }

    /// The feedback, which goes on from the torque (N m) so far when it was switched to.
    fn taken_over(&self, state: &mut State<R>, feedback: R) -> R {
        if !state.motor_reference.switched {
            return feedback;
        }
        seldom();
        state.motor_reference.switched = false;
        let difference = state.fallback.torque() - state.motor_reference.torque - feedback;
        feedback + self.feedback.take_over(&mut state.feedback, difference)
    }

    /// The torque command: `target` (N m) limited to the motor's peak torque and to the gear's rating.
    fn command(&self, state: &mut State<R>, target: R, faults: &mut Faults) -> R {
        let limited = target.limit(self.limits.motor_torque);
        faults.raise_if(limited != target, Faults::TORQUE_LIMITED);
        let ramped = self.fallback.step(&mut state.fallback, limited, *faults);
        let torque = self.protection.limit(&state.protection, ramped).limit(self.limits.motor_torque);
        if torque != ramped {
            seldom();
            faults.raise_if(true, Faults::TORQUE_LIMITED);
            state.fallback.sent(torque);
        }
        // The feedback's integral must not run while its torque does not reach the motor.
        state.limited = torque != target;
        torque
    }
}
