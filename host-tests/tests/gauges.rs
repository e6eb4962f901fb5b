//! Strain gauges and mesh sizes of open-loop runs: what `sim --gauge`, `--mesh` and `--step` rest on.

use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::Path;

use strainwave_desktop::GearFile;
use strainwave_desktop::io::log::{OpenLoop, OpenLoopRow};
use strainwave_desktop::plant::mesh_size::MeshSize;
use strainwave_desktop::plant::two_port::{self, Build, Gauge, Measured};

/// A run of 40 ms over the wave generator's angle and the load at a time.
fn run(build: Build, gauges: &[&str], motion: impl Fn(f64) -> (f64, f64)) -> Vec<OpenLoopRow> {
    let mut text = "t_s,theta_wg_rad,tau_load_nm\n".to_owned();
    for k in 0..=40 {
        let time = f64::from(k) * 1e-3;
        let (angle, load) = motion(time);
        writeln!(text, "{time},{angle},{load}").unwrap();
    }
    let input = OpenLoop::parse(Path::new("in.csv"), text.as_bytes()).unwrap();
    let gauges: Vec<Gauge> = gauges.iter().map(|gauge| gauge.parse().unwrap()).collect();
    let rows = two_port::run(&GearFile::default_gear(), &input, build, &gauges).unwrap();
    rows.collect::<Result<_, _>>().unwrap()
}

fn reference(mesh: MeshSize) -> Build {
    Build::Reference { mesh, longest_step: None }
}

/// Links of all kinds; the rim's own, which the ellipse alone strains, and one at the flange.
const GAUGES: [&str; 5] = ["0,0,1,0", "1,0,1,1", "5,1,-1,1", "2,1,0,-1", "7,0,2,2"];

/// Both builds have the same 8 x 3 links; what the reduction neglects is bounded by `verify flexspline`.
#[test]
fn both_builds_see_the_same_strain() {
    let motion = |t: f64| (30.0 * t, -40.0 * (t / 0.04));
    let literal = run(reference(MeshSize::By8x3), &GAUGES, motion);
    let reduced = run(Build::RealTime, &GAUGES, motion);
    for (literal, reduced) in literal.iter().zip(&reduced) {
        assert_eq!(literal.strains.len(), GAUGES.len());
        for (a, b) in literal.strains.iter().zip(&reduced.strains) {
            assert!((a - b).abs() < 5e-5, "{a} against {b} at {} s", literal.time);
        }
    }
    let largest =
        literal.iter().flat_map(|row| &row.strains).fold(0.0f64, |most, strain| most.max(strain.abs()));
    assert!(largest > 2e-3, "the ellipse has come by: {largest}");
}

#[test]
fn a_link_has_one_strain_whichever_end_it_is_named_by() {
    for build in [reference(MeshSize::By8x3), Build::RealTime] {
        for row in run(build, &["1,0,1,1", "2,1,-1,-1"], |t| (20.0 * t, -20.0)) {
            assert_eq!(row.strains[0], row.strains[1], "{build:?} at {} s", row.time);
        }
    }
}

/// A gauge stands on the flexspline: it feels where the wave generator is, not where the run began.
#[test]
fn where_a_run_begins_does_not_move_its_gauges() {
    const THERE: f64 = 1.3;
    // Around and along the axis: links that the torque of the motion does not strain.
    const GAUGES: [&str; 3] = ["0,0,1,0", "1,1,2,0", "2,0,0,1"];
    // Gently there within half of the run.
    let moved = |t: f64| (THERE * (1.0 - (std::f64::consts::PI * (t / 0.02).min(1.0)).cos()) / 2.0, 0.0);
    for build in [reference(MeshSize::By8x3), Build::RealTime] {
        let came = run(build, &GAUGES, moved);
        let began = run(build, &GAUGES, |_| (THERE, 0.0));
        let (came, began) = (came.last().unwrap(), began.last().unwrap());
        for (a, b) in came.strains.iter().zip(&began.strains) {
            assert!((a - b).abs() < 2e-5, "{build:?}: {a} against {b}");
        }
        let start = run(build, &GAUGES, |_| (0.0, 0.0));
        let change = (start[0].strains[0] - began.strains[0]).abs();
        assert!(change > 1e-3, "{build:?}: the ellipse stands elsewhere: {change}");
    }
}

