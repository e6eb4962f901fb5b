//! Observer: the gear's own model, corrected by what the joint's sensors say.
//!
//! ```text
//! state   theta_wg, omega_wg, theta_fs, omega_fs, d (external torque on the flexspline),
//!         s (what tau_t is off the model's), b (what the motor's torque is off it)
//! predict omega_wg += dt*(tau_mean + b - tau_res - (r + de/dtheta_wg)*s)/J_wg,   theta_wg += dt*omega_wg
//!         omega_fs += dt*(tau_t + s - tau_fric_out + d)/J_fs,                         theta_fs += dt*omega_fs
//! correct state += l_m*(theta_m - theta_wg),  then l_t*(tau_s - tau_t - s),  then l_o*(theta_o - theta_fs)
//! ```
//!
//! tau_mean is the motor's torque averaged over the last two control periods; tau_res = tau_wg - J_wg*domega_wg,
//! tau_t and the frictions come from [`crate::gear::Gear`], the two-port in its real-time build, at the motion before
//! the prediction: the observer carries hysteresis, presliding and kinematic error along. Angles are compared after
//! the prediction, where they are at the time of the reading; the gauge with a torque that is one control period
//! older. theta_m, theta_o are the encoders, tau_s a strain gauge; each of the last two may be absent, at any step,
//! and theta_o may come a constant number of periods late ([`past`]). The gains l are those of the steady-state
//! Kalman filter of the linearised model, one set for each combination of sensors, computed off line. Units: rad,
//! rad/s, N m.
//!
//! The gear is that of [`crate::gear::Gear::torques_of_stiffer`], with a flexspline as much stiffer than the model as
//! [`crate::compensator::adaptation`] has learnt. A gear that is stiffer or softer than is known by 10 % makes a
//! torsion that is measured disagree with the motor's torque by 10 %. Which to believe depends on the motor. Where it
//! moves, its friction is known to a few N m at the output and the rest is blamed on the stiffness: s. Where it
//! stands, static friction or a brake may hold whatever there is, so its torque says nothing and what is left over is
//! blamed on b, while s keeps what it learnt. It stands when its encoder has not left a few counts for [`STANDSTILL`]
//! control periods. With the motor encoder alone neither is observable beside d, and both stay zero. s is limited to
//! 3 deviations of the stiffness.
//!
//! A resting output may be anywhere within the count that its encoder shows: while the motor stands, an innovation
//! theta_o - theta_fs within +-q is none, and q is taken from a larger one.
//!
//! Discretisation: semi-implicit Euler, one step per control period. It is the leapfrog method, whose speeds belong
//! to the middle of the periods: a torque that acts over one period is shared by the two speeds beside its beginning
//! and its end. Taken for the whole of one of them it would come half a period early, which an observer that knows
//! its motor well takes for a load: 14 N m where the torque swings by 100 N m at 130 Hz, both at the output.
//!
//! Bounds: speeds are limited to twice what the joint can do, the external torque to the gear's peak torque; a
//! torsion beyond that of four times the peak torque starts the observer again at the motor's angle. Both are
//! reported as faults, as is a torsion past the range of the gear's law ([`crate::flexspline::reduced::RANGE`]),
//! which goes on at its largest torque. The reported transmitted torque ends at those four times.
//!
//! H. Taghirad, P. Belanger, "Modeling and parameter identification of harmonic drive systems", Journal of Dynamic
//! Systems, Measurement, and Control 120 (1998) for the two masses; R. Kalman, "A new approach to linear filtering
//! and prediction problems", Journal of Basic Engineering 82 (1960).

pub mod deviation;
pub mod past;

use crate::angle::Angle;
use crate::compensator::faults::Faults;
use crate::compensator::{Estimate, EstimateDeviation, HYSTERESIS_MEMORY, Limits, RealTimeGear};
use crate::error::{Error, require};
use crate::friction::JointFrictionState;
use crate::gear::{Applied, GearParams, GearState, Motion, Torques};
use crate::real::{RADIANS_PER_COUNT, Real, seldom};
use deviation::{Magnitudes, PERIODS, Spread, SpreadState, Uncertainty};
use past::{LONGEST_DELAY, Past};

