//! The gear's chapter: its ports and blocks, and the paper's Fig. 9, repeated steps of the wave generator under a constant load.

mod blocks;

use maud::{Markup, html};

use super::paper::{Item, beside};
use super::scenarios::Trials;
use super::{Chapter, figure, figure_table, plot};
use crate::io::figure::{Figure, number};
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;
use crate::plant::two_port::Build;
use crate::report::plot::{Page, Panel, Series};
use crate::verify::Measured;
use crate::verify::step_response::StepResponse;

pub(super) fn chapter(
    gear: &GearFile,
    trials: &Trials,
    progress: &mut dyn FnMut(f64),
) -> Result<Chapter, BadInput> {
    let failed = |error: RunError| BadInput::message(format_args!("{}: {error}", gear.gear.name));
    let reference = StepResponse::of(gear, Build::REFERENCE).map_err(failed)?;
    progress(0.3);
    let real_time = StepResponse::of(gear, Build::RealTime).map_err(failed)?;
    let mut measured = Measured::from(reference.figures());
    measured.figures.extend(told(&reference));
    let body = html! {
        (steps(gear, &reference, &real_time)) (ports(trials)) (inside(gear, &reference))
        h3 { "Figures with their bounds" }
        (figure_table(&measured))
    };
    Ok(Chapter { id: "two-port", title: "The gear as a two-port", body, measured })
}

fn ports(trials: &Trials) -> Markup {
    let imbalance = trials.imbalance();
    beside(
        Item::Fig7,
        &html! { h3 { "Two ports" } (figure(&blocks::ports(), &html! { "What goes in and what comes out at either port." })) },
        &html! {
            "The same two ports: a step takes both motions and answers with both torques, so that the motor's and the load's inertia "
            "may be outside. " code { "strainwave sim" } " takes position or velocity of the wave generator."
        },
        &html! {
            "Signs and units are stated, and power is accounted for: what enters both ports is stored or lost. "
            @match imbalance {
                Some(imbalance) => { "Largest part of the moved energy that is missing in S1 to S6 on this page: " (number(imbalance)) "." }
                None => { "No scenario was run with this gear, see below." }
            }
        },
    )
}

/// Torques at the end of the last step, at rest: hysteresis and friction of both sides, over the load.
fn shares(gear: &GearFile, response: &StepResponse) -> [f64; 3] {
    let r: f64 = gear.gear.signed_ratio().value();
    let line = crate::design::joint::gear_params::<f64>(gear).flexspline.line.build();
    response.rows.last().zip(line.ok()).map_or([f64::NAN; 3], |(row, line)| {
        let hysteresis = row.transmitted_torque - line.torque(row.torsion);
        let output = row.transmitted_torque + response.load;
        let input = (row.input_torque - r * row.transmitted_torque) / r;
        [hysteresis, output, input].map(|torque| torque / response.load.abs())
    })
}

fn inside(gear: &GearFile, response: &StepResponse) -> Markup {
    let [hysteresis, output, input] = shares(gear, response).map(|share| number(100.0 * share));
    beside(
        Item::Fig8,
        &html! { h3 { "Inside" } (figure(&blocks::inside(), &html! { "The blocks, and what passes between them." })) },
        &html! {
            "The same four blocks. At the end of Fig. 9's last step, in % of the load: hysteresis " (hysteresis) ", friction of the output "
            (output) ", of the input, at the output, " (input) "."
        },
        &html! {
            "The paper puts the blocks into a sequence; here flexspline and hysteresis stand side by side and their torques add. The kinematic error is "
            "one block more. Friction is the same law on both sides, as in the paper, with numbers of its own on each, a level that falls with speed, and a "
            "part that grows with the torque."
        },
    )
}

fn steps(gear: &GearFile, reference: &StepResponse, real_time: &StepResponse) -> Markup {
    let pictures = html! {
        p {
            "Repeated steps of the wave generator, 1 mrad at the output within one sampling time of 0.1 ms, under a load of "
            (reference.load) " N m."
        }
        (figure(&plot(&drawn(gear, reference, real_time)), &html! {
            "The reference build and what runs in real time. a) Wave generator, at the output, and "
            "flexspline; b) what the flexspline is behind by: ringing after each step, and the steady wind-up; c) its velocity."
        }))
    };
    let [beginning, end] = reference.oscillation();
    beside(
        Item::Fig9,
        &pictures,
        &html! {
            "Load " (reference.load) " N m, rows every 0.1 ms. Steady error " (number(reference.wind_up() * 1e3)) " mrad, where the "
            "catalogue's line has " (number(reference.line_torsion() * 1e3)) " mrad (" (number(100.0 * reference.wind_up_error())) " %). The oscillation "
            "has " (number(reference.ringing())) " Hz, where the linearised gear has " (number(reference.eigenfrequency())) " Hz ("
            (number(100.0 * reference.ringing_error())) " %); about the end of a step it swings by up to " (number(beginning * 1e3)) " mrad in the first quarter of "
            "the step and " (number(end * 1e3)) " mrad in the last."
        },
        &html! {
            "The paper's text gives load and sampling time, which are the same here" @if reference.load != -50.0 { " but for the load, which is "
            "that of a smaller gear" } ", and no height of the steps: 1 mrad is ours. That there is a damped oscillation and a steady error agrees; their sizes cannot be compared."
        },
    )
}

/// Sizes of the steady error and of the oscillation.
fn told(response: &StepResponse) -> [Figure; 3] {
    let [_, end] = response.oscillation();
    [
        Figure::reported("report.fig_9.wind_up", response.wind_up(), "rad"),
        Figure::reported("report.fig_9.ringing", response.ringing(), "Hz"),
        Figure::reported("report.fig_9.oscillation_at_end", end, "rad"),
    ]
}

fn drawn(gear: &GearFile, reference: &StepResponse, real_time: &StepResponse) -> Page {
    let r: f64 = gear.gear.signed_ratio().value();
    let time: Vec<_> = reference.rows.iter().map(|row| row.time).collect();
    let input: Vec<_> = reference.wave_generator.iter().map(|angle| 1e3 * r * angle).collect();
    let of = |run: &StepResponse, figure: fn(&crate::io::log::OpenLoopRow) -> f64| -> Vec<f64> {
        run.rows.iter().map(figure).collect()
    };
    let both = |panel: Panel, figure: fn(&crate::io::log::OpenLoopRow) -> f64| {
        panel.with(Series::line("reference", &time, &of(reference, figure))).with(Series::dashed(
            "real time",
            &time,
            &of(real_time, figure),
        ))
    };
    let angle = Panel::new("time", "s", "angle", "mrad").titled("a) wave generator and flexspline");
    let windup = Panel::new("time", "s", "torsion", "mrad").titled("b) wave generator less flexspline");
    let velocity = Panel::new("time", "s", "velocity", "rad/s").titled("c) flexspline");
    Page::new("")
        .with(both(angle.with(Series::line("wave generator", &time, &input)), |row| {
            1e3 * row.output_position
        }))
        .with(both(windup, |row| 1e3 * row.torsion))
        .with(both(velocity, |row| row.output_velocity))
}
