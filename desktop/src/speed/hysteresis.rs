//! A sample of hysteresis: the staircase, and the relays of eq. (9) over the staircase of as many levels.
//!
//! Three tones of 10 to 120 Hz at 10 kHz, 1024 samples with minor loops in minor loops. A desktop's processor predicts the
//! reversals of such an input; at random reversals a sample takes about twice as long.

use std::f64::consts::TAU;
use std::hint::black_box;

use strainwave::compensator::HYSTERESIS_MEMORY;
use strainwave::hysteresis::{Relays, RelaysState, Staircase, StaircaseState, Weights};
use strainwave::{Error, Real};

use super::{Kernel, floor};

/// Samples of a pass.
const SAMPLES: usize = 1024;
/// Amplitude and cycles of each tone.
const TONES: [(f64, f64); 3] = [(0.5, 1.0), (0.3, 4.0), (0.2, 12.0)];

/// The rival of the relays.
const FIFTY: &str = "hysteresis.staircase_50";

pub(super) fn kernels() -> Result<Vec<Kernel>, Error> {
    Ok(vec![
        staircase::<f32, 24>("hysteresis.staircase_24")?,
        staircase::<f64, 50>(FIFTY)?,
        staircase::<f64, 64>("hysteresis.staircase_64")?,
        relays::<50>("hysteresis.relays_50", FIFTY)?,
    ])
}

/// Sum of the tones, within +-1.
fn inputs<R: Real>() -> Vec<R> {
    let input = |k: usize| {
        let time = TAU * k as f64 / SAMPLES as f64;
        TONES.iter().map(|(amplitude, cycles)| amplitude * (cycles * time).sin()).sum()
    };
    (0..SAMPLES).map(|k| R::lit(input(k))).collect()
}

fn staircase<R: Real, const L: usize>(name: &'static str) -> Result<Kernel, Error> {
    let model = Staircase::<R, L, HYSTERESIS_MEMORY>::build(R::ONE, &Weights::uniform(R::ONE)?)?;
    let mut state = StaircaseState::default();
    Ok(kernel(name, floor::NAME, move |input| model.step(&mut state, input).output))
}

fn relays<const L: usize>(name: &'static str, rival: &'static str) -> Result<Kernel, Error> {
    let model = Relays::<f64, L>::build(1.0, &Weights::uniform(1.0)?)?;
    let mut state = RelaysState::default();
    Ok(kernel(name, rival, move |input| model.step(&mut state, input)))
}

fn kernel<R: Real>(
    name: &'static str,
    rival: &'static str,
    mut step: impl FnMut(R) -> R + 'static,
) -> Kernel {
    let inputs = inputs::<R>();
    Kernel::new(name, rival, SAMPLES, move || {
        for input in &inputs {
            black_box(step(*input));
        }
    })
}
