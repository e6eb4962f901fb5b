//! Keys that no table of keys has, each with the known key that is most alike.

use toml::{Table, Value};

use super::super::keys::Key;
use super::{Fault, join, shown_after};

/// Every unknown key or table of a file that has these `keys`.
pub(super) fn faults(file: &Table, keys: &'static [Key]) -> Vec<Fault> {
    let mut faults = Vec::new();
    Known(keys).in_table(file, "", "", &mut faults);
    faults
}

/// `path` is a table that holds known keys.
pub(in crate::io::gear_file) fn is_table(path: &str, keys: &'static [Key]) -> bool {
    Known(keys).is_table(path)
}

/// The known keys.
struct Known(&'static [Key]);

impl Known {
    /// `known` is the table's path as the table of keys writes it, `shown` as the message does (`[]` is `[2]` there).
    fn in_table(&self, table: &Table, known: &str, shown: &str, faults: &mut Vec<Fault>) {
        for (name, value) in table {
            let (known, shown) = (join(known, name), join(shown, name));
            match value {
                Value::Table(inner) if self.is_table(&known) => self.in_table(inner, &known, &shown, faults),
                Value::Array(items) if self.is_table(&format!("{known}[]")) => {
                    self.in_list(items, &known, &shown, faults);
                }
                _ if self.is_known(&known) => {}
                _ => faults.push(Fault { line: self.unknown(&shown, value), path: shown }),
            }
        }
    }

    fn in_list(&self, items: &[Value], known: &str, shown: &str, faults: &mut Vec<Fault>) {
        for (index, item) in items.iter().enumerate() {
            if let Value::Table(inner) = item {
                self.in_table(inner, &format!("{known}[]"), &format!("{shown}[{index}]"), faults);
            }
        }
    }

    fn is_table(&self, path: &str) -> bool {
        self.0.iter().any(|key| key.path.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')))
    }

    /// `path` is a key, a table or a list.
    fn is_known(&self, path: &str) -> bool {
        let follows = |rest: &str| matches!(rest.chars().next(), None | Some('.' | '['));
        self.0.iter().any(|key| key.path.strip_prefix(path).is_some_and(follows))
    }

    fn unknown(&self, path: &str, value: &Value) -> String {
        let nearest = self.nearest(path);
        let allowed = match self.0.iter().find(|key| key.path == nearest) {
            Some(key) => format!(" ({})", key.allowed),
            None => String::new(),
        };
        format!("unknown key {path}{}; the nearest known key is {nearest}{allowed}", shown_after(value))
    }

    /// The known key or table whose name is most alike: both its last part and its whole path count, so
    /// that a slip inside a table finds its neighbour and a key in the wrong table finds the right one.
    fn nearest(&self, path: &str) -> &'static str {
        let alike = |known: &str| {
            strsim::jaro_winkler(last_part(path), last_part(known)) + 0.5 * strsim::jaro_winkler(path, known)
        };
        let best = self.known_paths().max_by(|a, b| alike(a).total_cmp(&alike(b)));
        best.unwrap_or(self.0[0].path)
    }

    /// Every key and every table above it.
    fn known_paths(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().flat_map(|key| {
            let tables = key.path.match_indices('.').map(|(end, _)| key.path[..end].trim_end_matches("[]"));
            tables.chain([key.path])
        })
    }
}

fn last_part(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}
