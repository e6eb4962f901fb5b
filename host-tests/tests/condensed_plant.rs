//! The plant with its mesh condensed against the reference plant, in the same closed loop.

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::baseline::Baseline;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::plant::Plant;
use strainwave_desktop::verify::bounds;

use strainwave::flexspline::Flexspline;

/// Output and torsion (rad), a row each control period.
fn motion<F: Flexspline<f64>>(mut bench: Bench<F>, file: &GearFile, scenario: Scenario) -> Vec<[f64; 2]> {
    let mut rows = Vec::new();
    let mut visit =
        |plant: &Plant<F>| rows.push([plant.output().angle.to_radians(), plant.last_torques().torsion]);
    let mut controller = Baseline::b0(file).unwrap();
    bench.go(&scenario, &mut controller, |_, _, plant, _| visit(plant)).unwrap();
    rows
}

fn agrees(scenario: Scenario) {
    let file = GearFile::default_gear();
    let conditions = Conditions::of(&file, 1);
    let reference = motion(Bench::build(&file, &conditions).unwrap(), &file, scenario);
    let condensed = motion(Bench::condensed(&file, &conditions).unwrap(), &file, scenario);
    let figures =
        ["plant.condensed.output", "plant.condensed.torsion"].iter().enumerate().map(|(k, name)| {
            let off = reference.iter().zip(&condensed).map(|(a, b)| (a[k] - b[k]).abs());
            bounds::figure(name, off.fold(0.0, f64::max))
        });
    let figures: Vec<_> = figures.collect();
    assert!(figures.iter().all(|figure| figure.holds), "{scenario:?}: {figures:?}");
    println!("{scenario:?}: {figures:?}");
}

#[test]
fn in_s1() {
    agrees(Scenario::S1);
}

#[test]
fn in_s3() {
    agrees(Scenario::S3);
}

#[test]
fn in_s5() {
    agrees(Scenario::S5);
}
