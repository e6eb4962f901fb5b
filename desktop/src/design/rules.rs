//! The gains of a joint: what the rules of every part give for its file.

use strainwave::Error;

use super::estimated_damping;
use super::integral_level;
use super::parts::Parts;
use crate::design::feedback::feedback_params;
use crate::design::{compensation, observer_design};
use crate::io::gear_file::GearFile;

/// Of the joint of a gear file.
///
/// # Errors
/// As [`observer_design::observer_params`].
pub fn parts(file: &GearFile) -> Result<Parts, Error> {
    let mut parts = whole(file)?;
    let bears = estimated_damping::Levels::of(file, &parts);
    for ((gains, in_motion), at_rest) in
        parts.output_feedback.iter_mut().zip(bears.in_motion).zip(bears.at_rest)
    {
        gains.damping *= in_motion;
        gains.damping_at_rest *= at_rest;
    }
    parts.output_feedback[1].integral *= integral_level::level(file, &parts);
    Ok(parts)
}

/// The same with all of the damping by the estimate and of the integral.
pub(super) fn whole(file: &GearFile) -> Result<Parts, Error> {
    Ok(Parts {
        observer: observer_design::observer_params(file)?,
        feedback: feedback_params(file),
        disturbance: compensation::disturbance_params(file),
        output_feedback: compensation::output_feedback_params(file),
        measured_feedback: compensation::measured_feedback_params(file),
    })
}
