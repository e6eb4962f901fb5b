//! Flat feed-forward: the stored kinematic error and the gear's wind-up, put in advance.
//!
//! ```text
//! tau_t      = J_fs*ddq + fric(q)                                  torque through the flexspline
//! phi        = line^-1(tau_t),   c = dphi/dtau_t                   wind-up by the catalogue's line
//! dphi       = c*(J_fs*dddq + dfric/dt),   ddphi = c*J_fs*ddddq    its rates
//! theta      = (q + phi - e(theta))/r                              e, e': stored kinematic error and its slope
//! dtheta     = (dq + dphi)/(r + e')
//! ddtheta    = (ddq + ddphi - de'/dt*dtheta)/(r + e')
//! tau_ff     = J_wg*ddtheta + s_f*fric_in(dq/r) + (r + e')*(J_fs*ddq + s_f*fric_out(dq))
//! ```
//!
//! q is the setpoint of the output with its derivatives. fric is the gear's own friction model driven along the
//! setpoint, so that a wind-up which friction holds at rest stays; what is fed forward as torque is the fraction s_f of
//! Coulomb and viscous friction ([`super::rigid_body`]), nothing at rest. theta is found by fixed-point steps
//! (contraction N*e', 0.03 for the default gear). Rates of friction and of e' are differences over the control period.
//! Hysteresis is left out: the line is what a catalogue gives. Units: rad, N m; signs as in [`strainwave::gear`].

use strainwave::flexspline::stiffness_line::StiffnessLine;
use strainwave::friction::{FrictionModel, FrictionParams, JointFriction, JointFrictionState, Slip};
use strainwave::gear::{GearParams, KINEMATIC_TERMS};
use strainwave::kinematic_error::KinematicError;
use strainwave::{Angle, Error, Ratio};

use super::Commanded;
use super::cascade::Demand;
use super::rigid_body::RigidBody;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Fixed-point steps of theta: what is left is below the third power of the contraction.
const STEPS: usize = 3;

/// The model, and what it remembers of the setpoint's motion.
#[derive(Clone)]
pub(super) struct Flat {
    ratio: Ratio,
    line: StiffnessLine<f64>,
    kinematic_error: KinematicError<f64, KINEMATIC_TERMS>,
    output_friction: JointFriction<f64>,
    body: RigidBody,
    wave_generator_inertia: f64,
    flexspline_inertia: f64,
    friction_state: JointFrictionState<f64>,
    /// tau_t of the last setpoint (N m).
    transmitted: f64,
    /// Friction (N m) and e' of the last setpoint.
    last: Option<(f64, f64)>,
}

impl Flat {
    pub fn build(ratio: Ratio, gear: &GearParams<f64>, body: RigidBody) -> Result<Self, Error> {
        Ok(Self {
            ratio,
            line: gear.flexspline.line.build()?,
            kinematic_error: gear.kinematic_error.build(ratio)?,
            output_friction: gear.output_friction.build()?,
            body,
            wave_generator_inertia: gear.wave_generator_inertia,
            flexspline_inertia: gear.flexspline_inertia,
            friction_state: JointFrictionState::default(),
            transmitted: 0.0,
            last: None,
        })
    }

    /// Reference and torque of the motor; `shift` (rad) is added to the output's setpoint.
    pub fn step(&mut self, commanded: &Commanded, shift: f64) -> Demand {
        let (r, j): (f64, f64) = (self.ratio.value(), self.flexspline_inertia);
        let slip = Slip::new(commanded.velocity, CONTROL_PERIOD).under(0.0, self.transmitted);
        let friction = self.output_friction.step(&mut self.friction_state, &slip).force;
        let accelerating = j * commanded.acceleration;
        self.transmitted = accelerating + friction;
        let (wind_up, compliance) =
            (self.line.torsion(self.transmitted), self.line.compliance(self.transmitted));

        let ideal = commanded.position.plus(shift + wind_up);
        let angle = self.ahead_of_error(ideal);
        let slope = self.kinematic_error.at(angle).slope;
        let (before, slope_before) = self.last.replace((friction, slope)).unwrap_or((friction, slope));
        let winding = compliance * (j * commanded.jerk + (friction - before) / CONTROL_PERIOD);
        let transmission = r + slope;
        let velocity = (commanded.velocity + winding) / transmission;
        let bending = (slope - slope_before) / CONTROL_PERIOD * velocity;
        let acceleration =
            (commanded.acceleration + compliance * j * commanded.snap - bending) / transmission;
        let [on_input, on_output] = self.body.friction(commanded.velocity);
        Demand {
            angle,
            velocity,
            acceleration,
            torque: self.wave_generator_inertia * acceleration
                + on_input
                + transmission * (accelerating + on_output),
        }
    }

