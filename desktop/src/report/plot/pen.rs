//! Colours and strokes: either alone tells the curves of a panel apart.

use plotters::style::{Color as _, RGBColor, ShapeStyle};

use super::canvas::PIXEL;
use super::{Series, Style};

/// Okabe and Ito's colours, told apart with any colour vision and in grey print.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Mid grey in grey print.
    Blue,
    /// Mid grey in grey print.
    Vermilion,
    /// Mid grey in grey print.
    Green,
    /// Light grey in grey print.
    Purple,
    /// Light grey in grey print.
    SkyBlue,
    /// Light grey in grey print.
    Orange,
    /// Black in any print.
    Black,
}

impl Colour {
    /// All of them, in the order in which curves get them.
    pub(super) const ALL: [Self; 7] =
        [Self::Blue, Self::Vermilion, Self::Green, Self::Purple, Self::SkyBlue, Self::Orange, Self::Black];

    pub(super) fn rgb(self) -> RGBColor {
        match self {
            Self::Blue => RGBColor(0, 114, 178),
            Self::Vermilion => RGBColor(213, 94, 0),
            Self::Green => RGBColor(0, 158, 115),
            Self::Purple => RGBColor(204, 121, 167),
            Self::SkyBlue => RGBColor(86, 180, 233),
            Self::Orange => RGBColor(230, 159, 0),
            Self::Black => RGBColor(0, 0, 0),
        }
    }
}

/// Colours of a panel's curves: the one that a curve asks for, else the next; a curve without a name goes with the last
/// that has one, as a bound goes with its curve.
pub(super) fn colours(series: &[Series]) -> impl Iterator<Item = Colour> {
    (0..series.len()).map(|index| {
        let named = series[..=index].iter().rposition(|series| !series.name.is_empty());
        series[index].colour.unwrap_or(Colour::ALL[named.unwrap_or(index) % Colour::ALL.len()])
    })
}

/// Width of each stroke, in the drawing's units, and the lengths of its dashes and of the spaces between them. `plotters`
/// draws no dashes into SVG, so the width, of which no two are equal, stands for them in its text.
const STROKES: [(Style, u32, &[u32]); 5] = [
    (Style::Line, 6, &[]),
    (Style::Broad, 20, &[]),
    (Style::Dashed, 7, &[24, 16]),
    (Style::Dotted, 9, &[8, 12]),
    (Style::DashDotted, 8, &[36, 12, 8, 12]),
];

/// Stroke of a style; of points and bands a line's.
pub(super) fn stroke(style: Style, colour: Colour) -> ShapeStyle {
    let known = STROKES.iter().find(|(known, ..)| *known == style);
    colour.rgb().stroke_width(known.map_or(3 * PIXEL / 2, |(_, width, _)| *width))
}

/// The text of a drawing with the dashes that its widths stand for.
pub(super) fn with_dashes(svg: &str) -> String {
    STROKES.iter().filter(|(.., dashes)| !dashes.is_empty()).fold(
        svg.to_owned(),
        |text, (_, width, dashes)| {
            let width = format!("stroke-width=\"{width}\"");
            let dashes: Vec<_> = dashes.iter().map(u32::to_string).collect();
            text.replace(&width, &format!("{width} stroke-dasharray=\"{}\"", dashes.join(" ")))
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_without_a_name_goes_with_the_one_before() {
        let of = |names: &[&str]| -> Vec<_> {
            let series: Vec<_> = names.iter().map(|name| Series::line(*name, &[], &[])).collect();
            colours(&series).collect()
        };
        let [blue, vermilion, _, purple, ..] = Colour::ALL;
        assert_eq!(of(&["error", "bound", "", "last"]), [blue, vermilion, vermilion, purple]);
        assert_eq!(of(&["", ""]), [blue, vermilion]);
        let given = [Series::line("a", &[], &[]).coloured(Colour::Black), Series::line("b", &[], &[])];
        assert_eq!(colours(&given).collect::<Vec<_>>(), [Colour::Black, vermilion]);
    }

    #[test]
    fn a_width_stands_for_one_stroke() {
        let drawn = STROKES
            .map(|(style, ..)| format!("stroke-width=\"{}\"", stroke(style, Colour::Blue).stroke_width));
        for (k, one) in drawn.iter().enumerate() {
            assert!(!drawn[..k].contains(one));
            let dashed = with_dashes(one).contains("stroke-dasharray");
            assert_eq!(dashed, !STROKES[k].2.is_empty());
        }
    }
}
