//! Feed-forward: angle and torque of the motor for the output to follow its setpoint.
//!
//! ```text
//! J = f_J*J_fs,  tau_fric = f*friction of the gear's model along the setpoint       f: learnt factors
//! tau_t     = s_i*J*ddq + tau_fric_out - d_ff                 torque through the flexspline
//! phi       = c*(phi_m + w/(1 + h*w)*(tau_t - line(phi_m) - tau_m))         wind-up for it
//! theta_ref = (q + s_w*phi - s_e*e(theta_ref) - ripple) / r    motor reference
//! tau_ff    = J_wg*ddtheta_ref + s_f*tau_fric_in + (r + s_e*de/dtheta)*(J*(ddq + dt/2*dddq) + s_f*tau_fric_out)
//! dtheta_ref  = (dq + s_w*c*w/(1 + h*w)*(J*dddq + dtau_fric_out/dt) - s_e*de/dt) / r
//! ddtheta_ref = (ddq + dt/2*dddq + s_w*c*w/(1 + h*w)*J*ddddq - s_e*dde/dt^2) / r
//! ```
//!
//! q is the setpoint of the output with its derivatives, d_ff the compensated external torque, phi_m the model's torsion
//! in the adaptation's last slot, w the line's compliance there, c its factor, tau_m over c the hysteresis torque, h its slope,
//! and s the gains (0..=1) of inertia, friction, wind-up and kinematic error. Units: rad,
//! N m; signs as in [`crate::gear`]. Evaluated once per round T of [`crate::compensator::schedule`], for the setpoint of
//! that instant; the torque, which is held over each control period dt, for the middle of the first one. Until the next
//! setpoint the motor reference is extrapolated by the returned acceleration, jerk and torque rate. [`PLAN_TO_LEARN`]
//! periods later is the slot of line and hysteresis ([`FeedForward::step_torsion`]), for the torsion extrapolated to that
//! instant by its rate, and [`PLAN_TO_MODELS`] periods later that of kinematic error and the friction of either side
//! ([`FeedForward::step_models`]), for the setpoint extrapolated by its acceleration. The kinematic error is extrapolated
//! by its slope, and the slope by its rate, until the next setpoint. Rates of friction and slope are their differences
//! over T.
//!
//! The flexible joint is flat: motor angle and torque follow from the output's trajectory without solving a
//! differential equation: the motor's speed contains the setpoint's jerk, its acceleration the snap. Friction is the
//! gear's own model driven along the setpoint, so that it includes presliding at a reversal, and the rate of the
//! wind-up for it: without that the cascade lags by the change of the friction, and the lag remains at the end of a move.
//!
//! At rest the setpoint covers no path and the model's friction is held, up to the static level. A joint of 20 % less
//! friction would be driven by 80 % of that: once it slides, its friction is less than its static level. At rest the
//! friction torque is therefore faded out: s_f stands for s_f*w,
//!
//! ```text
//! w <- w + min(4*ds/eps, 1)*(1 - w) - T/T_f*w         ds: path of the motor over T, eps: its presliding, T_f = 0.5 s
//! ```
//!
//! which reaches 1 after a quarter of the presliding, drops by a few percent at a reversal, and tends to 0 at rest: the
//! torque decreases monotonically there, so that it does not hunt. At a motor speed of eps/(4*T_f) w is a half.
//!
//! Torsion, kinematic error and the friction's load are implicit equations. Line and hysteresis are solved by one Newton step
//! a round: h is the slope of the branch that the torsion is on where it goes on in its direction, and the steepest of all
//! branches where it reverses or has stood. So h is never less than the slope that the torsion meets on a new branch, and
//! the steps of a torsion that reverses approach the solution from one side, for a loop of any width: with the hysteresis
//! torque of the round before in the place of its slope they alternate around it, and from 0.4 of the line's stiffness on
//! they grow. The others are solved by one fixed-point step: e and the friction's ripple follow the motor reference of [`MODELS_TO_PLAN`] periods before (contraction:
//! N*de/dtheta, below 0.03 for the default gear), and the friction's load is the tau_t of the setpoint before
//! (contraction: the load's factor).
//!
//! Behind the kinematic error a motor accelerates by dtheta_wg^2*e''/r, at the top speed of a gear of the ratio 160 with more than all of its
//! torque, for a vibration that the load hardly follows there. Where it may take more than 1/sqrt(3) of the peak torque tau_max, e stands for a
//! part of it. As much is no limit cycle ([`crate::compensator::actuate::supervisor`]): a sine of that amplitude is below its level.
//!
//! ```text
//! e <- min(v^2/dtheta_wg^2, 1)*e,   v^2 = tau_max/sqrt(3) * abs(r)/(J_wg*c),   c: sum of A_k*k^2, the largest abs(e'')
//! ```
//!
//! d_ff is the estimated external torque as filtered by [`crate::compensator::estimate::disturbance`].
//!
//! Behind a tooth belt of the compliance c ([`crate::belt::series`]) theta_ref is the angle of the belt's input. It is ahead of the wave generator by
//! the stretch s, and the compliances of the rates have the belt's:
//!
//! ```text
//! theta_ref = (q + ... + s_w*r*s(r*tau_t + w*tau_fric_in))/r,   c*w/(1 + h*w) + r^2*c in the place of c*w/(1 + h*w)
//! ```
//!
//! M. Fliess, J. Levine, P. Martin, P. Rouchon, "Flatness and defect of non-linear systems", International Journal of
//! Control 61 (1995); A. De Luca, "Feedforward/feedback laws for the control of flexible robots", IEEE International
//! Conference on Robotics and Automation (2000).

