//! Fisher information of a motion about the parameters of a moving joint.
//!
//! The motor follows the motion; the real-time model in f64 answers with motor torque and output angle. Their sensitivities are
//! central differences. Noise, and what is known before, are those that `identify --moving` starts from: a torque of 20 % of the
//! Coulomb level, alike over 0.1 s; an angle of 20 urad, alike over a short path and time, and the encoder's own.
//!
//! | parameter | unit | known before |
//! | --- | --- | --- |
//! | levels of the input friction, its viscous part, inertia of the load | factor on the gear file's | 1 |
//! | stiffness | factor on the gear file's | 1 |
//! | weight, sine and cosine over the output angle | N m at the output | peak torque |
//! | kinematic error, sine and cosine of the orders 2 and 4 | rad | as the orders' catalogue size |
//! | offset of the encoders | rad | 0.01 |

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{DMatrix, DVector};
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{HYSTERESIS_MEMORY, RealTimeFlexspline, RealTimeGear};
use strainwave::friction::JointFrictionState;
use strainwave::gear::{GearParams, GearState, Motion};
use strainwave::{Angle, Error};

use crate::bench::Trajectory;
use crate::bench::task::{Task, periods};
use crate::design::capability::Capability;
use crate::design::joint::firmware_gear_params;
use crate::identify::moving::{EVERY, OFFSET, alike, error_prior, torque_noise};
use crate::io::gear_file::GearFile;
use crate::plant::unknowns::add;
use crate::sensor::Wave;

/// Step of the differences, in priors.
const STEP: f64 = 0.02;

/// A parameter of a moving joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Coulomb and static friction of the wave generator.
    FrictionLevel,
    /// Its viscous friction.
    Viscous,
    /// Inertia of the load.
    Inertia,
    /// Stiffness of the gear: what the angle tells of inertia and weight it tells of them over the stiffness.
    Stiffness,
    /// Weight over the sine of the output angle.
    WeightSine,
    /// Weight over its cosine.
    WeightCosine,
    /// Sine of an order of the kinematic error.
    ErrorSine(u32),
    /// Its cosine.
    ErrorCosine(u32),
    /// Offset of the encoders.
    Offset,
}

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::FrictionLevel,
        Self::Viscous,
        Self::Inertia,
        Self::Stiffness,
        Self::WeightSine,
        Self::WeightCosine,
        Self::ErrorSine(2),
        Self::ErrorCosine(2),
        Self::ErrorSine(4),
        Self::ErrorCosine(4),
        Self::Offset,
    ];

    /// As in the names of figures.
    pub fn name(self) -> String {
        match self {
            Self::FrictionLevel => "friction_level".into(),
            Self::Viscous => "viscous".into(),
            Self::Inertia => "inertia".into(),
            Self::Stiffness => "stiffness".into(),
            Self::WeightSine => "weight.sine".into(),
            Self::WeightCosine => "weight.cosine".into(),
            Self::ErrorSine(order) => format!("kinematic_error.order_{order}.sine"),
            Self::ErrorCosine(order) => format!("kinematic_error.order_{order}.cosine"),
            Self::Offset => "offset".into(),
        }
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::FrictionLevel | Self::Viscous | Self::Inertia | Self::Stiffness => "1",
            Self::WeightSine | Self::WeightCosine => "N m",
            Self::ErrorSine(_) | Self::ErrorCosine(_) | Self::Offset => "rad",
        }
    }

    fn prior(self, gear: &GearFile) -> f64 {
        match self {
            Self::FrictionLevel | Self::Viscous | Self::Inertia | Self::Stiffness => 1.0,
            Self::WeightSine | Self::WeightCosine => gear.gear.peak_torque,
            Self::ErrorSine(order) | Self::ErrorCosine(order) => error_prior(order),
            Self::Offset => OFFSET,
        }
    }
}

/// Every parameter with its prior's standard deviation, in its unit.
pub(super) fn priors(gear: &GearFile) -> Vec<(Parameter, f64)> {
    Parameter::ALL.map(|parameter| (parameter, parameter.prior(gear))).to_vec()
}

