//! Multi-rate model of the gear for the observer.
//!
//! Torsion and torques are those of [`crate::gear::Gear`] in every period of the observer, dt. The costly parts are
//! evaluated in every second one: kinematic error and hysteresis in the first, the friction of both sides in the
//! second, each over 2*dt. In between the kinematic error is extrapolated by its slope, hysteresis and friction are
//! held:
//!
//! ```text
//! e <- e + de/dtheta*dt*omega_wg,   error at most (k*omega_wg*dt)^2/2 of the amplitude of an order k
//! ```
//!
//! The flexspline is stiffer than its model by the learnt stiffening k: its line is the model's at a torsion and a rate
//! that are 1 + k times larger, so that its knees stay at their torques, as those of a catalogue's line do; the
//! hysteresis is 1 + k times the model's at that torsion, its loop under a given torque as wide as the model's. Units
//! and signs as in [`crate::gear`].
//!
//! Behind a tooth belt ([`crate::belt::series`]) the wave generator's angle and speed are those of the belt's input, and its
//! inertia has the motor's. The belt's stretch s by the torques of the period before takes its part of the torsion:
//!
//! ```text
//! phi = e - (theta_fs - r*theta_in) - r*s((r + de/dtheta)*tau_t + tau_fric_in)
//! ```
//!
//! A fixed-point step a period, which contracts by K_3*r^2*2*c, below 0.5 ([`MultiRate::behind`]).

use crate::angle::{Angle, Heading};
use crate::belt::SeriesBelt;
use crate::compensator::{HYSTERESIS_MEMORY, RealTimeGear};
use crate::constants::constants;
use crate::friction::{FrictionModel, JointFrictionState, Slip, StepTime};
use crate::hysteresis::torsion::TorsionHysteresisState;
use crate::kinematic_error::ErrorAndSlope;
use crate::real::Real;

/// State of the multi-rate model.
#[derive(Clone, Debug, Default)]
pub struct MultiRateGear<R: Real> {
    input_friction: JointFrictionState<R>,
    output_friction: JointFrictionState<R>,
    hysteresis: TorsionHysteresisState<R, HYSTERESIS_MEMORY>,
    /// Hysteresis torque of its last evaluation, with the learnt stiffening (N m).
    hysteresis_torque: R,
    /// Kinematic error of its last evaluation, extrapolated since.
    kinematic_error: ErrorAndSlope<R>,
    heading: Heading<R>,
    /// r*s of the last period (rad).
    stretch: R,
    /// The next period evaluates the frictions, not kinematic error and hysteresis.
    friction_next: bool,
}

/// Motion of both ends.
#[derive(Clone, Copy, Debug)]
pub struct Ends<R, V> {
    /// Angle of the wave generator, evaluated on demand.
    pub wave_generator: V,
    /// Its speed (rad/s).
    pub wave_generator_speed: R,
    /// theta_fs - r*theta_wg (rad).
    pub link_offset: R,
    /// Speed of the flange (rad/s).
    pub flange_speed: R,
}

/// Learnt correction of the gear's model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GearCorrection<R> {
    /// Factors on the friction of wave generator and flexspline, less 1.
    pub friction: [R; 2],
    /// Stiffening k of the flexspline relative to the model.
    pub stiffening: R,
    /// Learnt ripple of the output's position, added to the kinematic error (rad).
    pub position: R,
    /// Learnt torque that resists the motor, added to the model's (N m).
    pub motor_torque: R,
    /// Torque on the flexspline, added to the model's (N m).
    pub load: R,
}

/// Torques inside the gear (N m), and the torsion that they follow from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Torques<R> {
    /// Torsion phi (rad).
    pub torsion: R,
    /// Its rate (rad/s).
    pub torsion_rate: R,
    /// Ratio r + de/dtheta_wg by which the transmitted torque loads the wave generator.
    pub slope: R,
    /// tau_t on the output flange.
    pub transmitted: R,
    /// Friction at the wave generator.
    pub input_friction: R,
    /// Friction at the flexspline.
    pub output_friction: R,
    /// The flexspline's torque is at the end of its range.
    pub saturated: bool,
}

