//! Parts of the linear controllers of a joint.

use strainwave::Error;
use strainwave::compensator::actuate::cascade::FeedbackParams;
use strainwave::compensator::estimate::disturbance::DisturbanceParams;
use strainwave::compensator::estimate::observer::ObserverParams;
use strainwave::compensator::reference::measured_feedback::MeasuredFeedbackParams;
use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;

use crate::design::feedback::feedback_params;
use crate::design::{compensation, observer_design};
use crate::io::gear_file::GearFile;

/// Gains that the file and the rules give.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    /// Gains of the observer.
    pub observer: ObserverParams<f64>,
    /// The cascade.
    pub feedback: FeedbackParams<f64>,
    /// The disturbance path.
    pub disturbance: DisturbanceParams<f64>,
    /// Without and with an output encoder.
    pub output_feedback: [OutputFeedbackParams<f64>; 2],
    /// By the output encoder's angle.
    pub measured_feedback: MeasuredFeedbackParams<f64>,
}

impl Parts {
    /// Of the joint of a gear file.
    ///
    /// # Errors
    /// As [`observer_design::observer_params`].
    pub fn of(file: &GearFile) -> Result<Self, Error> {
        Ok(Self {
            observer: observer_design::observer_params(file)?,
            feedback: feedback_params(file),
            disturbance: compensation::disturbance_params(file),
            output_feedback: compensation::output_feedback_params(file),
            measured_feedback: compensation::measured_feedback_params(file),
        })
    }
}
