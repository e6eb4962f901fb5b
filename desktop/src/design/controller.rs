//! The controller of the code, linear about a joint at rest or in slow motion.
//!
//! ```text
//! x(n+1) = A_k x(n) + B_k v(n),   [tau, d](n) = C_k x(n) + D_k v(n)       k = n mod 8: the slot
//! v = [theta_m, theta_o, tau_measured, tau_t, d_in]
//! ```
//!
//! [`Controller::step`] is the control step of [`strainwave::compensator`] slot by slot, statement by statement, without
//! what is not linear: limits, faults, ramps. A_k..D_k are read off it by unit vectors, so the multi-rate schedule is
//! exact. Setpoint zero; dead zones pass everything, or the disturbance path nothing; the gear's line is the slope of the
//! operating point; kinematic error, hysteresis, learnt factors and ripple are none; the observer's friction is viscous
//! where the motor moves, and a spring besides where it stands, updated in every second period of the observer.
//! An output encoder that is late or slow is taken as prompt. The disturbance path reads d_in in the place of the
//! observer's d where its loop is open. Units: rad, N m, s; signs as in [`strainwave::gear`].

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use strainwave::compensator::actuate::cascade::FeedbackParams;
use strainwave::compensator::estimate::disturbance::DisturbanceParams;
use strainwave::compensator::estimate::observer::{GainSets, Gains};
use strainwave::compensator::reference::measured_feedback::MeasuredFeedbackParams;
use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;
use strainwave::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use strainwave::compensator::tuned::{DRIVE_CORNER, MOTOR_LAG};
use strainwave::friction::ModelName;

use super::mode::Mode;
use super::parts::Parts;
use crate::io::gear_file::SensorSet;
use crate::io::gear_file::{Friction, GearFile};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// States.
pub const STATES: usize = 39;
/// Inputs of the controller: theta_m, theta_o, tau_measured, tau_t, d_in.
pub const INPUTS: usize = 5;
/// Slots of a round.
pub const SLOTS: usize = SLOW_PERIODS as usize;

/// Slot whose reading of the output encoder is used, one slot later.
const OUTPUT_SLOT: usize = 4;
/// (s)
const ROUND_TIME: f64 = SLOW_PERIODS as f64 * CONTROL_PERIOD;

// Places in the state.
const MOTOR: usize = 0;
const TORQUE: usize = 1;
const TORQUE_ERROR: usize = 2;
const IMPULSE: usize = 3;
const MOTOR_ERROR: usize = 4;
const REFERENCE_SPEED: usize = 5;
const WIND_SPEED: usize = 6;
const WIND_ACCELERATION: usize = 7;
const WIND_TORQUE: usize = 8;
const SPEED: usize = 9;
const INTEGRAL: usize = 10;
const SEEN_MOTOR: usize = 11;
const MOTOR_RESIDUAL: usize = 12;
const MOTOR_SPEED: usize = 13;
const FLANGE_ERROR: usize = 14;
const FLANGE_SPEED: usize = 15;
const LAST_TORQUE: usize = 16;
const LOAD: usize = 17;
const SIXTH: usize = 18;
const INNOVATION: usize = 19;
const DEFLECTION: [usize; 2] = [20, 21];
const FRICTION: [usize; 2] = [22, 23];
const TRANSMITTED: usize = 24;
const SLOW: usize = 25;
const MEAN: usize = 26;
const FAST: usize = 27;
const FAST_RATE: usize = 28;
const FAST_ACCELERATION: usize = 29;
const SHIFTED: usize = 30;
const FIRST_POLE: usize = 31;
const FILTERED: usize = 32;
const READING: usize = 33;
const MEASURED: usize = 34;
const ROUND_SUM: usize = 35;
const OUTPUT_ERROR: usize = 36;
const MEASURED_IMPULSE: usize = 37;
const MEASURED_SHIFT: usize = 38;

