//! Keys that no file of its kind has, each with the known key that is most alike.

use toml::{Table, Value};

use super::{Fault, join, shown_after};
use crate::io::keyed_file::key::Key;

/// Every unknown key or table of the file.
pub(super) fn faults(file: &Table, keys: &'static [Key]) -> Vec<Fault> {
    let mut faults = Vec::new();
    in_table(keys, file, ["", ""], &mut faults);
    faults
}

/// `known` is the table's path as `keys` writes it, `shown` as the message does (`[]` is `[2]` there).
fn in_table(keys: &'static [Key], table: &Table, [known, shown]: [&str; 2], faults: &mut Vec<Fault>) {
    for (name, value) in table {
        let (known, shown) = (join(known, name), join(shown, name));
        match value {
            Value::Table(inner) if is_table(keys, &known) => in_table(keys, inner, [&known, &shown], faults),
            Value::Array(items) if is_table(keys, &format!("{known}[]")) => {
                in_list(keys, items, [&known, &shown], faults);
            }
            _ if is_known(keys, &known) => {}
            _ => faults.push(Fault { line: unknown(keys, &shown, value), path: shown }),
        }
    }
}

fn in_list(keys: &'static [Key], items: &[Value], [known, shown]: [&str; 2], faults: &mut Vec<Fault>) {
    for (index, item) in items.iter().enumerate() {
        if let Value::Table(inner) = item {
            in_table(keys, inner, [&format!("{known}[]"), &format!("{shown}[{index}]")], faults);
        }
    }
}

/// `path` is a table that holds known keys.
fn is_table(keys: &[Key], path: &str) -> bool {
    keys.iter().any(|key| key.path.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')))
}

/// `path` is a key, a table or a list.
fn is_known(keys: &[Key], path: &str) -> bool {
    keys.iter().any(|key| {
        key.path.strip_prefix(path).is_some_and(|rest| matches!(rest.chars().next(), None | Some('.' | '[')))
    })
}

fn unknown(keys: &'static [Key], path: &str, value: &Value) -> String {
    let nearest = nearest(keys, path);
    let allowed = match keys.iter().find(|key| key.path == nearest) {
        Some(key) => format!(" ({})", key.allowed),
        None => String::new(),
    };
    format!("unknown key {path}{}; the nearest known key is {nearest}{allowed}", shown_after(value))
}

/// The known key or table whose name is most alike: both its last part and its whole path count, so
/// that a slip inside a table finds its neighbour and a key in the wrong table finds the right one.
fn nearest(keys: &'static [Key], path: &str) -> &'static str {
    let alike = |known: &str| {
        strsim::jaro_winkler(last_part(path), last_part(known)) + 0.5 * strsim::jaro_winkler(path, known)
    };
    let best = known_paths(keys).max_by(|a, b| alike(a).total_cmp(&alike(b)));
    best.unwrap_or(keys[0].path)
}

/// Every key and every table above it.
fn known_paths(keys: &'static [Key]) -> impl Iterator<Item = &'static str> {
    keys.iter().flat_map(|key| {
        let tables = key.path.match_indices('.').map(|(end, _)| key.path[..end].trim_end_matches("[]"));
        tables.chain([key.path])
    })
}

fn last_part(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}