use crate::angle::{Angle, Heading, Ratio};
use crate::belt::SeriesBelt;
use crate::branch::seldom;
use crate::compensator::adapt::parameters::{Excitation, Factors};
use crate::compensator::schedule::{MODELS_TO_PLAN, PLAN_TO_LEARN, PLAN_TO_MODELS, SLOW_PERIODS};
use crate::compensator::tuned::{FADING_TIME, LIMIT_TO_LIMIT};
use crate::compensator::{CompensationGains, HYSTERESIS_MEMORY, RealTimeGear, Setpoint};
use crate::constants::constants;
use crate::error::{Error, require};
use crate::friction::{FrictionModel, JointFrictionState, Slip, StepTime};
use crate::gear::{GearParams, Motion};
use crate::hysteresis::torsion::{HysteresisTorque, TorsionHysteresisState};
use crate::kinematic_error::ErrorAndSlope;
use crate::real::Real;

/// Least h*w: where line and hysteresis together are less than half as stiff as the line, the Newton step is shortened.
const LEAST_SLOPE: f64 = -0.5;

/// Faster than any motor (rad/s).
const FASTEST_MOTOR: f64 = 1e6;

/// The built feed-forward.
///
/// At rest under a load of 20 N m the motor is sent ahead by the wind-up that carries it; accelerating the output takes
/// the inertia of the load over the ratio, and that of the rotor:
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::Angle;
/// use strainwave::compensator::adapt::parameters::Factors;
/// use strainwave::compensator::reference::feed_forward::{FeedForward, FeedForwardState, ModelCorrection};
/// use strainwave::compensator::{CompensationGains, RealTimeFlexspline, RealTimeGear, Setpoint};
///
/// let params = JOINT.gear;
/// let flexspline = RealTimeFlexspline::build(&params.flexspline, params.rated_torque)?;
/// let gear: RealTimeGear<f32> = params.build(flexspline, JOINT.dt)?;
/// let feed_forward = FeedForward::build(&params, JOINT.dt)?;
/// let gains = CompensationGains { kinematic_error: 0.0, ..CompensationGains::ALL };
/// let mut state = FeedForwardState::default();
/// let correction = ModelCorrection { load: -20.0, ..ModelCorrection::default() };
/// let mut loaded = feed_forward.step(&gear, &mut state, &Setpoint::default(), &gains, &correction);
/// for _ in 0..5 {
///     feed_forward.step_torsion(&gear, &mut state, &Factors::default());
///     feed_forward.step_models(&gear, &mut state, loaded.motor.angle, &Factors::default());
///     loaded = feed_forward.step(&gear, &mut state, &Setpoint::default(), &gains, &correction);
/// }
/// // The line alone, of which the hysteresis takes a part (rad at the output).
/// let alone = flexspline.torsion(20.0);
/// assert!((0.8 * alone..alone).contains(&loaded.link_offset));
/// assert!((loaded.motor.angle.minus(Angle::default()) + 100.0 * loaded.link_offset).abs() < 1e-6);
///
/// let setpoint = Setpoint { acceleration: 10.0, ..Setpoint::default() };
/// let (mut state, correction) = (FeedForwardState::default(), ModelCorrection::default());
/// let accelerating = feed_forward.step(&gear, &mut state, &setpoint, &gains, &correction);
/// let expected = -params.flexspline_inertia * 10.0 / 100.0 - params.wave_generator_inertia * 100.0 * 10.0;
/// assert!((accelerating.torque - expected).abs() < 1e-4, "{} N m", accelerating.torque);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedForward<R> {
    wave_generator_inertia: R,
    flexspline_inertia: R,
    ratio: R,
    inverse_ratio: R,
    /// T.
    round: StepTime<R>,
    /// From a setpoint to the adaptation's slot, and to that of the models (s).
    to_learn: R,
    to_models: R,
    /// From the models' slot to the next setpoint (s).
    to_plan: R,
    /// 4/eps.
    engagement: R,
    /// Path after a reversal on which the presliding ends (rad).
    presliding_path: R,
    /// T/T_f.
    fading: R,
    /// 1/T (1/s).
    inverse_round: R,
    /// Square of the motor's speed from which on the kinematic error is compensated in part (rad^2/s^2).
    kinematic_speed_squared: R,
    belt: SeriesBelt<R>,
    /// r^2*c (rad/(N m)).
    belt_compliance: R,
}

