//! The gear file: what is accepted, and how each kind of mistake is refused.

use std::collections::BTreeSet;
use std::path::Path;

use proptest::prelude::*;
use strainwave::friction::FrictionParams;
use strainwave_desktop::GearFile;
use strainwave_desktop::friction_params::friction_params;
use strainwave_desktop::gear_file::friction::{Backward, Friction, FrictionModel, StateRow};
use strainwave_desktop::gear_file::{
    Allowed, Arrangement, DEFAULT, KEYS, LARA8_J5, LARA8_MOVING, Learnt, RELATIONS,
};
use strainwave_desktop::joint::joint_params;
use toml::{Table, Value};

const LARA8: &str = LARA8_J5;

fn parse(text: &str) -> Result<GearFile, String> {
    GearFile::parse(Path::new("g.toml"), text.as_bytes()).map_err(|error| error.to_string())
}

/// The message for the default gear with `from` replaced by `to`.
fn refusal(from: &str, to: &str) -> String {
    assert!(DEFAULT.contains(from), "{from} is not in the default gear");
    let line = parse(&DEFAULT.replacen(from, to, 1)).expect_err("must be refused");
    assert!(line.starts_with("g.toml: ") && !line.contains('\n'), "{line}");
    line
}

#[test]
fn every_gear_is_read_and_written_back_unchanged() {
    for text in [DEFAULT, LARA8].into_iter().chain(LARA8_MOVING.map(|(_, text)| text)) {
        let gear = parse(text).unwrap();
        assert_eq!(parse(&gear.to_toml()).unwrap(), gear);
    }
}

#[test]
fn the_signed_ratio_follows_the_arrangement() {
    let (hd25, lara8) = (parse(DEFAULT).unwrap(), parse(LARA8).unwrap());
    assert_eq!(hd25.gear.arrangement, Arrangement::CircularSplineFixed);
    assert!((hd25.gear.signed_ratio().value::<f64>() + 1.0 / 100.0).abs() < 1e-15);
    assert!((lara8.gear.signed_ratio().value::<f64>() - 1.0 / 101.0).abs() < 1e-15);
    assert!((hd25.hysteresis.width() - 2.908_882e-4).abs() < 1e-9);
}

/// A gear that has every key.
fn full() -> Table {
    let mut gear = parse(LARA8).unwrap();
    gear.kinematic_error.flexspline = gear.kinematic_error.wave_generator.clone();
    gear.sensors.output_encoder_error = gear.kinematic_error.wave_generator.clone();
    gear.compensation.external_torque_wander = Some(3.0);
    (gear.sensors.output_encoder_delay, gear.sensors.output_encoder_period) = (3, 10);
    (gear.sensors.motor_encoder_noise, gear.sensors.output_encoder_noise) = (Some(1e-5), Some(2e-5));
    gear.learnt = Some(learnt());
    gear.hysteresis.half_range = Some(2e-3);
    gear.hysteresis.weights = Some(vec![vec![0.1], vec![0.3, 0.2], vec![0.5, 0.3, 0.1]]);
    for side in [&mut gear.friction.input, &mut gear.friction.output] {
        *side = every_friction(side);
    }
    gear.to_toml().parse().unwrap()
}

/// What a compensator may have learnt.
fn learnt() -> Learnt {
    Learnt {
        inertia: 1.1,
        input_friction: 0.9,
        output_friction: 1.2,
        compliance: 0.95,
        position_cosines: vec![1e-6, -2e-6],
        position_sines: vec![3e-6],
        torque_cosines: vec![1e-3],
        torque_sines: vec![-1e-3, 2e-3],
    }
}

/// What every friction model needs and may have.
fn every_friction(side: &Friction) -> Friction {
    Friction {
        dead_band: Some(1e-3),
        frictional_memory: Some(1e-3),
        dwell: Some(2.0),
        dahl_exponent: Some(2),
        micro_damping: Some(1e-4),
        load_driving: Some(0.08),
        load_driven: Some(0.12),
        ripple_cosines: Some(vec![0.1, -0.2]),
        ripple_sines: Some(vec![0.3]),
        backward: Some(Backward {
            coulomb: side.coulomb,
            static_level: side.static_level.map(|level| 1.1 * level),
            stribeck_velocity: side.stribeck_velocity,
            viscous: side.viscous,
            ripple_cosines: Some(vec![0.2]),
            ripple_sines: Some(vec![0.1, 0.1]),
        }),
        state_space: Some(vec![
            StateRow { a: vec![-1e3, 4e3], b: 1e3, c: 0.1 },
            StateRow { a: vec![-4e3, -2e3], b: 500.0, c: 0.05 },
        ]),
        ..side.clone()
    }
}

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