/// A linear controller at one operating point.
#[derive(Clone, Debug)]
pub struct Controller {
    ratio: f64,
    inertias: [f64; 2],
    stiffness: f64,
    damping: f64,
    viscous: [f64; 2],
    bristle: [f64; 2],
    observer: GainSets<f64>,
    sixth_moves: bool,
    stands: bool,
    /// The cascade's speed is the observer's.
    estimates_speed: bool,
    has_output: bool,
    has_gauge: bool,
    feedback: FeedbackParams<f64>,
    disturbance: DisturbanceParams<f64>,
    passes: f64,
    output_feedback: OutputFeedbackParams<f64>,
    /// b (s).
    estimated_damping: f64,
    /// P, and D (s), of the output encoder's angle, and omega_m (rad/s).
    measured_gains: [f64; 2],
    measured_corner: f64,
    reference_frequency: f64,
}

/// Stiffness of a side's friction about rest: sum of f_i*g0/eps_i, which is Fs*(1 + eta)/(eta*eps) of order 2.
pub fn bristle_stiffness(side: &Friction) -> f64 {
    let level = side.static_level.or(side.coulomb).unwrap_or_default();
    let distance = side.presliding.unwrap_or(f64::INFINITY);
    match side.model {
        ModelName::BlimanSorine2 => {
            let eta = side.presliding_ratio.unwrap_or(1.0);
            level * (1.0 + eta) / (eta * distance)
        }
        _ => level / distance,
    }
}

/// 1 - e^-x
fn fraction(x: f64) -> f64 {
    -(-x).exp_m1()
}

/// P and D of the output encoder's angle where the motor stands, at rest, or moves slowly.
fn measured_gains_in_mode(gains: &MeasuredFeedbackParams<f64>, stands: bool) -> [f64; 2] {
    if stands {
        [gains.proportional_at_rest, gains.derivative_at_rest]
    } else {
        [gains.proportional, gains.derivative]
    }
}

impl Controller {
    /// Of a gear at an operating point of this stiffness (N m/rad).
    pub fn new(
        file: &GearFile,
        parts: &Parts,
        set: SensorSet,
        mode: Mode,
        stiffness: f64,
        passes: bool,
    ) -> Self {
        let sides = [&file.friction.input, &file.friction.output];
        let (stands, has_output) = (mode != Mode::Moving, set == SensorSet::Both);
        let has_gauge = file.sensors.output_torque;
        let observer = if stands { parts.observer.standing } else { parts.observer.moving };
        let used = usize::from(has_output) + 2 * usize::from(has_gauge);
        let output_feedback = parts.output_feedback[usize::from(has_output)];
        let measured = &parts.measured_feedback;
        let count = TAU / f64::from(file.sensors.motor_encoder_bits).exp2();
        let moves =
            |gains: &Gains<f64>| [gains.motor, gains.torque, gains.output].iter().any(|l| l[5] != 0.0);
        Self {
            ratio: file.gear.signed_ratio().value(),
            inertias: [file.inertia.wave_generator, file.inertia.flexspline],
            stiffness,
            damping: 2.0
                * file.damping.torsion_mode_ratio
                * (file.stiffness.k1 * file.inertia.flexspline).sqrt(),
            viscous: sides.map(|side| side.viscous.unwrap_or_default()),
            bristle: sides.map(|side| if stands { bristle_stiffness(side) } else { 0.0 }),
            sixth_moves: moves(&observer[used]),
            observer,
            stands,
            estimates_speed: stands && parts.feedback.estimates_speed(count, CONTROL_PERIOD),
            has_output,
            has_gauge,
            feedback: parts.feedback,
            disturbance: parts.disturbance,
            passes: f64::from(u8::from(passes)),
            output_feedback,
            estimated_damping: if stands { output_feedback.damping_at_rest } else { output_feedback.damping },
            measured_gains: if has_output { measured_gains_in_mode(measured, stands) } else { [0.0; 2] },
            measured_corner: measured.corner,
            reference_frequency: (file.stiffness.k1 / file.inertia.flexspline).sqrt(),
        }
    }

