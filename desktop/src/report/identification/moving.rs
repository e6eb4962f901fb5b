//! The page of a moving joint's log: output angle over the motor's motion.

use std::f64::consts::TAU;

use maud::{Markup, html};

use super::fit::Fit;
use super::parameters::{Finding, Parameter};
use super::spectrum::Axes;
use super::{Outcome, chapter, correlation, friction_map, next, parameters, spectrum, times};
use crate::identify::moving::{
    BEATS, EVERY, Kind, LearntParameter, ORDERS, Parameter as FrictionParameter, Verdict as FrictionVerdict,
};
use crate::identify::replay::ReplayRow;
use crate::identify::{Covariance, LearntGear, MOVING_LOG};
use crate::io::gear_file::{GearFile, Harmonic};
use strainwave::compensator::schedule::CONTROL_PERIOD;

const BASE: &str = "base gear";
const OVER_TIME: Axes = Axes { along: ("frequency", "Hz"), unit: "urad", base: BASE };
const OVER_ANGLE: Axes = Axes { along: ("order", "1/turn"), unit: "urad", base: BASE };
/// Control periods from one drawn row to the next.
const DRAWN: usize = 10;
/// Highest frequency of the spectrum (Hz): some times that of a torsion mode.
const HIGHEST: f64 = 50.0;

/// The page of what was identified from the log of a moving joint.
pub fn moving(outcome: &Outcome, base: &GearFile, found: &LearntGear) -> String {
    let name = outcome.logs.first().map_or("log", String::as_str);
    let mut chapters = Vec::new();
    if found.has_output() {
        chapters.extend([
            chapter("fit", "Fit and prediction", fit(name, found, DRAWN).figure()),
            chapter("spectrum", "Spectrum of what is missed", spectra(&fit(name, found, EVERY), found)),
        ]);
    }
    chapters.extend([
        chapter("friction", "Torque over speed", friction_map::section(base, found)),
        chapter("parameters", "Parameters", table(base, found)),
        chapter("correlation", "Correlation", correlations(found)),
        chapter("next", "What to measure next", next::section(outcome, &advice(base, found))),
    ]);
    outcome.page(&base.gear.name, "Input friction and kinematic error", chapters)
}

/// Fit, friction and parameters alone.
pub(super) fn summary(name: &str, base: &GearFile, found: &LearntGear) -> Markup {
    html! { (fit(name, found, DRAWN).figure()) (friction_map::section(base, found)) (table(base, found)) }
}

/// Every so many rows; offsets are those of the rows that trained.
fn fit<'a>(name: &'a str, found: &LearntGear, every: usize) -> Fit<'a> {
    let column = |rows: &[ReplayRow], figure: fn(&ReplayRow) -> f64| -> Vec<f64> {
        rows.iter().step_by(every).map(figure).collect()
    };
    let at = column(&found.rows, |row| row.time);
    let trained = at.partition_point(|time| *time <= found.learnt);
    let measured = column(&found.rows, |row| row.measured);
    let aligned = |rows: &[ReplayRow]| {
        let predicted = column(rows, |row| row.predicted);
        let differences = predicted.iter().zip(&measured).take(trained).map(|(p, m)| p - m);
        let offset = differences.sum::<f64>() / trained.max(1) as f64;
        predicted.iter().map(|angle| 1e3 * (angle - offset)).collect()
    };
    Fit {
        log: name,
        along: ("time", "s"),
        trained,
        quantity: ("output angle", "mrad"),
        identified: aligned(&found.rows),
        base: aligned(&found.base_rows),
        base_name: BASE,
        error: ("urad", 1e3),
        measured: times(&measured, 1e3),
        at,
    }
}

fn spectra(fit: &Fit, found: &LearntGear) -> Markup {
    let [base, identified] = fit.errors();
    let interval = EVERY as f64 * CONTROL_PERIOD;
    let over_time = spectrum::panel(&OVER_TIME, [&base, &identified], interval, HIGHEST);
    let turn = |row: &ReplayRow| (row.motor - row.rigid) / TAU;
    let turns: Vec<_> = found.rows.iter().step_by(EVERY).map(turn).collect();
    let error = &found.gear.kinematic_error;
    let mut orders: Vec<_> =
        error.flexspline.iter().chain(&error.wave_generator).map(|term| term.order).collect();
    orders.sort_unstable();
    orders.dedup();
    let over_orders = spectrum::over_orders(&OVER_ANGLE, &turns, [&base, &identified], &orders);
    let caption = if over_orders.is_some() {
        "Amplitude of predicted - measured output over all rows: over frequency, and over the orders of the motor's angle relative to the \
         flexspline. Dotted: orders of the kinematic error that were identified. A line between them is an order without a \
         parameter."
    } else {
        "Amplitude of predicted - measured output over all rows. The motor turns less than once: its orders have no spectrum."
    };
    spectrum::section(std::iter::once(over_time).chain(over_orders).collect(), caption)
}

