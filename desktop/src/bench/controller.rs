//! Controller of a joint on the bench, and the compensator as one.

use strainwave::Error;
use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::schedule::Slot;
use strainwave::compensator::{Compensator, Input, JointParams, Output, State};

use crate::plant::divergence::RunError;

/// A controller of the joint.
pub trait Controller {
    /// Why a step failed, e.g. because the firmware no longer answers.
    type Error;

    /// One control period.
    ///
    /// # Errors
    /// Ends the run.
    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Self::Error>;
}

impl<C: Controller> Controller for &mut C {
    type Error = C::Error;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, C::Error> {
        (**self).step(input)
    }
}

/// The compensator in the firmware's precision, on the desktop.
#[derive(Clone)]
pub struct HostCompensator {
    model: Compensator<f32>,
    state: State<f32>,
}

impl HostCompensator {
    /// Builds from what the firmware is built from.
    ///
    /// # Errors
    /// As [`JointParams::build`].
    pub fn build(joint: &JointParams<f32>) -> Result<Self, Error> {
        let model = joint.build()?;
        let state = model.rest();
        Ok(Self { model, state })
    }

    /// Learnt factors and ripple so far.
    pub fn learnt(&self) -> Learnt<f32> {
        self.model.learnt(&self.state)
    }

    /// The slot that is next.
    pub fn slot(&self) -> Slot {
        self.state.slot()
    }

    /// One control step.
    pub fn step(&mut self, input: &Input<f32>) -> Output<f32> {
        self.model.step(&mut self.state, input)
    }
}

impl Controller for HostCompensator {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        Ok(self.step(input))
    }
}
