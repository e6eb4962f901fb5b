//! The baselines: what a good joint controller does today, in f64 on the desktop.
//!
//! | baseline | has | reads |
//! | --- | --- | --- |
//! | B0 | the motor-side cascade alone (`cascade.rs`) | motor encoder |
//! | B1 | and a rigid joint's feed-forward: inertia, Coulomb and viscous friction (`rigid_body.rs`) | motor encoder |
//! | B2 | and the stored kinematic error and the wind-up in advance (`flat.rs`) | motor encoder |
//! | B3 | B2 and the output's error fed back by P, I and D (`dual_loop.rs`) | both encoders |
//!
//! Each has gains of its own ([`gains`]), found by one optimiser with one objective ([`crate::tune`]) and stored in the gear
//! file. None adapts, none observes. B3 without an output encoder that reads is B2 with B3's gains.

mod cascade;
mod dual_loop;
mod flat;
pub mod gains;
mod motor_side;
pub(crate) mod rigid_body;

use strainwave::compensator::{Command, Input, Output, Setpoint};
use strainwave::{Angle, Error, Ratio};

use crate::bench::controller::Controller;
use crate::design::joint::firmware_gear_params;
use crate::design::wave_generator::at_wave_generator;
pub use crate::io::gear_file::{BaselineGains, GAINS, Gain, Kind};
use crate::io::gear_file::{GearFile, SensorSet};
use crate::plant::divergence::RunError;
use cascade::{Cascade, Demand};
use dual_loop::DualLoop;
use flat::Flat;
use motor_side::MotorSide;
use rigid_body::RigidBody;

/// A baseline controller.
#[derive(Clone)]
pub struct Baseline {
    belt: Option<MotorSide>,
    ratio: Ratio,
    cascade: Cascade,
    advance: Advance,
    output: Option<DualLoop>,
}

/// Feed-forward of a baseline.
#[derive(Clone)]
enum Advance {
    Nothing,
    RigidBody(Box<RigidBody>),
    Flat(Box<Flat>),
}

/// The output's setpoint, in f64.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Commanded {
    pub position: Angle<f64>,
    /// (rad/s)
    pub velocity: f64,
    /// (rad/s^2)
    pub acceleration: f64,
    /// (rad/s^3)
    pub jerk: f64,
    /// (rad/s^4)
    pub snap: f64,
}

impl Commanded {
    fn of(setpoint: &Setpoint<f32>) -> Self {
        let Angle { counts, rest } = setpoint.position;
        Self {
            position: Angle { counts, rest: rest.into() },
            velocity: setpoint.velocity.into(),
            acceleration: setpoint.acceleration.into(),
            jerk: setpoint.jerk.into(),
            snap: setpoint.snap.into(),
        }
    }

    /// It neither moves nor begins to.
    fn rests(&self) -> bool {
        self.velocity == 0.0 && self.acceleration == 0.0
    }
}

impl Baseline {
    /// A baseline with the gains that the gear file has for it.
    ///
    /// # Errors
    /// As [`Baseline::with_gains`].
    pub fn build(file: &GearFile, kind: Kind) -> Result<Self, Error> {
        Self::with_gains(file, kind, &BaselineGains::of(file, kind))
    }

    /// A baseline with these gains.
    ///
    /// # Errors
    /// As [`firmware_gear_params`] and the builds of what it is made of.
    pub fn with_gains(file: &GearFile, kind: Kind, gains: &BaselineGains) -> Result<Self, Error> {
        let belt = MotorSide::of(file);
        let file = &at_wave_generator(file);
        let (ratio, gear) = (file.gear.signed_ratio(), firmware_gear_params(file)?);
        let body = || RigidBody::new(ratio, &gear, gains.friction_gain);
        Ok(Self {
            belt,
            ratio,
            cascade: Cascade::build(file, gains)?,
            advance: match kind {
                Kind::B0 => Advance::Nothing,
                Kind::B1 => Advance::RigidBody(Box::new(body())),
                Kind::B2 | Kind::B3 => Advance::Flat(Box::new(Flat::build(ratio, &gear, body())?)),
            },
            output: (kind == Kind::B3).then(|| DualLoop::build(file, &gear, gains)).transpose()?,
        })
    }

    /// B0: the cascade alone.
    ///
    /// # Errors
    /// As [`Baseline::build`].
    pub fn b0(file: &GearFile) -> Result<Self, Error> {
        Self::build(file, Kind::B0)
    }

    /// B1: B0 with the feed-forward of a rigid joint.
    ///
    /// # Errors
    /// As [`Baseline::build`].
    pub fn b1(file: &GearFile) -> Result<Self, Error> {
        Self::build(file, Kind::B1)
    }

    /// B2: B1 with the stored kinematic error and the wind-up put in advance.
    ///
    /// # Errors
    /// As [`Baseline::build`].
    pub fn b2(file: &GearFile) -> Result<Self, Error> {
        Self::build(file, Kind::B2)
    }

    /// B3: B2 with the output's error fed back; it reads [`SensorSet::Both`].
    ///
    /// # Errors
    /// As [`Baseline::build`].
    pub fn b3(file: &GearFile) -> Result<Self, Error> {
        Self::build(file, Kind::B3)
    }

