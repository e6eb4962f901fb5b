//! Where a figure of a catalogue gear comes from, in the words of its gear file.

use std::fmt;

use super::figures::{Read, SIZES, row_ratio, slopes_were_read};
use super::gear::Model;

/// Origin of a figure.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Origin {
    /// The user's choice.
    Chosen,
    /// Read in a catalogue.
    Catalogue,
    /// By a law from other figures.
    Derived(String),
    /// By experience, no catalogue's figure.
    Rule(&'static str),
    /// Of the material or of the gear's kind.
    Fact(&'static str),
    /// As the default gear's, which was not measured either.
    Default,
    /// Found by `strainwave tune`.
    Tuned,
    /// To be identified.
    Unknown,
}

impl fmt::Display for Origin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Chosen => formatter.write_str("as chosen"),
            Self::Catalogue => formatter.write_str("catalogue"),
            Self::Derived(law) => formatter.write_str(law),
            Self::Rule(rule) => write!(formatter, "rule of thumb: {rule}"),
            Self::Fact(fact) => formatter.write_str(fact),
            Self::Default => formatter.write_str("rule of thumb: as the default gear hd25-100"),
            Self::Tuned => formatter.write_str("tuned for this gear"),
            Self::Unknown => formatter.write_str("not known before `strainwave identify`"),
        }
    }
}

impl Origin {
    /// K1, K2, K3.
    pub fn slopes(model: Model) -> Self {
        let (read, row) = (Read::of(model.size), row_ratio(model.ratio));
        if slopes_were_read(model.size, model.ratio) {
            return Self::Catalogue;
        }
        let ratio = if row == model.ratio { String::new() } else { format!(" at ratio {row}") };
        match of_size(read, 3) {
            Self::Derived(law) => Self::Derived(law + &ratio),
            _ if ratio.is_empty() => Self::Derived("catalogue, the slope that it lacks interpolated".into()),
            _ => Self::Derived(format!("interpolated: that of ratio {row}")),
        }
    }

    /// T1, T2.
    pub fn knees(model: Model) -> Self {
        of_size(Read::of(model.size), 3)
    }

    /// Rated torque.
    pub fn rated_torque(model: Model) -> Self {
        let power = "a power of the ratio through those of 50 and 100";
        match (of_size(Read::of(model.size), 3), model.ratio) {
            (origin, 50 | 100..) => origin,
            (Self::Derived(law), _) => Self::Derived(format!("{law}, {power}")),
            (_, 51..100) => Self::Derived(format!("interpolated: {power}")),
            _ => Self::Derived(format!("extrapolated: {power}")),
        }
    }

    /// Inertia of the wave generator with a rotor.
    pub fn wave_generator(model: Model) -> Self {
        match of_size(Read::of(model.size), 5) {
            Self::Derived(law) => {
                Self::Derived(format!("wave generator {law}; rule of thumb: a rotor of 0.45 of it"))
            }
            _ => Self::Rule("the catalogue's wave generator and a rotor of 0.45 of it"),
        }
    }

    /// Friction at the wave generator, which catalogues have of the ratio 100 alone.
    pub fn friction(model: Model) -> Self {
        match of_size(Read::friction(model.size), 3) {
            Self::Catalogue if model.ratio == 100 => Self::Catalogue,
            Self::Catalogue => Self::Derived("interpolated: that of ratio 100".into()),
            Self::Derived(law) if model.ratio != 100 => Self::Derived(law + " at ratio 100"),
            origin => origin,
        }
    }
}

/// A figure that grows with this power of the size.
fn of_size(read: Read, power: u32) -> Origin {
    if read.scale == 1.0 {
        return Origin::Catalogue;
    }
    let size = f64::from(read.size) * read.scale;
    let within = (f64::from(SIZES[0])..=f64::from(SIZES[SIZES.len() - 1])).contains(&size);
    let kind = if within { "interpolated" } else { "extrapolated" };
    Origin::Derived(format!("{kind}: size {} times {:.3}^{power}", read.size, read.scale))
}
