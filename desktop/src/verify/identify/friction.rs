//! Synthetic joints whose friction is the gear's own block with other parameters: one motion trains, another is judged.
//!
//! The joint is the default gear's, its torque that of the block in f64 in every control period, with inertia, weight and
//! ripple of its own. A log has a row every 4 ms: the motor's angle in counts of its encoder, its torque with the gear
//! file's noise, which is 1 % of the rated torque at the motor. The motion goes from presliding strokes to 50 rad/s.
//!
//! Judged are how often a parameter is outside its 95 % interval, the Coulomb level, and the friction of a motion that did not
//! train, beside the best static law: levels, Stribeck's curve, viscous friction and ripple of the orders 1 and 2 over speed and
//! angle, by least squares with the Stribeck speed that fits best. It is told the weight's and the inertia's share.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use strainwave::Angle;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::{FrictionModel, FrictionParams, JointFrictionState, Slip};

use crate::identify::moving::{LearntParameter, Parameter, learn_friction};
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::friction_params::joint_friction_params;
use crate::io::gear_file::{Friction, GearFile};
use crate::io::log::{MeasuredLog, Time};
use crate::verify::bounds::figure;
use crate::verify::{Measured, largest};

/// Joints of the whole measurement.
pub const JOINTS: u64 = 100;
/// Control periods from row to row.
const ROW: usize = 40;
/// Moves of the motor that train: end (rad), duration (s). 44 s in all, about as long as what `strainwave experiment` plans by itself.
const TRAINED: [(f64, f64); 28] = with_mirrored([
    (0.02, 0.6),
    (-0.02, 0.6),
    (0.08, 0.6),
    (-0.1, 0.8),
    (0.4, 1.0),
    (-0.8, 1.2),
    (2.0, 1.5),
    (-3.0, 1.5),
    (6.0, 2.0),
    (0.0, 2.0),
    (20.0, 2.5),
    (0.0, 2.5),
    (60.0, 2.5),
    (0.0, 2.5),
]);
/// Moves that are judged.
const JUDGED: [(f64, f64); 7] =
    [(0.05, 1.0), (-0.05, 0.9), (1.0, 1.2), (0.2, 0.8), (25.0, 2.0), (20.0, 1.0), (0.0, 1.7)];
/// Stribeck speeds of the static law (rad/s): from the least, each so many times the one before.
const STRIBECKS: (usize, f64, f64) = (40, 0.05, 1.18);

/// Moves, then the same the other way.
const fn with_mirrored(half: [(f64, f64); 14]) -> [(f64, f64); 28] {
    let mut moves = [(0.0, 0.0); 28];
    let mut k = 0;
    while k < half.len() {
        moves[k] = half[k];
        moves[half.len() + k] = (-half[k].0, half[k].1);
        k += 1;
    }
    moves
}

/// A joint.
struct Joint {
    gear: GearFile,
    /// Factor on the load's inertia and the rotor's.
    inertia: f64,
    /// At the motor (N m).
    weight: f64,
    /// Stroke by which the block had come when a motion begins (rad).
    start: f64,
}

impl Joint {
    fn draw(base: &GearFile, random: &mut ChaCha8Rng) -> Self {
        let mut gear = base.clone();
        let side = &mut gear.friction.input;
        let within = |random: &mut ChaCha8Rng, [least, most]: [f64; 2]| {
            (random.random_range(f64::ln(least)..f64::ln(most))).exp()
        };
        let rise = side.static_level.zip(side.coulomb).map(|(level, coulomb)| level - coulomb);
        let [level, viscous] = [[0.5, 2.0], [0.5, 8.0]].map(|range| within(random, range));
        let rise = rise.map(|rise| rise * within(random, [0.4, 2.0]));
        side.coulomb = side.coulomb.map(|coulomb| coulomb * level);
        side.static_level = side.coulomb.zip(rise).map(|(coulomb, rise)| coulomb + level * rise);
        side.viscous = side.viscous.map(|value| value * viscous);
        side.stribeck_velocity = side.stribeck_velocity.map(|speed| speed * within(random, [0.5, 3.0]));
        side.presliding = side.presliding.map(|distance| distance * within(random, [0.5, 2.0]));
        let mut part = || random.random_range(-0.08..0.08);
        (side.ripple_cosines, side.ripple_sines) = (Some(vec![part(), part()]), Some(vec![part(), part()]));
        let inertia = random.random_range(0.8..1.2);
        let weight = base.friction.input.coulomb.unwrap_or_default() * random.random_range(-0.5..0.5);
        Self { gear, inertia, weight, start: random.random_range(-0.05..0.05) }
    }