/// State of the feed-forward.
#[derive(Clone, Debug, Default)]
pub struct FeedForwardState<R: Real> {
    input_friction: JointFrictionState<R>,
    output_friction: JointFrictionState<R>,
    hysteresis: TorsionHysteresisState<R, HYSTERESIS_MEMORY>,
    /// line(phi_m) + tau_m (N m), phi_m (rad), and its change in a round.
    balance: R,
    torsion: R,
    torsion_change: R,
    /// w, and w/(1 + h*w) for a torsion that goes on and one that reverses (rad/(N m)).
    line_compliance: R,
    compliances: [R; 2],
    /// tau_fric_out in the models' last slot (N m), and its rate.
    friction: R,
    friction_rate: R,
    /// e and de/dtheta of the last slot, as far as they are compensated, extrapolated since.
    kinematic_error: ErrorAndSlope<R>,
    /// de/dtheta in the last slot, and its rate (1/s).
    slope: R,
    slope_rate: R,
    heading: Heading<R>,
    /// tau_t of the last setpoint (N m).
    transmitted: R,
    /// The model's torsion for the torque at the adaptation's slot (rad), and the output's speed at the models' (rad/s).
    nominal: R,
    velocity: R,
    /// w.
    engaged: R,
    /// s: path of the motor since its last reversal (rad), with its sign.
    path: R,
    /// s*dF/ds of its friction (N m).
    stiffened: R,
}

/// Learnt correction of the joint's model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelCorrection<R: Real> {
    /// Factors on the nominal gear.
    pub factors: Factors<R>,
    /// Compensated external torque (N m).
    pub load: R,
    /// Learnt ripple of the output's position at the reference (rad).
    pub ripple: R,
    /// Learnt torque of the motor there, added to the model's (N m).
    pub torque: R,
}

/// Demand of the feed-forward on the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand<R> {
    /// Angle and speed of the motor's reference.
    pub motor: Motion<R>,
    /// Its acceleration (rad/s^2).
    pub acceleration: R,
    /// Its jerk (rad/s^3).
    pub jerk: R,
    /// r times the motor's reference less the output's setpoint (rad).
    pub link_offset: R,
    /// Torque at the motor shaft (N m).
    pub torque: R,
    /// Rate of the torque (N m/s).
    pub torque_rate: R,
    /// r + s_e*de/dtheta there: motor torque for each N m at the output.
    pub transmission: R,
    /// Compliance of the gear's line times the wind-up gain (rad/(N m)).
    pub wind_up_compliance: R,
    /// J*ddq that the gear is wound up for (N m).
    pub accelerating: R,
    /// Its rate (N m/s).
    pub accelerating_rate: R,
    /// Its regressors for the adaptation, from the nominal gear.
    pub excitation: Excitation<R>,
}

