//! The joint that firmware is built with by default is what the default gear file gives.
//!
//! After a change of the gear file or of the parameters: `STRAINWAVE_OVERWRITE=1 cargo test -p
//! strainwave-host-tests --test joint_file`, and review the difference.

use std::path::Path;

use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::{joint_params, source};

#[test]
fn the_checked_in_joint_is_the_default_gear() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../boards/app/src/joint.rs");
    let file = GearFile::default_gear();
    let generated = source(&joint_params(&file).unwrap(), &file.gear.name);
    if std::env::var_os("STRAINWAVE_OVERWRITE").is_some() {
        std::fs::write(&path, &generated).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    assert!(kept == generated, "boards/app/src/joint.rs is not what gears/hd25-100.toml gives today");
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
