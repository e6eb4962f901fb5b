//! Observer: the gear's model, corrected by the innovations of the joint's sensors.
//!
//! ```text
//! state   theta_wg, omega_wg, theta_fs, omega_fs, d (external torque on the flexspline),
//!         s (residual of tau_t against the model), b (residual of the motor's torque)
//! predict omega_wg += T*(tau_mean + b - tau_res - (r + de/dtheta_wg)*s)/J_wg,    theta_wg += T*omega_wg
//!         omega_fs += T*(tau_t + s - tau_fric_out + d)/J_fs,                          theta_fs += T*omega_fs
//! correct state += l_m*(theta_m - theta_wg),  then l_t*(tau_s - tau_t - s),  then l_o*(theta_o - theta_fs)
//! ```
//!
//! Its period T is [`crate::compensator::schedule::OBSERVER_PERIODS`] control periods. tau_mean is the motor's torque
//! averaged over the last two of its periods; tau_res = tau_wg - J_wg*domega_wg, tau_t and the frictions are those of [`multi_rate`], the two-port in its
//! real-time build, at the motion before the prediction: the observer's model includes hysteresis, presliding and
//! kinematic error. Angles are compared after the prediction, where they are at the time of the reading; the gauge with a
//! torque that is one period older. theta_m, theta_o are the encoders, tau_s a strain gauge; each of the last two may
//! be absent, at any step, and theta_o, which is used once a round, may be delayed by a constant number of control
//! periods ([`past`]). The states are theta_wg - theta_m (motor residual) and theta_fs - r*theta_wg (link offset): both
//! are small, so that an f32 resolves them, and neither drifts by rounding, for the motor's angle is never summed up. The
//! gains l are those of the steady-state Kalman filter of the linearised model, one set for each combination of
//! sensors, computed off line. Units: rad, rad/s, N m.
//!
//! The gear's model is corrected by the factors and the ripple ([`GearCorrection`]) that
//! [`crate::compensator::adapt::learning`] has learnt. A stiffness error of 10 % makes the measured torsion disagree with
//! the motor's torque by 10 %. Which of the two is trusted depends on the motor. Where it moves, its friction is known to
//! a few N m at the output and the residual is attributed to the stiffness: s. Where it stands, static friction or a
//! brake may hold any torque, so that the residual is attributed to b and s is held. Standstill is detected after
//! [`SETTLED_TIME`](crate::compensator::tuned::SETTLED_TIME); the gains of a motor that stands are small. With the motor encoder alone neither is observable
//! beside d, and both stay zero. s is limited to 3 standard deviations of the stiffness.
//!
//! A resting output may be anywhere within the count of its encoder: while the motor stands, the innovation theta_o -
//! theta_fs passes a dead zone of half width q. An innovation beyond 0.3 of the torsion at peak torque and two counts corrects
//! nothing at first: motor and model know the torsion better. It does after as many of them in a row as take the encoder out
//! of use, unless the torque on the rotor explains it ([`crate::compensator::sense::rotor`]).
//!
//! Discretisation: semi-implicit Euler, one step per period. It is the leapfrog method, whose speeds belong to the
//! middle of the periods: a torque that acts over one period is split between the two speeds beside its beginning and
//! its end. Applied to one of them alone it would come half a period early, which an observer with an accurate motor
//! model attributes to a load: 29 N m where the torque oscillates by 100 N m at 130 Hz, both at the output.
//!
//! Bounds: speeds are limited to twice what the joint can do, the external torque to the gear's peak torque; a
//! torsion beyond that of four times the peak torque starts the observer again at the motor's angle. Both are
//! reported as faults, as is a torsion past the range of the gear's law ([`crate::flexspline::reduced::RANGE`]), whose
//! torque saturates there. The reported transmitted torque is limited to four times the peak torque.
//!
//! H. Taghirad, P. Belanger, "Modeling and parameter identification of harmonic drive systems", Journal of Dynamic
//! Systems, Measurement, and Control 120 (1998) for the two masses; R. Kalman, "A new approach to linear filtering
//! and prediction problems", Journal of Basic Engineering 82 (1960).

pub mod deviation;
mod gains;
pub mod multi_rate;
mod params;
pub mod past;
mod range;
mod standstill;
mod state;

pub use gains::{Correction, GainSets, Gains, STATES};
pub use multi_rate::GearCorrection;
pub use params::{LONGEST_PERIOD, ObserverParams};
pub use state::ObserverState;

