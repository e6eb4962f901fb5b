//! The gear file of a new joint: every section and key with its meaning, unit and origin as a comment.

use std::ops::RangeInclusive;

use toml_edit::{DocumentMut, Item, Table};

use super::gear::{Model, NOMINAL_LOAD};
use super::load::with_load;
use super::origin::Origin;
use super::{FILES, File};
use crate::io::gear_file::{GearFile, KEYS};

/// Sizes that the laws are stated for.
pub const SIZES: RangeInclusive<u32> = 8..=100;
/// Ratios that they are stated for.
pub const RATIOS: RangeInclusive<i32> = 30..=160;

/// A joint of a catalogue gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewJoint {
    /// The gear, of [`SIZES`] and [`RATIOS`].
    pub model: Model,
    /// J_fs, inertia of the output with everything attached to it (kg m^2); the catalogue's rule when there is none.
    pub load: Option<f64>,
}

impl NewJoint {
    /// Its parameters: those of the catalogue's own file, where there is one.
    pub fn gear(&self) -> GearFile {
        let gear = self.tuned().map_or_else(|| self.model.gear(None), File::gear);
        match self.load {
            Some(load) => with_load(&gear, load),
            None => gear,
        }
    }

    /// Its gear file.
    pub fn text(&self) -> String {
        let mut document: DocumentMut = self.gear().to_toml().parse().expect("what is written is TOML");
        self.comment(&mut document, "");
        format!("{}{}", self.head(), document)
    }

    fn head(&self) -> String {
        let Model { size, ratio } = self.model;
        format!(
            "# Joint with a harmonic drive of size {size}, N = {ratio}, written by `strainwave new`.\n\
             # Every comment tells meaning, unit and origin of a value. Replace what you know, then `strainwave check`.\n\
             # Interpolated and extrapolated figures follow the size x relative to the nearest size that was read:\n\
             # torque and stiffness x^3, inertia x^5. No figure is a claim about one unit.\n"
        )
    }

    fn comment(&self, table: &mut Table, parent: &str) {
        for (name, item) in table.iter_mut() {
            let path = if parent.is_empty() { name.to_string() } else { format!("{parent}.{}", name.get()) };
            match item {
                Item::Value(value) => value.decor_mut().set_suffix(format!("  # {}", self.note(&path))),
                Item::Table(section) => {
                    section.decor_mut().set_prefix(heading(&path));
                    self.comment(section, &path);
                }
                Item::ArrayOfTables(entries) => {
                    for (index, entry) in entries.iter_mut().enumerate() {
                        entry.decor_mut().set_prefix(if index == 0 { heading(&path) } else { "\n".into() });
                        self.comment(entry, &format!("{path}[]"));
                    }
                }
                Item::None => {}
            }
        }
    }

    /// Unit, meaning and origin of a key.
    fn note(&self, path: &str) -> String {
        let (meaning, origin) = self.meaning(path);
        let unit = KEYS.iter().find(|key| key.path == path).and_then(|key| key.allowed.unit());
        let unit = unit.map(|unit| format!("{unit}; ")).unwrap_or_default();
        format!("{unit}{meaning}; {origin}")
    }

    fn meaning(&self, path: &str) -> (&'static str, Origin) {
        let model = self.model;
        let (section, name) = path.rsplit_once('.').unwrap_or(("", path));
        match section {
            "gear" | "stiffness" | "hysteresis" => catalogue_line(model, name),
            "flexspline" => cup(name),
            "inertia" if name == "flexspline_kg_m2" => {
                ("J_fs, the output with everything attached to it", self.load_origin())
            }
            "inertia" => ("J_wg, wave generator and rotor", Origin::wave_generator(model)),
            "friction.input" => input_friction(name, Origin::friction(model)),
            "friction.output" => output_friction(name),
            "sensors" => sensor(name),
            "feedback" => gain(name, self.gains_origin()),
            _ if section.starts_with("baselines") => gain(name, self.gains_origin()),
            _ if section.starts_with("kinematic_error") => kinematic_error(name),
            _ => joint(name),
        }
    }

    fn load_origin(&self) -> Origin {
        match self.load {
            Some(_) => Origin::Chosen,
            None => Origin::Derived(format!("rule of thumb: {NOMINAL_LOAD}*N^2*J_wg, as the default gear's")),
        }
    }

    fn tuned(&self) -> Option<&'static File> {
        FILES.iter().find(|file| file.model == self.model)
    }

    /// Of the cascade and the baselines.
    fn gains_origin(&self) -> Origin {
        match (self.tuned(), self.load) {
            (Some(_), None) => Origin::Tuned,
            (Some(_), Some(_)) => Origin::Rule("those tuned for this gear, transferred to this load"),
            (None, _) => Origin::Rule("the default gear's, transferred to this gear and load"),
        }
    }
}

