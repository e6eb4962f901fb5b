//! Input sequences that take the control step where no scenario does: any bits, and legal motions in which things go
//! wrong.
//!
//! A sequence is drawn from its seed alone. One in `ANY_BITS` has nothing but random bits; the others are motions of S1 to S5
//! on the condensed plant, closed by the compensator itself, in which single periods are disturbed
//! ([`disturbance`]): so that most of its code still has a sound state to work on. Every sequence begins at a
//! restart. What a disturbed compensator answers acts on the plant.

pub mod disturbance;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::Error;
use strainwave::compensator::{Input, JointParams, Output};

use crate::bench::controller::{Controller, HostCompensator};
use crate::bench::scenario::Scenario;
use crate::bench::task::Demand;
use crate::bench::task::Task;
use crate::bench::{Bench, Conditions};
use crate::design::capability::Capability;
use crate::design::joint::joint_params;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;
use disturbance::Disturbance;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// One sequence in so many is of random bits.
const ANY_BITS: u64 = 6;
/// Fewest and most control periods of a sequence.
const LENGTHS: [f64; 2] = [64.0, 2048.0];
/// Smallest and largest fraction of disturbed periods.
const RATES: [f64; 2] = [2e-3, 0.5];
/// Periods before the one that matters in which a variation may change something.
const WINDOW: usize = 32;
/// Most changes of a variation.
const CHANGES: u32 = 4;

/// The sequence of this seed for the joint of a gear file.
///
/// # Errors
/// A gear that no compensator or plant can be built for.
pub fn sequence(file: &GearFile, seed: u64) -> Result<Vec<Input<f32>>, Error> {
    let joint = joint_params(file)?;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let length = between(&mut random, LENGTHS) as usize;
    if seed.is_multiple_of(ANY_BITS) {
        let bits = |_| {
            let mut input = Input::default();
            Disturbance::Bits.apply(&mut input, &joint, &mut random);
            input
        };
        return Ok((0..length).map(bits).collect());
    }
    Disturbed::sample(&joint, random)?.drive(file, seed, length)
}

/// A sequence up to period `at` with something else in the periods before it.
///
/// # Panics
/// When the sequence has no period `at`.
pub fn variation(inputs: &[Input<f32>], at: usize, joint: &JointParams<f32>, seed: u64) -> Vec<Input<f32>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut varied = inputs[..=at].to_vec();
    for _ in 0..random.random_range(1..=CHANGES) {
        let place = at - random.random_range(0..WINDOW.min(at + 1));
        Disturbance::sample(&mut random).apply(&mut varied[place], joint, &mut random);
    }
    varied
}

/// Even over the logarithm.
fn between(random: &mut ChaCha8Rng, [least, most]: [f64; 2]) -> f64 {
    least * (most / least).powf(random.random_range(0.0..1.0))
}

/// A compensator some of whose inputs are disturbed, and what it read.
struct Disturbed {
    host: HostCompensator,
    joint: JointParams<f32>,
    random: ChaCha8Rng,
    rate: f64,
    /// Error of `elapsed` against the control period, in every period.
    off_time: f32,
    read: Vec<Input<f32>>,
}

impl Disturbed {
    fn sample(joint: &JointParams<f32>, mut random: ChaCha8Rng) -> Result<Self, Error> {
        let rate = between(&mut random, RATES);
        let off_time = if random.random_bool(0.3) { random.random_range(0.9..1.1) } else { 1.0 };
        Ok(Self {
            host: HostCompensator::build(joint)?,
            joint: *joint,
            random,
            rate,
            off_time,
            read: Vec::new(),
        })
    }

    /// The inputs of a motion of so many periods.
    fn drive(mut self, file: &GearFile, seed: u64, length: usize) -> Result<Vec<Input<f32>>, Error> {
        let scenario = Scenario::ALL[self.random.random_range(0..5)];
        let mut sensed = file.clone();
        sensed.sensors.output_torque = self.random.random_bool(0.5);
        let sensors = SensorSet::ALL[self.random.random_range(0..2)];
        let mut bench = Bench::condensed(&sensed, &Conditions { sensors, ..Conditions::of(&sensed, seed) })?;
        match bench.go(&Beginning { scenario, length }, &mut self, |_, _, _, _| ()) {
            // What was read until then is a sequence, too.
            Ok(()) | Err(RunError::Diverged(_)) => Ok(self.read),
            Err(RunError::Parameter(error)) => Err(error),
        }
    }
}

impl Controller for Disturbed {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        let mut input = Input { elapsed: self.off_time * input.elapsed, ..*input };
        while self.random.random_bool(self.rate) {
            Disturbance::sample(&mut self.random).apply(&mut input, &self.joint, &mut self.random);
        }
        self.read.push(input);
        Ok(self.host.step(&input))
    }
}

/// The first `length` control periods of a scenario.
struct Beginning {
    scenario: Scenario,
    length: usize,
}

impl Task for Beginning {
    fn duration(&self) -> f64 {
        self.length as f64 * CONTROL_PERIOD
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        self.scenario.at(time, capability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::output_bounds::beyond_bounds;

    /// Bits, as NaN is not itself.
    fn bits(inputs: &[Input<f32>]) -> Vec<String> {
        inputs.iter().map(|input| format!("{input:?}")).collect()
    }

    #[test]
    fn a_seed_is_a_sequence_and_its_outputs_are_bounded() {
        let file = GearFile::default_gear();
        let joint = joint_params(&file).unwrap();
        for seed in 0..2 * ANY_BITS {
            let inputs = sequence(&file, seed).unwrap();
            assert_eq!(bits(&inputs), bits(&sequence(&file, seed).unwrap()), "seed {seed}");
            assert!(inputs.len() >= LENGTHS[0] as usize, "seed {seed}: {}", inputs.len());
            let mut host = HostCompensator::build(&joint).unwrap();
            for (step, input) in inputs.iter().enumerate() {
                assert_eq!(beyond_bounds(&joint, &host.step(input)), None, "seed {seed}, step {step}");
            }
        }
    }

    #[test]
    fn a_variation_differs_before_its_end_alone() {
        let file = GearFile::default_gear();
        let (inputs, joint) = (sequence(&file, 1).unwrap(), joint_params(&file).unwrap());
        let unchanged = |seed| {
            let varied = variation(&inputs, 60, &joint, seed);
            assert_eq!(varied.len(), 61);
            bits(&inputs).iter().zip(bits(&varied)).take_while(|(a, b)| **a == *b).count()
        };
        let unchanged: Vec<_> = (0..20).map(unchanged).collect();
        assert!(unchanged.iter().all(|periods| *periods > 60 - WINDOW), "{unchanged:?}");
        assert!(unchanged.iter().any(|periods| *periods < 61), "{unchanged:?}");
    }
}
