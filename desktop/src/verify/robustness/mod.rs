//! The compensator and its rivals on plants that none of them knows, row by row and all at once.
//!
//! A plant is drawn by [`crate::plant::unknowns`]; on each, every rival and the compensator with either set of sensors work
//! for 10 s, go into S1 to S5 from there, and stop and rest after each. Per row and set of sensors:
//!
//! | figure | definition |
//! | --- | --- |
//! | `shakes` | runs that diverge or keep oscillating at rest ([`RunResult::oscillates`]) |
//! | `limited` | runs that stay at the torque limit for more than 10 ms of their judged part ([`RunResult::is_limited`]) |
//! | `worse` | runs of which a metric is worse than B0's, by more than 5 % and more than 12 urad ([`RunResult::is_worse`]) |
//! | `stopped` | runs that end with the drive switched off by a fault, of which no plant has any |
//! | `s2.error`, `s4.error` | rms output error over that of the best rival on the same plant, median of the plants |
//! | `s1.vibration`, `s3.vibration` | the torsion's vibration after the moves, alike |
//! | `rest.torque` | the motor torque's oscillation at rest over B0's, rms of S1 to S5, median of the plants |
//! | `s2.error.to_b0`, `s3.vibration.to_b0` | over B0's, the worst of the plants; only reported |
//! | `s4.error.learnt`, `s4.error.absent` | as `s4.error`, of a compensator without the stored kinematic error, which has learnt it while it worked or may not learn it; only reported, of some rows |
//!
//! Plants have the condensed mesh; the worst can be run again on the reference mesh ([`Robustness::worst_runs`]).
//!
//! A rival that needs the output's encoder is none of the compensator's without it.

mod map;
mod rerun;
mod run_result;
mod summary;

use strainwave::Error;
use strainwave::compensator::JointParams;
use strainwave::flexspline::Flexspline;

use crate::bench::baseline::Baseline;
use crate::bench::controller::HostCompensator;
use crate::bench::scenario::Scenario;
use crate::bench::{Bench, Conditions};
use crate::design::joint::joint_params;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::plant::sample::PlantSample;
use crate::plant::unknowns::Which;
use crate::verify::compensator::each;
pub use map::Map;
pub use rerun::{Place, Rerun, WorstRun};
pub use run_result::{COUNT, JUDGED, Judged, Oscillation, RunResult, RunResults, metrics};
pub use summary::{Robustness, Summary, best, median};

/// Plants of a row of one unknown when nothing else is said.
pub const SEEDS: u64 = 6;
/// The same of the row with all unknowns at once, on six of which what some plants do is not seen.
pub const SEEDS_OF_ALL: u64 = 60;
/// The first seed that claims are judged on.
pub const FIRST: u64 = 10_000;

/// Requested plants.
#[derive(Clone)]
pub struct Request {
    /// The rows.
    pub rows: Vec<Which>,
    /// The first seed.
    pub first: u64,
    /// Number of seeds of each row; `None` for the row's own.
    pub seeds: Option<u64>,
    /// Noises on each plant.
    pub noises: u32,
    /// On the reference mesh, some hundred times slower.
    pub reference: bool,
}

/// A rival: its name, what it reads, and how it is built for a joint.
pub struct Rival {
    /// As in `b0`.
    pub name: &'static str,
    /// Sensors of the controller.
    pub sensors: SensorSet,
    /// For a joint.
    pub build: fn(&GearFile) -> Result<Baseline, Error>,
}

/// All of them; the first is B0.
pub const RIVALS: &[Rival] = &[
    Rival { name: "b0", sensors: SensorSet::Motor, build: Baseline::b0 },
    Rival { name: "b1", sensors: SensorSet::Motor, build: Baseline::b1 },
    Rival { name: "b2", sensors: SensorSet::Motor, build: Baseline::b2 },
    Rival { name: "b3", sensors: SensorSet::Both, build: Baseline::b3 },
];

/// Everything that ran on one plant with one noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The plant.
    pub seed: u64,
    /// Its noise.
    pub realisation: u32,
    /// The rivals, in their order.
    pub rivals: Vec<RunResults>,
    /// The compensator with each set of sensors.
    pub compensated: [RunResults; 2],
    /// The same in S4, without the stored kinematic error: learnt, or not.
    pub untold: Option<[[RunResults; 2]; 2]>,
}

/// One plant with one noise.
#[derive(Clone, Copy)]
struct Job {
    which: Which,
    seed: u64,
    realisation: u32,
}

