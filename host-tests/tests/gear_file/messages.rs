//! Messages for mistakes in a gear file.

use strainwave_desktop::io::gear_file::DEFAULT;

use super::{parse, refusal};

#[test]
fn messages_read_well() {
    assert_eq!(
        refusal("ratio = 100", "ratio = 0"),
        "g.toml: gear.ratio = 0 is out of range; allowed: a whole number from 30 to 320"
    );
    assert_eq!(
        refusal("k2_nm_per_rad = 5.0e4", "k2_nm_per_rad = -3"),
        "g.toml: stiffness.k2_nm_per_rad = -3 is out of range; allowed: a number from 1 to 1e8 N m/rad"
    );
    assert_eq!(
        refusal("t2_nm = 48.0", "t2_nm = 14.0"),
        "g.toml: stiffness.t2_nm = 14 is out of range; allowed: more than stiffness.t1_nm = 14"
    );
    assert_eq!(
        refusal("arrangement = \"circular_spline_fixed\"", "arrangement = \"cs\""),
        "g.toml: gear.arrangement = \"cs\" is out of range; allowed: \"circular_spline_fixed\" or \
         \"flexspline_fixed\""
    );
    assert!(refusal("name = \"hd25-100\"", "name = ").starts_with("g.toml: line 5: not TOML: "));
    assert!(refusal("ratio = 100", "ratio = 100\nratio = 100").starts_with("g.toml: line 7: not TOML: "));
}

#[test]
fn an_unknown_key_is_shown_its_nearest_neighbour() {
    for (from, to, unknown, nearest) in [
        (
            "k1_nm_per_rad = ",
            "k1 = ",
            "stiffness.k1 = 31000.0",
            "stiffness.k1_nm_per_rad (a number from 1 to",
        ),
        ("[stiffness]", "[stifness]", "stifness", "stiffness"),
        ("[gear]", "ratio = 100\n[gear]", "ratio = 100", "gear.ratio (a whole"),
        ("t1_nm =", "T1_nm = 3\nt1_nm =", "stiffness.T1_nm = 3", "stiffness.t1_nm (a number"),
        ("[motor]", "[motor]\nstatic_nm = 1", "motor.static_nm = 1", "friction.output.static_nm (a number"),
        (
            "order = 4",
            "order = 4\nphase_deg = 1",
            "kinematic_error.wave_generator[1].phase_deg = 1",
            "kinematic_error.wave_generator[].phase_rad (a number from -3.14",
        ),
        ("name =", "\"a.b\\n\" = 1\nname =", "gear.\"a.b\\n\" = 1", ""),
    ] {
        let expected = format!("g.toml: unknown key {unknown}; the nearest known key is {nearest}");
        let line = refusal(from, to);
        assert!(line.starts_with(&expected), "{line}\n{expected}");
    }
}

#[test]
fn a_quoted_name_with_a_dot_is_no_path() {
    let line = parse(&format!("\"gear.ratio\" = 7\n{DEFAULT}")).unwrap_err();
    assert!(line.starts_with("g.toml: unknown key \"gear.ratio\" = 7;"), "{line}");
}

#[test]
fn lists_of_orders_are_optional_and_short() {
    let (head, _) = DEFAULT.split_once("[[kinematic_error").unwrap();
    let (_, tail) = DEFAULT.split_once("# Steel cup.").unwrap();
    assert!(parse(&format!("{head}{tail}")).unwrap().kinematic_error.wave_generator.is_empty());
    let entry = "[[kinematic_error.flexspline]]\norder = 2\namplitude_rad = 1e-5\nphase_rad = 0\n";
    assert!(parse(&format!("{head}{}{tail}", entry.repeat(8))).is_ok());
    let line = parse(&format!("{head}{}{tail}", entry.repeat(9))).unwrap_err();
    assert_eq!(line, "g.toml: kinematic_error.flexspline has 9 entries; allowed: at most 8");
    for (text, expected) in [
        ("kinematic_error = 1", "kinematic_error = 1 is a whole number; allowed: a table"),
        (
            "kinematic_error.flexspline = 1",
            "kinematic_error.flexspline = 1 is a whole number; allowed: a list",
        ),
        (
            "kinematic_error.flexspline = [1]",
            "kinematic_error.flexspline[0] = 1 is a whole number; allowed: a",
        ),
    ] {
        let line = parse(&format!("{text}\n{head}{tail}")).unwrap_err();
        assert!(line.starts_with(&format!("g.toml: {expected}")), "{line}");
    }
}
