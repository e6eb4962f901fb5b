//! The report's pictures as files of their own, for other pages.

use maud::Markup;

/// Attributes of an SVG file that a picture within a page does not have.
const NAMESPACE: &str = "xmlns=\"http://www.w3.org/2000/svg\"";

/// Style of the drawings in the light colours of the page's style sheet.
const STYLE: &str = "svg { background: #fff; font-family: sans-serif; } \
    .link { fill: none; stroke-width: 1.2; stroke-linecap: round; } \
    .stretch { stroke: #0072b2; } .shear { stroke: #d55e00; } .bend { stroke: #009e73; } .back { opacity: 0.25; } \
    .node { fill: #1a1a1a; } .guide { fill: none; stroke: #556; stroke-dasharray: 4 3; } .weight { fill: #0072b2; } \
    .outline { fill: none; stroke: #ccd; } .wire { fill: none; stroke: #1a1a1a; stroke-width: 1.2; } .block { stroke: #0072b2; } \
    text.small { fill: #556; }";

/// A picture of the report.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Chapter and section, as the name of a file without its ending.
    pub name: String,
    /// The SVG text.
    pub svg: String,
}

/// The pictures of a chapter, named by it and by the section in which they stand; further ones of a section are
/// numbered.
pub(super) fn of_chapter(id: &str, body: &Markup) -> Vec<Picture> {
    let mut found: Vec<Picture> = Vec::new();
    for (index, part) in body.0.split("<h3>").enumerate() {
        let (title, rest) = part.split_once("</h3>").filter(|_| index > 0).unwrap_or(("", part));
        let section = format!("{id}-{}", slug(title)).trim_end_matches('-').to_owned();
        for (count, svg) in rest.split("<svg").skip(1).enumerate() {
            let svg = svg.split_once("</svg>").map_or(svg, |(inside, _)| inside);
            let name = if count == 0 { section.clone() } else { format!("{section}-{}", count + 1) };
            found.push(Picture { name, svg: whole(svg) });
        }
    }
    found
}

fn whole(inside: &str) -> String {
    let namespace = if inside.contains(NAMESPACE) { String::new() } else { format!(" {NAMESPACE}") };
    match inside.split_once('>').filter(|_| inside.contains(" class=")) {
        Some((head, drawing)) => format!("<svg{namespace}{head}><style>{STYLE}</style>{drawing}</svg>\n"),
        None => format!("<svg{namespace}{inside}</svg>\n"),
    }
}

/// Letters and digits, words joined by hyphens.
fn slug(title: &str) -> String {
    let kept: String =
        title.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { ' ' }).collect();
    kept.split_whitespace().collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use maud::PreEscaped;

    use super::*;

    #[test]
    fn pictures_are_named_by_where_they_stand() {
        let body = "<p>a</p><svg one></svg><h3>Torque over torsion</h3><svg two>x</svg><p></p><svg xmlns=\"http://www.w3.org/2000/svg\"></svg>";
        let found = of_chapter("gear", &PreEscaped(body.into()));
        let names: Vec<_> = found.iter().map(|picture| picture.name.as_str()).collect();
        assert_eq!(names, ["gear", "gear-torque-over-torsion", "gear-torque-over-torsion-2"]);
        assert_eq!(found[1].svg, format!("<svg {NAMESPACE} two>x</svg>\n"));
        let drawing = whole("><path class=\"link\"/>");
        assert!(
            drawing.contains("><style>svg {") && drawing.ends_with("</style><path class=\"link\"/></svg>\n")
        );
        assert!(found.iter().all(|picture| picture.svg.matches(NAMESPACE).count() == 1));
    }
}