    /// theta for which r*theta + e(theta) is `ideal`.
    fn ahead_of_error(&self, ideal: Angle<f64>) -> Angle<f64> {
        (0..STEPS).fold(self.ratio.to_motor(ideal), |theta, _| {
            self.ratio.to_motor(ideal.plus(-self.kinematic_error.at(theta).error))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::firmware_gear_params;
    use crate::io::gear_file::{Arrangement, GearFile};

    fn flat(file: &GearFile) -> Flat {
        let (ratio, gear) = (file.gear.signed_ratio(), firmware_gear_params(file).unwrap());
        Flat::build(ratio, &gear, RigidBody::new(ratio, &gear, 0.8)).unwrap()
    }

    fn arrangements() -> [GearFile; 2] {
        [Arrangement::CircularSplineFixed, Arrangement::FlexsplineFixed].map(|arrangement| {
            let mut file = GearFile::default_gear();
            file.gear.arrangement = arrangement;
            file
        })
    }

    /// Under a torque that does not change the motor is sent to q/r + line^-1(tau)/r.
    #[test]
    fn a_steady_torque_winds_the_gear_up_by_the_catalogues_line() {
        for mut file in arrangements() {
            file.kinematic_error = Default::default();
            let r: f64 = file.gear.signed_ratio().value();
            // Through the three pieces of the line; an acceleration at no speed leaves the friction alone.
            for torque in [-60.0, -7.0, 0.0, 7.0, 30.0, 100.0] {
                let acceleration = torque / file.inertia.flexspline;
                let commanded =
                    Commanded { position: Angle::from_radians(0.2), acceleration, ..Commanded::default() };
                let demand = flat(&file).step(&commanded, 0.0);
                let wind_up = (0.2
                    + firmware_gear_params::<f64>(&file)
                        .unwrap()
                        .flexspline
                        .line
                        .build()
                        .unwrap()
                        .torsion(torque))
                    / r;
                assert!((demand.angle.to_radians() - wind_up).abs() < 1e-7, "{torque}: {demand:?}");
                assert_eq!(demand.velocity, 0.0);
            }
        }
    }

    /// The reference cancels the plant's kinematic error: r*theta + e(theta) = q.
    #[test]
    fn the_kinematic_error_cancels() {
        for file in arrangements() {
            let (ratio, mut flat) = (file.gear.signed_ratio(), flat(&file));
            let error = firmware_gear_params::<f64>(&file).unwrap().kinematic_error.build(ratio).unwrap();
            for k in 0..1000 {
                let q = Angle::from_radians(1e-3 * f64::from(k));
                let theta = flat.step(&Commanded { position: q, ..Commanded::default() }, 0.0).angle;
                let left = ratio.apply(theta).plus(error.at(theta).error).minus(q);
                assert!(left.abs() < 1e-9, "{k}: {left}");
            }
        }
    }

    /// The speed is the slope of the angle, the acceleration that of the speed.
    #[test]
    fn the_rates_are_those_of_the_angle() {
        let mut flat = flat(&GearFile::default_gear());
        let demands: Vec<_> = (0..2500)
            .map(|k| {
                crate::bench::scenario::Scenario::S3
                    .at(f64::from(k) * CONTROL_PERIOD, &crate::design::capability::Capability::default())
            })
            .map(|demand| flat.step(&Commanded::of(&demand.setpoint()), 0.0))
            .collect();
        let fastest = demands.iter().map(|demand| demand.velocity.abs()).fold(0.0, f64::max);
        let strongest = demands.iter().map(|demand| demand.acceleration.abs()).fold(0.0, f64::max);
        let (mut offset, mut slope) = (0.0, 0.0);
        for pair in demands.windows(3) {
            let travelled = pair[2].angle.minus(pair[0].angle) / (2.0 * CONTROL_PERIOD);
            offset = f64::max(offset, (travelled - pair[1].velocity).abs());
            slope +=
                ((pair[2].velocity - pair[0].velocity) / (2.0 * CONTROL_PERIOD) - pair[1].acceleration).abs();
        }
        // The line's knees, where the compliance jumps, are in it.
        assert!(offset < 0.02 * fastest, "{offset} of {fastest}");
        assert!(slope / 2500.0 < 0.02 * strongest, "{slope} of {strongest}");
    }
}
