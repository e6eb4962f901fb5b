//! Eq. (1): two links side by side, drawn (Fig. 3), and their force over the displacement (Fig. 4).

use maud::{Markup, html};
use strainwave::Error;
use strainwave::flexspline::calibration::unit_stiffness;
use strainwave::flexspline::{FlexsplineParams, TwoLinks, TwoLinksParams};

use super::{M, N};
use crate::report::paper::{Item, beside};
use crate::report::plot::{Page, Panel, Series};
use crate::report::{figure, plot};

/// Points of the curve.
const POINTS: i32 = 400;
/// Largest displacement, in a.
const SPAN: f64 = 3.0;

/// Two shear links of the mesh, side by side over one spacing of the slices.
fn shear_pair(params: &FlexsplineParams<f64>) -> TwoLinksParams<f64> {
    let cup = &params.cup;
    let angle = std::f64::consts::TAU / N as f64;
    let (reach, sagitta) = (cup.radius * angle.sin(), cup.radius * (1.0 - angle.cos()));
    let height = sagitta.hypot(cup.length / (M as f64 - 1.0));
    let stiffness = cup.stiffness() / unit_stiffness::<f64, M>(cup, N, &params.bend);
    TwoLinksParams::relaxed(reach, height, stiffness)
}

pub(super) fn section(params: &FlexsplineParams<f64>) -> Result<Markup, Error> {
    let pair = shear_pair(params);
    let links = pair.build()?;
    Ok(html! {
        h3 { "Two links: eq. (1)" }
        p {
            "Two links reach over the height b to a node, one from a on either side. The links are linear, the force "
            "along the base is not. Here the two shear links of the " (N) "x" (M) " mesh: a = "
            (format!("{:.2}", pair.reach * 1e3)) " mm, b = " (format!("{:.2}", pair.height * 1e3)) " mm, k = "
            (format!("{:.2}", pair.stiffness * 1e-6)) " MN/m, without tension at rest. The first link is shortest, b, at "
            "dx = a."
        }
        (beside(
            Item::Fig3,
            &figure(&drawing(), &html! { "The links at rest (dashed) and with the node displaced by dx. L1 gets shorter, L2 longer." }),
            &html! {
                "a = " (format!("{:.3}", pair.reach * 1e3)) " mm, b = " (format!("{:.3}", pair.height * 1e3)) " mm, L0 = "
                (format!("{:.3}", pair.rest_length * 1e3)) " mm: eq. (1) as printed."
            },
            &html! { "Nothing in the geometry. The paper leaves L0 open; here it is the length at rest, so that the links are free of tension." },
        ))
        (beside(
            Item::Fig4,
            &figure(&plot(&Page::new("").with(curve(&pair, &links))), &html! {
                "The force that holds the node, and what each link adds to it. Dashed: the slope at rest, "
                "2 k (1 - L0 b²/L³) = " (format!("{:.0}", links.stiffness() * 1e-3)) " N/mm."
            }),
            &html! {
                "Odd and nonlinear: at dx = 2a the force is " (format!("{:.2}", links.force(2.0 * pair.reach) / (2.0 * pair.reach * links.stiffness())))
                " times that of the slope at rest."
            },
            &html! {
                "L1 is shortest at dx = a and as long as at rest only at 2a again. Between a and 2a, where the paper calls it stretched, it "
                "gets longer but is still under pressure: at 1.5a it is " (format!("{:.3}", 1e3 * shortened(&pair, &links))) " mm shorter than at rest."
            },
        ))
    })
}

/// What L1 is shorter by than at rest, at dx = 1.5 a (m).
fn shortened(pair: &TwoLinksParams<f64>, links: &TwoLinks<f64>) -> f64 {
    pair.rest_length - links.lengths(1.5 * pair.reach)[0]
}

/// Force over displacement.
fn curve(pair: &TwoLinksParams<f64>, links: &TwoLinks<f64>) -> Panel {
    let displacements = (-POINTS..=POINTS).map(|k| SPAN * pair.reach * f64::from(k) / f64::from(POINTS));
    let displacements: Vec<f64> = displacements.collect();
    let millimetres: Vec<f64> = displacements.iter().map(|dx| dx * 1e3).collect();
    let kilonewtons = |force: &dyn Fn(f64) -> f64| -> Vec<f64> {
        displacements.iter().map(|dx| force(*dx) * 1e-3).collect()
    };
    Panel::new("displacement dx", "mm", "force along the base", "kN")
        .with(Series::line("both links, eq. (1)", &millimetres, &kilonewtons(&|dx| links.force(dx))))
        .with(Series::line("link L1", &millimetres, &kilonewtons(&|dx| links.forces(dx)[0])))
        .with(Series::line("link L2", &millimetres, &kilonewtons(&|dx| links.forces(dx)[1])))
        .with(Series::dashed("slope at rest", &millimetres, &kilonewtons(&|dx| links.stiffness() * dx)))
}

/// Fig. 3, not to scale.
fn drawing() -> Markup {
    html! {
        svg width="420" height="190" viewBox="0 0 420 190" role="img" aria-label="Two links and a node" {
            path.guide d="M60 150 L180 30 L300 150 M180 30 V150" {}
            path.guide d="M30 150 H390" {}
            path.link.stretch d="M60 150 L235 30" {}
            path.link.shear d="M300 150 L235 30" {}
            circle.node cx="180" cy="30" r="3" opacity="0.4" {}
            circle.node cx="235" cy="30" r="5" {}
            circle.node cx="60" cy="150" r="4" {}
            circle.node cx="300" cy="150" r="4" {}
            text x="207" y="22" text-anchor="middle" font-size="13" { "dx" }
            text x="120" y="90" text-anchor="end" font-size="13" { "L2" }
            text x="283" y="95" font-size="13" { "L1" }
            text x="172" y="100" text-anchor="end" font-size="13" { "b" }
            text x="120" y="170" text-anchor="middle" font-size="13" { "a" }
            text x="240" y="170" text-anchor="middle" font-size="13" { "a" }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::gear_params;
    use crate::io::gear_file::GearFile;

    /// The mesh's stiffness in torsion is mostly that of its shear pairs: the picture's numbers are the mesh's.
    #[test]
    fn the_pair_is_that_of_the_mesh() {
        let params = gear_params::<f64>(&GearFile::default_gear()).flexspline;
        let pair = shear_pair(&params);
        // One ring of pairs between each two slices, in series along the axis.
        let ring = N as f64 * params.cup.radius.powi(2) * pair.build().unwrap().stiffness();
        let shear_alone = ring / (M as f64 - 1.0);
        let whole = params.cup.stiffness();
        assert!(shear_alone < whole && shear_alone > 0.2 * whole, "{shear_alone} of {whole} N m/rad");
    }
}
