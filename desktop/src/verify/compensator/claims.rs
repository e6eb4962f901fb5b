//! What is claimed of the compensator, row by row.

use crate::bench::SensorSet;
use crate::bounds;
use crate::figure::Figure;
use crate::judge::Mark;
use crate::scenario::Scenario;
use crate::verify::compensator::performance::{Compared, Performance};

/// What a mark is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The same mark of the cascade alone.
    B0,
    /// The same mark of the cascade with a rigid joint's feed-forward.
    B1,
    /// The rated torque of the default gear.
    RatedTorque,
    /// Nothing: a share.
    One,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// With the motor's sensors, with both encoders.
    pub names: [&'static str; 2],
    /// What is judged.
    pub mark: Mark,
    /// Beside what.
    pub reference: Reference,
}

const fn claim(mark: Mark, reference: Reference, names: [&'static str; 2]) -> Claim {
    Claim { names, mark, reference }
}

/// Every row.
pub const CLAIMS: &[Claim] = &[
    claim(
        Mark::StepVibration,
        Reference::B0,
        ["compensator.motor.s1.vibration_to_b0", "compensator.both.s1.vibration_to_b0"],
    ),
    claim(Mark::Error, Reference::B0, ["compensator.motor.s2.rms_to_b0", "compensator.both.s2.rms_to_b0"]),
    claim(Mark::Error, Reference::B1, ["compensator.motor.s2.rms_to_b1", "compensator.both.s2.rms_to_b1"]),
    claim(
        Mark::MoveVibration,
        Reference::B0,
        ["compensator.motor.s3.vibration_to_b0", "compensator.both.s3.vibration_to_b0"],
    ),
    claim(
        Mark::Settling,
        Reference::B0,
        ["compensator.motor.s3.settling_to_b0", "compensator.both.s3.settling_to_b0"],
    ),
    claim(
        Mark::Ripple,
        Reference::B0,
        ["compensator.motor.s4.ripple_to_b0", "compensator.both.s4.ripple_to_b0"],
    ),
    claim(Mark::Peak, Reference::B0, ["compensator.motor.s5.peak_to_b0", "compensator.both.s5.peak_to_b0"]),
    claim(
        Mark::Steady,
        Reference::B0,
        ["compensator.motor.s5.steady_to_b0", "compensator.both.s5.steady_to_b0"],
    ),
    claim(
        Mark::ExternalTorque,
        Reference::RatedTorque,
        ["compensator.motor.external_torque", "compensator.both.external_torque"],
    ),
    claim(
        Mark::Outside,
        Reference::One,
        ["compensator.motor.outside_three_deviations", "compensator.both.outside_three_deviations"],
    ),
];

impl Claim {
    /// The worst of all draws beside its bound, with the draw's seed; `rated` torque (N m).
    pub fn figure(&self, sensors: SensorSet, draws: &[Compared], rated: f64) -> Figure {
        let values = draws.iter().map(|draw| (draw.seed, self.value(sensors, draw, rated)));
        let worst = values.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let (seed, value) = worst.unwrap_or((0, f64::NAN));
        bounds::figure(self.names[sensors as usize], value).of_draw(seed)
    }

    fn value(&self, sensors: SensorSet, draw: &Compared, rated: f64) -> f64 {
        let ours = draw.compensated[sensors as usize].mark(self.mark);
        self.relative(ours, draw.baselines.each_ref().map(|baseline| baseline.mark(self.mark)), rated)
    }

    /// The compensator's mark relative to what this row names: marks of B0 and B1, or the rated torque (N m).
    pub fn relative(&self, ours: f64, [b0, b1]: [f64; 2], rated: f64) -> f64 {
        ours / match self.reference {
            Reference::B0 => b0,
            Reference::B1 => b1,
            Reference::RatedTorque => rated,
            Reference::One => 1.0,
        }
    }

    /// The figure of one plant with the firmware in the loop, beside the same bound.
    pub fn of_target(&self, sensors: SensorSet, value: f64) -> Figure {
        let row = self.names[sensors as usize];
        bounds::figure_as(row.replacen("compensator", "pil", 1), row, value)
    }
}

/// The draw on which a scenario comes closest to its bounds, or misses them by most, among measured `figures`.
pub fn worst_draw(figures: &[Figure], scenario: Scenario, sensors: SensorSet) -> Option<u64> {
    let names: Vec<_> = CLAIMS
        .iter()
        .filter(|claim| claim.mark.is_of(scenario))
        .map(|claim| claim.names[sensors as usize])
        .collect();
    let share = |figure: &&Figure| figure.value / figure.bound.unwrap_or(f64::INFINITY);
    figures
        .iter()
        .filter(|figure| names.contains(&figure.name.as_str()))
        .max_by(|a, b| share(a).total_cmp(&share(b)))?
        .seed
}

/// Runs that are unstable, and runs that are worse than B0, each with the seed of the first.
pub fn in_the_box(sensors: SensorSet, draws: &[Compared]) -> [Figure; 2] {
    let names = [
        ["compensator.motor.box.unstable", "compensator.motor.box.worse_than_b0"],
        ["compensator.both.box.unstable", "compensator.both.box.worse_than_b0"],
    ][sensors as usize];
    let count = |name, bad: fn(&Performance, &Performance) -> usize| {
        let bad = |draw: &Compared| bad(&draw.compensated[sensors as usize], &draw.baselines[0]);
        let figure = bounds::figure(name, draws.iter().map(bad).sum::<usize>() as f64);
        match draws.iter().find(|draw| bad(draw) > 0) {
            Some(draw) => figure.of_draw(draw.seed),
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
            let same = |other: &Claim| (other.mark, other.reference) == (claim.mark, claim.reference);
            assert!(!CLAIMS[..k].iter().any(same), "{claim:?} stands there twice");
        }
    }

    #[test]
    fn the_worst_draw_is_the_one_nearest_to_its_bound() {
        let figure = |name, value, seed| bounds::figure(name, value).of_draw(seed);
        let figures = [
            figure("compensator.motor.s3.vibration_to_b0", 0.05, 4),
            figure("compensator.motor.s3.settling_to_b0", 0.2, 7),
            figure("compensator.both.s3.settling_to_b0", 0.9, 9),
            figure("compensator.motor.s2.rms_to_b0", 0.9, 11),
        ];
        let worst = |scenario, sensors| worst_draw(&figures, scenario, sensors);
        assert_eq!(worst(Scenario::S3, SensorSet::Motor), Some(7));
        assert_eq!(worst(Scenario::S3, SensorSet::Both), Some(9));
        assert_eq!(worst(Scenario::S5, SensorSet::Motor), None);
    }
}
