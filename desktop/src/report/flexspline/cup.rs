//! The mesh as it stands assembled (Fig. 1), and the links of one node (Fig. 2).

use std::fmt::Write;

use maud::{Markup, html};
use strainwave::Error;
use strainwave::flexspline::cup::{DIRECTIONS, is_bend};
use strainwave::flexspline::shell::ShellState;
use strainwave::flexspline::{Flexspline, FlexsplineParams, Mesh};

use super::{M, N};
use crate::io::figure::number;
use crate::plant::STEP_SHARE;
use crate::report::figure;
use crate::report::paper::{Item, beside};
use crate::report::picture::NODES_AROUND as N_DRAWN;

/// Magnification of the drawn displacement.
const EXAGGERATION: f64 = 20.0;
/// Height of the eye over the plane of the rim, and how far the cup is turned (rad).
const ELEVATION: f64 = 0.5;
const VIEW: f64 = 0.35;
/// Width of the picture, in radii of the cup and in pixels.
const RADII: f64 = 3.0;
const WIDTH: f64 = 560.0;

/// The three kinds of links, as the style sheet names them.
const KINDS: [&str; 3] = ["bend", "shear", "stretch"];

fn kind((around, along): (i32, usize)) -> &'static str {
    match (is_bend((around, along)), around != 0 && along != 0) {
        (true, _) => KINDS[0],
        (false, true) => KINDS[1],
        (false, false) => KINDS[2],
    }
}

pub(super) fn section(params: &FlexsplineParams<f64>) -> Result<Markup, Error> {
    let mesh = Mesh::<f64, N, M>::build(params, STEP_SHARE * Mesh::<f64, N, M>::stable_step(params))?;
    let (round, assembled) = (mesh.shell().round(), mesh.rest());
    let radius = params.cup.radius;
    let points = |i, j| {
        let (at, to) = (round.position(i, j), assembled.shell().position(i, j));
        project(std::array::from_fn(|axis| (at[axis] + EXAGGERATION * (to[axis] - at[axis])) / radius))
    };
    Ok(html! {
        h3 { "The mesh" }
        p {
            (N) " nodes around and " (M) " along the axis, joined by " (mesh_links(&round)) " links of one stiffness: "
            span.key.stretch { "stretch" } " to the nearest, " span.key.shear { "shear" } " to the diagonal and "
            span.key.bend { "bend" } " to the next neighbours but one."
        }
        (beside(
            Item::Fig1,
            &figure(&cup(&points, params.cup.length / radius), &html! {
                "The assembled mesh, displacements times " (EXAGGERATION) ". The wave generator presses the rim "
                "(above) into its ellipse; the flange (below) is round and rigid. Links behind the axis are pale."
            }),
            &html! { (N) " nodes around, " (M) " along the axis. " a href="#picture" { "In three dimensions" } " with " (N_DRAWN) " nodes." },
            &html! {
                "The size is the paper's. Its rim is round: here the wave generator presses it outwards by " (number(100.0 * params.cup.ellipse / radius))
                " % of the radius, and the torque enters through a tooth contact; with an ellipse of 0 the shell is the paper's."
            },
        ))
        (beside(
            Item::Fig2,
            &figure(&node(), &html! { "The 16 links of a node that is two slices or more from either end, rolled flat." }),
            &html! { "4 stretch, 4 shear and 8 bend links, in all " (mesh_links(&round)) " on the " (N) "x" (M) " mesh." },
            &html! {
                "With four slices no node is two or more from either end: a node inside has 13 links, one at an end 10, "
                (number(2.0 * mesh_links(&round) as f64 / (N * M) as f64)) " in the mean and not 16. The bend links are linear by default ("
                code { "bend_hardening" } " makes them the paper's nonlinear ones); the hardening sits in the tooth contact."
            },
        ))
    })
}

fn mesh_links<const N: usize, const M: usize>(_: &ShellState<f64, N, M>) -> usize {
    strainwave::flexspline::Shell::<f64, N, M>::links()
}

/// A point in radii as seen from above the rim, z downwards: right, down, towards the eye.
fn project([x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sine, cosine) = VIEW.sin_cos();
    let (right, near) = (x * cosine - y * sine, x * sine + y * cosine);
    let (sine, cosine) = ELEVATION.sin_cos();
    [right, near * sine + z * cosine, near * cosine - z * sine]
}

