//! Identification of Preisach weights: what comes back from data of known weights.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use strainwave::hysteresis::{Staircase, StaircaseState, TorsionHysteresis, TorsionHysteresisState, Weights};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::gear_params;
use strainwave_desktop::identify::{
    Error, GearLog, GearOptions, Options, Sequence, Smoothing, identify, identify_gear, reversal,
};
use strainwave_desktop::io::data;

const U: f64 = 2.0;

fn outputs<const L: usize>(weights: &Weights<f64, L>, inputs: &[f64]) -> Vec<f64> {
    let model = Staircase::<f64, L, 128>::build(U, weights).unwrap();
    let mut state = StaircaseState::default();
    inputs.iter().map(|input| model.step(&mut state, *input).output).collect()
}

/// Symmetric weights from `least` to 1, a third of them 0.
fn random_weights<const L: usize>(random: &mut ChaCha8Rng, least: f64) -> Weights<f64, L> {
    let mut table = vec![0.0; L * L];
    for weight in &mut table {
        *weight = if random.random_range(0..3) == 0 { 0.0 } else { random.random_range(least..1.0) };
    }
    let weight =
        |i: usize, j: usize| if i + j < L { table[i * L + j] } else { table[(L - 1 - j) * L + L - 1 - i] };
    Weights::signed_from_fn(weight).unwrap()
}

fn furthest<const L: usize>(a: &Weights<f64, L>, b: &Weights<f64, L>) -> f64 {
    let cells = (0..L).flat_map(|i| (0..=i).map(move |j| (i, j)));
    cells.map(|(i, j)| (a.at(i, j) - b.at(i, j)).abs()).fold(0.0, f64::max)
}

/// All samples train, without smoothness.
fn exact() -> Options {
    Options { training: 1.0, smoothing: Smoothing::Given(0.0), ..Options::new(U) }
}

#[test]
fn the_weights_come_back_from_what_excites_them_all() {
    const L: usize = 12;
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let walk: Vec<f64> = (0..1500).map(|_| random.random_range(-1.1 * U..1.1 * U)).collect();
    for input in [reversal::reversal_curves(U, L, 3), reversal::loops(U, L, 3, L - 1), walk] {
        let weights = random_weights::<L>(&mut random, 0.0);
        let output = outputs(&weights, &input);
        let found = identify::<L>(Sequence { input: &input, output: &output }, &exact()).unwrap();
        assert!(furthest(&found.weights, &weights) < 2e-4, "{}", furthest(&found.weights, &weights));
        assert!(found.excitation.fraction() == 1.0 && found.training_rms < 1e-4);
    }
}

#[test]
fn an_offset_is_no_weight() {
    const L: usize = 8;
    let weights = random_weights::<L>(&mut ChaCha8Rng::seed_from_u64(2), 0.0);
    let input = reversal::reversal_curves(U, L, 3);
    let output: Vec<_> = outputs(&weights, &input).iter().map(|y| y - 5.0).collect();
    // Just smooth enough for the solver not to look for digits below rounding.
    let options = Options { offset: true, smoothing: Smoothing::Given(1e-9), ..exact() };
    let found = identify::<L>(Sequence { input: &input, output: &output }, &options).unwrap();
    assert!((found.offset + 5.0).abs() < 1e-3 && furthest(&found.weights, &weights) < 1e-3);
}

/// The fitted output is that of the operator built from the weights, between grid points too.
#[test]
fn the_operator_gives_what_was_fitted() {
    const L: usize = 10;
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let input: Vec<f64> = (0..800).map(|_| random.random_range(-U..U)).collect();
    let output: Vec<f64> = input.iter().map(|u| u + 0.3 * (5.0 * u).sin()).collect();
    let found = identify::<L>(Sequence { input: &input, output: &output }, &Options::new(U)).unwrap();
    let operator = outputs(&found.weights, &input);
    let scale = found.weights.total();
    assert!(operator.iter().zip(&found.predicted).all(|(a, b)| (a - b).abs() < 1e-12 * scale));
    let rms = |range: std::ops::Range<usize>| {
        let count = range.len() as f64;
        (range.map(|k| (output[k] - operator[k]).powi(2)).sum::<f64>() / count).sqrt()
    };
    assert!((rms(0..400) - found.training_rms).abs() < 1e-9 * scale);
    assert!((rms(400..800) - found.held_out_rms.unwrap()).abs() < 1e-9 * scale);
}

