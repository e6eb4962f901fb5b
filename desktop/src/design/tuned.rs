//! Tuned constants of the design rules: by which gains and noises follow from a gear file.
//!
//! One table with those of the control step, [`strainwave::compensator::tuned`], where it is said what a tuned constant is. The
//! outer frequency is that of the torsion mode, or [`OUTER_TO_POSITION`] times the position gain where that is less.

use strainwave::compensator::tuned::Tuned;

strainwave::tuned! {
    // Cascade.
    FILTER_TO_VELOCITY = 10.0, One,
        "Corner of the speed's filter over the velocity loop's bandwidth: its lag takes 6 degrees of the loop's phase";

    // Observer.
    STILL_NOISE = 0.5, Count,
        "Noise of the encoder of a motor that stands, besides its resolution, in counts of 2^19 a revolution";
    MOTION_THRESHOLD = 8.0, One,
        "Way of the motor that is a motion, in deviations of its encoder's noise: no noise is taken for one";
    UNOBSERVED_RATE = 1.0, PerSecond,
        "Speed at which a load that is not seen may grow, in rated torques";
    FOLLOWED_FRICTION = 0.03, One,
        "Deviation of the motor's friction at rest where its encoder shows its path, of the static level";
    HELD_FRICTION = 0.4, One,
        "The same of a motor that stands, which a brake may hold";
    OUTPUT_FRICTION = 0.75, One,
        "The same of the output, whose presliding is shorter than what is known of its path";
    WANDER = 0.15, One,
        "Largest random walk of the external torque in a second, in rated torques, less where the loop through the disturbance path bears less: \
         from 1.7 on the filter of the motor's encoder alone loses its stability where the stiffness is off by 10 %";
    RENEWED_FRICTION = 0.05, One,
        "Part of the Coulomb friction that the filter takes for noise, renewed in every period";
    OUTPUT_JITTER = 4.0, Count,
        "The same of the output's: in slow motion the error of a count is a wave that follows the angle, which is averaged over many \
         counts; with more of it the estimate vibrates where friction holds the output";
    STANDING_WANDER = 0.1, One,
        "Factor on the random walk while the motor stands, where the gains are to be small";
    STANDING_FRICTION = 0.2, One,
        "The same on the renewed friction";

    // Output feedback.
    ADDED_DAMPING = 0.125, One,
        "Damping ratio that the output feedback adds to the torsion mode, by the estimate: by simulation of the default gear and of \
         training joints, as those of this group";
    MEASURED_DAMPING = 0.4, One,
        "The same by the output encoder, in slow motion";
    MEASURED_DAMPING_AT_REST = 0.55, One,
        "The same at rest, where more of it opposes a load step";
    PROPORTIONAL = 0.4, One,
        "Stiffness that the output encoder's angle adds in slow motion, of the joint's own";
    PROPORTIONAL_AT_REST = 0.26, One,
        "The same at rest, where a load step asks for torque by it";
    MEASURED_CORNER = 5.0, One,
        "Corner of the low pass on the output encoder's angle over the torsion mode's frequency: a count moves the reference by \
         P + 2*zeta*this = 4.4 counts in slow motion";
    INTEGRAL = 0.3, One,
        "Integral of the output's error, of the outer frequency: with a third more at rest, and poles a quarter higher, 17 of 1200 runs of \
         training plants with all unknowns oscillate and 41 are worse than the cascade, with this 5 and 20";
    FILTER_CORNER = 1.2, One,
        "Corner of the integral's poles over the torsion mode's frequency: it takes a damping ratio of 0.015 off the mode, of 0.15 \
         without them; a load that flexes has its mode up to a third lower";
    OUTER_TO_POSITION = 1.75, One,
        "Largest outer frequency over the position gain: an integral is no faster than the position loop bears";

    // Disturbance path.
    SLOW_CORNER = 0.4, One,
        "Corner of the slow part, of the outer frequency: with half of it a heavy joint is still off by a tenth of a load step's wind-up \
         half a second later, and 27 more runs of the training joints are worse than a baseline";

    // Adaptation.
    FACTOR_ROOM = 1.25, One,
        "Room that a factor has, in tolerances of the gear file";
    INERTIA_RATE = 30.0, PerSecond,
        "Rate of the inertia's factor where its torque is the rated one";
    STABLE_SHARE = 0.75, One,
        "Part of the rate from which on a step of the adaptation at the peak torque is not stable";
    FRICTION_RATE = 1.2, PerSecond,
        "Rate of the friction's factor at its Coulomb level, on the motor's side";
    OUTPUT_FRICTION_RATE = 0.3, PerSecond,
        "The same on the output's side, which shows less of it";
    PRESLIDING_RATE = 8.0, PerSecond,
        "Rate of the presliding's shape, where it weighs as much as the Coulomb levels";
    PRESLIDING_STIFFNESS_RATE = 40.0, PerSecond,
        "The same of its stiffness";
    COMPLIANCE_RATE = 80.0, PerSecond,
        "Rate of the compliance's factor at the rated torque's torsion";
    FLEXING_RATE = 60.0, PerSecond,
        "The same without an output encoder, at the flexing torque of the next line";
    FLEXING_LEVEL = 0.06, One,
        "Largest flexing torque that counts, in rated torques";
    RESIDUAL_DEAD_ZONE = 0.001, One,
        "Dead zone of the residual that is learnt from, in rated torques: wider than its noise";
    REGRESSOR_CORNER = 200.0, RadianPerSecond,
        "Corner of the low passes on the regressors: as slow as the observer's external torque, of the default gear";
    BIAS_CORNER = 2.0, RadianPerSecond,
        "Corner of the constant load that is told from the factors: slow against a motion of any joint";

    // Ripple.
    POSITION_RIPPLE_RATE = 1.0 / 64.0, One,
        "Rate of the position's ripple, of the outer frequency: the loop through the torsion mode is stable below 0.036, for a damping ratio \
         of 0.1 and a mode at the ends of its tolerance";
    TORQUE_RIPPLE_RATE = 1.0, PerSecond,
        "Rate of the torque's ripple";
    LARGEST_RIPPLE = 3e-4, Radian,
        "Largest coefficient of the position's ripple: a kinematic error of about an arcminute";
    LARGEST_TORQUE_RIPPLE = 0.3, One,
        "The same of the torque's, in Coulomb levels of the motor's side";
    LEAST_RIPPLE_SPEED = 1.0 / 160.0, One,
        "Speed of the motor from which on ripple is learnt, of the torsion mode's frequency";
    LARGEST_RIPPLE_SPEED = 0.375, One,
        "Speed up to which it is, of order 1: well below the mode, where the sign of the output's response changes";
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
