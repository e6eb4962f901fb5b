//! The worst runs of every claim, to be made again on the reference mesh, by whatever runs the compensator there.
//!
//! | claim | value of a run |
//! | --- | --- |
//! | `shakes` | oscillation at rest over the largest that is none against B0's |
//! | `limited` | time at the torque limit in the judged part (s) |
//! | `worse` | largest ratio to B0's of a metric that is more than a count above it |
//! | a metric's | ratio to the best rival's |
//! | `rest.torque` | motor torque's oscillation at rest over B0's |
//!
//! Each run is made as it was on the condensed mesh: 10 s of work, the scenario, the rest.

use strainwave::Error;

use super::run_result::{JUDGED, Judged, RunResult, torque_ratio};
use super::summary::{RATIOS, Robustness, reads_no_more};
use super::{Outcome, RIVALS, Rival};
use crate::bench::controller::Controller;
use crate::bench::scenario::Scenario;
use crate::bench::working_motion::WorkingMotion;
use crate::bench::{Bench, Conditions};
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;
use crate::plant::sample::PlantSample;
use crate::plant::unknowns::Which;
use crate::verify::judge::Metric;

/// Claim of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Claim {
    Shakes,
    Limited,
    Worse,
    Ratio(&'static str, Scenario, Metric),
    RestTorque,
}

impl Claim {
    fn all() -> impl Iterator<Item = Self> {
        let ratios = RATIOS.iter().map(|(row, scenario, metric)| Self::Ratio(row, *scenario, *metric));
        [Self::Shakes, Self::Limited, Self::Worse, Self::RestTorque].into_iter().chain(ratios)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Shakes => "shakes",
            Self::Limited => "limited",
            Self::Worse => "worse",
            Self::Ratio(row, ..) => row.trim_start_matches("robustness."),
            Self::RestTorque => "rest.torque",
        }
    }

    fn unit(self) -> &'static str {
        if self == Self::Limited { "s" } else { "1" }
    }

    fn is_of(self, scenario: Scenario) -> bool {
        if let Self::Ratio(_, of, _) = self { of == scenario } else { true }
    }

    /// The larger the worse; infinite of a plant that diverged.
    fn value(
        self,
        scenario: Scenario,
        ours: Option<&RunResult>,
        rivals: &[Option<RunResult>],
        sensors: SensorSet,
    ) -> f64 {
        let Some(ours) = ours else { return f64::INFINITY };
        let b0 = rivals.first().and_then(Option::as_ref);
        let beside_b0 = |of: fn(&RunResult, &RunResult) -> f64| b0.map_or(0.0, |b0| of(ours, b0));
        match self {
            Self::Shakes => beside_b0(|ours, b0| ours.shaking(b0).into_iter().fold(0.0, f64::max)),
            Self::Limited => ours.limited,
            Self::Worse => beside_b0(RunResult::worst_ratio),
            Self::RestTorque => beside_b0(|ours, b0| torque_ratio(ours.torque_at_rest, b0.torque_at_rest)),
            Self::Ratio(_, _, metric) => {
                let fair = RIVALS.iter().zip(rivals).filter(|(rival, _)| reads_no_more(rival, sensors));
                let metrics =
                    fair.filter_map(|(_, result)| Some(result.as_ref()?.metric(scenario, metric).abs()));
                ours.metric(scenario, metric).abs() / metrics.fold(f64::INFINITY, f64::min)
            }
        }
    }
}

/// One scenario on one plant with one noise.
#[derive(Clone, Copy, PartialEq)]
pub struct Place {
    /// Uncertainty of the plant.
    pub which: Which,
    /// The plant.
    pub seed: u64,
    /// Its noise.
    pub realisation: u32,
    /// Scenario of the run.
    pub scenario: Scenario,
}

/// A run that is among the worst of a claim.
#[derive(Clone, Copy)]
pub struct WorstRun {
    claim: Claim,
    /// Plant and scenario.
    pub place: Place,
    /// Sensors of the compensator.
    pub sensors: SensorSet,
    /// Value of the claim on the condensed mesh, in its unit.
    pub condensed: f64,
}

impl WorstRun {
    /// As in `robustness.box.motor.s2.error.again.10003.s2`: row, sensors, claim, seed, scenario, and the noise where it is not
    /// the seed's own.
    pub fn name(&self) -> String {
        let Place { which, seed, realisation, scenario } = self.place;
        let noise = if realisation == 0 { String::new() } else { format!(".noise_{realisation}") };
        let (row, sensors, claim) = (which.name(), self.sensors.name(), self.claim.name());
        format!("robustness.{row}.{sensors}.{claim}.again.{seed}.{}{noise}", scenario.name())
    }

    /// Unit of the claim's value.
    pub fn unit(&self) -> &'static str {
        self.claim.unit()
    }

    /// Value of the claim in another run of the compensator, against others of the rivals in their order.
    pub fn value(&self, ours: Option<&RunResult>, rivals: &[Option<RunResult>]) -> f64 {
        self.claim.value(self.place.scenario, ours, rivals, self.sensors)
    }
}

impl Robustness {
    /// The worst runs of each claim of each row: of so many plants.
    pub fn worst_runs(&self, count: usize) -> Vec<WorstRun> {
        self.outcomes.iter().flat_map(|(which, outcomes)| worst(*which, outcomes, count)).collect()
    }
}

