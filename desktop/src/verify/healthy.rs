//! Healthy joints of the catalogue at work for hours: faults that are named on them, and feedback that is reduced.
//!
//! Every joint works [`DURATION`] through a life of its own ([`WorkingLife`]), on the condensed plant of its seed, with the sensors that it
//! was drawn with; all 500 together ten hours. As for [`crate::verify::catalogue`] its plant may differ by more than the box; with every
//! unknown at once gravity adds to the loads, and the drive gives 60 % of its torque.
//!
//! | figure | definition |
//! | --- | --- |
//! | `healthy.alarms` | joints on which a fault is named, a limited torque or setpoint and reduced feedback excepted; or that diverge |
//! | `healthy.reduced` | joints whose feedback the supervisor reduces |
//! | `healthy.reduced.time` | share of the time in which it is reduced; only reported |
//! | `healthy.stopped` | joints whose drive is off in the end; only reported |
//! | `healthy.limited` | joints whose torque or setpoint is limited; only reported |

use strainwave::Error;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{Faults, Mode};

use crate::bench::controller::HostCompensator;
use crate::bench::task::Task;
use crate::bench::working_life::WorkingLife;
use crate::bench::{Bench, Conditions};
use crate::catalogue::Joint;
use crate::design::joint::joint_params;
use crate::io::figure::Figure;
use crate::plant::divergence::RunError;
use crate::plant::unknowns::Which;
use crate::verify::Measured;
use crate::verify::catalogue::{Request, bounded, name};
use crate::verify::compensator::each;
use crate::verify::faults::LIMITS;

/// Working life of a joint (s).
pub const DURATION: f64 = 72.0;

/// The working life of one joint.
#[derive(Clone, Debug)]
pub struct Outcome {
    joint: Joint,
    /// Its length (s).
    duration: f64,
    /// When each fault was named first (s), in the order of [`Faults::NAMES`].
    first: Vec<Option<f64>>,
    /// Time with reduced feedback (s).
    reduced: f64,
    /// The drive was off in the end.
    stopped: bool,
    /// The plant diverged.
    diverged: bool,
}

/// All lives.
#[derive(Clone, Debug)]
pub struct Report {
    unknown: Which,
    outcomes: Vec<Outcome>,
}

/// Lets every requested joint work for `duration` (s); `progress` is called with the fraction done.
///
/// # Errors
/// A joint that no plant or compensator can be built for.
pub fn measure(request: &Request, duration: f64, mut progress: impl FnMut(f64)) -> Result<Report, Error> {
    let outcomes = each(&request.joints(), |joint| Outcome::of(joint, duration), &mut progress);
    Ok(Report { unknown: request.unknown, outcomes: outcomes.into_iter().collect::<Result<_, _>>()? })
}

impl Outcome {
    fn of(joint: &Joint, duration: f64) -> Result<Self, Error> {
        let life = WorkingLife::of(joint.seed, duration);
        let mut controller = HostCompensator::build(&joint_params(&joint.known)?)?;
        let mut bench = Bench::condensed_of(&joint.plant()?, &Conditions::of(&joint.known, joint.seed))?;
        let mut outcome = Self {
            joint: joint.clone(),
            duration: life.duration(),
            first: vec![None; Faults::NAMES.len()],
            reduced: 0.0,
            stopped: false,
            diverged: false,
        };
        let ended = bench.go(&life, &mut controller, |k, _, _, answer| {
            outcome.note(k as f64 * CONTROL_PERIOD, answer.faults);
            outcome.stopped = answer.mode == Mode::Safe;
        });
        match ended {
            Err(RunError::Parameter(error)) => return Err(error),
            Err(RunError::Diverged(_)) => outcome.diverged = true,
            Ok(_) => (),
        }
        Ok(outcome)
    }

    fn note(&mut self, time: f64, faults: Faults) {
        if faults.contains(Faults::FEEDBACK_REDUCED) {
            self.reduced += CONTROL_PERIOD;
        }
        for (first, (fault, _)) in self.first.iter_mut().zip(Faults::NAMES) {
            if first.is_none() && faults.contains(*fault) {
                *first = Some(time);
            }
        }
    }

    /// Names of the faults among `others`, each with the time at which it came first (s).
    fn among(&self, others: Faults) -> impl Iterator<Item = (&'static str, f64)> {
        let named = Faults::NAMES.iter().zip(&self.first);
        named
            .filter(move |((fault, _), _)| others.contains(*fault))
            .filter_map(|((_, name), first)| Some((*name, (*first)?)))
    }

    fn alarms(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let none = LIMITS.with(Faults::FEEDBACK_REDUCED).bits();
        self.among(Faults::from_bits(!none))
    }

    fn is_alarmed(&self) -> bool {
        self.diverged || self.alarms().next().is_some()
    }

    fn is_reduced(&self) -> bool {
        self.reduced > 0.0
    }

