//! Parts of the linear controllers of a joint.

use strainwave::compensator::actuate::cascade::FeedbackParams;
use strainwave::compensator::estimate::disturbance::DisturbanceParams;
use strainwave::compensator::estimate::observer::ObserverParams;
use strainwave::compensator::reference::measured_feedback::MeasuredFeedbackParams;
use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;
use strainwave::compensator::tuned::UNCERTAINTY_MARGIN;

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
    /// With the cascade that is left where the supervisor ([`strainwave::compensator::actuate::supervisor`]) has taken the
    /// feedback functions away.
    #[must_use]
    pub(crate) fn softened(&self) -> Self {
        let mut parts = *self;
        parts.feedback.position_gain /= UNCERTAINTY_MARGIN.get();
        parts.feedback.integral_time *= UNCERTAINTY_MARGIN.get();
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::cascade;
    use crate::design::rules::parts;
    use crate::io::gear_file::GearFile;
    use strainwave::compensator::actuate::cascade::{CascadeInput, FeedbackState, Stiffness};
    use strainwave::compensator::schedule::CONTROL_PERIOD;

    /// The linear analysis and the control step soften it alike.
    #[test]
    fn a_softened_cascade_is_the_one_that_the_control_step_softens() {
        let built = parts(&GearFile::default_gear()).unwrap();
        let torques = |parts: Parts, stiffness| {
            let feedback = parts.feedback.build(CONTROL_PERIOD).unwrap();
            let mut state = FeedbackState::default();
            [1e-4, -3e-4, 2e-4, 5e-4].map(|position_error| {
                let input = CascadeInput { position_error, ..CascadeInput::default() };
                feedback.step(&mut state, 1e-2, &input, stiffness, false)
            })
        };
        let by_gains = torques(built.softened(), Stiffness::FULL);
        let by_stiffness = torques(built, Stiffness::FULL.softer(0.0));
        assert!(by_gains.iter().zip(by_stiffness).all(|(a, b)| (a / b - 1.0).abs() < 1e-12));
        assert_ne!(by_gains, torques(built, Stiffness::FULL));
    }

    /// Lead of the torque over the motor's angle (rad): positive where the cascade damps.
    fn lead(feedback: &FeedbackParams<f64>, omega: f64) -> f64 {
        cascade::answer(feedback, omega).arg()
    }

    #[test]
    fn a_cascade_damps_above_its_own_frequency_and_a_softened_one_further_down() {
        let built = parts(&GearFile::default_gear()).unwrap();
        for feedback in [built, built.softened()].map(|parts| parts.feedback) {
            let own = (feedback.position_gain / feedback.integral_time).sqrt();
            let [below, at, above] = [0.8, 1.0, 1.25].map(|factor| lead(&feedback, factor * own));
            assert!(below < 0.0 && (-0.1..0.0).contains(&at) && above > 0.0, "{below} {at} {above}");
        }
    }
}
