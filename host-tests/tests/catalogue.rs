//! The gear files of the catalogue are what its laws give, and a joint can be built with each.
//!
//! After a change of a law: `STRAINWAVE_OVERWRITE=1 cargo test -p strainwave-host-tests catalogue`, and review the
//! difference. What the baselines were tuned to stays.

use std::path::{Path, PathBuf};

use strainwave_desktop::GearFile;
use strainwave_desktop::catalogue::{FILES, Model};
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::io::gear_file::Baselines;

fn path(model: Model) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../gears/catalogue/{}.toml", model.name()))
}

/// Tuned baselines of the file in the tree; none when there is no file yet.
fn tuned(model: Model) -> Option<Baselines> {
    GearFile::read(&path(model)).ok().and_then(|file| file.baselines)
}

#[test]
fn the_checked_in_gears_are_those_of_the_laws() {
    for model in FILES.iter().map(|file| file.model) {
        let (path, generated) = (path(model), model.text(tuned(model)));
        if std::env::var_os("STRAINWAVE_OVERWRITE").is_some() {
            std::fs::write(&path, &generated).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap();
        assert!(kept == generated, "{} is not what the catalogue's laws give", path.display());
    }
}

#[test]
fn no_other_file_stands_among_them() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../gears/catalogue");
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), FILES.len());
}

#[test]
fn a_compensator_can_be_built_for_each() {
    for file in FILES {
        let gear = GearFile::read(&path(file.model)).unwrap();
        gear.require_firmware_friction().unwrap();
        let built = joint_params::<f32>(&gear).and_then(|joint| joint.build());
        assert!(built.is_ok(), "{}: {:?}", gear.gear.name, built.err());
    }
}
