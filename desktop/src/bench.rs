//! A joint on the bench: a plant that is off what its controller knows, its sensors, and a controller that closes
//! the loop every 0.1 ms.
//!
//! Each control period: the sensors are read, the controller answers, its torque acts on the plant for one
//! period. The motor's torque is what was commanded, and what is measured of it carries noise. An encoder gives the
//! count whose middle is nearest to the angle. Torques in N m, angles in rad.

use std::collections::VecDeque;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use strainwave::compensator::{Input, Output, Sensors, Shares};
use strainwave::flexspline::Flexspline;
use strainwave::{Angle, Error};

use crate::closed_loop::Controller;
use crate::divergence::RunError;
use crate::draw::Draw;
use crate::gear_file::GearFile;
use crate::joint::{CONTROL_PERIOD, firmware_gear_params};
use crate::plant::{CondensedMesh, Plant, PlantMesh, encoder_count};
use crate::scenario::Demand;

/// Which encoders the controller reads; motor torque it always does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorSet {
    /// The motor's alone.
    Motor,
    /// The motor's and the output's.
    Both,
}

impl SensorSet {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::Motor, Self::Both];

    /// What a gear file's joint has.
    pub fn of(file: &GearFile) -> Self {
        if file.sensors.output_encoder_bits.is_some() { Self::Both } else { Self::Motor }
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|set| set.name() == name)
    }

    /// The name, as in `motor`.
    pub fn name(self) -> &'static str {
        ["motor", "both"][self as usize]
    }
}

/// What a joint is put on the bench with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// The plant (see [`Draw::from_seed`]) and its noise.
    pub seed: u64,
    /// What the controller reads.
    pub sensors: SensorSet,
    /// Factor on the noise of the sensors: 2 doubles the deviation of the torques and takes the encoders' last bit.
    pub noise: f64,
}

impl Conditions {
    /// The sensors of a gear file as they are, on the plant of `seed`.
    pub fn of(file: &GearFile, seed: u64) -> Self {
        Self { seed, sensors: SensorSet::of(file), noise: 1.0 }
    }

    /// The plant's parameters.
    ///
    /// # Errors
    /// As [`firmware_gear_params`].
    pub fn plant(&self, file: &GearFile) -> Result<strainwave::gear::GearParams<f64>, Error> {
        Ok(Draw::from_seed(self.seed).apply(&firmware_gear_params(file)?))
    }
}

/// What a joint is asked to do.
pub trait Task {
    /// Length (s).
    fn duration(&self) -> f64;

    /// What is asked at `time` (s) of a joint of this rated torque (N m).
    fn at(&self, time: f64, rated_torque: f64) -> Demand;

    /// The wave generator is held by a brake.
    fn blocked(&self) -> bool {
        false
    }
}

/// An encoder of 2^bits counts a turn whose last counts may be lost in noise.
#[derive(Clone, Copy, Debug)]
struct EncoderModel {
    bits: u32,
    lost: u32,
}

impl EncoderModel {
    fn new(bits: u32, noise: f64) -> Self {
        Self { bits, lost: noise.log2().round().max(0.0) as u32 }
    }

    fn read(self, angle: Angle<f64>) -> u32 {
        let bits = self.bits - self.lost.min(self.bits);
        let half = std::f64::consts::PI / 2f64.powi(bits.cast_signed());
        encoder_count(angle.plus(half), bits) << (self.bits - bits)
    }
}

/// Counts of an encoder that arrive late, and not every period.
#[derive(Clone, Debug)]
struct LateEncoder {
    encoder: EncoderModel,
    /// By how many periods.
    delay: usize,
    /// Every how many.
    every: usize,
    /// Counts on their way, the newest last.
    coming: VecDeque<u32>,
    periods: usize,
}

impl LateEncoder {
    fn read(&mut self, angle: Angle<f64>) -> Option<u32> {
        self.coming.push_back(self.encoder.read(angle));
        let arrived = if self.coming.len() > self.delay { self.coming.pop_front() } else { None };
        let due = self.periods.is_multiple_of(self.every);
        self.periods += 1;
        arrived.filter(|_| due)
    }
}

/// The joint's sensors, with noise that repeats for the same seed.
#[derive(Clone, Debug)]
struct SensorModel {
    motor_encoder: EncoderModel,
    output_encoder: Option<LateEncoder>,
    motor_torque_noise: Normal<f64>,
    output_torque_noise: Option<Normal<f64>>,
    random: ChaCha8Rng,
}

impl SensorModel {
    fn new(file: &GearFile, conditions: &Conditions) -> Self {
        let factor = conditions.noise;
        let noise = |deviation: f64| {
            Normal::new(0.0, factor * deviation).expect("the gear file's noise is not negative")
        };
        let sensors = &file.sensors;
        let output_bits = sensors.output_bits();
        let output_encoder = LateEncoder {
            encoder: EncoderModel::new(output_bits, factor),
            delay: sensors.output_encoder_delay as usize,
            every: sensors.output_encoder_period as usize,
            coming: VecDeque::new(),
            periods: 0,
        };
        Self {
            motor_encoder: EncoderModel::new(sensors.motor_encoder_bits, factor),
            output_encoder: (conditions.sensors == SensorSet::Both).then_some(output_encoder),
            motor_torque_noise: noise(sensors.motor_torque_noise),
            output_torque_noise: sensors.output_torque.then(|| noise(sensors.output_torque_noise)),
            random: ChaCha8Rng::seed_from_u64(conditions.seed),
        }
    }

