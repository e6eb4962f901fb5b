//! The firmware as a controller: every step on the emulated processor, and the same step on the host; in lockstep, or the host ahead.

use std::collections::VecDeque;

use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::schedule::Slot;
use strainwave::compensator::{Input, JointParams, Output};
use strainwave_app::frame::{Fields, decode_output, encode_input, encode_output};
use strainwave_desktop::Figure;
use strainwave_desktop::bench::controller::{Controller, HostCompensator};
use strainwave_desktop::plant::divergence::RunError;
use strainwave_desktop::verify::bounds;

use crate::machine::{self, AHEAD, Ending, Machine};

/// A booted firmware and the host's build of the same joint.
pub struct Target {
    machine: Machine,
    host: HostCompensator,
    agreement: Agreement,
}

/// Number of steps in which target and host agreed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Agreement {
    /// Steps taken.
    pub steps: u64,
    /// Steps in which any bit of the output differed.
    pub different: u64,
}

impl Agreement {
    /// Both runs as one.
    pub fn and(self, other: Self) -> Self {
        Self { steps: self.steps + other.steps, different: self.different + other.different }
    }

    /// Counts a step with these outputs.
    fn compare(&mut self, target: &Output<f32>, host: &Output<f32>) {
        self.steps += 1;
        self.different += u64::from(canonical(target) != canonical(host));
    }

    /// The steps that differed, of which there must be none.
    pub fn figure(&self, name: impl Into<String>) -> Figure {
        bounds::figure_as(name, "pil.steps_unlike_host", self.different as f64)
    }
}

/// Why a run on the target ended.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The machine.
    #[error(transparent)]
    Machine(#[from] machine::Error),
    /// A parameter that no model can be built from.
    #[error(transparent)]
    Parameter(#[from] strainwave::Error),
    /// The plant.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl Target {
    /// Pairs the host's build of `joint` with a machine that was booted with the same joint.
    ///
    /// # Errors
    /// As [`JointParams::build`].
    pub fn new(machine: Machine, joint: &JointParams<f32>) -> Result<Self, Error> {
        Ok(Self { machine, host: HostCompensator::build(joint)?, agreement: Agreement::default() })
    }

    /// Number of steps in which both agreed so far.
    pub fn agreement(&self) -> Agreement {
        self.agreement
    }

    /// Learnt factors and ripple of the host's build, which equal the target's.
    pub fn learnt(&self) -> Learnt<f32> {
        self.host.learnt()
    }

    /// Ends the firmware and reads its report.
    ///
    /// # Errors
    /// As [`Machine::finish`].
    pub fn finish(self) -> Result<Ending, Error> {
        Ok(self.machine.finish()?)
    }
}

impl Controller for Target {
    type Error = Error;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Error> {
        let answer = decode_output(&self.machine.exchange(&encode_input(input))?);
        self.agreement.compare(&answer, &self.host.step(input));
        Ok(answer)
    }
}

/// The host's build as the controller, and a booted firmware that takes the same steps up to [`AHEAD`] periods later: faster than in
/// lockstep, and the same, bit by bit, as long as both agree.
pub struct Follower<F> {
    machine: Machine,
    host: HostCompensator,
    agreement: Agreement,
    /// Outputs of the host that the target has not answered yet.
    expected: VecDeque<Output<f32>>,
    answered: F,
}

impl<F: FnMut(&Output<f32>)> Follower<F> {
    /// Pairs the host's build of `joint` with a machine that was booted with the same joint; `answered` is called with each of the
    /// target's outputs.
    ///
    /// # Errors
    /// As [`JointParams::build`].
    pub fn new(machine: Machine, joint: &JointParams<f32>, answered: F) -> Result<Self, Error> {
        let host = HostCompensator::build(joint)?;
        Ok(Self { machine, host, agreement: Agreement::default(), expected: VecDeque::new(), answered })
    }

    /// The slot that is next.
    pub fn slot(&self) -> Slot {
        self.host.slot()
    }

    /// Takes the target's answers that are missing, ends the firmware and reads its report.
    ///
    /// # Errors
    /// As [`Machine::receive`] and [`Machine::finish`].
    pub fn finish(mut self) -> Result<(Agreement, Ending), Error> {
        while !self.expected.is_empty() {
            self.take_answer()?;
        }
        Ok((self.agreement, self.machine.finish()?))
    }

    fn take_answer(&mut self) -> Result<(), Error> {
        let answer = decode_output(&self.machine.receive()?);
        if let Some(expected) = self.expected.pop_front() {
            self.agreement.compare(&answer, &expected);
        }
        (self.answered)(&answer);
        Ok(())
    }
}

impl<F: FnMut(&Output<f32>)> Controller for Follower<F> {
    type Error = Error;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Error> {
        if self.expected.len() == AHEAD {
            self.take_answer()?;
        }
        self.machine.send(&encode_input(input))?;
        let output = self.host.step(input);
        self.expected.push_back(output);
        Ok(output)
    }
}

/// An output's bits with every NaN alike: which NaN an operation makes differs between processors.
fn canonical(output: &Output<f32>) -> impl PartialEq {
    let mut output = *output;
    OneNan.output(&mut output);
    encode_output(&output)
}

/// Makes every NaN the same.
struct OneNan;

impl Fields for OneNan {
    fn bytes<const K: usize>(&mut self, _: &mut [u8; K]) {}

    fn f32(&mut self, value: &mut f32) {
        if value.is_nan() {
            *value = f32::NAN;
        }
    }
}
