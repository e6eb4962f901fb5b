//! `[learnt]`: what a compensator has learnt of its joint, kept for its next start.

use serde::{Deserialize, Serialize};
use strainwave::Real;
use strainwave::compensator::adapt::learning;
use strainwave::compensator::adapt::parameters::Factors;
use strainwave::compensator::adapt::ripple::{Coefficients, RippleMap};
use toml_edit::{DocumentMut, Item, Table};

/// Factors on the gear's parameters, and the ripple by the coefficients of its orders; what is left out is the nominal gear's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learnt {
    /// On the inertia of flexspline and load.
    #[serde(default = "nominal")]
    pub inertia: f64,
    /// On the friction of the wave generator.
    #[serde(default = "nominal")]
    pub input_friction: f64,
    /// On the friction of the flexspline.
    #[serde(default = "nominal")]
    pub output_friction: f64,
    /// On the compliance of the flexspline.
    #[serde(default = "nominal")]
    pub compliance: f64,
    /// Fraction of order 2 in the presliding of both frictions.
    #[serde(default = "nominal")]
    pub presliding: f64,
    /// 1 and how much stiffer the presliding is.
    #[serde(default = "nominal")]
    pub presliding_stiffness: f64,
    /// Ripple of the position at the output (rad).
    #[serde(rename = "ripple_position_cosines_rad", default)]
    pub position_cosines: Vec<f64>,
    /// (rad)
    #[serde(rename = "ripple_position_sines_rad", default)]
    pub position_sines: Vec<f64>,
    /// Ripple of the torque at the motor (N m).
    #[serde(rename = "ripple_torque_cosines_nm", default)]
    pub torque_cosines: Vec<f64>,
    /// (N m)
    #[serde(rename = "ripple_torque_sines_nm", default)]
    pub torque_sines: Vec<f64>,
}

/// The factor that is left out.
fn nominal() -> f64 {
    1.0
}

impl Learnt {
    /// The keys of a compensator's learnt factors and ripple.
    pub fn of(learnt: &learning::Learnt<f32>) -> Self {
        let Factors {
            inertia,
            input_friction,
            output_friction,
            compliance,
            presliding,
            presliding_stiffness,
        } = learnt.factors;
        let side = |map: &Coefficients<f32>, side: usize| map.iter().map(|pair| pair[side].into()).collect();
        let RippleMap { position, torque } = &learnt.ripple;
        Self {
            inertia: inertia.into(),
            input_friction: input_friction.into(),
            output_friction: output_friction.into(),
            compliance: compliance.into(),
            presliding: presliding.into(),
            presliding_stiffness: presliding_stiffness.into(),
            position_cosines: side(position, 0),
            position_sines: side(position, 1),
            torque_cosines: side(torque, 0),
            torque_sines: side(torque, 1),
        }
    }

    /// As a compensator starts from it.
    pub fn start<R: Real>(&self) -> learning::Learnt<R> {
        let at = |values: &[f64], k: usize| values.get(k).copied().map_or(R::ZERO, R::lit);
        let map = |cosines: &[f64], sines: &[f64]| std::array::from_fn(|k| [at(cosines, k), at(sines, k)]);
        learning::Learnt {
            factors: Factors {
                inertia: R::lit(self.inertia),
                input_friction: R::lit(self.input_friction),
                output_friction: R::lit(self.output_friction),
                compliance: R::lit(self.compliance),
                presliding: R::lit(self.presliding),
                presliding_stiffness: R::lit(self.presliding_stiffness),
            },
            ripple: RippleMap {
                position: map(&self.position_cosines, &self.position_sines),
                torque: map(&self.torque_cosines, &self.torque_sines),
            },
        }
    }