#[test]
fn negative_weights_are_found_when_asked_for_alone() {
    const L: usize = 8;
    let weights = random_weights::<L>(&mut ChaCha8Rng::seed_from_u64(4), -1.0);
    let input = reversal::reversal_curves(U, L, 4);
    let output = outputs(&weights, &input);
    let sequence = Sequence { input: &input, output: &output };
    let signed = identify::<L>(sequence, &Options { signed: true, ..exact() }).unwrap();
    assert!(furthest(&signed.weights, &weights) < 1e-3);
    let bounded = identify::<L>(sequence, &exact()).unwrap();
    assert!((0..L).all(|i| (0..=i).all(|j| bounded.weights.at(i, j) >= 0.0)));
    assert!(bounded.training_rms > 100.0 * signed.training_rms);
}

/// A log that stays small leaves most of the triangle alone, and says so.
#[test]
fn what_was_not_moved_is_told_and_continued() {
    const L: usize = 12;
    let weights = Weights::<f64, L>::uniform(6.0).unwrap();
    let input: Vec<f64> = reversal::reversal_curves(0.5 * U, L, 4);
    let output = outputs(&weights, &input);
    let options = Options { training: 1.0, ..Options::new(U) };
    let found = identify::<L>(Sequence { input: &input, output: &output }, &options).unwrap();
    let fraction = found.excitation.fraction();
    assert!((0.2..0.4).contains(&fraction), "{fraction}");
    assert!(
        found.excitation.moved[6][5]
            && !found.excitation.moved[L - 1][0]
            && !found.excitation.moved[L - 1][L - 1]
    );
    // Even weights are what the smoothness continues by.
    assert!(furthest(&found.weights, &weights) < 0.05 * weights.at(L - 1, 0));
}

#[test]
fn what_shows_no_hysteresis_is_refused_by_name() {
    let refused = |input: &[f64], output: &[f64]| {
        identify::<8>(Sequence { input, output }, &Options::new(U)).unwrap_err()
    };
    let rise: Vec<f64> = (0..200).map(|k| f64::from(k) / 100.0).collect();
    assert_eq!(refused(&rise[..60], &rise[..60]), Error::TooShort { samples: 60, least: 100 });
    assert!(matches!(refused(&rise, &rise), Error::NeverReverses { input: "input", .. }));
    assert!(matches!(refused(&[1.0; 200], &rise), Error::NeverReverses { span: 0.0, .. }));
    assert_eq!(refused(&rise, &rise[1..]), Error::Lengths { inputs: 200, outputs: 199 });
    let mut gap = rise.clone();
    gap[7] = f64::NAN;
    assert_eq!(refused(&gap, &rise), Error::NotFinite { sample: 7 });
    assert_eq!(refused(&rise, &gap), Error::NotFinite { sample: 7 });
    let bad = |options: Options| {
        let (input, output) = (reversal::reversal_curves(U, 8, 4), reversal::reversal_curves(U, 8, 4));
        identify::<8>(Sequence { input: &input, output: &output }, &options).unwrap_err().to_string()
    };
    assert_eq!(bad(Options { half_range: -1.0, ..exact() }), "half_range is out of range");
    assert_eq!(bad(Options { training: 0.0, ..exact() }), "training is out of range");
}

/// A joint of the default gear, softer by `factor`, with weights of its own, under a sequence of torsions up to rated
/// torque; torque and torsion with the noise of sensors.
struct Joint {
    base: GearFile,
    log: GearLog,
    width: f64,
}

