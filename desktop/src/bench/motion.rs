//! Motion that a joint is tried in: a scenario, or a trajectory of the user.

use crate::bench::scenario::{Scenario, Stretch};
use crate::bench::task::{Demand, Task};
use crate::bench::trajectory::Trajectory;
use crate::design::capability::Capability;

/// A motion of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion<'a> {
    /// One of the six.
    Scenario(Scenario),
    /// The user's.
    Trajectory(&'a Trajectory),
}

impl Motion<'_> {
    /// The name, as in `s2`.
    pub fn name(self) -> &'static str {
        self.scenario().map_or("trajectory", Scenario::name)
    }

    /// One line for people.
    pub fn title(self) -> &'static str {
        self.scenario().map_or("trajectory of the user", Scenario::title)
    }

    /// The scenario, where it is one.
    pub fn scenario(self) -> Option<Scenario> {
        match self {
            Self::Scenario(scenario) => Some(scenario),
            Self::Trajectory(_) => None,
        }
    }

    /// From here on the error counts (s): of a trajectory all of it.
    pub fn judged_from(self) -> f64 {
        self.scenario().map_or(0.0, Scenario::judged_from)
    }

    /// Stretches of rest after a move; of a trajectory none are known.
    pub fn rests(self) -> Vec<Stretch> {
        self.scenario().map(Scenario::rests).unwrap_or_default()
    }

    /// Angle of the output where the bench has its zero (rad).
    pub fn zero(self) -> f64 {
        match self {
            Self::Scenario(_) => 0.0,
            Self::Trajectory(trajectory) => trajectory.zero(),
        }
    }
}

impl From<Scenario> for Motion<'_> {
    fn from(scenario: Scenario) -> Self {
        Self::Scenario(scenario)
    }
}

impl<'a> From<&'a Trajectory> for Motion<'a> {
    fn from(trajectory: &'a Trajectory) -> Self {
        Self::Trajectory(trajectory)
    }
}

impl Task for Motion<'_> {
    fn duration(&self) -> f64 {
        match self {
            Self::Scenario(scenario) => scenario.duration(),
            Self::Trajectory(trajectory) => trajectory.duration(),
        }
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        match self {
            Self::Scenario(scenario) => scenario.at(time, capability),
            Self::Trajectory(trajectory) => trajectory.at(time, capability),
        }
    }

    fn blocked(&self) -> bool {
        self.scenario().is_some_and(Scenario::blocked)
    }
}
