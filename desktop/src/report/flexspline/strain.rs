//! Strain at a gauge over one revolution of the wave generator, of the settled mesh and of the condensed one.

use maud::{Markup, html};
use strainwave::flexspline::reduced::{Direction, Node};
use strainwave::flexspline::{Reduced, StrainGauge};
use strainwave::{Angle, Error};

use super::{M, N};
use crate::design::joint::gear_params;
use crate::io::gear_file::GearFile;
use crate::plant::settled::Settled;
use crate::report::plot::{Page, Panel, Series};
use crate::report::{figure, plot};

/// The gauge: a shear link at the rim.
const NODE: Node = (0, 0);
const DIRECTION: Direction = (1, 1);
/// Angles in a revolution of the settled mesh and of the condensed one.
const ANGLES: i32 = 36;
const FINE_ANGLES: i32 = 360;
/// Steps in which the mesh settles from one angle to the next.
const SETTLING: usize = 6_000;

pub(super) fn section(gear: &GearFile, mut progress: impl FnMut(f64)) -> Result<Markup, Error> {
    let (double, single) = (gear_params::<f64>(gear), gear_params::<f32>(gear));
    let reduced = Reduced::<f32, N, M>::build(&single.flexspline, single.rated_torque)?;
    let gauge = StrainGauge::build(&reduced, NODE, DIRECTION)?;
    let mut mesh = Settled::<N, M>::build(&double.flexspline, SETTLING)?;
    let rated_torsion = double.flexspline.line.build()?.torsion(double.rated_torque);
    let mut panel = Panel::new("wave generator's angle", "degree", "strain", "um/m");
    for (index, (name, torsion)) in [("no", 0.0), ("rated", rated_torsion)].into_iter().enumerate() {
        let (mut strains, mut torque) = (Vec::new(), 0.0);
        for k in 0..=ANGLES {
            progress(0.5 * (index as f64 + f64::from(k) / f64::from(ANGLES)));
            torque = mesh.torque(torsion, angle(k, ANGLES).to_radians());
            strains.push(mesh.strain(NODE, DIRECTION)? * 1e6);
        }
        let fine = |k| gauge.strain(torque as f32, Angle::from_turn_fraction(k, FINE_ANGLES));
        let fine: Vec<_> = (0..=FINE_ANGLES).map(|k| f64::from(fine(k)) * 1e6).collect();
        panel = panel
            .with(Series::points(format!("mesh, {name} torque"), &angles(ANGLES), &strains))
            .with(Series::line(format!("condensed, {name} torque"), &angles(FINE_ANGLES), &fine));
    }
    let (i, j) = NODE;
    Ok(html! {
        h3 { "Strain at a gauge" }
        p {
            "A gauge along the shear link that leaves node (" (i) ", " (j) ") at the rim, over one revolution of the wave "
            "generator. The ellipse comes by twice a revolution; the torque shifts the curve by "
            (format!("{:.3}", f64::from(gauge.per_torque) * 1e6)) " µm/m for each N m."
        }
        (figure(&plot(&Page::new("").with(panel)), &html! {
            "Strain over the wave generator's angle at no and at rated torque: points of the settled mesh (f64), curves "
            "of the condensed one (f32)."
        }))
    })
}

/// The k-th of `count` angles in a revolution (degrees).
fn angle(k: i32, count: i32) -> f64 {
    360.0 * f64::from(k) / f64::from(count)
}

fn angles(count: i32) -> Vec<f64> {
    (0..=count).map(|k| angle(k, count)).collect()
}
