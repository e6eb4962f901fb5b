//! Torque by strain gauges on the flexspline, scenario S8: four gauges of the literal 36 x 4 mesh, and the observer with them.
//!
//! Every seed draws other flaws of the gauges and of the reference that they learn from. Errors are rms over the judged part, as fractions of
//! the rated torque; beside them stands the raw bridge, the same gauges without compensation.

use crate::bench::torque_fusion;
use crate::bench::torque_sensing::{Errors, Record, judge_on_host};
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;
use crate::verify::{Measured, bounds, largest};

/// The first judged seed.
pub const FIRST: u64 = 10_000;
/// How many are judged.
pub const SEEDS: u64 = 100;
/// Part of the time in which a normal error is beyond three standard deviations.
const BEYOND: f64 = 0.0027;
/// How many of them with the observer, which costs more.
const OBSERVED: u64 = 20;

pub(super) fn measure() -> Result<Measured, BadInput> {
    let file = GearFile::default_gear();
    let record = Record::of(&file).map_err(BadInput::message)?;
    let figures = figures(&file, &record).map_err(RunError::from).map_err(BadInput::message)?;
    Ok(Measured::from(figures))
}

fn figures(file: &GearFile, record: &Record) -> Result<Vec<Figure>, strainwave::Error> {
    let seeds = FIRST..FIRST + SEEDS;
    let four = seeds
        .clone()
        .map(|seed| judge_on_host::<4>(file, record, seed))
        .collect::<Result<Vec<Errors>, _>>()?;
    let worst = |of: fn(&Errors) -> f64| largest(four.iter().map(of));
    let raw: Vec<f64> = four.iter().map(|errors| errors.raw).collect();
    let mut figures = vec![
        bounds::figure("gauges.s8.error", worst(|errors| errors.error)),
        Figure::reported("gauges.s8.error.median", median(four.iter().map(|errors| errors.error)), "1"),
        bounds::figure("gauges.s8.raw.median", median(raw.iter().copied())),
        Figure::reported("gauges.s8.raw.least", raw.iter().copied().fold(f64::INFINITY, f64::min), "1"),
        Figure::bounded("gauges.s8.beyond_three_deviations", worst(|errors| errors.far), "1", BEYOND),
    ];
    let worst_of = |judge: fn(&GearFile, &Record, u64) -> Result<Errors, strainwave::Error>| {
        let errors = (FIRST..FIRST + OBSERVED).map(|seed| Ok(judge(file, record, seed)?.error));
        Ok::<_, strainwave::Error>(largest(errors.collect::<Result<Vec<f64>, strainwave::Error>>()?))
    };
    figures.push(Figure::reported("gauges.s8.two.error", worst_of(judge_on_host::<2>)?, "1"));
    figures.push(Figure::reported("gauges.s8.eight.error", worst_of(judge_on_host::<8>)?, "1"));
    figures.extend(observed(file, record)?);
    Ok(figures)
}

/// Error of the external torque with the gauges over that without, of the worst seed, and both.
fn observed(file: &GearFile, record: &Record) -> Result<Vec<Figure>, strainwave::Error> {
    let errors = (FIRST..FIRST + OBSERVED)
        .map(|seed| torque_fusion::external_torque(file, record, seed))
        .collect::<Result<Vec<_>, _>>()?;
    let ratio = largest(errors.iter().map(|error| error.with / error.without));
    Ok(vec![
        bounds::figure("gauges.observer.external_torque", ratio),
        Figure::reported(
            "gauges.observer.without.median",
            median(errors.iter().map(|error| error.without)),
            "N m",
        ),
        Figure::reported("gauges.observer.with.median", median(errors.iter().map(|error| error.with)), "N m"),
    ])
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