    /// Sizes of the states, so that their numbers are of one size for an eigenvalue's sake.
    pub fn units(&self) -> [f64; STATES] {
        let (n, omega, torque) = (1.0 / self.ratio.abs(), self.reference_frequency, self.stiffness);
        let mut units = [1.0; STATES];
        let mut set = |places: &[usize], unit: f64| places.iter().for_each(|place| units[*place] = unit);
        set(&[MOTOR, MOTOR_ERROR, SEEN_MOTOR, MOTOR_RESIDUAL, DEFLECTION[0], MEASURED_SHIFT], n);
        set(&[REFERENCE_SPEED, WIND_SPEED, SPEED, MOTOR_SPEED], n * omega);
        set(&[WIND_ACCELERATION], n * omega * omega);
        set(&[TORQUE, TORQUE_ERROR, WIND_TORQUE, INTEGRAL, LAST_TORQUE, FRICTION[0]], torque / n);
        set(&[IMPULSE, MEASURED_IMPULSE], torque / n * 2.0 * CONTROL_PERIOD);
        set(&[FLANGE_SPEED], omega);
        set(&[LOAD, FRICTION[1], TRANSMITTED, SLOW, MEAN, FAST], torque);
        set(&[SIXTH], if self.stands { torque / n } else { torque });
        set(&[FAST_RATE], torque * omega);
        set(&[FAST_ACCELERATION], torque * omega * omega);
        units
    }

    /// One control period of `slot`: commanded torque and the observer's d. `open` where the disturbance path reads
    /// `v[4]` in the place of d.
    pub fn step(&self, slot: usize, x: &mut [f64], v: &[f64; INPUTS], open: bool) -> [f64; 2] {
        let dt = CONTROL_PERIOD;
        let [motor, output, measured, gauge, load] = *v;
        let moved = motor - x[MOTOR];
        x[MOTOR] = motor;
        x[IMPULSE] += dt * x[TORQUE];
        x[MEASURED_IMPULSE] += dt * measured;
        x[MOTOR_ERROR] += dt * (x[REFERENCE_SPEED] + x[WIND_SPEED]) - moved;
        if slot == OUTPUT_SLOT {
            x[READING] = output;
        } else if slot == OUTPUT_SLOT + 1 {
            self.integrate(x);
            if self.has_output {
                self.read_output(x);
            }
        }
        match slot {
            0 | 2 | 4 | 6 => self.observe(slot, x, motor, gauge, open.then_some(load)),
            1 => self.plan(x, motor),
            3 => self.learn(x, if open { load } else { x[LOAD] }),
            _ => {}
        }
        let speed = if self.estimates_speed { x[MOTOR_SPEED] } else { moved / dt };
        if slot % 2 == 1 {
            self.measure(x, output);
        }
        x[TORQUE] = self.drive(x, speed);
        [x[TORQUE], x[LOAD]]
    }

    /// The output encoder's reading of the observer's last step.
    fn read_output(&self, x: &mut [f64]) {
        let gains = &self.observer[1 + 2 * usize::from(self.has_gauge)];
        x[INNOVATION] = x[READING] - self.ratio * (x[SEEN_MOTOR] + x[MOTOR_RESIDUAL]) - x[FLANGE_ERROR];
        self.correct(x, &gains.output, x[INNOVATION]);
    }