/// Number of observed states: the sixth is s where the motor moves, b where it stands.
pub const STATES: usize = 6;

/// Control periods without motion after which the motor stands.
pub const STANDSTILL: u32 = 200;

/// Most control periods from one reading of the output encoder to the next.
pub const LONGEST_PERIOD: u32 = 100;

/// Part of the rated torque that s may have beside its share of the torque: hysteresis, the encoders' zero.
const LEAST_STIFFNESS_TORQUE: f64 = 0.03;

/// Correction of each state [theta_wg, omega_wg, theta_fs, omega_fs, d, s or b] per unit of a sensor's innovation.
pub type Correction<R> = [R; STATES];

/// Gains for one combination of sensors; those of an absent sensor are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains<R> {
    /// l_m, per rad of the motor encoder.
    pub motor: Correction<R>,
    /// l_t, per N m of the strain gauge.
    pub torque: Correction<R>,
    /// F^D l_o, per rad of the output encoder.
    pub output: Correction<R>,
    /// c_1..=c_D, of the past.
    pub past: [R; LONGEST_DELAY],
    /// What the estimates' deviations are made of.
    pub spread: Spread<R>,
}

/// Gains without further sensors, with output encoder, with strain gauge, with both.
pub type GainSets<R> = [Gains<R>; 4];

/// Parameters of the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverParams<R> {
    /// Where the motor moves.
    pub moving: GainSets<R>,
    /// Where it stands.
    pub standing: GainSets<R>,
    /// Way of the motor that is a motion (rad).
    pub stir: R,
    /// Delay of the output encoder's reading (control periods).
    pub output_encoder_delay: u32,
    /// Control periods from one reading of the output encoder to the next.
    pub output_encoder_period: u32,
    /// q (rad): one count of the output encoder.
    pub output_count: R,
    /// How uncertain the model is.
    pub uncertainty: Uncertainty<R>,
}

/// The built observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer<R> {
    moving: GainSets<R>,
    standing: GainSets<R>,
    /// Counts of 2^32 a turn.
    stir: u32,
    delay: usize,
    period: u32,
    output_count: R,
    uncertainty: Uncertainty<R>,
    limits: Range<R>,
    inverse_wave_generator_inertia: R,
    dt: R,
}

/// What the observer believes.
#[derive(Clone, Debug)]
pub struct ObserverState<R: Real> {
    gear: GearState<R, (), JointFrictionState<R>, HYSTERESIS_MEMORY>,
    wave_generator: Motion<R>,
    flange: Motion<R>,
    /// Of the last control period (N m).
    motor_torque: R,
    external_torque: R,
    /// s (N m).
    stiffness_torque: R,
    /// theta_o - theta_fs at the last reading (rad).
    output_innovation: R,
    /// b (N m).
    held_torque: R,
    standstill: Standstill,
    /// Control periods since a reading of the output encoder, up to the period in which it is missed.
    since_output: u32,
    past: Past,
    spread: SpreadState<R>,
    deviation: EstimateDeviation<R>,
    /// Control periods since it was evaluated, and what the innovations asked of d in them (N m).
    periods: u32,
    asked: R,
    started: bool,
}

/// Since when, and where, the motor has not moved.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Standstill {
    phase: u32,
    periods: u32,
}

impl Standstill {
    /// One more control period at this phase; whether the motor moves.
    #[inline(always)]
    fn step(&mut self, phase: u32, stir: u32) -> bool {
        self.periods = (self.periods + 1).min(STANDSTILL);
        if phase.wrapping_sub(self.phase).cast_signed().unsigned_abs() > stir {
            *self = Self { phase, periods: 0 };
        }
        self.periods < STANDSTILL
    }
}

/// What the sensors say in this step, already checked.
#[derive(Clone, Copy, Debug)]
pub struct Measurement<R> {
    /// Unbounded angle of the motor.
    pub motor: Angle<R>,
    /// Angle of the output where it was when the reading was taken.
    pub output: Option<Angle<R>>,
    /// Torque of the motor (N m).
    pub motor_torque: R,
    /// What is known to act on the flexspline beside the model (N m).
    pub known_torque: R,
    /// By how much the flexspline is known to be stiffer than the model, relative to it.
    pub known_stiffness: R,
    /// Torque through the flexspline (N m).
    pub output_torque: Option<R>,
}