impl<R: Real> FeedForward<R> {
    /// The feed-forward of a gear for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `ratio`, `dt` unless above 0 and up to 1, or the name of the inertia that is not finite
    /// and positive.
    pub fn build(gear: &GearParams<R>, dt: R) -> Result<Self, Error> {
        require(dt > R::ZERO && dt <= R::ONE, "dt")?;
        require(gear.wave_generator_inertia.is_positive(), "wave_generator_inertia")?;
        require(gear.flexspline_inertia.is_positive(), "flexspline_inertia")?;
        let (ratio, round) = (Ratio::one_over(gear.ratio)?, R::from_i32(SLOW_PERIODS as i32) * dt);
        Ok(Self {
            wave_generator_inertia: gear.wave_generator_inertia,
            flexspline_inertia: gear.flexspline_inertia,
            ratio: ratio.value(),
            inverse_ratio: R::from_i32(ratio.n()),
            round: StepTime::new(round),
            to_learn: R::from_i32(PLAN_TO_LEARN as i32) * dt,
            to_models: R::from_i32(PLAN_TO_MODELS as i32) * dt,
            to_plan: R::from_i32(MODELS_TO_PLAN as i32) * dt,
            presliding_path: R::lit(4.0) * gear.input_friction.presliding,
            engagement: R::lit(4.0) / gear.input_friction.presliding,
            fading: (round / R::lit(FADING_TIME.get())).min(R::ONE),
            inverse_round: R::ONE / round,
            kinematic_speed_squared: R::lit(FASTEST_MOTOR * FASTEST_MOTOR),
            belt: SeriesBelt::NONE,
            belt_compliance: R::ZERO,
        })
    }

    /// The same of a gear behind a belt.
    #[must_use]
    pub fn behind(self, belt: SeriesBelt<R>) -> Self {
        Self { belt, belt_compliance: self.ratio * self.ratio * belt.compliance(), ..self }
    }

    /// The same with a motor of this peak torque (N m).
    #[must_use]
    pub fn with_motor(self, gear: &GearParams<R>, peak_torque: R) -> Self {
        let curvature = gear.kinematic_error.curvature(self.ratio) * self.inverse_ratio.abs();
        let (inertia, most) =
            (gear.wave_generator_inertia * curvature, R::lit(FASTEST_MOTOR * FASTEST_MOTOR));
        let torque = R::lit(LIMIT_TO_LIMIT) * peak_torque;
        let squared = if inertia > R::ZERO { (torque / inertia).min(most) } else { most };
        Self { kinematic_speed_squared: squared, ..self }
    }

    /// Evaluates the part of the kinematic error that is compensated at this speed.
    #[inline(always)]
    fn step_kinematic_error(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut FeedForwardState<R>,
        reference: Angle<R>,
    ) {
        state.kinematic_error = gear.kinematic_error(reference, state.heading);
        let velocity = state.velocity * self.inverse_ratio;
        let squared = velocity * velocity;
        if squared > self.kinematic_speed_squared {
            seldom();
            let part = self.kinematic_speed_squared / squared;
            state.kinematic_error.error *= part;
            state.kinematic_error.slope *= part;
        }
        state.slope_rate = (state.kinematic_error.slope - state.slope) * self.inverse_round;
        state.slope = state.kinematic_error.slope;
    }

