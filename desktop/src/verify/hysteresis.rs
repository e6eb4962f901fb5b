//! Hysteresis: two realisations of one operator, and the default gear's loop.

mod identification;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY};
use strainwave::hysteresis::{
    Relays, RelaysState, Staircase, StaircaseState, TorsionHysteresis, TorsionHysteresisParams, Weights,
    gap_for_width,
};

use crate::bounds;
use crate::file::BadInput;
use crate::gear_file::GearFile;
use crate::joint::gear_params;
use crate::verify::{Measured, largest};

/// Random inputs on the grid.
const INPUTS: usize = 100_000;
/// Points of a branch of the loop.
const POINTS: i32 = 2000;

pub(super) fn measure() -> Result<Measured, BadInput> {
    let mut measured = Measured::from(vec![
        bounds::figure("hysteresis.staircase_against_relays", worst_against_relays()),
        bounds::figure("hysteresis.default_gear.width", width_error()),
    ]);
    measured.add(identification::measure()?);
    Ok(measured)
}

/// Largest difference of the outputs as a share of the total weight.
fn worst_against_relays() -> f64 {
    const LEVELS: usize = HYSTERESIS_LEVELS;
    let weights = Weights::uniform(1.0).expect("the weight is in range");
    let relays = Relays::<f64, LEVELS>::build(1.0, &weights).expect("the range is positive");
    let staircase = Staircase::<f64, LEVELS, { LEVELS + 2 }>::build(1.0, &weights).expect("as the relays");
    let (mut relays_state, mut staircase_state) = (RelaysState::default(), StaircaseState::default());
    let mut random = ChaCha8Rng::seed_from_u64(1);
    largest((0..INPUTS).map(|_| {
        let input = f64::from(random.random_range(0..=LEVELS as i32)) * 2.0 / LEVELS as f64 - 1.0;
        relays.step(&mut relays_state, input) - staircase.step(&mut staircase_state, input).output
    }))
}

/// Relative error of the full width at zero torque after +-rated torque, with the levels of the real-time build.
fn width_error() -> f64 {
    let file = GearFile::default_gear();
    let params = gear_params::<f64>(&file);
    let line = params.flexspline.line.build().expect("the default gear has a line");
    let half_range = line.torsion(params.rated_torque);
    let gap = gap_for_width(params.flexspline.line.stiffness[0], params.hysteresis_width, half_range)
        .expect("the default gear's loop is narrow enough");
    let model: TorsionHysteresis<f64, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY> =
        TorsionHysteresisParams { half_range, gap }.build().expect("the loop is in range");
    let mut state = Default::default();
    // Up once, then the two branches; each is read off where its torque passes zero.
    let mut zero_crossing = |from: f64, to: f64| {
        let mut last = None;
        let mut crossing = f64::NAN;
        for k in 0..=POINTS {
            let torsion = from + (to - from) * f64::from(k) / f64::from(POINTS);
            let torque = line.torque(torsion) + model.step(&mut state, torsion).torque;
            if let Some((before, torque_before)) = last
                && (torque_before < 0.0) != (torque < 0.0)
            {
                crossing = before + (torsion - before) * torque_before / (torque_before - torque);
            }
            last = Some((torsion, torque));
        }
        crossing
    };
    zero_crossing(0.0, half_range);
    let falling = zero_crossing(half_range, -half_range);
    let rising = zero_crossing(-half_range, half_range);
    ((falling - rising).abs() / params.hysteresis_width - 1.0).abs()
}
