//! Scenario S8: torque by strain gauges on the flexspline while the wave generator reverses, 5 to 500 rad/s, and the torque
//! swings by the rated one.
//!
//! ```text
//! omega_wg    from each of [`SPEEDS`] to the next by half a cosine over [`REVERSAL`], held for [`HELD`]
//! tau_load    = J_fs*r*domega_wg/dt - tau_rated*sin(2*pi*f*t)*(1 - cos(pi*min(t/0.2 s, 1)))/2
//! tau_ref     = ((1 + k)*tau_wg - J_wg*domega_wg/dt - (1 + c)*(Fc*sign(omega_wg) + Fv*omega_wg) + noise)/r
//! ```
//!
//! The external torque carries the output's inertia through the reversals and swings on top of it. The plant is the two-port of the gear file
//! with the literal 36 x 4 mesh, hysteresis, kinematic error and friction: its links are where the gauges read
//! ([`super::placed_gauge`]). Drawn per seed: every gauge's gain, offset, place, direction and noise; of the reference, which is
//! the motor's torque balance, the error k of the torque constant, +-`TORQUE_CONSTANT`, and c of the friction,
//! +-`FRICTION`. The angle is that of both encoders, 19 bits. The first [`LEARNING`] seconds are for learning; the rest is judged.
//!
//! The truth is the torque through the shell: the hysteresis of the plant acts beside it and strains nothing.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::flexspline::reduced::{Direction, Node};
use strainwave::flexspline::{GaugeTorque, Reduced, StrainGauge, TorqueGauges, TorqueGaugesParams};
use strainwave::gear::GearParams;
use strainwave::{Angle, Error, Real};

use super::placed_gauge::{Flaws, LINKS, NOISE, links};
use crate::design::joint::{firmware_gear_params, gear_params};
use crate::io::gear_file::GearFile;
use crate::io::log::OpenLoop;
use crate::plant::NODES;
use crate::plant::divergence::RunError;
use crate::plant::two_port::trajectory::Trajectory;
use crate::plant::two_port::{self, Build};
use crate::sensor::Noise;

/// Speeds of the wave generator, one after the other (rad/s).
pub const SPEEDS: [f64; 11] = [0.0, 100.0, -100.0, 500.0, -500.0, 20.0, -20.0, 5.0, -5.0, 500.0, -500.0];
/// Time from a speed to the next (s): the output's inertia then takes less than the rated torque.
pub const REVERSAL: f64 = 0.25;
/// Time at a speed (s).
pub const HELD: f64 = 0.15;
/// Time that is not judged (s).
pub const LEARNING: f64 = 1.6;
/// Frequency of the torque (Hz).
const SWING: f64 = 1.7;
/// Time in which the swing comes on (s).
const ONSET: f64 = 0.2;
/// Largest error of the motor's torque constant.
const TORQUE_CONSTANT: f64 = 0.1;
/// Largest error of the friction that the reference knows.
const FRICTION: f64 = 0.2;
/// Noise of the motor's torque, in torques that balance the rated one.
const TORQUE_NOISE: f64 = 0.01;
/// Bits of a revolution's 32 that the encoders, of 19, do not have.
const LOST_BITS: u32 = 32 - 19;
/// Standard deviations beyond which an error is counted.
const FAR: f64 = 3.0;
/// Most gauges.
pub const MOST: usize = 8;
/// Where they are: a quarter of a revolution apart, in pairs of both diagonals, at the rim, where torque strains most.
pub const PLACES: [(Node, Direction); MOST] = [
    ((0, 0), (1, 1)),
    ((9, 0), (1, 1)),
    ((18, 0), (-1, 1)),
    ((27, 0), (-1, 1)),
    ((4, 0), (-1, 1)),
    ((13, 0), (-1, 1)),
    ((22, 0), (1, 1)),
    ((31, 0), (1, 1)),
];

/// A control period of the plant.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Time (s).
    pub time: f64,
    /// Torque through the shell (N m).
    pub torque: f64,
    /// External torque on the output (N m).
    pub load: f64,
    /// Angle of the wave generator as its encoder has it, whole revolutions included.
    pub motor_angle: Angle<f32>,
    /// Wave generator less flexspline, as both encoders have it.
    pub wave_generator: Angle<f32>,
    /// Torque of the motor (N m), speed (rad/s) and acceleration of the wave generator (rad/s^2).
    motor: [f64; 3],
    /// Strains of the links of every place.
    strains: Vec<f64>,
}

/// What the joint's controller gets in a control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<const G: usize> {
    /// Strains.
    pub strains: [f32; G],
    /// Wave generator less flexspline.
    pub wave_generator: Angle<f32>,
    /// Torque of the motor, as its current has it (N m).
    pub motor_torque: f32,
    /// Torque by the motor's balance (N m).
    pub reference: f32,
}

