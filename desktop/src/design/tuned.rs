//! Tuned constants of the design rules: by which gains and noises follow from a gear file.
//!
//! One table with those of the control step, [`strainwave::compensator::tuned`], where it is said what a tuned constant is. The
//! outer frequency is that of the torsion mode, or less where [`INTEGRAL`] of it would be more than half of the position gain.

use strainwave::compensator::tuned::Tuned;

strainwave::tuned! {
    // Cascade.
    FILTER_TO_VELOCITY = 10.0, One,
        "Corner of the speed's filter over the velocity loop's bandwidth: its lag takes 6 degrees of the loop's phase";

    // Observer.
    WANDER = 0.15, One,
        "Largest random walk of the external torque in a second, in rated torques, less where the loop through the disturbance path bears less: \
         from 1.7 on the filter of the motor's encoder alone loses its stability where the stiffness is off by 10 %";
    FRICTION_NOISE = 0.04, One,
        "Part of a friction's level that is not known: what the filter takes for noise of the Coulomb friction, renewed in every period, and \
         the deviation of the motor's friction at rest where its encoder shows its path";
    STANDING_WANDER = 0.25, One,
        "Factor on the random walk while the motor stands, where the gains are to be small";

    // Output feedback.
    ADDED_DAMPING = 0.125, One,
        "Damping ratio that the output feedback adds to the torsion mode, by the estimate: by simulation of the default gear and of \
         training joints, as those of this group";
    MEASURED = 0.4, One,
        "What the output encoder adds in slow motion: damping ratio to the torsion mode, and stiffness of the joint's own";
    MEASURED_DAMPING_AT_REST = 0.55, One,
        "The damping ratio at rest, where more of it opposes a load step";
    PROPORTIONAL_AT_REST = 0.26, One,
        "The stiffness at rest, where a load step asks for torque by it";
    MEASURED_CORNER = 5.0, One,
        "Corner of the low pass on the output encoder's angle over the torsion mode's frequency: a count moves the reference by \
         P + 2*zeta*this = 4.4 counts in slow motion";
    INTEGRAL = 0.35, One,
        "Integral of the output's error, and corner of the disturbance path's slow part, of the outer frequency: of training plants \
         with all unknowns as few oscillate as with 0.3, with which the measured output leaves more of the kinematic error in slow motion";

    // Adaptation.
    LEARNING_RATE = 45.0, PerSecond,
        "Rate of a factor that its motion shows at once, where its torque is at its level: of inertia, compliance, with or without an \
         output encoder, and the presliding's stiffness";
    LARGEST_RIPPLE_SPEED = 0.375, One,
        "Speed of the motor up to which ripple of order 1 is learnt, of the torsion mode's frequency: well below the mode, where the sign of the \
         output's response changes";
}

/// Every tuned constant: of the control step, then of the design rules.
pub fn every() -> impl Iterator<Item = Tuned> + Clone {
    strainwave::compensator::tuned::TABLE.iter().chain(TABLE).copied()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn no_name_is_there_twice_and_every_reason_is_one() {
        let mut names = HashSet::new();
        for constant in every() {
            assert!(names.insert(constant.name), "{} is there twice", constant.name);
            assert!(constant.value.is_finite() && constant.value > 0.0, "{}", constant.name);
            assert!(constant.why.len() > 20, "{} has no reason", constant.name);
        }
    }
}
