//! A joint on the bench: a plant that is off what its controller knows, its sensors, and a controller that closes
//! the loop every 0.1 ms.
//!
//! Each control period: the sensors are read, the controller answers, its torque acts on the plant for one
//! period. The motor's torque is the drive's response to the command, and its measurement is noisy. An encoder
//! gives the count whose middle is nearest to the angle ([`crate::sensor::encoder`]). Torques in N m, angles in rad.
//!
//! With a jittering clock ([`crate::plant::clock`]) the plant stays on its micro-steps: it goes to the last one before
//! the instant, the encoders are read a part of a micro-step in advance at constant speed, and the new torque acts from there.

use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use strainwave::Error;
use strainwave::compensator::{CompensationGains, Input, Output, Sensors, Status};
use strainwave::flexspline::Flexspline;
use strainwave::gear::Motion;

use crate::bench::controller::Controller;
use crate::bench::task::{Demand, Task, periods};
use crate::design::belt::driving_belt;
use crate::design::capability::Capability;
use crate::design::joint::firmware_gear_params;
use crate::design::wave_generator::at_wave_generator;
use crate::io::gear_file::{GearFile, SensorSet};
use crate::plant::box_sample::BoxSample;
use crate::plant::clock::{Clock, ClockParams};
use crate::plant::divergence::RunError;
use crate::plant::driving_belt::{DrivingBeltParams, Spans};
use crate::plant::payload::Payload;
use crate::plant::sample::PlantSample;
use crate::plant::{CondensedMesh, Plant, PlantMesh, plant_params};
use crate::sensor::{
    AnalogueState, Encoder, EncoderErrors, EncoderParams, EncoderState, MotorCurrent, MotorCurrentParams,
    TorqueSensor, TorqueSensorParams,
};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Test conditions of a joint on the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// The plant (see [`BoxSample::from_seed`]) and its noise.
    pub seed: u64,
    /// Sensors of the controller.
    pub sensors: SensorSet,
    /// Factor on the noise of the sensors: 2 doubles the deviation of the torques and takes the encoders' last bit.
    pub noise: f64,
    /// Which noise on this plant: 0 is the seed's own.
    pub realisation: u32,
    /// Of a plant behind a belt.
    pub spans: Spans,
}

impl Conditions {
    /// The sensors of a gear file as they are, on the plant of `seed`.
    pub fn of(file: &GearFile, seed: u64) -> Self {
        Self { seed, sensors: SensorSet::of(file), noise: 1.0, realisation: 0, spans: Spans::default() }
    }

    /// The plant's parameters.
    ///
    /// # Errors
    /// As [`firmware_gear_params`].
    pub fn plant(&self, file: &GearFile) -> Result<strainwave::gear::GearParams<f64>, Error> {
        Ok(BoxSample::from_seed(self.seed).apply(&firmware_gear_params(file)?))
    }

    /// The plant's belt.
    fn belt(&self, file: &GearFile) -> Option<DrivingBeltParams> {
        driving_belt(file).map(|belt| BoxSample::from_seed(self.seed).apply_to_belt(belt))
    }
}

/// The joint's sensors, with noise that repeats for the same seed.
#[derive(Clone, Debug)]
pub(crate) struct SensorModel {
    motor_encoder: (Encoder, EncoderState),
    output_encoder: Option<(Encoder, EncoderState)>,
    motor_current: (MotorCurrent, AnalogueState),
    torque_sensor: Option<(TorqueSensor, AnalogueState)>,
    random: ChaCha8Rng,
    encoder_random: ChaCha8Rng,
}

/// Purposes of a bench's random numbers; each has a stream of its own, and other noise on the same plant others.
#[derive(Clone, Copy)]
enum Purpose {
    Torque,
    Encoders,
    Clock,
}

fn random(seed: u64, realisation: u32, purpose: Purpose) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(3 * u64::from(realisation) + purpose as u64);
    random
}