    /// Advances the friction of both sides, and w with that of the motor.
    #[inline(always)]
    fn step_friction(&self, gear: &RealTimeGear<R>, state: &mut FeedForwardState<R>) {
        let (heading, output) = (state.heading, state.velocity);
        let slip = |velocity, load| Slip {
            wave_generator: heading,
            ..Slip::over(velocity, self.round).under(R::ZERO, load)
        };
        let (on_input, on_output) = gear.frictions();
        let before = on_input.presliding(&state.input_friction);
        on_output.step(&mut state.output_friction, &slip(output, state.transmitted));
        let slip = slip(output * self.inverse_ratio, self.ratio * state.transmitted);
        state.engaged = state.engaged - self.fading * state.engaged;
        state.engaged += (slip.displacement().abs() * self.engagement).min(R::ONE) * (R::ONE - state.engaged);
        on_input.step(&mut state.input_friction, &slip);
        let change = on_input.presliding(&state.input_friction) - before;
        state.stiffened = self.steps_since_reversal(state, slip.displacement()) * change;
    }

    /// s/ds after another `step` ds of the motor (rad); 0 at rest and beyond the presliding path.
    #[inline(always)]
    fn steps_since_reversal(&self, state: &mut FeedForwardState<R>, step: R) -> R {
        let path = if state.path * step < R::ZERO { step } else { state.path + step };
        state.path = path.limit(self.presliding_path);
        if step == R::ZERO || state.path != path { R::ZERO } else { path / step }
    }

    /// Advances line and hysteresis in the adaptation's slot to the torsion of the last setpoint, for the next Newton step.
    #[inline(always)]
    pub fn step_torsion(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut FeedForwardState<R>,
        factors: &Factors<R>,
    ) {
        let scale = R::ONE + factors.stiffening();
        let HysteresisTorque { torque, slope } = gear.hysteresis().step(&mut state.hysteresis, state.nominal);
        let on_line = gear.flexspline().torque(state.nominal, R::ZERO);
        let compliance = gear.flexspline().compliance(on_line);
        let with_hysteresis =
            |slope: R| compliance / (R::ONE + (scale * slope * compliance).max(R::lit(LEAST_SLOPE)));
        state.line_compliance = compliance;
        if self.belt.stretches() {
            state.line_compliance += self.belt_compliance;
        }
        state.compliances = [slope, gear.hysteresis().greatest_slope()].map(with_hysteresis);
        state.balance = on_line + scale * torque;
        state.torsion_change = state.nominal - state.torsion;
        state.torsion = state.nominal;
    }

    /// Advances the models in their slot, with the motor's reference at `reference` now.
    #[inline(always)]
    pub fn step_models(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut FeedForwardState<R>,
        reference: Angle<R>,
        factors: &Factors<R>,
    ) {
        state.heading = reference.heading();
        self.step_kinematic_error(gear, state, reference);
        self.step_friction(gear, state);
        let (_, output) = gear.frictions();
        let friction = factors.output_friction * output.force(&state.output_friction);
        state.friction_rate = (friction - state.friction) * self.inverse_round;
        state.friction = friction;
    }

    /// w*(F_2 - F_1) and w*s*dF/ds of the wave generator's friction (N m), 0 at rest.
    #[inline(always)]
    pub fn presliding(&self, gear: &RealTimeGear<R>, state: &FeedForwardState<R>) -> [R; 2] {
        let (input, _) = gear.frictions();
        let engaged = if state.velocity == R::ZERO { R::ZERO } else { state.engaged };
        [engaged * input.shaped(&state.input_friction), engaged * state.stiffened]
    }

    /// Sets the learnt shape and stiffness of the presliding of either side.
    #[inline(always)]
    pub fn shape(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut FeedForwardState<R>,
        order_two: R,
        stiffening: R,
    ) {
        let (input, output) = gear.frictions();
        input.shape(&mut state.input_friction, order_two, stiffening);
        output.shape(&mut state.output_friction, order_two, stiffening);
    }

    /// The nominal gear's torsion for tau_t (rad), and the compliance of its line and hysteresis (rad/(N m)).
    #[inline(always)]
    fn torsion(state: &FeedForwardState<R>) -> (R, R) {
        let change = state.transmitted - state.balance;
        let [going_on, reversing] = state.compliances;
        let compliance = if change * state.torsion_change > R::ZERO { going_on } else { reversing };
        (state.torsion + compliance * change, compliance)
    }