fn table(base: &GearFile, found: &LearntGear) -> Markup {
    parameters::section(
        &rows(base, found),
        BASE,
        &[
            "Intervals are those of the two least squares, with their priors: of friction, with the noise and the correlation of the torque's \
             residual, and of the orders, where 20 urad are alike over a short path and time. They are of the first order around \
             what was found, and tell what this noise leaves where the joint is what the model says.",
            "The wander of the external torque has none: it is the better of two observers.",
        ],
    )
}

fn rows(base: &GearFile, found: &LearntGear) -> Vec<Parameter> {
    let mut rows: Vec<_> = found.friction.parameters.iter().map(friction).collect();
    for (kind, before, now) in [
        (Kind::Flexspline, &base.kinematic_error.flexspline, &found.gear.kinematic_error.flexspline),
        (Kind::Case, &base.kinematic_error.wave_generator, &found.gear.kinematic_error.wave_generator),
        (Kind::Scale, &base.sensors.output_encoder_error, &found.gear.sensors.output_encoder_error),
    ] {
        rows.extend(now.iter().map(|term| order(kind, before, term, found.error_covariance.as_ref())));
    }
    let wander = found.gear.compensation.external_torque_wander.map(|wander| {
        let before = base.compensation.external_torque_wander;
        Parameter::new("compensation.external_torque_wander", "N m/s^0.5", before, wander)
            .found(Finding::Beside)
    });
    rows.into_iter().chain(wander).collect()
}

/// A parameter of the input friction.
fn friction(learnt: &LearntParameter) -> Parameter {
    let LearntParameter { parameter, base, value, deviation, interval, verdict } = learnt;
    let name = format!("friction.input.{}", parameter.key());
    let row = Parameter::new(name, parameter.unit(), Some(*base), *value);
    match verdict {
        FrictionVerdict::Identified | FrictionVerdict::Traded(_) => {
            let row = row.within(Some(*deviation)).between(*interval);
            if matches!(parameter, FrictionParameter::RippleCosine(_) | FrictionParameter::RippleSine(_)) {
                row
            } else {
                row.not_negative()
            }
        }
        FrictionVerdict::AtLimit => row.found(Finding::AtLimit),
        FrictionVerdict::BaseKept | FrictionVerdict::NotExcited | FrictionVerdict::NoLoad => {
            row.found(Finding::Kept)
        }
    }
}

/// Amplitude of an order; its error is that along the phase that was found.
fn order(kind: Kind, before: &[Harmonic], now: &Harmonic, covariance: Option<&Covariance>) -> Parameter {
    let before = before.iter().find(|term| term.order == now.order).map_or(0.0, |term| term.amplitude);
    let [sine, cosine] = kind.coefficients(now.order);
    let along = [(sine.as_str(), now.phase.cos()), (cosine.as_str(), now.phase.sin())];
    let name = format!("{}, order {}: amplitude", kind.key(), now.order);
    Parameter::new(name, "rad", Some(before), now.amplitude)
        .not_negative()
        .within(covariance.and_then(|covariance| covariance.error_of_sum(&along)))
}

fn correlations(found: &LearntGear) -> Markup {
    let friction = "Parameters of the friction, and offset, weight, inertia, start and waves that are fitted beside them.";
    let orders = "Offset of the encoders, sines and cosines of the orders.";
    html! {
        (correlation::section(&found.friction.covariance, friction))
        @if let Some(covariance) = &found.error_covariance { (correlation::section(covariance, orders)) }
    }
}

fn advice(base: &GearFile, found: &LearntGear) -> Vec<String> {
    let mut advice = Vec::new();
    let turns = found.revolutions;
    let learnt = |order: &u32| {
        found.errors && found.gear.kinematic_error.flexspline.iter().any(|term| term.order == *order)
    };
    let missing: Vec<_> = ORDERS.iter().filter(|order| !learnt(order)).map(u32::to_string).collect();
    if !found.has_output() {
        advice.push("Without theta_out_rad nothing shows the kinematic error.".into());
    } else if !missing.is_empty() {
        let orders = missing.join(", ");
        advice.push(format!("The motor's {turns:.3} turns that trained do not show the orders {orders}."));
    }
    let needed = BEATS * f64::from(base.gear.signed_ratio().n().abs());
    if turns < needed {
        advice.push(format!(
            "Orders relative to the case and to the flexspline count as one: over {turns:.3} turns of the motor they are not told \
             apart; that takes {needed} turns."
        ));
    }
    advice.extend(found.friction.beyond());
    advice.extend(correlation::alike(&found.friction.covariance));
    advice.extend(found.error_covariance.iter().flat_map(correlation::alike));
    if found.judgement.is_none() {
        advice.push(next::nothing_held_out());
    }
    advice.push(format!(
        "What shows most of a moving joint is {MOVING_LOG}; strainwave experiment writes such a motion, with the errors that it leaves."
    ));
    advice
}

#[cfg(test)]
mod tests {
    use super::super::tests::check;
    use super::*;
    use crate::identify::moving::{LearntFriction, Residual};
    use crate::identify::replay::Judgement;
    use crate::identify::{Refusal, Verdict};
    use crate::io::figure::Figure;

