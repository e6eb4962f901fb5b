//! The search for a baseline's gains: CMA-ES within their ranges, from where they stand.
//!
//! Every gain is a coordinate from 0 to 1: its logarithm between the ends of its range, its value where the range starts
//! at 0. The search is the covariance matrix adaptation evolution strategy with a box ([`basin::BoundedCmaEs`]): the
//! [`objective`](super::objective) is rough, since the first run that shakes doubles it, and its gains depend on each
//! other. It repeats for the same seeds and budget. No result is worse than the start.
//!
//! N. Hansen, "The CMA evolution strategy: a tutorial", arXiv:1604.00772 (2016).

use std::cell::{Cell, RefCell};
use std::convert::Infallible;

use basin::{
    BoundedCmaEs, BoxBounds, Constrained, ConstraintSet, Constraints, CostFunction, DenseMatrix, Executor,
    NoConstraints, PopulationProgress,
};

use super::objective::{Objective, Score, training_plant};
use crate::bench::baseline::{BaselineGains, Gain, Kind};
use crate::catalogue::joints::{self, Joint};
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;
use crate::plant::sample::PlantSample;

/// Plants that gains are chosen on, unless others are named.
pub const SEEDS: std::ops::RangeInclusive<u64> = 901..=906;
/// Evaluations of the objective, unless told otherwise.
pub const BUDGET: u64 = 200;
/// Standard deviation of the first generation.
const SPREAD: f64 = 0.12;
/// Of the search's random numbers.
const SEED: u64 = 1;

/// Result of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// Which baseline.
    pub kind: Kind,
    /// Initial gains of the search, and their score.
    pub before: (BaselineGains, Score),
    /// The best found.
    pub after: (BaselineGains, Score),
}

/// Training plants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Training {
    /// Plants of the gear file's joint, by seed.
    Plants(std::ops::RangeInclusive<u64>),
    /// So many joints with this gear, of other loads and encoders ([`crate::catalogue::joints`]).
    Joints(u64),
}

impl Training {
    fn plants(&self, file: &GearFile) -> Result<Vec<PlantSample>, strainwave::Error> {
        match self {
            Self::Plants(seeds) => seeds.clone().map(|seed| training_plant(file, seed)).collect(),
            Self::Joints(count) => joints::of_gear(file, *count).iter().map(Joint::plant).collect(),
        }
    }
}

/// Searches the gains of a baseline from those that the gear file has for it; `progress` is called with the fraction done.
///
/// # Errors
/// A gear that no plant or baseline can be built for.
pub fn tune(
    file: &GearFile,
    kind: Kind,
    training: &Training,
    budget: u64,
    mut progress: impl FnMut(f64),
) -> Result<Tuned, RunError> {
    let objective = Objective::build(file, kind, training.plants(file)?)?;
    let start = BaselineGains::of(file, kind);
    let worth = objective.score(&start)?;
    let found = search(kind, &start, budget, |gains, fraction| {
        progress(fraction);
        objective.score(gains).map_or(f64::INFINITY, |score| score.logarithm())
    });
    let score = objective.score(&found)?;
    let before = (start, worth);
    let better = score.logarithm() < worth.logarithm();
    Ok(Tuned { kind, before, after: if better { (found, score) } else { before } })
}

/// The best gains for a cost, which is called with the fraction of the budget that is used.
fn search(
    kind: Kind,
    start: &BaselineGains,
    budget: u64,
    cost: impl FnMut(&BaselineGains, f64) -> f64,
) -> BaselineGains {
    let gains: Vec<_> = kind.gains().collect();
    let count = gains.len();
    let from = gains.iter().map(|gain| to_coordinate(gain, (gain.get)(start))).collect();
    let problem =
        Problem { gains, start: *start, budget, evaluations: Cell::new(0), cost: RefCell::new(cost) };
    let bounds = BoxBounds::new(Some(vec![0.0; count]), Some(vec![1.0; count]));
    let boxed = Constrained::new(&problem, ConstraintSet::new().with_bounds(bounds));
    let solver = BoundedCmaEs::<Vec<f64>, DenseMatrix>::new(SEED, SPREAD);
    let generation = BoundedCmaEs::<Vec<f64>, DenseMatrix>::default_lambda(count) as u64 + 1;
    let run = Executor::new(boxed, solver, PopulationProgress::from_point(from))
        .max_iter(budget)
        .max_cost_evals(budget.saturating_sub(generation))
        .run();
    run.map_or(*start, |found| problem.at(found.best_param()))
}

