//! The default gear's loop between +-rated torque: its width at zero torque, and the energy that a cycle takes.

use strainwave::Real;
use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY};
use strainwave::flexspline::stiffness_line::StiffnessLine;
use strainwave::hysteresis::{
    Relays, RelaysState, TorsionHysteresis, TorsionHysteresisState, Weights, gap_for_width,
};

use crate::design::joint::gear_params;
use crate::identify::torque_loop::{Sample, TorqueLoop};
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::verify::bounds;

/// Samples of a branch.
const SAMPLES: i32 = 20_000;

pub(super) fn measure() -> Vec<Figure> {
    let cycle = cycle();
    let width = gear_params::<f64>(&GearFile::default_gear()).hysteresis_width;
    let found = TorqueLoop::of(&cycle).map_or(f64::NAN, |found| found.width);
    vec![
        bounds::figure("hysteresis.default_gear.width", (found / width - 1.0).abs()),
        bounds::figure("hysteresis.default_gear.energy", (area(&cycle) / dissipated() - 1.0).abs()),
    ]
}

/// Rated torque (N m).
pub(super) fn rated_torque() -> f64 {
    gear_params(&GearFile::default_gear()).rated_torque
}

pub(super) fn line<R: Real>() -> StiffnessLine<R> {
    let params = gear_params::<R>(&GearFile::default_gear());
    params.flexspline.line.build().expect("the default gear has a line")
}

/// Half range (rad) and weights (N m).
fn weights<R: Real, const L: usize>() -> (R, Weights<R, L>) {
    let params = gear_params::<R>(&GearFile::default_gear());
    let half_range = line::<R>().torsion(params.rated_torque);
    let gap = gap_for_width(params.flexspline.line.stiffness[0], params.hysteresis_width, half_range);
    let weights = Weights::uniform(gap.expect("the default gear's loop is narrow enough"));
    (half_range, weights.expect("the gap is in range"))
}

pub(super) fn hysteresis<R: Real, const L: usize>() -> TorsionHysteresis<R, L, HYSTERESIS_MEMORY> {
    let (half_range, weights) = weights();
    TorsionHysteresis::from_weights(half_range, &weights).expect("the loop is in range")
}

/// Scenario S6 as it is meant, so slow that nothing but line and hysteresis is left: to the rated torque, to that of
/// the other side, and back, by the torsion for each torque; without the initial branch.
fn cycle() -> Vec<Sample> {
    let (line, model) = (line::<f64>(), hysteresis::<f64, HYSTERESIS_LEVELS>());
    let inverse = model.inverse(&line).expect("the line is stiffer than the loop");
    let mut state = TorsionHysteresisState::default();
    let rated = rated_torque();
    let mut to = |torque: f64| {
        let torsion = inverse.torsion(&state, torque);
        Sample { torsion, torque: line.torque(torsion) + model.step(&mut state, torsion).torque }
    };
    let up = |k: i32| rated * (2.0 * f64::from(k) / f64::from(SAMPLES) - 1.0);
    to(rated);
    let falling: Vec<_> = (0..=SAMPLES).rev().map(|k| to(up(k))).collect();
    let rising = (1..=SAMPLES).map(|k| to(up(k)));
    falling.into_iter().chain(rising).collect()
}

/// Energy that the cycle takes (J).
fn area(cycle: &[Sample]) -> f64 {
    let trapezoid =
        |pair: &[Sample]| 0.5 * (pair[0].torque + pair[1].torque) * (pair[1].torsion - pair[0].torsion);
    cycle.windows(2).map(trapezoid).sum()
}

/// Energy that the relays of eq. (9) lose in it (J).
fn dissipated() -> f64 {
    let (half_range, weights) = weights::<f64, HYSTERESIS_LEVELS>();
    let relays = Relays::build(half_range, &weights).expect("the range is positive");
    let mut state = RelaysState::default();
    relays.step(&mut state, half_range);
    let before = state.dissipated();
    relays.step(&mut state, -half_range);
    relays.step(&mut state, half_range);
    state.dissipated() - before
}