/// One run of the plant, of which any number of gauges can be read.
pub struct Record {
    samples: Vec<Sample>,
    /// The gear as its controller knows it.
    known: GearParams<f64>,
}

impl Record {
    /// Runs the plant, with links at all [`PLACES`].
    ///
    /// # Errors
    /// As [`two_port::run`].
    pub fn of(file: &GearFile) -> Result<Self, RunError> {
        let input = input(file);
        let gauges: Vec<_> =
            PLACES.into_iter().flat_map(|(node, direction)| links(node, direction)).collect();
        let trajectory = Trajectory::new(input.time.stamps(), &input.drive);
        let rows = two_port::run(file, &input, Build::REFERENCE, &gauges)?;
        let sample = |row: Result<crate::io::log::OpenLoopRow, RunError>| {
            let row = row?;
            let motor = trajectory.at(row.time);
            let seen = |angle| Angle::<f64>::from_radians_f64(angle).counts >> LOST_BITS << LOST_BITS;
            let (motor_counts, output_counts) = (seen(motor.angle), seen(row.output_position));
            Ok(Sample {
                time: row.time,
                torque: row.shell_torque,
                load: input.time.at(row.time).of(&input.load_torque),
                motor_angle: Angle::from_counts(motor_counts),
                wave_generator: Angle::from_counts(motor_counts - output_counts),
                motor: [row.input_torque, motor.velocity, motor.acceleration],
                strains: row.strains,
            })
        };
        let samples = rows.map(sample).collect::<Result<_, RunError>>()?;
        Ok(Self { samples, known: firmware_gear_params(file)? })
    }

    /// Every control period.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// What the first G gauges of a seed and its reference read, control period by control period.
    pub fn readings<const G: usize>(&self, seed: u64) -> impl Iterator<Item = Reading<G>> {
        let params = &self.known;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let flaws: [Flaws; MOST] =
            PLACES.map(|(_, direction)| Flaws::draw(&params.flexspline.cup, direction, &mut random));
        let scale = 1.0 + random.random_range(-TORQUE_CONSTANT..TORQUE_CONSTANT);
        let known = 1.0 + random.random_range(-FRICTION..FRICTION);
        let contact = params.input_friction.forward;
        let n = f64::from(params.ratio);
        let white = |deviation| Noise::Rms(deviation).build(CONTROL_PERIOD).expect("the deviation is finite");
        let (noise, torque_noise) = (white(NOISE), white(TORQUE_NOISE * params.rated_torque / n.abs()));
        self.samples.iter().map(move |sample| {
            let mut strains = [0.0; G];
            for ((strain, flaws), of_links) in
                strains.iter_mut().zip(&flaws).zip(sample.strains.chunks(LINKS))
            {
                *strain = (flaws.reading(of_links) + noise.step(&mut random)) as f32;
            }
            let [torque, velocity, acceleration] = sample.motor;
            let direction = if velocity == 0.0 { 0.0 } else { velocity.signum() };
            let friction = known * (contact.coulomb * direction + contact.viscous * velocity);
            let inertia = params.wave_generator_inertia * acceleration;
            let motor_torque = scale * torque + torque_noise.step(&mut random);
            Reading {
                strains,
                wave_generator: sample.wave_generator,
                motor_torque: motor_torque as f32,
                reference: (n * (motor_torque - inertia - friction)) as f32,
            }
        })
    }
}

/// The sensor of the first G gauges, as the mesh has them.
///
/// # Errors
/// As [`TorqueGaugesParams::build`].
pub fn sensor<R: Real, const G: usize>(file: &GearFile) -> Result<TorqueGauges<R, G>, Error> {
    let gear = gear_params::<R>(file);
    let cup = Reduced::<R, { NODES.0 }, { NODES.1 }>::build(&gear.flexspline, gear.rated_torque)?;
    let mut gauges = [StrainGauge::build(&cup, PLACES[0].0, PLACES[0].1)?; G];
    for (gauge, (node, direction)) in gauges.iter_mut().zip(PLACES) {
        *gauge = StrainGauge::build(&cup, node, direction)?;
    }
    params(gauges, gear.rated_torque).build()
}

/// What is declared of the gauges, by standard deviations.
fn params<R: Real, const G: usize>(gauges: [StrainGauge<R>; G], rated_torque: R) -> TorqueGaugesParams<R, G> {
    TorqueGaugesParams {
        gauges,
        rated_torque,
        gain: R::lit(DECLARED_GAIN),
        offset: R::lit(DECLARED_OFFSET),
        noise: R::lit(NOISE),
        misplacement: R::lit(MISPLACEMENT),
        reference: R::lit(REFERENCE),
    }
}

/// Declared standard deviation of a gain: that of +-10 %, evenly spread.
const DECLARED_GAIN: f64 = 0.058;
/// Of an offset (strain): the same of +-1e-4.
const DECLARED_OFFSET: f64 = 5.8e-5;
/// Of the gain that misplacement leaves.
const MISPLACEMENT: f64 = 0.01;
/// Of the reference's mean error (N m).
const REFERENCE: f64 = 0.5;