use crate::angle::{Angle, Ratio};
use crate::belt::SeriesBelt;
use crate::branch::seldom;
use crate::compensator::faults::Faults;
use crate::compensator::schedule::{CONTROL_PERIOD, SLOW_PERIODS};
use crate::compensator::tuned::TRANSIENT_TIME;
use crate::compensator::{Estimate, RealTimeGear};
use crate::constants::constants;
use crate::real::{RADIANS_PER_COUNT, Real};
use deviation::{Magnitudes, Uncertainty};
use gains::set;
use multi_rate::{Ends, MultiRate, Torques};
use past::Past;
use range::Range;

/// The built observer.
///
/// A motor turns at a constant 20 rad/s while 25 N m push against the output. From the motor's angle and torque alone the
/// observer finds the load and the wind-up:
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::compensator::estimate::observer::{GearCorrection, Measurement};
/// use strainwave::compensator::schedule::OBSERVER_PERIODS;
/// use strainwave::compensator::{Faults, RealTimeFlexspline, RealTimeGear};
/// use strainwave::gear::Motion;
///
/// let (params, dt, load) = (JOINT.gear, JOINT.dt, -25.0);
/// let flexspline = RealTimeFlexspline::build(&params.flexspline, params.rated_torque)?;
/// let gear: RealTimeGear<f32> = params.build(flexspline, dt)?;
/// let observer = JOINT.observer.build(&params, &JOINT.limits, &JOINT.tolerances, dt)?;
/// let (mut plant, mut state) = (gear.rest(), observer.rest());
/// let (mut motor, mut output) = (Motion::<f32>::default(), Motion::default());
/// let (mut faults, mut torque, mut torsion) = (Faults::NONE, 0.0, 0.0);
/// for period in 0..20_000 {
///     motor.velocity = (motor.velocity + 0.01).min(20.0);
///     motor.angle = motor.angle.plus(dt * motor.velocity);
///     let torques = gear.step(&mut plant, &mut output, &motor, load);
///     (torque, torsion) = (torque + torques.wave_generator, torques.torsion);
///     if period % OBSERVER_PERIODS == OBSERVER_PERIODS - 1 {
///         let measured = Measurement {
///             motor: motor.angle,
///             motor_speed: motor.velocity,
///             reads_output: false,
///             period: OBSERVER_PERIODS as f32 * dt,
///             motor_torque: torque / OBSERVER_PERIODS as f32,
///             output_torque: None,
///         };
///         observer.step(&gear, &mut state, &measured, &GearCorrection::default(), false, &mut faults);
///         torque = 0.0;
///     }
/// }
/// let estimate = observer.estimate(&state, &GearCorrection::default());
/// assert!((estimate.external_torque - load).abs() < 1.0, "{}", estimate.external_torque);
/// assert!((estimate.torsion - torsion).abs() < 3e-5, "{} {torsion}", estimate.torsion);
/// assert!((estimate.output_position.minus(output.angle)).abs() < 3e-5); // rad, after 6 turns of the motor
/// assert_eq!(faults, Faults::NONE);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer<R> {
    /// Motion threshold of the motor: counts of 2^32 a revolution, and as an angle (rad).
    motion_threshold: u32,
    motion_threshold_angle: R,
    /// Delay of a reading in control periods, and in periods of the observer.
    late: u32,
    delay: u32,
    /// Readings may be delayed.
    looks_back: bool,
    ratio: Ratio,
    period: u32,
    output_count: R,
    uncertainty: Uncertainty<R>,
    limits: Range<R>,
    inverse_wave_generator_inertia: R,
    inverse_flexspline_inertia: R,
    multi_rate: MultiRate<R>,
    moving: GainSets<R>,
    standing: GainSets<R>,
}

/// Sensor readings of one step of the observer, already checked.
#[derive(Clone, Copy, Debug)]
pub struct Measurement<R> {
    /// Unbounded angle of the motor.
    pub motor: Angle<R>,
    /// Its speed in the last control period (rad/s): what the observer starts from, and nothing else.
    pub motor_speed: R,
    /// A reading of the output encoder of this step follows ([`Observer::correct_output`]).
    pub reads_output: bool,
    /// Time since the last step of the observer (s).
    pub period: R,
    /// Torque of the motor, its mean over the steps of that time (N m).
    pub motor_torque: R,
    /// Torque through the flexspline (N m).
    pub output_torque: Option<R>,
}

