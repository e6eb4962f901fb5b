//! A key of a file and what it may hold, and relations between keys.

use std::fmt;
use std::ops::{Bound, RangeBounds};

use strainwave::hysteresis::table::TABLE_LEVELS;

/// Allowed values of a key.
#[derive(Clone, Copy, Debug)]
pub enum Allowed {
    /// 1 to 80 characters without control characters.
    Text,
    /// `true` or `false`.
    Flag,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A whole number from the first to the second.
    Whole(i64, i64),
    /// A finite number between two ends, and its unit.
    Number(Bound<f64>, Bound<f64>, &'static str),
    /// Rows of 1, 2, 3, ... numbers, 2 to [`TABLE_LEVELS`] of them, each number from the first to the second, and its unit.
    Triangle(f64, f64, &'static str),
    /// One to so many numbers between plus and minus an end, and their unit.
    Numbers(usize, f64, &'static str),
}

/// Longest text (characters).
pub const LONGEST_TEXT: usize = 80;
/// Most entries of a list of tables.
pub const MOST_ENTRIES: usize = 8;

/// One key: its path in the file (`[]` marks a list of tables) and what it may hold.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Dotted path, such as `friction.input.coulomb_nm`.
    pub path: &'static str,
    /// Its allowed values.
    pub allowed: Allowed,
    /// The file need not have it.
    pub optional: bool,
}

pub(crate) const fn key(path: &'static str, allowed: Allowed) -> Key {
    Key { path, allowed, optional: false }
}

pub(crate) const fn optional(path: &'static str, allowed: Allowed) -> Key {
    Key { path, allowed, optional: true }
}

/// From `least` to `most`, both allowed.
pub(crate) const fn within(least: f64, most: f64, unit: &'static str) -> Allowed {
    Allowed::Number(Bound::Included(least), Bound::Included(most), unit)
}

/// More than 0, up to `most`.
pub(crate) const fn positive(most: f64, unit: &'static str) -> Allowed {
    Allowed::Number(Bound::Excluded(0.0), Bound::Included(most), unit)
}

/// The parts one after the other, `N` keys in all.
pub(crate) const fn joined<const N: usize>(parts: &[&[Key]]) -> [Key; N] {
    let mut all = [parts[0][0]; N];
    let (mut at, mut part) = (0, 0);
    while part < parts.len() {
        let mut index = 0;
        while index < parts[part].len() {
            all[at] = parts[part][index];
            (at, index) = (at + 1, index + 1);
        }
        part += 1;
    }
    all
}

/// Relation between two numbers of the same file.
#[derive(Clone, Copy, Debug)]
pub struct Relation {
    /// The key that is refused.
    pub path: &'static str,
    /// Whether it may equal the limit.
    pub or_equal: bool,
    /// The limit in multiples of `than`.
    pub times: f64,
    /// The key that it is compared with.
    pub than: &'static str,
}

pub(crate) const fn at_least(path: &'static str, than: &'static str) -> Relation {
    Relation { path, or_equal: true, times: 1.0, than }
}

pub(crate) const fn more_than(path: &'static str, times: f64, than: &'static str) -> Relation {
    Relation { path, or_equal: false, times, than }
}

/// Everything that a kind of file may hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Schema {
    /// Every key, in the order of the file.
    pub keys: &'static [Key],
    /// Relations between them.
    pub relations: &'static [Relation],
    /// Tables of `[friction]`, one for each side.
    pub sides: &'static [&'static str],
    /// Sections that a file may leave out as a whole.
    pub optional_sections: &'static [&'static str],
}

impl Schema {
    /// These keys alone.
    pub(crate) const fn of(keys: &'static [Key]) -> Self {
        Self { keys, relations: &[], sides: &[], optional_sections: &[] }
    }
}

/// The section that the key at this path is in.
pub(crate) fn section_of(path: &str) -> &str {
    path.split(['.', '[']).next().unwrap_or(path)
}

impl Relation {
    /// `value` stands rightly to the compared key's `other`.
    pub fn holds(&self, value: f64, other: f64) -> bool {
        let limit = self.times * other;
        value > limit || (self.or_equal && value == limit)
    }
}

impl fmt::Display for Relation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.or_equal { "at least " } else { "more than " })?;
        if self.times != 1.0 {
            write!(formatter, "{} times ", self.times)?;
        }
        formatter.write_str(self.than)
    }
}

/// The controller's f32 has the number, to its precision: it neither vanishes nor overflows.
pub(crate) fn in_single_precision(number: f64) -> bool {
    number == 0.0 || (number as f32).is_normal()
}

impl Allowed {
    /// A number that [`Allowed::Number`] or [`Allowed::Whole`] holds, or that may be one of [`Allowed::Numbers`]; NaN and
    /// infinities never, nor what vanishes in the controller's f32.
    pub fn holds(self, number: f64) -> bool {
        match self {
            Self::Number(least, most, _) => (least, most).contains(&number) && in_single_precision(number),
            Self::Numbers(_, end, _) => number.abs() <= end && in_single_precision(number),
            Self::Whole(least, most) => {
                number.fract() == 0.0 && number >= least as f64 && number <= most as f64
            }
            _ => false,
        }
    }

    /// Unit of a number; none of what is no number or has no unit.
    pub fn unit(self) -> Option<&'static str> {
        match self {
            Self::Number(.., unit) | Self::Triangle(.., unit) | Self::Numbers(.., unit) => {
                Some(unit).filter(|unit| *unit != "1")
            }
            _ => None,
        }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Text => write!(formatter, "text of 1 to {LONGEST_TEXT} characters"),
            Self::Flag => formatter.write_str("true or false"),
            Self::Word(words) => {
                let quoted: Vec<_> = words.iter().map(|word| format!("{word:?}")).collect();
                formatter.write_str(&quoted.join(" or "))
            }
            Self::Whole(least, most) => write!(formatter, "a whole number from {least} to {most}"),
            Self::Number(least, most, unit) => {
                write!(formatter, "a number {} {}{}", lower_end(least), upper_end(most), unit_after(unit))
            }
            Self::Numbers(most, end, unit) => {
                let (end, unit) = (plain(end), unit_after(unit));
                write!(formatter, "a list of 1 to {most} numbers from -{end} to {end}{unit}")
            }
            Self::Triangle(least, most, unit) => write!(
                formatter,
                "rows of 1, 2, 3, ... numbers from {} to {} {unit}, 2 to {TABLE_LEVELS} rows",
                plain(least),
                plain(most)
            ),
        }
    }
}

fn unit_after(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}

fn lower_end(end: Bound<f64>) -> String {
    match end {
        Bound::Included(least) => format!("from {}", plain(least)),
        Bound::Excluded(least) => format!("above {}", plain(least)),
        Bound::Unbounded => String::new(),
    }
}

fn upper_end(end: Bound<f64>) -> String {
    match end {
        Bound::Included(most) => format!("to {}", plain(most)),
        Bound::Excluded(most) => format!("below {}", plain(most)),
        Bound::Unbounded => String::new(),
    }
}

/// Powers of ten for the large and the small, as a person would write them.
fn plain(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) { format!("{number:e}") } else { number.to_string() }
}
