//! What a baseline is tuned for: one objective for all, on training plants.
//!
//! ```text
//! ln J = mean over plants and scenarios of (1/n)*sum_k ln sqrt(x_k^2 + f^2)  +  bad*ln 2
//! ```
//!
//! x_k are the n figures of a scenario, each in rad, J their geometric mean:
//!
//! | scenario | figures |
//! | --- | --- |
//! | S1 | residual vibration of the torsion |
//! | S2 | rms output error |
//! | S3 | residual vibration of the torsion, rms output error after the move |
//! | S4 | ripple of the output error, rms output error |
//! | S5 | peak and steady output error |
//!
//! They are the marks of [`crate::judge`]. f = 1 urad: less than that gains next to nothing. Every bad run doubles J. A
//! run is bad when the plant diverges (its figures then count as [`LOST`]), when the motor torque is at its limit for more
//! than [`LONGEST_LIMITED`] of the judged part, or when it shakes: over its last fifth the torsion's vibration is above
//! 10 urad and above three times that of the untuned B0 on the same plant, or the motor torque's, taken alike, above
//! [`LOUD`] of the rated torque over N.

use std::thread;

use strainwave::Error;
use strainwave::gear::GearParams;

use super::{Baseline, BaselineGains, Kind};
use crate::bench::{Bench, Conditions};
use crate::closed_loop::{Row, go_on};
use crate::divergence::RunError;
use crate::gear_file::GearFile;
use crate::joint::CONTROL_PERIOD;
use crate::judge::{Judge, Mark, rms, vibration, without_slow_part};
use crate::plant::CondensedMesh;
use crate::scenario::Scenario;
use crate::working_motion::WorkingMotion;

/// A figure: the scenario, the mark and its name.
pub type FigureOf = (Scenario, Mark, &'static str);

/// What counts.
pub const FIGURES: [FigureOf; 8] = [
    (Scenario::S1, Mark::StepVibration, "s1.vibration"),
    (Scenario::S2, Mark::Error, "s2.rms"),
    (Scenario::S3, Mark::MoveVibration, "s3.vibration"),
    (Scenario::S3, Mark::Error, "s3.rms"),
    (Scenario::S4, Mark::Ripple, "s4.ripple"),
    (Scenario::S4, Mark::Error, "s4.rms"),
    (Scenario::S5, Mark::Peak, "s5.peak"),
    (Scenario::S5, Mark::Steady, "s5.steady"),
];
/// The scenarios that they are of.
pub const SCENARIOS: [Scenario; 5] = [Scenario::S1, Scenario::S2, Scenario::S3, Scenario::S4, Scenario::S5];

/// f (rad).
const FLOOR: f64 = 1e-6;
/// What a figure counts as where the plant diverged (rad).
pub const LOST: f64 = 1.0;
/// Longest time at the torque limit of a good run's judged part (s).
pub const LONGEST_LIMITED: f64 = 0.01;
/// Torque ripple at the end of a good run, in rated torques over N.
pub const LOUD: f64 = 0.05;
/// Torsion's vibration at the end of a good run, in those of the untuned B0, and in rad.
const MOST_VIBRATION: f64 = 3.0;
const QUIET: f64 = 10e-6;
/// Share of a run that is its end.
const END: f64 = 0.2;

/// What came of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// In the order of [`FIGURES`], those of the scenario (rad).
    pub figures: Vec<f64>,
    /// Rms vibration of the torsion at the end (rad).
    pub vibration: f64,
    /// Rms of the motor torque there, less its slow part (N m).
    pub torque_ripple: f64,
    /// At the torque limit in the judged part (s).
    pub limited: f64,
}

