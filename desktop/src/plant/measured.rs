//! What the sensors of a file read along an open-loop run.
//!
//! A reading is that of the row's instant, every 0.1 ms. An encoder's counts are followed over whole revolutions as a controller does, from those of
//! the true angle at the start: `reading = angle at the start + sum of the changes of the count`, each the shortest way. Every sensor draws from
//! a stream of its own, so that one more or less changes no other. Units and signs as in [`crate::sensor`]; the error of a figure is that of
//! the reading against what the sensor would read without errors.

use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::gear::Motion;
use strainwave::{Angle, Error};

use crate::io::Figure;
use crate::io::log::{Drive, OpenLoop};
use crate::io::sensor_file::{EncoderSection, SensorFile};
use crate::plant::two_port::trajectory::Trajectory;
use crate::sensor::{
    Accelerometer, AnalogueState, Encoder, EncoderState, GaugeBridge, MotorCurrent, TorqueSensor,
};

/// True values of a row; none of what a model does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Truth {
    /// Motion of the motor.
    pub motor: Option<Motion<f64>>,
    /// Motion of the output, or of the joint of a link.
    pub output: Option<Motion<f64>>,
    /// Torque behind the gear, or of the joint of a link (N m).
    pub torque: Option<f64>,
    /// Torque of the motor (N m).
    pub motor_torque: Option<f64>,
    /// Specific force at the tip of a link, across it (m/s^2).
    pub specific_force: Option<f64>,
    /// Strain on a link at the place of the bridge.
    pub strain: Option<f64>,
}

/// A motion of the angle (rad) and its speed (rad/s).
pub fn motion(angle: f64, velocity: f64) -> Motion<f64> {
    Motion { angle: Angle::from_radians_f64(angle), velocity }
}

/// The motor's motion along an open-loop input.
pub struct MotorMotion {
    trajectory: Trajectory,
    first: f64,
    zero: f64,
}

impl MotorMotion {
    /// Of a gear's or a belt gear's input.
    pub fn of(input: &OpenLoop) -> Self {
        let zero = match &input.drive {
            Drive::Position(position) => position[0],
            Drive::Velocity(_) => 0.0,
        };
        let stamps = input.time.stamps();
        Self { trajectory: Trajectory::new(stamps, &input.drive), first: stamps[0], zero }
    }

    /// At the time of a row (s).
    pub fn at(&self, time: f64) -> Motion<f64> {
        let sample = self.trajectory.at(time - self.first);
        motion(self.zero + sample.angle, sample.velocity)
    }
}

/// An encoder whose counts are followed over whole revolutions.
#[derive(Clone, Debug)]
struct Followed {
    encoder: Encoder,
    state: EncoderState,
    /// Counts a revolution.
    counts: f64,
    /// Last count, and the angle that stands for it (rad).
    last: Option<(u32, f64)>,
}

impl Followed {
    fn build(section: &EncoderSection) -> Result<Self, Error> {
        let encoder = section.params().build(CONTROL_PERIOD)?;
        let counts = 2f64.powi(section.bits.cast_signed());
        Ok(Self { encoder, state: EncoderState::default(), counts, last: None })
    }

    fn step(&mut self, truth: Motion<f64>, random: &mut ChaCha8Rng) -> f64 {
        let count = self.encoder.step(&mut self.state, truth, random).count;
        let near = |angle: f64, change: f64| angle + change - TAU * ((change) / TAU).round();
        let shown = f64::from(count) * TAU / self.counts;
        let angle = match self.last {
            Some((last, angle)) => near(angle, shown - f64::from(last) * TAU / self.counts),
            None => near(truth.angle.to_radians(), shown - truth.angle.to_radians()),
        };
        self.last = Some((count, angle));
        angle
    }
}

/// A sensor, where it is, and what it remembers.
#[derive(Clone, Debug)]
enum Sensor {
    Motor(Followed),
    Output(Followed),
    Torque(TorqueSensor, AnalogueState),
    Current(MotorCurrent, AnalogueState),
    Acceleration(Accelerometer, AnalogueState),
    Bridge(GaugeBridge, AnalogueState),
}

