//! The gear file: what is accepted, and how each kind of mistake is refused.

mod damage;
mod friction;
mod full;
mod keys;
mod messages;
mod whole;

use std::path::Path;

use strainwave_desktop::GearFile;
use strainwave_desktop::io::gear_file::{Arrangement, DEFAULT, LARA8_J5, LARA8_MOVING};

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