impl<R: Real> ObserverParams<R> {
    /// Prepares the observer of a gear for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `gains` unless all are finite, `stir` or `output_count` unless in 0..=1, `output_encoder_delay` beyond
    /// [`LONGEST_DELAY`], `output_encoder_period` unless in 1..=[`LONGEST_PERIOD`], or as [`Limits::check`] and the gear's parts.
    pub fn build(&self, gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Observer<R>, Error> {
        let sets = || self.moving.iter().chain(&self.standing);
        let mut gains = sets().flat_map(|g| g.motor.iter().chain(&g.output).chain(&g.torque).chain(&g.past));
        require(gains.all(|gain| gain.is_finite()), "gains")?;
        require(sets().all(|gains| gains.spread.is_finite()), "deviation")?;
        require(self.stir >= R::ZERO && self.stir <= R::ONE, "stir")?;
        require(self.output_count >= R::ZERO && self.output_count <= R::ONE, "output_count")?;
        let delay = self.output_encoder_delay as usize;
        require(delay <= LONGEST_DELAY, "output_encoder_delay")?;
        require((1..=LONGEST_PERIOD).contains(&self.output_encoder_period), "output_encoder_period")?;
        limits.check()?;
        let wave_generator_inertia = gear.wave_generator_inertia;
        require(wave_generator_inertia > R::ZERO, "wave_generator_inertia")?;
        Ok(Observer {
            moving: self.moving,
            standing: self.standing,
            stir: (self.stir * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32().unsigned_abs(),
            delay,
            period: self.output_encoder_period,
            output_count: self.output_count,
            uncertainty: self.uncertainty,
            limits: Range {
                motor_speed: R::lit(2.0) * limits.motor_speed,
                output_speed: R::lit(2.0) * limits.output_speed(gear.ratio),
                external_torque: limits.output_torque,
                held_torque: limits.output_torque / R::from_i32(gear.ratio).abs(),
                stiffness_torque: [
                    R::lit(3.0) * self.uncertainty.stiffness,
                    R::lit(LEAST_STIFFNESS_TORQUE) * gear.rated_torque,
                ],
                torsion: gear.flexspline.line.build()?.torsion(R::lit(4.0) * limits.output_torque),
                transmitted: R::lit(4.0) * limits.output_torque,
            },
            inverse_wave_generator_inertia: R::ONE / wave_generator_inertia,
            dt,
        })
    }
}

/// What the observer's states are kept in: twice the joint's speeds, its peak torque, and the torsion
/// of four times the peak torque, where the teeth have long ratcheted.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range<R> {
    motor_speed: R,
    output_speed: R,
    external_torque: R,
    held_torque: R,
    /// Of s: share of the transmitted torque, and what is added to it.
    stiffness_torque: [R; 2],
    torsion: R,
    transmitted: R,
}

impl<R: Real> Observer<R> {
    /// The state at rest at the zero angle.
    pub fn rest(&self, gear: &RealTimeGear<R>) -> ObserverState<R> {
        ObserverState {
            gear: gear.rest(),
            wave_generator: Motion::default(),
            flange: Motion::default(),
            motor_torque: R::ZERO,
            external_torque: R::ZERO,
            stiffness_torque: R::ZERO,
            output_innovation: R::ZERO,
            held_torque: R::ZERO,
            standstill: Standstill { phase: 0, periods: STANDSTILL },
            since_output: u32::MAX,
            past: Past::default(),
            spread: SpreadState::default(),
            deviation: EstimateDeviation::default(),
            periods: PERIODS - 1,
            asked: R::ZERO,
            started: false,
        }
    }

    /// Where the output was, up to whole turns, at the instant of the reading that comes with the next step, for a
    /// motor that is at `motor` now; `None` where that was before the start.
    pub fn output_at_reading(
        &self,
        gear: &RealTimeGear<R>,
        state: &ObserverState<R>,
        motor: Angle<R>,
    ) -> Option<Angle<R>> {
        let before = |periods| state.past.before(periods).map(|phase| Angle::from_counts(phase.into()));
        self.delay.checked_sub(1).map_or(Some(gear.drive(motor)), before)
    }

