//! Observer: the gear's own model, corrected by what the joint's sensors say.
//!
//! ```text
//! state   theta_wg, omega_wg, theta_fs, omega_fs, d (external torque on the flexspline),
//!         s (what tau_t is off the model's), b (what the motor's torque is off it)
//! predict omega_wg += T*(tau_mean + b - tau_res - (r + de/dtheta_wg)*s)/J_wg,    theta_wg += T*omega_wg
//!         omega_fs += T*(tau_t + s - tau_fric_out + d)/J_fs,                          theta_fs += T*omega_fs
//! correct state += l_m*(theta_m - theta_wg),  then l_t*(tau_s - tau_t - s),  then l_o*(theta_o - theta_fs)
//! ```
//!
//! Its period T is [`OBSERVED`] control periods. tau_mean is the motor's torque averaged over the last two of its
//! periods; tau_res = tau_wg - J_wg*domega_wg, tau_t and the frictions are those of [`by_turns`], the two-port in its
//! real-time build, at the motion before the prediction: the observer carries hysteresis, presliding and kinematic
//! error along. Angles are compared after the prediction, where they are at the time of the reading; the gauge with a
//! torque that is one period older. theta_m, theta_o are the encoders, tau_s a strain gauge; each of the last two may
//! be absent, at any step, and theta_o, which is looked at once a round, may come a constant number of control
//! periods late ([`past`]). What is kept is theta_wg - theta_m and theta_fs - r*theta_wg: both are small, so that an
//! f32 holds them, and neither drifts from a sum of roundings, for the motor's own angle is never summed up. The
//! gains l are those of the steady-state Kalman filter of the linearised model, one set for each combination of
//! sensors, computed off line. Units: rad, rad/s, N m.
//!
//! The gear is what is known of it ([`Known`]): model, factors and ripple as [`crate::compensator::learning`] has
//! learnt them. A gear that is stiffer or softer than is known by 10 % makes a torsion that is measured disagree with
//! the motor's torque by 10 %. Which to believe depends on the motor. Where it moves, its friction is known to a few
//! N m at the output and the rest is blamed on the stiffness: s. Where it stands, static friction or a brake may hold
//! whatever there is, so its torque says nothing and what is left over is blamed on b, while s keeps what it learnt.
//! It stands when its encoder has not left a few counts for [`STANDSTILL`] periods. With the motor encoder alone
//! neither is observable beside d, and both stay zero. s is limited to 3 deviations of the stiffness.
//!
//! A resting output may be anywhere within the count that its encoder shows: while the motor stands, an innovation
//! theta_o - theta_fs within +-q is none, and q is taken from a larger one.
//!
//! Discretisation: semi-implicit Euler, one step per period. It is the leapfrog method, whose speeds belong to the
//! middle of the periods: a torque that acts over one period is shared by the two speeds beside its beginning and its
//! end. Taken for the whole of one of them it would come half a period early, which an observer that knows its motor
//! well takes for a load: 29 N m where the torque swings by 100 N m at 130 Hz, both at the output.
//!
//! Bounds: speeds are limited to twice what the joint can do, the external torque to the gear's peak torque; a
//! torsion beyond that of four times the peak torque starts the observer again at the motor's angle. Both are
//! reported as faults, as is a torsion past the range of the gear's law ([`crate::flexspline::reduced::RANGE`]),
//! which goes on at its largest torque. The reported transmitted torque ends at those four times.
//!
//! H. Taghirad, P. Belanger, "Modeling and parameter identification of harmonic drive systems", Journal of Dynamic
//! Systems, Measurement, and Control 120 (1998) for the two masses; R. Kalman, "A new approach to linear filtering
//! and prediction problems", Journal of Basic Engineering 82 (1960).

pub mod by_turns;
pub mod deviation;
pub mod past;

