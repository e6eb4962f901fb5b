//! `[friction]`: which keys a model needs, and of which no model can be built.

use strainwave::friction::{FrictionParams, ModelName};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::DEFAULT;
use strainwave_desktop::io::gear_file::friction_params::friction_params;
use toml::Table;

use super::full::full;
use super::parse;

/// A gear whose friction has just these keys of the full one.
fn with_friction(model: ModelName, names: &[&str]) -> Table {
    let mut table = full();
    for side in ["input", "output"] {
        let side = table["friction"][side].as_table_mut().unwrap();
        side.retain(|name, _| names.contains(&name));
        side.insert("model".into(), model.word().into());
    }
    table
}

#[test]
fn a_friction_model_needs_its_keys_and_no_others() {
    for model in ModelName::ALL {
        let names: Vec<_> = model.needs().collect();
        let gear = parse(&with_friction(*model, &names).to_string()).unwrap();
        assert_eq!(gear.friction.output.model, *model);
        assert_eq!(parse(&gear.to_toml()).unwrap(), gear);
        for missing in &names {
            let others: Vec<_> = names.iter().copied().filter(|name| name != missing).collect();
            let line = parse(&with_friction(*model, &others).to_string()).unwrap_err();
            let expected = format!(
                "g.toml: missing key friction.input.{missing}, which friction.input.model = \"{}\" needs; allowed: a ",
                model.word()
            );
            assert!(line.starts_with(&expected), "{line}\n{expected}");
        }
    }
}

/// One changed word compares two models; each reads what it says that it needs.
#[test]
fn keys_that_a_friction_model_does_not_read_may_stay() {
    let mut whole = full();
    for model in ModelName::ALL {
        for side in ["input", "output"] {
            whole["friction"][side]["model"] = model.word().into();
        }
        let gear = parse(&whole.to_string()).unwrap();
        let [few, all] =
            [&parse(&with_friction(*model, &model.needs().collect::<Vec<_>>()).to_string()).unwrap(), &gear]
                .map(|gear| friction_params::<f64>(&gear.friction.output).build().unwrap());
        // The whole file has a number other than the default for each key that a model may have.
        assert_eq!(few == all, model.may_have().is_empty(), "{}", model.word());
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
    for (model, keys, tables, expected) in [
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
        assert!(line.starts_with(&format!("g.toml: friction.input.{expected}")), "{line}\n{expected}");
    }
}

#[test]
fn the_firmware_has_one_block() {
    for model in ModelName::ALL {
        let mut gear = GearFile::default_gear();
        gear.friction.output.model = *model;
        let line = format!(
            "friction.output.model = {:?} is not in the firmware; allowed there: \"bliman_sorine_1\" or \"bliman_sorine_2\"",
            model.word()
        );
        let refused = !ModelName::IN_FIRMWARE.contains(model);
        assert_eq!(gear.require_firmware_friction(), if refused { Err(line) } else { Ok(()) });
        assert_eq!(joint_params::<f32>(&gear).is_err(), refused, "{}", model.word());
    }
}