    /// Measured less believed output angle at the last reading (rad), where there is one within its period and the motor moves.
    #[inline(always)]
    pub fn output_innovation(&self, state: &ObserverState<R>) -> Option<R> {
        let told = state.since_output < self.period && state.standstill.periods < STANDSTILL;
        told.then_some(state.output_innovation)
    }

    /// Predicts over one control period, corrects by the measurement, and estimates.
    #[inline(never)] // The timing budget counts blocks by their symbols.
    pub fn step(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
        faults: &mut Faults,
    ) -> Estimate<R> {
        if !state.started {
            seldom();
            return self.first(gear, state, measured);
        }
        let applied = Applied { motor: measured.motor_torque, load: state.external_torque };
        let torques = gear.torques_of_stiffer(
            &mut state.gear,
            &state.wave_generator,
            &state.flange,
            applied,
            measured.known_stiffness,
        );
        faults.raise_if(torques.saturated, Faults::TORSION_BEYOND_RANGE);
        if !torques.torsion.is_within(self.limits.torsion) {
            seldom();
            faults.raise_if(true, Faults::OBSERVER_RESET);
            return self.first(gear, state, measured);
        }
        let moved = state.standstill.step(measured.motor.phase(), self.stir);
        let sets = if moved { &self.moving } else { &self.standing };
        let gauge = measured.output_torque.is_some();
        let gains = set(sets, measured.output.is_some(), gauge);
        let output_seen = self.output_seen(state, measured);
        let torsion_rate = torques.drive_rate - state.flange.velocity;
        let acceleration = self.predict(gear, state, &torques, measured);
        let asked = self.correct(gains, state, measured, torques.transmitted, moved);
        self.keep_in_range(state, &torques, faults);
        let transmitted = (torques.transmitted + state.stiffness_torque).limit(self.limits.transmitted);
        let torsion = torques.torsion;
        state.asked += asked;
        state.periods += 1;
        if state.periods == PERIODS {
            let magnitudes = Magnitudes {
                asked: state.asked,
                moved,
                input_friction: torques.input_friction,
                output_friction: torques.output_friction,
                transmitted,
                torsion,
                torsion_rate,
                output_speed: state.flange.velocity,
                acceleration,
            };
            let spread = &set(sets, output_seen, gauge).spread;
            state.deviation = spread.step(&mut state.spread, &self.uncertainty, &magnitudes);
            (state.asked, state.periods) = (R::ZERO, 0);
        }
        Estimate {
            output_position: state.flange.angle,
            output_velocity: state.flange.velocity,
            torsion,
            transmitted_torque: transmitted,
            input_friction: torques.input_friction,
            output_friction: torques.output_friction,
            external_torque: state.external_torque,
            deviation: state.deviation,
        }
    }

    /// Whether the output encoder has read within its period.
    #[inline(always)]
    fn output_seen(&self, state: &mut ObserverState<R>, measured: &Measurement<R>) -> bool {
        let since = state.since_output.saturating_add(1);
        state.since_output = if measured.output.is_some() { 0 } else { since };
        state.since_output < self.period
    }

    /// The first step, or the first again: the joint rests, and nothing is known of its torques.
    #[cold]
    #[inline(never)]
    fn first(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
    ) -> Estimate<R> {
        state.wave_generator = Motion { angle: measured.motor, velocity: R::ZERO };
        state.flange = Motion { angle: gear.drive(measured.motor), velocity: R::ZERO };
        state.motor_torque = measured.motor_torque;
        state.external_torque = R::ZERO;
        state.stiffness_torque = R::ZERO;
        state.held_torque = R::ZERO;
        state.past = Past::default();
        state.started = true;
        state.past.push(state.flange.angle.phase());
        let set = set(&self.standing, false, measured.output_torque.is_some());
        state.deviation = set.spread.base;
        let (output_position, deviation) = (state.flange.angle, state.deviation);
        Estimate { output_position, deviation, ..Estimate::default() }
    }

