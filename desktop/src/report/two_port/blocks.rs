//! Figs. 7 and 8: the gear's ports, and the blocks inside.

use maud::{Markup, html};

/// A block: left, top, width (pixels), name, and what it is.
type Block = (u32, u32, u32, &'static str, &'static str);

const HEIGHT: u32 = 52;

fn block((left, top, width, name, what): Block) -> Markup {
    let middle = left + width / 2;
    html! {
        rect.outline.block x=(left) y=(top) width=(width) height=(HEIGHT) rx="6" {}
        text x=(middle) y=(top + 22) text-anchor="middle" font-size="14" { (name) }
        text.small x=(middle) y=(top + 40) text-anchor="middle" font-size="11" { (what) }
    }
}

/// Paths with an arrow at the end of each.
fn arrows(paths: &[&str]) -> Markup {
    html! {
        defs { marker #tip markerWidth="8" markerHeight="8" refX="7" refY="4" orient="auto" { path.node d="M0 0L8 4L0 8z" {} } }
        @for path in paths { path.wire d=(path) marker-end="url(#tip)" {} }
    }
}

fn words(all: &[(u32, u32, &str)]) -> Markup {
    html! { @for (x, y, word) in all { text x=(x) y=(y) text-anchor="middle" font-size="12" { (word) } } }
}

/// Fig. 7.
pub(super) fn ports() -> Markup {
    html! {
        svg width="560" height="110" viewBox="0 0 560 110" role="img" aria-label="The gear as a two-port" {
            (arrows(&["M40 40H200", "M200 75H40", "M360 40H520", "M520 75H360"]))
            (block((200, 28, 160, "gear", "step: torques and motion")))
            (words(&[(110, 32, "motion of the motor"), (110, 92, "torque at the motor"), (440, 32, "motion of the output"), (440, 92, "load")]))
        }
    }
}

/// Fig. 8, with the paper's names of the blocks.
pub(super) fn inside() -> Markup {
    html! {
        svg width="760" height="250" viewBox="0 0 760 250" role="img" aria-label="The blocks inside the gear" {
            (arrows(&[
                "M20 56H130", "M270 56H330", "M300 56V116H330", "M490 56H520V80H560", "M490 116H520V92H560", "M700 86H750",
                "M630 112V160", "M75 56V186H130", "M270 186H330", "M410 142V160",
            ]))
            (block((130, 30, 140, "kinematic error", "not in the paper")))
            (block((330, 30, 160, "flexspline", "gearHD, eq. (6)")))
            (block((330, 90, 160, "hysteresis", "gearHyst, eq. (9)")))
            (block((560, 60, 140, "output inertia", "J_fs")))
            (block((560, 160, 140, "output friction", "gearFric, eqs. (7), (8)")))
            (block((130, 160, 140, "input friction", "gearFric, eqs. (7), (8)")))
            (block((330, 160, 160, "motor's torque", "sum, by the ratio")))
            (words(&[(60, 48, "motor"), (725, 78, "output"), (300, 48, "torsion")]))
        }
    }
}