/// Ratio and periods of the multi-rate model.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultiRate<R> {
    ratio: R,
    dt: R,
    /// 2*dt.
    round: StepTime<R>,
    belt: SeriesBelt<R>,
}

impl<R: Real> MultiRate<R> {
    /// For a gear of this ratio r and the observer's period dt (s).
    pub fn build(ratio: R, dt: R) -> Self {
        Self { ratio, dt, round: StepTime::new(R::lit(2.0) * dt), belt: SeriesBelt::NONE }
    }

    /// The same behind a belt.
    #[must_use]
    pub fn behind(self, belt: SeriesBelt<R>) -> Self {
        Self { belt, ..self }
    }

    /// r.
    #[inline(always)]
    pub fn ratio(&self) -> R {
        self.ratio
    }
}

impl<R: Real> MultiRateGear<R> {
    /// Sets the learnt shape and stiffness of the presliding of either side.
    #[inline(always)]
    pub fn shape(&mut self, gear: &RealTimeGear<R>, order_two: R, stiffening: R) {
        let (input, output) = gear.frictions();
        input.shape(&mut self.input_friction, order_two, stiffening);
        output.shape(&mut self.output_friction, order_two, stiffening);
    }

    /// Evaluates the kinematic error at this angle of the wave generator (rad).
    #[inline(always)]
    pub fn start_at(&mut self, gear: &RealTimeGear<R>, wave_generator: Angle<R>) -> R {
        self.heading = wave_generator.heading();
        self.kinematic_error = gear.kinematic_error(wave_generator, self.heading);
        self.kinematic_error.error
    }

    /// Takes the period as one in which its parts are evaluated: a part stays in its slot of the schedule.
    #[inline(always)]
    pub fn take_turn(&mut self) {
        self.friction_next = !self.friction_next;
    }

    /// Torques for the motion of both ends; advances the parts that are due in this period.
    #[inline(always)]
    pub fn torques(
        &mut self,
        multi_rate: &MultiRate<R>,
        gear: &RealTimeGear<R>,
        ends: &Ends<R, impl Fn() -> Angle<R>>,
        gear_correction: &GearCorrection<R>,
    ) -> Torques<R> {
        let has_friction = self.friction_next;
        self.take_turn();
        if has_friction {
            self.kinematic_error.error +=
                self.kinematic_error.slope * (multi_rate.dt * ends.wave_generator_speed);
        } else {
            self.start_at(gear, (ends.wave_generator)());
        }
        let slope = multi_rate.ratio + self.kinematic_error.slope;
        let in_front = if multi_rate.belt.stretches() { self.stretch } else { R::ZERO };
        let torsion = self.kinematic_error.error - ends.link_offset - in_front;
        let torsion_rate = slope * ends.wave_generator_speed - ends.flange_speed;
        let scale = R::ONE + gear_correction.stiffening;
        let torque = gear.flexspline().torque(scale * torsion, scale * torsion_rate);
        if !has_friction {
            let hysteresis = gear.hysteresis().step(&mut self.hysteresis, scale * torsion);
            self.hysteresis_torque = scale * hysteresis.torque;
        }
        let transmitted = torque + self.hysteresis_torque;
        let (on_input, on_output) = gear.frictions();
        if has_friction {
            let slip = |velocity, load| Slip {
                wave_generator: self.heading,
                ..Slip::over(velocity, multi_rate.round).under(R::ZERO, load)
            };
            // Both within their limits: the observer's range bounds the speeds, the flexspline its torque.
            let on_motor = slip(ends.wave_generator_speed, slope * transmitted);
            on_input.advance(&mut self.input_friction, &on_motor);
            on_output.advance(&mut self.output_friction, &slip(ends.flange_speed, transmitted));
        }
        let [input, output] = [on_input.force(&self.input_friction), on_output.force(&self.output_friction)];
        let input_friction = input + gear_correction.friction[0] * input;
        if multi_rate.belt.stretches() {
            self.stretch = multi_rate.ratio * multi_rate.belt.stretch(slope * transmitted + input_friction);
        }
        Torques {
            torsion,
            torsion_rate,
            slope,
            transmitted,
            input_friction,
            output_friction: output + gear_correction.friction[1] * output,
            saturated: gear.flexspline().saturates(torque),
        }
    }
}