impl Request {
    /// Plants of a row.
    fn seeds_of(&self, which: Which) -> u64 {
        self.seeds.unwrap_or(if matches!(which, Which::All) { SEEDS_OF_ALL } else { SEEDS })
    }

    /// Its runs, a row after the other.
    fn jobs(&self, which: Which) -> impl Iterator<Item = Job> + '_ {
        let seeds = self.first..self.first + self.seeds_of(which);
        seeds.flat_map(move |seed| (0..self.noises).map(move |realisation| Job { which, seed, realisation }))
    }
}

/// Rows of which S4 is also judged without the stored kinematic error.
fn asks_for_the_map(which: Which) -> bool {
    let name = which.name();
    matches!(which, Which::All) || name == "box" || name.starts_with("kinematic")
}

/// Every requested row; `progress` is called with the fraction done.
///
/// # Errors
/// A gear that no compensator or rival can be built for.
pub fn measure(
    file: &GearFile,
    request: &Request,
    mut progress: impl FnMut(f64),
) -> Result<Robustness, Error> {
    let jobs: Vec<_> = request.rows.iter().flat_map(|which| request.jobs(*which)).collect();
    let joint = joint_params(file)?;
    let run = |job: &Job| {
        if request.reference {
            job.run(file, &joint, Bench::of)
        } else {
            job.run(file, &joint, Bench::condensed_of)
        }
    };
    let outcomes = each(&jobs, run, &mut progress);
    let mut outcomes = outcomes.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter();
    let mut row = |which| (which, outcomes.by_ref().take(request.jobs(which).count()).collect());
    let outcomes: Vec<(Which, Vec<Outcome>)> = request.rows.iter().map(|which| row(*which)).collect();
    let rows = outcomes.iter().map(|(which, outcomes)| Summary::of(*which, outcomes)).collect();
    Ok(Robustness { rows, outcomes })
}

impl Job {
    /// `joint` is that of the file.
    fn run<F: Flexspline<f64>>(
        &self,
        file: &GearFile,
        joint: &JointParams<f32>,
        build: fn(&PlantSample, &Conditions) -> Result<Bench<F>, Error>,
    ) -> Result<Outcome, Error>
    where
        Bench<F>: Clone,
    {
        let sample = PlantSample::of(file, self.which, self.seed)?;
        let known = &sample.known;
        let joint = if known == file { *joint } else { joint_params(known)? };
        let judged = Judged::of(known, &sample.params);
        let bench = |sensors| {
            let conditions =
                Conditions { sensors, realisation: self.realisation, ..Conditions::of(known, self.seed) };
            build(&sample, &conditions)
        };
        let rivals = RIVALS
            .iter()
            .map(|rival| judged.results(bench(rival.sensors)?, (rival.build)(known)?, &JUDGED))
            .collect::<Result<_, _>>()?;
        let compensated = |joint: &JointParams<f32>, sensors, scenarios: &[Scenario]| {
            judged.results(bench(sensors)?, HostCompensator::build(joint)?, scenarios)
        };
        let both_sets = |joint: &JointParams<f32>, scenarios: &[Scenario]| -> Result<_, Error> {
            let [motor, both] = SensorSet::ALL.map(|sensors| compensated(joint, sensors, scenarios));
            Ok([motor?, both?])
        };
        let untold = || -> Result<_, Error> {
            let [learnt, absent] = [Map::Learnt, Map::Absent].map(|map| map.joint(&joint));
            Ok([both_sets(&learnt, &[Scenario::S4])?, both_sets(&absent, &[Scenario::S4])?])
        };
        Ok(Outcome {
            seed: self.seed,
            realisation: self.realisation,
            rivals,
            compensated: both_sets(&joint, &JUDGED)?,
            untold: if asks_for_the_map(self.which) { Some(untold()?) } else { None },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_its_own_plants_unless_their_number_is_said() {
        let request = |seeds| Request { rows: Vec::new(), first: 7, seeds, noises: 2, reference: false };
        let delay = Which::named("drive.delay").unwrap();
        let plants = |request: &Request, which| request.jobs(which).count() as u64;
        assert_eq!(plants(&request(None), delay), 2 * SEEDS);
        assert_eq!(plants(&request(None), Which::All), 2 * SEEDS_OF_ALL);
        assert_eq!([delay, Which::All].map(|which| plants(&request(Some(3)), which)), [6; 2]);
        let seeds: Vec<_> = request(Some(3)).jobs(delay).map(|job| (job.seed, job.realisation)).collect();
        assert_eq!(seeds, [(7, 0), (7, 1), (8, 0), (8, 1), (9, 0), (9, 1)]);
    }
}
