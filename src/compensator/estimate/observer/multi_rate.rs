//! The gear as the observer carries it along: its memories by turns.
//!
//! Torsion and torques are those of [`crate::gear::Gear`] in every period of the observer, dt. What costs most to
//! evaluate has its turn in every second one: kinematic error and hysteresis in the first, the friction of both sides
//! in the second, each over 2*dt. In between the kinematic error moves on its slope, hysteresis and friction are
//! held:
//!
//! ```text
//! e <- e + de/dtheta*dt*omega_wg,   off by at most (k*omega_wg*dt)^2/2 of the amplitude of an order k
//! ```
//!
//! The flexspline is as much stiffer than the model, k, as is known: its line is the model's at a torsion and a rate
//! that are 1 + k times larger, so that its knees stay at their torques, as those of a catalogue's line do; the
//! hysteresis is 1 + k times the model's at that torsion, its loop under a given torque as wide as the model's. Units
//! and signs as in [`crate::gear`].

use crate::angle::{Angle, Heading};
use crate::compensator::{HYSTERESIS_MEMORY, RealTimeGear};
use crate::friction::{FrictionModel, JointFrictionState, Slip, StepTime};
use crate::hysteresis::torsion::TorsionHysteresisState;
use crate::kinematic_error::Deviation;
use crate::real::Real;

/// What it remembers.
#[derive(Clone, Debug, Default)]
pub struct GearByTurns<R: Real> {
    input_friction: JointFrictionState<R>,
    output_friction: JointFrictionState<R>,
    hysteresis: TorsionHysteresisState<R, HYSTERESIS_MEMORY>,
    /// Of the last turn (N m), of the gear that is as stiff as is known.
    hysteresis_torque: R,
    /// Of the last turn, moved on since.
    deviation: Deviation<R>,
    heading: Heading<R>,
    /// The frictions had the last turn, not the kinematic error.
    friction_last: bool,
}

/// How both ends move.
#[derive(Clone, Copy, Debug)]
pub struct Ends<R, V> {
    /// Angle of the wave generator, when it is needed.
    pub wave_generator: V,
    /// Its speed (rad/s).
    pub wave_generator_speed: R,
    /// By how much the flange is ahead of r*theta_wg (rad).
    pub ahead: R,
    /// Speed of the flange (rad/s).
    pub flange_speed: R,
}

/// What is known of this gear beside its model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Known<R> {
    /// Factors on the friction of wave generator and flexspline, less 1.
    pub friction: [R; 2],
    /// By how much the flexspline is stiffer, relative to the model.
    pub stiffening: R,
    /// By how much the output is ahead beside the kinematic error (rad).
    pub position: R,
    /// Torque that resists the motor beside the model's (N m).
    pub motor_torque: R,
    /// Torque on the flexspline beside the model's (N m).
    pub load: R,
}

/// Torques inside the gear (N m), and what they follow from.
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

/// What does not change from period to period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns<R> {
    ratio: R,
    dt: R,
    /// 2*dt.
    round: StepTime<R>,
}

impl<R: Real> Turns<R> {
    /// For a gear of this ratio r and the observer's period dt (s).
    pub fn build(ratio: R, dt: R) -> Self {
        Self { ratio, dt, round: StepTime::new(R::lit(2.0) * dt) }
    }

    /// r.
    #[inline(always)]
    pub fn ratio(&self) -> R {
        self.ratio
    }
}

impl<R: Real> GearByTurns<R> {
    /// Gives the presliding of either side the learnt shape.
    #[inline(always)]
    pub fn shape(&mut self, gear: &RealTimeGear<R>, share: R, stiffening: R) {
        let (input, output) = gear.frictions();
        input.shape(&mut self.input_friction, share, stiffening);
        output.shape(&mut self.output_friction, share, stiffening);
    }

    /// Goes on from this angle of the wave generator; answers with the kinematic error there (rad).
    #[inline(always)]
    pub fn start_at(&mut self, gear: &RealTimeGear<R>, wave_generator: Angle<R>) -> R {
        self.heading = wave_generator.heading();
        self.deviation = gear.kinematic_error(wave_generator, self.heading);
        self.deviation.error
    }

    /// Advances what has its turn for the motion of both ends, and answers with the torques.
    #[inline(always)]
    pub fn torques(
        &mut self,
        turns: &Turns<R>,
        gear: &RealTimeGear<R>,
        ends: &Ends<R, impl Fn() -> Angle<R>>,
        known: &Known<R>,
    ) -> Torques<R> {
        self.friction_last = !self.friction_last;
        let has_friction = self.friction_last;
        if has_friction {
            self.deviation.error += self.deviation.slope * (turns.dt * ends.wave_generator_speed);
        } else {
            self.start_at(gear, (ends.wave_generator)());
        }
        let slope = turns.ratio + self.deviation.slope;
        let torsion = self.deviation.error - ends.ahead;
        let torsion_rate = slope * ends.wave_generator_speed - ends.flange_speed;
        let scale = R::ONE + known.stiffening;
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
                ..Slip::over(velocity, turns.round).under(R::ZERO, load)
            };
            let on_motor = slip(ends.wave_generator_speed, slope * transmitted);
            on_input.step(&mut self.input_friction, &on_motor);
            on_output.step(&mut self.output_friction, &slip(ends.flange_speed, transmitted));
        }
        let [input, output] = [on_input.force(&self.input_friction), on_output.force(&self.output_friction)];
        Torques {
            torsion,
            torsion_rate,
            slope,
            transmitted,
            input_friction: input + known.friction[0] * input,
            output_friction: output + known.friction[1] * output,
            saturated: gear.flexspline().saturates(torque),
        }
    }
}
