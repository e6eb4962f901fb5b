//! Parts of the linear controllers of a joint.

use strainwave::compensator::actuate::cascade::FeedbackParams;
use strainwave::compensator::estimate::disturbance::DisturbanceParams;
use strainwave::compensator::estimate::observer::ObserverParams;
use strainwave::compensator::reference::measured_feedback::MeasuredFeedbackParams;
use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;

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
