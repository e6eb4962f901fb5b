//! The gear's chapter: the paper's Fig. 9, repeated steps of the wave generator under a constant load.

use maud::html;

use super::{Chapter, figure, figure_table, plot};
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;
use crate::plant::two_port::Build;
use crate::report::plot::{Page, Panel, Series};
use crate::verify::Measured;
use crate::verify::step_response::StepResponse;

pub(super) fn chapter(gear: &GearFile, progress: &mut dyn FnMut(f64)) -> Result<Chapter, BadInput> {
    let failed = |error: RunError| BadInput::message(format_args!("{}: {error}", gear.gear.name));
    let reference = StepResponse::of(gear, Build::REFERENCE).map_err(failed)?;
    progress(0.3);
    let real_time = StepResponse::of(gear, Build::RealTime).map_err(failed)?;
    let measured = Measured::from(reference.figures());
    let body = html! {
        p {
            "The whole gear as a two-port (Figs. 7 and 8): steps of the wave generator, 1 mrad at the output within one "
            "sampling time of 0.1 ms, under a load of " (reference.load) " N m."
        }
        (figure(&plot(&drawn(gear, &reference, &real_time)), &html! {
            "The paper's Fig. 9, of the reference build and of what runs in real time. a) Wave generator, at the output, and "
            "flexspline; b) what the flexspline is behind by: ringing after each step, and the steady wind-up; c) its velocity."
        }))
        (figure_table(&measured))
    };
    Ok(Chapter { id: "two-port", title: "The gear as a two-port", body, measured })
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
