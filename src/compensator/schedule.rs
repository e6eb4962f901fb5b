//! Multi-rate schedule: which stage runs in which control period.
//!
//! | period of a round | slot |
//! | --- | --- |
//! | first, third, fifth, seventh | observer and fast disturbance estimate; in the first after them the output encoder's torsion beside the rotor's, in the fifth before them the correction of the observer's gear by the learnt factors |
//! | second | command, feed-forward, output feedback |
//! | fourth | slow disturbance estimate, line and hysteresis; in rotation: factors, standard deviations, the gains' ramp |
//! | sixth | correction of the observer by the output encoder's reading of the fifth; checks of the rotor and the sensors; learning of the ripple |
//! | eighth | the feed-forward's kinematic error and friction; the learnt ripple's value |
//!
//! The second, fourth, sixth and eighth period have the feedback of the output encoder's angle besides. Encoders, cascade and torque
//! command run in every period, so that the model costs in each period no more than one of
//! its parts. Latency: motor's encoder and torque to the torque command, at most two periods; output encoder, setpoint
//! and gains, up to a round and a period.
//!
//! A slot waits for the next period where this one has rare work of its own, so that both are never in one period:
//!
//! | rare work | how often at most |
//! | --- | --- |
//! | a count of the motor's encoder that is refused, and the first one after it | until the angle is lost ([`crate::compensator::sense::motor_encoder`]) |
//! | a change of the drive's mode | while the drive is switched in every period, it has no reference and gives no torque |
//! | a control overrun | 2 ms of them lead to Safe ([`crate::compensator::actuate::mode`]) |
//! | the output encoder's zero | once |
//! | a reference that begins, is commanded in another kind or by no number, or approaches its command | the command's slot takes two periods: a round then has nine |
//!
//! What is integrated or averaged goes by the time and the number of steps that it took, not by the round's nominal length. While
//! the drive is off no torque is computed. The faults of a slot count from the next period on, where the mode follows them before
//! anything else is done.

/// Control period of a joint (s): from one control step to the next.
pub const CONTROL_PERIOD: f64 = 1e-4;

/// Control periods from one observer slot to the next.
pub const OBSERVER_PERIODS: u32 = 2;

/// Control periods of a round, from one slot of everything else to the next.
pub const SLOW_PERIODS: u32 = 8;

/// Control periods from the feed-forward's slot to the adaptation's.
pub const PLAN_TO_LEARN: u32 = 2;
/// Control periods from the feed-forward's slot to that of its models.
pub const PLAN_TO_MODELS: u32 = 6;
/// Control periods from the models' slot to the feed-forward's next.
pub const MODELS_TO_PLAN: u32 = SLOW_PERIODS - PLAN_TO_MODELS;

/// The slot of a control period.
///
/// The observer runs in every second control period, everything else once a round:
///
/// ```
/// use strainwave::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS, Slot};
///
/// let round = std::iter::successors(Some(Slot::default()), |slot| Some(slot.next())).take(SLOW_PERIODS as usize);
/// let slots: Vec<Slot> = round.collect();
/// assert_eq!(slots.iter().filter(|slot| slot.observes()).count(), (SLOW_PERIODS / OBSERVER_PERIODS) as usize);
/// assert_eq!(slots.iter().filter(|slot| **slot == Slot::Plan).count(), 1);
/// assert_eq!(slots.last().unwrap().next(), slots[0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Slot {
    /// The observer.
    #[default]
    Observe,
    /// The feed-forward.
    Plan,
    /// The observer.
    ObserveSecond,
    /// The adaptation and the slow disturbance estimate.
    Learn,
    /// The observer, whose gear is corrected first; the output encoder's reading of this period is kept.
    ObserveOutput,
    /// Checks of the rotor and the sensors.
    Check,
    /// The observer.
    ObserveLast,
    /// The feed-forward's models.
    Model,
}

impl Slot {
    /// The observer runs.
    #[inline(always)]
    pub fn observes(self) -> bool {
        matches!(self, Self::Observe | Self::ObserveSecond | Self::ObserveOutput | Self::ObserveLast)
    }

    /// In the next control period.
    #[inline(always)]
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Observe => Self::Plan,
            Self::Plan => Self::ObserveSecond,
            Self::ObserveSecond => Self::Learn,
            Self::Learn => Self::ObserveOutput,
            Self::ObserveOutput => Self::Check,
            Self::Check => Self::ObserveLast,
            Self::ObserveLast => Self::Model,
            Self::Model => Self::Observe,
        }
    }
}

/// Functions that share the fourth period of a round in rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlowSlot {
    /// The adaptive factors.
    #[default]
    Adapt,
    /// The estimates' standard deviations, and the test for frozen encoders.
    StandardDeviations,
    /// The ramp of the compensation functions' gains, while one has not settled.
    RampGains,
}

/// Number of slow slots.
pub const SLOW_SLOTS: u32 = 3;

impl SlowSlot {
    /// In the next round.
    #[inline(always)]
    #[must_use]
    pub fn next(self, gains_have_settled: bool) -> Self {
        match self {
            Self::Adapt => Self::StandardDeviations,
            Self::StandardDeviations if !gains_have_settled => Self::RampGains,
            Self::StandardDeviations | Self::RampGains => Self::Adapt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_round_has_every_slot_and_the_observer_in_every_second_period() {
        let slots: Vec<Slot> =
            core::iter::successors(Some(Slot::default()), |slot| Some(slot.next())).take(17).collect();
        let observes = |slot: &Slot| slot.observes();
        for (k, slot) in slots.iter().enumerate() {
            assert_eq!(*slot, slots[k % SLOW_PERIODS as usize]);
            assert_eq!(observes(slot), k % OBSERVER_PERIODS as usize == 0);
        }
        let place = |slot: Slot| slots.iter().position(|other| *other == slot).unwrap() as u32;
        assert_eq!(place(Slot::Learn) - place(Slot::Plan), PLAN_TO_LEARN);
        assert_eq!(place(Slot::Model) - place(Slot::Plan), PLAN_TO_MODELS);
        for slot in [Slot::Plan, Slot::Learn, Slot::Check, Slot::Model] {
            assert!(slots.contains(&slot), "{slot:?}");
        }
    }

    /// While a gain is ramped, the other slots still come in every third round.
    #[test]
    fn the_gains_ramp_takes_every_third_slot_at_most() {
        for (settled, others) in [(true, 2), (false, SLOW_SLOTS as usize)] {
            let slow: Vec<SlowSlot> =
                core::iter::successors(Some(SlowSlot::Adapt), |slow| Some(slow.next(settled)))
                    .take(12)
                    .collect();
            for slot in [SlowSlot::Adapt, SlowSlot::StandardDeviations] {
                assert_eq!(slow.iter().filter(|other| **other == slot).count(), 12 / others);
            }
            assert_eq!(slow.contains(&SlowSlot::RampGains), !settled);
        }
    }
}