/// A gain's place in its range, 0 to 1.
fn to_coordinate(gain: &Gain, value: f64) -> f64 {
    let [least, most] = gain.range;
    let fraction = if least > 0.0 { (value / least).ln() / (most / least).ln() } else { value / most };
    fraction.clamp(0.0, 1.0)
}

/// The gain at a place in its range.
fn from_coordinate(gain: &Gain, place: f64) -> f64 {
    let [least, most] = gain.range;
    let value = if least > 0.0 { least * (most / least).powf(place) } else { most * place };
    value.clamp(least, most)
}

/// The objective as the search sees it.
struct Problem<C> {
    gains: Vec<&'static Gain>,
    start: BaselineGains,
    budget: u64,
    evaluations: Cell<u64>,
    cost: RefCell<C>,
}

impl<C> Problem<C> {
    fn at(&self, places: &[f64]) -> BaselineGains {
        let mut gains = self.start;
        for (gain, place) in self.gains.iter().zip(places) {
            *(gain.place)(&mut gains) = from_coordinate(gain, *place);
        }
        gains
    }
}

impl<C> Constraints for &Problem<C> {
    type Set = NoConstraints;

    fn constraints(&self) -> NoConstraints {
        ConstraintSet::new()
    }
}

impl<C: FnMut(&BaselineGains, f64) -> f64> CostFunction for &Problem<C> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;

    fn cost(&self, places: &Vec<f64>) -> Result<f64, Infallible> {
        self.evaluations.set(self.evaluations.get() + 1);
        let fraction = (self.evaluations.get() as f64 / self.budget as f64).min(1.0);
        Ok((self.cost.borrow_mut())(&self.at(places), fraction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::baseline::GAINS;
    use crate::io::gear_file::Baselines;

    #[test]
    fn a_coordinate_is_a_place_in_its_range() {
        for gain in GAINS {
            let [least, most] = gain.range;
            assert_eq!([least, most].map(|value| to_coordinate(gain, value)), [0.0, 1.0]);
            for place in [0.0, 0.3, 1.0] {
                assert!((to_coordinate(gain, from_coordinate(gain, place)) - place).abs() < 1e-12);
            }
        }
    }

    /// The least of a known function, inside the ranges and on their edge.
    #[test]
    fn the_search_finds_the_least() {
        let start = BaselineGains::untuned(&GearFile::default_gear(), Kind::B1);
        let expected = BaselineGains { position_bandwidth: 30.0, friction_gain: 0.0, ..start };
        let cost = |gains: &BaselineGains, _| {
            let difference = |gain: &Gain| {
                to_coordinate(gain, (gain.get)(gains)) - to_coordinate(gain, (gain.get)(&expected))
            };
            Kind::B1.gains().map(|gain| difference(gain).powi(2)).sum()
        };
        let found = search(Kind::B1, &start, 600, cost);
        assert!(cost(&found, 0.0) < 1e-4, "{found:?}");
        assert_eq!(found, search(Kind::B1, &start, 600, cost));
        assert_eq!(found.output_low_pass, start.output_low_pass);
    }

    #[test]
    fn the_budget_is_kept() {
        let start = BaselineGains::untuned(&GearFile::default_gear(), Kind::B3);
        for budget in [30, 100] {
            let mut evaluations = 0;
            search(Kind::B3, &start, budget, |gains, _| {
                evaluations += 1;
                gains.position_bandwidth
            });
            assert!(evaluations <= budget && evaluations + 12 > budget, "{evaluations} of {budget}");
        }
    }

    /// From slow loops, on one plant, twice: better than the start, and the same.
    #[test]
    fn tuning_improves_and_repeats() {
        let mut file = GearFile::default_gear();
        let untuned = BaselineGains::untuned(&file, Kind::B0);
        let slow = BaselineGains { position_bandwidth: 5.0, velocity_bandwidth: 25.0, ..untuned };
        file.baselines = Some(Baselines::default());
        file.baselines.iter_mut().for_each(|stored| stored.set(Kind::B0, &slow));
        let tuned = || tune(&file, Kind::B0, &Training::Plants(901..=901), 20, |_| ()).unwrap();
        let found = tuned();
        assert!(found.after.1.logarithm() < found.before.1.logarithm(), "{found:?}");
        assert_eq!(found, tuned());
    }
}
