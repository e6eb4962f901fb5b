//! The paper's figures and its table: what it says of each, beside ours, and what differs.
//!
//! R. Leniowski, "Modeling of torsional vibration in harmonic drives", Archives of Acoustics. Quoted are captions and the
//! numbers of the text; those of its curves stand in its pictures alone and are not quoted.

use maud::{Markup, html};

use super::Chapter;
use crate::verify::Measured;

/// A figure or table of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Item {
    Fig1,
    Fig2,
    Fig3,
    Fig4,
    Fig5,
    Fig6,
    Fig7,
    Fig8,
    Fig9,
    Table1,
}

impl Item {
    /// In the order of the paper, its table last.
    pub const ALL: [Self; 10] = [
        Self::Fig1,
        Self::Fig2,
        Self::Fig3,
        Self::Fig4,
        Self::Fig5,
        Self::Fig6,
        Self::Fig7,
        Self::Fig8,
        Self::Fig9,
        Self::Table1,
    ];

    /// Anchor on the page.
    pub fn anchor(self) -> &'static str {
        ["fig-1", "fig-2", "fig-3", "fig-4", "fig-5", "fig-6", "fig-7", "fig-8", "fig-9", "table-1"]
            [self as usize]
    }

    /// As the paper counts it.
    pub fn title(self) -> String {
        let (kind, number) = self.anchor().split_once('-').expect("every anchor has a hyphen");
        format!("{} {number}", if kind == "fig" { "Fig." } else { "Table" })
    }

    /// The paper's caption.
    pub fn caption(self) -> &'static str {
        match self {
            Self::Fig1 => "Cylindrical flexspline.",
            Self::Fig2 => {
                "FE mass-spring model connectivity, stretch springs, shear springs, bending springs."
            }
            Self::Fig3 => "Reference and current configurations of model connectivity.",
            Self::Fig4 => "Tangent force/deformation characteristic.",
            Self::Fig5 => "Hysteresis curve.",
            Self::Fig6 => "Relay characteristic and hysteresis, discrete model.",
            Self::Fig7 => "HD model.",
            Self::Fig8 => "The inside structure of HD.",
            Self::Fig9 => {
                "a, b) Position angle of wave generator and flexpline angle, c) the flexpline velocity. Horizontal axis – time in \
                 seconds (0.1 ms sampling time), vertical axis – radians × 1e-3, (a, b), radian/s (c)."
            }
            Self::Table1 => "Classic models of friction.",
        }
    }

    /// What its text says of it.
    fn text(self) -> &'static str {
        match self {
            Self::Fig1 => {
                "“FE circular cylindrical shell loaded on both sides by the various forces which are tangent to the flexspline surface”; 36 stacks and 4 slices."
            }
            Self::Fig2 => {
                "“Four nearest-stretch springs, four diagonal-shear springs” and “eight next-nearest neighbours (nonlinear bend spring)”: 16 for each mass. Its introduction has 8 directions and 4 “long-distance” neighbours."
            }
            Self::Fig3 => "Eq. (1): L1 = sqrt(b² + (a − Δx)²), L2 = sqrt(b² + (a + Δx)²). No numbers.",
            Self::Fig4 => {
                "“Nonlinear”; “link L2 is stretched for any Δx, but link L1 for a > Δx ≥ 0 is clamped and for 2a > Δx > a is stretched.” No numbers."
            }
            Self::Fig5 => {
                "“Complicated-shape characteristic of hysteresis” from engineering data. No numbers."
            }
            Self::Fig6 => {
                "Eq. (9): a sum of n weighted relays; n and the weights are “tuned to the individual characteristic”."
            }
            Self::Fig7 => {
                "In: angular position (or velocity) of the wave generator, load torque. Out: angular position (or velocity) of the flexspline, torque at the wave generator."
            }
            Self::Fig8 => {
                "“Four function blocks”: gearHD by eq. (6), gearFric on both sides by eqs. (7) and (8), gearHyst."
            }
            Self::Fig9 => {
                "“Repeating step” of the wave generator, “constant −50 Nm load torque”, 0.1 ms. “Small damped oscillation, when reference signals are quickly changed”, “small steady error … a result of equilibrium between HD stiffness torque and load”. No height of the steps, no size of either."
            }
            Self::Table1 => "Six models: Coulomb, viscous, static, Stribeck effect, Karnopp, Armstrong.",
        }
    }
}

/// Our pictures of an item, and below them the paper beside ours and what differs.
pub(super) fn beside(item: Item, pictures: &Markup, ours: &Markup, differs: &Markup) -> Markup {
    html! {
        div id=(item.anchor()) {
            (pictures)
            dl.paper {
                dt { "Paper, " (item.title()) } dd { q { (item.caption()) } " " (item.text()) }
                dt { "Ours" } dd { (ours) }
                dt { "Differs" } dd { (differs) }
            }
        }
    }
}

/// The list of all, each with its place on the page.
pub(super) fn chapter() -> Chapter {
    let body = html! {
        p {
            "Every figure and table of R. Leniowski, “Modeling of torsional vibration in harmonic drives” (Archives of Acoustics), has its place on "
            "this page: ours, the paper's caption and what its text says of it, and what differs. The numbers of the paper's curves stand in its "
            "pictures alone; what its text does not say has no number here. All of ours is computed in this run."
        }
        ul { @for item in Item::ALL {
            li { a href={ "#" (item.anchor()) } { (item.title()) } ": " (item.caption()) }
        } }
    };
    Chapter { id: "paper", title: "The paper, figure by figure", body, measured: Measured::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_listed_and_has_its_own_place() {
        let list = chapter().body.into_string();
        for item in Item::ALL {
            assert!(list.contains(&format!("<a href=\"#{}\">{}</a>", item.anchor(), item.title())), "{list}");
        }
        assert_eq!([Item::Fig9.title(), Item::Table1.title()], ["Fig. 9", "Table 1"]);
    }
}