impl Sensor {
    /// Reading and what it would be without errors; none of what a model does not have.
    fn step(&mut self, truth: &Truth, random: &mut ChaCha8Rng) -> Option<[f64; 2]> {
        let turned = |encoder: &mut Followed, motion: Motion<f64>, random: &mut ChaCha8Rng| {
            [encoder.step(motion, random), motion.angle.to_radians()]
        };
        Some(match self {
            Self::Motor(encoder) => turned(encoder, truth.motor?, random),
            Self::Output(encoder) => turned(encoder, truth.output?, random),
            Self::Torque(sensor, state) => [sensor.step(state, truth.torque?, random), truth.torque?],
            Self::Current(sensor, state) => {
                let torque = truth.motor_torque?;
                [sensor.step(state, torque, random), sensor.current(torque)]
            }
            Self::Acceleration(sensor, state) => {
                let force = truth.specific_force?;
                [sensor.step(state, force, random), force]
            }
            Self::Bridge(sensor, state) => {
                let strain = truth.strain?;
                [sensor.step(state, strain, random), sensor.voltage(strain)]
            }
        })
    }
}

/// A sensor of the file with its column.
#[derive(Clone, Debug)]
struct Column {
    /// Table of the file.
    name: &'static str,
    /// Ending of the column's name, and unit of the figure.
    unit: [&'static str; 2],
    sensor: Sensor,
    random: ChaCha8Rng,
    /// Sum of the squared errors, and of how many.
    squares: f64,
    rows: f64,
}

/// The sensors of a file along a run.
#[derive(Clone, Debug)]
pub struct Measurement {
    columns: Vec<Column>,
    missing: Vec<&'static str>,
}

impl Measurement {
    /// Those sensors of the file whose true value is in `sample`, the truth of any row.
    ///
    /// # Errors
    /// As a sensor's `build`; a file that was read has none.
    pub fn build(file: &SensorFile, sample: &Truth) -> Result<Self, Error> {
        let (mut columns, mut missing) = (Vec::new(), Vec::new());
        for (stream, (name, unit, there, sensor)) in sensors(file, sample)?.into_iter().enumerate() {
            let Some(sensor) = sensor else { continue };
            if !there {
                missing.push(name);
                continue;
            }
            let mut random = ChaCha8Rng::seed_from_u64(file.sensor_set.seed);
            random.set_stream(stream as u64);
            columns.push(Column { name, unit, sensor, random, squares: 0.0, rows: 0.0 });
        }
        Ok(Self { columns, missing })
    }

    /// Tables of the file for which the model has no true value.
    pub fn missing(&self) -> &[&'static str] {
        &self.missing
    }

    /// Names of the columns.
    pub fn columns(&self) -> Vec<String> {
        self.columns.iter().map(|column| format!("{}_{}", column.name, column.unit[0])).collect()
    }

    /// The readings of the next row, as many as there are columns.
    pub fn step(&mut self, truth: &Truth) -> Vec<f64> {
        let read = |column: &mut Column| {
            let [reading, ideal] = column.sensor.step(truth, &mut column.random)?;
            column.squares += (reading - ideal).powi(2);
            column.rows += 1.0;
            Some(reading)
        };
        self.columns.iter_mut().filter_map(read).collect()
    }

    /// Error of each sensor over the rows so far, rms.
    pub fn figures(&self) -> Vec<Figure> {
        let figure = |column: &Column| {
            let rms = (column.squares / column.rows.max(1.0)).sqrt();
            Figure::reported(format!("sim.sensor.{}.error.rms", column.name), rms, column.unit[1])
        };
        self.columns.iter().map(figure).collect()
    }
}

type Entry = (&'static str, [&'static str; 2], bool, Option<Sensor>);

