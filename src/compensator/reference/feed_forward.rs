//! Feed-forward: where the motor should be, and with what torque, for the output to follow its setpoint.
//!
//! ```text
//! J = f_J*J_fs,  tau_fric = f*friction of the gear's model along the setpoint       f: learnt factors
//! tau_t     = s_i*J*ddq + tau_fric_out - d_ff                 what the flexspline must carry
//! phi       = c*line^-1(tau_t - tau_hyst)                      wind-up that carries it; tau_hyst: the model's of phi/c, over c
//! theta_ref = (q + s_w*phi - s_e*e(theta_ref) - ripple) / r    put in advance
//! tau_ff    = J_wg*ddtheta_ref + s_f*tau_fric_in + (r + s_e*de/dtheta)*(J*(ddq + dt/2*dddq) + s_f*tau_fric_out)
//! dtheta_ref  = (dq + s_w*c/k*(J*dddq + d(tau_fric_out - tau_hyst)/dt) - s_e*de/dt) / r
//! ddtheta_ref = (ddq + dt/2*dddq + s_w*c/k*J*ddddq - s_e*dde/dt^2) / r
//! ```
//!
//! q is the setpoint of the output with its derivatives, d_ff the external torque as far as it is followed, k the
//! line's stiffness at tau_t, c its compliance factor, and s the shares (0..=1) of inertia, friction, wind-up and
//! kinematic error. Units: rad, N m; signs as in [`crate::gear`]. Evaluated once per round T of [`crate::compensator::schedule`], for
//! the setpoint of that instant; the torque, which is held over each control period dt, for the middle of the first
//! one. Until the next setpoint the motor goes on by the acceleration, the jerk and the torque's rate that are answered
//! with. [`PLAN_TO_MODELS`] periods later kinematic error, hysteresis and the friction of either side have their turn
//! ([`FeedForward::remember`]), for where the setpoint will be by then: on its acceleration, the torsion on its rate.
//! The kinematic error moves on its slope and bend until the next setpoint. Rates of friction, hysteresis and slope are
//! their differences over T.
//!
//! The flexible joint is flat: motor angle and torque follow from the output's trajectory without solving a
//! differential equation: the motor's speed takes the setpoint's jerk, its acceleration the snap. Friction is the
//! gear's own model driven along the setpoint, so its presliding before a reversal is contained, and the speed at
//! which the wind-up that carries it comes and goes: without it the cascade lags by what the friction changes, and
//! that is still there when a move ends.
//!
//! At rest the setpoint covers no path and the model's friction stays what it was, up to the static level. A joint of
//! 20 % less friction would be driven by 80 % of that: once it slides, its friction is less than its static level.
//! What is fed forward as torque therefore fades where nothing moves: s_f stands for s_f*w,
//!
//! ```text
//! w <- w + min(4*ds/eps, 1)*(1 - w) - T/T_f*w         ds: path of the motor over T, eps: its presliding, T_f = 0.5 s
//! ```
//!
//! which is there after a quarter of the presliding, passes a reversal within a few percent, and is 0 at rest: the
//! torque only falls there, so it does not hunt. At a motor speed of eps/(4*T_f) w is a half.
//!
//! Hysteresis, kinematic error and the friction's load are implicit equations; all are solved by one fixed-point step
//! in their turn: the hysteresis torque follows the torsion of the setpoint before (contraction: its slope over K1,
//! about 0.2), e and the friction's ripple follow the motor reference of [`MODELS_TO_PLAN`] periods before (contraction:
//! N*de/dtheta, below 0.03 for the default gear), and the friction's load is the tau_t of the setpoint before
//! (contraction: the load's factor).
//!
//! The external torque that the observer estimates winds the gear up as [`crate::compensator::estimate::disturbance`] follows it: d_ff.
//!
//! M. Fliess, J. Levine, P. Martin, P. Rouchon, "Flatness and defect of non-linear systems", International Journal of
//! Control 61 (1995); A. De Luca, "Feedforward/feedback laws for the control of flexible robots", IEEE International
//! Conference on Robotics and Automation (2000).

