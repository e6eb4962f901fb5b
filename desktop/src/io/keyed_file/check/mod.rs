//! A parsed file against its table of keys: everything that is wrong with it, a line each.

mod unknown;
mod values;

use strainwave::friction::ModelName;
use strainwave::friction::data::MOST_STATES;
use toml::{Table, Value};

use super::key::{Relation, Schema, section_of};

/// One thing that is wrong with a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    /// Path of the key in the file.
    pub path: String,
    /// The key, its value and what is allowed.
    pub line: String,
}

impl Fault {
    /// The section that the key is in.
    pub fn section(&self) -> &str {
        section_of(&self.path)
    }
}

/// Unknown keys first, since a misspelt key is also a missing one; then every key in the table's order; then what the
/// friction models need; then the relations between keys of which each is right by itself.
pub(super) fn faults(file: &Table, schema: &Schema) -> Vec<Fault> {
    let mut faults = unknown::faults(file, schema.keys);
    values::faults(file, schema, &mut faults);
    faults.extend(schema.sides.iter().filter_map(|side| missing_need(file, schema, side)));
    let sound = |path: &str| !faults.iter().any(|fault| fault.path == path);
    let relations = schema.relations.iter().filter(|relation| sound(relation.path) && sound(relation.than));
    let unrelated: Vec<_> = relations.filter_map(|relation| violated(file, relation)).collect();
    faults.extend(unrelated);
    faults
}

/// The first key that the friction model of a side needs and that is not there.
fn missing_need(file: &Table, schema: &Schema, side: &str) -> Option<Fault> {
    let friction = file.get("friction")?.get(side)?;
    let model = friction.get("model").and_then(Value::as_str).and_then(ModelName::of_word)?;
    let name = model.needs().find(|name| friction.get(name).is_none())?;
    let path = format!("friction.{side}.{name}");
    Some(Fault { line: needed(schema, &path, side, model), path })
}

/// A key, or the list of its table's entries.
fn needed(schema: &Schema, path: &str, side: &str, model: ModelName) -> String {
    let allowed = schema.keys.iter().find(|key| key.path == path).map(|key| key.allowed.to_string());
    let allowed = allowed.unwrap_or_else(|| format!("a list of 1 to {MOST_STATES} tables"));
    format!("missing key {path}, which friction.{side}.model = {:?} needs; allowed: {allowed}", model.word())
}

fn violated(file: &Table, relation: &Relation) -> Option<Fault> {
    let (value, other) = (number_at(file, relation.path)?, number_at(file, relation.than)?);
    let line = || format!("{} = {value} is out of range; allowed: {relation} = {other}", relation.path);
    (!relation.holds(value, other)).then(|| Fault { path: relation.path.into(), line: line() })
}

fn number_at(file: &Table, path: &str) -> Option<f64> {
    let mut parts = path.split('.');
    let first = file.get(parts.next()?)?;
    number(parts.try_fold(first, |value, part| value.get(part))?)
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(whole) => Some(*whole as f64),
        Value::Float(number) => Some(*number),
        _ => None,
    }
}

/// A name that TOML would have to quote is quoted, so that no dot of its own can make it a path.
fn join(parent: &str, name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    let name = if bare { name.to_owned() } else { format!("{name:?}") };
    if parent.is_empty() { name } else { format!("{parent}.{name}") }
}

/// ` = value`, shortened; nothing for tables and lists, whose text would bury the message.
fn shown_after(value: &Value) -> String {
    const LONGEST: usize = 40;
    let text = match value {
        Value::Table(_) | Value::Array(_) => return String::new(),
        Value::String(text) => format!("{text:?}"),
        other => other.to_string(),
    };
    match value {
        _ if text.chars().count() <= LONGEST => format!(" = {text}"),
        Value::Float(number) => format!(" = {number:e}"),
        _ => format!(" = {}...", text.chars().take(LONGEST).collect::<String>()),
    }
}
