//! Who a joint is, and what it has learnt.

use std::path::Path;

use strainwave::compensator::adapt::learning;
use strainwave::compensator::words::{LAYOUT, identity};
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::Learnt;
use strainwave_desktop::{BadInput, Figure, GearFile};
use strainwave_service::tuning::client::Counts;
use strainwave_service::tuning::{Hello, Refusal};

use super::quantities;

/// A joint in a line.
pub fn describe(hello: &Hello) -> String {
    let store = Refusal::Store(hello.store).reason();
    format!("{}, joint {:08x}, control {} Hz, {store}", hello.gear(), hello.joint, hello.rate)
}

/// The joint that the user expects.
pub struct Expected {
    gear: GearFile,
    text: String,
    /// Checksum of its constants.
    joint: u32,
}

impl Expected {
    /// The joint of a gear file.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        let (gear, text) = GearFile::read_with_text(path)?;
        buildable(&gear).map_err(|why| BadInput::new(path, why))?;
        let params = joint_params::<f32>(&gear).map_err(|why| BadInput::new(path, why))?;
        let built = params.build().map_err(|why| BadInput::new(path, why))?;
        Ok(Self { joint: identity(&built.to_words()), gear, text })
    }

    /// Its gear file.
    pub fn gear(&self) -> &GearFile {
        &self.gear
    }

    /// Refuses another joint than this.
    pub fn require(&self, hello: &Hello) -> Result<(), String> {
        require_layout(hello)?;
        if hello.joint == self.joint {
            return Ok(());
        }
        let (name, joint) = (&self.gear.gear.name, self.joint);
        Err(format!(
            "the joint is {} {:08x}, not {name} {joint:08x} of the gear file: its firmware was built with another",
            hello.gear(),
            hello.joint
        ))
    }

    /// Writes the gear file with what was learnt.
    pub fn keep(&self, learnt: &learning::Learnt<f32>, path: &Path) -> Result<(), BadInput> {
        Learnt::of(learnt).keep_in(&self.text, path)
    }
}

/// Refuses a joint whose constants and learnt words this program cannot read.
pub fn require_layout(hello: &Hello) -> Result<(), String> {
    let layout = hello.layout;
    if layout == LAYOUT {
        return Ok(());
    }
    Err(format!(
        "the joint's constants have layout {layout:08x}, those of this program {LAYOUT:08x}: its firmware has another version"
    ))
}

/// What was learnt, by the keys of a gear file.
fn entries(learnt: &learning::Learnt<f32>) -> Vec<(String, serde_json::Value)> {
    let value = serde_json::to_value(Learnt::of(learnt)).unwrap_or_default();
    let serde_json::Value::Object(entries) = value else { return Vec::new() };
    entries.into_iter().collect()
}

/// What was learnt, a line each.
pub fn listed(learnt: &learning::Learnt<f32>) -> String {
    let lines = entries(learnt).into_iter().map(|(key, value)| format!("    {key} = {value}"));
    lines.collect::<Vec<_>>().join("\n")
}

/// Figures of what the store holds: the number of its record and the factors.
pub fn stored(number: u32, learnt: &learning::Learnt<f32>) -> Vec<Figure> {
    let number = Figure::reported("connect.stored.record", number.into(), "1");
    let factors = entries(learnt).into_iter().filter_map(|(key, value)| {
        Some(Figure::reported(format!("connect.stored.{key}"), value.as_f64()?, "1"))
    });
    [number].into_iter().chain(factors).collect()
}

/// Figures of the readings, with the quantities of the last one.
pub fn read(count: u64, missing: u64, last: &[f64]) -> Vec<Figure> {
    let counts = [("connect.readings", count), ("connect.missing", missing)];
    let counts = counts.into_iter().map(|(name, count)| Figure::reported(name, count as f64, "1"));
    let last = quantities::all().zip(last).map(|((name, unit), value)| {
        Figure::reported(format!("connect.last.{name}"), *value, unit.replace("nm", "N m").replace('_', "/"))
    });
    counts.chain(last).collect()
}

/// Figures of the link.
pub fn counted(counts: &Counts) -> [Figure; 3] {
    [
        ("connect.requests", counts.requests),
        ("connect.repeated", counts.repeated),
        ("connect.damaged", counts.damaged),
    ]
    .map(|(name, count)| Figure::reported(name, count as f64, "1"))
}
