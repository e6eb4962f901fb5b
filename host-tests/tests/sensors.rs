//! Sensors: what is claimed of them, the file of a set, and what they read along a run.

use std::path::Path;

use strainwave_desktop::SensorFile;
use strainwave_desktop::io::LinkFile;
use strainwave_desktop::io::keyed_file::FileKind;
use strainwave_desktop::io::link_file;
use strainwave_desktop::io::log::LinkInputLog;
use strainwave_desktop::plant::link;
use strainwave_desktop::verify::Part;

#[test]
fn every_figure_holds_and_its_bound_is_tight() {
    let measured = Part::Sensor.measure().unwrap();
    assert!(measured.figures.len() >= 10);
    assert!(measured.notes.is_empty() && measured.figures.iter().all(|figure| figure.holds), "{measured:?}");
}

#[test]
fn the_example_is_a_sensor_file() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/sensors/joint.toml");
    assert_eq!(FileKind::at(&path), FileKind::Sensor);
    assert_eq!(SensorFile::read(&path).unwrap(), SensorFile::example());
    assert_eq!(SensorFile::example().names().len(), 6);
}

/// Hanging still the accelerometer carries the weight; moving, twice the integral of what is left is the tip's way across the link.
#[test]
fn the_tip_is_sensed_as_it_moves() {
    let file = LinkFile::parse("l.toml".as_ref(), link_file::EXAMPLE.as_bytes()).unwrap();
    let rows: String =
        (0..=400).map(|k| format!("{},{}\n", 1e-3 * f64::from(k), angle(1e-3 * f64::from(k)))).collect();
    let text = format!("t_s,theta_joint_rad\n{rows}");
    let log = LinkInputLog::parse("in.csv".as_ref(), text.as_bytes(), true).unwrap();
    let rows: Vec<_> = link::run(&file, &log, Some(0.25)).unwrap().rows.collect();
    let first = &rows[0];
    assert!((first.sensed.specific_force - 9.81).abs() < 1e-3, "{:?}", first.sensed);
    assert_eq!(first.sensed.strain, Some(first.strains[1]));
    // Of the place of the tip, second differences along the direction across the link.
    let (dt, mut most) = (1e-4, 0.0_f64);
    for three in rows[1000..3500].windows(3) {
        let joint = three[1].sensed.joint;
        let (sine, cosine) = joint.angle.to_radians().sin_cos();
        let second =
            |axis: usize| (three[2].tip[axis] - 2.0 * three[1].tip[axis] + three[0].tip[axis]) / (dt * dt);
        let across = -sine * second(0) + cosine * second(1) + 9.81 * cosine;
        let error = across - three[1].sensed.specific_force;
        most = most.max((across - 9.81 * cosine).abs());
        assert!(error.abs() < 0.05, "{error} at {}", three[1].time);
    }
    assert!(most > 1.0, "{most}");
}

/// A smooth move of 0.2 rad in 0.4 s (rad).
fn angle(time: f64) -> f64 {
    let x = time / 0.4;
    0.2 * x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3))
}
