//! Runs of the scenarios: every controller on one plant.

use strainwave::Error;

use crate::bench::baseline::{Baseline, Kind};
use crate::bench::closed_loop::{Run, go_on};
use crate::bench::scenario::Scenario;
use crate::bench::{Bench, Conditions};
use crate::design::buildable::buildable;
use crate::design::joint::joint_params;
use crate::io::file::BadInput;
use crate::io::gear_file::{GearFile, SensorSet};
use crate::plant::divergence::RunError;
use crate::report::controller::Controller;
use crate::verify::compensator::{each, worked};
use crate::verify::judge::{Judge, Metric};

/// The plant.
pub(super) const SEED: u64 = 1;

/// All controllers, B0 first.
const CONTROLLERS: [Controller; 6] = [
    Controller::Baseline(0),
    Controller::Baseline(1),
    Controller::Baseline(2),
    Controller::Compensator(SensorSet::Motor),
    Controller::Baseline(3),
    Controller::Compensator(SensorSet::Both),
];

/// A metric of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Judgement {
    /// As in the names of figures.
    pub name: &'static str,
    /// In `unit`, rad or s.
    pub value: f64,
    pub unit: &'static str,
}

impl Judgement {
    /// In the unit for people.
    pub fn shown(&self) -> f64 {
        self.value * if self.unit == "s" { 1e3 } else { 1e6 }
    }

    /// That unit.
    pub fn shown_unit(&self) -> &'static str {
        if self.unit == "s" { "ms" } else { "urad" }
    }
}

/// A controller in a scenario.
pub(in crate::report) struct Trial {
    pub scenario: Scenario,
    pub controller: Controller,
    pub run: Run,
    /// Those of the scenario.
    pub metrics: Vec<Judgement>,
}

/// All runs.
pub(in crate::report) struct Trials {
    runs: Vec<Trial>,
    /// Why there are none.
    pub left_out: Option<String>,
}

impl Trials {
    /// Of the joint of a gear file; none where no firmware can be built for it. `progress` is called with the fraction done.
    ///
    /// # Errors
    /// A plant that diverges.
    pub fn run(file: &GearFile, mut progress: impl FnMut(f64)) -> Result<Self, BadInput> {
        if let Err(why) = file.require_firmware_friction().and_then(|()| buildable(file)) {
            return Ok(Self::none(why));
        }
        let found = each(&CONTROLLERS, |controller| of_controller(file, *controller), &mut progress);
        let found = found.into_iter().collect::<Result<Vec<_>, _>>();
        let found = found.map_err(|error| BadInput::message(format_args!("{}: {error}", file.gear.name)))?;
        Ok(Self { runs: found.into_iter().flatten().collect(), left_out: None })
    }

    /// No runs, for this reason.
    pub fn none(why: impl Into<String>) -> Self {
        Self { runs: Vec::new(), left_out: Some(why.into()) }
    }

    /// Largest part of the moved energy that is missing in any run; `None` where there are none.
    pub fn imbalance(&self) -> Option<f64> {
        self.runs.iter().map(|trial| trial.run.imbalance).reduce(f64::max)
    }

    /// Those of a scenario, B0 first.
    pub fn of(&self, scenario: Scenario) -> impl Iterator<Item = &Trial> {
        self.runs.iter().filter(move |trial| trial.scenario == scenario)
    }

    /// The compensated runs with the motor encoder alone, and that of the held joint, which has no controller.
    pub fn compensated(&self) -> impl Iterator<Item = (Scenario, &Run)> {
        let drawn = |trial: &&Trial| {
            trial.scenario.blocked() || trial.controller == Controller::Compensator(SensorSet::Motor)
        };
        self.runs.iter().filter(drawn).map(|trial| (trial.scenario, &trial.run))
    }
}

fn of_controller(file: &GearFile, controller: Controller) -> Result<Vec<Trial>, RunError> {
    let conditions = Conditions { sensors: controller.sensors(), ..Conditions::of(file, SEED) };
    match controller {
        Controller::Baseline(place) => {
            let bench = Bench::condensed(file, &conditions)?;
            let baseline = Baseline::build(file, Kind::ALL[place])?;
            let scenarios = Scenario::ALL.into_iter().filter(|scenario| place == 0 || !scenario.blocked());
            let run = |scenario| go_on(&mut bench.clone(), scenario, &mut baseline.clone(), |_| ());
            scenarios.map(|scenario| trial(file, &conditions, controller, scenario, run(scenario)?)).collect()
        }
        Controller::Compensator(_) => {
            let (bench, compensator) = worked(&joint_params(file)?, file, &conditions)?;
            let scenarios = Scenario::ALL.into_iter().filter(|scenario| !scenario.blocked());
            let run = |scenario| go_on(&mut bench.clone(), scenario, &mut compensator.clone(), |_| ());
            scenarios.map(|scenario| trial(file, &conditions, controller, scenario, run(scenario)?)).collect()
        }
    }
}

fn trial(
    file: &GearFile,
    conditions: &Conditions,
    controller: Controller,
    scenario: Scenario,
    run: Run,
) -> Result<Trial, RunError> {
    let plant = conditions.plant(file)?;
    let judge = Judge::new(scenario, &plant, &run.trace);
    let judged = |metric: Metric| -> Result<Judgement, Error> {
        let unit = if metric == Metric::Settling { "s" } else { "rad" };
        Ok(Judgement { name: metric.name(), value: judge.metric(metric)?, unit })
    };
    let metrics = Metric::ALL.into_iter().filter(|metric| metric.is_of(scenario)).map(judged);
    let metrics = metrics.collect::<Result<_, _>>()?;
    Ok(Trial { scenario, controller, run, metrics })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_controller_runs_and_the_page_shows_what_verify_judges() {
        let file = GearFile::default_gear();
        let trials = Trials::run(&file, |_| ()).unwrap();
        assert_eq!(trials.left_out, None);
        for scenario in Scenario::ALL {
            let count = if scenario.blocked() { 1 } else { CONTROLLERS.len() };
            assert_eq!(trials.of(scenario).count(), count, "{scenario:?}");
            assert_eq!(trials.of(scenario).next().unwrap().controller, Controller::Baseline(0));
        }
        assert_eq!(trials.compensated().count(), Scenario::ALL.len());
        // The same plant, noise and controllers as those of the claims.
        let rivals = crate::verify::compensator::Rivals::build(&file).unwrap();
        let compared = rivals.compare(&file, &Conditions::of(&file, SEED)).unwrap();
        let ours = trials
            .of(Scenario::S2)
            .find(|trial| trial.controller == Controller::Compensator(SensorSet::Motor));
        assert_eq!(ours.unwrap().metrics[0].value, compared.compensated[0].metric(Metric::Error));
        assert_eq!(
            trials.of(Scenario::S2).next().unwrap().run.rms,
            compared.baselines[0].metric(Metric::Error)
        );
    }

    #[test]
    fn a_gear_for_simulation_only_says_why_there_are_no_runs() {
        let mut file = GearFile::default_gear();
        file.friction.input.model = strainwave::friction::ModelName::Coulomb;
        let trials = Trials::run(&file, |_| ()).unwrap();
        assert!(trials.left_out.is_some() && trials.of(Scenario::S1).next().is_none());
    }
}
