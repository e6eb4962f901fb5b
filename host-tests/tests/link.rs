//! The arm link and its patch: their file, and how much the stored answers notice.

use std::path::Path;

use strainwave_desktop::LinkFile;
use strainwave_desktop::io::keyed_file::key::Allowed;
use strainwave_desktop::io::link_file::KEYS;
use strainwave_desktop::verify::Part;
use strainwave_desktop::verify::link::{eigenvalues, motion};
use toml::{Table, Value};

const FOREARM: &str = include_str!("../../examples/link/forearm.toml");

fn parse(text: &str) -> Result<LinkFile, String> {
    LinkFile::parse(Path::new("l.toml"), text.as_bytes()).map_err(|error| error.to_string())
}

/// The message for the example with `from` replaced by `to`.
fn refusal(from: &str, to: &str) -> String {
    assert!(FOREARM.contains(from), "{from} is not in the example");
    parse(&FOREARM.replacen(from, to, 1)).expect_err("must be refused")
}

/// The example with every key that a file may have; those of identified hysteresis exclude the width.
fn full() -> Table {
    let mut table: Table = FOREARM.parse().unwrap();
    let piezo = table["piezo"].as_table_mut().unwrap();
    piezo.insert("linear_share".into(), 0.8.into());
    piezo.insert(
        "hysteresis_weights_v".into(),
        Value::Array(vec![vec![10.0].into(), vec![-5.0, 10.0].into()]),
    );
    table
}

#[test]
fn the_example_is_read_and_written_back_unchanged() {
    let file = parse(FOREARM).unwrap();
    assert_eq!(parse(&toml::to_string(&file).unwrap()).unwrap(), file);
    assert_eq!((file.link.modes, file.warning()), (2, None));
    let (head, _) = FOREARM.split_once("# A plate of soft PZT").unwrap();
    assert!(parse(head).unwrap().piezo.is_none());
    assert_eq!(parse(&head.replacen("modes = 2", "", 1)).unwrap().link.modes, 2);
}

#[test]
fn the_table_of_keys_is_the_type() {
    let table = full();
    let written = table.iter().flat_map(|(section, keys)| {
        keys.as_table().unwrap().keys().map(move |key| format!("{section}.{key}"))
    });
    let mut written: Vec<_> = written.collect();
    let mut listed: Vec<_> = KEYS.iter().map(|key| key.path.to_owned()).collect();
    written.sort();
    listed.sort();
    assert_eq!(written, listed);
}

#[test]
fn every_key_but_the_optional_ones_is_required_and_of_its_type() {
    let file: Table = FOREARM.parse().unwrap();
    for key in KEYS {
        let (section, name) = key.path.split_once('.').unwrap();
        let mut without = file.clone();
        without[section].as_table_mut().unwrap().remove(name);
        match parse(&without.to_string()) {
            Ok(_) => assert!(key.optional, "{} may be left out", key.path),
            Err(line) => {
                assert_eq!(line, format!("l.toml: missing key {}; allowed: {}", key.path, key.allowed));
            }
        }
        let mut wrong = file.clone();
        let value = if matches!(key.allowed, Allowed::Text) { Value::Boolean(true) } else { "x".into() };
        wrong[section].as_table_mut().unwrap().insert(name.into(), value);
        let line = parse(&wrong.to_string()).expect_err(key.path);
        assert!(line.starts_with(&format!("l.toml: {} = ", key.path)), "{line}");
        assert!(line.ends_with(&format!("allowed: {}", key.allowed)), "{line}");
        if matches!(key.allowed, Allowed::Number(..)) {
            wrong[section].as_table_mut().unwrap().insert(name.into(), Value::Float(f64::NAN));
            let line = parse(&wrong.to_string()).expect_err(key.path);
            assert!(line.contains(" = nan is out of range; allowed: a number "), "{line}");
        }
    }
}

