//! Tuned constants of the compensator, one table: every one with its unit and the reason of its value.
//!
//! A constant is tuned when another value would be no mistake: it was chosen by what joints do with it. [`TABLE`] has those of
//! the control step and of what it is built from; those of the rules by which a gear file becomes its gains stand in
//! `strainwave_desktop::design::tuned`, declared alike. Not tuned, and beside the code that they belong to, are
//!
//! - the schedule, sizes and number formats,
//! - ranges of validity, and guards of the arithmetic,
//! - the rounding of a count, and a factor whose derivation stands at its formula.
//!
//! A time is in seconds, and becomes whole periods where something is built or stepped ([`Tuned::periods`]).
//!
//! `strainwave verify constants` runs joints with each of them halved and doubled. For that the cargo feature
//! `scaled-constants` looks every value up at run time, times a factor that is 1 but for one constant at a time. Without the
//! feature, as in firmware, a value is a constant of the program.

use crate::constants::{START, fingerprint};

/// Unit of a tuned constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// A ratio, or a number of events.
    One,
    /// s
    Second,
    /// 1/s
    PerSecond,
    /// rad
    Radian,
    /// rad/s
    RadianPerSecond,
    /// Counts of an encoder.
    Count,
}

impl Unit {
    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::One => "1",
            Self::Second => "s",
            Self::PerSecond => "1/s",
            Self::Radian => "rad",
            Self::RadianPerSecond => "rad/s",
            Self::Count => "count",
        }
    }
}

/// A tuned constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// As in the code.
    pub name: &'static str,
    /// In `unit`, not scaled.
    pub value: f64,
    /// Of the value.
    pub unit: Unit,
    /// What it is, and why it has its value.
    pub why: &'static str,
    /// Fingerprint of the name: which constant is scaled.
    key: u32,
}

impl Tuned {
    /// A constant; [`crate::tuned!`] declares a table of them.
    pub const fn new(name: &'static str, value: f64, unit: Unit, why: &'static str) -> Self {
        Self { name, value, unit, why, key: fingerprint(START, name.as_bytes()) }
    }

    /// The value.
    #[cfg(not(feature = "scaled-constants"))]
    #[inline(always)]
    pub const fn get(self) -> f64 {
        self.value
    }

    /// The value, times the factor that this constant is scaled by.
    #[cfg(feature = "scaled-constants")]
    #[inline(always)]
    pub fn get(self) -> f64 {
        scaling::scaled(self.key, self.value)
    }

    /// A time (s) in whole periods of this duration (s): the nearest number, at least 1.
    #[inline(always)]
    pub fn periods(self, period: f64) -> u32 {
        ((self.get() / period + 0.5) as u32).max(1)
    }
}

#[cfg(feature = "scaled-constants")]
pub use scaling::Scaled;

#[cfg(feature = "scaled-constants")]
mod scaling {
    use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

    use super::Tuned;

    /// Key of no constant.
    const NONE: u32 = 0;

    /// Key of the constant that is scaled, and the bits of its factor: for every thread, as a run uses many.
    static KEY: AtomicU32 = AtomicU32::new(NONE);
    static FACTOR: AtomicU32 = AtomicU32::new(0);

    #[inline(always)]
    pub(super) fn scaled(key: u32, value: f64) -> f64 {
        if KEY.load(Relaxed) == key { value * f64::from(f32::from_bits(FACTOR.load(Relaxed))) } else { value }
    }

    /// A constant is scaled until this is dropped.
    #[must_use = "dropped, the constant has its value again"]
    #[derive(Debug)]
    pub struct Scaled(());

    impl Tuned {
        /// Scales the constant, for every thread; `None` while one is scaled already.
        ///
        /// What was built before keeps the value that it was built with.
        pub fn scale(self, factor: f32) -> Option<Scaled> {
            KEY.compare_exchange(NONE, self.key, Relaxed, Relaxed).ok()?;
            FACTOR.store(factor.to_bits(), Relaxed);
            Some(Scaled(()))
        }
    }