/// The motion and the load, a row every millisecond.
fn input(file: &GearFile) -> OpenLoop {
    let gear = gear_params::<f64>(file);
    let inertia = gear.flexspline_inertia / f64::from(gear.ratio);
    let end = (REVERSAL + HELD) * (SPEEDS.len() - 1) as f64;
    let mut text = "t_s,omega_wg_rad_s,tau_load_nm\n".to_owned();
    for k in 0..=(end * 1e3) as u32 {
        let time = f64::from(k) * 1e-3;
        let (speed, acceleration) = motion(time);
        let onset = 0.5 * (1.0 - (PI * (time / ONSET).min(1.0)).cos());
        let load = inertia * acceleration - gear.rated_torque * onset * (TAU * SWING * time).sin();
        writeln!(text, "{time},{speed},{load}").expect("a string grows");
    }
    OpenLoop::parse(Path::new("S8"), text.as_bytes()).expect("the input is well formed")
}

/// Speed (rad/s) and acceleration (rad/s^2) of the wave generator.
fn motion(time: f64) -> (f64, f64) {
    let part = (time / (REVERSAL + HELD)) as usize;
    let [from, to] = [part, part + 1].map(|k| SPEEDS[k.min(SPEEDS.len() - 1)]);
    let along = ((time - part as f64 * (REVERSAL + HELD)) / REVERSAL).min(1.0);
    let rate = 0.5 * PI / REVERSAL * (PI * along).sin();
    (from + (to - from) * 0.5 * (1.0 - (PI * along).cos()), (to - from) * rate)
}

/// Control periods that are not judged.
pub fn unjudged() -> usize {
    (LEARNING / CONTROL_PERIOD) as usize
}

/// Errors of a seed's gauges over the judged part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// rms, of rated torque.
    pub error: f64,
    /// The same of the gauges as a full bridge, balanced at rest, with the mesh's strain per torque.
    pub raw: f64,
    /// Part of the time in which the error is beyond three standard deviations.
    pub far: f64,
}

/// Judges the first G gauges of a seed, as `step` tells their torque control period by control period.
///
/// # Errors
/// As [`sensor`], and those of `step`.
pub fn judge<const G: usize, E: From<Error>>(
    file: &GearFile,
    record: &Record,
    seed: u64,
    mut step: impl FnMut(&Reading<G>) -> Result<GaugeTorque<f32>, E>,
) -> Result<Errors, E> {
    let (nominal, rated) = (sensor::<f32, G>(file)?, file.gear.rated_torque);
    let mut bridge = Bridge::default();
    let [mut error, mut raw] = [Mean::default(); 2];
    let mut far = 0.0;
    for (period, (sample, read)) in record.samples().iter().zip(record.readings::<G>(seed)).enumerate() {
        let GaugeTorque { torque, standard_deviation } = step(&read)?;
        let bridge_torque = bridge.torque(&nominal, &read.strains);
        if period >= unjudged() {
            let off = f64::from(torque) - sample.torque;
            error.take(off / rated);
            raw.take((bridge_torque - sample.torque) / rated);
            far += f64::from(u8::from(off.abs() > FAR * f64::from(standard_deviation)));
        }
    }
    Ok(Errors { error: error.root(), raw: raw.root(), far: far / error.count })
}

/// The same with the sensor in the firmware's precision.
///
/// # Errors
/// As [`sensor`].
pub fn judge_on_host<const G: usize>(file: &GearFile, record: &Record, seed: u64) -> Result<Errors, Error> {
    let sensor = sensor::<f32, G>(file)?;
    let mut state = sensor.rest();
    judge(file, record, seed, |read: &Reading<G>| {
        Ok(sensor.step(&mut state, &read.strains, read.wave_generator, Some(read.reference)))
    })
}

/// Mean of squares.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    pub(super) fn take(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1.0;
    }

    pub(super) fn root(self) -> f64 {
        (self.sum / self.count).sqrt()
    }
}

/// The gauges in a full bridge as for torque, those of one diagonal in the arms opposite to those of the other, balanced by their first
/// reading. Where all have their nominal gain and place, the ellipse's 2nd harmonic cancels in it.
#[derive(Clone, Copy, Debug, Default)]
struct Bridge {
    balance: Option<f64>,
}

impl Bridge {
    fn torque<const G: usize>(&mut self, sensor: &TorqueGauges<f32, G>, strains: &[f32; G]) -> f64 {
        let per_torque = sensor.per_torque().map(f64::from);
        let product: f64 = strains.iter().zip(per_torque).map(|(strain, p)| f64::from(*strain) * p).sum();
        let torque = product / per_torque.iter().map(|p| p * p).sum::<f64>();
        torque - *self.balance.get_or_insert(torque)
    }
}