    /// Moves both speeds by one control period; answers with the flange's acceleration (rad/s^2).
    #[inline(always)]
    fn predict(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        torques: &Torques<R>,
        measured: &Measurement<R>,
    ) -> R {
        let resisting = torques.wave_generator + torques.slope * state.stiffness_torque;
        let mean = R::lit(0.5) * (measured.motor_torque + state.motor_torque);
        state.motor_torque = measured.motor_torque;
        let motor = (mean + state.held_torque - resisting) * self.inverse_wave_generator_inertia;
        let load = state.external_torque + measured.known_torque + state.stiffness_torque;
        let flange = gear.flange_acceleration(torques, load);
        state.wave_generator.velocity += self.dt * motor;
        state.flange.velocity += self.dt * flange;
        flange
    }

    /// Moves both angles by one control period and corrects by each sensor in turn, for the torque `transmitted` (N m) less s;
    /// answers with what they asked of d (N m). An angle takes its prediction and its corrections as one way.
    #[inline(always)]
    fn correct(
        &self,
        gains: &Gains<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
        transmitted: R,
        moved: bool,
    ) -> R {
        let before = state.external_torque;
        if moved {
            state.held_torque = R::ZERO;
        }
        let mut way = [self.dt * state.wave_generator.velocity, self.dt * state.flange.velocity];
        let innovation = measured.motor.minus(state.wave_generator.angle) - way[0];
        state.correct(&mut way, &gains.motor, innovation, moved);
        if let Some(torque) = measured.output_torque {
            let innovation = torque - transmitted - state.stiffness_torque;
            state.correct(&mut way, &gains.torque, innovation, moved);
        }
        state.flange.angle = state.flange.angle.plus(way[1]);
        state.past.push(state.flange.angle.phase());
        if let (Some(angle), Some(then)) = (measured.output, state.past.before(self.delay)) {
            let counts = angle.phase().wrapping_sub(then).cast_signed();
            let innovation = R::from_i32(counts) * R::lit(RADIANS_PER_COUNT);
            state.output_innovation = innovation;
            let innovation =
                if moved { innovation } else { innovation - innovation.limit(self.output_count) };
            way[1] = R::ZERO;
            state.correct(&mut way, &gains.output, innovation, moved);
            state.flange.angle = state.flange.angle.plus(way[1]);
            state.past.correct(self.delay, &gains.past, innovation);
        }
        state.wave_generator.angle = state.wave_generator.angle.plus(way[0]);
        state.external_torque - before
    }

    #[inline(always)]
    fn keep_in_range(&self, state: &mut ObserverState<R>, torques: &Torques<R>, faults: &mut Faults) {
        let limits = &self.limits;
        for (value, bound) in [
            (&mut state.wave_generator.velocity, limits.motor_speed),
            (&mut state.flange.velocity, limits.output_speed),
            (&mut state.external_torque, limits.external_torque),
        ] {
            if !value.is_within(bound) {
                seldom();
                faults.raise_if(true, Faults::ESTIMATE_LIMITED);
                *value = value.limit(bound);
            }
        }
        let [share, least] = limits.stiffness_torque;
        state.stiffness_torque = state.stiffness_torque.limit(share * torques.transmitted.abs() + least);
        state.held_torque = state.held_torque.limit(limits.held_torque);
    }
}

/// The set of what is there.
#[inline(always)]
fn set<R>(sets: &GainSets<R>, output: bool, gauge: bool) -> &Gains<R> {
    match (output, gauge) {
        (false, false) => &sets[0],
        (true, false) => &sets[1],
        (false, true) => &sets[2],
        (true, true) => &sets[3],
    }
}

impl<R: Real> ObserverState<R> {
    /// Corrects by one sensor's innovation; adds to the `way` (rad) of both angles.
    #[inline(always)]
    fn correct(&mut self, way: &mut [R; 2], by: &Correction<R>, innovation: R, moved: bool) {
        way[0] += by[0] * innovation;
        self.wave_generator.velocity += by[1] * innovation;
        way[1] += by[2] * innovation;
        self.flange.velocity += by[3] * innovation;
        self.external_torque += by[4] * innovation;
        let last = if moved { &mut self.stiffness_torque } else { &mut self.held_torque };
        *last += by[5] * innovation;
    }
}