/// The table that holds the last part of a path (in a list its first entry), and that part.
fn at<'t, 'p>(table: &'t mut Table, path: &'p str) -> (&'t mut Table, &'p str) {
    let Some((first, rest)) = path.split_once('.') else { return (table, path) };
    match table.get_mut(first.trim_end_matches("[]")).unwrap() {
        Value::Array(items) => at(items[0].as_table_mut().unwrap(), rest),
        inner => at(inner.as_table_mut().unwrap(), rest),
    }
}

fn set(table: &mut Table, path: &str, value: impl Into<Value>) {
    let (inner, name) = at(table, path);
    assert!(inner.insert(name.into(), value.into()).is_some(), "{path} is not in the full gear");
}

/// The full gear with one value changed.
fn changed(path: &str, value: impl Into<Value>) -> Result<GearFile, String> {
    let mut table = full();
    set(&mut table, path, value);
    parse(&table.to_string())
}

/// As messages show a path of [`KEYS`].
fn shown(path: &str) -> String {
    path.replace("[]", "[0]")
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
            // Half range and weights come together.
            Err(line) if line.contains(" without ") => {
                assert!(key.optional && key.path.starts_with("hysteresis."), "{line}");
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
    let model = FrictionModel::BlimanSorine2;
    let (_, name) = path.strip_prefix("friction.")?.split_once('.')?;
    model.needs().any(|needed| needed == name).then(|| model.name())
}

/// A gear whose friction has just these keys of the full one.
fn with_friction(model: FrictionModel, names: &[&str]) -> Table {
    let mut table = full();
    for side in ["input", "output"] {
        let side = table["friction"][side].as_table_mut().unwrap();
        side.retain(|name, _| names.contains(&name));
        side.insert("model".into(), model.name().into());
    }
    table
}

#[test]
fn a_friction_model_needs_its_keys_and_no_others() {
    for model in FrictionModel::ALL {
        let names: Vec<_> = model.needs().collect();
        let gear = parse(&with_friction(*model, &names).to_string()).unwrap();
        assert_eq!(gear.friction.output.model, *model);
        assert_eq!(parse(&gear.to_toml()).unwrap(), gear);
        for missing in &names {
            let others: Vec<_> = names.iter().copied().filter(|name| name != missing).collect();
            let line = parse(&with_friction(*model, &others).to_string()).unwrap_err();
            let wanted = format!(
                "g.toml: missing key friction.input.{missing}, which friction.input.model = \"{}\" needs; allowed: a ",
                model.name()
            );
            assert!(line.starts_with(&wanted), "{line}\n{wanted}");
        }
    }
}

/// One changed word compares two models; each reads what it says that it needs.
#[test]
fn keys_that_a_friction_model_does_not_read_may_stay() {
    let mut whole = full();
    for model in FrictionModel::ALL {
        for side in ["input", "output"] {
            whole["friction"][side]["model"] = model.name().into();
        }
        let gear = parse(&whole.to_string()).unwrap();
        let [few, all] =
            [&parse(&with_friction(*model, &model.needs().collect::<Vec<_>>()).to_string()).unwrap(), &gear]
                .map(|gear| friction_params::<f64>(&gear.friction.output).build().unwrap());
        let defaults_matter = FrictionModel::IN_FIRMWARE.contains(model)
            || matches!(model, FrictionModel::Dahl | FrictionModel::ResetIntegrator | FrictionModel::LuGre);
        assert_eq!(few == all, !defaults_matter, "{}", model.name());
    }
}

#[test]
fn what_is_left_out_backwards_is_as_forwards() {
    let gear = |backward: &str| {
        let text = DEFAULT.replace("[friction.output]", &format!("{backward}\n[friction.output]"));
        friction_params::<f64>(&parse(&text).unwrap().friction.input)
    };
    assert_eq!(gear(""), gear("[friction.input.backward]"));
    assert_eq!(gear(""), gear("[friction.input.backward]\ncoulomb_nm = 0.035\nripple_sines = [0]"));
    assert_ne!(gear(""), gear("[friction.input.backward]\ncoulomb_nm = 0.034"));
    assert_ne!(gear(""), gear("[friction.input.backward]\nripple_sines = [0, 0.1]"));
}

#[test]
fn friction_that_no_model_can_be_built_from_is_refused_by_key() {
    let states = |rows: &[(&[f64], f64, f64)]| {
        let row = |(a, b, c): &(&[f64], f64, f64)| {
            format!("[[friction.input.state_space]]\na_per_rad = {a:?}\nb_per_rad = {b:?}\nc_nm = {c:?}\n")
        };
        rows.iter().map(row).collect::<String>()
    };
    let shape =
        "state_space is out of range; allowed: 1 to 4 states, each a_per_rad with as many numbers, A stable";
    for (model, keys, tables, wanted) in [
        (
            "dahl",
            "coulomb_nm = 0",
            String::new(),
            "coulomb_nm = 0 is out of range; allowed: at least 1e-9 N m with model = \"dahl\"",
        ),
        (
            "lugre",
            "coulomb_nm = 0",
            String::new(),
            "coulomb_nm = 0 is out of range; allowed: at least 1e-9 N m",
        ),
        (
            "reset_integrator",
            "coulomb_nm = 0",
            String::new(),
            "coulomb_nm = 0 is out of range; allowed: above 1e-6 static_nm",
        ),
        (
            "lugre",
            "presliding_rad = 1e-9\nstatic_nm = 2",
            String::new(),
            "presliding_rad = 0.000000001 is out of range; allowed: static_nm/presliding_rad from 1e-9 to 1e9 N m/rad with \
             model = \"lugre\"",
        ),
        (
            "reset_integrator",
            "presliding_rad = 1e-8",
            String::new(),
            "presliding_rad = 0.00000001 is out of range; allowed: coulomb_nm/presliding_rad from 0 to 1e6 N m/rad",
        ),
        (
            "bliman_sorine_1",
            "",
            "[friction.input.backward]\ncoulomb_nm = 0.06\n".into(),
            "backward.static_nm = 0.05 is out of range; allowed: at least coulomb_nm backwards",
        ),
        (
            "bliman_sorine_2",
            "ripple_cosines = [0.8]\nripple_sines = [0.8]",
            String::new(),
            "ripple_cosines is out of range; allowed: with ripple_sines amplitudes sqrt(a_k^2 + b_k^2) that add up to at \
             most 0.99, not 1.131",
        ),
        (
            "bliman_sorine_2",
            "ripple_cosines = [0.5]",
            "[friction.input.backward]\nripple_sines = [0, 0.5]\n".into(),
            "backward.ripple_cosines is out of range",
        ),
        (
            "viscous",
            "viscous_nm_s_per_rad = 0.7",
            String::new(),
            "viscous_nm_s_per_rad = 0.7 is out of range; allowed: below J/dt = 6.000e-1 N m s/rad",
        ),
        (
            "lugre",
            "micro_damping_nm_s_per_rad = 3",
            String::new(),
            "micro_damping_nm_s_per_rad = 3 is out of range; allowed: below J/dt",
        ),
        ("state_space", "", states(&[(&[-1.0, 0.0], 1.0, 1.0)]), shape),
        ("state_space", "", states(&[(&[-1.0], 1.0, 1.0), (&[0.0, -1.0], 1.0, 1.0)]), shape),
        ("state_space", "", states(&[(&[-1.0; 4] as &[f64], 1.0, 1.0); 5]), shape),
        ("state_space", "", states(&[(&[1.0], 1.0, 1.0)]), shape),
        (
            "state_space",
            "",
            states(&[(&[-1.0, 0.0], 1.0, 0.0), (&[1.0, -1.0], 0.0, 1.0)]),
            "state_space is out of range; allowed: a model that takes work",
        ),
    ] {
        let mut side: Table =
            DEFAULT.parse::<Table>().unwrap()["friction"]["input"].as_table().unwrap().clone();
        side.extend(keys.parse::<Table>().unwrap());
        side.insert("model".into(), model.into());
        let (head, tail) = DEFAULT.split_once("[friction.input]").unwrap();
        let (_, tail) = tail.split_once("[friction.output]").unwrap();
        let line =
            parse(&format!("{head}[friction.input]\n{side}\n{tables}[friction.output]{tail}")).unwrap_err();
        assert!(line.starts_with(&format!("g.toml: friction.input.{wanted}")), "{line}\n{wanted}");
    }
}

#[test]
fn the_firmware_has_one_block() {
    for model in FrictionModel::ALL {
        let mut gear = GearFile::default_gear();
        gear.friction.output.model = *model;
        let line = format!(
            "friction.output.model = {:?} is not in the firmware; allowed there: \"bliman_sorine_1\" or \"bliman_sorine_2\"",
            model.name()
        );
        let refused = !FrictionModel::IN_FIRMWARE.contains(model);
        assert_eq!(gear.require_firmware_friction(), if refused { Err(line) } else { Ok(()) });
        assert_eq!(joint_params::<f32>(&gear).is_err(), refused, "{}", model.name());
    }
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

#[test]
fn open_ends_are_excluded_and_closed_ends_included() {
    assert!(
        changed("compensation.friction_share", 0).is_ok()
            && changed("compensation.friction_share", 1).is_ok()
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
            let wanted = format!("g.toml: {path} = {value} is out of range; allowed: {relation} = {other}");
            parse(&table.to_string()).is_err_and(|line| line == wanted)
        };
        assert!(refused(limit * 0.99), "{path} below {than}");
        assert_eq!(refused(limit), !relation.or_equal, "{path} at the limit of {than}");
        assert!(!refused(limit * 1.01), "{path} above {than}");
    }
}

#[test]
fn what_only_the_whole_gear_can_tell_is_refused_by_key() {
    for (from, to, wanted) in [
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
        assert!(line.starts_with(&format!("g.toml: {wanted}")), "{line}");
    }
}

/// The message for a gear with these rows as its weights.
fn weights_refusal(rows: &[&[f64]]) -> String {
    let list = |row: &&[f64]| Value::Array(row.iter().map(|weight| Value::Float(*weight)).collect());
    changed("hysteresis.weights_nm", rows.iter().map(list).collect::<Vec<_>>()).unwrap_err()
}

#[test]
fn weights_are_a_triangle_that_a_gear_can_have() {
    let allowed = "allowed: rows of 1, 2, 3, ... numbers from 0 to 10000 N m, 2 to 24 rows";
    for (rows, wanted) in [
        (&[&[1.0][..]][..], "has 1 rows"),
        (&[&[1.0], &[1.0]], "[1] is not a list of 2 numbers"),
        (&[&[1.0], &[1.0, 1.0, 1.0]], "[1] is not a list of 2 numbers"),
        (&[&[1.0], &[-1.0, 1.0]], "[1][0] = -1.0 is out of range"),
        (&[&[1.0], &[f64::NAN, 1.0]], "[1][0] = nan is out of range"),
    ] {
        let space = if wanted.starts_with('[') { "" } else { " " };
        let wanted = format!("g.toml: hysteresis.weights_nm{space}{wanted}; {allowed}");
        assert_eq!(weights_refusal(rows), wanted);
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
        let wanted = format!("g.toml: unknown key {unknown}; the nearest known key is {nearest}");
        let line = refusal(from, to);
        assert!(line.starts_with(&wanted), "{line}\n{wanted}");
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
    for (text, wanted) in [
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
        assert!(line.starts_with(&format!("g.toml: {wanted}")), "{line}");
    }
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let line = |path: &Path| GearFile::read(path).unwrap_err().to_string();
    assert!(line(&folder.path().join("none.toml")).contains("none.toml: cannot be read: No such file"));
    assert!(line(folder.path()).contains("cannot be read: it is a folder"));
    let path = folder.path().join("binary.toml");
    std::fs::write(&path, b"[gear]\nname = \"\xff\"").unwrap();
    assert!(line(&path).ends_with("binary.toml: line 2: not TOML: not UTF-8 text"));
    std::fs::write(&path, vec![b' '; (1 << 20) + 1]).unwrap();
    assert!(line(&path).ends_with("longer than 1048576 bytes, the most allowed"));
}

#[test]
fn a_gear_out_of_range_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("g.toml");
    let mut gear = GearFile::default_gear();
    gear.stiffness.k1 = f64::NAN;
    assert!(gear.write(&path).unwrap_err().to_string().contains("stiffness.k1_nm_per_rad = nan"));
    assert!(!path.exists());
    GearFile::default_gear().write(&path).unwrap();
    assert_eq!(GearFile::read(&path).unwrap(), GearFile::default_gear());
}

fn one_line_or_gear(bytes: &[u8]) -> Result<(), TestCaseError> {
    if let Err(error) = GearFile::parse(Path::new("g.toml"), bytes) {
        let line = error.to_string();
        prop_assert!(line.starts_with("g.toml: ") && !line.chars().any(char::is_control), "{line}");
    }
    Ok(())
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        one_line_or_gear(&bytes)?;
    }

    /// Damage to a good file reaches further into the checks than noise does.
    #[test]
    fn no_damage_panics(at in 0..DEFAULT.len(), cut in 0..40usize, put in prop::collection::vec(any::<u8>(), 0..8)) {
        let end = (at + cut).min(DEFAULT.len());
        one_line_or_gear(&[&DEFAULT.as_bytes()[..at], &put, &DEFAULT.as_bytes()[end..]].concat())?;
    }

    /// Well-formed text in the wrong places.
    #[test]
    fn no_rearranged_lines_panic(order in prop::collection::vec(0..100usize, 1..60)) {
        let lines: Vec<_> = DEFAULT.lines().filter(|line| !line.starts_with('#')).collect();
        let text: Vec<_> = order.iter().map(|index| lines[index % lines.len()]).collect();
        one_line_or_gear(text.join("\n").as_bytes())?;
    }
}