    /// Demand for a setpoint, with the learnt `correction` of the model.
    #[inline(always)]
    pub fn step(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut FeedForwardState<R>,
        setpoint: &Setpoint<R>,
        gains: &CompensationGains<R>,
        correction: &ModelCorrection<R>,
    ) -> Demand<R> {
        let ModelCorrection { factors, load, ripple, torque } = *correction;
        let inertia = self.flexspline_inertia * factors.inertia * gains.inertia;
        let motor_velocity = setpoint.velocity * self.inverse_ratio;
        state.velocity = setpoint.velocity + self.to_models * setpoint.acceleration;
        let (input, output) = gear.frictions();
        let input_friction = input.force(&state.input_friction);
        let output_friction = output.force(&state.output_friction);
        let on_output = factors.output_friction * output_friction;

        let (accelerating, accelerating_rate) = (inertia * setpoint.acceleration, inertia * setpoint.jerk);
        state.transmitted = accelerating + on_output - load;
        let (nominal, compliance) = Self::torsion(state);
        let wind_up_gain = gains.wind_up * factors.compliance;
        let mut wind_up_compliance = wind_up_gain * compliance;
        let mut belt_offset = R::ZERO;
        if self.belt.stretches() {
            let friction = state.engaged * factors.input_friction * input_friction;
            let stretch = self.belt.stretch(self.ratio * state.transmitted + friction);
            belt_offset = gains.wind_up * self.ratio * stretch;
            wind_up_compliance += gains.wind_up * self.belt_compliance;
        }
        let transmitted_rate = accelerating_rate + state.friction_rate;
        state.nominal = nominal + self.to_learn * compliance * transmitted_rate;

        let moved = self.to_plan * motor_velocity;
        state.kinematic_error.error += state.kinematic_error.slope * moved;
        state.kinematic_error.slope += self.to_plan * state.slope_rate;
        let kinematic_error = state.kinematic_error;
        let link_offset =
            wind_up_gain * nominal + belt_offset - gains.kinematic_error * kinematic_error.error - ripple;
        let link_offset_rate = wind_up_compliance * transmitted_rate
            - gains.kinematic_error * kinematic_error.slope * motor_velocity;
        let reference = gear.ratio().to_motor(setpoint.position.plus(link_offset));

        let half_step = R::lit(0.5 / SLOW_PERIODS as f64) * self.round.seconds();
        let acceleration = setpoint.acceleration + half_step * setpoint.jerk;
        let slope_term = state.slope_rate * motor_velocity
            + kinematic_error.slope * self.inverse_ratio * setpoint.acceleration;
        let link_offset_acceleration =
            wind_up_compliance * inertia * setpoint.snap - gains.kinematic_error * slope_term;
        let motor_acceleration = (acceleration + link_offset_acceleration) * self.inverse_ratio;
        let engaged = state.engaged;
        let friction_gain = gains.friction * engaged;
        let transmission = self.ratio + gains.kinematic_error * kinematic_error.slope;
        let moving = if setpoint.velocity == R::ZERO { R::ZERO } else { engaged };
        Demand {
            motor: Motion {
                angle: reference,
                velocity: (setpoint.velocity + link_offset_rate) * self.inverse_ratio,
            },
            acceleration: motor_acceleration,
            jerk: self.inverse_ratio * setpoint.jerk,
            link_offset,
            torque_rate: self.wave_generator_inertia * gains.inertia * self.inverse_ratio * setpoint.jerk
                + transmission * accelerating_rate,
            torque: self.wave_generator_inertia * gains.inertia * motor_acceleration
                + friction_gain * factors.input_friction * input_friction
                + transmission * (inertia * acceleration + friction_gain * on_output)
                + torque,
            transmission,
            wind_up_compliance: wind_up_gain * state.line_compliance,
            accelerating,
            accelerating_rate,
            excitation: Excitation {
                velocity: setpoint.velocity,
                acceleration: setpoint.acceleration,
                jerk: setpoint.jerk,
                snap: setpoint.snap,
                input_friction: moving * input_friction,
                output_friction: moving * output_friction,
                ..Excitation::default()
            },
        }
    }
}
