//! Identification: weights from noisy data of known ones, and a measured gear predicted from half of its log.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use strainwave::hysteresis::{Staircase, StaircaseState, Weights};

use crate::identify::{
    Error, GearLog, GearOptions, Options, Sequence, identify, identify_gear, regressors, reversal,
};
use crate::io::data;
use crate::io::file::BadInput;
use crate::io::gear_file::{GearFile, LARA8_J5};
use crate::io::log::MeasuredLog;
use crate::plant::MEMORY;
use crate::verify::bounds;
use crate::verify::{Measured, largest};

/// Levels of the random table.
const LEVELS: usize = 16;
/// Tables.
const SEEDS: u64 = 10;
/// Standard deviation of the noise, of the output's span.
const NOISE: f64 = 0.01;
/// Samples a cell of the reversal curves.
const SAMPLES: usize = 4;
/// Corners of the minor loops that are predicted, and samples between two of them.
const CORNERS: usize = 200;
const BETWEEN: usize = 20;
/// The log of a joint that is held against a load.
const LOG: &str = "lara8/joint/jog_j2_mass.j5.csv";

pub(super) fn measure() -> Result<Measured, BadInput> {
    let worst = (1..=SEEDS).map(synthetic).collect::<Result<Vec<_>, _>>().map_err(BadInput::message)?;
    let mut measured =
        Measured::from(vec![bounds::figure("hysteresis.identification.synthetic", largest(worst))]);
    measured.add(size_17()?);
    Ok(measured)
}

/// Largest error over minor loops that were not recorded, as a fraction of the output's span: weights of a random
/// table from its reversal curves with noise.
fn synthetic(seed: u64) -> Result<f64, Error> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let values: Vec<f64> = regressors::pairs::<LEVELS>().map(|_| random.random_range(0.0..1.0)).collect();
    let weights = regressors::weights_of::<LEVELS>(&values, false)?;
    let span = 2.0 * weights.total();
    let input = reversal::reversal_curves(1.0, LEVELS, SAMPLES);
    let noisy = |y: f64| {
        let noise: f64 = StandardNormal.sample(&mut random);
        y + NOISE * span * noise
    };
    let output: Vec<f64> = outputs(&weights, &input)?.into_iter().map(noisy).collect();
    let options = Options { training: 1.0, ..Options::new(1.0) };
    let found = identify::<LEVELS>(Sequence { input: &input, output: &output }, &options)?;
    let corners: Vec<_> = (0..CORNERS).map(|_| random.random_range(-1.0..1.0)).collect();
    let inputs = corners.windows(2).flat_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        (1..=BETWEEN).map(move |k| from + (to - from) * k as f64 / BETWEEN as f64)
    });
    let inputs: Vec<_> = inputs.collect();
    let (expected, predicted) = (outputs(&weights, &inputs)?, outputs(&found.weights, &inputs)?);
    Ok(largest(expected.iter().zip(&predicted).map(|(expected, predicted)| expected - predicted)) / span)
}

fn outputs(weights: &Weights<f64, LEVELS>, inputs: &[f64]) -> Result<Vec<f64>, Error> {
    let model = Staircase::<f64, LEVELS, MEMORY>::build(1.0, weights)?;
    let mut state = StaircaseState::default();
    Ok(inputs.iter().map(|input| model.step(&mut state, *input).output).collect())
}

/// The torsion of a held joint over the second half of its log: offset and one factor on the catalogue's line from the first
/// half alone.
fn size_17() -> Result<Measured, BadInput> {
    let Some(path) = data::find(LOG) else {
        return Ok(Measured::skipped(format!("hysteresis.identification.size_17: skipped: no data ({LOG})")));
    };
    let gear = GearFile::parse("gears/lara8-j5.toml".as_ref(), LARA8_J5.as_bytes())?;
    let log = GearLog::of(&MeasuredLog::read(&path)?, &gear)
        .ok_or_else(|| BadInput::new(&path, "the output's angle or torque is missing"))?;
    let found = identify_gear(&gear, &[log], &GearOptions::default(), |_| ())
        .map_err(|error| BadInput::new(&path, error))?;
    let rms = found.held_out_rms.unwrap_or(f64::NAN);
    Ok(vec![bounds::figure("hysteresis.identification.size_17", rms)].into())
}