/// A reading of the output encoder, already checked.
#[derive(Clone, Copy, Debug)]
pub struct OutputReading<R> {
    /// Angle of the output at the instant of the reading.
    pub angle: Angle<R>,
    /// Control periods from when the reading came to the observer's last step; 0 for one that does not look back.
    pub age: u32,
}

impl<R: Real> Observer<R> {
    /// The same of a gear behind a belt: theta_wg is the input angle of the belt ([`crate::belt::series`]).
    #[must_use]
    pub fn behind(self, belt: SeriesBelt<R>) -> Self {
        Self { multi_rate: self.multi_rate.behind(belt), ..self }
    }

    /// Angle of the output, up to whole revolutions, at the instant of a reading that came `age` control periods before
    /// the last step; `None` where that was before the start.
    pub fn output_at_reading(
        &self,
        gear: &RealTimeGear<R>,
        state: &ObserverState<R>,
        age: u32,
    ) -> Option<Angle<R>> {
        if !self.looks_back {
            return Some(gear.drive(state.motor));
        }
        state.past.before(self.late as usize + age as usize).map(|phase| Angle::from_counts(phase.into()))
    }

    /// Measured less estimated output angle at the last reading (rad), where there is one within its period.
    #[inline(always)]
    pub fn output_innovation(&self, state: &ObserverState<R>) -> Option<R> {
        (state.since_output <= self.period).then_some(state.output_innovation)
    }

    /// The same while the motor moves.
    #[inline(always)]
    pub fn moving_output_innovation(&self, state: &ObserverState<R>) -> Option<R> {
        let valid = state.since_output <= self.period && state.magnitudes.moved;
        valid.then_some(state.output_innovation)
    }

    /// By how much the output encoder's reading is late (control periods).
    #[inline(always)]
    pub fn output_delay(&self) -> u32 {
        self.late
    }

    /// Readings may be delayed: they are late, or do not come in every control period.
    #[inline(always)]
    pub fn looks_back(&self) -> bool {
        self.looks_back
    }

    /// Predicts over one period, and corrects by the measurement. `rests`: rest is commanded.
    #[inline(always)]
    pub fn step(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
        gear_correction: &GearCorrection<R>,
        rests: bool,
        faults: &mut Faults,
    ) {
        if !state.started {
            seldom();
            // By its numbers: of a reference the hot path would write the measurement to memory.
            let moved = measured.motor_speed * R::lit(CONTROL_PERIOD);
            let stands = moved.is_within(self.motion_threshold_angle);
            let speed = if stands { R::ZERO } else { measured.motor_speed };
            let torques = (measured.motor_torque, measured.output_torque.is_some());
            return self.first(gear, state, (measured.motor, speed), torques);
        }
        let (motor, residual) = (state.motor, state.motor_residual);
        let ends = Ends {
            wave_generator: || offset_by(motor, residual),
            wave_generator_speed: state.wave_generator_speed,
            link_offset: state.link_offset,
            flange_speed: state.flange_speed,
        };
        let torques = state.gear.torques(&self.multi_rate, gear, &ends, gear_correction);
        faults.raise_if(torques.saturated, Faults::TORSION_BEYOND_RANGE);
        if !torques.torsion.is_within(self.limits.torsion) {
            seldom();
            faults.raise_if(true, Faults::OBSERVER_RESET);
            // It starts again with its next step: that alone costs as much as this one.
            (state.started, state.motor) = (false, measured.motor);
            return;
        }
        let acceleration = self.predict(state, &torques, measured, gear_correction);
        let predicted = state.motor_residual.is_within(self.motion_threshold_angle);
        let moved = state.standstill.step(measured.motor.phase(), predicted, rests, self.motion_threshold);
        let sets = if moved { &self.moving } else { &self.standing };
        let gauge = measured.output_torque.is_some();
        let gains = set(sets, measured.reads_output, gauge);
        let load_correction = self.correct(gains, state, measured, &torques, moved);
        self.limits.keep(state, &torques, moved, faults);
        state.magnitudes = Magnitudes {
            load_correction: state.magnitudes.load_correction + load_correction,
            moved,
            input_friction: torques.input_friction,
            output_friction: torques.output_friction,
            transmitted: torques.transmitted + state.stiffness_torque,
            torsion: torques.torsion,
            torsion_rate: torques.torsion_rate,
            output_speed: state.flange_speed,
            acceleration,
        };
        state.since_output = state.since_output.saturating_add(1);
        state.readings = [state.since_output <= self.period, gauge];
    }

