//! The coarse mesh in f32 as the target steps it, on the host.

use strainwave::flexspline::FlexsplineParams;
use strainwave_app::literal_mesh::default_gear::JOINT;
use strainwave_app::literal_mesh::{STEP_SHARE, WindUp, wind_up};
use strainwave_desktop::design::joint;
use strainwave_desktop::{GearFile, plant};

/// The wind-up of a joint that differs by its flexspline.
fn of(change: impl FnOnce(&mut FlexsplineParams<f32>)) -> WindUp {
    let mut params = JOINT;
    change(&mut params.gear.flexspline);
    wind_up(&params).expect("the joint is sound")
}

#[test]
fn it_has_its_reductions_torque_beyond_both_knees() {
    let end = of(|_| ());
    assert!(end.agrees(), "{end:?}");
    let [_, second_knee] = JOINT.gear.flexspline.line.knee_torque;
    assert!(end.literal > 1.2 * second_knee, "{end:?}");
}

#[test]
fn every_gear_file_here_has_such_a_mesh() {
    let lara8 = GearFile::parse(
        "gears/lara8-j5.toml".as_ref(),
        strainwave_desktop::io::gear_file::LARA8_J5.as_bytes(),
    );
    let params = joint::joint_params(&lara8.expect("is a gear file")).expect("is sound");
    let end = wind_up(&params).expect("the joint is sound");
    assert!(end.agrees(), "{end:?}");
}

#[test]
fn what_is_no_longer_the_same_gear_is_told() {
    let strained = of(|flexspline| flexspline.cup.ellipse = 2.9e-3);
    assert!(!strained.agrees(), "{strained:?}");
    assert!(!WindUp { literal: f32::NAN, reduced: 60.0 }.agrees());
    assert!(!WindUp { literal: -60.0, reduced: 60.0 }.agrees());
}

#[test]
fn a_constant_out_of_range_is_named() {
    let mut params = JOINT;
    params.gear.flexspline.cup.wall = 0.0;
    assert_eq!(wind_up(&params), Err(strainwave::Error::OutOfRange("wall")));
}

#[test]
fn its_micro_steps_are_the_plants_share_of_the_stable_one() {
    assert_eq!(STEP_SHARE, plant::STEP_SHARE as f32);
}
