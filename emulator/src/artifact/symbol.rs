//! Names of functions without what a compiler may change: mangling, hashes, type arguments.

/// The path of a function: `<a::B<f32> as a::C<f32>>::step` and `a::B<R>::step::h0123456789abcdef` are both
/// `a::B::step`, so that a budget names a function once for every mangling.
pub fn path(symbol: &str) -> String {
    let demangled = format!("{:#}", rustc_demangle::demangle(symbol));
    let plain = match demangled.strip_prefix('<') {
        Some(rest) => self_type(rest),
        None => demangled,
    };
    without_arguments(&plain)
}

/// `a::B<f32> as a::C>::step` is `a::B<f32>::step`.
fn self_type(rest: &str) -> String {
    let end = closing(rest);
    let (inner, tail) = (&rest[..end], rest.get(end + 1..).unwrap_or(""));
    let inner = match split_as(inner) {
        Some(before) => before,
        None => inner,
    };
    let inner = match inner.strip_prefix('<') {
        Some(nested) => self_type(nested),
        None => inner.to_owned(),
    };
    format!("{inner}{tail}")
}

/// The place of the `>` that closes what `text` is inside of, or its end.
fn closing(text: &str) -> usize {
    let mut depth = 0;
    for (place, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if is_arrow(text, place) => {}
            '>' if depth == 0 => return place,
            '>' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

fn is_arrow(text: &str, place: usize) -> bool {
    text[..place].ends_with('-')
}

fn split_as(inner: &str) -> Option<&str> {
    let mut places = inner.match_indices(" as ").map(|(place, _)| place);
    places
        .find(|place| inner[..*place].matches('<').count() == inner[..*place].matches('>').count())
        .map(|p| &inner[..p])
}

fn without_arguments(text: &str) -> String {
    let mut path = String::new();
    let mut rest = text;
    while let Some(open) = rest.find('<') {
        path.push_str(rest[..open].trim_end_matches("::"));
        let inside = &rest[open + 1..];
        rest = inside.get(closing(inside) + 1..).unwrap_or("");
    }
    path + rest
}

/// Whether `path` is what `pattern` describes: segments between `::`, of which `*` stands for any one.
pub fn matches(pattern: &str, path: &str) -> bool {
    let (mut wanted, mut found) = (pattern.split("::"), path.split("::"));
    loop {
        match (wanted.next(), found.next()) {
            (None, None) => return true,
            (Some("*"), Some(_)) => {}
            (Some(w), Some(f)) if w == f => {}
            _ => return false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_manglings_give_one_path() {
        let cases = [
            (
                "_ZN10strainwave11compensator20Compensator$LT$R$GT$4step17h0123456789abcdefE",
                "strainwave::compensator::Compensator::step",
            ),
            (
                "_ZN92_$LT$strainwave..friction..Dahl$LT$R$GT$$u20$as$u20$strainwave..friction..Model$LT$R$GT$$GT$4step17h0123456789abcdefE",
                "strainwave::friction::Dahl::step",
            ),
            (
                "_RNvMNtCs1234_10strainwave11compensatorINtB2_11CompensatorfE4step",
                "strainwave::compensator::Compensator::step",
            ),
            ("SysTick", "SysTick"),
        ];
        for (symbol, expected) in cases {
            assert_eq!(path(symbol), expected, "{}", rustc_demangle::demangle(symbol));
        }
    }

    #[test]
    fn arguments_go_wherever_they_stand() {
        assert_eq!(path("a::b::<c::D<e>, fn(f) -> g>::h"), "a::b::h");
        assert_eq!(path("<<a::B<f32> as c::D>::E as f::G>::h"), "a::B::E::h");
    }

    #[test]
    fn a_star_is_one_segment() {
        assert!(matches("a::*::step", "a::B::step"));
        assert!(!matches("a::*::step", "a::b::C::step"));
        assert!(!matches("a::step", "a::step::x") && !matches("a::step::x", "a::step"));
    }
}
