//! The firmware as a controller: every step on the emulated processor, and the same step on the host.

use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::schedule::Slot;
use strainwave::compensator::{Input, JointParams, Output};
use strainwave_app::frame::{Fields, decode_output, encode_input, encode_output};
use strainwave_desktop::Figure;
use strainwave_desktop::bench::controller::{Controller, HostCompensator};
use strainwave_desktop::plant::divergence::RunError;
use strainwave_desktop::verify::bounds;

use crate::machine::{self, Ending, Machine};

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

    /// The slot that is next.
    pub fn slot(&self) -> Slot {
        self.host.slot()
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
        let expected = self.host.step(input);
        self.agreement.steps += 1;
        self.agreement.different += u64::from(canonical(&answer) != canonical(&expected));
        Ok(answer)
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