impl Outcome {
    fn of(scenario: Scenario, judge: &Judge<'_>, rows: &[Row], limit: f64) -> Result<Self, Error> {
        let of = FIGURES.iter().filter(|figure| figure.0 == scenario);
        let at_limit = |row: &&Row| f64::from(row.answer.motor_torque.abs()) >= 0.999 * limit;
        let end = &rows[rows.len() - (END * rows.len() as f64) as usize..];
        let torques: Vec<_> = end.iter().map(|row| f64::from(row.answer.motor_torque)).collect();
        let period = judge.natural_period()?;
        Ok(Self {
            figures: of.map(|(_, mark, _)| judge.mark(*mark)).collect::<Result<_, _>>()?,
            vibration: rms(vibration(end, period)),
            torque_ripple: rms(without_slow_part(&torques, period)),
            limited: judge.judged().iter().filter(at_limit).count() as f64 * CONTROL_PERIOD,
        })
    }

    fn diverged(scenario: Scenario) -> Self {
        let count = FIGURES.iter().filter(|figure| figure.0 == scenario).count();
        Self { figures: vec![LOST; count], vibration: LOST, torque_ripple: LOST, limited: LOST }
    }

    /// (1/n)*sum_k ln sqrt(x_k^2 + f^2)
    fn logarithm(&self) -> f64 {
        let logarithms =
            self.figures.iter().map(|figure| if figure.is_finite() { figure.hypot(FLOOR).ln() } else { 0.0 });
        logarithms.sum::<f64>() / self.figures.len() as f64
    }

    /// It is bad beside the untuned B0, on a joint whose torque is loud from `loud` (N m) on.
    fn is_bad(&self, b0: &Self, loud: f64) -> bool {
        self.limited > LONGEST_LIMITED
            || self.vibration > (MOST_VIBRATION * b0.vibration).max(QUIET)
            || self.torque_ripple > loud
    }
}

/// A joint on the bench.
struct Stand {
    plant: GearParams<f64>,
    bench: Bench<CondensedMesh>,
    torque_limit: f64,
}

impl Stand {
    fn build(file: &GearFile, conditions: &Conditions) -> Result<Self, Error> {
        Ok(Self {
            plant: conditions.plant(file)?,
            bench: Bench::condensed(file, conditions)?,
            torque_limit: file.motor.peak_torque,
        })
    }

    fn run(&self, baseline: &Baseline, scenario: Scenario) -> Result<Outcome, RunError> {
        match go_on(&mut self.bench.clone(), scenario, &mut baseline.clone(), |_| ()) {
            Ok(run) => {
                let judge = Judge::new(scenario, &self.plant, &run.trace);
                Ok(Outcome::of(scenario, &judge, &run.trace, self.torque_limit)?)
            }
            Err(RunError::Diverged(_)) => Ok(Outcome::diverged(scenario)),
            Err(error) => Err(error),
        }
    }
}

/// One baseline over all scenarios on one plant, after the working motion; outcomes in the order of [`SCENARIOS`].
///
/// # Errors
/// A gear that cannot be built.
pub fn after_work(
    file: &GearFile,
    conditions: &Conditions,
    baseline: &Baseline,
) -> Result<Vec<Outcome>, RunError> {
    let (mut stand, mut baseline) = (Stand::build(file, conditions)?, baseline.clone());
    match stand.bench.go(&WorkingMotion, &mut baseline, |_, _, _, _| ()) {
        Err(RunError::Diverged(_)) => return Ok(SCENARIOS.map(Outcome::diverged).to_vec()),
        other => other?,
    }
    SCENARIOS.iter().map(|scenario| stand.run(&baseline, *scenario)).collect()
}

/// The objective of one baseline.
pub struct Objective {
    file: GearFile,
    kind: Kind,
    stands: Vec<Stand>,
    /// The untuned B0 on each stand in each scenario.
    b0: Vec<Outcome>,
    loud: f64,
}

/// What some gains are worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Geometric mean of the figures (rad).
    pub mean: f64,
    /// Bad runs.
    pub bad: usize,
}

impl Score {
    /// ln J, J in rad.
    pub fn logarithm(&self) -> f64 {
        self.mean.ln() + self.bad as f64 * 2f64.ln()
    }
}

