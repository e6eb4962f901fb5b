//! The staircase against the relays, and the laws of the operator.

use super::*;
use crate::hysteresis::relays::{Relays, RelaysState};
use proptest::prelude::*;
use std::vec::Vec;

const U: f64 = 1.5e-3;
const S: f64 = 9.0;

fn staircase<R: Real, const L: usize, const MEMORY: usize>() -> Staircase<R, L, MEMORY> {
    Staircase::build(R::lit(U), &Weights::uniform(R::lit(S)).unwrap()).unwrap()
}

/// Outputs along inputs in units of U.
fn outputs<const MEMORY: usize>(inputs: &[f64]) -> Vec<f64> {
    let (model, mut state) = (staircase::<f64, 24, MEMORY>(), StaircaseState::default());
    inputs.iter().map(|u| model.step(&mut state, u * U).output).collect()
}

fn last(inputs: &[f64]) -> f64 {
    *outputs::<64>(inputs).last().unwrap()
}

/// Numbers 0..bound without a pattern (Marsaglia's xorshift64).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % bound
    }
}

/// Weights that grow towards the corner of the plane; symmetric, not uniform.
fn uneven<const L: usize>() -> Weights<f64, L> {
    Weights::from_fn(|i, j| (1 + (i - j) * (i - j)) as f64 * (1 + i + L - 1 - j) as f64).unwrap()
}

fn agrees_with_relays<const L: usize>(weights: Weights<f64, L>) {
    let relays = Relays::build(U, &weights).unwrap();
    let staircase = Staircase::<f64, L, 51>::build(U, &weights).unwrap();
    let (mut a, mut b) = (RelaysState::default(), StaircaseState::default());
    let (mut random, mut deepest) = (Random(88_172_645_463_325_252), 0);
    let (mut low, mut high) = (0, L);
    for step in 0..100_000 {
        // Mostly inwards, so that the memory gets deep; from time to time anywhere.
        if low >= high || step % 97 == 0 {
            (low, high) = (random.below(L / 2), L - random.below(L / 2));
        }
        let k = if random.below(2) == 0 {
            low += random.below(3);
            low.min(L)
        } else {
            high = high.saturating_sub(random.below(3));
            high
        };
        let input = relays.edge(k);
        let difference = relays.step(&mut a, input) - staircase.step(&mut b, input).output;
        assert!(difference.abs() < 1e-12 * weights.magnitude(), "step {step}: {difference:e}");
        deepest = deepest.max(b.depth());
    }
    assert!((L / 2..=L).contains(&deepest), "{deepest}");
}

/// Weights of either sign that cancel in every G, but not in the outputs.
fn cancelling<R: Real, const L: usize>() -> Weights<R, L> {
    let sign = |i: usize, j: usize| if (i - j).is_multiple_of(2) { R::ONE } else { -R::ONE };
    Weights::signed_from_fn(sign).unwrap()
}

#[test]
fn weights_that_cancel_have_room_for_their_outputs() {
    agrees_with_relays::<24>(cancelling());
    const L: usize = 24;
    let (exact, single) = (cancelling::<f64, L>(), cancelling::<f32, L>());
    let (exact, single) = (
        Staircase::<f64, L, 51>::build(1.0, &exact).unwrap(),
        Staircase::<f32, L, 51>::build(1.0, &single).unwrap(),
    );
    let (mut a, mut b) = (StaircaseState::default(), StaircaseState::default());
    let mut random = Random(88_172_645_463_325_252);
    for _ in 0..100_000 {
        let input = random.below(1 << 20) as f64 / f64::from(1 << 19) - 1.0;
        let (expected, found) = (exact.step(&mut a, input).output, single.step(&mut b, input as f32).output);
        assert!((f64::from(found) - expected).abs() < 1e-2, "{input}: {found} {expected}");
    }
}

#[test]
fn it_agrees_with_the_relays_at_grid_inputs() {
    agrees_with_relays::<8>(Weights::uniform(S).unwrap());
    agrees_with_relays::<16>(Weights::uniform(S).unwrap());
    agrees_with_relays::<24>(Weights::uniform(S).unwrap());
    agrees_with_relays::<50>(Weights::uniform(S).unwrap());
}

#[test]
fn it_agrees_with_the_relays_for_uneven_weights_and_odd_levels() {
    agrees_with_relays::<9>(uneven());
    agrees_with_relays::<24>(uneven());
}

fn path(length: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..=1.0f64, 0..length)
}

