//! Fig. 5: torque over torsion around the major loop, with minor loops inside.

use maud::{Markup, html};
use strainwave::Error;
use strainwave::compensator::HYSTERESIS_LEVELS;
use strainwave::friction::FrictionParams;
use strainwave::gear::GearParams;

use crate::identify::law::{Law, torques};
use crate::report::paper::{Item, beside};
use crate::report::plot::{Page, Panel, Series};
use crate::report::{figure, plot};

/// Corners in rated torques: the virgin curve, the major loop, and loops within.
const CORNERS: [f64; 9] = [0.0, 1.0, -1.0, 1.0, -0.5, 0.5, -0.25, 0.25, 0.0];

pub(super) fn section<P: FrictionParams<f64>>(params: &GearParams<f64, P>) -> Result<Markup, Error> {
    let law = Law::<HYSTERESIS_LEVELS>::of(params)?;
    let torques: Vec<_> = torques(&CORNERS).map(|fraction| fraction * params.rated_torque).collect();
    let on = law.torsions(&torques);
    let line = params.flexspline.line.build()?;
    // The loop itself is narrow against the torsion: below it stands alone.
    let torsions: Vec<_> = on.iter().map(|on| on.torsion * 1e3).collect();
    let hysteresis: Vec<_> = on.iter().map(|on| on.hysteresis).collect();
    let catalogue: Vec<_> = torsions.iter().map(|torsion| line.torque(torsion * 1e-3)).collect();
    let page = Page::new("")
        .with(
            Panel::new("torsion", "mrad", "torque", "N m")
                .with(Series::line("gear", &torsions, &torques))
                .with(Series::dashed("catalogue's line", &torsions, &catalogue)),
        )
        .with(Panel::new("torsion", "mrad", "hysteresis torque", "N m").with(Series::line(
            "",
            &torsions,
            &hysteresis,
        )));
    let width = law.width(params.rated_torque).to_degrees() * 60.0;
    Ok(html! {
        h3 { "Hysteresis curve" }
        p { "The loop is " (format!("{width:.2}")) " arcmin wide at zero torque after rated torque either way." }
        (beside(
            Item::Fig5,
            &figure(&plot(&page), &html! {
                "From rest to rated torque, around the major loop, and back to zero through ever smaller ones. Below, "
                "what the hysteresis adds to the line: the loops lie in each other and remember where they turned."
            }),
            &html! {
                (format!("{width:.2}")) " arcmin wide at zero torque, where the gear file asks for "
                (format!("{:.2}", params.hysteresis_width.to_degrees() * 60.0)) " arcmin; "
                (format!("{:.2}", 1e3 * law.torsions(&[params.rated_torque]).first().map_or(f64::NAN, |on| on.torsion))) " mrad at rated torque."
            },
            &html! {
                "The paper shows one curve of a catalogue and gives no numbers. Ours is a law: minor loops and the virgin curve come with "
                "it, and the hardening of the curve is the stiffness line's, not the hysteresis'."
            },
        ))
    })
}
