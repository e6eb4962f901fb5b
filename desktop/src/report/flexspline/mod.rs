//! The flexspline's chapter: eq. (1), the mesh, torque, strain, natural frequencies, figures.

mod cup;
mod links;
mod sizes;
mod strain;
mod torsion;

use maud::{Markup, html};
use strainwave::Error;

use super::{Chapter, figure_table};
use crate::design::joint::gear_params;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::verify::Part;

/// Nodes of the reference mesh.
const N: usize = 36;
const M: usize = 4;

pub(super) fn chapter(gear: &GearFile, progress: &mut dyn FnMut(f64)) -> Result<Chapter, BadInput> {
    let drawn = sections(gear, progress)
        .map_err(|error| BadInput::message(format_args!("{}: {error}", gear.gear.name)))?;
    let measured = Part::Flexspline.measure()?;
    let body = html! {
        (introduction(gear)) (drawn)
        h3 { "Figures with their bounds" }
        p { "Measured now, on the default gear: part of " code { "strainwave verify flexspline" } "." }
        (figure_table(&measured))
    };
    Ok(Chapter { id: "flexspline", title: "Flexspline", body, measured })
}

/// Sections drawn from the gear.
fn sections(gear: &GearFile, progress: &mut dyn FnMut(f64)) -> Result<Markup, Error> {
    let params = gear_params::<f64>(gear);
    let cup = cup::section(&params.flexspline)?;
    let links = links::section(&params.flexspline)?;
    let torsion = torsion::section(gear, |fraction| progress(0.12 * fraction))?;
    let strain = strain::section(gear, |fraction| progress(0.12 + 0.12 * fraction))?;
    let sizes = sizes::section(&params.flexspline);
    progress(0.24);
    Ok(html! { (cup) (links) (torsion) (strain) (sizes) })
}

fn introduction(gear: &GearFile) -> Markup {
    let cup = &gear.flexspline;
    let millimetres = |metres: f64| (metres * 1e6).round() / 1e3;
    html! {
        p {
            "A cup of radius " (millimetres(cup.radius)) " mm, length " (millimetres(cup.length)) " mm and wall "
            (millimetres(cup.wall)) " mm, pressed by the wave generator into an ellipse of "
            (millimetres(cup.ellipse)) " mm. It is a shell of point masses and links (eq. (6)), driven at the "
            "rim through the tooth contact, in which the catalogue's hardening sits, and held by the output flange."
        }
    }
}