/// The worst plants of each claim with either set of sensors, `count` of each with its worst scenario, as far as there is
/// anything of it at all.
fn worst(which: Which, outcomes: &[Outcome], count: usize) -> Vec<WorstRun> {
    let claims =
        SensorSet::ALL.into_iter().flat_map(|sensors| Claim::all().map(move |claim| (sensors, claim)));
    claims
        .flat_map(|(sensors, claim)| {
            let mut plants: Vec<_> = outcomes
                .iter()
                .filter_map(|outcome| worst_scenario(which, outcome, sensors, claim))
                .collect();
            plants.sort_by(|a, b| b.condensed.total_cmp(&a.condensed));
            plants.truncate(count);
            plants
        })
        .collect()
}

fn worst_scenario(which: Which, outcome: &Outcome, sensors: SensorSet, claim: Claim) -> Option<WorstRun> {
    let ours = &outcome.compensated[sensors as usize];
    let runs = JUDGED.into_iter().enumerate().filter(|(_, scenario)| claim.is_of(*scenario));
    let runs = runs.map(|(place, scenario)| {
        let rivals: Vec<_> = outcome.rivals.iter().map(|results| results[place].clone()).collect();
        let condensed = claim.value(scenario, ours[place].as_ref(), &rivals, sensors);
        let place = Place { which, seed: outcome.seed, realisation: outcome.realisation, scenario };
        WorstRun { claim, place, sensors, condensed }
    });
    runs.filter(|run| run.condensed > 0.0).max_by(|a, b| a.condensed.total_cmp(&b.condensed))
}

/// The plant of a place, for runs on the reference mesh.
pub struct Rerun {
    place: Place,
    sample: PlantSample,
}

impl Place {
    /// Draws the plant of a joint.
    ///
    /// # Errors
    /// As [`PlantSample::of`].
    pub fn again(self, file: &GearFile) -> Result<Rerun, Error> {
        let sample = PlantSample::of(file, self.which, self.seed)?;
        Ok(Rerun { place: self, sample })
    }
}

impl Rerun {
    /// Gear file that a controller is built for.
    pub fn known(&self) -> &GearFile {
        &self.sample.known
    }

    /// A rival's run; `None` where the plant diverges.
    ///
    /// # Errors
    /// A parameter that no model can be built from.
    pub fn rival(&self, rival: &Rival) -> Result<Option<RunResult>, Error> {
        match self.result(rival.sensors, &mut (rival.build)(self.known())?) {
            Ok(result) => Ok(Some(result)),
            Err(RunError::Diverged(_)) => Ok(None),
            Err(RunError::Parameter(error)) => Err(error),
        }
    }

    /// A controller's run with these sensors.
    ///
    /// # Errors
    /// The controller's, a plant that cannot be built, or one that diverges.
    pub fn result<C: Controller>(&self, sensors: SensorSet, controller: &mut C) -> Result<RunResult, C::Error>
    where
        C::Error: From<RunError>,
    {
        let conditions = Conditions {
            sensors,
            realisation: self.place.realisation,
            ..Conditions::of(self.known(), self.place.seed)
        };
        let mut bench = Bench::of(&self.sample, &conditions).map_err(RunError::from)?;
        bench.go(&WorkingMotion, controller, |_, _, _, _| ())?;
        Judged::of(self.known(), &self.sample.params).result(bench, controller, self.place.scenario)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(seed: u64, error: f64, limited: f64) -> Outcome {
        let result = |error| {
            Some(RunResult {
                metrics: vec![error],
                torsion_at_rest: 1e-6,
                torque_at_rest: 1e-3,
                limited: 0.0,
                ..RunResult::default()
            })
        };
        let mut ours: [Option<RunResult>; JUDGED.len()] = Default::default();
        ours.fill(result(error));
        ours[1].as_mut().unwrap().limited = limited;
        let mut theirs = ours.clone();
        theirs.fill(result(1e-4));
        let compensated = [ours.clone(), ours];
        Outcome { seed, realisation: 0, rivals: vec![theirs; RIVALS.len()], compensated, untold: None }
    }

    #[test]
    fn the_worst_plants_of_each_claim_are_named_with_their_scenario() {
        let which = Which::named("box").unwrap();
        let outcomes = [outcome(1, 2e-4, 0.0), outcome(2, 5e-5, 0.02), outcome(3, 3e-4, 0.0)];
        let found = worst(which, &outcomes, 2);
        let of = |claim: &str| -> Vec<_> {
            let prefix = format!("robustness.box.motor.{claim}.again.");
            let runs = found
                .iter()
                .filter_map(|run| Some((run.name().strip_prefix(&prefix)?.to_owned(), run.condensed)));
            runs.collect()
        };
        let s2 = of("s2.error");
        assert!(s2.len() == 2 && s2[0].0 == "3.s2" && (s2[0].1 - 3.0).abs() < 1e-9, "{s2:?}");
        assert_eq!(of("limited"), [("2.s2".to_owned(), 0.02)]);
        assert_eq!(of("worse").len(), 2, "one plant is not worse in any scenario");
    }
}