proptest! {
    #[test]
    fn a_greater_extremum_wipes_out_what_was_before(
        before in path(30), extremum in 0.2..1.0f64, after in path(30),
    ) {
        let inner: Vec<f64> = before.iter().map(|u| u * extremum).collect();
        let long = [&inner[..], &[extremum], &after].concat();
        let short = [&[extremum], &after[..]].concat();
        prop_assert!((last(&long) - last(&short)).abs() < 1e-12 * S);
    }

    #[test]
    fn minor_loops_between_the_same_inputs_are_congruent(
        one in path(30), two in path(30), ends in (-1.0..1.0f64, -1.0..1.0f64), at in 0.0..=1.0f64,
    ) {
        let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
        let inside = low + at * (high - low);
        let rise = |history: &[f64]| {
            let y = outputs::<64>(&[history, &[high, low, inside]].concat());
            y[y.len() - 1] - y[y.len() - 2]
        };
        prop_assert!((rise(&one) - rise(&two)).abs() < 1e-12 * S);
    }

    #[test]
    fn the_output_returns_when_the_input_returns_from_a_minor_loop(
        history in path(30), ends in (-1.0..1.0f64, -1.0..1.0f64), inside in path(20),
    ) {
        let (from, to) = ends;
        let minor: Vec<f64> = inside.iter().map(|x| from + (to - from) * (0.5 + 0.5 * x)).collect();
        let direct = last(&[&history[..], &[from, to]].concat());
        let around = last(&[&history[..], &[from, to], &minor, &[to]].concat());
        prop_assert!((direct - around).abs() < 1e-12 * S);
    }

    #[test]
    fn the_output_does_not_depend_on_the_rate(inputs in path(30), cuts in 1..20usize) {
        let mut slow = Vec::new();
        let mut from = 0.0;
        for &to in &inputs {
            slow.extend((1..cuts).map(|k| from + (to - from) * k as f64 / cuts as f64));
            slow.push(to);
            from = to;
        }
        if !inputs.is_empty() {
            prop_assert!((last(&inputs) - last(&slow)).abs() < 1e-12 * S);
        }
    }

    #[test]
    fn the_output_is_continuous(inputs in path(30), to in -1.0..=1.0f64) {
        let end = inputs.last().copied().unwrap_or(0.0);
        let sweep: Vec<f64> = (0..=1000).map(|k| end + (to - end) * f64::from(k) / 1000.0).collect();
        let y = outputs::<64>(&[&inputs[..], &sweep].concat());
        // dy/du never exceeds 2*S/U, the end of the major branch.
        let steepest = 2.0 * S * (to - end).abs() / 1000.0 + 1e-12;
        prop_assert!(y[inputs.len()..].windows(2).all(|w| (w[1] - w[0]).abs() <= steepest));
    }

    #[test]
    fn the_slope_is_the_derivative(inputs in path(30), to in -1.0..=1.0f64) {
        let (model, mut state) = (staircase::<f64, 24, 64>(), StaircaseState::default());
        for u in &inputs {
            model.step(&mut state, u * U);
        }
        let direction = (to - inputs.last().copied().unwrap_or(0.0)).signum();
        let response = model.step(&mut state, to * U);
        let h = direction * 1e-7 * U;
        let difference = (model.peek(&state, to * U + h).output - response.output) / h;
        // Except where the step crosses an edge of the grid or wipes out.
        let edges = (to * 12.0).floor() != ((to + direction * 1e-7) * 12.0).floor();
        let wipes = inputs.iter().any(|u| (u.abs() - to.abs()).abs() < 1e-6);
        prop_assume!(!edges && !wipes && to.abs() < 0.999_999);
        prop_assert!((difference - response.slope).abs() < 1e-4 * S / U);
    }

    #[test]
    fn f32_follows_f64(inputs in path(200)) {
        let (single, double) = (staircase::<f32, 24, 24>(), staircase::<f64, 24, 24>());
        let (mut a, mut b) = (StaircaseState::default(), StaircaseState::default());
        for u in inputs {
            let input = (u * U) as f32;
            let y = single.step(&mut a, input).output;
            let exact = double.step(&mut b, f64::from(input)).output;
            // Up to 24 turning points, each with an entry rounded to half a 32767th, counted twice.
            prop_assert!((f64::from(y) - exact).abs() < 24.0 / f64::from(i16::MAX) * S);
        }
    }

    #[test]
    fn any_input_bits_give_a_bounded_output(bits in prop::collection::vec(any::<u32>(), 1..200)) {
        let (model, mut state) = (staircase::<f32, 24, 8>(), StaircaseState::default());
        for bits in bits {
            let (before, input) = (state, f32::from_bits(bits));
            let response = model.step(&mut state, input);
            prop_assert!(response.output.abs() <= S as f32 * 1.001);
            let held = state.held() > before.held();
            prop_assert_eq!(held, input.is_nan());
            prop_assert!(held || state.is_saturated() == (input.abs() >= U as f32));
            prop_assert!(!held || (response.output == model.output(&before) && response.slope == 0.0));
            prop_assert!(!held || model.output(&state) == model.output(&before));
        }
    }

    #[test]
    fn peeking_sees_what_the_step_does(inputs in path(100)) {
        let (model, mut state) = (staircase::<f64, 24, 8>(), StaircaseState::default());
        for u in inputs {
            let seen = model.peek(&state, 1.2 * u * U);
            prop_assert_eq!(seen, model.step(&mut state, 1.2 * u * U));
        }
    }

    /// The bound of the header: a ring-down fills a memory that is too small for it, then the input leaves to one
    /// side and sweeps to the other. A path with more turning points would fill the memory again, with larger loops; a
    /// longer ring-down could end below the resolution of an input, 2^-52 of the range.
    #[test]
    fn a_full_memory_errs_within_its_bound(
        decays in prop::collection::vec(0.3..0.999f64, 10..28), mut sweep in path(20), side in any::<bool>(),
    ) {
        const MEMORY: usize = 9;
        let (full, short) = (staircase::<f64, 24, 128>(), staircase::<f64, 24, MEMORY>());
        let (mut a, mut b) = (StaircaseState::default(), StaircaseState::default());
        let mut amplitude = 1.0;
        let spiral: Vec<f64> = decays.iter().map(|decay| { amplitude *= -decay; amplitude }).collect();
        let bound = if spiral.len() >= MEMORY {
            2.0 * S * (0.5 * (spiral[MEMORY - 5] - spiral[MEMORY - 4]).abs()).powi(2) * 1.01 + 1e-9
        } else {
            1e-9
        };
        // Inside the smallest kept loop the output is exact, whatever was forgotten.
        for u in &spiral {
            let difference = full.step(&mut a, u * U).output - short.step(&mut b, u * U).output;
            prop_assert!(difference.abs() < 1e-12 * S);
        }
        sweep.sort_by(f64::total_cmp);
        for u in sweep.iter().map(|u| if side { *u } else { -u }) {
            let difference = full.step(&mut a, u * U).output - short.step(&mut b, u * U).output;
            prop_assert!(difference.abs() <= bound, "{} {}", difference, bound);
        }
    }
}

