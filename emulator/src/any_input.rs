//! The control step on any input: what the most costly one costs, and whether image and host agree there.
//!
//! Sequences of inputs ([`strainwave_desktop::bench::any_input`]) go through the image and the host's build side by side, each from a
//! restart. Then, for each slot of the schedule, the sequence with its most costly step is varied shortly before that
//! step, and the variation kept when it costs no less: a search by hill climbing. Nothing in it is random but what its seeds
//! give, so that it finds the same each time. What it finds is reached, not proved to be the most: that is
//! [`crate::counting::worst_path`], where the code shows a bound.

use std::collections::BTreeMap;
use std::path::Path;

use strainwave::compensator::schedule::{SLOW_PERIODS, Slot};
use strainwave::compensator::{Input, JointParams, Output};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::any_input::{sequence, variation};
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::bench::output_bounds::beyond_bounds;
use strainwave_desktop::design::joint::joint_params;

use crate::artifact::{self, CONTROL_STEP, Image};
use crate::counting::{self, Counting, flash_accelerator, path};
use crate::machine::{self, Machine};
use crate::target::{self, Follower};

/// Sequences that are drawn.
const SEQUENCES: u64 = 96;
/// Variations of the most costly step of each slot.
const VARIATIONS: u64 = 48;
/// Slots of the schedule.
pub const SLOTS: usize = SLOW_PERIODS as usize;

/// Why the search could not be made.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The run failed.
    #[error(transparent)]
    Run(#[from] target::Error),
    /// The image cannot be read.
    #[error(transparent)]
    Image(#[from] artifact::Error),
    /// The control step could not be counted.
    #[error(transparent)]
    Counting(#[from] counting::Error),
}

impl From<machine::Error> for Error {
    fn from(error: machine::Error) -> Self {
        Self::Run(error.into())
    }
}

impl From<strainwave::Error> for Error {
    fn from(error: strainwave::Error) -> Self {
        Self::Run(error.into())
    }
}

/// Result of the search.
#[derive(Clone, Debug, PartialEq)]
pub struct AnyInput {
    /// Control steps that were taken.
    pub steps: u64,
    /// Steps of which any bit of the output differed from the host's.
    pub unlike_host: u64,
    /// Steps with an output that is not finite or beyond its bound, by the name of the first such.
    pub unbounded: BTreeMap<&'static str, u64>,
    /// The most costly step.
    pub worst: Step,
    /// Its cycles where the code is in the flash of an STM32F405, if every instruction has a cost.
    pub from_flash: Option<u64>,
    /// Its cycles in each function, those of its callees apart, the most first.
    pub functions: Vec<(String, u64)>,
    /// Cycles of the most costly step of each slot, in the schedule's order; those in which it waited are its own.
    pub slots: [u64; SLOTS],
}

/// A control step that was taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// Its cost.
    pub cycles: u64,
    /// The sequence that it is in.
    pub seed: u64,
    /// Number of variations of the sequence that led to it.
    pub variations: u32,
    /// Its number in the sequence, from 0.
    pub number: usize,
    pub(crate) inputs: Vec<Input<f32>>,
}

/// Searches with the image at `elf`, which was built for the joint of `file`; `progress` is called with the fraction done.
///
/// # Errors
/// When the image cannot be run or counted.
pub fn search(elf: &Path, file: &GearFile, mut progress: impl FnMut(f64)) -> Result<AnyInput, Error> {
    let mut search = Search::of(Image::read(elf)?, joint_params(file)?)?;
    let runs = (SEQUENCES + VARIATIONS * SLOTS as u64) as f64;
    for seed in 0..SEQUENCES {
        let inputs = sequence(file, seed)?;
        search.take(Step { seed, inputs, ..Step::default() })?;
        progress((seed + 1) as f64 / runs);
    }
    for number in 0..VARIATIONS * SLOTS as u64 {
        search.vary(number as usize % SLOTS, number)?;
        progress((SEQUENCES + number + 1) as f64 / runs);
    }
    search.found()
}

struct Search {
    image: Image,
    joint: JointParams<f32>,
    counting: Counting,
    /// The most costly step of each slot.
    most: [Step; SLOTS],
    steps: u64,
    unlike_host: u64,
    unbounded: BTreeMap<&'static str, u64>,
}

impl Search {
    fn of(image: Image, joint: JointParams<f32>) -> Result<Self, Error> {
        let counting = Counting::prepare(&image, &image.find(CONTROL_STEP)?)?;
        let most = Default::default();
        Ok(Self { image, joint, counting, most, steps: 0, unlike_host: 0, unbounded: BTreeMap::new() })
    }

    /// Varies what comes before the most costly step of a slot.
    fn vary(&mut self, slot: usize, seed: u64) -> Result<(), Error> {
        let from = &self.most[slot];
        let inputs = variation(&from.inputs, from.number, &self.joint, seed);
        let varied = Step { seed: from.seed, variations: from.variations + 1, inputs, ..Step::default() };
        self.take(varied)
    }

    /// Runs the inputs of a step's sequence, and keeps its most costly steps.
    fn take(&mut self, sequence: Step) -> Result<(), Error> {
        let slots = self.run(&sequence.inputs, &self.counting.arguments_for_calls())?;
        let calls = self.counting.results(&self.image)?.calls;
        let mut found: [Option<(u64, usize)>; SLOTS] = [None; SLOTS];
        for (number, (cycles, slot)) in calls.into_iter().zip(slots).enumerate() {
            found[slot as usize] = found[slot as usize].max(Some((cycles, number)));
        }
        for (most, found) in self.most.iter_mut().zip(found) {
            if let Some((cycles, number)) = found.filter(|(cycles, _)| *cycles >= most.cycles) {
                *most = Step { cycles, number, ..sequence.clone() };
            }
        }
        Ok(())
    }

    /// Runs inputs from a restart, on target and host; the slot of each.
    fn run(&mut self, inputs: &[Input<f32>], arguments: &[String]) -> Result<Vec<Slot>, Error> {
        let Self { joint, unbounded, .. } = self;
        let judge = |output: &Output<f32>| {
            if let Some(name) = beyond_bounds(joint, output) {
                *unbounded.entry(name).or_default() += 1;
            }
        };
        let mut target = Follower::new(Machine::boot(self.image.path(), arguments)?, joint, judge)?;
        let mut slots = Vec::with_capacity(inputs.len());
        for input in inputs {
            slots.push(target.slot());
            target.step(input)?;
        }
        let (agreement, _) = target.finish()?;
        self.steps += agreement.steps;
        self.unlike_host += agreement.different;
        Ok(slots)
    }

    /// Result, the most costly step followed once more.
    fn found(mut self) -> Result<AnyInput, Error> {
        let slots = self.most.each_ref().map(|step| step.cycles);
        let worst = self.most.iter().max_by_key(|step| step.cycles).cloned().unwrap_or_default();
        self.run(&worst.inputs, &self.counting.arguments_for_path(worst.number))?;
        let path = self.counting.results(&self.image)?.path;
        let functions = path::by_function(&self.image, &path).unwrap_or_default();
        let from_flash = flash_accelerator::cycles(&self.image, &path);
        let Self { steps, unlike_host, unbounded, .. } = self;
        Ok(AnyInput { steps, unlike_host, unbounded, worst, from_flash, functions, slots })
    }
}
