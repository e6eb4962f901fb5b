//! Observer: the gear's own model, corrected by what the joint's sensors say.
//!
//! ```text
//! state   theta_wg, omega_wg, theta_fs, omega_fs, d (external torque on the flexspline)
//! predict omega_wg += dt*(tau_motor - tau_res)/J_wg,             theta_wg += dt*omega_wg
//!         omega_fs += dt*(tau_t - tau_fric_out + d)/J_fs,        theta_fs += dt*omega_fs
//! correct state += l_m*(theta_m - theta_wg) + l_o*(theta_o - theta_fs) + l_t*(tau_s - tau_t)
//! ```
//!
//! tau_res = tau_wg - J_wg*domega_wg, tau_t and the frictions come from [`crate::gear::Gear`], the two-port
//! in its real-time build, at the motion before the prediction: the observer carries hysteresis,
//! presliding and kinematic error along. Angles are compared after the prediction, where they are at the
//! time of the reading; the gauge with a torque that is one control period older. theta_m, theta_o
//! are the encoders, tau_s a strain gauge; each of the last two may be absent, at any step. The gains l are those of
//! the steady-state Kalman filter of the linearised model, one set for each combination of sensors,
//! computed off line. Units: rad, rad/s, N m.
//!
//! Discretisation: semi-implicit Euler, one step per control period.
//!
//! Bounds: speeds are limited to twice what the joint can do, the external torque to the gear's peak
//! torque; a torsion beyond that of four times the peak torque starts the observer again at the motor's
//! angle. Both are reported as faults, as is a torsion past the range of the gear's law
//! ([`crate::flexspline::reduced::RANGE`]), which goes on at its largest torque. The reported torsion and transmitted torque end at those four times.
//!
//! H. Taghirad, P. Belanger, "Modeling and parameter identification of harmonic drive systems", Journal of
//! Dynamic Systems, Measurement, and Control 120 (1998) for the two masses; R. Kalman, "A new approach to
//! linear filtering and prediction problems", Journal of Basic Engineering 82 (1960).

use crate::angle::Angle;
use crate::compensator::faults::Faults;
use crate::compensator::{Estimate, HYSTERESIS_MEMORY, Limits, RealTimeGear};
use crate::error::{Error, require};
use crate::friction::JointFrictionState;
use crate::gear::{Applied, GearParams, GearState, Motion, Torques};
use crate::real::Real;

/// Number of observed states.
pub const STATES: usize = 5;

/// Correction of each state [theta_wg, omega_wg, theta_fs, omega_fs, d] per unit of a sensor's innovation.
pub type Correction<R> = [R; STATES];

/// Gains for one combination of sensors; those of an absent sensor are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains<R> {
    /// l_m, per rad of the motor encoder.
    pub motor: Correction<R>,
    /// l_o, per rad of the output encoder.
    pub output: Correction<R>,
    /// l_t, per N m of the strain gauge.
    pub torque: Correction<R>,
}

/// Parameters of the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverParams<R> {
    /// Gains without further sensors, with output encoder, with strain gauge, with both.
    pub gains: [Gains<R>; 4],
}

/// The built observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer<R> {
    gains: [Gains<R>; 4],
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
    external_torque: R,
    started: bool,
}

/// What the sensors say in this step, already checked.
#[derive(Clone, Copy, Debug)]
pub struct Measurement<R> {
    /// Unbounded angle of the motor.
    pub motor: Angle<R>,
    /// Unbounded angle of the output.
    pub output: Option<Angle<R>>,
    /// Torque of the motor (N m).
    pub motor_torque: R,
    /// Torque through the flexspline (N m).
    pub output_torque: Option<R>,
}

