//! Laws of the operator on random histories, differences as fractions of the total weight.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::history::{at_random, inputs, run};
use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Histories of each law.
const HISTORIES: usize = 2000;
/// Most inputs of a history: fewer than the memory holds.
const INPUTS: usize = 25;

/// Violation of a law by one random history.
type Law = fn(&mut ChaCha8Rng) -> f64;

pub(super) fn measure() -> Vec<Figure> {
    let laws: [(&str, Law); 4] = [
        ("hysteresis.wiping_out", wiping_out),
        ("hysteresis.congruency", congruency),
        ("hysteresis.return_point", return_point),
        ("hysteresis.rate_independence", rate_independence),
    ];
    let figure = |(name, law): (&str, fn(&mut ChaCha8Rng) -> f64)| {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        bounds::figure(name, largest((0..HISTORIES).map(|_| law(&mut random))))
    };
    laws.map(figure).to_vec()
}

fn last(outputs: &[f64]) -> f64 {
    *outputs.last().expect("a history has inputs")
}

/// Wiping-out: a history before an extremum greater than all of it has no effect.
fn wiping_out(random: &mut ChaCha8Rng) -> f64 {
    let model = at_random(random);
    let extremum: f64 = random.random_range(0.1..1.0);
    let before = inputs(random, INPUTS).into_iter().map(|input| extremum * input);
    let after = inputs(random, INPUTS / 2);
    let since = || std::iter::once(extremum).chain(after.iter().copied());
    last(&run(&model, before.chain(since())).1) - last(&run(&model, since()).1)
}

/// Minor loops between the same inputs rise alike, whatever was before.
fn congruency(random: &mut ChaCha8Rng) -> f64 {
    let model = at_random(random);
    let [a, b, fraction]: [f64; 3] = random.random();
    let (low, high) = (2.0 * a.min(b) - 1.0, 2.0 * a.max(b) - 1.0);
    let mut rise = || {
        let before = inputs(random, INPUTS - 3);
        let outputs = run(&model, before.into_iter().chain([high, low, low + fraction * (high - low)])).1;
        outputs[outputs.len() - 1] - outputs[outputs.len() - 2]
    };
    rise() - rise()
}

/// Back from a minor loop the output is what it was.
fn return_point(random: &mut ChaCha8Rng) -> f64 {
    let model = at_random(random);
    let mut before = inputs(random, INPUTS / 2);
    let [from, to]: [f64; 2] = [random.random_range(-1.0..1.0), random.random_range(-1.0..1.0)];
    before.extend([from, to]);
    let inside = inputs(random, INPUTS / 2).into_iter().map(|x| from + (to - from) * (0.5 + 0.5 * x));
    let around = before.iter().copied().chain(inside).chain([to]);
    last(&run(&model, around).1) - last(&run(&model, before.iter().copied()).1)
}

/// A monotone input may take any number of steps.
fn rate_independence(random: &mut ChaCha8Rng) -> f64 {
    let model = at_random(random);
    let fast = inputs(random, INPUTS);
    let mut slow = Vec::new();
    for pair in std::iter::once(0.0).chain(fast.iter().copied()).collect::<Vec<_>>().windows(2) {
        let steps = random.random_range(1..20);
        slow.extend((1..steps).map(|k| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(steps)));
        slow.push(pair[1]);
    }
    last(&run(&model, slow).1) - last(&run(&model, fast).1)
}
