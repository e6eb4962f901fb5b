//! The values of a file's keys: there, of the right type, in range.

use std::ops::RangeInclusive;

use strainwave::hysteresis::table::TABLE_LEVELS;
use toml::{Table, Value};

use super::{Fault, join, number, shown_after};
use crate::io::keyed_file::key::{
    Allowed, Key, LONGEST_TEXT, MOST_ENTRIES, Schema, in_single_precision, section_of,
};

/// Adds what is wrong with the value of every key, in the order of the table of keys; not of sections that are left out and may be.
pub(super) fn faults(file: &Table, schema: &Schema, faults: &mut Vec<Fault>) {
    let left_out = |section: &str| schema.optional_sections.contains(&section) && !file.contains_key(section);
    for key in schema.keys.iter().filter(|key| !left_out(section_of(key.path))) {
        let mut found = Vec::new();
        for (path, value) in find(file, key, &mut found) {
            if let Err(line) = check_value(&path, value, key.allowed) {
                found.push(Fault { path, line });
            }
        }
        // A table of the wrong type is met again by each of its keys.
        found.retain(|fault| !faults.contains(fault));
        faults.append(&mut found);
    }
}

type Tables<'a> = Vec<(String, &'a Table)>;

/// The values at a key, each with its path: one, or one an entry of the list that it is in.
fn find<'a>(file: &'a Table, key: &Key, faults: &mut Vec<Fault>) -> Vec<(String, &'a Value)> {
    let mut tables = vec![(String::new(), file)];
    let (parents, name) = key.path.rsplit_once('.').unwrap_or(("", key.path));
    for part in parents.split('.') {
        tables = match part.strip_suffix("[]") {
            Some(list) => enter_list(&tables, list, faults),
            None => enter_table(&tables, part, key, faults),
        };
    }
    let mut found = Vec::new();
    for (parent, table) in tables {
        let path = join(&parent, name);
        match table.get(name) {
            Some(value) => found.push((path, value)),
            None if key.optional => {}
            None => faults.push(missing(path, key.allowed)),
        }
    }
    found
}

fn enter_table<'a>(tables: &Tables<'a>, name: &str, key: &Key, faults: &mut Vec<Fault>) -> Tables<'a> {
    let mut entered = Vec::new();
    for (parent, table) in tables {
        let path = join(parent, name);
        match table.get(name) {
            Some(Value::Table(inner)) => entered.push((path, inner)),
            Some(other) => faults.push(Fault { line: wrong_type(&path, other, "a table"), path }),
            None if key.optional || key.path.contains("[]") => {}
            None => faults.push(missing(key.path.to_owned(), key.allowed)),
        }
    }
    entered
}

/// The entries of a list of tables, which the file may leave out.
fn enter_list<'a>(tables: &Tables<'a>, name: &str, faults: &mut Vec<Fault>) -> Tables<'a> {
    let mut entered = Vec::new();
    for (parent, table) in tables {
        let path = join(parent, name);
        match table.get(name) {
            None => {}
            Some(Value::Array(items)) if items.len() > MOST_ENTRIES => {
                let line = format!("{path} has {} entries; allowed: at most {MOST_ENTRIES}", items.len());
                faults.push(Fault { path, line });
            }
            Some(Value::Array(items)) => entered.append(&mut enter_items(&path, items, faults)),
            Some(other) => faults.push(Fault { line: wrong_type(&path, other, "a list of tables"), path }),
        }
    }
    entered
}

fn enter_items<'a>(path: &str, items: &'a [Value], faults: &mut Vec<Fault>) -> Tables<'a> {
    let mut entered = Vec::new();
    for (index, item) in items.iter().enumerate() {
        let path = format!("{path}[{index}]");
        match item {
            Value::Table(inner) => entered.push((path, inner)),
            other => faults.push(Fault { line: wrong_type(&path, other, "a table"), path }),
        }
    }
    entered
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
    if let (Allowed::Triangle(least, most, _), Value::Array(rows)) = (allowed, value) {
        return check_triangle(path, rows, least..=most).map_err(|why| format!("{why}; allowed: {allowed}"));
    }
    if let (Allowed::Numbers(most, ..), Value::Array(items)) = (allowed, value) {
        return check_list(path, items, most, allowed);
    }
    if holds(allowed, value) { Ok(()) } else { Err(out_of_range(path, value, allowed)) }
}

fn check_triangle(path: &str, rows: &[Value], range: RangeInclusive<f64>) -> Result<(), String> {
    if !(2..=TABLE_LEVELS).contains(&rows.len()) {
        return Err(format!("{path} has {} rows", rows.len()));
    }
    for (index, row) in rows.iter().enumerate() {
        let path = format!("{path}[{index}]");
        let numbers = row.as_array().map_or(&[][..], Vec::as_slice);
        if numbers.len() != index + 1 {
            return Err(format!("{path} is not a list of {} numbers", index + 1));
        }
        let inside = |number: f64| range.contains(&number) && in_single_precision(number);
        if let Some(at) = numbers.iter().position(|value| !number(value).is_some_and(inside)) {
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
        Some(at) => Err(out_of_range(&format!("{path}[{at}]"), &items[at], allowed)),
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

/// A range may reach to 0 where f32 does not.
fn out_of_range(path: &str, value: &Value, allowed: Allowed) -> String {
    let vanishes =
        number(value).is_some_and(|number| number.abs() < f32::MIN_POSITIVE.into() && number != 0.0);
    let least = if vanishes {
        format!(", its magnitude at least {:.1e}, the least of f32", f32::MIN_POSITIVE)
    } else {
        String::new()
    };
    format!("{path}{} is out of range; allowed: {allowed}{least}", shown_after(value))
}

fn missing(path: String, allowed: Allowed) -> Fault {
    Fault { line: format!("missing key {path}; allowed: {allowed}"), path }
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
