//! Whether a compensator can be built for a gear file, and the key at fault where none can.
//!
//! Each key is in its own range, but observer and adaptation are designed from all of them: the library refuses a parameter
//! that stands in no file. At fault is taken to be the key whose smallest change, by decades, makes the build succeed;
//! its limit, the others being as they are, is found by bisection of the logarithm.

use std::path::Path;

use strainwave::Error;
use toml::{Table, Value};

use crate::design::joint::joint_params;
use crate::io::gear_file::{GearFile, KEYS, Key};

/// Decades by which a value is changed, either way.
const DECADES: [i32; 6] = [1, 2, 4, 8, 16, 32];
/// Bisections of the interval between a value that fails and one that does not: to 3 digits.
const BISECTIONS: u32 = 18;

/// What limits the use of a file: simulation only, for this reason; `None` when nothing does.
///
/// # Errors
/// As [`buildable`], of a file whose friction the firmware has.
pub fn use_of(file: &GearFile) -> Result<Option<String>, String> {
    match file.require_firmware_friction() {
        Err(why) => Ok(Some(why)),
        Ok(()) => buildable(file).map(|()| None),
    }
}

/// The firmware's compensator can be built from this file.
///
/// # Errors
/// One line that names the key, its value and what is allowed.
pub fn buildable(file: &GearFile) -> Result<(), String> {
    file.require_firmware_friction()?;
    build(file)
        .map_err(|error| blame(file).unwrap_or_else(|| format!("no compensator can be built: {error}")))
}

fn build(file: &GearFile) -> Result<(), Error> {
    joint_params::<f32>(file)?.build().map(|_| ())
}

/// The file with another number at a key builds.
fn builds_with(file: &Table, key: &Key, number: f64) -> bool {
    let mut changed = file.clone();
    if let Some(value) = at(&mut changed, key.path) {
        *value = Value::Float(number);
    }
    let changed = GearFile::parse(Path::new("changed"), changed.to_string().as_bytes());
    changed.is_ok_and(|file| build(&file).is_ok())
}

fn at<'a>(file: &'a mut Table, path: &str) -> Option<&'a mut Value> {
    let (section, name) = path.rsplit_once('.')?;
    let table = section.split('.').try_fold(file, |table, part| table.get_mut(part)?.as_table_mut())?;
    table.get_mut(name)
}

/// A value of a key that fails and one that does not.
struct Culprit {
    key: &'static Key,
    value: f64,
    good: f64,
}

fn blame(file: &GearFile) -> Option<String> {
    let mut table: Table = file.to_toml().parse().ok()?;
    let mut default: Table = GearFile::default_gear().to_toml().parse().ok()?;
    let mut numbers = Vec::new();
    for key in KEYS {
        if let Some(value) = at(&mut table, key.path).and_then(|value| value.as_float()) {
            // 0 has no decades: the default gear's value has.
            let from = if value == 0.0 {
                at(&mut default, key.path).and_then(|value| value.as_float())
            } else {
                Some(value)
            };
            numbers.extend(from.map(|from| (key, value, from)));
        }
    }
    let decades = DECADES.into_iter().flat_map(|decade| [decade, -decade]);
    let mut trials =
        decades.flat_map(|decade| numbers.iter().map(move |number| (number, 10f64.powi(decade))));
    let culprit = trials.find_map(|((key, value, from), factor)| {
        let good = from * factor;
        builds_with(&table, key, good).then_some(Culprit { key, value: *value, good })
    })?;
    Some(culprit.describe(&table))
}

impl Culprit {
    /// The value nearest to the one that fails with which the file builds, to 3 digits.
    fn limit(&self, file: &Table) -> f64 {
        let (mut bad, mut good) = (self.value, self.good);
        for _ in 0..BISECTIONS {
            // From 0 on there is no logarithm.
            let middle = if bad == 0.0 { 0.1 * good } else { (bad * good).sqrt() };
            if builds_with(file, self.key, middle) { good = middle } else { bad = middle }
        }
        good
    }

    fn describe(&self, file: &Table) -> String {
        let Self { key, value, good } = self;
        let end = if good > value { "from" } else { "up to" };
        let unit = key.allowed.unit().map(|unit| format!(" {unit}")).unwrap_or_default();
        let limit = self.limit(file);
        format!(
            "{} = {value:?} is out of range; allowed, with the other keys as they are: {end} {limit:.3e}{unit}",
            key.path
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(change: impl Fn(&mut GearFile)) -> String {
        let mut file = GearFile::default_gear();
        change(&mut file);
        file.check().unwrap();
        buildable(&file).unwrap_err()
    }

    #[test]
    fn the_key_at_fault_is_named_with_its_limit() {
        assert_eq!(buildable(&GearFile::default_gear()), Ok(()));
        let line = refused(|file| file.stiffness.k1 = 3.0);
        assert!(
            line.starts_with("stiffness.k1_nm_per_rad = 3.0 is out of range; allowed, with the other"),
            "{line}"
        );
        let limit: f64 = line.split("from ").nth(1).unwrap().trim_end_matches(" N m/rad").parse().unwrap();
        let with = |k1: f64| {
            let mut file = GearFile::default_gear();
            file.stiffness.k1 = k1;
            buildable(&file).is_ok()
        };
        assert!(with(1.01 * limit) && !with(0.9 * limit), "{line}");
        let line = refused(|file| file.tolerances.stiffness = 0.0);
        assert!(line.starts_with("tolerances.stiffness = 0.0 is out of range; "), "{line}");
        let line = refused(|file| file.compensation.external_torque_wander = Some(1e-30));
        assert!(line.starts_with("compensation.external_torque_wander_nm_per_sqrt_s = 1e-30 is"), "{line}");
    }

    #[test]
    fn another_friction_model_is_not_for_the_firmware() {
        let line = refused(|file| file.friction.input.model = strainwave::friction::ModelName::Coulomb);
        assert!(line.starts_with("friction.input.model = \"coulomb\" is not in the firmware"), "{line}");
    }
}
