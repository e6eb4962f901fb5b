//! What has its turn in which control period.
//!
//! | period of a round | turn |
//! | --- | --- |
//! | first, third | the observer, and the load that it sees |
//! | second | command, feed-forward, output feedback, learnt ripple |
//! | fourth | the feed-forward's models, and by turns factors, deviations, shares |
//!
//! Encoders, cascade and torque command run in every one. So the model costs in each period what one of its parts
//! does. What the motor's sensors say of a load is in the torque two periods later at most; what the output's
//! encoder, the setpoint and the shares say takes a round and more.

/// Control periods from one turn of the observer to the next.
pub const OBSERVER_PERIODS: u32 = 2;

/// Control periods from one turn of everything else to the next.
pub const SLOW_PERIODS: u32 = 4;

/// Whose turn it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Slot {
    /// The observer's.
    #[default]
    Observe,
    /// The feed-forward's.
    Plan,
    /// The observer's again.
    ObserveAgain,
    /// Of what is learnt.
    Learn,
}

impl Slot {
    /// In the next control period.
    #[inline(always)]
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Observe => Self::Plan,
            Self::Plan => Self::ObserveAgain,
            Self::ObserveAgain => Self::Learn,
            Self::Learn => Self::Observe,
        }
    }
}

/// What the fourth period of a round is for beside the feed-forward's models.
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
            core::iter::successors(Some(Slot::default()), |turn| Some(turn.next())).take(9).collect();
        let observes = |turn: &Slot| matches!(turn, Slot::Observe | Slot::ObserveAgain);
        for (k, turn) in turns.iter().enumerate() {
            assert_eq!(*turn, turns[k % SLOW_PERIODS as usize]);
            assert_eq!(observes(turn), k % OBSERVER_PERIODS as usize == 0);
        }
        assert!(turns.contains(&Slot::Plan) && turns.contains(&Slot::Learn));
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
