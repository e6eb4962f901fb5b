//! A parsed gear file against the table of keys: the first thing wrong with it, as one line.

use toml::{Table, Value};

use strainwave::friction::ModelName;
use strainwave::friction::data::MOST_STATES;
use strainwave::hysteresis::table::TABLE_LEVELS;

use super::keys::{Allowed, KEYS, Key, LONGEST_TEXT, MOST_ORDERS, RELATIONS};

/// Unknown keys first, since a misspelt key is also a missing one; then every key in the table's
/// order; then what the friction models need; then the relations between keys.
pub(super) fn check(file: &Table) -> Result<(), String> {
    refuse_unknown(file, "", "")?;
    for key in KEYS {
        for (path, value) in find(file, key)? {
            check_value(&path, value, key.allowed)?;
        }
    }
    for side in ["input", "output"] {
        check_needs(file, side)?;
    }
    check_relations(file)
}

/// The keys that the friction model of a side needs are there.
fn check_needs(file: &Table, side: &str) -> Result<(), String> {
    let friction = &file["friction"][side];
    let model = friction["model"].as_str().and_then(ModelName::of_word);
    let missing = model.and_then(|model| model.needs().find(|name| friction.get(name).is_none()));
    match (model, missing) {
        (Some(model), Some(name)) => Err(needed(&format!("friction.{side}.{name}"), side, model)),
        _ => Ok(()),
    }
}

/// A key, or the list of its table's entries.
fn needed(path: &str, side: &str, model: ModelName) -> String {
    let allowed = KEYS.iter().find(|key| key.path == path).map(|key| key.allowed.to_string());
    let allowed = allowed.unwrap_or_else(|| format!("a list of 1 to {MOST_STATES} tables"));
    format!("missing key {path}, which friction.{side}.model = {:?} needs; allowed: {allowed}", model.word())
}

/// `known` is the table's path as [`KEYS`] writes it, `shown` as the message does (`[]` is `[2]` there).
fn refuse_unknown(table: &Table, known: &str, shown: &str) -> Result<(), String> {
    for (name, value) in table {
        let (known, shown) = (join(known, name), join(shown, name));
        match value {
            Value::Table(inner) if is_table(&known) => refuse_unknown(inner, &known, &shown)?,
            Value::Array(items) if is_table(&format!("{known}[]")) => {
                refuse_unknown_items(items, &known, &shown)?;
            }
            _ if is_known(&known) => {}
            _ => return Err(unknown(&shown, value)),
        }
    }
    Ok(())
}

fn refuse_unknown_items(items: &[Value], known: &str, shown: &str) -> Result<(), String> {
    for (index, item) in items.iter().enumerate() {
        if let Value::Table(inner) = item {
            refuse_unknown(inner, &format!("{known}[]"), &format!("{shown}[{index}]"))?;
        }
    }
    Ok(())
}

/// A name that TOML would have to quote is quoted, so that no dot of its own can make it a path.
fn join(parent: &str, name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    let name = if bare { name.to_owned() } else { format!("{name:?}") };
    if parent.is_empty() { name } else { format!("{parent}.{name}") }
}

/// `path` is a table that holds known keys.
fn is_table(path: &str) -> bool {
    KEYS.iter().any(|key| key.path.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')))
}

/// `path` is a key, a table or a list.
fn is_known(path: &str) -> bool {
    KEYS.iter().any(|key| {
        key.path.strip_prefix(path).is_some_and(|rest| matches!(rest.chars().next(), None | Some('.' | '[')))
    })
}

fn unknown(path: &str, value: &Value) -> String {
    let nearest = nearest(path);
    let allowed = match KEYS.iter().find(|key| key.path == nearest) {
        Some(key) => format!(" ({})", key.allowed),
        None => String::new(),
    };
    format!("unknown key {path}{}; the nearest known key is {nearest}{allowed}", shown_after(value))
}

/// The known key or table whose name is most alike: both its last part and its whole path count, so
/// that a slip inside a table finds its neighbour and a key in the wrong table finds the right one.
fn nearest(path: &str) -> &'static str {
    let alike = |known: &str| {
        strsim::jaro_winkler(last_part(path), last_part(known)) + 0.5 * strsim::jaro_winkler(path, known)
    };
    let best = known_paths().max_by(|a, b| alike(a).total_cmp(&alike(b)));
    best.unwrap_or(KEYS[0].path)
}