fn joint(stiffness_factor: f64, width: f64, noise: [f64; 2]) -> Joint {
    let base = GearFile::default_gear();
    let mut truth = base.clone();
    for stiffness in [&mut truth.stiffness.k1, &mut truth.stiffness.k2, &mut truth.stiffness.k3] {
        *stiffness *= stiffness_factor;
    }
    truth.hysteresis.width_arcmin = width;
    let params = gear_params::<f64>(&truth);
    let line = params.flexspline.line.build().unwrap();
    let half_range = line.torsion(params.rated_torque);
    let model: TorsionHysteresis<f64, 24, 64> = params.hysteresis().unwrap();
    let mut state = TorsionHysteresisState::default();
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let [torque_noise, torsion_noise] = noise.map(|noise| Normal::new(0.0, noise).unwrap());
    let mut log = GearLog::default();
    for torsion in reversal::loops(half_range, 24, 4, 3) {
        let torque = line.torque(torsion) + model.step(&mut state, torsion).torque;
        log.time.push(log.time.len() as f64 * 0.01);
        log.torque.push(torque + torque_noise.sample(&mut random));
        log.torsion.push(torsion + 0.1 + torsion_noise.sample(&mut random));
    }
    Joint { base, log, width: truth.hysteresis.width() }
}

#[test]
fn a_joint_s_loop_and_stiffness_come_back_from_noisy_sensors() {
    for (factor, width) in [(0.8, 2.0), (1.05, 0.5)] {
        let Joint { base, log, width } = joint(factor, width, [0.2, 2e-6]);
        let found = identify_gear(&base, &[log], &GearOptions::default(), |_| ()).unwrap();
        assert!((found.stiffness_factor / factor - 1.0).abs() < 0.01, "{}", found.stiffness_factor);
        let error = found.gear.hysteresis.width() / width - 1.0;
        assert!(error.abs() < 0.05, "{error}");
        assert!((found.starts[0].offset - 0.1).abs() < 2e-6);
        let (held_out, base) = (found.held_out_rms.unwrap(), found.base_held_out_rms.unwrap());
        assert!(held_out < 2.5e-5 && held_out < 0.5 * base, "{held_out:e} {base:e}");
        let text = found.gear.to_toml();
        assert_eq!(GearFile::parse("g.toml".as_ref(), text.as_bytes()).unwrap(), found.gear);
    }
}

#[test]
fn a_log_that_says_nothing_new_gives_the_base_gear_back() {
    let Joint { base, log, width } = joint(1.0, 1.0, [0.0; 2]);
    let options = GearOptions { smoothing: Smoothing::Given(1e3), ..GearOptions::default() };
    let found = identify_gear(&base, &[log], &options, |_| ()).unwrap();
    assert!((found.stiffness_factor - 1.0).abs() < 1e-3, "{}", found.stiffness_factor);
    assert!((found.gear.hysteresis.width() / width - 1.0).abs() < 0.01);
    let (identified, standard) = (gear_params::<f64>(&found.gear), gear_params::<f64>(&base));
    let [identified, standard] =
        [identified, standard].map(|gear| gear.hysteresis_weights::<24>().unwrap().1);
    assert!(furthest(&identified, &standard) < 1e-3 * standard.at(23, 0));
}

#[test]
fn logs_that_cannot_identify_a_gear_are_refused() {
    let Joint { base, log, .. } = joint(1.0, 1.0, [0.0; 2]);
    let refused = |change: fn(&mut GearLog)| {
        let mut log = log.clone();
        change(&mut log);
        identify_gear(&base, &[log], &GearOptions::default(), |_| ()).unwrap_err().to_string()
    };
    let line = refused(|log| log.motor_travel = 3.0);
    assert_eq!(line, "the motor turns by 3.000 rad; allowed: at most 0.5 rad, the joint has to be held");
    let line = refused(|log| log.torque = (0..log.torque.len()).map(|k| k as f64).collect());
    assert!(line.starts_with("the torque never reverses by 0.01 of its span"), "{line}");
    let line = refused(|log| log.torque.truncate(70));
    assert_eq!(line, "70 samples are too few; allowed: at least 100");
}