#[test]
fn messages_read_well() {
    for (from, to, expected) in [
        (
            "length_m = 0.5",
            "length_m = 0",
            "link.length_m = 0 is out of range; allowed: a number from 0.001 to 100 m",
        ),
        ("[piezo]", "[pieso]", "unknown key pieso; the nearest known key is piezo"),
        (
            "payload_kg",
            "payload",
            "unknown key link.payload = 0.15; the nearest known key is link.payload_kg (a number",
        ),
        (
            "payload_kg = 0.15",
            "payload_kg = 300",
            "link.payload_kg = 300 is out of range; allowed: at most 1000 times the beam's mass = 216",
        ),
        (
            "end_m = 0.06",
            "end_m = 0.6",
            "piezo.end_m = 0.6 is out of range; allowed: at most link.length_m = 0.5",
        ),
        (
            "end_m = 0.06",
            "end_m = 0.01",
            "piezo.end_m = 0.01 is out of range; allowed: more than piezo.start_m = 0.01",
        ),
        (
            "[0.0, 0.25]",
            "[0.0, 0.7]",
            "link.gauges_m[1] = 0.7 is out of range; allowed: at most link.length_m = 0.5",
        ),
        ("[0.0, 0.25]", "[-0.1]", "link.gauges_m[0] = -0.1 is out of range; allowed: a number from 0"),
        ("[0.0, 0.25]", "[0.1, 0.1]", "link.gauges_m[1] = 0.1 stands there twice"),
        (
            "[0.004, 0.005]",
            "[0.004, 0.005, 0.006]",
            "link.damping_ratios has 3 entries; allowed: 1 for all modes, or one for each of link.modes = 2",
        ),
        (
            "[0.004, 0.005]",
            "[-0.004]",
            "link.damping_ratios[0] = -0.004 is out of range; allowed: a number from 0 to 0.99",
        ),
        (
            "-190e-12",
            "0",
            "piezo.charge_constant_m_per_v = 0 is out of range; allowed: not 0; below 0 for PZT",
        ),
        (
            "1.6e-8",
            "2e-9",
            "piezo.permittivity_f_per_m = 0.000000002 is out of range; allowed: above \
             charge_constant_m_per_v^2*youngs_modulus_pa = 2.238e-9 F/m",
        ),
        (
            "hysteresis_width = 0.15",
            "hysteresis_width = 0.5",
            "piezo.hysteresis_width = 0.5 is out of range; allowed: a number from 0 below 0.5",
        ),
        (
            "hysteresis_width = 0.15",
            "linear_share = 0.9",
            "piezo.linear_share without piezo.hysteresis_weights_v",
        ),
        (
            "hysteresis_width = 0.15",
            "hysteresis_width = 0.1\nhysteresis_weights_v = [[1], [2, 1]]",
            "piezo.hysteresis_width beside piezo.hysteresis_weights_v; allowed: one of them",
        ),
        (
            "hysteresis_width = 0.15",
            "hysteresis_weights_v = [[1], [2, 3]]",
            "piezo.hysteresis_weights_v[0][0] = 1 is out of range; allowed: its mirror image \
             piezo.hysteresis_weights_v[1][1] = 3",
        ),
    ] {
        let line = refusal(from, to);
        assert!(line.starts_with(&format!("l.toml: {expected}")), "{line}\n{expected}");
    }
}

#[test]
fn identified_hysteresis_of_either_sign_is_read() {
    let mut table = full();
    table["piezo"].as_table_mut().unwrap().remove("hysteresis_width");
    let patch = parse(&table.to_string()).unwrap().patch().unwrap().unwrap();
    let mut state = patch.rest();
    let mut couple = |voltage: f64| (0..10).map(|_| patch.step(&mut state, voltage).couple).last().unwrap();
    let full = couple(200.0) / patch.coupling();
    assert!((full - (0.8 * 200.0 + 15.0)).abs() < 1e-6, "{full}");
    let (falling, _, rising) = (couple(0.0), couple(-200.0), couple(0.0));
    assert!(falling != rising, "{falling} {rising}");
}

/// More modes than the period of control shows are refused with the bound; as many as it shows are not.
#[test]
fn modes_that_the_step_cannot_carry_are_named_with_the_bound() {
    let line = refusal("modes = 2", "modes = 8");
    assert!(line.contains("link.damping_ratios has 2 entries"), "{line}");
    // All eight of the soft example are slow enough.
    let text = FOREARM.replacen("[0.004, 0.005]", "[0.004]", 1);
    assert!(parse(&text.replacen("modes = 2", "modes = 8", 1)).is_ok());
    let text = text.replacen("bending_stiffness_nm2 = 14.9", "bending_stiffness_nm2 = 1490.0", 1);
    let with = |modes: usize| parse(&text.replacen("modes = 2", &format!("modes = {modes}"), 1));
    let line = with(8).unwrap_err();
    let most = line.strip_prefix("l.toml: link.modes = 8 is out of range; allowed: at most ").expect(&line);
    let most: usize = most.split(':').next().unwrap().parse().unwrap();
    assert!(line.contains(&format!("a quarter of the period of mode {} is ", most + 1)), "{line}");
    assert!(with(most).is_ok() && with(most + 1).is_err());
    let stiff = text.replacen("bending_stiffness_nm2 = 1490.0", "bending_stiffness_nm2 = 1e9", 1);
    let line = parse(&stiff).unwrap_err();
    assert!(
        line.starts_with("l.toml: link.bending_stiffness_nm2: too stiff a link to have modes: "),
        "{line}"
    );
}

#[test]
fn a_payload_beyond_its_rating_is_a_warning() {
    let file = parse(&FOREARM.replacen("payload_kg = 0.15", "payload_kg = 0.3", 1)).unwrap();
    assert_eq!(
        file.warning().as_deref(),
        Some("link.payload_kg = 0.3 is more than link.rated_payload_kg = 0.25")
    );
}

#[test]
fn every_figure_holds_and_its_bound_is_tight() {
    for part in [Part::Link, Part::Piezo] {
        let measured = part.measure().unwrap();
        assert!(
            measured.notes.is_empty() && measured.figures.iter().all(|figure| figure.holds),
            "{measured:?}"
        );
    }
}

/// Sensitivity of the stored answers: what is off by little shows.
#[test]
fn stored_finite_elements_notice_a_small_error() {
    for row in eigenvalues::stored() {
        assert!(row.off() < 1e-8);
    }
    let heavier = eigenvalues::stored()[2];
    assert!(heavier.off_when_heavier(1.0001) > 1e-6);
    let exact = motion::differences(&motion::link_params());
    let mut stiffer = motion::link_params::<f64>();
    stiffer.bending_stiffness *= 1.01;
    let mut undamped = motion::link_params::<f64>();
    undamped.damping = [0.0; 2];
    for changed in [stiffer, undamped] {
        assert!(motion::differences(&changed).torque > 5.0 * exact.torque, "{exact:?}");
    }
}