    impl Drop for Scaled {
        fn drop(&mut self) {
            KEY.store(NONE, Relaxed);
        }
    }
}

/// Declares tuned constants, a line each: `NAME = value, Unit, "what it is: why it has its value";`, and `TABLE`, all of them.
#[macro_export]
macro_rules! tuned {
    ($($name:ident = $value:expr, $unit:ident, $why:literal;)*) => {
        $(
            #[doc = $why]
            pub const $name: $crate::compensator::tuned::Tuned = $crate::compensator::tuned::Tuned::new(
                stringify!($name),
                $value,
                $crate::compensator::tuned::Unit::$unit,
                $why,
            );
        )*

        /// All of them.
        pub const TABLE: &[$crate::compensator::tuned::Tuned] = &[$($name),*];
    };
}

/// Gain margin that every loop is asked to have: 6 dB. Asked, not tuned.
pub const GAIN_MARGIN: f64 = 2.0;

/// Time in which an oscillation is to end (s). Asked, not tuned. A load step is beyond the dead zone of the disturbance path for less.
pub const OSCILLATION_TIME: f64 = 0.15;

/// Standard deviation of a torque that goes to and fro between its limits evenly, in those: of a triangular wave. A sine from limit to limit has
/// more, 0.7.
pub const LIMIT_TO_LIMIT: f64 = 0.577_350_269_189_625_8;

