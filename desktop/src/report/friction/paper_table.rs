//! Table 1: the paper's formulas as printed, computed here, against the library's models.
//!
//! Each formula is written out from the paper, with the numbers of the gear's input side. What is compared is the force over
//! the stated range, as a fraction of Fs; where the printed formula cannot be meant, the difference says so.

use maud::{Markup, html};
use strainwave::friction::ModelName;

use super::level::steady;
use super::models::{Models, Numbers};
use crate::io::figure::{Figure, number};
use crate::report::paper::{Item, beside};
use crate::report::table;

/// Speeds of the comparison up to so many vs, either way.
const FASTEST: f64 = 4.0;
const SPEEDS: i32 = 40;
/// Applied torques up to so many Fs, either way.
const MOST: f64 = 2.0;

/// A row.
struct Row {
    model: ModelName,
    formula: &'static str,
    /// Over what it is compared.
    over: &'static str,
    /// Largest difference, as a fraction of Fs; NaN of a model that is not drawn.
    difference: f64,
    words: &'static str,
}

pub(super) fn section(numbers: &Numbers, models: &Models) -> (Markup, Vec<Figure>) {
    let rows = rows(numbers, models);
    let told = rows
        .iter()
        .filter(|row| row.difference.is_finite())
        .map(|row| Figure::reported(format!("report.table_1.{}", row.model.word()), row.difference, "1"));
    let told = told.collect();
    let cells: Vec<_> = rows
        .iter()
        .map(|row| {
            let difference = percent(row.difference);
            [row.model.word().into(), row.formula.into(), row.over.into(), difference, row.words.into()]
        })
        .collect();
    let drawn = html! {
        h3 { "The paper's table" }
        div.words { (table(["model", "formula as printed", "compared over", "differs by, % of Fs", "what differs"], &cells)) }
    };
    let body = beside(
        Item::Table1,
        &drawn,
        &html! { "All six, and beside them Dahl, bristle, reset integrator, Bliman and Sorine's, lubricated contact and LuGre, which the paper names." },
        &html! { "Row by row in the table above: each formula is computed as printed and compared with the library's model of that name." },
    );
    (body, told)
}

/// In % for people; rounding errors are none.
fn percent(fraction: f64) -> String {
    match fraction {
        nan if nan.is_nan() => "-".into(),
        small if small < 1e-9 => "0".into(),
        other => number(100.0 * other),
    }
}

fn rows(numbers: &Numbers, models: &Models) -> Vec<Row> {
    let (fc, fs, vs) = (numbers.coulomb, numbers.static_level, numbers.stribeck_velocity);
    let side = &numbers.side;
    let (fv, delta) = (side.viscous.unwrap_or(0.0), f64::from(side.stribeck_exponent.unwrap_or(2)));
    let band = side.dead_band.unwrap_or(0.0);
    let falling = move |v: f64| (fs - fc) * (-(v.abs() / vs).powf(delta)).exp();
    let curve = move |v: f64| (fc + falling(v)) * v.signum() + fv * v;
    let moving = |model, printed: &dyn Fn(f64) -> f64| over_speed(numbers, models, model, printed);
    let row = |model, formula, over, difference, words| Row { model, formula, over, difference, words };
    vec![
        row(
            ModelName::Coulomb,
            "F_C sign(v)",
            "speeds to 4 vs",
            moving(ModelName::Coulomb, &|v| fc * v.signum()),
            "Nothing.",
        ),
        row(
            ModelName::Viscous,
            "F_V v",
            "speeds to 4 vs",
            moving(ModelName::Viscous, &|v| fv * v),
            "Nothing.",
        ),
        row(
            ModelName::Static,
            "F_e below F_s, else F_s sign(F_e), at v = 0",
            "applied to 2 Fs at v = 0",
            over_applied(numbers, models, ModelName::Static, &|applied| applied.clamp(-fs, fs)),
            "Nothing at standstill. A body that moves has no row in the paper; here it has Coulomb's.",
        ),
        row(
            ModelName::Stribeck,
            "(F_S − F_C) exp(−|v/v_s|^δ)",
            "speeds to 4 vs",
            moving(ModelName::Stribeck, &|v| falling(v) * v.signum()),
            "The paper has the falling part alone; the model adds F_C and F_V v, and that is the difference.",
        ),
        row(
            ModelName::Karnopp,
            "F(v) for v ≥ DV, F(F_e) for v < DV",
            "speeds to 4 vs, nothing applied",
            moving(ModelName::Karnopp, &|v| if v >= band { curve(v) } else { 0.0 }),
            "Its |v| lost the bars: as printed a body that moves backwards counts as standing. Forwards they agree.",
        ),
        row(
            ModelName::Armstrong,
            "F_S = F_∞ + (F_∞ − F_∞ t_d/(t_d + γ))",
            "speeds to 4 vs, after a long rest",
            moving(ModelName::Armstrong, &|v| {
                let ratio = v / vs;
                (fc + (fs - fc) / (1.0 + ratio * ratio)) * v.signum() + fv * v
            }),
            "Nothing while it slides after a long rest. As printed static friction falls with the dwell t_d, from 2 F_∞ to F_∞; here it \
             rises from what the last slip left to F_∞, as Armstrong's does.",
        ),
    ]
}

fn over_speed(numbers: &Numbers, models: &Models, name: ModelName, printed: &dyn Fn(f64) -> f64) -> f64 {
    let Some(model) = models.drawn.iter().find(|model| model.name == name.word()) else { return f64::NAN };
    let speeds = (-SPEEDS..=SPEEDS).filter(|k| *k != 0);
    let speeds = speeds.map(|k| FASTEST * numbers.stribeck_velocity * f64::from(k) / f64::from(SPEEDS));
    let differences = speeds.map(|speed| (steady(numbers, model, speed) - printed(speed)).abs());
    differences.fold(0.0, f64::max) / numbers.static_level
}

fn over_applied(numbers: &Numbers, models: &Models, name: ModelName, printed: &dyn Fn(f64) -> f64) -> f64 {
    let Some(model) = models.drawn.iter().find(|model| model.name == name.word()) else { return f64::NAN };
    let applied = (-SPEEDS..=SPEEDS).map(|k| MOST * numbers.static_level * f64::from(k) / f64::from(SPEEDS));
    let differences = applied.map(|applied| (model.rest().step(0.0, 1e-4, applied) - printed(applied)).abs());
    differences.fold(0.0, f64::max) / numbers.static_level
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::gear_file::GearFile;

    /// Where the words say that nothing differs the numbers say so, and where a formula is misprinted they show it.
    #[test]
    fn the_differences_are_those_of_the_words() {
        let numbers = Numbers::of(&GearFile::default_gear().friction.input);
        let rows = rows(&numbers, &Models::build(&numbers));
        let of = |model| rows.iter().find(|row| row.model == model).unwrap().difference;
        for model in [ModelName::Coulomb, ModelName::Viscous, ModelName::Static, ModelName::Armstrong] {
            assert!(of(model) < 1e-3, "{model:?}: {}", of(model));
        }
        // Coulomb's level, and a whole sliding curve.
        assert!(of(ModelName::Stribeck) >= 0.99 * numbers.coulomb / numbers.static_level);
        assert!(of(ModelName::Karnopp) >= 0.99 * numbers.coulomb / numbers.static_level);
        assert!(rows.iter().all(|row| row.difference < 10.0));
    }
}