impl<R: Real> ObserverParams<R> {
    /// Prepares the observer of a gear for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `gains` unless all are finite, or as [`Limits::check`] and the gear's parts.
    pub fn build(&self, gear: &GearParams<R>, limits: &Limits<R>, dt: R) -> Result<Observer<R>, Error> {
        let mut gains = self.gains.iter().flat_map(|g| g.motor.iter().chain(&g.output).chain(&g.torque));
        require(gains.all(|gain| gain.is_finite()), "gains")?;
        limits.check()?;
        let wave_generator_inertia = gear.wave_generator_inertia;
        require(wave_generator_inertia > R::ZERO, "wave_generator_inertia")?;
        Ok(Observer {
            gains: self.gains,
            limits: Range {
                motor_speed: R::lit(2.0) * limits.motor_speed,
                output_speed: R::lit(2.0) * limits.output_speed(gear.ratio),
                external_torque: limits.output_torque,
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
            external_torque: R::ZERO,
            started: false,
        }
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
            self.start(gear, state, measured);
        }
        let applied = Applied { motor: measured.motor_torque, load: state.external_torque };
        let torques = gear.torques(&mut state.gear, &state.wave_generator, &state.flange, applied);
        faults.raise_if(torques.saturated, Faults::TORSION_BEYOND_RANGE);
        self.predict(gear, state, &torques, measured.motor_torque);
        self.correct(state, measured, &torques);
        self.keep_in_range(gear, state, measured, &torques, faults);
        Estimate {
            output_position: state.flange.angle,
            output_velocity: state.flange.velocity,
            torsion: torques.torsion.limit(self.limits.torsion),
            transmitted_torque: torques.transmitted.limit(self.limits.transmitted),
            input_friction: torques.input_friction,
            output_friction: torques.output_friction,
            external_torque: state.external_torque,
        }
    }

    /// Starts at rest at the motor's angle, without torsion.
    fn start(&self, gear: &RealTimeGear<R>, state: &mut ObserverState<R>, measured: &Measurement<R>) {
        state.wave_generator = Motion { angle: measured.motor, velocity: R::ZERO };
        state.flange = Motion { angle: gear.drive(measured.motor), velocity: R::ZERO };
        state.external_torque = R::ZERO;
        state.started = true;
    }

    fn predict(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        torques: &Torques<R>,
        motor_torque: R,
    ) {
        let motor = (motor_torque - torques.wave_generator) * self.inverse_wave_generator_inertia;
        let flange = gear.flange_acceleration(torques, state.external_torque);
        state.wave_generator.advance(motor, self.dt);
        state.flange.advance(flange, self.dt);
    }

    fn correct(&self, state: &mut ObserverState<R>, measured: &Measurement<R>, torques: &Torques<R>) {
        let gains = match (measured.output.is_some(), measured.output_torque.is_some()) {
            (false, false) => &self.gains[0],
            (true, false) => &self.gains[1],
            (false, true) => &self.gains[2],
            (true, true) => &self.gains[3],
        };
        let motor = measured.motor.minus(state.wave_generator.angle);
        let output = measured.output.map_or(R::ZERO, |angle| angle.minus(state.flange.angle));
        let torque = measured.output_torque.map_or(R::ZERO, |torque| torque - torques.transmitted);
        let by = |k: usize| gains.motor[k] * motor + gains.output[k] * output + gains.torque[k] * torque;
        state.wave_generator.angle = state.wave_generator.angle.plus(by(0));
        state.wave_generator.velocity += by(1);
        state.flange.angle = state.flange.angle.plus(by(2));
        state.flange.velocity += by(3);
        state.external_torque += by(4);
    }

    fn keep_in_range(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut ObserverState<R>,
        measured: &Measurement<R>,
        torques: &Torques<R>,
        faults: &mut Faults,
    ) {
        let limits = &self.limits;
        for (value, bound) in [
            (&mut state.wave_generator.velocity, limits.motor_speed),
            (&mut state.flange.velocity, limits.output_speed),
            (&mut state.external_torque, limits.external_torque),
        ] {
            let limited = value.limit(bound);
            faults.raise_if(limited != *value, Faults::ESTIMATE_LIMITED);
            *value = limited;
        }
        let lost = !torques.torsion.is_finite() || torques.torsion.abs() > limits.torsion;
        faults.raise_if(lost, Faults::OBSERVER_RESET);
        if lost {
            self.start(gear, state, measured);
        }
    }
}