tuned! {
    // Of several stages: what an uncertainty of one kind is, wherever it acts.
    RECOVERY = 0.1, One,
        "Part of what a fault has counted, or lasted, that a sound sample takes off: one in eleven may be bad; a bit that is stuck and an \
         oscillation, which is sound for some of its time, make more of them, and a sound line far fewer";
    NOISE_TORQUE = 0.05, One,
        "Torque that noise may make, in motor's peak torques: a count of the output encoder in slow motion by its feedback; and what measured \
         and commanded torque differ by, some ten times the noise of the default joint's measurement";
    OSCILLATIONS = 3.0, One,
        "Windows on end that oscillate, reversals of a load beyond the dead zone, and periods of the torque from limit to limit, that are an \
         oscillation: a load step and its vibration are in two windows, a load that comes and goes has two reversals with its ringing";
    FAULT_TIME = 2e-3, Second,
        "Time of wrong samples on end that is a fault: of bad frames of the motor's encoder, after which its angle is lost, less than half of \
         the 5 ms in which that is to be named; of overruns of the control, after which the drive is off; and of corrections of the external \
         torque, which widen the declared deviations where they last longer";
    TRANSIENT_TIME = 8e-3, Second,
        "Time of a transient of the motor's torque, ten rounds: of its ramp from one end of its range to the other, so that a fallback makes no \
         step; and for which a sensor at the output may disagree with the motor's side, as what is uncertain of both for a moment is no fault";
    SETTLED_TIME = 0.02, Second,
        "Time after which a state of the joint's inputs is settled, twenty periods of an outer controller of 1 kHz: at which a setpoint is \
         stale, and a slip of it forgotten; without motion of its encoder, at which a motor stands, and the observer's gains are those of one \
         that a brake may hold; and in which a gain goes from 0 to 1, so that one that is switched makes no step of the output, at most 6 % \
         of it at a time";
    RESERVE = 0.15, One,
        "Part of a torque that is kept for what is not foreseen: of an approach beside a load's, for any estimate of it; and of that of an \
         approach for the brake, as the rest is the setpoint's, a load's and a weak drive's";
    FADING_TIME = 0.5, Second,
        "Time in which the friction that is fed forward fades at rest, so that a joint of less friction than the model's is not driven by \
         it; without a fault of its inputs, after which the model is trusted again; and without the feedback after an oscillation, and in \
         which that comes back: slow against any vibration, and one of 10 Hz decays in it that the cascade hardly damps";
    TORQUE_CORNER = 140.0, RadianPerSecond,
        "Corner of what is compared with a torque that is not commanded: low pass of the measured torque where another controller moves \
         the motor, and, as slow as the observer's external torque of the default gear, of what the adaptation explains that by";
    HYSTERESIS_TORQUE = 0.045, One,
        "Torque that the torsion does not tell, in rated torques: that of a stiffness error at no torsion, by hysteresis and the encoders' \
         zero; and the largest flexing torque that the compliance is learnt from";
    ENCODER_NOISE = 3.0, Count,
        "Noise of an encoder besides its resolution, from the lowest to the highest: of the motor's in a control period, for the observer, in \
         counts of 2^19 a revolution; so many counts are no motion of a motor that stands, nor a distance from where it is to rest; half of \
         it, with its rounding, is the dead zone of a resting output's angle";

    // Sensors.
    UNCERTAINTY_MARGIN = 1.5, One,
        "What is a fault, over the largest that a sound joint within its tolerances makes, and what is asked of it less: half as much \
         again for what they do not say; the position error of a lost reference, over that at which the cascade asks for all of the motor's \
         torque; and what a cascade is slower by whose feedback functions were reduced";
    MOTOR_PATH = 0.5, Radian,
        "Commanded path of the motor in which its encoder moves, unless it is frozen: an angle, whatever the gear";
    DRIVE_CORNER = 7.0, RadianPerSecond,
        "Corner between commanded and measured motor torque: noise of the measurement above it, a drive's errors below it";

    // References.
    SLOW_SPEED = 0.05, One,
        "Slow motion, in joint's speeds: up to it the output feedback integrates, before the error of a fast move changes its sign, and the \
         gains of either direction are mixed, without a step at a reversal";
    MOTOR_LAG = 0.5, One,
        "Part of a resting motor's lag that the output feedback's integral takes for output that is not missing: with none, joints of much \
         static friction hunt; with all of it z waits for the cascade in S1. Of 625 runs of training joints with both encoders 112 are \
         worse than a baseline, 124 with 1, 128 with 0";

    // Torque command.
    COARSE_COUNT = 0.015, One,
        "Torque by a count of the motor's encoder with which the observer's speed damps a resting motor, in motor's peak torques. \
         Of 1250 runs of training joints 2 keep oscillating and 140 are worse than a baseline; with 0.05 6 and 139, without the \
         observer's speed 12 and 139, without a bound 3 and 148: these three at any distance from the reference";
    LIMIT_CYCLE_TORSION = 0.005, One,
        "Standard deviation of the torsion that oscillates at rest, in torsions of the rated torque: 7 urad of the default \
         gear, less than what is called shaking";
    DECAYED = 0.75, One,
        "Part of its variance that a vibration has left after a period, if it decays: a damping ratio of 0.025";
    LONGEST_HOLD = 8.0, Second,
        "Longest time without the feedback after an oscillation: one that always comes back is there for a fiftieth of the time; and the time in which the cascade is as \
         stiff again as it was built";

    // Adaptation.
    SLOW_RATE = 1.4, PerSecond,
        "Rate of what is to be slow against a reversal of the motion, and how fast a load grows that nobody sees: of the friction's \
         factors, of the load that is told from them, of gravity's cosine and of the torque's ripple";
    RARE_RATE = 8.0, PerSecond,
        "The same of what a motion shows for a part of it: gravity's sine, as a joint works within a part of a revolution, and the shape of \
         the presliding, which is there after a reversal";
    FALSE_RIPPLE = 0.18, One,
        "Part of a ripple that another error may be taken for: what a constant moves a coefficient there and back in a radian of its wave, a \
         position error in largest ripples, and the relative change of a steady speed in a radian of the motor";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_so_many_periods() {
        let time = |value| Tuned::new("TIME", value, Unit::Second, "an example");
        assert_eq!([2e-3, 0.02, 3.2e-3, 1e-9].map(|value| time(value).periods(1e-4)), [20, 200, 32, 1]);
        assert_eq!((SETTLED_TIME.periods(2e-4), FAULT_TIME.periods(2e-4)), (100, 10));
    }
}