/// Largest error, relative to the output at saturation, when the input leaves a ring-down.
fn ring_down_error<const MEMORY: usize>() -> f64 {
    let spiral: Vec<f64> = (0..112).map(|k: i32| (-0.94f64).powi(k)).collect();
    let errors = [1.0, -1.0].map(|side| {
        let out: Vec<f64> = (0..=2000).map(|k| side * f64::from(k) / 2000.0).collect();
        let inputs = [&spiral[..], &out].concat();
        let pairs = outputs::<128>(&inputs).into_iter().zip(outputs::<MEMORY>(&inputs));
        pairs.map(|(exact, found)| (exact - found).abs() / S).fold(0.0, f64::max)
    });
    errors[0].max(errors[1])
}

/// The figures of the header.
#[test]
fn a_ring_down_that_overflows_the_memory_errs_little() {
    assert!((0.025..0.026).contains(&ring_down_error::<28>()));
    assert!((0.041..0.042).contains(&ring_down_error::<24>()));
    let kept = 0.5 * (0.94f64.powi(28 - 5) + 0.94f64.powi(28 - 4));
    assert!((2.0 * kept * kept - 0.11).abs() < 0.005);
}

#[test]
fn it_starts_demagnetised() {
    let (model, state) = (staircase::<f64, 24, 8>(), StaircaseState::default());
    assert!(model.peek(&state, 0.0).output.abs() < 1e-15 * S);
    // On the virgin curve of the standard shape, S*(u/U)^2.
    for k in 0..=12 {
        let x = f64::from(k) / 12.0;
        assert!((model.peek(&state, x * U).output - S * x * x).abs() < 1e-13);
        assert!((model.peek(&state, -x * U).output + S * x * x).abs() < 1e-13);
    }
}

#[test]
fn a_parameter_out_of_range_is_named() {
    let weights = Weights::<f64, 8>::uniform(1.0).unwrap();
    let small = Staircase::<f64, 8, 7>::build(1.0, &weights);
    assert_eq!(small.unwrap_err(), Error::OutOfRange("capacity"));
    let range = Staircase::<f64, 8, 8>::build(f64::NAN, &weights);
    assert_eq!(range.unwrap_err(), Error::OutOfRange("half_range"));
}