/// Bits of an encoder that noise takes: a factor of 2 the last one, of 4 the last two.
fn lost_bits(noise: f64, bits: u32) -> u32 {
    (noise.log2().round().max(0.0) as u32).min(bits - 1)
}

/// Half width of the evenly distributed noise of this standard deviation (rad), in counts.
fn half_width(deviation: f64, bits: u32) -> f64 {
    3f64.sqrt() * deviation / TAU * f64::from(bits).exp2()
}

impl SensorModel {
    /// Of the encoders of a gear file with these errors.
    pub(crate) fn new(file: &GearFile, conditions: &Conditions, errors: &[EncoderErrors; 2]) -> Self {
        Self::build(file, conditions, errors).expect("a gear file's sensors are in range")
    }

    fn build(file: &GearFile, conditions: &Conditions, errors: &[EncoderErrors; 2]) -> Result<Self, Error> {
        let (sensors, factor) = (&file.sensors, conditions.noise);
        let encoder = |bits: u32, noise: Option<f64>, errors: EncoderErrors| EncoderParams {
            lost_bits: lost_bits(factor, bits),
            errors: EncoderErrors {
                noise: errors.noise.max(half_width(noise.unwrap_or(0.0), bits)),
                ..errors
            },
            ..EncoderParams::of_bits(bits)
        };
        let output_encoder = EncoderParams {
            delay: f64::from(sensors.output_encoder_delay) * CONTROL_PERIOD,
            every: sensors.output_encoder_period as usize,
            ..encoder(sensors.output_bits(), sensors.output_encoder_noise, errors[1])
        };
        let motor_current = MotorCurrentParams::as_torque(factor * sensors.motor_torque_noise);
        let torque_sensor = TorqueSensorParams::of_noise(factor * sensors.output_torque_noise);
        let read = conditions.sensors == SensorSet::Both;
        let random = |purpose| random(conditions.seed, conditions.realisation, purpose);
        Ok(Self {
            motor_encoder: started(
                encoder(sensors.motor_encoder_bits, sensors.motor_encoder_noise, errors[0])
                    .build(CONTROL_PERIOD)?,
            ),
            output_encoder: read.then(|| output_encoder.build(CONTROL_PERIOD)).transpose()?.map(started),
            motor_current: started(motor_current.build(CONTROL_PERIOD)?),
            torque_sensor: sensors
                .output_torque
                .then(|| torque_sensor.build(CONTROL_PERIOD))
                .transpose()?
                .map(started),
            random: random(Purpose::Torque),
            encoder_random: random(Purpose::Encoders),
        })
    }

    /// As they read `advance` (s) after the plant's last micro-step.
    pub(crate) fn read<F: Flexspline<f64>>(&mut self, plant: &Plant<F>, advance: f64) -> Sensors<f32> {
        let (random, encoder_random) = (&mut self.random, &mut self.encoder_random);
        let advanced = |motion: Motion<f64>| {
            let by = motion.velocity * advance;
            Motion { angle: if advance > 0.0 { motion.angle.plus(by) } else { motion.angle }, ..motion }
        };
        let (encoder, state) = &mut self.motor_encoder;
        let motor_encoder = encoder.step(state, advanced(plant.motor()), encoder_random).count;
        let output_encoder = self.output_encoder.as_mut().and_then(|(encoder, state)| {
            encoder.step(state, advanced(plant.output()), encoder_random).new_count()
        });
        let (sensor, state) = &mut self.motor_current;
        let motor_torque = sensor.step(state, plant.measured_motor_torque(), random) as f32;
        let output_torque = self
            .torque_sensor
            .as_mut()
            .map(|(sensor, state)| sensor.step(state, plant.last_torques().transmitted, random) as f32);
        Sensors { motor_encoder, output_encoder, motor_torque, output_torque }
    }
}

/// A sensor before its first sample.
fn started<M, S: Default>(sensor: M) -> (M, S) {
    (sensor, S::default())
}