use crate::angle::{Angle, Heading, Ratio};
use crate::compensator::adapt::parameters::{Excitation, Factors};
use crate::compensator::schedule::{MODELS_TO_PLAN, PLAN_TO_MODELS, SLOW_PERIODS};
use crate::compensator::{HYSTERESIS_MEMORY, RealTimeGear, Setpoint, Shares};
use crate::error::{Error, require};
use crate::friction::{FrictionModel, JointFrictionState, Slip, StepTime};
use crate::gear::{GearParams, Motion};
use crate::hysteresis::torsion::TorsionHysteresisState;
use crate::kinematic_error::Deviation;
use crate::real::Real;

/// T_f (s): how long friction is fed forward at rest.
const FADING_TIME: f64 = 0.5;

/// The built feed-forward.
///
/// At rest under a load of 20 N m the motor is sent ahead by the wind-up that carries it; accelerating the output takes
/// the inertia of the load over the ratio, and that of the rotor:
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::Angle;
/// use strainwave::compensator::reference::feed_forward::{FeedForward, FeedForwardState, ModelCorrection};
/// use strainwave::compensator::{RealTimeFlexspline, RealTimeGear, Setpoint, Shares};
///
/// let params = JOINT.gear;
/// let flexspline = RealTimeFlexspline::build(&params.flexspline, params.rated_torque)?;
/// let gear: RealTimeGear<f32> = params.build(flexspline, JOINT.dt)?;
/// let feed_forward = FeedForward::build(&params, JOINT.dt)?;
/// let demand = |setpoint, load| {
///     let correction = ModelCorrection { load, ..ModelCorrection::default() };
///     feed_forward.step(&gear, &mut FeedForwardState::default(), &setpoint, &Shares::ALL, &correction)
/// };
/// let loaded = demand(Setpoint::default(), -20.0);
/// assert!((loaded.ahead - flexspline.torsion(20.0)).abs() < 1e-9); // rad at the output
/// assert!((loaded.motor.angle.minus(Angle::default()) + 100.0 * loaded.ahead).abs() < 1e-6);
///
/// let accelerating = demand(Setpoint { acceleration: 10.0, ..Setpoint::default() }, 0.0);
/// let expected = -params.flexspline_inertia * 10.0 / 100.0 - params.wave_generator_inertia * 100.0 * 10.0;
/// assert!((accelerating.torque - expected).abs() < 1e-4, "{} N m", accelerating.torque);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedForward<R> {
    wave_generator_inertia: R,
    flexspline_inertia: R,
    ratio: R,
    inverse_ratio: R,
    /// T.
    round: StepTime<R>,
    /// From a setpoint to the models' slot (s).
    to_models: R,
    /// From the models' slot to the next setpoint (s).
    to_plan: R,
    /// 4/eps.
    engagement: R,
    /// Path behind a reversal after which nothing of it is left (rad).
    presliding_path: R,
    /// T/T_f.
    fading: R,
    /// 1/T (1/s).
    inverse_round: R,
    /// Half a control period (s).
    half_step: R,
}

/// What the feed-forward remembers of the setpoint's motion.
#[derive(Clone, Debug, Default)]
pub struct FeedForwardState<R: Real> {
    input_friction: JointFrictionState<R>,
    output_friction: JointFrictionState<R>,
    hysteresis: TorsionHysteresisState<R, HYSTERESIS_MEMORY>,
    hysteresis_torque: R,
    /// tau_fric_out - tau_hyst in the hysteresis' last turn (N m), and its rate.
    resistance: R,
    resistance_rate: R,
    /// e and de/dtheta of the last turn, moved on since.
    deviation: Deviation<R>,
    /// de/dtheta in the last turn, and its rate (1/s).
    slope: R,
    bend: R,
    heading: Heading<R>,
    /// tau_t of the last setpoint (N m).
    carried: R,
    /// In the models' turn: the model's torsion that carries the torque (rad), and the output's speed (rad/s).
    nominal: R,
    velocity: R,
    /// w.
    engaged: R,
    /// s: path of the motor since it turned back (rad), with its sign.
    path: R,
    /// s*dF/ds of its friction (N m).
    stiffened: R,
}

/// What has been learnt of the joint beside its model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelCorrection<R: Real> {
    /// Factors on the nominal gear.
    pub factors: Factors<R>,
    /// The external torque as far as it is followed.
    pub load: R,
    /// How far the output is ahead of the gear's model at the reference (rad).
    pub ripple: R,
    /// Torque that the motor needs there beside the model's (N m).
    pub torque: R,
}