    /// Corrects by a reading of the output encoder, after the step that it belongs to.
    #[inline(always)]
    pub fn correct_output(
        &self,
        state: &mut ObserverState<R>,
        reading: &OutputReading<R>,
        gear_correction: &GearCorrection<R>,
        faults: &mut Faults,
    ) {
        let Some(innovation) =
            self.output_innovates(state, reading, gear_correction).filter(|_| state.started)
        else {
            return;
        };
        (state.output_innovation, state.since_output) = (innovation, 0);
        if self.is_gross(state, innovation) {
            return;
        }
        let (before, moved) = (state.external_torque, state.magnitudes.moved);
        let sets = if moved { &self.moving } else { &self.standing };
        let gains = set(sets, true, state.readings[1]);
        let innovation = if moved { innovation } else { innovation.dead_zone(self.output_count) };
        state.correct(&gains.output, innovation, moved);
        if self.looks_back {
            state.past.correct(self.delay as usize, &gains.past, innovation);
        }
        self.limits.keep_motion(state, faults);
        state.magnitudes.load_correction += state.external_torque - before;
    }

    /// The estimate.
    pub fn estimate(&self, state: &ObserverState<R>, gear_correction: &GearCorrection<R>) -> Estimate<R> {
        let Magnitudes { torsion, input_friction, output_friction, .. } = state.magnitudes;
        let (output_position, output_velocity) = self.output(state, gear_correction);
        Estimate {
            output_position,
            output_velocity,
            torsion,
            transmitted_torque: self.transmitted(state),
            input_friction,
            output_friction,
            external_torque: state.external_torque,
            deviation: state.deviation,
        }
    }

    /// Of the estimate, the output's angle and speed (rad/s).
    #[inline(always)]
    pub fn output(&self, state: &ObserverState<R>, gear_correction: &GearCorrection<R>) -> (Angle<R>, R) {
        (self.output_position(state).plus(gear_correction.position), state.flange_speed)
    }

    /// theta_fs, of the model.
    #[inline(always)]
    fn output_position(&self, state: &ObserverState<R>) -> Angle<R> {
        self.ratio.apply(state.motor).plus(self.multi_rate.ratio() * state.motor_residual + state.link_offset)
    }

    /// Output angle, ripple included, less r times a motor angle that is `motor_offset` (rad) from the measured one, a
    /// time dt (s) after the last step (rad).
    #[inline(always)]
    pub fn output_offset(
        &self,
        state: &ObserverState<R>,
        gear_correction: &GearCorrection<R>,
        motor_offset: R,
        dt: R,
    ) -> R {
        let ratio = self.multi_rate.ratio();
        let now = state.link_offset + dt * (state.flange_speed - ratio * state.wave_generator_speed);
        now + ratio * (state.motor_residual - motor_offset) + gear_correction.position
    }

    /// tau_t + s (N m).
    #[inline(always)]
    pub fn transmitted(&self, state: &ObserverState<R>) -> R {
        state.magnitudes.transmitted.limit(self.limits.transmitted)
    }

    /// Standard deviations of the estimates after [`deviation::PERIODS`] more periods.
    #[inline(always)]
    pub fn step_standard_deviations(&self, state: &mut ObserverState<R>) {
        let sets = if state.magnitudes.moved { &self.moving } else { &self.standing };
        let [output, gauge] = state.readings;
        let spread = &set(sets, output, gauge).spread;
        state.deviation = spread.step(&mut state.spread, &self.uncertainty, &state.magnitudes);
        state.magnitudes.load_correction = R::ZERO;
    }

    /// Sets the learnt shape of the presliding of either side ([`crate::friction::JointFriction::shape`]).
    #[inline(always)]
    pub fn shape(&self, gear: &RealTimeGear<R>, state: &mut ObserverState<R>, order_two: R, stiffening: R) {
        state.gear.shape(gear, order_two, stiffening);
    }