/// All corrections on, friction by the gear file's gain.
pub(crate) fn all_gains(file: &GearFile) -> CompensationGains<f32> {
    CompensationGains { friction: file.compensation.friction_gain as f32, ..CompensationGains::ALL }
}

/// Plant, sensors, clock, and the controller's last answer.
#[derive(Clone)]
pub struct Bench<F: Flexspline<f64> = PlantMesh> {
    plant: Plant<F>,
    sensors: SensorModel,
    clock: Clock,
    /// Micro-steps by which the plant is off the clock's whole periods.
    offset: i64,
    gains: CompensationGains<f32>,
    capability: Capability,
    last: Output<f32>,
}

impl Bench {
    /// A joint at rest, its plant the reference.
    ///
    /// # Errors
    /// As [`Plant::build`].
    pub fn build(file: &GearFile, conditions: &Conditions) -> Result<Self, Error> {
        Self::loaded(file, conditions, &Payload::NONE)
    }

    /// The same with a payload that the controller is not told.
    ///
    /// # Errors
    /// As [`Plant::build`].
    pub fn loaded(file: &GearFile, conditions: &Conditions, payload: &Payload) -> Result<Self, Error> {
        let params = payload.on(&conditions.plant(file)?);
        let plant = Plant::between(&plant_params(&params), &payload.sides())?;
        Self::around(plant, file, conditions)
    }

    /// The same of a plant that its controller does not know; the seed is the plant's.
    ///
    /// # Errors
    /// As [`Plant::build`].
    pub fn of(sample: &PlantSample, conditions: &Conditions) -> Result<Self, Error> {
        let plant = Plant::between(&sample.plant_params(), &sample.sides)?;
        Ok(Self::of_sample(plant, sample, conditions))
    }
}

impl Bench<CondensedMesh> {
    /// A joint at rest, its plant the condensed one.
    ///
    /// # Errors
    /// As [`Plant::condensed`].
    pub fn condensed(file: &GearFile, conditions: &Conditions) -> Result<Self, Error> {
        Self::around(Plant::condensed(&conditions.plant(file)?)?, file, conditions)
    }

    /// The same of a plant that its controller does not know; the seed is the plant's.
    ///
    /// # Errors
    /// As [`Plant::condensed`].
    pub fn condensed_of(sample: &PlantSample, conditions: &Conditions) -> Result<Self, Error> {
        let plant = Plant::condensed_between(&sample.plant_params(), &sample.sides)?;
        Ok(Self::of_sample(plant, sample, conditions))
    }
}

impl<F: Flexspline<f64>> Bench<F> {
    fn around(plant: Plant<F>, file: &GearFile, conditions: &Conditions) -> Result<Self, Error> {
        let plant = match conditions.belt(file) {
            Some(belt) => plant.driven_by(&belt, conditions.spans)?,
            None => plant,
        };
        Ok(Self::with(plant, file, conditions, &Default::default(), ClockParams::default()))
    }

    fn of_sample(plant: Plant<F>, sample: &PlantSample, conditions: &Conditions) -> Self {
        let conditions = Conditions { seed: sample.seed, ..*conditions };
        Self::with(plant, &sample.known, &conditions, &sample.encoders, sample.clock)
    }

    fn with(
        plant: Plant<F>,
        file: &GearFile,
        conditions: &Conditions,
        errors: &[EncoderErrors; 2],
        clock: ClockParams,
    ) -> Self {
        Self {
            plant,
            sensors: SensorModel::new(file, conditions, errors),
            clock: Clock::new(clock, random(conditions.seed, conditions.realisation, Purpose::Clock)),
            offset: 0,
            gains: all_gains(file),
            capability: Capability::of(&at_wave_generator(file)),
            last: Output::default(),
        }
    }

    /// The plant as it is now.
    pub fn plant(&self) -> &Plant<F> {
        &self.plant
    }

