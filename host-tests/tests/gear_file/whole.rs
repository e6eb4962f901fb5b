//! Checks that need the whole gear.

use strainwave_desktop::io::gear_file::DEFAULT;
use toml::Value;

use super::full::changed;
use super::{parse, refusal};

#[test]
fn what_only_the_whole_gear_can_tell_is_refused_by_key() {
    for (from, to, expected) in [
        (
            "k3_nm_per_rad = 5.7e4",
            "k3_nm_per_rad = 1e6",
            "stiffness.k3_nm_per_rad = 1000000 is out of range; allowed: below the cup's own stiffness G*J/l = 1603",
        ),
        (
            "width_arcmin = 1.0",
            "width_arcmin = 6",
            "hysteresis.width_arcmin = 6 is out of range; allowed: below the torsion at rated torque = 5.036",
        ),
        (
            "flexspline_kg_m2 = 1.2",
            "flexspline_kg_m2 = 0.002",
            "inertia.flexspline_kg_m2 = 0.002 is out of range; allowed: above 4*dt^2*K3 = 2.280e-3 kg m^2",
        ),
    ] {
        let line = refusal(from, to);
        assert!(line.starts_with(&format!("g.toml: {expected}")), "{line}");
    }
}

#[test]
fn hardening_in_the_bend_links_is_refused_where_they_cannot_follow() {
    let bends = "density_kg_per_m3 = 7850.0\nhardening = \"bends\"";
    for (more, expected) in [
        (
            "bend_hardening = 1e4",
            "flexspline.bend_saturation = 0 is out of range; allowed: above 0 to 5.745e-2",
        ),
        (
            "bend_hardening = 1e6\nbend_saturation = 0.05",
            "flexspline.bend_saturation = 0.05 is out of range; allowed: above 0 to 5.745e-3",
        ),
    ] {
        let line = refusal("density_kg_per_m3 = 7850.0", &format!("{bends}\n{more}"));
        assert!(line.starts_with(&format!("g.toml: {expected}")), "{line}");
    }
    let line = refusal("density_kg_per_m3 = 7850.0", "density_kg_per_m3 = 7850.0\nhardening = \"teeth\"");
    let expected = "flexspline.hardening = \"teeth\" is out of range; allowed: \"contact\" or \"bends\"";
    assert_eq!(line, format!("g.toml: {expected}"));
    let text = DEFAULT.replace("density_kg_per_m3 = 7850.0", bends);
    let stiff = text.replace("k3_nm_per_rad = 5.7e4", "k3_nm_per_rad = 1.2e5");
    let line = parse(&stiff).unwrap_err();
    assert!(
        line.starts_with("g.toml: stiffness.k3_nm_per_rad = 120000 is out of range; allowed: above"),
        "{line}"
    );
    parse(&text).unwrap();
}

/// The message for a gear with these rows as its weights.
fn weights_refusal(rows: &[&[f64]]) -> String {
    let list = |row: &&[f64]| Value::Array(row.iter().map(|weight| Value::Float(*weight)).collect());
    changed("hysteresis.weights_nm", rows.iter().map(list).collect::<Vec<_>>()).unwrap_err()
}

#[test]
fn weights_are_a_triangle_that_a_gear_can_have() {
    let allowed = "allowed: rows of 1, 2, 3, ... numbers from 0 to 10000 N m, 2 to 24 rows";
    for (rows, expected) in [
        (&[&[1.0][..]][..], "has 1 rows"),
        (&[&[1.0], &[1.0]], "[1] is not a list of 2 numbers"),
        (&[&[1.0], &[1.0, 1.0, 1.0]], "[1] is not a list of 2 numbers"),
        (&[&[1.0], &[-1.0, 1.0]], "[1][0] = -1.0 is out of range"),
        (&[&[1.0], &[f64::NAN, 1.0]], "[1][0] = nan is out of range"),
    ] {
        let space = if expected.starts_with('[') { "" } else { " " };
        let expected = format!("g.toml: hysteresis.weights_nm{space}{expected}; {allowed}");
        assert_eq!(weights_refusal(rows), expected);
    }
    let line = weights_refusal(&[&[1.0], &[1.0, 0.5]]);
    let mirror = "g.toml: hysteresis.weights_nm[0][0] = 1 is out of range; allowed: its mirror image \
                  hysteresis.weights_nm[1][1] = 0.5";
    assert_eq!(line, mirror);
    let line = weights_refusal(&[&[1.0], &[100.0, 1.0]]);
    assert!(line.starts_with("g.toml: hysteresis.weights_nm: the torque falls with the torsion"), "{line}");
    let line = refusal("width_arcmin = 1.0", "width_arcmin = 1.0\nhalf_range_rad = 1e-3");
    assert_eq!(line, "g.toml: hysteresis.half_range_rad without hysteresis.weights_nm");
}