    fn observe(&self, slot: usize, x: &mut [f64], motor: f64, gauge: f64, load: Option<f64>) {
        let (dt, r) = (f64::from(OBSERVER_PERIODS) * CONTROL_PERIOD, self.ratio);
        let [commanded, measured] = [IMPULSE, MEASURED_IMPULSE].map(|of| std::mem::take(&mut x[of]) / dt);
        x[TORQUE_ERROR] += fraction(dt * DRIVE_CORNER.get()) * (measured - commanded - x[TORQUE_ERROR]);
        let torque = commanded + x[TORQUE_ERROR];
        let torsion = -x[FLANGE_ERROR];
        let rate = r * x[MOTOR_SPEED] - x[FLANGE_SPEED];
        let transmitted = self.stiffness * torsion + self.damping * rate;
        // Kinematic error and hysteresis in the first and third, friction in the others.
        if slot % 4 == 2 {
            for (side, speed) in [x[MOTOR_SPEED], x[FLANGE_SPEED]].into_iter().enumerate() {
                let deflection = x[DEFLECTION[side]] + 2.0 * dt * speed;
                x[DEFLECTION[side]] = if self.bristle[side] > 0.0 { deflection } else { 0.0 };
                x[FRICTION[side]] = self.viscous[side] * speed + self.bristle[side] * x[DEFLECTION[side]];
            }
        }
        let (stiffness_torque, held) = if self.stands { (0.0, x[SIXTH]) } else { (x[SIXTH], 0.0) };
        let mean = 0.5 * (torque + x[LAST_TORQUE]);
        x[LAST_TORQUE] = torque;
        let resisting = x[FRICTION[0]] + r * (transmitted + stiffness_torque);
        x[MOTOR_SPEED] += dt * (mean + held - resisting) / self.inertias[0];
        x[FLANGE_SPEED] +=
            dt * (transmitted - x[FRICTION[1]] + x[LOAD] + stiffness_torque) / self.inertias[1];
        let way = dt * x[MOTOR_SPEED];
        x[MOTOR_RESIDUAL] += way - (motor - x[SEEN_MOTOR]);
        x[FLANGE_ERROR] += dt * x[FLANGE_SPEED] - r * way;
        x[SEEN_MOTOR] = motor;
        let reads = slot == OUTPUT_SLOT && self.has_output;
        let gains = &self.observer[usize::from(reads) + 2 * usize::from(self.has_gauge)];
        self.correct(x, &gains.motor, -x[MOTOR_RESIDUAL]);
        if self.has_gauge {
            let s = if self.stands { 0.0 } else { x[SIXTH] };
            self.correct(x, &gains.torque, gauge - transmitted - s);
        }
        if !self.has_output {
            x[INNOVATION] = 0.0;
        }
        x[TRANSMITTED] = transmitted + if self.stands { 0.0 } else { x[SIXTH] };
        self.step_fast(x, dt, load.unwrap_or(x[LOAD]));
    }

    fn correct(&self, x: &mut [f64], by: &[f64; 6], innovation: f64) {
        let by_place = [
            (MOTOR_RESIDUAL, by[0]),
            (MOTOR_SPEED, by[1]),
            (FLANGE_ERROR, by[2] - self.ratio * by[0]),
            (FLANGE_SPEED, by[3]),
            (LOAD, by[4]),
            (SIXTH, if self.sixth_moves { by[5] } else { 0.0 }),
        ];
        for (place, gain) in by_place {
            x[place] += gain * innovation;
        }
        if !self.sixth_moves {
            x[SIXTH] = 0.0;
        }
    }

    fn step_fast(&self, x: &mut [f64], dt: f64, load: f64) {
        let omega = self.disturbance.fast_corner.min(0.5 / dt);
        let target = self.passes * (load - x[MEAN]);
        x[FAST_ACCELERATION] = omega * (omega * (target - x[FAST]) - 2.0 * x[FAST_RATE]);
        x[FAST_RATE] += dt * x[FAST_ACCELERATION];
        x[FAST] += dt * x[FAST_RATE];
        if omega == 0.0 {
            (x[FAST], x[FAST_RATE]) = (0.0, 0.0);
        }
        let by_torque = self.disturbance.wind_up_fraction / (self.stiffness * self.ratio);
        x[WIND_SPEED] = -by_torque * x[FAST_RATE];
        x[WIND_ACCELERATION] = -by_torque * x[FAST_ACCELERATION];
        x[WIND_TORQUE] = self.inertias[0] * x[WIND_ACCELERATION] - self.ratio * x[FAST];
    }

    /// The slow disturbance estimate.
    fn learn(&self, x: &mut [f64], load: f64) {
        let slow_gain = fraction(ROUND_TIME * self.disturbance.slow_corner);
        x[MEAN] += slow_gain * (load - x[MEAN]);
        x[SLOW] += slow_gain * (self.passes * load - x[SLOW]);
    }