    /// Goes through a task from where the joint is; `visit` sees the plant at the start of each period with the
    /// demand and the controller's output, the last one where it missed its step.
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
        let dt = self.plant.micro_step_time();
        for k in 0..periods(task) {
            let time = k as f64 * CONTROL_PERIOD;
            let tick = self.clock.tick();
            // By so much the step is after the plant's last micro-step.
            let advance = tick.offset - self.offset as f64 * dt;
            if let Some(elapsed) = tick.elapsed {
                let demand = task.at(time + tick.offset, &self.capability);
                let input = Input {
                    sensors: self.sensors.read(&self.plant, advance),
                    command: demand.setpoint().into(),
                    gains: self.gains.into(),
                    elapsed: elapsed as f32,
                    setpoint_age: 0.0,
                    status: if task.blocked() { Status::DRIVE_OFF } else { Status::FINE },
                };
                self.last = controller.step(&input)?;
            }
            let demand = task.at(time + self.offset as f64 * dt, &self.capability);
            visit(k, demand, &self.plant, self.last);
            if tick.elapsed.is_some() && !task.blocked() {
                self.plant.command(f64::from(self.last.motor_torque), advance / dt);
            }
            self.advance(demand.load, task.blocked()).map_err(RunError::from)?;
        }
        Ok(())
    }

    /// To the last micro-step before the clock's next instant.
    fn advance(&mut self, load: f64, blocked: bool) -> Result<(), crate::plant::divergence::Diverged> {
        let next = (self.clock.advance() / self.plant.micro_step_time()).floor() as i64;
        if blocked {
            return self.plant.step_blocked(load);
        }
        let steps = self.plant.micro_steps().cast_signed() as i64 + next - self.offset;
        self.offset = next;
        self.plant.go_on(steps.unsigned_abs() as usize, load)
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal};

    use super::*;
    use crate::sensor::encoder::encoder_count;

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

    /// Torque and a normal number of the joint's stream each, the motor's first; of the encoders the nearest count.
    #[test]
    fn errors_of_the_bench_are_those_of_its_gear_file_bit_for_bit() {
        let mut file = GearFile::default_gear();
        file.sensors.output_torque = true;
        let conditions = Conditions { sensors: SensorSet::Both, ..Conditions::of(&file, 7) };
        let mut bench = Bench::condensed(&file, &conditions).unwrap();
        let mut drawn = random(7, 0, Purpose::Torque);
        for k in 0..50 {
            bench.plant.command(0.01 * f64::from(k), 0.0);
            bench.plant.go_on(4, 0.0).unwrap();
            let plant = bench.plant.clone();
            let mut noisy = |torque: f64, deviation| {
                (torque + Normal::new(0.0, deviation).unwrap().sample(&mut drawn)) as f32
            };
            let motor_torque = noisy(plant.measured_motor_torque(), file.sensors.motor_torque_noise);
            let output_torque = noisy(plant.last_torques().transmitted, file.sensors.output_torque_noise);
            let count = |angle: strainwave::Angle<f64>, bits: u32| {
                encoder_count(angle.plus(std::f64::consts::PI / 2f64.powi(bits.cast_signed())), bits)
            };
            let expected = Sensors {
                motor_encoder: count(plant.motor().angle, file.sensors.motor_encoder_bits),
                output_encoder: Some(count(plant.output().angle, file.sensors.output_bits())),
                motor_torque,
                output_torque: Some(output_torque),
            };
            assert_eq!(bench.sensors.read(&plant, 0.0), expected, "{k}");
        }
    }

    #[test]
    fn the_controller_reads_the_encoders_of_its_set() {
        let file = GearFile::default_gear();
        for (sensors, expected) in [(SensorSet::Motor, None), (SensorSet::Both, Some(0))] {
            let conditions = Conditions { sensors, ..Conditions::of(&file, 1) };
            let mut bench = Bench::condensed(&file, &conditions).unwrap();
            assert_eq!(bench.sensors.read(&bench.plant, 0.0).output_encoder, expected);
        }
    }

    use crate::bench::baseline::Baseline;
    use crate::bench::controller::{Controller, HostCompensator};
    use crate::bench::scenario::Scenario;
    use crate::design::joint::joint_params;
    use crate::plant::unknowns::Which;

    fn sample(row: &str, seed: u64) -> PlantSample {
        PlantSample::of(&GearFile::default_gear(), Which::named(row).unwrap(), seed).unwrap()
    }

    fn bench(sample: &PlantSample) -> Bench<CondensedMesh> {
        Bench::condensed_of(sample, &Conditions::of(&sample.known, sample.seed)).unwrap()
    }

    /// Output and torsion (rad), a row each control period.
    fn motion<C: Controller<Error = RunError>>(
        bench: &mut Bench<CondensedMesh>,
        controller: &mut C,
    ) -> Vec<[f64; 2]> {
        let mut rows = Vec::new();
        let visit = |_, _, plant: &Plant<CondensedMesh>, _| {
            rows.push([plant.output().angle.to_radians(), plant.last_torques().torsion]);
        };
        bench.go(&Scenario::S3, controller, visit).unwrap();
        rows
    }

    /// Bit for bit, noise and all.
    #[test]
    fn a_plant_of_the_box_alone_moves_as_the_plant_of_before() {
        let file = GearFile::default_gear();
        let controller = HostCompensator::build(&joint_params(&file).unwrap()).unwrap();
        for seed in [0, 3] {
            let mut before = Bench::condensed(&file, &Conditions::of(&file, seed)).unwrap();
            let before = motion(&mut before, &mut controller.clone());
            assert_eq!(motion(&mut bench(&sample("box", seed)), &mut controller.clone()), before);
        }
    }

    /// Times between its steps, of a cascade that answers.
    struct Watch(Baseline, Vec<f64>);

    impl Controller for Watch {
        type Error = RunError;

        fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
            self.1.push(input.elapsed.into());
            Controller::step(&mut self.0, input)
        }
    }

    /// The controller gets the true time, and the plant has gone just as far whatever the clock does.
    #[test]
    fn a_clock_that_is_off_keeps_the_time() {
        let file = GearFile::default_gear();
        let b0 = Baseline::b0(&file).unwrap();
        let exact = motion(&mut bench(&sample("box", 5)), &mut b0.clone());
        for row in ["time.jitter", "time.missed"] {
            let mut watch = Watch(b0.clone(), Vec::new());
            let moved = motion(&mut bench(&sample(row, 5)), &mut watch);
            let elapsed: f64 = watch.1.iter().sum();
            assert!((elapsed - Scenario::S3.duration()).abs() < 3.0 * CONTROL_PERIOD, "{row}: {elapsed}");
            assert!(watch.1.iter().any(|elapsed| (elapsed - CONTROL_PERIOD).abs() > 1e-5));
            let offset = exact.iter().zip(&moved).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
            assert!(offset > 0.0 && offset < 1e-3, "{row}: {offset}");
        }
    }

    /// Whatever is in front of the gear and behind it, the power through the gear closes.
    #[test]
    fn the_power_balance_closes_between_any_sides() {
        let b0 = Baseline::b0(&GearFile::default_gear()).unwrap();
        let mut ideal = bench(&sample("box", 5));
        motion(&mut ideal, &mut b0.clone());
        for row in [
            "load.flexible",
            "load.backlash",
            "load.gravity",
            "drive.delay",
            "motor.cogging",
            "friction.dahl",
        ] {
            let mut bench = bench(&sample(row, 5));
            motion(&mut bench, &mut b0.clone());
            let (ideal, imbalance) = (ideal.plant().imbalance(), bench.plant().imbalance());
            assert!(imbalance < 3.0 * ideal.max(1e-3), "{row}: {imbalance}, {ideal} without");
        }
    }
}