/// Every key and every table above it.
fn known_paths() -> impl Iterator<Item = &'static str> {
    KEYS.iter().flat_map(|key| {
        let tables = key.path.match_indices('.').map(|(end, _)| key.path[..end].trim_end_matches("[]"));
        tables.chain([key.path])
    })
}

fn last_part(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// The values at a key, each with its path: one, or one an entry of the list that it is in.
fn find<'a>(file: &'a Table, key: &Key) -> Result<Vec<(String, &'a Value)>, String> {
    let mut tables = vec![(String::new(), file)];
    let (parents, name) = key.path.rsplit_once('.').unwrap_or(("", key.path));
    for part in parents.split('.') {
        tables = match part.strip_suffix("[]") {
            Some(list) => enter_list(&tables, list)?,
            None => enter_table(&tables, part, key)?,
        };
    }
    let mut found = Vec::new();
    for (parent, table) in tables {
        let path = join(&parent, name);
        match table.get(name) {
            Some(value) => found.push((path, value)),
            None if key.optional => {}
            None => return Err(missing(&path, key.allowed)),
        }
    }
    Ok(found)
}

type Tables<'a> = Vec<(String, &'a Table)>;

fn enter_table<'a>(tables: &Tables<'a>, name: &str, key: &Key) -> Result<Tables<'a>, String> {
    let mut entered = Vec::new();
    for (parent, table) in tables {
        let path = join(parent, name);
        match table.get(name) {
            Some(Value::Table(inner)) => entered.push((path, inner)),
            Some(other) => return Err(wrong_type(&path, other, "a table")),
            None if key.optional || key.path.contains("[]") => {}
            None => return Err(missing(key.path, key.allowed)),
        }
    }
    Ok(entered)
}

/// The entries of a list of tables, which the file may leave out.
fn enter_list<'a>(tables: &Tables<'a>, name: &str) -> Result<Tables<'a>, String> {
    let mut entered = Vec::new();
    for (parent, table) in tables {
        let path = join(parent, name);
        match table.get(name) {
            None => {}
            Some(Value::Array(items)) if items.len() > MOST_ORDERS => {
                return Err(format!("{path} has {} entries; allowed: at most {MOST_ORDERS}", items.len()));
            }
            Some(Value::Array(items)) => entered.append(&mut enter_items(&path, items)?),
            Some(other) => return Err(wrong_type(&path, other, "a list of tables")),
        }
    }
    Ok(entered)
}

fn enter_items<'a>(path: &str, items: &'a [Value]) -> Result<Tables<'a>, String> {
    let enter = |(index, item): (usize, &'a Value)| {
        let path = format!("{path}[{index}]");
        match item {
            Value::Table(inner) => Ok((path, inner)),
            other => Err(wrong_type(&path, other, "a table")),
        }
    };
    items.iter().enumerate().map(enter).collect()
}

fn check_value(path: &str, value: &Value, allowed: Allowed) -> Result<(), String> {
    let right_type = matches!(
        (allowed, value),
        (Allowed::Text | Allowed::Word(_), Value::String(_))
            | (Allowed::Flag, Value::Boolean(_))
            | (Allowed::Whole(..), Value::Integer(_))
            | (Allowed::Number(..), Value::Integer(_) | Value::Float(_))
            | (Allowed::Triangle(..), Value::Array(_))
            | (Allowed::Numbers(..), Value::Array(_))
    );
    if !right_type {
        return Err(wrong_type(path, value, allowed));
    }
    if let (Allowed::Triangle(most, _), Value::Array(rows)) = (allowed, value) {
        return check_triangle(path, rows, most).map_err(|why| format!("{why}; allowed: {allowed}"));
    }
    if let (Allowed::Numbers(most, ..), Value::Array(items)) = (allowed, value) {
        return check_list(path, items, most, allowed);
    }
    if holds(allowed, value) {
        Ok(())
    } else {
        Err(format!("{path}{} is out of range; allowed: {allowed}", shown_after(value)))
    }
}