    /// Every baseline that these sensors allow, by name.
    ///
    /// # Errors
    /// As [`Baseline::build`].
    pub fn all(file: &GearFile, sensors: SensorSet) -> Result<Vec<(&'static str, Self)>, Error> {
        Kind::ALL
            .into_iter()
            .filter(|kind| sensors == SensorSet::Both || kind.sensors() == SensorSet::Motor)
            .map(|kind| Ok((kind.name(), Self::build(file, kind)?)))
            .collect()
    }

    /// Torque command for one control period (N m); it follows positions alone.
    pub fn step(&mut self, input: &Input<f32>) -> f64 {
        let raw = input.sensors.motor_encoder;
        let raw = self.belt.as_mut().map_or(raw, |belt| belt.count(raw));
        let motor = self.cascade.read(raw, input.elapsed);
        let Command::Position(setpoint) = input.command else { return 0.0 };
        let commanded = Commanded::of(&setpoint);
        let limited = self.cascade.limited();
        let shift = match &mut self.output {
            Some(output) => output.step(&commanded, input.sensors.output_encoder, limited),
            None => 0.0,
        };
        let demand = self.advance.step(self.ratio, &commanded, shift);
        let torque = self.cascade.step(&motor, &demand);
        self.belt.as_ref().map_or(torque, |belt| belt.torque(torque))
    }
}

impl Kind {
    /// Sensors that it needs.
    pub fn sensors(self) -> SensorSet {
        if self == Self::B3 { SensorSet::Both } else { SensorSet::Motor }
    }
}

impl Advance {
    /// Reference of the motor for a setpoint that is shifted by `shift` (rad).
    fn step(&mut self, ratio: Ratio, commanded: &Commanded, shift: f64) -> Demand {
        let torque = match self {
            Self::Flat(flat) => return flat.step(commanded, shift),
            Self::RigidBody(body) => body.torque(commanded),
            Self::Nothing => 0.0,
        };
        Demand {
            angle: ratio.to_motor(commanded.position.plus(shift)),
            velocity: commanded.velocity * f64::from(ratio.n()),
            acceleration: 0.0,
            torque,
        }
    }
}

impl Controller for Baseline {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        let motor_torque = Baseline::step(self, input) as f32;
        // It estimates nothing, in every period.
        Ok(Output { motor_torque, observed: true, ..Output::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::closed_loop::go_on;
    use crate::bench::scenario::Scenario;
    use crate::bench::{Bench, Conditions};
    use crate::io::gear_file::Arrangement;

    fn file(arrangement: Arrangement) -> GearFile {
        let mut file = GearFile::default_gear();
        file.gear.arrangement = arrangement;
        file
    }

    /// The cascade turns the motor against the setpoint's sign when r is negative.
    #[test]
    fn the_motor_is_driven_to_where_the_output_should_be() {
        for (arrangement, sign) in
            [(Arrangement::CircularSplineFixed, -1.0), (Arrangement::FlexsplineFixed, 1.0)]
        {
            for kind in Kind::ALL {
                let mut baseline = Baseline::build(&file(arrangement), kind).unwrap();
                let setpoint = Setpoint { position: Angle::from_radians(1e-3), ..Setpoint::default() };
                let input = Input { command: setpoint.into(), ..Input::default() };
                let torque = baseline.step(&input);
                assert!(torque * sign > 0.0, "{kind:?}: {torque}");
            }
        }
    }

    #[test]
    fn the_sensors_decide_which_baselines_there_are() {
        let file = GearFile::default_gear();
        let names = |sensors| {
            let all = Baseline::all(&file, sensors).unwrap();
            all.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
        };
        assert_eq!(names(SensorSet::Motor), ["b0", "b1", "b2"]);
        assert_eq!(names(SensorSet::Both), ["b0", "b1", "b2", "b3"]);
    }

    fn rms(file: &GearFile, scenario: Scenario, baseline: &Baseline, sensors: SensorSet) -> f64 {
        let conditions = Conditions { sensors, ..Conditions::of(file, 0) };
        let mut bench = Bench::condensed(file, &conditions).unwrap();
        go_on(&mut bench, scenario, &mut baseline.clone(), |_| ()).unwrap().rms
    }

    /// With the same gains, to the bit.
    #[test]
    fn b3_without_an_output_encoder_is_b2() {
        let file = GearFile::default_gear();
        let gains = BaselineGains::of(&file, Kind::B2);
        let [b2, b3] = [Kind::B2, Kind::B3].map(|kind| Baseline::with_gains(&file, kind, &gains).unwrap());
        let of = |baseline| rms(&file, Scenario::S3, baseline, SensorSet::Motor);
        assert_eq!(of(&b2), of(&b3));
    }

    /// On the plant that they know, each is better than the one before where its part counts.
    #[test]
    fn what_each_adds_helps() {
        let mut file = GearFile::default_gear();
        file.baselines = None;
        let error = |kind: Kind, scenario| {
            rms(&file, scenario, &Baseline::build(&file, kind).unwrap(), kind.sensors())
        };
        let crawl = Kind::ALL.map(|kind| error(kind, Scenario::S4));
        assert!(crawl[2] < 0.2 * crawl[1], "{crawl:?}");
        let load = Kind::ALL.map(|kind| error(kind, Scenario::S5));
        assert!(load[3] < 0.5 * load[2], "{load:?}");
        let reversal = Kind::ALL.map(|kind| error(kind, Scenario::S2));
        assert!(reversal[2] < 0.5 * reversal[1] && reversal[3] < reversal[2], "{reversal:?}");
    }
}