    /// Rows of a log, and in every row the friction of the block (N m).
    fn log(
        &self,
        moves: &[(f64, f64)],
        random: &mut ChaCha8Rng,
    ) -> Result<(MeasuredLog, Vec<f64>), BadInput> {
        let r: f64 = self.gear.gear.signed_ratio().value();
        let inertia =
            self.inertia * (self.gear.inertia.wave_generator + r * r * self.gear.inertia.flexspline);
        let output = contact(&self.gear.friction.output, moves, r, 0.0)?;
        let friction = contact(&self.gear.friction.input, moves, 1.0, self.start)?;
        let noise = Normal::new(0.0, self.gear.sensors.motor_torque_noise).map_err(BadInput::message)?;
        let count = TAU / 2f64.powi(self.gear.sensors.motor_encoder_bits.cast_signed());
        let rows = friction.len();
        let at = |row: usize| angle(moves, (row * ROW) as f64 * CONTROL_PERIOD);
        let torque =
            |row: usize| inertia * acceleration(moves, row) + self.weight + r * output[row] + friction[row];
        let log = MeasuredLog {
            time: Time::every(ROW as f64 * CONTROL_PERIOD, rows),
            motor_position: (0..rows).map(|row| (at(row) / count).round() * count).collect(),
            motor_torque: (0..rows).map(|row| torque(row) + noise.sample(random)).collect(),
            output_position: Some((0..rows).map(|row| r * at(row)).collect()),
            output_torque: None,
            model_torque: None,
        };
        Ok((log, friction))
    }
}

/// Friction of a contact in every row of moves of the motor, `ratio` times which it moves (N m).
fn contact(side: &Friction, moves: &[(f64, f64)], ratio: f64, start: f64) -> Result<Vec<f64>, BadInput> {
    let params =
        joint_friction_params::<f64>(side).ok_or_else(|| BadInput::message("another friction model"))?;
    let (model, mut state) = (params.build().map_err(BadInput::message)?, JointFrictionState::default());
    model.step(&mut state, &Slip::new(start, 1.0));
    let periods = (duration(moves) / CONTROL_PERIOD) as usize;
    let (mut before, mut forces) = (0.0, Vec::new());
    for period in 0..periods {
        let now = angle(moves, period as f64 * CONTROL_PERIOD);
        let heading = Angle::<f64>::from_radians_f64(now).heading();
        let slip = Slip::new(ratio * (now - before) / CONTROL_PERIOD, CONTROL_PERIOD);
        let force = model.step(&mut state, &Slip { wave_generator: heading, ..slip }).force;
        if period % ROW == 0 {
            forces.push(force);
        }
        before = now;
    }
    Ok(forces)
}

fn duration(moves: &[(f64, f64)]) -> f64 {
    moves.iter().map(|(_, duration)| duration).sum()
}

/// Angle of moves from rest to rest (rad).
fn angle(moves: &[(f64, f64)], time: f64) -> f64 {
    let (mut from, mut elapsed) = (0.0, time);
    for (to, duration) in moves {
        let x = elapsed / duration;
        if x < 1.0 {
            return from + (to - from) * x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3));
        }
        (from, elapsed) = (*to, elapsed - duration);
    }
    from
}

/// Speed (rad/s) in a row.
fn speed(moves: &[(f64, f64)], row: usize) -> f64 {
    let time = (row * ROW) as f64 * CONTROL_PERIOD;
    (angle(moves, time) - angle(moves, (time - CONTROL_PERIOD).max(0.0))) / CONTROL_PERIOD
}

fn acceleration(moves: &[(f64, f64)], row: usize) -> f64 {
    let (time, h) = ((row * ROW) as f64 * CONTROL_PERIOD, 1e-3);
    let at = |time: f64| angle(moves, time.max(0.0));
    (at(time + h) - 2.0 * at(time) + at(time - h)) / (h * h)
}

/// What one joint says.
struct Judged {
    /// Largest relative error of the Coulomb level.
    level: f64,
    /// Parameters, and whether their interval misses them.
    outside: Vec<(Parameter, bool)>,
    /// Rms error of the friction on the motion that did not train (N m), of the static law too, and its own rms.
    rms: [f64; 3],
}

/// The whole, of the joints of these seeds; `progress` is called with the fraction done.
///
/// # Errors
/// When a joint cannot be learnt from.
pub fn measure(joints: Range<u64>, mut progress: impl FnMut(f64)) -> Result<Measured, BadInput> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let mut judged = Vec::new();
    for first in joints.clone().step_by(workers as usize) {
        let seeds = first..joints.end.min(first + workers);
        let found: Vec<_> = std::thread::scope(|scope| {
            let started: Vec<_> = seeds.map(|seed| scope.spawn(move || judge(seed))).collect();
            started.into_iter().map(|thread| thread.join().expect("a joint is judged")).collect()
        });
        judged.extend(found.into_iter().collect::<Result<Vec<_>, _>>()?);
        progress((first + workers - joints.start) as f64 / (joints.end - joints.start) as f64);
    }
    Ok(figures(&judged).into())
}