fn check_triangle(path: &str, rows: &[Value], most: f64) -> Result<(), String> {
    if !(2..=TABLE_LEVELS).contains(&rows.len()) {
        return Err(format!("{path} has {} rows", rows.len()));
    }
    for (index, row) in rows.iter().enumerate() {
        let path = format!("{path}[{index}]");
        let numbers = row.as_array().map_or(&[][..], Vec::as_slice);
        if numbers.len() != index + 1 {
            return Err(format!("{path} is not a list of {} numbers", index + 1));
        }
        let outside = |value: &&Value| !number(value).is_some_and(|number| (0.0..=most).contains(&number));
        if let Some(at) = numbers.iter().position(|value| outside(&value)) {
            return Err(format!("{path}[{at}]{} is out of range", shown_after(&numbers[at])));
        }
    }
    Ok(())
}

fn check_list(path: &str, items: &[Value], most: usize, allowed: Allowed) -> Result<(), String> {
    if !(1..=most).contains(&items.len()) {
        return Err(format!("{path} has {} entries; allowed: {allowed}", items.len()));
    }
    let outside = |item: &Value| !number(item).is_some_and(|number| allowed.holds(number));
    match items.iter().position(outside) {
        None => Ok(()),
        Some(at) => {
            Err(format!("{path}[{at}]{} is out of range; allowed: {allowed}", shown_after(&items[at])))
        }
    }
}

fn holds(allowed: Allowed, value: &Value) -> bool {
    match (allowed, value) {
        (Allowed::Flag, _) => true,
        (Allowed::Text, Value::String(text)) => {
            (1..=LONGEST_TEXT).contains(&text.chars().count()) && !text.chars().any(char::is_control)
        }
        (Allowed::Word(words), Value::String(word)) => words.contains(&word.as_str()),
        _ => number(value).is_some_and(|number| allowed.holds(number)),
    }
}

fn check_relations(file: &Table) -> Result<(), String> {
    for relation in RELATIONS {
        let (Some(value), Some(other)) = (number_at(file, relation.path), number_at(file, relation.than))
        else {
            continue;
        };
        if !relation.holds(value, other) {
            return Err(format!(
                "{} = {value} is out of range; allowed: {relation} = {other}",
                relation.path
            ));
        }
    }
    Ok(())
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

fn missing(path: &str, allowed: Allowed) -> String {
    format!("missing key {path}; allowed: {allowed}")
}

fn wrong_type(path: &str, value: &Value, allowed: impl std::fmt::Display) -> String {
    format!("{path}{} is {}; allowed: {allowed}", shown_after(value), type_name(value))
}

fn type_name(value: &Value) -> &'static str {
    match value {
        Value::String(_) => "text",
        Value::Integer(_) => "a whole number",
        Value::Float(_) => "a number with a fraction",
        Value::Boolean(_) => "true or false",
        Value::Datetime(_) => "a date",
        Value::Array(_) => "a list",
        Value::Table(_) => "a table",
    }
}

/// ` = value`, shortened; nothing for tables and lists, whose text would bury the message.
fn shown_after(value: &Value) -> String {
    const LONGEST: usize = 40;
    let text = match value {
        Value::Table(_) | Value::Array(_) => return String::new(),
        Value::String(text) => format!("{text:?}"),
        other => other.to_string(),
    };
    if text.chars().count() <= LONGEST {
        format!(" = {text}")
    } else {
        format!(" = {}...", text.chars().take(LONGEST).collect::<String>())
    }
}