impl Objective {
    /// Of a baseline on the plants of these seeds.
    ///
    /// # Errors
    /// A gear that no plant or baseline can be built for.
    pub fn build(
        file: &GearFile,
        kind: Kind,
        seeds: impl IntoIterator<Item = u64>,
    ) -> Result<Self, RunError> {
        let conditions = |seed| Conditions { sensors: kind.sensors(), ..Conditions::of(file, seed) };
        let stands = seeds.into_iter().map(|seed| Stand::build(file, &conditions(seed)));
        let mut objective = Self {
            file: file.clone(),
            kind,
            stands: stands.collect::<Result<_, _>>()?,
            b0: Vec::new(),
            loud: LOUD * file.gear.rated_torque / f64::from(file.gear.signed_ratio().n()).abs(),
        };
        let b0 = Baseline::with_gains(file, Kind::B0, &BaselineGains::untuned(file, Kind::B0))?;
        objective.b0 = objective.outcomes(&b0)?;
        Ok(objective)
    }

    /// What these gains are worth.
    ///
    /// # Errors
    /// Gains that no baseline can be built with.
    pub fn score(&self, gains: &BaselineGains) -> Result<Score, RunError> {
        let outcomes = self.outcomes(&Baseline::with_gains(&self.file, self.kind, gains)?)?;
        let sum: f64 = outcomes.iter().map(Outcome::logarithm).sum();
        let bad = outcomes.iter().zip(&self.b0).filter(|(run, b0)| run.is_bad(b0, self.loud));
        Ok(Score { mean: (sum / outcomes.len() as f64).exp(), bad: bad.count() })
    }

    /// Stand by stand, scenario by scenario; on two threads, the long S2 apart from the others.
    fn outcomes(&self, baseline: &Baseline) -> Result<Vec<Outcome>, RunError> {
        let run = |stand: &Stand, scenario: Scenario| stand.run(baseline, scenario);
        let [s1, s2, rest @ ..] = SCENARIOS;
        let (long, others) = thread::scope(|scope| {
            let long = scope.spawn(|| self.stands.iter().map(|stand| run(stand, s2)).collect::<Vec<_>>());
            let others = |stand| [s1, rest[0], rest[1], rest[2]].map(|scenario| run(stand, scenario));
            let others: Vec<_> = self.stands.iter().map(others).collect();
            (long.join().expect("a run does not panic"), others)
        });
        let in_order = long.into_iter().zip(others).flat_map(|(s2, [s1, s3, s4, s5])| [s1, s2, s3, s4, s5]);
        in_order.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(figures: Vec<f64>) -> Outcome {
        Outcome { figures, vibration: 1e-6, torque_ripple: 1e-3, limited: 0.0 }
    }

    #[test]
    fn the_mean_is_geometric_with_a_floor() {
        assert!((outcome(vec![1e-4, 1e-2]).logarithm() - 1e-3f64.ln()).abs() < 1e-3);
        assert!((outcome(vec![0.0]).logarithm() - 1e-6f64.ln()).abs() < 1e-9);
        // What is no number is as bad as a plant that is lost.
        let lost = Outcome::diverged(Scenario::S2).logarithm();
        assert!((outcome(vec![f64::NAN]).logarithm() - lost).abs() < 1e-9);
    }

    #[test]
    fn what_shakes_saturates_or_diverges_is_bad() {
        let (good, loud) = (outcome(vec![1e-5]), 0.03);
        assert!(!good.is_bad(&good, loud));
        let shaking = Outcome { vibration: 1.1e-5, ..good.clone() };
        assert!(
            shaking.is_bad(&good, loud)
                && !shaking.is_bad(&Outcome { vibration: 5e-6, ..good.clone() }, loud)
        );
        assert!(Outcome { torque_ripple: 0.04, ..good.clone() }.is_bad(&good, loud));
        assert!(Outcome { limited: 0.02, ..good.clone() }.is_bad(&good, loud));
        assert!(Outcome::diverged(Scenario::S5).is_bad(&good, loud));
        assert_eq!(Score { mean: 1.0, bad: 2 }.logarithm(), 4f64.ln());
    }

    #[test]
    fn every_scenario_has_a_figure() {
        for scenario in SCENARIOS {
            assert!(FIGURES.iter().any(|figure| figure.0 == scenario));
            assert!(!Outcome::diverged(scenario).figures.is_empty());
        }
    }
}
