//! Claims of S2, S3 and S4 in three states of the stored kinematic error, the map ([`Map`]): told, learnt, absent.
//!
//! The gear's own kinematic error differs from the stored one in amplitude and phase, as in the row `kinematic.stored` of
//! [`crate::plant::unknowns`]. Every controller works for 10 s and goes into each scenario from there; a rival has the same map as
//! the compensator beside it, so that what the map brings stands apart from what the rest brings. Per set of sensors and state:
//!
//! | figure | definition |
//! | --- | --- |
//! | `s2.rms_to_b0`, `s3.vibration_to_b0`, `s4.ripple_to_b0` | metric over that of the cascade alone, the worst of all samples |
//! | `s2.rms_to_best`, `s3.vibration_to_best`, `s4.ripple_to_best` | over that of the best rival with the same map that reads no more, median |
//! | `map_brings.s2` and alike | metric with the map told over that without it, median; of the rivals that put it in advance too; only reported |
//!
//! Over B0 those rivals are reported as well.

mod claims;

use strainwave::Error;

use crate::bench::controller::HostCompensator;
use crate::bench::scenario::Scenario;
use crate::bench::{Bench, Conditions};
use crate::design::joint::joint_params;
use crate::io::figure::Figure;
use crate::io::gear_file::{GearFile, SensorSet};
use crate::plant::sample::PlantSample;
use crate::plant::unknowns::Which;
use crate::verify::compensator::each;
use crate::verify::robustness::{FIRST, JUDGED, Judged, Map, RIVALS, RunResults};
pub use claims::{CLAIMS, Claim};

/// Scenarios of the claims.
pub const SCENARIOS: [Scenario; 3] = [Scenario::S2, Scenario::S3, Scenario::S4];
/// Noises on each plant.
pub const NOISES: u32 = 2;
/// Row of the plants' unknowns.
const ROW: &str = "kinematic.stored";

/// Everything that ran on one plant with one noise.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The plant.
    pub seed: u64,
    /// Its noise.
    pub realisation: u32,
    /// The rivals in their order, with the map and without.
    rivals: [Vec<RunResults>; 2],
    /// The compensator in each state of the map, with each set of sensors.
    compensated: [[RunResults; 2]; 3],
}

impl Outcome {
    /// The rivals that stand beside the compensator in this state.
    fn rivals(&self, map: Map) -> &[RunResults] {
        &self.rivals[usize::from(map != Map::Told)]
    }

    fn ours(&self, map: Map, sensors: SensorSet) -> &RunResults {
        &self.compensated[map as usize][sensors as usize]
    }
}

/// Every claim on `samples` plants with so many noises each; `progress` is called with the fraction done.
///
/// # Errors
/// A gear that no compensator or rival can be built for.
pub fn measure(
    file: &GearFile,
    samples: u64,
    noises: u32,
    mut progress: impl FnMut(f64),
) -> Result<Vec<Figure>, Error> {
    let seeds = FIRST..FIRST + samples;
    let jobs: Vec<_> =
        seeds.flat_map(|seed| (0..noises).map(move |realisation| (seed, realisation))).collect();
    let run = |(seed, realisation): &(u64, u32)| outcome(file, *seed, *realisation);
    let outcomes = each(&jobs, run, &mut progress).into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(claims::figures(&outcomes))
}

fn outcome(file: &GearFile, seed: u64, realisation: u32) -> Result<Outcome, Error> {
    let which = Which::named(ROW).expect("the row is one of the table's");
    let sample = PlantSample::of(file, which, seed)?;
    let judged = Judged::of(file, &sample.params);
    let bench = |sensors| {
        let conditions = Conditions { sensors, realisation, ..Conditions::of(file, seed) };
        Bench::condensed_of(&sample, &conditions)
    };
    let rivals = |map: Map| -> Result<Vec<_>, Error> {
        let known = map.file(file);
        let run = RIVALS
            .iter()
            .map(|rival| judged.results(bench(rival.sensors)?, (rival.build)(&known)?, &SCENARIOS));
        run.collect()
    };
    let joint = joint_params(file)?;
    let compensated = |map: Map, sensors| {
        judged.results(bench(sensors)?, HostCompensator::build(&map.joint(&joint))?, &SCENARIOS)
    };
    let both_sets = |map| -> Result<_, Error> {
        let [motor, both] = SensorSet::ALL.map(|sensors| compensated(map, sensors));
        Ok([motor?, both?])
    };
    let [told, learnt, absent] = Map::ALL.map(both_sets);
    Ok(Outcome {
        seed,
        realisation,
        rivals: [rivals(Map::Told)?, rivals(Map::Absent)?],
        compensated: [told?, learnt?, absent?],
    })
}

/// Place of a scenario among [`JUDGED`].
fn place(scenario: Scenario) -> usize {
    JUDGED.iter().position(|judged| *judged == scenario).unwrap_or_default()
}
