//! Claims of the compensator, row by row.

use crate::bench::scenario::Scenario;
use crate::io::figure::Figure;
use crate::io::gear_file::SensorSet;
use crate::verify::bounds;
use crate::verify::compensator::performance::{Compared, Performance};
use crate::verify::judge::Metric;

/// Reference of a metric's ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The same metric of the cascade alone.
    B0,
    /// The same metric of the cascade with a rigid joint's feed-forward.
    B1,
    /// The rated torque of the default gear.
    RatedTorque,
    /// Nothing: a ratio.
    One,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// With the motor's sensors, with both encoders.
    pub names: [&'static str; 2],
    /// Metric of the claim.
    pub metric: Metric,
    /// Reference of the ratio.
    pub reference: Reference,
}

const fn claim(metric: Metric, reference: Reference, names: [&'static str; 2]) -> Claim {
    Claim { names, metric, reference }
}

/// Every row.
pub const CLAIMS: &[Claim] = &[
    claim(
        Metric::StepVibration,
        Reference::B0,
        ["compensator.motor.s1.vibration_to_b0", "compensator.both.s1.vibration_to_b0"],
    ),
    claim(Metric::Error, Reference::B0, ["compensator.motor.s2.rms_to_b0", "compensator.both.s2.rms_to_b0"]),
    claim(Metric::Error, Reference::B1, ["compensator.motor.s2.rms_to_b1", "compensator.both.s2.rms_to_b1"]),
    claim(
        Metric::MoveVibration,
        Reference::B0,
        ["compensator.motor.s3.vibration_to_b0", "compensator.both.s3.vibration_to_b0"],
    ),
    claim(
        Metric::Settling,
        Reference::B0,
        ["compensator.motor.s3.settling_to_b0", "compensator.both.s3.settling_to_b0"],
    ),
    claim(
        Metric::Ripple,
        Reference::B0,
        ["compensator.motor.s4.ripple_to_b0", "compensator.both.s4.ripple_to_b0"],
    ),
    claim(Metric::Peak, Reference::B0, ["compensator.motor.s5.peak_to_b0", "compensator.both.s5.peak_to_b0"]),
    claim(
        Metric::Steady,
        Reference::B0,
        ["compensator.motor.s5.steady_to_b0", "compensator.both.s5.steady_to_b0"],
    ),
    claim(
        Metric::ExternalTorque,
        Reference::RatedTorque,
        ["compensator.motor.external_torque", "compensator.both.external_torque"],
    ),
    claim(
        Metric::Outside,
        Reference::One,
        ["compensator.motor.outside_three_deviations", "compensator.both.outside_three_deviations"],
    ),
];

/// A claim on one sample.
#[derive(Clone, Copy, Debug)]
pub struct Claimed {
    /// Which claim.
    pub claim: &'static Claim,
    /// Sensors of the compensator.
    pub sensors: SensorSet,
    /// The sample.
    pub seed: u64,
    /// Its noise.
    pub realisation: u32,
    /// The claim's value.
    pub value: f64,
}

/// The claims of scenarios, each with either set of sensors, on their worst plants: `count` of each, with the noise that is worst there.
pub fn worst_samples(samples: &[Compared], rated: f64, count: usize) -> Vec<Claimed> {
    let claims = CLAIMS.iter().filter(|claim| claim.scenario().is_some());
    let all = claims.flat_map(|claim| SensorSet::ALL.map(|sensors| (claim, sensors)));
    all.flat_map(|(claim, sensors)| {
        let mut worst = claim.on(sensors, samples, rated);
        worst.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
        let mut plants = Vec::new();
        worst.retain(|sample| {
            !plants.contains(&sample.seed) && {
                plants.push(sample.seed);
                true
            }
        });
        worst.truncate(count);
        worst
    })
    .collect()
}

impl Claim {
    /// The scenario of which it is; none of the estimates' claims, which are of all.
    pub fn scenario(&self) -> Option<Scenario> {
        Scenario::ALL.into_iter().find(|scenario| self.metric.is_of(*scenario))
    }

    /// On every sample.
    fn on(&'static self, sensors: SensorSet, samples: &[Compared], rated: f64) -> Vec<Claimed> {
        let on = |sample: &Compared| {
            let &Compared { seed, realisation, .. } = sample;
            Claimed { claim: self, sensors, seed, realisation, value: self.value(sensors, sample, rated) }
        };
        samples.iter().map(on).collect()
    }

    /// The worst of all samples with its bound, with the sample's seed and noise; `rated` torque (N m).
    pub fn figure(&'static self, sensors: SensorSet, samples: &[Compared], rated: f64) -> Figure {
        let all = self.on(sensors, samples, rated);
        let worst = all.into_iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
        let figure = |value| bounds::figure(self.names[sensors as usize], value);
        worst.map_or_else(
            || figure(f64::NAN),
            |worst| figure(worst.value).of_seed(worst.seed).of_noise(worst.realisation),
        )
    }

    fn value(&self, sensors: SensorSet, sample: &Compared, rated: f64) -> f64 {
        let ours = sample.compensated[sensors as usize].metric(self.metric);
        self.relative(ours, sample.baselines.each_ref().map(|baseline| baseline.metric(self.metric)), rated)
    }

    /// The compensator's metric relative to what this row names: metrics of B0 and B1, or the rated torque (N m).
    pub fn relative(&self, ours: f64, [b0, b1]: [f64; 2], rated: f64) -> f64 {
        ours / match self.reference {
            Reference::B0 => b0,
            Reference::B1 => b1,
            Reference::RatedTorque => rated,
            Reference::One => 1.0,
        }
    }

    /// The figure of one plant with the firmware in the loop, with the same bound.
    pub fn of_target(&self, sensors: SensorSet, value: f64) -> Figure {
        let row = self.names[sensors as usize];
        bounds::figure_as(row.replacen("compensator", "pil", 1), row, value)
    }
}

/// The sample on which a scenario comes closest to its bounds, or misses them by most, among measured `figures`: its seed
/// and its noise.
pub fn worst_draw(figures: &[Figure], scenario: Scenario, sensors: SensorSet) -> Option<(u64, u32)> {
    let names: Vec<_> = CLAIMS
        .iter()
        .filter(|claim| claim.metric.is_of(scenario))
        .map(|claim| claim.names[sensors as usize])
        .collect();
    let fraction = |figure: &&Figure| figure.value / figure.bound.unwrap_or(f64::INFINITY);
    let worst = figures
        .iter()
        .filter(|figure| names.contains(&figure.name.as_str()))
        .max_by(|a, b| fraction(a).total_cmp(&fraction(b)))?;
    Some((worst.seed?, worst.noise.unwrap_or_default()))
}

/// Rows of the box with the motor's sensors and with both encoders: unstable, worse than B0.
pub type BoxRows = [[&'static str; 2]; 2];

/// Rows of all samples of the box.
pub const BOX: BoxRows = [
    ["compensator.motor.box.unstable", "compensator.motor.box.worse_than_b0"],
    ["compensator.both.box.unstable", "compensator.both.box.worse_than_b0"],
];
/// Rows of fewer samples.
pub const BOX_SAMPLE: BoxRows = [
    ["compensator.motor.box_sample.unstable", "compensator.motor.box_sample.worse_than_b0"],
    ["compensator.both.box_sample.unstable", "compensator.both.box_sample.worse_than_b0"],
];

/// Runs that are unstable, and runs that are worse than B0, each with the seed of the first.
pub fn in_the_box(rows: &BoxRows, sensors: SensorSet, samples: &[Compared]) -> [Figure; 2] {
    let names = rows[sensors as usize];
    let count = |name, bad: fn(&Performance, &Performance) -> usize| {
        let bad = |sample: &Compared| bad(&sample.compensated[sensors as usize], &sample.baselines[0]);
        let figure = bounds::figure(name, samples.iter().map(bad).sum::<usize>() as f64);
        match samples.iter().find(|sample| bad(sample) > 0) {
            Some(sample) => figure.of_seed(sample.seed),
            None => figure,
        }
    };
    [count(names[0], Performance::unstable), count(names[1], Performance::worse)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_its_bound_and_a_mark_of_its_own() {
        for (k, claim) in CLAIMS.iter().enumerate() {
            assert!(claim.names.iter().all(|name| bounds::find(name).is_some()), "{claim:?}");
            let same = |other: &Claim| (other.metric, other.reference) == (claim.metric, claim.reference);
            assert!(!CLAIMS[..k].iter().any(same), "{claim:?} stands there twice");
        }
    }

    #[test]
    fn the_worst_draw_is_the_one_nearest_to_its_bound() {
        let figure = |name, value, seed| bounds::figure(name, value).of_seed(seed);
        let figures = [
            figure("compensator.motor.s3.vibration_to_b0", 0.05, 4),
            figure("compensator.motor.s3.settling_to_b0", 0.2, 7),
            figure("compensator.both.s3.settling_to_b0", 0.9, 9).of_noise(2),
            figure("compensator.motor.s2.rms_to_b0", 0.9, 11),
        ];
        let worst = |scenario, sensors| worst_draw(&figures, scenario, sensors);
        assert_eq!(worst(Scenario::S3, SensorSet::Motor), Some((7, 0)));
        assert_eq!(worst(Scenario::S3, SensorSet::Both), Some((9, 2)));
        assert_eq!(worst(Scenario::S5, SensorSet::Motor), None);
    }
}