    /// Motion there and back over ten turns; the output has an order 2 that the learnt gear knows.
    fn learnt(directions: [bool; 2]) -> LearntGear {
        let (mut gear, base) = (GearFile::default_gear(), GearFile::default_gear());
        gear.kinematic_error.flexspline = vec![Harmonic { order: 2, amplitude: 1e-4, phase: 0.3 }];
        gear.kinematic_error.wave_generator.clear();
        let r: f64 = base.gear.signed_ratio().value();
        let row = |gear: &GearFile, k: u32| {
            let time = f64::from(k) * CONTROL_PERIOD;
            let motor = TAU * (5.0 - (2.0 * time - 5.0).abs());
            let order = |gear: &GearFile| {
                gear.kinematic_error.flexspline.iter().map(|term| term.at(motor)).sum::<f64>()
            };
            let mut learnt = base.clone();
            learnt.kinematic_error.flexspline = vec![Harmonic { order: 2, amplitude: 1e-4, phase: 0.3 }];
            ReplayRow {
                time,
                motor,
                motor_torque: 0.1,
                output_torque: None,
                measured: r * motor + order(&learnt) + 0.01,
                predicted: r * motor + order(gear),
                rigid: r * motor,
            }
        };
        let rows = |gear: &GearFile| (0..50_000).map(|k| row(gear, k)).collect::<Vec<_>>();
        let (all, base_rows) = (rows(&gear), rows(&base));
        LearntGear {
            learnt: 2.5,
            revolutions: 5.0,
            errors: true,
            friction: friction_at_limit(directions),
            training_rms: Some(1e-6),
            judgement: Some(Judgement::of(&all, 2.5)),
            base_judgement: Some(Judgement::of(&base_rows, 2.5)),
            error_covariance: Residual::solve(&base, &base_rows).unwrap().covariance,
            rows: all,
            base_rows,
            gear,
        }
    }

    /// The level ends at 0.
    fn friction_at_limit(directions: [bool; 2]) -> LearntFriction {
        let learnt = |parameter, verdict| LearntParameter {
            parameter,
            base: 0.1,
            value: 0.12,
            deviation: 0.01,
            interval: [0.1, 0.14],
            verdict,
        };
        LearntFriction {
            level: 0.0,
            viscous: 1.2,
            directions,
            parameters: vec![
                learnt(FrictionParameter::Coulomb, FrictionVerdict::AtLimit),
                learnt(FrictionParameter::Viscous, FrictionVerdict::Identified),
            ],
            waves: Vec::new(),
            residual: 0.01,
            covariance: Covariance::of_one("viscous_nm_s_per_rad", 0.1),
        }
    }

    fn drawn(found: &LearntGear) -> String {
        let figures = [Figure::reported("identify.training.turns", 5.0, "1")];
        let logs = ["moving.csv".to_owned()];
        let base = GearFile::default_gear();
        let against = Refusal::of(&found.gear, &found.friction.limits(), None).map(|why| why.to_string());
        let verdict = Verdict::of(against, false, MOVING_LOG);
        let outcome = Outcome {
            logs: &logs,
            output: "new.toml",
            verdict: &verdict,
            described: None,
            not_identified: &found.not_identified(),
            figures: &figures,
        };
        let page = moving(&outcome, &base, found);
        check(&page, &outcome);
        page
    }

    #[test]
    fn the_page_names_orders_limits_and_directions() {
        let page = drawn(&learnt([true, false]));
        assert!(
            page.contains("<tr class=\"missed\"><td>friction.input.coulomb_nm</td>"),
            "the level ends at 0"
        );
        assert!(page.contains("<td>kinematic_error.flexspline, order 2: amplitude</td>"));
        assert!(page.contains("\norders 2\n") && page.contains("order [1/turn]"));
        assert!(
            page.contains("is at the limit of its search")
                && page.contains("<li>friction backwards: not identified,")
        );
        assert!(
            page.contains("show the orders 1, 4, 6, 8, 10.")
                && page.contains("The shaded part, up to 2.500 s, trained;")
        );
        assert!(page.contains("kinematic_error.flexspline order 2 sine"), "the heat map");
        assert!(page.contains("friction, base gear") && page.contains("friction, identified"));
    }

    /// The offset of the rows that trained is removed, of the base gear an order is left.
    #[test]
    fn the_errors_are_those_that_are_judged() {
        let found = learnt([true; 2]);
        let fit = fit("a.csv", &found, DRAWN);
        let [base, identified] = fit.errors();
        assert!(identified.iter().all(|error| error.abs() < 1e-6));
        let squares = base[fit.trained..].iter().map(|error| error * error).sum::<f64>();
        let rms = (squares / (base.len() - fit.trained) as f64).sqrt();
        let judged = found.base_judgement.unwrap().rms * 1e6;
        assert!((rms / judged - 1.0).abs() < 1e-2, "{rms} {judged}");
    }
}
