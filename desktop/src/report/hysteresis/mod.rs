//! The hysteresis' chapter: the gear's loop, the relay and the Preisach plane with the gear's weights, figures.

mod loops;
mod plane;

use maud::{Markup, html};
use strainwave::Error;

use super::{Chapter, figure_table};
use crate::design::joint::gear_params;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::verify::{Measured, Part};

pub(super) fn chapter(gear: &GearFile, progress: &mut dyn FnMut(f64)) -> Result<Chapter, BadInput> {
    progress(0.0);
    let measured = Part::Hysteresis.measure()?;
    let drawn = sections(gear, &measured)
        .map_err(|error| BadInput::message(format_args!("{}: {error}", gear.gear.name)))?;
    let body = html! {
        p {
            "Torque over torsion, rate independent: the catalogue's line is in the middle of the loop, a Preisach "
            "operator (eq. (9)) makes its branches. "
            @match gear.hysteresis.weights {
                Some(_) => { "Its weights were identified from measured logs." }
                None => { "Its weights are the standard shape, even over the plane, of the catalogue's hysteresis loss." }
            }
        }
        (drawn)
        h3 { "Figures with their bounds" }
        p { "Measured now: part of " code { "strainwave verify hysteresis" } "." }
        (figure_table(&measured))
    };
    Ok(Chapter { id: "hysteresis", title: "Hysteresis", body, measured })
}

fn sections(gear: &GearFile, measured: &Measured) -> Result<Markup, Error> {
    let params = gear_params::<f64>(gear);
    Ok(html! { (loops::section(&params)?) (plane::section(&params, measured)?) })
}