    fn plan(&self, x: &mut [f64], motor: f64) {
        let (dt, r) = (CONTROL_PERIOD, self.ratio);
        let compensated = x[SLOW] + self.disturbance.wind_up_fraction * x[FAST];
        let wound = -compensated / self.stiffness;
        let position =
            x[FLANGE_ERROR] + dt * (x[FLANGE_SPEED] - r * x[MOTOR_SPEED]) + r * x[MOTOR_RESIDUAL] + r * motor;
        let mean = f64::from(OBSERVER_PERIODS) * std::mem::take(&mut x[ROUND_SUM]) / SLOTS as f64;
        x[OUTPUT_ERROR] = if self.has_output { mean } else { position };
        let gains = &self.output_feedback;
        let whole = x[MEAN] + self.disturbance.wind_up_fraction * x[FAST];
        let torque = x[TRANSMITTED] - x[FRICTION[1]] + whole;
        let angle = self.estimated_damping * x[FLANGE_SPEED] + x[SHIFTED];
        let rate = self.estimated_damping * torque / self.inertias[1] + gains.integral * x[FILTERED];
        x[MOTOR_ERROR] = (wound - angle) / r - motor;
        x[REFERENCE_SPEED] = -rate / r;
    }

    /// The integral of the output's error, of which the motor at rest has a part yet to go.
    fn integrate(&self, x: &mut [f64]) {
        let gains = &self.output_feedback;
        let motor_lag = if self.stands { self.ratio * x[MOTOR_ERROR] } else { 0.0 };
        let missing = x[OUTPUT_ERROR] + MOTOR_LAG.get() * motor_lag;
        let filter = fraction(ROUND_TIME * gains.filter_corner);
        x[FIRST_POLE] += filter * (missing - x[FIRST_POLE]);
        x[FILTERED] += filter * (x[FIRST_POLE] - x[FILTERED]);
        let way = ROUND_TIME * gains.integral * x[FILTERED];
        x[SHIFTED] = if gains.integral > 0.0 { x[SHIFTED] + way } else { 0.0 };
    }

    /// Shift of the motor's reference by P and D of the output encoder's angle, in the periods without the observer.
    fn measure(&self, x: &mut [f64], output: f64) {
        let dt = f64::from(OBSERVER_PERIODS) * CONTROL_PERIOD;
        let [proportional, derivative] = self.measured_gains;
        let change = fraction(dt * self.measured_corner) * (output - x[MEASURED]);
        x[MEASURED] += change;
        x[ROUND_SUM] += output;
        x[MEASURED_SHIFT] = -(proportional * output + derivative / dt * change) / self.ratio;
    }

    fn drive(&self, x: &mut [f64], speed: f64) -> f64 {
        let dt = CONTROL_PERIOD;
        let FeedbackParams { position_gain, velocity_gain, integral_time, filter_corner, .. } = self.feedback;
        let filter = fraction(dt * filter_corner);
        x[SPEED] += filter * (speed - x[SPEED]);
        let late = dt * (1.0 / filter - 0.5) * x[WIND_ACCELERATION];
        let expected =
            position_gain * (x[MOTOR_ERROR] + x[MEASURED_SHIFT]) + x[REFERENCE_SPEED] + x[WIND_SPEED] - late;
        let lag = expected - x[SPEED];
        x[INTEGRAL] += velocity_gain * dt / integral_time * lag;
        velocity_gain * lag + x[INTEGRAL] + x[WIND_TORQUE]
    }

    /// [A B; C D] of each slot, states in their units.
    pub fn matrices(&self, open: bool) -> [DMatrix<f64>; SLOTS] {
        let units = self.units();
        std::array::from_fn(|slot| {
            let mut matrix = DMatrix::zeros(STATES + 2, STATES + INPUTS);
            for column in 0..STATES + INPUTS {
                let (mut x, mut v) = ([0.0; STATES], [0.0; INPUTS]);
                match column.checked_sub(STATES) {
                    None => x[column] = units[column],
                    Some(input) => v[input] = 1.0,
                }
                let out = self.step(slot, &mut x, &v, open);
                (0..STATES).for_each(|row| matrix[(row, column)] = x[row] / units[row]);
                (0..2).for_each(|row| matrix[(STATES + row, column)] = out[row]);
            }
            matrix
        })
    }
}