/// The figures of the verify part, from the data themselves: what trains does not see what is predicted.
#[test]
fn the_second_half_of_the_measured_log_does_not_train() {
    let Some(path) = data::find("lara8/joint/jog_j2_mass.j5.csv") else {
        println!("skipped: no data");
        return;
    };
    let gear = GearFile::parse("g".as_ref(), strainwave_desktop::io::gear_file::LARA8_J5.as_bytes()).unwrap();
    let log = GearLog::of(&strainwave_desktop::io::log::MeasuredLog::read(&path).unwrap(), &gear).unwrap();
    let mut other = log.clone();
    let half = log.torsion.len() / 2;
    other.torsion[half..].iter_mut().for_each(|torsion| *torsion += 1e-3);
    let identified = |log: GearLog| identify_gear(&gear, &[log], &GearOptions::default(), |_| ()).unwrap();
    let (found, moved) = (identified(log), identified(other));
    assert_eq!(found.gear, moved.gear);
    assert!((found.predicted[0][half] - moved.predicted[0][half]).abs() == 0.0);
    assert!(moved.held_out_rms.unwrap() > 9e-4);
}

/// The way up of a joint's log, eight samples for each of its.
fn ramp(log: &GearLog, rated: f64) -> GearLog {
    let peak = log.torque.iter().position(|torque| *torque > 0.95 * rated).unwrap();
    let back = peak + log.torque[peak..].iter().position(|torque| *torque < 0.9 * rated).unwrap();
    let finer = |column: &[f64]| {
        let pairs = column[..=back].windows(2);
        let between = |pair: &[f64]| {
            [0, 1, 2, 3, 4, 5, 6, 7].map(|k| pair[0] + (pair[1] - pair[0]) * f64::from(k) / 8.0)
        };
        pairs.flat_map(between).collect()
    };
    GearLog {
        time: finer(&log.time),
        torque: finer(&log.torque),
        torsion: finer(&log.torsion),
        ..log.clone()
    }
}

/// What differs in the hysteresis of a joint and its base gear counts as stiffness: a single branch does not tell them apart.
#[test]
fn a_torque_that_goes_one_way_gives_a_stiffness_and_keeps_the_hysteresis() {
    for (width, factor, most) in [(0.0, 0.8, 0.02), (0.0, 1.1, 0.02), (1.0, 0.8, 0.12), (1.0, 1.1, 0.12)] {
        let Joint { mut base, log, .. } = joint(factor, width, [0.2, 2e-6]);
        base.hysteresis.width_arcmin = width;
        let log = ramp(&log, base.gear.rated_torque);
        for levels in [None, Some(6), Some(8)] {
            let options = GearOptions { levels, training: 1.0, ..GearOptions::default() };
            let found = identify_gear(&base, std::slice::from_ref(&log), &options, |_| ()).unwrap();
            let error = found.stiffness_factor / factor - 1.0;
            assert!(error.abs() < most, "{width} {factor}: {error}");
            assert!(found.table.is_none() && found.gear.hysteresis == base.hysteresis);
            found.gear.check().unwrap();
        }
    }
}

#[test]
fn a_stiffness_beyond_its_search_is_told() {
    let Joint { mut base, log, .. } = joint(1.0, 0.0, [0.0; 2]);
    base.hysteresis.width_arcmin = 0.0;
    let mut log = ramp(&log, base.gear.rated_torque);
    let limits = |log: &GearLog| {
        let options = GearOptions { training: 1.0, ..GearOptions::default() };
        identify_gear(&base, std::slice::from_ref(log), &options, |_| ()).unwrap().limits()
    };
    assert_eq!(limits(&log), []);
    log.torsion.iter_mut().for_each(|torsion| *torsion *= 8.0);
    assert_eq!(limits(&log), [("stiffness.k1_nm_per_rad", 0.2)]);
}