/// A joint of the model.
struct Joint {
    params: GearParams<f64>,
    /// Weight over sine and cosine of the output angle (N m).
    weight: [f64; 2],
    offset: f64,
}

impl Joint {
    /// With one parameter changed.
    fn with(gear: &GearFile, parameter: Parameter, change: f64) -> Result<Self, Error> {
        let (mut params, mut weight, mut offset) = (firmware_gear_params::<f64>(gear)?, [0.0; 2], 0.0);
        let friction = &mut params.input_friction;
        let (contacts, error) =
            ([&mut friction.forward, &mut friction.backward], &mut params.kinematic_error.case);
        match parameter {
            Parameter::FrictionLevel => {
                for contact in contacts {
                    contact.coulomb *= 1.0 + change;
                    contact.static_level *= 1.0 + change;
                }
            }
            Parameter::Viscous => {
                for contact in contacts {
                    contact.viscous *= 1.0 + change;
                }
            }
            Parameter::Inertia => params.flexspline_inertia *= 1.0 + change,
            Parameter::Stiffness => {
                params.flexspline.line.stiffness =
                    params.flexspline.line.stiffness.map(|k| k * (1.0 + change));
            }
            Parameter::WeightSine => weight[0] = change,
            Parameter::WeightCosine => weight[1] = change,
            Parameter::ErrorSine(order) => add(error, wave(order, change, 0.0)),
            Parameter::ErrorCosine(order) => add(error, wave(order, change, FRAC_PI_2)),
            Parameter::Offset => offset = change,
        }
        Ok(Self { params, weight, offset })
    }

    /// Motor torque (N m) and output angle (rad) every [`EVERY`] control periods of a motion.
    fn answers(&self, motion: &[Moving]) -> Result<[Vec<f64>; 2], Error> {
        let flexspline = RealTimeFlexspline::build(&self.params.flexspline, self.params.rated_torque)?;
        let gear: RealTimeGear<f64> = self.params.build(flexspline, CONTROL_PERIOD)?;
        let mut state: GearState<f64, (), JointFrictionState<f64>, HYSTERESIS_MEMORY> = gear.rest();
        let mut flange = Motion { angle: gear.drive(Angle::default()), velocity: 0.0 };
        let [mut torque, mut angle] = [(); 2].map(|()| Vec::with_capacity(motion.len() / EVERY + 1));
        for (period, moving) in motion.iter().enumerate() {
            let (sine, cosine) = flange.angle.to_radians().sin_cos();
            let load = self.weight[0] * sine + self.weight[1] * cosine;
            let output = flange.angle.to_radians();
            let resisting = gear.step(&mut state, &mut flange, &moving.motor, load).wave_generator;
            if period % EVERY == 0 {
                torque.push(self.params.wave_generator_inertia * moving.acceleration + resisting);
                angle.push(output + self.offset);
            }
        }
        Ok([torque, angle])
    }
}

/// A sine of this amplitude, which may be negative.
fn wave(order: u32, amplitude: f64, phase: f64) -> Wave {
    let phase = if amplitude < 0.0 { phase - PI } else { phase };
    Wave { order, amplitude: amplitude.abs(), phase }
}

/// Motion of the motor in a control period.
struct Moving {
    motor: Motion<f64>,
    /// (rad/s^2)
    acceleration: f64,
}

fn motion(gear: &GearFile, trajectory: &Trajectory) -> Vec<Moving> {
    let (n, capability) = (f64::from(gear.gear.signed_ratio().n()), Capability::of(gear));
    let moving = |period: usize| {
        let demand = trajectory.at(period as f64 * CONTROL_PERIOD, &capability);
        let angle = Angle::from_radians_f64(n * demand.position);
        Moving {
            motor: Motion { angle, velocity: n * demand.velocity },
            acceleration: n * demand.acceleration,
        }
    };
    (0..periods(trajectory)).map(moving).collect()
}