use crate::angle::{Angle, Ratio};
use crate::compensator::faults::Faults;
use crate::compensator::turns::{OBSERVED, ROUND};
use crate::compensator::{Estimate, EstimateDeviation, Limits, RealTimeGear};
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::{RADIANS_PER_COUNT, Real, seldom};
pub use by_turns::Known;
use by_turns::{Ends, GearByTurns, Torques, Turns};
use deviation::{Magnitudes, Spread, SpreadState, Uncertainty};
use past::{LONGEST_DELAY, Past, STEPS};

/// Number of observed states: the sixth is s where the motor moves, b where it stands.
pub const STATES: usize = 6;

/// Periods of the observer without motion after which the motor stands: 20 ms.
pub const STANDSTILL: u32 = 200 / OBSERVED;

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
    pub past: [R; STEPS],
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
    /// Delay of a reading in control periods, and in own ones.
    late: usize,
    delay: usize,
    /// Readings may be of the past.
    looks_back: bool,
    ratio: Ratio,
    period: u32,
    output_count: R,
    uncertainty: Uncertainty<R>,
    limits: Range<R>,
    inverse_wave_generator_inertia: R,
    inverse_flexspline_inertia: R,
    turns: Turns<R>,
    dt: R,
}

/// What the observer believes. Both angles are relative, so that they are small and need no more than an f32.
#[derive(Clone, Debug)]
pub struct ObserverState<R: Real> {
    gear: GearByTurns<R>,
    /// theta_m of the last period.
    motor: Angle<R>,
    /// theta_wg - theta_m (rad) and omega_wg (rad/s).
    off: R,
    wave_generator_speed: R,
    /// theta_fs - r*theta_wg (rad) and omega_fs (rad/s).
    ahead: R,
    flange_speed: R,
    /// tau of the last period (N m).
    motor_torque: R,
    external_torque: R,
    /// s (N m).
    stiffness_torque: R,
    /// b (N m).
    held_torque: R,
    /// theta_o - theta_fs at the last reading (rad).
    output_innovation: R,
    standstill: Standstill,
    /// Own periods since a reading of the output encoder.
    since_output: u32,
    past: Past,
    spread: SpreadState<R>,
    deviation: EstimateDeviation<R>,
    /// What the deviations are to be made of, and by which sensors.
    magnitudes: Magnitudes<R>,
    seen: [bool; 2],
    started: bool,
}

/// Since when, and where, the motor has not moved.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Standstill {
    phase: u32,
    periods: u32,
}

impl Standstill {
    /// One more period at this phase; whether the motor moves.
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
    /// Control periods since that reading came; 0 for an observer that does not look back.
    pub age: u32,
    /// Torque of the motor (N m).
    pub motor_torque: R,
    /// Torque through the flexspline (N m).
    pub output_torque: Option<R>,
}

impl<R: Real> Gains<R> {
    /// With what corrects the flange's angle as what corrects by how much it is ahead of r*theta_wg.
    fn relative(mut self, ratio: R) -> Self {
        for by in [&mut self.motor, &mut self.torque, &mut self.output] {
            by[2] -= ratio * by[0];
        }
        self
    }
}