    /// The joint and what was named on it.
    fn line(&self) -> String {
        let named = self.alarms().map(|(name, time)| format!("{name} at {time:.1} s"));
        let reduced = self.is_reduced().then(|| format!("feedback reduced for {:.1} s", self.reduced));
        let diverged = self.diverged.then(|| "diverged".to_owned());
        let stopped = self.stopped.then(|| "stopped".to_owned());
        let words: Vec<_> = named.chain(reduced).chain(diverged).chain(stopped).collect();
        format!("{}: {}", self.joint.describe(), words.join(", "))
    }
}

impl Report {
    fn count(&self, holds: impl Fn(&Outcome) -> bool) -> f64 {
        self.outcomes.iter().filter(|outcome| holds(outcome)).count() as f64
    }

    fn sum(&self, of: impl Fn(&Outcome) -> f64) -> f64 {
        self.outcomes.iter().map(of).sum()
    }

    /// The figures with their bounds.
    pub fn figures(&self) -> Vec<Figure> {
        let duration = self.sum(|outcome| outcome.duration);
        let limited = self.count(|outcome| outcome.among(LIMITS).next().is_some());
        let reported = |figure: &str, value, unit| Figure::reported(name(figure, self.unknown), value, unit);
        let bounded = |rows, value| bounded(rows, self.unknown, value);
        vec![
            bounded(["healthy.alarms", "healthy.unknown.alarms"], self.count(Outcome::is_alarmed)),
            bounded(["healthy.reduced", "healthy.unknown.reduced"], self.count(Outcome::is_reduced)),
            reported("healthy.reduced.time", self.sum(|outcome| outcome.reduced) / duration, "1"),
            reported("healthy.stopped", self.count(|outcome| outcome.stopped), "joint"),
            reported("healthy.limited", limited, "joint"),
            reported("healthy.joints", self.outcomes.len() as f64, "joint"),
            reported("healthy.time", duration, "s"),
        ]
    }

    /// The figures, with notes on the `named` worst joints: those with an alarm first, then by the time of reduced feedback.
    pub fn measured(&self, named: usize) -> Measured {
        let mut worst: Vec<_> =
            self.outcomes.iter().filter(|outcome| outcome.is_alarmed() || outcome.is_reduced()).collect();
        worst.sort_by(|a, b| b.is_alarmed().cmp(&a.is_alarmed()).then(b.reduced.total_cmp(&a.reduced)));
        let notes = worst.into_iter().take(named).map(Outcome::line).collect();
        Measured { figures: self.figures(), notes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::Set;

    fn outcome() -> Outcome {
        let joint = Set::Training.joints().swap_remove(0);
        let first = vec![None; Faults::NAMES.len()];
        Outcome { joint, duration: 10.0, first, reduced: 0.0, stopped: false, diverged: false }
    }

    #[test]
    fn a_limit_is_no_alarm_and_reduced_feedback_is_counted_by_itself() {
        let mut limited = outcome();
        limited.note(1.0, LIMITS);
        assert!(!limited.is_alarmed() && !limited.is_reduced());
        let mut reduced = outcome();
        reduced.note(1.0, Faults::FEEDBACK_REDUCED);
        assert!(!reduced.is_alarmed() && reduced.is_reduced());
        let mut alarmed = outcome();
        alarmed.note(2.0, Faults::OVERSPEED);
        alarmed.note(3.0, Faults::OVERSPEED);
        assert_eq!(alarmed.alarms().collect::<Vec<_>>(), [("overspeed", 2.0)]);
        let figures = Report { unknown: Which::BOX, outcomes: vec![limited, reduced, alarmed] }.figures();
        let value = |name: &str| figures.iter().find(|figure| figure.name == name).unwrap().value;
        assert_eq!([value("healthy.alarms"), value("healthy.reduced"), value("healthy.limited")], [1.0; 3]);
    }

    #[test]
    fn the_joint_with_an_alarm_is_named_first() {
        let (mut reduced, mut alarmed) = (outcome(), outcome());
        reduced.reduced = 5.0;
        alarmed.note(2.0, Faults::OVERSPEED);
        let notes =
            Report { unknown: Which::BOX, outcomes: vec![outcome(), reduced, alarmed] }.measured(9).notes;
        assert_eq!(notes.len(), 2);
        assert!(
            notes[0].ends_with("overspeed at 2.0 s") && notes[1].ends_with("reduced for 5.0 s"),
            "{notes:?}"
        );
    }

    /// A joint at work, all of whose time counts.
    #[test]
    fn a_joint_works() {
        let report =
            measure(&Request { set: Set::Training, first: 3, count: 1, unknown: Which::BOX }, 2.0, |_| ())
                .unwrap();
        let outcome = &report.outcomes[0];
        assert!(outcome.duration >= 2.0 && !outcome.diverged && !outcome.stopped);
        assert!(!outcome.is_alarmed(), "{}", outcome.line());
    }
}