    /// The first step, also after a reset: the joint moves as its motor does, with its torques unknown. From the motor's angle,
    /// speed (rad/s) and torque (N m), and that there is a gauge.
    #[cold]
    #[inline(never)]
    fn first(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        (motor, motor_speed): (Angle<R>, R),
        (motor_torque, gauge): (R, bool),
    ) {
        state.motor = motor;
        state.motor_residual = R::ZERO;
        state.wave_generator_speed = motor_speed;
        state.link_offset = state.gear.start_at(gear, motor);
        state.gear.take_turn();
        state.flange_speed = self.multi_rate.ratio() * motor_speed;
        state.motor_torque = motor_torque;
        state.external_torque = R::ZERO;
        state.stiffness_torque = R::ZERO;
        state.held_torque = R::ZERO;
        state.past = Past::default();
        (state.started, state.gross) = (true, 0);
        state.past.push(self.output_position(state).phase());
        let set = set(&self.standing, false, gauge);
        state.deviation = set.spread.base;
        state.magnitudes = Magnitudes::default();
    }

    /// Predicts the motion of both ends over one period; returns the flange's acceleration (rad/s^2).
    #[inline(always)]
    fn predict(
        &self,
        state: &mut ObserverState<R>,
        torques: &Torques<R>,
        measured: &Measurement<R>,
        gear_correction: &GearCorrection<R>,
    ) -> R {
        let resisting = torques.input_friction
            + gear_correction.motor_torque
            + torques.slope * (torques.transmitted + state.stiffness_torque);
        let mean = R::lit(0.5) * (measured.motor_torque + state.motor_torque);
        state.motor_torque = measured.motor_torque;
        let motor = (mean + state.held_torque - resisting) * self.inverse_wave_generator_inertia;
        let load = state.external_torque + gear_correction.load + state.stiffness_torque;
        let flange = (torques.transmitted - torques.output_friction + load) * self.inverse_flexspline_inertia;
        let dt = measured.period;
        state.wave_generator_speed += dt * motor;
        state.flange_speed += dt * flange;
        let step = dt * state.wave_generator_speed;
        state.motor_residual += step - measured.motor.since(state.motor);
        state.link_offset += dt * state.flange_speed - self.multi_rate.ratio() * step;
        state.motor = measured.motor;
        flange
    }

    /// Corrects by the motor's encoder and the gauge, one after the other; returns the change of d (N m).
    #[inline(always)]
    fn correct(
        &self,
        gains: &Gains<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
        torques: &Torques<R>,
        moved: bool,
    ) -> R {
        let before = state.external_torque;
        state.correct(&gains.motor, -state.motor_residual, moved);
        if let Some(torque) = measured.output_torque {
            state.correct(&gains.torque, torque - torques.transmitted - state.stiffness_torque, moved);
        }
        if self.looks_back {
            state.past.push(self.output_position(state).phase());
        }
        state.external_torque - before
    }

    /// The innovation is larger than what is uncertain of the torsion, and has not been for as long as it takes to tell that
    /// the encoder disagrees with the motor's side.
    #[inline(always)]
    fn is_gross(&self, state: &mut ObserverState<R>, innovation: R) -> bool {
        if innovation.is_within(self.limits.output_innovation) {
            state.gross = 0;
            return false;
        }
        seldom();
        state.gross = state.gross.saturating_add(1);
        state.gross <= TRANSIENT_TIME.periods(f64::from(SLOW_PERIODS) * CONTROL_PERIOD)
    }

    /// theta_o less ripple less theta_fs at the instant of the reading (rad), where there is one.
    #[inline(always)]
    fn output_innovates(
        &self,
        state: &ObserverState<R>,
        reading: &OutputReading<R>,
        gear_correction: &GearCorrection<R>,
    ) -> Option<R> {
        let OutputReading { angle, age } = *reading;
        if !self.looks_back {
            let measured = angle.minus(self.ratio.apply(state.motor));
            return Some(
                measured
                    - self.multi_rate.ratio() * state.motor_residual
                    - state.link_offset
                    - gear_correction.position,
            );
        }
        seldom();
        let then = state.past.before(self.late as usize + age as usize)?;
        let counts = angle.phase().wrapping_sub(then).cast_signed();
        Some(R::from_i32(counts) * R::lit(RADIANS_PER_COUNT) - gear_correction.position)
    }
}

/// An angle plus an offset (rad), to a count.
#[inline(always)]
pub(super) fn offset_by<R: Real>(angle: Angle<R>, offset: R) -> Angle<R> {
    let counts = (offset * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32();
    Angle::from_counts(angle.counts.wrapping_add(i64::from(counts)))
}