    /// Puts this as `[learnt]` where it stood, at the end when there was none.
    pub(super) fn put_into(&self, document: &mut DocumentMut) {
        let learnt = toml_edit::ser::to_document(self).expect("every field has a TOML form");
        let section = document.entry("learnt").or_insert(Item::Table(Table::new()));
        let mut kept = section.as_table().cloned().unwrap_or_default();
        kept.clear();
        kept.extend(learnt.iter().map(|(key, value)| (key, value.clone())));
        *section = Item::Table(kept);
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::io::gear_file::DEFAULT;
    use crate::io::gear_file::GearFile;
    use crate::io::gear_file::text::edited;

    fn learnt() -> learning::Learnt<f32> {
        learning::Learnt {
            factors: Factors {
                inertia: 0.833_333_3_f32,
                input_friction: 1.1,
                output_friction: 0.95,
                compliance: 1.01,
                presliding: 0.4,
                presliding_stiffness: 1.2,
            },
            ripple: RippleMap {
                position: [[1e-4, -2e-5], [0.0, 3.3e-6], [0.0; 2], [1e-9, 0.0]],
                torque: [[1e-3, 2e-3], [0.0; 2], [0.0; 2], [-1e-4, 0.0]],
            },
        }
    }

    fn parsed(text: &str) -> GearFile {
        GearFile::parse(Path::new("kept.toml"), text.as_bytes()).unwrap()
    }

    /// Through the file and back nothing of an f32 is lost.
    #[test]
    fn what_is_kept_is_what_is_started_from() {
        let mut file = GearFile::default_gear();
        file.learnt = Some(Learnt::of(&learnt()));
        let again = parsed(&file.to_toml());
        assert_eq!(again, file);
        assert_eq!(again.learnt.unwrap().start::<f32>(), learnt());
    }

    /// With comments before, in and behind the section, and without a section: the rest is there to the letter.
    #[test]
    fn the_rest_of_the_file_stays_as_it_is() {
        let kept = Learnt::of(&learnt());
        let appended = edited(DEFAULT, |document| kept.put_into(document)).unwrap();
        let section = appended.strip_prefix(DEFAULT).unwrap();
        assert!(section.trim_start().starts_with("[learnt]\ninertia = 0.8333"), "{section}");
        assert_eq!(parsed(&appended).learnt.as_ref(), Some(&kept));

        let old = "# on the bench\n[learnt] # by hand\ninertia = 1.2\ninput_friction = 1.0\noutput_friction = 1.0\n\
                   compliance = 1.0\n";
        let (first, rest) = DEFAULT.split_once("[motor]").unwrap();
        let before = format!("{first}{old}\n# which?\n[motor]{rest}");
        let replaced = edited(&before, |document| kept.put_into(document)).unwrap();
        let (head, tail) = replaced.split_once("# on the bench\n[learnt] # by hand\n").unwrap();
        assert!(head == first && tail.ends_with(&format!("\n\n# which?\n[motor]{rest}")), "{replaced}");
        assert_eq!(parsed(&replaced), parsed(&appended));
        assert_eq!(edited(&replaced, |document| kept.put_into(document)).unwrap(), replaced);
    }

    /// The other way to write a table.
    #[test]
    fn an_inline_section_is_replaced_too() {
        let factors =
            "learnt = { inertia = 1.2, input_friction = 1.0, output_friction = 1.0, compliance = 1.0 }\n";
        let kept = Learnt::of(&learnt());
        let replaced = edited(&format!("{factors}{DEFAULT}"), |document| kept.put_into(document)).unwrap();
        assert_eq!(parsed(&replaced).learnt, Some(kept));
    }

    #[test]
    fn what_could_not_be_read_again_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept.toml");
        let wrong = Learnt { inertia: f64::NAN, ..Learnt::of(&learnt()) };
        let refused = wrong.keep_in(DEFAULT, &path).unwrap_err().to_string();
        assert!(refused.contains("kept.toml: learnt.inertia"), "{refused}");
        assert!(!path.exists());
        Learnt::of(&learnt()).keep_in(DEFAULT, &path).unwrap();
        assert_eq!(GearFile::read(&path).unwrap().learnt, Some(Learnt::of(&learnt())));
    }

    #[test]
    fn a_factor_out_of_range_is_named() {
        let text = GearFile::default_gear().to_toml()
            + "\n[learnt]\ninertia = 2.5\ninput_friction = 1.0\noutput_friction = 1.0\ncompliance = 1.0\n";
        let refused = GearFile::parse(Path::new("g.toml"), text.as_bytes()).unwrap_err().to_string();
        assert!(refused.contains("learnt.inertia") && refused.contains("2.5"), "{refused}");
    }
}
