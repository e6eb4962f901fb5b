//! The worst samples of the compensator's claims again: the firmware image in the emulator, the plant with the reference mesh.
//!
//! Nothing is shortened: the firmware works for 10 s and goes into the scenario, B0 and B1 run it from rest on the same plant, all of
//! them with the noise of the sample.

use std::path::Path;

use strainwave_desktop::bench::Conditions;
use strainwave_desktop::bench::baseline::Baseline;
use strainwave_desktop::bench::closed_loop::{Run, go_on};
use strainwave_desktop::verify::bounds;
use strainwave_desktop::verify::compensator::{Claim, Claimed, each};
use strainwave_desktop::{Figure, GearFile};

use crate::pil::{self, Error, Trial};
use crate::target::{self, Agreement};

/// Values of the claims of one trial, and in how many steps the firmware was unlike the host.
type Again = (Vec<(&'static Claim, f64)>, Agreement);

/// The trial of a sample; none of a claim that is of all scenarios.
fn trial(file: &GearFile, sample: &Claimed) -> Option<Trial<'static>> {
    let rest = Trial::from_rest(file, sample.claim.scenario()?, sample.seed);
    let Claimed { sensors, realisation, .. } = *sample;
    Some(Trial { conditions: Conditions { sensors, realisation, ..rest.conditions }, worked: true, ..rest })
}

/// Every trial once, however many claims ask for it.
fn trials(file: &GearFile, samples: &[Claimed]) -> Vec<Trial<'static>> {
    let mut trials = Vec::new();
    for trial in samples.iter().filter_map(|sample| trial(file, sample)) {
        if !trials.contains(&trial) {
            trials.push(trial);
        }
    }
    trials
}

fn run(elf: &Path, file: &GearFile, trial: &Trial<'_>) -> Result<Again, target::Error> {
    let target = pil::compensated(elf, &[], file, trial, |_| ())?;
    let baseline = |mut baseline: Baseline| -> Result<Run, target::Error> {
        Ok(go_on(&mut trial.bench(file)?, trial.motion, &mut baseline, |_| ())?)
    };
    let [b0, b1] = [Baseline::b0(file)?, Baseline::b1(file)?].map(baseline);
    let values = trial.claimed(file, &trial.conditions.plant(file)?, [&target.run, &b0?, &b1?])?;
    Ok((values, target.agreement))
}

/// Runs the samples again with a board's firmware for the joint of `file`. Of each its value on the condensed mesh, on the host, and,
/// within its claim's bound, on the reference mesh with the firmware. `progress` is called with the fraction done.
///
/// # Errors
/// When the firmware cannot be built or run, or a plant diverges.
pub fn measure(
    board: &str,
    file: &GearFile,
    samples: &[Claimed],
    mut progress: impl FnMut(f64),
) -> Result<Vec<Figure>, Error> {
    let elf = pil::prepare(board, file)?.elf;
    let jobs: Vec<_> = trials(file, samples)
        .into_iter()
        .map(|trial| {
            let learns = trial.learns_ripple();
            let elf = if learns { pil::build(board, &trial.controller_gear(file))?.elf } else { elf.clone() };
            Ok((trial, elf))
        })
        .collect::<Result<_, Error>>()?;
    let again = |(trial, elf): &(Trial<'static>, std::path::PathBuf)| run(elf, file, trial);
    let done = each(&jobs, again, &mut progress).into_iter().collect::<Result<Vec<_>, _>>()?;
    let value = |sample: &Claimed| -> Option<f64> {
        let wanted = trial(file, sample)?;
        let place = jobs.iter().position(|(trial, _)| *trial == wanted)?;
        let found = done[place].0.iter().find(|(claim, _)| claim.names == sample.claim.names)?;
        Some(found.1)
    };
    let mut figures: Vec<_> =
        samples.iter().filter_map(|sample| Some(beside(sample, value(sample)?))).flatten().collect();
    let agreement = done.iter().fold(Agreement::default(), |all, (_, run)| all.and(*run));
    figures.push(Figure::reported("compensator.again.steps", agreement.steps as f64, "1"));
    figures.push(agreement.figure("compensator.again.steps_unlike_host"));
    Ok(figures)
}

/// A sample's value on the condensed mesh beside that of its second run.
fn beside(sample: &Claimed, again: f64) -> [Figure; 2] {
    let Claimed { claim, sensors, seed, realisation, value } = *sample;
    let row = claim.names[sensors as usize];
    let noise = if realisation == 0 { String::new() } else { format!(".noise_{realisation}") };
    let name = |mesh: &str| format!("{row}.again.{seed}{noise}.{mesh}");
    [Figure::reported(name("condensed"), value, "1"), bounds::figure_as(name("reference"), row, again)]
        .map(|figure| figure.of_seed(seed).of_noise(realisation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use strainwave_desktop::io::gear_file::SensorSet;
    use strainwave_desktop::verify::compensator::CLAIMS;

    fn sample(name: &str, seed: u64, realisation: u32) -> Claimed {
        let claim = CLAIMS.iter().find(|claim| claim.names[0] == name).unwrap();
        Claimed { claim, sensors: SensorSet::Motor, seed, realisation, value: 0.3 }
    }

    #[test]
    fn claims_of_one_scenario_share_their_trial() {
        let file = GearFile::default_gear();
        let samples = [
            sample("compensator.motor.s3.vibration_to_b0", 4, 1),
            sample("compensator.motor.s3.settling_to_b0", 4, 1),
            sample("compensator.motor.s3.settling_to_b0", 4, 0),
            sample("compensator.motor.s2.rms_to_b1", 4, 1),
        ];
        let trials = trials(&file, &samples);
        assert_eq!(trials.len(), 3);
        assert!(trials.iter().all(|trial| trial.worked && trial.conditions.seed == 4));
        assert_eq!(trial(&file, &sample("compensator.motor.external_torque", 4, 0)), None);
    }

    #[test]
    fn both_values_stand_side_by_side_and_the_second_is_bounded() {
        let [condensed, reference] = beside(&sample("compensator.motor.s3.vibration_to_b0", 4, 2), 9.0);
        assert_eq!(condensed.name, "compensator.motor.s3.vibration_to_b0.again.4.noise_2.condensed");
        assert!(condensed.holds && condensed.value == 0.3 && !reference.holds);
        assert_eq!((reference.seed, reference.noise), (Some(4), Some(2)));
    }
}
