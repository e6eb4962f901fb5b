//! Operators identified from some loops of an actuator, which predict others.
//!
//! | file | |
//! | --- | --- |
//! | `actuators` | actuators of other classes, and the inputs |
//! | `rivals` | others on the same splits: scipy's non-negative least squares |
//!
//! Splits: the major loop trains and the nested loops and every reversal curve are predicted; or every second reversal curve trains, too, and
//! the others and the nested loops are predicted. What trains has 1 % of noise; what is predicted is compared with what the
//! actuator does, without. Of the measured joint half of its log trains. Errors are rms, of the span of what trains.

mod actuators;
mod rivals;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use self::actuators::{Actuator, BUTTERFLY, DISSIPATIVE};
use super::held;
use crate::identify::{IdentifiedOperator, OperatorOptions, identify_operator};
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::log::InputOutput;
use crate::verify::Measured;
use crate::verify::bounds::figure_as;

/// Standard deviation of the noise, of the span.
const NOISE: f64 = 0.01;
const SEED: u64 = 10_000;

/// One split, and the row of its bound.
struct Split {
    name: String,
    row: &'static str,
    options: OperatorOptions,
    trained: Vec<InputOutput>,
    held_out: Vec<InputOutput>,
}

/// Every split; `progress` is called with the fraction done. With `rivals` they are measured on the same splits.
pub(super) fn measure(rivals: bool, mut progress: impl FnMut(f64)) -> Result<Measured, BadInput> {
    let mut measured = Measured::default();
    let mut splits: Vec<_> = DISSIPATIVE.iter().flat_map(|of| splits(of, false)).collect();
    splits.extend(self::splits(&BUTTERFLY, true));
    match held_joint()? {
        Some(split) => splits.push(split),
        None => {
            measured.notes.push(format!("identify.operator.held_joint: skipped: no data ({})", held::LOG));
        }
    }
    let mut ours = Vec::new();
    for (done, split) in splits.iter().enumerate() {
        progress(done as f64 / splits.len() as f64);
        let found = identify_operator(&split.trained, &split.held_out, &split.options, |_| ())
            .map_err(|why| BadInput::message(format_args!("{}: {why}", split.name)))?;
        let error = found.held_out.map_or(f64::NAN, |errors| errors.rms);
        measured.figures.push(figure_as(format!("{}.held_out", split.name), split.row, error));
        measured.figures.extend(details(split, &found));
        ours.push(error);
    }
    if rivals {
        measured.add(rivals::measure(&splits, &ours)?);
    } else {
        measured.notes.push("identify.operator.over_rival: not measured; --rivals does".into());
    }
    Ok(measured)
}

fn details(split: &Split, found: &IdentifiedOperator) -> Vec<Figure> {
    let Some(errors) = found.held_out else { return Vec::new() };
    let reported = |what: &str, value| Figure::reported(format!("{}.{what}", split.name), value, "1");
    vec![
        reported("held_out_max", errors.max),
        reported("line", errors.line_rms),
        reported("levels", found.operator.grid().levels as f64),
    ]
}

/// Both splits of an actuator.
fn splits(actuator: &Actuator, signed: bool) -> [Split; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let clean = |input: Vec<f64>| InputOutput { output: (actuator.output)(&input), input };
    let mut noisy = |log: InputOutput| with_noise(log, &mut random);
    // One actuator, one recording: the noise of a loop is the same in both splits.
    let major = noisy(clean(actuators::major()));
    let curves: Vec<_> = actuators::curves().map(clean).collect();
    let nested = clean(actuators::nested());
    let every_second = |first: usize| curves.iter().skip(first).step_by(2).cloned();
    let trained = every_second(0).map(&mut noisy);
    let trained: Vec<_> = std::iter::once(major.clone()).chain(trained).collect();
    let split = |what: &str, trained, held_out| Split {
        name: format!("identify.operator.{}.{what}", actuator.name),
        row: if signed { "identify.operator.butterfly" } else { "identify.operator.held_out" },
        options: OperatorOptions { training: 1.0, signed, ..OperatorOptions::default() },
        trained,
        held_out,
    };
    [
        split("major", vec![major], curves.iter().cloned().chain([nested.clone()]).collect()),
        split("curves", trained, every_second(1).chain([nested]).collect()),
    ]
}

fn with_noise(mut log: InputOutput, random: &mut ChaCha8Rng) -> InputOutput {
    let (least, most) =
        log.output.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(*y), b.max(*y)));
    // A span is a positive number.
    if let Ok(noise) = Normal::new(0.0, NOISE * (most - least)) {
        log.output.iter_mut().for_each(|y| *y += noise.sample(random));
    }
    log
}

/// Torsion over torque of a measured joint; `None` without the data.
fn held_joint() -> Result<Option<Split>, BadInput> {
    let Some((_, log)) = held::log()? else { return Ok(None) };
    Ok(Some(Split {
        name: "identify.operator.held_joint".into(),
        row: "identify.operator.held_out",
        options: OperatorOptions::default(),
        trained: vec![InputOutput { input: log.torque, output: log.torsion }],
        held_out: Vec::new(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Smoothing;

    /// On one grid, so that it takes a second.
    #[test]
    fn loops_that_did_not_train_are_predicted_whichever_way_the_output_goes() {
        for actuator in DISSIPATIVE {
            let [_, mut curves] = splits(&actuator, false);
            curves.options.levels = Some(8);
            curves.options.smoothing = Smoothing::Given(1e-6);
            let found =
                identify_operator(&curves.trained, &curves.held_out, &curves.options, |_| ()).unwrap();
            let errors = found.held_out.unwrap();
            assert!(errors.rms < 0.03 && errors.rms < 0.3 * errors.line_rms, "{}: {errors:?}", curves.name);
            let leads = found.operator.weights().iter().all(|weight| *weight <= 0.0);
            let lags = found.operator.weights().iter().all(|weight| *weight >= 0.0);
            assert!(if actuator.name == "bouc_wen" { leads } else { lags }, "{}", curves.name);
        }
    }

    #[test]
    fn a_butterfly_needs_weights_of_both_signs() {
        let [_, mut curves] = splits(&BUTTERFLY, true);
        curves.options.levels = Some(8);
        curves.options.smoothing = Smoothing::Given(1e-5);
        let mut error = |signed| {
            curves.options.signed = signed;
            let found = identify_operator(&curves.trained, &curves.held_out, &curves.options, |_| ());
            found.unwrap().held_out.unwrap().rms
        };
        let (signed, bounded) = (error(true), error(false));
        assert!(signed < 0.06 && bounded > 3.0 * signed, "{signed} {bounded}");
    }

    #[test]
    fn what_trains_is_noisy_and_what_is_judged_is_not_and_is_no_part_of_it() {
        let [major, curves] = splits(&DISSIPATIVE[0], false);
        assert_eq!((major.trained.len(), major.held_out.len()), (1, 16));
        assert_eq!((curves.trained.len(), curves.held_out.len()), (9, 8));
        for split in [&major, &curves] {
            let clean = |log: &InputOutput| (DISSIPATIVE[0].output)(&log.input) == log.output;
            assert!(split.held_out.iter().all(clean) && !split.trained.iter().any(clean));
            assert!(
                split.held_out.iter().all(|held| split.trained.iter().all(|log| log.input != held.input))
            );
        }
    }
}