/// A joint that was loaded before its log: what it came from is found, not counted as stiffness.
#[test]
fn a_log_may_start_from_any_state() {
    let base = GearFile::default_gear();
    let mut wide = base.clone();
    wide.hysteresis.width_arcmin = 2.0;
    let params = gear_params::<f64>(&wide);
    let line = params.flexspline.line.build().unwrap();
    let model: TorsionHysteresis<f64, 24, 64> = params.hysteresis().unwrap();
    let mut state = TorsionHysteresisState::default();
    model.step(&mut state, -line.torsion(params.rated_torque));
    let mut log = GearLog::default();
    for k in 0..300 {
        let torsion =
            line.torsion(0.5 * params.rated_torque) * f64::from(if k < 200 { k } else { 400 - k }) / 200.0;
        log.time.push(f64::from(k) * 0.01);
        log.torque.push(line.torque(torsion) + model.step(&mut state, torsion).torque);
        log.torsion.push(torsion);
    }
    let options = GearOptions { training: 1.0, ..GearOptions::default() };
    let found = identify_gear(&wide, &[log], &options, |_| ()).unwrap();
    assert!(found.starts[0].extreme_torque < -0.5 * params.rated_torque, "{:?}", found.starts);
    assert!((found.stiffness_factor - 1.0).abs() < 0.01, "{}", found.stiffness_factor);
    assert!(found.training_rms < 5e-6, "{:e}", found.training_rms);
}

/// A torsion that jumps at every reversal, as backlash makes it, asks for a torque that falls.
#[test]
fn an_identified_gear_passes_its_own_check() {
    let Joint { base, mut log, .. } = joint(1.0, 3.0, [0.5, 2e-6]);
    let mut sign = 0.0;
    for k in 1..log.torque.len() {
        let step = log.torque[k] - log.torque[k - 1];
        sign = if step.abs() > 1.0 { step.signum() } else { sign };
        log.torsion[k] += 3e-4 * sign;
    }
    let options =
        GearOptions { smoothing: Smoothing::Given(1e-10), levels: Some(24), ..GearOptions::default() };
    let found = identify_gear(&base, &[log], &options, |_| ()).unwrap();
    found.gear.check().unwrap();
}

/// How much of the measured log trains does not matter, nor on which grid.
#[test]
fn the_measured_joint_s_stiffness_does_not_depend_on_the_part_that_trains() {
    let Some(path) = data::find("lara8/joint/jog_j2_mass.j5.csv") else {
        println!("skipped: no data");
        return;
    };
    let gear = GearFile::parse("g".as_ref(), strainwave_desktop::io::gear_file::LARA8_J5.as_bytes()).unwrap();
    let log = GearLog::of(&strainwave_desktop::io::log::MeasuredLog::read(&path).unwrap(), &gear).unwrap();
    let identified = |training: f64, levels: Option<usize>| {
        let options = GearOptions { training, levels, ..GearOptions::default() };
        identify_gear(&gear, std::slice::from_ref(&log), &options, |_| ()).unwrap()
    };
    let whole = identified(1.0, None);
    assert!(whole.training_rms < 35e-6, "{:e}", whole.training_rms);
    for (training, levels) in
        [(0.3, None), (0.4, None), (0.5, Some(6)), (0.5, Some(8)), (0.7, None), (0.9, None)]
    {
        let found = identified(training, levels);
        let difference = found.stiffness_factor / whole.stiffness_factor - 1.0;
        assert!(difference.abs() < 0.05, "{training}: {difference}");
        assert!(found.held_out_rms < found.base_held_out_rms);
        found.gear.check().unwrap();
    }
}