fn figures(judged: &[Judged]) -> Vec<Figure> {
    let count = judged.len() as f64;
    let mut outside = BTreeMap::<String, u32>::new();
    for (parameter, missed) in judged.iter().flat_map(|joint| &joint.outside) {
        *outside.entry(parameter.key()).or_default() += u32::from(*missed);
    }
    // Divided once: the sum of three twentieths would be more than 0.15.
    let share = |joints: u32| f64::from(joints) / count;
    let whole = judged.iter().filter(|joint| joint.outside.iter().all(|(_, missed)| !missed)).count() as f64;
    let mut ratios: Vec<_> = judged.iter().map(|joint| joint.rms[0] / joint.rms[1]).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    let mut levels: Vec<_> = judged.iter().map(|joint| joint.level).collect();
    levels.sort_unstable_by(f64::total_cmp);
    let mean = |k: usize| (judged.iter().map(|joint| joint.rms[k].powi(2)).sum::<f64>() / count).sqrt();
    let mut figures = vec![
        figure("identify.friction.outside", largest(outside.values().map(|joints| share(*joints)))),
        figure("identify.friction.level", levels[(levels.len() * 95).div_ceil(100) - 1]),
        Figure::reported("identify.friction.level.worst", largest(levels.iter().copied()), "1"),
        figure("identify.friction.over_static", largest(ratios.iter().copied())),
        Figure::reported("identify.friction.over_static.median", ratios[ratios.len() / 2], "1"),
        Figure::reported("identify.friction.rms", mean(0), "N m"),
        Figure::reported("identify.friction.static.rms", mean(1), "N m"),
        Figure::reported("identify.friction.itself.rms", mean(2), "N m"),
        Figure::reported("identify.friction.all_inside", whole / count, "1"),
    ];
    let each = |(key, joints): (&String, &u32)| {
        Figure::reported(format!("identify.friction.outside.{key}"), share(*joints), "1")
    };
    figures.extend(outside.iter().map(each));
    figures
}

fn judge(seed: u64) -> Result<Judged, BadInput> {
    let base = GearFile::default_gear();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let joint = Joint::draw(&base, &mut random);
    let (log, trained) = joint.log(&TRAINED, &mut random)?;
    let (found, friction) = learn_friction(&base, &log).map_err(BadInput::message)?;
    let truth = contact(&joint.gear.friction.input, &JUDGED, 1.0, 0.0)?;
    let ours = contact(&found.friction.input, &JUDGED, 1.0, 0.0)?;
    let noisy: Vec<_> = {
        let noise = Normal::new(0.0, base.sensors.motor_torque_noise).map_err(BadInput::message)?;
        trained.iter().map(|friction| friction + noise.sample(&mut random)).collect()
    };
    let rival = static_law(&noisy);
    let rms = |errors: &dyn Fn(usize) -> f64| {
        ((0..truth.len()).map(|row| errors(row).powi(2)).sum::<f64>() / truth.len() as f64).sqrt()
    };
    let own = &joint.gear.friction.input;
    let missed = |learnt: &LearntParameter| {
        let value = value(own, learnt.parameter);
        (learnt.parameter, !(learnt.interval[0]..=learnt.interval[1]).contains(&value))
    };
    let coulomb = |side: &Friction| side.coulomb.unwrap_or(f64::NAN);
    Ok(Judged {
        level: (coulomb(&found.friction.input) / coulomb(own) - 1.0).abs(),
        outside: friction.parameters.iter().map(missed).collect(),
        rms: [
            rms(&|row| ours[row] - truth[row]),
            rms(&|row| rival(row) - truth[row]),
            rms(&|row| truth[row]),
        ],
    })
}

/// Parameter of a side.
fn value(side: &Friction, parameter: Parameter) -> f64 {
    parameter.of(side).unwrap_or(f64::NAN)
}

/// The static law that fits the friction of the rows that train best, over the rows that are judged.
fn static_law(friction: &[f64]) -> impl Fn(usize) -> f64 {
    let (count, least, factor) = STRIBECKS;
    let fitted = |stribeck: f64| {
        let rows: Vec<_> = (0..friction.len()).map(|row| columns(&TRAINED, row, stribeck)).collect();
        let matrix = DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column]);
        let right = DVector::from_row_slice(friction);
        let found = matrix
            .clone()
            .svd(true, true)
            .solve(&right, 1e-12)
            .unwrap_or_else(|_| DVector::zeros(rows[0].len()));
        let left = (&matrix * &found - right).norm_squared();
        (stribeck, found, left)
    };
    let all = (0..count).map(|k| fitted(least * factor.powi(k as i32)));
    let best = all.min_by(|a, b| a.2.total_cmp(&b.2));
    move |row| {
        best.as_ref().map_or(f64::NAN, |(stribeck, found, _)| {
            columns(&JUDGED, row, *stribeck).iter().zip(found.iter()).map(|(column, x)| column * x).sum()
        })
    }
}

/// Columns of the static law in a row.
fn columns(moves: &[(f64, f64)], row: usize, stribeck: f64) -> [f64; 7] {
    let speed = speed(moves, row);
    let at = angle(moves, (row * ROW) as f64 * CONTROL_PERIOD);
    let sign = if speed == 0.0 { 0.0 } else { speed.signum() };
    let [one, two] = [1.0, 2.0].map(|order: f64| (order * at).sin_cos());
    let rise = (-speed.abs() / stribeck).exp();
    [sign, sign * rise, speed, sign * one.0, sign * one.1, sign * two.0, sign * two.1]
}