#[test]
fn every_mesh_size_runs_and_gives_the_same_gear() {
    let motion = |t: f64| (10.0 * t, -30.0 * (t / 0.04));
    let expected = run(Build::REFERENCE, &[], motion);
    for mesh in MeshSize::ALL {
        let rows = run(reference(*mesh), &["0,0,1,1"], motion);
        for (row, expected) in rows.iter().zip(&expected) {
            assert!((row.torsion - expected.torsion).abs() < 1e-6, "{mesh}: {row:?} against {expected:?}");
        }
    }
}

#[test]
fn a_shorter_step_changes_little() {
    let motion = |t: f64| (10.0 * t, -30.0 * (t / 0.04));
    let mesh = MeshSize::By8x3;
    let expected = run(reference(mesh), &[], motion);
    let rows = run(Build::Reference { mesh, longest_step: Some(1e-6) }, &[], motion);
    assert_ne!(rows, expected);
    for (row, expected) in rows.iter().zip(&expected) {
        assert!((row.torsion - expected.torsion).abs() < 1e-7, "{row:?} against {expected:?}");
    }
}

#[test]
fn a_gauge_that_is_none_is_told_what_there_is() {
    let refused = |text: &str| text.parse::<Gauge>().unwrap_err();
    for text in ["", "1,2,3", "1,2,3,4,5", "a,0,1,1", "0,0,1.5,1"] {
        assert_eq!(refused(text), "not I,J,AROUND,ALONG; allowed: four whole numbers");
    }
    assert_eq!(refused("-1,0,1,1"), "I = -1 is out of range; allowed: 0 or more");
    let directions = "direction 3,0 is out of range; allowed, either way: 1,0 0,1 1,1 -1,1 2,0 0,2 2,2 -2,2";
    assert_eq!(refused("0,0,3,0"), directions);
    assert!(
        refused("0,0,0,0").starts_with("direction 0,0") && refused("0,0,1,2").starts_with("direction 1,2")
    );
    let off = |text: &str| text.parse::<Gauge>().unwrap().require_on((36, 4)).unwrap_err();
    assert_eq!(off("36,0,1,1"), "i = 36 is out of range; allowed: 0 to 35 on the 36x4 mesh");
    assert_eq!(off("0,4,1,0"), "j = 4 is out of range; allowed: 0 to 3 on the 36x4 mesh");
    assert_eq!(off("0,2,0,2"), "j + along = 4 is out of range; allowed: 0 to 3 on the 36x4 mesh");
    assert_eq!(off("0,0,1,-1"), "j + along = -1 is out of range; allowed: 0 to 3 on the 36x4 mesh");
    let gauge: Gauge = "35,3,-2,-2".parse().unwrap();
    assert_eq!((gauge.require_on((36, 4)), gauge.column()), (Ok(()), "strain_35_3_-2_-2".into()));
}

/// The flange's forces are the mesh's torque, both ends balance, and they are there in the rows that were asked for. On this mesh a
/// node in the middle has all 16 links.
#[test]
fn the_forces_on_both_ends_carry_the_torque() {
    let mut gear = GearFile::default_gear();
    gear.hysteresis.width_arcmin = 1e-3;
    let text = "t_s,theta_wg_rad,tau_load_nm\n0,0,0\n0.002,0.2,-40\n0.004,0.2,-40\n";
    let input = OpenLoop::parse(Path::new("in.csv"), text.as_bytes()).unwrap();
    let measured = Measured { gauges: &[], forces_every: NonZeroUsize::new(8) };
    let rows = |build| -> Vec<OpenLoopRow> {
        two_port::run_measured(&gear, &input, build, measured).unwrap().collect::<Result<_, _>>().unwrap()
    };
    let radius = gear.flexspline.radius;
    for (k, row) in rows(reference(MeshSize::By36x6)).iter().enumerate() {
        let Some([rim, flange]) = &row.forces else {
            assert!(k % 8 != 0, "{k}");
            continue;
        };
        assert!(k % 8 == 0 && rim.len() == 36 && flange.len() == 36, "{k}");
        let torque = -radius * flange.iter().map(|force| force.tangential).sum::<f64>();
        let hysteresis = 0.02;
        assert!((torque - row.transmitted_torque).abs() < hysteresis, "{torque} {row:?}");
        let pressed = rim.iter().fold(0.0, |most: f64, force| most.max(force.radial));
        assert!(pressed > 10.0, "the wave generator presses the rim outward: {pressed} N");
    }
    assert!(rows(Build::RealTime).iter().all(|row| row.forces.is_none()));
}
