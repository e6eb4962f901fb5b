//! Multi-rate schedule: which stage runs in which control period.
//!
//! | period of a round | slot |
//! | --- | --- |
//! | first, third, fifth, seventh | observer and fast disturbance estimate |
//! | second | command, feed-forward, output feedback |
//! | fourth | slow disturbance estimate; in rotation factors, standard deviations, the gains' ramp |
//! | sixth | correction of the observer by the output encoder's reading of the fifth; checks of the rotor and the sensors |
//! | eighth | the feed-forward's models, learnt ripple |
//!
//! Encoders, cascade and torque command run in every period. So the model costs in each period what one of its parts
//! does. What the motor's sensors show of a load is in the torque two periods later at most; what the output's
//! encoder, the setpoint and the gains say takes up to a round and a period.

/// Control periods from one observer slot to the next.
pub const OBSERVER_PERIODS: u32 = 2;

/// Control periods of a round, from one slot of everything else to the next.
pub const SLOW_PERIODS: u32 = 8;

/// Control periods from the feed-forward's slot to that of what is learnt.
pub const PLAN_TO_LEARN: u32 = 2;
/// The same to its models'.
pub const PLAN_TO_MODELS: u32 = 6;
/// The same from the models' slot to the feed-forward's next.
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
    /// What is learnt.
    Learn,
    /// The observer; the output encoder's reading of this period is kept.
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

/// What the fourth period of a round is for in rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlowSlot {
    /// The factors.
    #[default]
    Adapt,
    /// The estimates' deviations, and encoders that stand still.
    Deviate,
    /// The shares, while one is on its way.
    Lead,
}

/// How many there are.
pub const SLOW_SLOTS: u32 = 3;

impl SlowSlot {
    /// In the next round.
    #[inline(always)]
    #[must_use]
    pub fn next(self, shares_have_arrived: bool) -> Self {
        match self {
            Self::Adapt => Self::Deviate,
            Self::Deviate if !shares_have_arrived => Self::Lead,
            Self::Deviate | Self::Lead => Self::Adapt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn in_a_round_everyone_has_a_turn_and_the_observer_every_second() {
        let turns: Vec<Slot> =
            core::iter::successors(Some(Slot::default()), |turn| Some(turn.next())).take(17).collect();
        let observes = |turn: &Slot| turn.observes();
        for (k, turn) in turns.iter().enumerate() {
            assert_eq!(*turn, turns[k % SLOW_PERIODS as usize]);
            assert_eq!(observes(turn), k % OBSERVER_PERIODS as usize == 0);
        }
        let place = |slot: Slot| turns.iter().position(|other| *other == slot).unwrap() as u32;
        assert_eq!(place(Slot::Learn) - place(Slot::Plan), PLAN_TO_LEARN);
        assert_eq!(place(Slot::Model) - place(Slot::Plan), PLAN_TO_MODELS);
        for slot in [Slot::Plan, Slot::Learn, Slot::Check, Slot::Model] {
            assert!(turns.contains(&slot), "{slot:?}");
        }
    }

    /// While a share is on its way, nobody starves.
    #[test]
    fn who_leads_takes_a_turn_from_nobody() {
        for (arrived, others) in [(true, 2), (false, SLOW_SLOTS as usize)] {
            let slow: Vec<SlowSlot> =
                core::iter::successors(Some(SlowSlot::Adapt), |slow| Some(slow.next(arrived)))
                    .take(12)
                    .collect();
            for turn in [SlowSlot::Adapt, SlowSlot::Deviate] {
                assert_eq!(slow.iter().filter(|had| **had == turn).count(), 12 / others);
            }
            assert_eq!(slow.contains(&SlowSlot::Lead), !arrived);
        }
    }
}
