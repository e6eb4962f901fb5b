//! Identification of Preisach weights: what comes back from data of known weights.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::hysteresis::{Staircase, StaircaseState, Weights};
use strainwave_desktop::identify::{Options, Sequence, Smoothing, identify, reversal};

const U: f64 = 2.0;

fn outputs<const L: usize>(weights: &Weights<f64, L>, inputs: &[f64]) -> Vec<f64> {
    let model = Staircase::<f64, L, 128>::build(U, weights).unwrap();
    let mut state = StaircaseState::default();
    inputs.iter().map(|input| model.step(&mut state, *input).output).collect()
}

fn random_weights<const L: usize>(seed: u64) -> Weights<f64, L> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let table: Vec<f64> = (0..L * L).map(|_| random.random_range(0.0..1.0)).collect();
    Weights::from_fn(|i, j| if i + j < L { table[i * L + j] } else { table[(L - 1 - j) * L + L - 1 - i] })
        .unwrap()
}

#[test]
fn recovers() {
    const L: usize = 16;
    let weights = random_weights::<L>(3);
    for input in [reversal::reversal_curves(U, L, 3), reversal::loops(U, L, 3, 15)] {
        let output = outputs(&weights, &input);
        for smoothing in [Smoothing::Chosen, Smoothing::Given(0.0)] {
            let started = std::time::Instant::now();
            let found = identify::<L>(
                Sequence { input: &input, output: &output },
                &Options { training: 1.0, smoothing, ..Options::new(U) },
            )
            .unwrap();
            println!(
                "{} {:?} smoothing {:e} rms {:e} exc {}",
                input.len(),
                started.elapsed(),
                found.smoothing,
                found.training_rms,
                found.excitation.share()
            );
            let mut worst = 0.0f64;
            for i in 0..L {
                for j in 0..=i {
                    worst = worst.max((found.weights.at(i, j) - weights.at(i, j)).abs());
                }
            }
            println!("worst {worst:e}");
        }
    }
}

#[test]
fn synthetic() {
    use rand_distr::{Distribution, Normal};
    const L: usize = 16;
    for seed in 1..=10 {
        let weights = random_weights::<L>(seed);
        let mut random = ChaCha8Rng::seed_from_u64(seed + 1000);
        let span = 2.0 * weights.total();
        let noise = Normal::new(0.0, 0.01 * span).unwrap();
        let input = reversal::reversal_curves(U, L, 4);
        let output: Vec<_> =
            outputs(&weights, &input).into_iter().map(|y| y + noise.sample(&mut random)).collect();
        let found = identify::<L>(
            Sequence { input: &input, output: &output },
            &Options { training: 1.0, ..Options::new(U) },
        )
        .unwrap();
        let minor: Vec<f64> = {
            let mut at = 0.0;
            (0..200)
                .flat_map(|_| {
                    let to = random.random_range(-U..U);
                    let from = at;
                    at = to;
                    (1..=20).map(move |k| from + (to - from) * k as f64 / 20.0)
                })
                .collect()
        };
        let (a, b) = (outputs(&weights, &minor), outputs(&found.weights, &minor));
        let worst = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / span;
        println!(
            "{} sm {:e} tr {:.4} worst {worst:.5}",
            input.len(),
            found.smoothing,
            found.training_rms / span
        );
    }
}

#[test]
fn lara() {
    use strainwave_desktop::gear_file::{self, GearFile};
    use strainwave_desktop::identify::{GearLog, GearOptions, identify_gear};
    let mut gear = GearFile::parse("g".as_ref(), gear_file::LARA8_J5.as_bytes()).unwrap();
    let log = strainwave_desktop::log::MeasuredLog::read(
        &strainwave_desktop::data::find("lara8/joint/jog_j2_mass.j5.csv").unwrap(),
    )
    .unwrap();
    let log = GearLog::of(&log, &gear).unwrap();
    for width in [0.0, 0.5, 1.0, 1.5] { gear.hysteresis.width_arcmin = width;
        for levels in [None, Some(6), Some(8), Some(12), Some(24)] {
            let t = std::time::Instant::now();
            match identify_gear(
                &gear,
                std::slice::from_ref(&log),
                &GearOptions { levels, ..Default::default() },
                |_| (),
            ) {
                Ok(f) => println!(
                    "{levels:?} {:?} L {} k {:.3} off {:?} sm {:e} val {:.2} tr {:.2} held {:.2} base {:.2} exc {:.3} width {:.4}",
                    t.elapsed(),
                    f.levels,
                    f.stiffness_factor,
                    f.offsets,
                    f.smoothing,
                    f.validation_rms * 1e6,
                    f.training_rms * 1e6,
                    f.held_out_rms.unwrap() * 1e6,
                    f.base_held_out_rms.unwrap() * 1e6,
                    f.excitation.share(),
                    f.gear.hysteresis.width_arcmin
                ),
                Err(e) => println!("{levels:?} {e}"),
            }
        }
    }
}