/// Comment before a section.
fn heading(path: &str) -> String {
    let text = match path {
        "gear" => "The gear and what it bears.",
        "stiffness" => "Torsion curve: slope k1 up to the torque t1, k2 up to t2, k3 beyond.",
        "hysteresis" => "Hysteresis of the torsion curve.",
        "kinematic_error" => {
            "Position error of the ideal gear, amplitude*sin(order*angle + phase) at the output."
        }
        "kinematic_error.wave_generator" => "Over the wave generator's angle relative to the case.",
        "flexspline" => "The cup.",
        "inertia" => "Inertia of both sides.",
        "damping" => "Damping of the torsion.",
        "friction.input" => "Friction at the wave generator.",
        "friction.output" => "Friction at the output.",
        "motor" => "Limits of the motor.",
        "drive" => "From torque command to torque.",
        "tolerances" => "How well the parameters above are known, as largest relative deviations.",
        "sensors" => "Sensors of the joint.",
        "feedback" => "The compensator's cascade at the motor: position P over velocity PI.",
        "compensation" => "The compensator's functions.",
        "baselines.b0" => "Baseline B0, which pil compares with: the cascade alone.",
        "baselines.b1" => "Baseline B1: with a rigid joint's feed-forward.",
        "baselines.b2" => "Baseline B2: with kinematic error and wind-up put in advance.",
        "baselines.b3" => "Baseline B3: with the output's error fed back too.",
        // A table without a line of its own.
        _ => "",
    };
    format!("\n# {text}\n")
}

fn catalogue_line(model: Model, name: &str) -> (&'static str, Origin) {
    match name {
        "name" => ("name of the joint", Origin::Chosen),
        "ratio" => ("N, teeth of the flexspline over the difference of teeth", Origin::Chosen),
        "arrangement" => (
            "or flexspline_fixed: the circular spline is the output",
            Origin::Rule("the usual arrangement, the flexspline is the output"),
        ),
        "rated_torque_nm" => ("at the output", Origin::rated_torque(model)),
        "peak_torque_nm" => ("at the output", Origin::Rule("157/67 of the rated torque")),
        "t1_nm" | "t2_nm" => ("knee", Origin::knees(model)),
        "width_arcmin" => (
            "full width of the loop at no torque, after the rated torque both ways",
            Origin::Rule("3, 2 and 1 for the ratios 30, 50 and 100"),
        ),
        _ => ("slope", Origin::slopes(model)),
    }
}

fn kinematic_error(name: &str) -> (&'static str, Origin) {
    match name {
        "order" => ("periods in a turn", Origin::Fact("an elliptic wave generator has even orders")),
        "phase_rad" => ("phase", Origin::Unknown),
        "flexspline" => ("orders of the angle relative to the flexspline", Origin::Unknown),
        _ => ("at the output", Origin::Rule("0.34 and 0.07 of the catalogue's positional accuracy")),
    }
}

fn cup(name: &str) -> (&'static str, Origin) {
    let shape = Origin::Rule("the default gear's cup, linear with the size");
    match name {
        "radius_m" => ("radius", shape),
        "length_m" => ("length", shape),
        "wall_m" => ("thickness of the wall", shape),
        "ellipse_m" => ("radial displacement at the ellipse's major axis", shape),
        "youngs_modulus_pa" => ("Young's modulus", Origin::Fact("steel")),
        "poisson_ratio" => ("Poisson's ratio", Origin::Fact("steel")),
        "density_kg_per_m3" => ("density", Origin::Fact("steel")),
        "hardening" => ("where the hardening lies, \"contact\" or \"bends\"", Origin::Fact("the default")),
        "bend_hardening" => ("hardening of the mesh's bend links", Origin::Fact("0: linear links")),
        _ => ("strain from which on they harden no more", Origin::Fact("0: linear links")),
    }
}

/// `read` is the origin of what catalogues have.
fn input_friction(name: &str, read: Origin) -> (&'static str, Origin) {
    match name {
        "coulomb_nm" => ("Coulomb friction", Origin::Rule("0.72 of the static friction")),
        "static_nm" => ("static friction, the starting torque", read),
        "viscous_nm_s_per_rad" => {
            ("viscous friction, what Coulomb friction leaves of the running torque", read)
        }
        "load_driving" => ("level over torque while the motor drives the load, from the efficiency", read),
        "load_driven" => {
            ("level over torque while the load drives the motor", Origin::Rule("as load_driving"))
        }
        _ => sliding(name),
    }
}

fn output_friction(name: &str) -> (&'static str, Origin) {
    match name {
        "coulomb_nm" => ("Coulomb friction", Origin::Rule("0.5 % of the rated torque")),
        "static_nm" => ("static friction, at break-away", Origin::Rule("1.3 times the Coulomb friction")),
        "viscous_nm_s_per_rad" => ("viscous friction", Origin::Rule("4 s/rad times the Coulomb friction")),
        _ => sliding(name),
    }
}

fn sliding(name: &str) -> (&'static str, Origin) {
    match name {
        "model" => ("friction model", Origin::Fact("Bliman-Sorine of order 2, which the firmware has")),
        "stribeck_rad_per_s" => ("Stribeck speed", Origin::Default),
        "stribeck_exponent" => ("exponent of the Stribeck curve", Origin::Default),
        "presliding_rad" => ("distance of presliding", Origin::Default),
        _ => ("ratio of the two distances of presliding", Origin::Default),
    }
}

