//! Every key: required or optional, its type, its range, its relation to others.

use std::collections::BTreeSet;

use strainwave::friction::ModelName;
use strainwave_desktop::io::gear_file::{Allowed, KEYS, RELATIONS};
use toml::{Table, Value};

use super::full::{at, changed, full, set, shown};
use super::parse;

/// Every path of a table, lists as `[]`.
fn paths(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Table(table) => {
            for (name, inner) in table {
                let dot = if path.is_empty() { "" } else { "." };
                paths(inner, &format!("{path}{dot}{name}"), found);
            }
        }
        Value::Array(items) if items.iter().all(Value::is_table) => {
            items.iter().for_each(|item| paths(item, &format!("{path}[]"), found));
        }
        _ => {
            found.insert(path.to_owned());
        }
    }
}

#[test]
fn the_table_of_keys_is_the_type() {
    let mut written = BTreeSet::new();
    paths(&Value::Table(full()), "", &mut written);
    let listed: BTreeSet<_> = KEYS.iter().map(|key| key.path.to_owned()).collect();
    assert_eq!(written, listed);
    assert_eq!(listed.len(), KEYS.len(), "a key is listed twice");
}

#[test]
fn every_key_but_the_optional_ones_is_required() {
    for key in KEYS {
        let mut table = full();
        let (inner, name) = at(&mut table, key.path);
        assert!(inner.remove(name).is_some(), "{} is not in the full gear", key.path);
        let path = shown(key.path);
        let who = needs(key.path).map_or(String::new(), |model| {
            format!(", which {}.model = \"{model}\" needs", &path[..path.rfind('.').unwrap()])
        });
        match parse(&table.to_string()) {
            // Half range and weights come together, and no encoder stands still without its noise.
            Err(line) if line.contains(" without ") => {
                let together = ["hysteresis.", "sensors.motor_encoder_noise_rad"];
                assert!(key.optional && together.iter().any(|path| key.path.starts_with(path)), "{line}");
            }
            Ok(_) => assert!(key.optional && who.is_empty(), "{path} may be left out"),
            Err(line) => {
                assert!(!key.optional || !who.is_empty(), "{line}");
                assert_eq!(line, format!("g.toml: missing key {path}{who}; allowed: {}", key.allowed));
            }
        }
    }
}

/// The full gear's friction model, when it needs the key of a side.
fn needs(path: &str) -> Option<&'static str> {
    let model = ModelName::BlimanSorine2;
    let (_, name) = path.strip_prefix("friction.")?.split_once('.')?;
    model.needs().any(|needed| needed == name).then(|| model.word())
}

#[test]
fn every_key_refuses_every_wrong_type() {
    let values = [
        Value::String("x".into()),
        Value::Boolean(true),
        Value::Integer(1),
        Value::Float(0.5),
        Value::Array(vec![]),
        Value::Table(Table::new()),
    ];
    for key in KEYS {
        for value in &values {
            let fits = matches!(
                (key.allowed, value),
                (Allowed::Text | Allowed::Word(_), Value::String(_))
                    | (Allowed::Flag, Value::Boolean(_))
                    | (Allowed::Whole(..), Value::Integer(_))
                    | (Allowed::Number(..), Value::Integer(_) | Value::Float(_))
                    | (Allowed::Triangle(..), Value::Array(_))
                    | (Allowed::Numbers(..), Value::Array(_))
            );
            if !fits {
                let line = changed(key.path, value.clone()).expect_err(key.path);
                assert!(line.starts_with(&format!("g.toml: {}", shown(key.path))), "{line}");
                assert!(
                    line.contains(" is ") && line.ends_with(&format!("allowed: {}", key.allowed)),
                    "{line}"
                );
            }
        }
    }
}

/// Values of the right type that no key of this kind allows.
fn outside(allowed: Allowed) -> Vec<Value> {
    match allowed {
        Allowed::Whole(least, most) => vec![(least - 1).into(), (most + 1).into(), i64::MIN.into()],
        Allowed::Number(..) => {
            [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300].map(Value::Float).to_vec()
        }
        Allowed::Word(_) | Allowed::Text => vec!["".into(), "a\nb".into(), "z".repeat(200).into()],
        Allowed::Flag | Allowed::Triangle(..) => vec![],
        Allowed::Numbers(most, end, _) => {
            let lists = [vec![], vec![0.0; most + 1], vec![0.0, 1.01 * end], vec![f64::NAN]];
            lists.map(|list| Value::Array(list.into_iter().map(Value::Float).collect())).to_vec()
        }
    }
}

#[test]
fn every_key_refuses_what_is_out_of_range_or_not_finite() {
    for key in KEYS {
        for value in outside(key.allowed) {
            let line = changed(key.path, value).expect_err(key.path);
            assert!(line.ends_with(&format!("; allowed: {}", key.allowed)), "{line}");
            let rest = line.strip_prefix(&format!("g.toml: {}", shown(key.path))).expect(&line);
            let starts: &[&str] = match key.allowed {
                Allowed::Numbers(..) => &[" has ", "[0] = ", "[1] = "],
                _ => &[" = "],
            };
            assert!(starts.iter().any(|start| rest.starts_with(start)), "{line}");
        }
    }
}

/// What vanishes in the controller's f32, or overflows, is refused before a joint is built with it.
#[test]
fn no_number_is_held_that_single_precision_does_not_hold() {
    for key in KEYS.iter().filter(|key| matches!(key.allowed, Allowed::Number(..))) {
        for (value, shown_as) in [(1e-320, "1e-320"), (-1e-320, "-1e-320"), (1e40, "1e40")] {
            let line = changed(key.path, value).expect_err(key.path);
            let expected =
                format!("g.toml: {} = {shown_as} is out of range; allowed: {}", shown(key.path), key.allowed);
            assert!(line.starts_with(&expected), "{line}\n{expected}");
        }
    }
}

#[test]
fn open_ends_are_excluded_and_closed_ends_included() {
    assert!(
        changed("compensation.friction_gain", 0).is_ok() && changed("compensation.friction_gain", 1).is_ok()
    );
    assert!(
        changed("hysteresis.width_arcmin", 0).is_ok() && changed("damping.torsion_mode_ratio", 0).is_ok()
    );
    let line = changed("damping.torsion_mode_ratio", 1).unwrap_err();
    assert!(line.ends_with("allowed: a number from 0 below 1"), "{line}");
    let line = changed("motor.peak_torque_nm", 0).unwrap_err();
    assert!(line.ends_with("allowed: a number above 0 to 10000 N m"), "{line}");
}

#[test]
fn relations_between_keys_hold() {
    for relation in RELATIONS {
        let (path, than) = (relation.path, relation.than);
        let holds = |number: f64| KEYS.iter().any(|key| key.path == path && key.allowed.holds(number));
        // A value of the compared key that leaves the refused one in its own range.
        let mut gear = full();
        let (inner, name) = at(&mut gear, than);
        let candidates = [5e-4, inner[name].as_float().unwrap()];
        let other = candidates.into_iter().find(|other| holds(relation.times * other * 0.99)).expect(path);
        let limit = relation.times * other;
        let refused = |value: f64| {
            let mut table = full();
            set(&mut table, than, other);
            set(&mut table, path, value);
            let expected = format!("g.toml: {path} = {value} is out of range; allowed: {relation} = {other}");
            parse(&table.to_string()).is_err_and(|line| line == expected)
        };
        assert!(refused(limit * 0.99), "{path} below {than}");
        assert_eq!(refused(limit), !relation.or_equal, "{path} at the limit of {than}");
        assert!(!refused(limit * 1.01), "{path} above {than}");
    }
}
