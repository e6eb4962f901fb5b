//! The observer in scenario S8, with and without the torque of strain gauges.
//!
//! ```text
//! tau_s = tau + hysteresis(torsion(tau))          tau, sd the gauges' torque and standard deviation
//! ```
//!
//! The observer has the motor's encoder and the motor's torque, whose constant is up to 10 % off ([`super::torque_sensing`]), and no
//! encoder at the output. Gauges feel the shell alone: the torque of the hysteresis beside it is that of the gear's own model, driven by
//! the torsion that the gauges' torque makes. The reading goes in by its deviation
//! ([`strainwave::flexspline::GaugeTorque::for_observer`]): the observer's gains are for [`DESIGNED`], as a gear file declares it. Torques
//! in N m, in the firmware's precision.

use strainwave::Error;
use strainwave::compensator::estimate::observer::{GearCorrection, Measurement, Observer, ObserverState};
use strainwave::compensator::schedule::OBSERVER_PERIODS;
use strainwave::compensator::{Faults, RealTimeFlexspline, RealTimeGear};
use strainwave::flexspline::{TorqueGauges, TorqueGaugesState};
use strainwave::hysteresis::TorsionHysteresisState;

use super::torque_sensing::{Mean, Reading, Record, sensor, unjudged};
use crate::design::joint::joint_params;
use crate::io::gear_file::GearFile;

/// Gauges.
const GAUGES: usize = 4;
/// Deviation of the gauges' torque that the observer is designed for (N m): 1.5 % of the rated torque of size 25.
pub const DESIGNED: f64 = 1.0;

/// Errors of the estimated external torque of a seed over the judged part, rms (N m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExternalTorque {
    /// By motor encoder and motor torque alone.
    pub without: f64,
    /// With the gauges.
    pub with: f64,
}

/// Both errors.
///
/// # Errors
/// As [`sensor`] and [`joint_params`].
pub fn external_torque(file: &GearFile, record: &Record, seed: u64) -> Result<ExternalTorque, Error> {
    let error = |gauges: bool| {
        let mut file = file.clone();
        file.sensors.output_torque = gauges;
        file.sensors.output_torque_noise = DESIGNED;
        error(&file, record, seed, gauges.then(|| Gauges::build(&file)).transpose()?)
    };
    Ok(ExternalTorque { without: error(false)?, with: error(true)? })
}

fn error(file: &GearFile, record: &Record, seed: u64, mut gauges: Option<Gauges>) -> Result<f64, Error> {
    let mut joint = Joint::build(file)?;
    let (mut mean, mut motor_torque) = (Mean::default(), 0.0);
    for (period, (sample, read)) in record.samples().iter().zip(record.readings::<GAUGES>(seed)).enumerate() {
        motor_torque += read.motor_torque;
        let expected = joint.expected_torque();
        let torque = gauges.as_mut().map(|gauges| gauges.torque(&joint.gear, &read, expected));
        if period as u32 % OBSERVER_PERIODS != OBSERVER_PERIODS - 1 {
            continue;
        }
        joint.step(&Measurement {
            motor: sample.motor_angle,
            motor_speed: 0.0,
            reads_output: false,
            period: OBSERVER_PERIODS as f32 * joint.dt,
            motor_torque: core::mem::take(&mut motor_torque) / OBSERVER_PERIODS as f32,
            output_torque: torque,
        });
        if period >= unjudged() {
            mean.take(f64::from(joint.state.external_torque()) - sample.load);
        }
    }
    Ok(mean.root())
}

/// The observer of a joint that is the gear file's.
struct Joint {
    gear: RealTimeGear<f32>,
    observer: Observer<f32>,
    state: ObserverState<f32>,
    dt: f32,
}

impl Joint {
    fn build(file: &GearFile) -> Result<Self, Error> {
        let joint = joint_params::<f32>(file)?;
        let flexspline = RealTimeFlexspline::build(&joint.gear.flexspline, joint.gear.rated_torque)?;
        let gear = joint.gear.build(flexspline, joint.dt)?;
        let observer = joint.observer.build(&joint.gear, &joint.limits, &joint.tolerances, joint.dt)?;
        let state = observer.rest();
        Ok(Self { gear, observer, state, dt: joint.dt })
    }

    fn expected_torque(&self) -> f32 {
        self.observer.transmitted(&self.state)
    }

    fn step(&mut self, measured: &Measurement<f32>) {
        let (correction, faults) = (GearCorrection::default(), &mut Faults::default());
        self.observer.step(&self.gear, &mut self.state, measured, &correction, false, faults);
    }
}

/// The sensor, and the hysteresis beside the shell.
struct Gauges {
    sensor: TorqueGauges<f32, GAUGES>,
    state: TorqueGaugesState<f32, GAUGES>,
    hysteresis: TorsionHysteresisState<f32, { strainwave::compensator::HYSTERESIS_MEMORY }>,
}

impl Gauges {
    fn build(file: &GearFile) -> Result<Self, Error> {
        let sensor = sensor(file)?;
        Ok(Self { sensor, state: sensor.rest(), hysteresis: TorsionHysteresisState::default() })
    }

    /// Torque through the flexspline for an observer that expects `expected`.
    fn torque(&mut self, gear: &RealTimeGear<f32>, read: &Reading<GAUGES>, expected: f32) -> f32 {
        let mut torque =
            self.sensor.step(&mut self.state, &read.strains, read.wave_generator, Some(read.reference));
        let torsion = gear.flexspline().torsion(torque.torque);
        torque.torque += gear.hysteresis().step(&mut self.hysteresis, torsion).torque;
        torque.for_observer(DESIGNED as f32, expected)
    }
}