impl<R: Real> ObserverParams<R> {
    /// Prepares the observer of a gear for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `gains` unless all are finite, `stir` or `output_count` unless in 0..=1,
    /// `output_encoder_delay` beyond [`LONGEST_DELAY`], `output_encoder_period` unless in 1..=[`LONGEST_PERIOD`], or
    /// as [`Limits::check`] and the gear's parts.
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
        let dt = R::from_i32(OBSERVED as i32) * dt;
        let ratio = Ratio::one_over(gear.ratio)?;
        let wave_generator_inertia = gear.wave_generator_inertia;
        require(wave_generator_inertia > R::ZERO, "wave_generator_inertia")?;
        Ok(Observer {
            moving: self.moving.map(|gains| gains.relative(ratio.value())),
            standing: self.standing.map(|gains| gains.relative(ratio.value())),
            stir: (self.stir * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32().unsigned_abs(),
            late: delay,
            looks_back: delay > 0 || self.output_encoder_period > 1,
            ratio,
            delay: delay.div_ceil(OBSERVED as usize),
            period: self.output_encoder_period.div_ceil(ROUND) * (ROUND / OBSERVED),
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
            inverse_flexspline_inertia: R::ONE / gear.flexspline_inertia,
            turns: Turns::build(ratio.value(), dt),
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
    pub fn rest(&self) -> ObserverState<R> {
        ObserverState {
            gear: GearByTurns::default(),
            motor: Angle::default(),
            off: R::ZERO,
            wave_generator_speed: R::ZERO,
            ahead: R::ZERO,
            flange_speed: R::ZERO,
            motor_torque: R::ZERO,
            external_torque: R::ZERO,
            stiffness_torque: R::ZERO,
            held_torque: R::ZERO,
            output_innovation: R::ZERO,
            standstill: Standstill { phase: 0, periods: STANDSTILL },
            since_output: u32::MAX,
            past: Past::default(),
            spread: SpreadState::default(),
            deviation: EstimateDeviation::default(),
            magnitudes: Magnitudes::default(),
            seen: [false; 2],
            started: false,
        }
    }

    /// Where the output was, up to whole turns, at the instant of the reading that comes with the next step, for a
    /// motor that is at `motor` now, `age` control periods after it came; `None` where that was before the start.
    pub fn output_at_reading(
        &self,
        gear: &RealTimeGear<R>,
        state: &ObserverState<R>,
        motor: Angle<R>,
        age: u32,
    ) -> Option<Angle<R>> {
        let before = |periods| state.past.before(periods).map(|phase| Angle::from_counts(phase.into()));
        let late = self.late + age as usize;
        late.checked_sub(OBSERVED as usize).map_or(Some(gear.drive(motor)), before)
    }

    /// Measured less believed output angle at the last reading (rad), where there is one within its period.
    #[inline(always)]
    pub fn output_innovation(&self, state: &ObserverState<R>) -> Option<R> {
        (state.since_output < self.period).then_some(state.output_innovation)
    }

    /// The same where the motor moves.
    #[inline(always)]
    pub fn moving_output_innovation(&self, state: &ObserverState<R>) -> Option<R> {
        let told = state.since_output < self.period && state.magnitudes.moved;
        told.then_some(state.output_innovation)
    }

    /// Readings may be of the past: they are late, or do not come in every control period.
    #[inline(always)]
    pub fn looks_back(&self) -> bool {
        self.looks_back
    }

    /// Predicts over one period, and corrects by the measurement.
    #[inline(always)]
    pub fn step(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
        known: &Known<R>,
        faults: &mut Faults,
    ) {
        if !state.started {
            seldom();
            return self.first(gear, state, measured);
        }
        let (motor, off) = (state.motor, state.off);
        let ends = Ends {
            wave_generator: || beside(motor, off),
            wave_generator_speed: state.wave_generator_speed,
            ahead: state.ahead,
            flange_speed: state.flange_speed,
        };
        let torques = state.gear.torques(&self.turns, gear, &ends, known);
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
        let acceleration = self.predict(state, &torques, measured, known);
        let asked = self.correct(gains, state, measured, &torques, known, moved);
        self.keep_in_range(state, &torques, moved, faults);
        state.magnitudes = Magnitudes {
            asked: state.magnitudes.asked + asked,
            moved,
            input_friction: torques.input_friction,
            output_friction: torques.output_friction,
            transmitted: torques.transmitted + state.stiffness_torque,
            torsion: torques.torsion,
            torsion_rate: torques.torsion_rate,
            output_speed: state.flange_speed,
            acceleration,
        };
        state.seen = [output_seen, gauge];
    }

    /// What is believed.
    pub fn estimate(&self, state: &ObserverState<R>, known: &Known<R>) -> Estimate<R> {
        let Magnitudes { torsion, input_friction, output_friction, .. } = state.magnitudes;
        Estimate {
            output_position: self.output_position(state).plus(known.position),
            output_velocity: state.flange_speed,
            torsion,
            transmitted_torque: self.transmitted(state),
            input_friction,
            output_friction,
            external_torque: state.external_torque,
            deviation: state.deviation,
        }
    }

    /// theta_fs, of the model.
    #[inline(always)]
    fn output_position(&self, state: &ObserverState<R>) -> Angle<R> {
        self.ratio.apply(state.motor).plus(self.turns.ratio() * state.off + state.ahead)
    }

    /// By how much the output is ahead, ripple included, of r times a motor angle that is `ahead` of the measured one
    /// (rad), a time dt (s) after the last step.
    #[inline(always)]
    pub fn output_beside(&self, state: &ObserverState<R>, known: &Known<R>, ahead: R, dt: R) -> R {
        let ratio = self.turns.ratio();
        let now = state.ahead + dt * (state.flange_speed - ratio * state.wave_generator_speed);
        now + ratio * (state.off - ahead) + known.position
    }

    /// tau_t + s (N m).
    #[inline(always)]
    pub fn transmitted(&self, state: &ObserverState<R>) -> R {
        state.magnitudes.transmitted.limit(self.limits.transmitted)
    }

    /// The estimates' deviations after [`deviation::PERIODS`] more periods.
    #[inline(always)]
    pub fn deviate(&self, state: &mut ObserverState<R>) {
        let sets = if state.magnitudes.moved { &self.moving } else { &self.standing };
        let [output, gauge] = state.seen;
        let spread = &set(sets, output, gauge).spread;
        state.deviation = spread.step(&mut state.spread, &self.uncertainty, &state.magnitudes);
        state.magnitudes.asked = R::ZERO;
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
    fn first(&self, gear: &RealTimeGear<R>, state: &mut ObserverState<R>, measured: &Measurement<R>) {
        state.motor = measured.motor;
        state.off = R::ZERO;
        state.wave_generator_speed = R::ZERO;
        state.ahead = state.gear.start_at(gear, measured.motor);
        state.flange_speed = R::ZERO;
        state.motor_torque = measured.motor_torque;
        state.external_torque = R::ZERO;
        state.stiffness_torque = R::ZERO;
        state.held_torque = R::ZERO;
        state.past = Past::default();
        state.started = true;
        state.past.push(self.output_position(state).phase());
        let set = set(&self.standing, false, measured.output_torque.is_some());
        state.deviation = set.spread.base;
        state.magnitudes = Magnitudes::default();
    }

    /// Moves both speeds by one period; answers with the flange's acceleration (rad/s^2).
    #[inline(always)]
    fn predict(
        &self,
        state: &mut ObserverState<R>,
        torques: &Torques<R>,
        measured: &Measurement<R>,
        known: &Known<R>,
    ) -> R {
        let resisting = torques.input_friction
            + known.motor_torque
            + torques.slope * (torques.transmitted + state.stiffness_torque);
        let mean = R::lit(0.5) * (measured.motor_torque + state.motor_torque);
        state.motor_torque = measured.motor_torque;
        let motor = (mean + state.held_torque - resisting) * self.inverse_wave_generator_inertia;
        let load = state.external_torque + known.load + state.stiffness_torque;
        let flange = (torques.transmitted - torques.output_friction + load) * self.inverse_flexspline_inertia;
        state.wave_generator_speed += self.dt * motor;
        state.flange_speed += self.dt * flange;
        flange
    }

    /// Moves both angles by one period and corrects by each sensor in turn; answers with what they asked of d (N m).
    #[inline(always)]
    fn correct(
        &self,
        gains: &Gains<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
        torques: &Torques<R>,
        known: &Known<R>,
        moved: bool,
    ) -> R {
        let before = state.external_torque;
        let way = self.dt * state.wave_generator_speed;
        state.off += way - measured.motor.since(state.motor);
        state.ahead += self.dt * state.flange_speed - self.turns.ratio() * way;
        state.motor = measured.motor;
        state.correct(&gains.motor, -state.off, moved);
        if let Some(torque) = measured.output_torque {
            state.correct(&gains.torque, torque - torques.transmitted - state.stiffness_torque, moved);
        }
        if self.looks_back {
            state.past.push(self.output_position(state).phase());
        }
        if let Some(innovation) = self.output_innovates(state, measured, known) {
            state.output_innovation = innovation;
            let innovation =
                if moved { innovation } else { innovation - innovation.limit(self.output_count) };
            state.correct(&gains.output, innovation, moved);
            if self.looks_back {
                state.past.correct(self.delay, &gains.past, innovation);
            }
        }
        state.external_torque - before
    }

    /// theta_o less ripple less theta_fs at the instant of the reading (rad), where there is one.
    #[inline(always)]
    fn output_innovates(
        &self,
        state: &ObserverState<R>,
        measured: &Measurement<R>,
        known: &Known<R>,
    ) -> Option<R> {
        let angle = measured.output?;
        if !self.looks_back {
            let beside = angle.minus(self.ratio.apply(state.motor));
            return Some(beside - self.turns.ratio() * state.off - state.ahead - known.position);
        }
        seldom();
        let then = state.past.before(self.late + measured.age as usize)?;
        let counts = angle.phase().wrapping_sub(then).cast_signed();
        Some(R::from_i32(counts) * R::lit(RADIANS_PER_COUNT) - known.position)
    }

    #[inline(always)]
    fn keep_in_range(
        &self,
        state: &mut ObserverState<R>,
        torques: &Torques<R>,
        moved: bool,
        faults: &mut Faults,
    ) {
        let limits = &self.limits;
        for (value, bound) in [
            (&mut state.wave_generator_speed, limits.motor_speed),
            (&mut state.flange_speed, limits.output_speed),
            (&mut state.external_torque, limits.external_torque),
        ] {
            if !value.is_within(bound) {
                seldom();
                faults.raise_if(true, Faults::ESTIMATE_LIMITED);
                *value = value.limit(bound);
            }
        }
        if moved {
            let [share, least] = limits.stiffness_torque;
            state.stiffness_torque = state.stiffness_torque.limit(share * torques.transmitted.abs() + least);
            state.held_torque = R::ZERO;
        } else {
            state.held_torque = state.held_torque.limit(limits.held_torque);
        }
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
    /// omega_fs (rad/s).
    #[inline(always)]
    pub fn output_velocity(&self) -> R {
        self.flange_speed
    }

    /// Friction at the flexspline (N m).
    #[inline(always)]
    pub fn output_friction(&self) -> R {
        self.magnitudes.output_friction
    }

    /// phi (rad).
    #[inline(always)]
    pub fn torsion(&self) -> R {
        self.magnitudes.torsion
    }

    /// d (N m).
    #[inline(always)]
    pub fn external_torque(&self) -> R {
        self.external_torque
    }

    /// Corrects by one sensor's innovation.
    #[inline(always)]
    fn correct(&mut self, by: &Correction<R>, innovation: R, moved: bool) {
        self.off += by[0] * innovation;
        self.wave_generator_speed += by[1] * innovation;
        self.ahead += by[2] * innovation;
        self.flange_speed += by[3] * innovation;
        self.external_torque += by[4] * innovation;
        let last = if moved { &mut self.stiffness_torque } else { &mut self.held_torque };
        *last += by[5] * innovation;
    }
}

/// The angle that is so far (rad) beside another one, to a count.
#[inline(always)]
pub(super) fn beside<R: Real>(angle: Angle<R>, off: R) -> Angle<R> {
    let counts = (off * R::lit(1.0 / RADIANS_PER_COUNT)).to_i32();
    Angle::from_counts(angle.counts.wrapping_add(i64::from(counts)))
}