/// All links, those behind first; the cup is `length` radii long.
fn cup(point: &impl Fn(usize, usize) -> [f64; 3], length: f64) -> Markup {
    let scale = WIDTH / RADII;
    let above = 1.3 * ELEVATION.sin();
    let height = scale * (2.0 * above + length * ELEVATION.cos());
    // The middle of the axis, as deep as what is behind begins.
    let middle = project([0.0, 0.0, 0.5 * length])[2];
    let paths = |kind_wanted: &str, behind: bool| {
        let mut path = String::new();
        for (around, along) in DIRECTIONS.into_iter().filter(|direction| kind(*direction) == kind_wanted) {
            for (i, j) in (0..M - along).flat_map(|j| (0..N).map(move |i| (i, j))) {
                let far = (i as i32 + around).rem_euclid(N as i32) as usize;
                let [a, b] = [point(i, j), point(far, j + along)];
                if (0.5 * (a[2] + b[2]) < middle) == behind {
                    let [[ax, ay, _], [bx, by, _]] = [a, b].map(|p| p.map(|part| part * scale));
                    let _ = write!(path, "M{ax:.1} {ay:.1}L{bx:.1} {by:.1}");
                }
            }
        }
        path
    };
    let (left, top) = (-0.5 * WIDTH, -scale * above);
    html! {
        svg width=(WIDTH) height=(format!("{height:.0}")) role="img" aria-label="The cup's mesh"
            viewBox=(format!("{left:.0} {top:.0} {WIDTH:.0} {height:.0}")) {
            @for (behind, class) in [(true, "back"), (false, "front")] {
                g class=(class) {
                    @for kind in KINDS { path class={ "link " (kind) } d=(paths(kind, behind)) {} }
                }
            }
            @for (name, j) in [("rim", 0), ("flange", M - 1)] {
                text x=(0.5 * WIDTH) y=(format!("{:.0}", scale * middle_of(point, j))) text-anchor="end" font-size="13" {
                    (name)
                }
            }
        }
    }
}

/// Depth of a slice's middle in the drawing.
fn middle_of(point: &impl Fn(usize, usize) -> [f64; 3], j: usize) -> f64 {
    (0..N).map(|i| point(i, j)[1]).sum::<f64>() / N as f64
}

/// One node and its neighbours on a flat grid.
fn node() -> Markup {
    const SPACING: i32 = 44;
    let at = |(around, along): (i32, i32)| (around * SPACING, along * SPACING);
    let links = DIRECTIONS.into_iter().flat_map(|(around, along)| {
        [1, -1].map(|sign| (kind((around, along)), (sign * around, sign * along as i32)))
    });
    let links: Vec<_> = links.collect();
    html! {
        svg width="360" height="240" viewBox="-180 -120 360 240" role="img" aria-label="The links of a node" {
            @for (kind, direction) in &links {
                @let (x, y) = at(*direction);
                // Bend links pass over the nearest neighbours: bowed, so that both are seen.
                @let (bow_x, bow_y) = if *kind == KINDS[0] { (x / 2 - y / 6, y / 2 + x / 6) } else { (x / 2, y / 2) };
                path class={ "link " (kind) } d=(format!("M0 0Q{bow_x} {bow_y} {x} {y}")) {}
            }
            @for (_, direction) in &links {
                @let (x, y) = at(*direction);
                circle.node cx=(x) cy=(y) r="3.5" {}
            }
            circle.node cx="0" cy="0" r="6" {}
            text x="110" y="4" font-size="13" { "around" }
            text x="0" y="112" text-anchor="middle" font-size="13" { "along the axis" }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_four_links_of_the_near_kinds_and_eight_bend_links() {
        let count = |name| 2 * DIRECTIONS.into_iter().filter(|direction| kind(*direction) == name).count();
        assert_eq!(KINDS.map(count), [8, 4, 4]);
    }

    #[test]
    fn projecting_keeps_lengths() {
        let [x, y, z] = project([0.3, -0.4, 1.2]);
        assert!((x * x + y * y + z * z - 1.69).abs() < 1e-12);
    }
}
