//! `[baselines.b0]` to `[baselines.b3]`: what the baselines were tuned to on this gear.

use serde::{Deserialize, Serialize};
use toml_edit::{DocumentMut, Item, Table};

use super::gains::{BaselineGains, Kind, StoredGains};

/// The gains of each baseline that was tuned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baselines {
    /// The cascade alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub b0: Option<StoredGains>,
    /// With a rigid joint's feed-forward.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub b1: Option<StoredGains>,
    /// With kinematic error and wind-up put in advance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub b2: Option<StoredGains>,
    /// With the output's error fed back too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub b3: Option<StoredGains>,
}

impl Baselines {
    /// Those of one baseline.
    pub fn of(&self, kind: Kind) -> Option<&StoredGains> {
        [&self.b0, &self.b1, &self.b2, &self.b3][kind as usize].as_ref()
    }

    /// Puts in those of one baseline.
    pub fn set(&mut self, kind: Kind, gains: &BaselineGains) {
        let places = [&mut self.b0, &mut self.b1, &mut self.b2, &mut self.b3];
        *places.into_iter().nth(kind as usize).expect("there is a place for each kind") =
            Some(StoredGains::new(kind, gains));
    }

    /// Puts these sections where they stood, at the end where there was none.
    pub(super) fn put_into(&self, document: &mut DocumentMut) {
        let tuned = toml_edit::ser::to_document(self).expect("every field has a TOML form");
        let mut section = match document.remove("baselines").map(Item::into_table) {
            Some(Ok(section)) => section,
            _ => Table::new(),
        };
        section.set_implicit(true);
        for (name, gains) in tuned.iter() {
            let gains = gains.clone().into_table().expect("a struct's form is a table");
            let mut kept = section.get(name).and_then(Item::as_table).cloned().unwrap_or_default();
            kept.clear();
            kept.extend(gains);
            section.insert(name, Item::Table(kept));
        }
        document.insert("baselines", Item::Table(section));
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::io::gear_file::GAINS;
    use crate::io::gear_file::GearFile;
    use crate::io::gear_file::KEYS;
    use crate::io::gear_file::text::edited;
    use crate::io::keyed_file::key::Allowed;

    fn plain() -> String {
        let mut file = GearFile::default_gear();
        file.baselines = None;
        file.to_toml()
    }

    fn parsed(text: &str) -> Result<GearFile, String> {
        GearFile::parse(Path::new("kept.toml"), text.as_bytes()).map_err(|error| error.to_string())
    }

    fn gains() -> BaselineGains {
        let rule = BaselineGains::untuned(&GearFile::default_gear(), Kind::B3);
        BaselineGains { position_bandwidth: 28.5, output_integral: 33.3, ..rule }
    }

    fn tuned() -> Baselines {
        let mut tuned = Baselines::default();
        tuned.set(Kind::B0, &gains());
        tuned.set(Kind::B3, &gains());
        tuned
    }

    #[test]
    fn what_is_stored_is_what_a_baseline_is_built_with() {
        let kept = edited(&plain(), |document| tuned().put_into(document)).unwrap();
        let file = parsed(&kept).unwrap();
        assert_eq!(file.baselines, Some(tuned()));
        assert_eq!(BaselineGains::of(&file, Kind::B3), gains());
        assert_eq!(BaselineGains::of(&file, Kind::B1), BaselineGains::untuned(&file, Kind::B1));
        assert_eq!(parsed(&file.to_toml()).unwrap(), file);
    }

    /// A section is replaced, and comments and the other sections are there to the letter.
    #[test]
    fn the_rest_of_the_file_stays_as_it_is() {
        let before = format!("# ours\n{}\n# by hand\n[baselines.b1]\nfriction_gain = 0.7\n", plain());
        let once = edited(&before, |document| tuned().put_into(document)).unwrap();
        assert!(once.starts_with(&before), "{once}");
        assert_eq!(edited(&once, |document| tuned().put_into(document)).unwrap(), once);
        let file = parsed(&once).unwrap();
        assert_eq!(BaselineGains::of(&file, Kind::B1).friction_gain, 0.7);
    }

    #[test]
    fn a_gain_out_of_range_and_one_of_another_baseline_are_named() {
        let refused = |section: &str| parsed(&format!("{}\n{section}\n", plain())).unwrap_err();
        let wrong = refused("[baselines.b3]\noutput_low_pass_hz = 1e5");
        assert!(
            wrong.contains("baselines.b3.output_low_pass_hz = 100000") && wrong.contains("2000 Hz"),
            "{wrong}"
        );
        let other = refused("[baselines.b2]\noutput_proportional = 1.0");
        assert!(other.contains("unknown key baselines.b2.output_proportional"), "{other}");
    }

    /// The table of keys and the table of gains say the same.
    #[test]
    fn every_gain_has_its_key() {
        for kind in Kind::ALL {
            for gain in kind.gains() {
                let path = format!("baselines.{}.{}", kind.name(), gain.key);
                let key = KEYS.iter().find(|key| key.path == path).unwrap_or_else(|| panic!("{path}"));
                let Allowed::Number(..) = key.allowed else { panic!("{path}") };
                for (fraction, holds) in [(1.0, true), (1.001, false)] {
                    let [least, most] = gain.range;
                    assert!(
                        key.optional
                            && key.allowed.holds(least)
                            && key.allowed.holds(most * fraction) == holds
                    );
                }
            }
        }
        let keys = KEYS.iter().filter(|key| key.path.starts_with("baselines.")).count();
        assert_eq!(keys, Kind::ALL.map(|kind| kind.gains().count()).iter().sum::<usize>());
        assert_eq!(GAINS.len(), 9);
    }
}
