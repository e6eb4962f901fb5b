//! The joint that firmware is built with by default is what the default gear file gives.
//!
//! After a change of the gear file or of the parameters: `STRAINWAVE_OVERWRITE=1 cargo test -p
//! strainwave-host-tests --test joint_file`, and review the difference.

use std::path::Path;

use strainwave_desktop::GearFile;
use strainwave_desktop::joint::{joint_params, source};

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