    fn read<F: Flexspline<f64>>(&mut self, plant: &Plant<F>, motor_torque: f64) -> Sensors<f32> {
        let random = &mut self.random;
        Sensors {
            motor_encoder: self.motor_encoder.read(plant.motor().angle),
            output_encoder: self
                .output_encoder
                .as_mut()
                .and_then(|encoder| encoder.read(plant.output().angle)),
            motor_torque: (motor_torque + self.motor_torque_noise.sample(random)) as f32,
            output_torque: self
                .output_torque_noise
                .map(|noise| (plant.last_torques().transmitted + noise.sample(random)) as f32),
        }
    }
}

/// All corrections on, friction by the gear file's share.
fn all_shares(file: &GearFile) -> Shares<f32> {
    Shares { friction: file.compensation.friction_share as f32, ..Shares::ALL }
}

/// Plant, sensors, and the torque that was last commanded.
#[derive(Clone)]
pub struct Bench<F: Flexspline<f64> = PlantMesh> {
    plant: Plant<F>,
    sensors: SensorModel,
    shares: Shares<f32>,
    rated_torque: f64,
    torque: f64,
}

impl Bench {
    /// A joint at rest, its plant the reference.
    ///
    /// # Errors
    /// As [`Plant::build`].
    pub fn build(file: &GearFile, conditions: &Conditions) -> Result<Self, Error> {
        Ok(Self::around(Plant::build(&conditions.plant(file)?)?, file, conditions))
    }
}

impl Bench<CondensedMesh> {
    /// A joint at rest, its plant the condensed one.
    ///
    /// # Errors
    /// As [`Plant::condensed`].
    pub fn condensed(file: &GearFile, conditions: &Conditions) -> Result<Self, Error> {
        Ok(Self::around(Plant::condensed(&conditions.plant(file)?)?, file, conditions))
    }
}

impl<F: Flexspline<f64>> Bench<F> {
    fn around(plant: Plant<F>, file: &GearFile, conditions: &Conditions) -> Self {
        Self {
            plant,
            sensors: SensorModel::new(file, conditions),
            shares: all_shares(file),
            rated_torque: file.gear.rated_torque,
            torque: 0.0,
        }
    }

    /// The plant as it is now.
    pub fn plant(&self) -> &Plant<F> {
        &self.plant
    }

    /// Goes through a task from where the joint is; `visit` sees the plant at the start of each period with what is
    /// asked and the controller's answer to it.
    ///
    /// # Errors
    /// The controller's, or a plant that diverges.
    pub fn go<C: Controller>(
        &mut self,
        task: &impl Task,
        controller: &mut C,
        mut visit: impl FnMut(usize, Demand, &Plant<F>, Output<f32>),
    ) -> Result<(), C::Error>
    where
        C::Error: From<RunError>,
    {
        for k in 0..periods(task) {
            let demand = task.at(k as f64 * CONTROL_PERIOD, self.rated_torque);
            let sensors = self.sensors.read(&self.plant, self.torque);
            let input = Input {
                sensors,
                command: demand.setpoint().into(),
                shares: self.shares.into(),
                elapsed: 0.0,
            };
            let answer = controller.step(&input)?;
            visit(k, demand, &self.plant, answer);
            self.torque = if task.blocked() { 0.0 } else { f64::from(answer.motor_torque) };
            self.advance(demand.load, task.blocked()).map_err(RunError::from)?;
        }
        Ok(())
    }

    fn advance(&mut self, load: f64, blocked: bool) -> Result<(), crate::divergence::Diverged> {
        if blocked { self.plant.step_blocked(load) } else { self.plant.step(self.torque, load) }
    }
}

/// Control periods of a task.
pub fn periods(task: &impl Task) -> usize {
    (task.duration() / CONTROL_PERIOD).round() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_encoder_gives_the_nearest_count() {
        let counts = |noise, share: f64| {
            let encoder = EncoderModel::new(4, noise);
            encoder.read(Angle::from_radians_f64(share * std::f64::consts::TAU / 16.0))
        };
        assert_eq!([-0.49, 0.0, 0.49, 0.51, 3.4, 15.6].map(|share| counts(1.0, share)), [0, 0, 0, 1, 3, 0]);
        assert_eq!([-0.9, 0.9, 1.1, 2.9, 15.1].map(|share| counts(2.0, share)), [0, 0, 2, 2, 0]);
    }

    #[test]
    fn a_late_and_slow_encoder_gives_old_counts_now_and_then() {
        let encoder = EncoderModel::new(4, 1.0);
        let mut late = LateEncoder { encoder, delay: 2, every: 3, coming: VecDeque::new(), periods: 0 };
        let read =
            (0..10).map(|k| late.read(Angle::from_radians_f64(f64::from(k) * std::f64::consts::TAU / 16.0)));
        let wanted = [None, None, None, Some(1), None, None, Some(4), None, None, Some(7)];
        assert_eq!(read.collect::<Vec<_>>(), wanted);
    }

    /// The same seed, the same noise; twice the factor, twice the noise.
    #[test]
    fn noise_repeats_and_scales() {
        let file = GearFile::default_gear();
        let read = |noise| {
            let conditions = Conditions { noise, ..Conditions::of(&file, 3) };
            let mut bench = Bench::condensed(&file, &conditions).unwrap();
            [(); 3].map(|()| bench.sensors.read(&bench.plant, 0.0).motor_torque)
        };
        assert_eq!(read(1.0), read(1.0));
        assert_eq!(read(2.0), read(1.0).map(|torque| 2.0 * torque));
    }

    #[test]
    fn the_controller_reads_the_encoders_of_its_set() {
        let file = GearFile::default_gear();
        for (sensors, wanted) in [(SensorSet::Motor, None), (SensorSet::Both, Some(0))] {
            let conditions = Conditions { sensors, ..Conditions::of(&file, 1) };
            let mut bench = Bench::condensed(&file, &conditions).unwrap();
            assert_eq!(bench.sensors.read(&bench.plant, 0.0).output_encoder, wanted);
        }
    }
}
