//! The table of bounds itself: unique names, no row without a measurement, none too loose.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use strainwave_desktop::verify::Part;
use strainwave_desktop::verify::bounds::{self, BOUNDS, FLOORS};

#[test]
fn rows_are_unique_and_complete() {
    let mut names = HashSet::new();
    for bound in BOUNDS.into_iter().flatten().chain(FLOORS) {
        assert!(names.insert(bound.name), "{} stands there twice", bound.name);
        let parts: Vec<_> = bound.name.split('.').collect();
        let plain = |part: &&str| {
            !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        };
        assert!(parts.len() >= 2 && parts.iter().all(plain), "{} is not a dotted name", bound.name);
        assert!(bound.value.is_finite() && bound.value >= 0.0, "{}", bound.name);
        assert!(!bound.unit.is_empty() && bound.why.len() > 10, "{} lacks its unit or reason", bound.name);
    }
}

#[test]
fn a_missed_target_is_reported() {
    for (name, target) in bounds::TARGETS {
        let mut rows = BOUNDS.into_iter().flatten().chain(FLOORS);
        let bound = rows.find(|row| row.name == *name).unwrap_or_else(|| panic!("{name} is no bound"));
        let is_looser = if bounds::is_floor(name) { bound.value < *target } else { bound.value > *target };
        assert!(is_looser && bound.why.contains("; target "), "{name}");
        assert_eq!(bounds::misses_target(&bound.figure(*target)), None);
        let line = bounds::misses_target(&bound.figure(bound.value)).unwrap();
        assert!(line.contains(name) && line.contains(&format!("target {target}, missed")), "{line}");
    }
}

/// Every Rust file of the repository but the table and this test, both of which are named `bounds`.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with('.') || ["target", "bounds", "bounds.rs"].contains(&name.as_str()) {
            continue;
        }
        if path.is_dir() {
            sources(&path, found);
        } else if name.ends_with(".rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_row_is_measured_somewhere() {
    let mut files = vec![];
    sources(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")), &mut files);
    let text: String = files.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    for bound in BOUNDS.into_iter().flatten().chain(FLOORS) {
        assert!(text.contains(&format!("\"{}\"", bound.name)), "nothing measures {}", bound.name);
    }
}

/// The other parts are measured for the page of `strainwave report`, which a test of the command requires to hold, and all
/// of them by `verify`.
#[test]
fn every_quick_figure_of_the_compensator_holds_and_its_bound_is_tight() {
    for figure in Part::Compensator.measure().unwrap().figures {
        assert!(figure.holds, "{figure:?}");
        let bound = bounds::find(&figure.name).unwrap();
        assert!(!bound.is_loose(figure.value), "{figure:?} is far below its bound");
    }
}

#[test]
fn a_figure_holds_up_to_its_bound_and_nan_never() {
    let bound = bounds::Bound { name: "a.b", value: 2.0, unit: "1", why: "an example" };
    assert!(bound.figure(2.0).holds && !bound.figure(2.1).holds && !bound.figure(f64::NAN).holds);
    assert!(bound.is_loose(0.19) && !bound.is_loose(0.21));
}

#[test]
fn a_floor_holds_from_its_value_on_and_nan_never() {
    let [floor, ..] = FLOORS else { panic!("no floor") };
    let holds = |value| bounds::figure(floor.name, value).holds;
    assert!(holds(floor.value) && holds(2.0 * floor.value));
    assert!(!holds(0.99 * floor.value) && !holds(f64::NAN));
}