/// Every table: its unit, whether the model has its true value, and its sensor where the file has one.
fn sensors(file: &SensorFile, sample: &Truth) -> Result<[Entry; 6], Error> {
    let encoder = |section: &Option<EncoderSection>| section.as_ref().map(Followed::build).transpose();
    let state = AnalogueState::default();
    let torque = file.torque_sensor.map(|it| it.build(CONTROL_PERIOD)).transpose()?;
    let current = file.motor_current.map(|it| it.build(CONTROL_PERIOD)).transpose()?;
    let acceleration = file.accelerometer.map(|it| it.build(CONTROL_PERIOD)).transpose()?;
    let bridge = file.gauge_bridge.map(|it| it.bridge.build(CONTROL_PERIOD)).transpose()?;
    let (motor, output) = (encoder(&file.motor_encoder)?, encoder(&file.output_encoder)?);
    Ok([
        ("motor_encoder", ["rad", "rad"], sample.motor.is_some(), motor.map(Sensor::Motor)),
        ("output_encoder", ["rad", "rad"], sample.output.is_some(), output.map(Sensor::Output)),
        ("torque_sensor", ["nm", "N m"], sample.torque.is_some(), torque.map(|it| Sensor::Torque(it, state))),
        (
            "motor_current",
            ["a", "A"],
            sample.motor_torque.is_some(),
            current.map(|it| Sensor::Current(it, state)),
        ),
        (
            "accelerometer",
            ["m_per_s2", "m/s^2"],
            sample.specific_force.is_some(),
            acceleration.map(|it| Sensor::Acceleration(it, state)),
        ),
        ("gauge_bridge", ["v", "V"], sample.strain.is_some(), bridge.map(|it| Sensor::Bridge(it, state))),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive() -> Truth {
        Truth {
            motor: Some(motion(0.0, 0.0)),
            output: Some(motion(0.0, 0.0)),
            torque: Some(0.0),
            motor_torque: Some(0.0),
            ..Truth::default()
        }
    }

    /// Two and a half revolutions either way: the reading follows, half a count and the late 50 us off.
    #[test]
    fn an_encoder_is_followed_over_whole_revolutions() {
        let mut file = SensorFile::example();
        file.motor_encoder = Some(EncoderSection { bits: 12, ..bare() });
        let mut measurement = Measurement::build(&file, &drive()).unwrap();
        for k in 0..4000 {
            let angle = 100.0 + 16.0 * (1.5e-3 * f64::from(k)).sin();
            let truth = Truth { motor: Some(motion(angle, 0.0)), ..drive() };
            let reading = measurement.step(&truth)[0];
            assert!((reading - angle).abs() <= 0.501 * TAU / 4096.0, "{k}: {reading} {angle}");
        }
        let figure = &measurement.figures()[0];
        assert!((figure.value / (TAU / 4096.0 / 12f64.sqrt()) - 1.0).abs() < 0.05, "{figure:?}");
    }

    fn bare() -> EncoderSection {
        toml::from_str("bits = 17").unwrap()
    }

    /// A sensor that is left out changes no other's readings.
    #[test]
    fn every_sensor_has_random_numbers_of_its_own() {
        let all = SensorFile::example();
        let mut fewer = all.clone();
        (fewer.motor_encoder, fewer.torque_sensor) = (None, None);
        let [mut all, mut fewer] = [all, fewer].map(|file| Measurement::build(&file, &drive()).unwrap());
        assert_eq!(all.missing(), ["accelerometer", "gauge_bridge"]);
        assert_eq!(
            all.columns(),
            ["motor_encoder_rad", "output_encoder_rad", "torque_sensor_nm", "motor_current_a"]
        );
        assert_eq!(fewer.columns(), ["output_encoder_rad", "motor_current_a"]);
        for _ in 0..100 {
            let (of_all, of_fewer) = (all.step(&drive()), fewer.step(&drive()));
            assert_eq!([of_all[1], of_all[3]], [of_fewer[0], of_fewer[1]]);
        }
    }
}