fn sensor(name: &str) -> (&'static str, Origin) {
    match name {
        "motor_encoder_bits" => ("bits a revolution", Origin::Default),
        "output_torque" => ("true: there is a torque sensor at the output", Origin::Default),
        "motor_torque_noise_nm" => {
            ("standard deviation at the shaft", Origin::Rule("1 % of the rated torque over N"))
        }
        _ => ("standard deviation", Origin::Rule("1 % of the rated torque")),
    }
}

fn gain(name: &str, origin: Origin) -> (&'static str, Origin) {
    let meaning = match name {
        "position_bandwidth_hz" => "bandwidth of the position loop",
        "velocity_bandwidth_hz" => "bandwidth of the velocity loop",
        "integral_time_s" => "integral time of the velocity loop",
        "speed_filter_factor" => "corner of the speed's low pass over the velocity bandwidth",
        "friction_gain" => "fraction of the friction that is fed forward",
        "output_proportional" => "P of the output's error",
        "output_integral_per_s" => "I of the output's error",
        "output_derivative_s" => "D of the output's error",
        _ => "corner of its low pass",
    };
    (meaning, origin)
}

/// Keys of the motor, its drive, and what is known of the joint.
fn joint(name: &str) -> (&'static str, Origin) {
    match name {
        "torsion_mode_ratio" => ("modal damping ratio", Origin::Default),
        "peak_torque_nm" => ("at the shaft", Origin::Rule("1.5 times the gear's peak torque over N")),
        "rotor_speed_limit_rad_per_s" => (
            "limit of the rotor's speed",
            Origin::Rule("5600 revolutions a minute for size 25, with size^-0.62"),
        ),
        "delay_periods" => ("longest delay beyond the control's own, in control periods", Origin::Default),
        "current_loop_least_hz" => ("least bandwidth of the current loop", Origin::Default),
        "current_loop_largest_hz" => ("largest bandwidth of the current loop", Origin::Default),
        "torque_constant_tolerance" => ("of the torque constant", Origin::Default),
        "rotor_inertia" => ("of J_wg", Origin::Default),
        "load_inertia" => ("of J_fs", Origin::Default),
        "stiffness" => ("of k1, k2, k3 by one factor", Origin::Default),
        "friction" => ("of the friction of either side", Origin::Default),
        _ => ("fraction of the friction that is fed forward", Origin::Default),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::design::buildable::buildable;

    fn read(joint: &NewJoint) -> GearFile {
        let text = joint.text();
        GearFile::parse(Path::new("new.toml"), text.as_bytes())
            .unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    fn joint(size: u32, ratio: i32) -> NewJoint {
        NewJoint { model: Model { size, ratio }, load: None }
    }

    #[test]
    fn a_gear_of_the_catalogue_is_its_file() {
        for file in FILES {
            assert_eq!(read(&NewJoint { model: file.model, load: None }), file.gear());
        }
    }

    /// Ends, sizes that are made and some between.
    #[test]
    fn every_size_and_ratio_is_a_joint_that_can_be_built() {
        for size in [8, 9, 14, 19, 20, 25, 32, 40, 65, 100] {
            for ratio in [30, 39, 50, 64, 80, 100, 121, 160] {
                let file = read(&joint(size, ratio));
                buildable(&file).unwrap_or_else(|why| panic!("{size}-{ratio}: {why}"));
            }
        }
    }

    #[test]
    fn every_key_and_every_section_has_its_comment() {
        for joint in [joint(25, 80), joint(19, 47), NewJoint { load: Some(0.8), ..joint(100, 160) }] {
            let text = joint.text();
            for (line, after) in text.lines().zip(text.lines().skip(1)) {
                let keyed = line.contains(" = ") && !line.starts_with('#');
                assert!(
                    !keyed || line.contains("  # ") && line.split("  # ").nth(1).unwrap().contains("; "),
                    "{line}"
                );
                // The first entry of a list has the comment of all.
                let section = after.starts_with('[') && !after.starts_with("[[");
                assert!(!section || (line.starts_with("# ") && line.len() > 5), "{line}\n{after}");
            }
        }
    }

    #[test]
    fn what_no_catalogue_has_says_so() {
        let line = |joint: NewJoint, key: &str| {
            let text = joint.text();
            text.lines().find(|line| line.starts_with(key)).unwrap_or_else(|| panic!("{key}")).to_owned()
        };
        assert!(line(joint(14, 100), "k1_nm").ends_with("# N m/rad; slope; catalogue"));
        assert!(line(joint(19, 100), "k1_nm").ends_with("; interpolated: size 20 times 0.950^3"));
        assert!(
            line(joint(50, 120), "k1_nm").ends_with("; extrapolated: size 32 times 1.562^3 at ratio 100")
        );
        assert!(line(joint(25, 80), "rated_torque_nm").contains("interpolated: a power of the ratio"));
        assert!(line(joint(25, 100), "peak_torque_nm").contains("rule of thumb: "));
        assert!(
            line(NewJoint { load: Some(0.8), ..joint(25, 100) }, "flexspline_kg_m2 = 0.8")
                .ends_with("as chosen")
        );
    }
}
