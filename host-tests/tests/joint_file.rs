//! The generated files are what the default gear file gives: the compensator that the boards are built with by default, and
//! the parameters that the library's examples use.
//!
//! After a change of the gear file, of the parameters or of the built compensator: `STRAINWAVE_OVERWRITE=1 cargo test -p
//! strainwave-host-tests joint_file`, and review the difference.

use std::path::Path;

use strainwave_desktop::GearFile;
use strainwave_desktop::design::export::Export;
use strainwave_desktop::design::joint::{joint_params, source};

/// The file below the repository's root holds this text; written first where that is asked for.
fn assert_kept(path: &str, generated: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    if std::env::var_os("STRAINWAVE_OVERWRITE").is_some() {
        std::fs::write(&file, generated).unwrap();
    }
    let kept = std::fs::read_to_string(&file).unwrap();
    assert!(kept == generated, "{path} is not what gears/hd25-100.toml gives today");
}

#[test]
fn the_checked_in_compensator_is_the_default_gears() {
    assert_kept("boards/app/src/joint.rs", &Export::of(&GearFile::default_gear()).unwrap().rust());
}

#[test]
fn the_checked_in_parameters_are_the_default_gears() {
    let file = GearFile::default_gear();
    assert_kept("examples/joint/hd25_100.rs", &source(&joint_params(&file).unwrap(), &file.gear.name));
}

#[test]
fn identified_weights_come_along() {
    let mut gear = GearFile::default_gear();
    gear.hysteresis.half_range = Some(1.5e-3);
    gear.hysteresis.weights = Some(vec![vec![0.5], vec![2.0, 0.5]]);
    let params = joint_params::<f32>(&gear).unwrap();
    let table = params.gear.hysteresis_table.unwrap();
    assert!((table.weights::<2>().unwrap().at(1, 0) - 2.0).abs() < 1e-4);
    let text = source(&params, &gear.gear.name);
    assert!(text.contains("use strainwave::hysteresis::HysteresisTable;\n"));
    assert!(text.contains("hysteresis_table: Some(\n            HysteresisTable {"), "{text}");
    assert!(!source(&joint_params(&GearFile::default_gear()).unwrap(), "g").contains("HysteresisTable"));
}