/// What the feed-forward asks of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand<R> {
    /// Where the motor should be, and how fast it should turn.
    pub motor: Motion<R>,
    /// How fast its speed should change (rad/s^2).
    pub acceleration: R,
    /// How fast that changes (rad/s^3).
    pub jerk: R,
    /// By how much r times the motor's angle is to be ahead of the output (rad).
    pub ahead: R,
    /// Torque at the motor shaft (N m).
    pub torque: R,
    /// How fast that changes (N m/s).
    pub torque_rate: R,
    /// r + s_e*de/dtheta there: what of a torque at the output the motor carries.
    pub transmission: R,
    /// By how much the gear's torsion yields to a torque, as far as it is wound up (rad/(N m)).
    pub wound: R,
    /// J*ddq that the gear is wound up for (N m).
    pub accelerating: R,
    /// How fast that changes (N m/s).
    pub accelerating_rate: R,
    /// What it rests on, from the nominal gear.
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
        let positive = |value: R| value.is_finite() && value > R::ZERO;
        require(positive(gear.wave_generator_inertia), "wave_generator_inertia")?;
        require(positive(gear.flexspline_inertia), "flexspline_inertia")?;
        let (ratio, round) = (Ratio::one_over(gear.ratio)?, R::from_i32(SLOW_PERIODS as i32) * dt);
        Ok(Self {
            wave_generator_inertia: gear.wave_generator_inertia,
            flexspline_inertia: gear.flexspline_inertia,
            ratio: ratio.value(),
            inverse_ratio: R::from_i32(ratio.n()),
            round: StepTime::new(round),
            to_models: R::from_i32(PLAN_TO_MODELS as i32) * dt,
            to_plan: R::from_i32(MODELS_TO_PLAN as i32) * dt,
            presliding_path: R::lit(4.0) * gear.input_friction.presliding,
            engagement: R::lit(4.0) / gear.input_friction.presliding,
            fading: (round / R::lit(FADING_TIME)).min(R::ONE),
            inverse_round: R::ONE / round,
            half_step: R::lit(0.5) * dt,
        })
    }

    /// The kinematic error's turn.
    #[inline(always)]
    fn deviate(&self, gear: &RealTimeGear<R>, state: &mut FeedForwardState<R>, reference: Angle<R>) {
        state.deviation = gear.kinematic_error(reference, state.heading);
        state.bend = (state.deviation.slope - state.slope) * self.inverse_round;
        state.slope = state.deviation.slope;
    }

    /// The frictions' turn; w with that of the motor.
    #[inline(always)]
    fn step_friction(&self, gear: &RealTimeGear<R>, state: &mut FeedForwardState<R>) {
        let (heading, output) = (state.heading, state.velocity);
        let slip = |velocity, load| Slip {
            wave_generator: heading,
            ..Slip::over(velocity, self.round).under(R::ZERO, load)
        };
        let (on_input, on_output) = gear.frictions();
        let before = on_input.presliding(&state.input_friction);
        on_output.step(&mut state.output_friction, &slip(output, state.carried));
        let slip = slip(output * self.inverse_ratio, self.ratio * state.carried);
        state.engaged = state.engaged - self.fading * state.engaged;
        state.engaged += (slip.displacement().abs() * self.engagement).min(R::ONE) * (R::ONE - state.engaged);
        on_input.step(&mut state.input_friction, &slip);
        let change = on_input.presliding(&state.input_friction) - before;
        state.stiffened = self.steps_since_reversal(state, slip.displacement()) * change;
    }

    /// s/ds after another `step` ds of the motor (rad); 0 at rest and where the reversal is far behind.
    #[inline(always)]
    fn steps_since_reversal(&self, state: &mut FeedForwardState<R>, step: R) -> R {
        let path = if state.path * step < R::ZERO { step } else { state.path + step };
        state.path = path.limit(self.presliding_path);
        if step == R::ZERO || state.path != path { R::ZERO } else { path / step }
    }

    /// The models' turn, after the last setpoint's, with the motor sent to `reference` now.
    #[inline(always)]
    pub fn remember(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut FeedForwardState<R>,
        reference: Angle<R>,
        factors: &Factors<R>,
    ) {
        state.heading = reference.heading();
        self.deviate(gear, state, reference);
        self.step_friction(gear, state);
        let scale = R::ONE + factors.stiffening();
        state.hysteresis_torque = scale * gear.hysteresis().step(&mut state.hysteresis, state.nominal).torque;
        let (_, output) = gear.frictions();
        let resistance =
            factors.output_friction * output.force(&state.output_friction) - state.hysteresis_torque;
        state.resistance_rate = (resistance - state.resistance) * self.inverse_round;
        state.resistance = resistance;
    }

    /// w*(F_2 - F_1) and w*s*dF/ds of the wave generator's friction (N m), 0 at rest.
    #[inline(always)]
    pub fn presliding(&self, gear: &RealTimeGear<R>, state: &FeedForwardState<R>) -> [R; 2] {
        let (input, _) = gear.frictions();
        let engaged = if state.velocity == R::ZERO { R::ZERO } else { state.engaged };
        [engaged * input.shaped(&state.input_friction), engaged * state.stiffened]
    }

    /// Gives the presliding of either side its learnt shape and stiffness.
    #[inline(always)]
    pub fn shape(&self, gear: &RealTimeGear<R>, state: &mut FeedForwardState<R>, share: R, stiffening: R) {
        let (input, output) = gear.frictions();
        input.shape(&mut state.input_friction, share, stiffening);
        output.shape(&mut state.output_friction, share, stiffening);
    }

    /// Demand for a setpoint; `correction` is what has been learnt of the joint beside its model.
    #[inline(always)]
    pub fn step(
        &self,
        gear: &RealTimeGear<R>,
        state: &mut FeedForwardState<R>,
        setpoint: &Setpoint<R>,
        shares: &Shares<R>,
        correction: &ModelCorrection<R>,
    ) -> Demand<R> {
        let ModelCorrection { factors, load, ripple, torque } = *correction;
        let inertia = self.flexspline_inertia * factors.inertia * shares.inertia;
        let motor_velocity = setpoint.velocity * self.inverse_ratio;
        state.velocity = setpoint.velocity + self.to_models * setpoint.acceleration;
        let (input, output) = gear.frictions();
        let input_friction = input.force(&state.input_friction);
        let output_friction = output.force(&state.output_friction);
        let on_output = factors.output_friction * output_friction;

        let (accelerating, accelerating_rate) = (inertia * setpoint.acceleration, inertia * setpoint.jerk);
        state.carried = accelerating + on_output - load;
        let on_line = state.carried - state.hysteresis_torque;
        let nominal = gear.flexspline().torsion(on_line);
        let compliance = gear.flexspline().compliance(on_line);
        let wound_share = shares.wind_up * factors.compliance;
        let wound = wound_share * compliance;
        let carried_rate = accelerating_rate + state.resistance_rate;
        state.nominal = nominal + self.to_models * compliance * carried_rate;

        let moved = self.to_plan * motor_velocity;
        state.deviation.error += state.deviation.slope * moved;
        state.deviation.slope += self.to_plan * state.bend;
        let deviation = state.deviation;
        let ahead = wound_share * nominal - shares.kinematic_error * deviation.error - ripple;
        let ahead_rate = wound * carried_rate - shares.kinematic_error * deviation.slope * motor_velocity;
        let reference = gear.ratio().undo(setpoint.position.plus(ahead));

        let acceleration = setpoint.acceleration + self.half_step * setpoint.jerk;
        let bent = state.bend * motor_velocity + deviation.slope * self.inverse_ratio * setpoint.acceleration;
        let ahead_acceleration = wound * inertia * setpoint.snap - shares.kinematic_error * bent;
        let motor_acceleration = (acceleration + ahead_acceleration) * self.inverse_ratio;
        let engaged = state.engaged;
        let share = shares.friction * engaged;
        let transmission = self.ratio + shares.kinematic_error * deviation.slope;
        let moving = if setpoint.velocity == R::ZERO { R::ZERO } else { engaged };
        Demand {
            motor: Motion {
                angle: reference,
                velocity: (setpoint.velocity + ahead_rate) * self.inverse_ratio,
            },
            acceleration: motor_acceleration,
            jerk: self.inverse_ratio * setpoint.jerk,
            ahead,
            torque_rate: self.wave_generator_inertia * shares.inertia * self.inverse_ratio * setpoint.jerk
                + transmission * accelerating_rate,
            torque: self.wave_generator_inertia * shares.inertia * motor_acceleration
                + share * factors.input_friction * input_friction
                + transmission * (inertia * acceleration + share * on_output)
                + torque,
            transmission,
            wound,
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