/// Information of a motion from rest in units of the priors: S'S.
pub(super) fn information(
    gear: &GearFile,
    trajectory: &Trajectory,
    priors: &[(Parameter, f64)],
) -> Result<DMatrix<f64>, Error> {
    let motion = motion(gear, trajectory);
    let mut columns = Vec::with_capacity(priors.len());
    for (parameter, prior) in priors {
        let [ahead, behind] =
            [STEP, -STEP].map(|step| Joint::with(gear, *parameter, step * prior)?.answers(&motion));
        let ([torque, angle], [torque_behind, angle_behind]) = (ahead?, behind?);
        let slope = |ahead: &[f64], behind: &[f64]| -> Vec<f64> {
            ahead.iter().zip(behind).map(|(ahead, behind)| (ahead - behind) / (2.0 * STEP)).collect()
        };
        let torque = slope(&torque, &torque_behind).into_iter().map(|slope| slope / torque_noise(gear));
        let angle = whitened(&slope(&angle, &angle_behind), &motion);
        columns.push(DVector::from_iterator(2 * angle.len(), torque.chain(angle)));
    }
    let sensitivity = DMatrix::from_columns(&columns);
    Ok(sensitivity.transpose() * sensitivity)
}

/// Slopes of the angle, each row of unit noise.
fn whitened(slope: &[f64], motion: &[Moving]) -> Vec<f64> {
    let motor = |row: usize| motion[row * EVERY].motor.angle;
    let added = |row: usize| {
        if row == 0 {
            return slope[0] / alike(f64::INFINITY).1;
        }
        let (rho, noise) = alike(motor(row).minus(motor(row - 1)).abs());
        (slope[row] - rho * slope[row - 1]) / noise
    };
    (0..slope.len()).map(added).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::log::{CommandedMotion, Time};

    fn trajectory(position: impl Fn(f64) -> f64) -> Trajectory {
        let time = Time::every(0.01, 401);
        let position = time.stamps().iter().map(|time| position(*time)).collect();
        Trajectory::of(&CommandedMotion { time, position, velocity: None, acceleration: None, load: None })
    }

    /// Two parameters' correlation where they are all that is unknown.
    fn correlation(information: &DMatrix<f64>, a: usize, b: usize) -> f64 {
        information[(a, b)] / (information[(a, a)] * information[(b, b)]).sqrt()
    }

    /// One speed does not tell Coulomb from viscous friction, several do.
    #[test]
    fn one_speed_does_not_tell_coulomb_from_viscous_friction() {
        let gear = GearFile::default_gear();
        let of = |position: &dyn Fn(f64) -> f64| {
            information(&gear, &trajectory(position), &priors(&gear)).unwrap()
        };
        let one = of(&|time| 0.2 * time);
        let several = of(&|time| 0.04 * time * time);
        assert!(correlation(&one, 0, 1) > 0.98, "{}", correlation(&one, 0, 1));
        assert!(correlation(&several, 0, 1) < 0.97, "{}", correlation(&several, 0, 1));
    }

    /// At a constant speed the torque of the friction's levels is what the model says: all rows together tell the factor to
    /// noise over level and the root of their number.
    #[test]
    fn the_information_of_friction_is_that_of_its_level() {
        let gear = GearFile::default_gear();
        let found = information(&gear, &trajectory(|time| 0.2 * time), &priors(&gear)).unwrap();
        let coulomb = gear.friction.input.coulomb.unwrap();
        let expected = 1000.0 * (coulomb / torque_noise(&gear)).powi(2);
        assert!((found[(0, 0)] / expected - 1.0).abs() < 0.1, "{} {expected}", found[(0, 0)]);
    }

    /// A joint that stands tells nothing of its error's second sine beyond the offset.
    #[test]
    fn a_standing_joint_tells_nothing_but_an_offset() {
        let gear = GearFile::default_gear();
        let priors = priors(&gear);
        let standing = information(&gear, &trajectory(|_| 0.0), &priors).unwrap();
        let moving = information(&gear, &trajectory(|time| 0.1 * time), &priors).unwrap();
        let cosine = Parameter::ALL.iter().position(|p| *p == Parameter::ErrorCosine(2)).unwrap();
        assert!(correlation(&standing, cosine, 10) > 0.999);
        assert!(correlation(&moving, cosine, 10).abs() < 0.5, "{}", correlation(&moving, cosine, 10));
        assert!(standing[(0, 0)] < 1e-3 * moving[(0, 0)], "{} {}", standing[(0, 0)], moving[(0, 0)]);
    }
}
