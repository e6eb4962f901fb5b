//! A reference run that diverges ends with the time and the node.

use std::path::Path;

use strainwave::compensator::{Input, Output};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::closed_loop;
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::design::joint::firmware_gear_params;
use strainwave_desktop::io::log::OpenLoop;
use strainwave_desktop::plant::Plant;
use strainwave_desktop::plant::divergence::{Diverged, RunError};
use strainwave_desktop::plant::mesh_size::MeshSize;
use strainwave_desktop::plant::two_port::{self, Build};

/// End of a run of 10 ms whose wave generator jumps to `angle` (rad), with the load (N m), from 5 ms on.
fn run(build: Build, angle: f64, load: f64) -> Result<usize, Diverged> {
    let rows = (0..100).map(|k| {
        let jumped = if k < 50 { 0.0 } else { 1.0 };
        format!("{},{},{}\n", 2.0 + f64::from(k) * 1e-4, angle * jumped, load * jumped)
    });
    let text = "t_s,theta_wg_rad,tau_load_nm\n".to_owned() + &rows.collect::<String>();
    let input = OpenLoop::parse(Path::new("in.csv"), text.as_bytes()).unwrap();
    let rows = two_port::run(&GearFile::default_gear(), &input, build, &[]).unwrap();
    match rows.collect::<Result<Vec<_>, _>>() {
        Ok(rows) => Ok(rows.len()),
        Err(RunError::Diverged(diverged)) => Err(diverged),
        Err(RunError::Parameter(error)) => panic!("{error}"),
    }
}

fn check(diverged: Diverged, (n, m): (usize, usize), from: f64, to: f64) {
    let Diverged { time, node: (i, j), strain } = diverged;
    assert!((from..=to).contains(&time) && i < n && j < m, "{diverged:?}");
    assert!(strain.is_nan() || strain.abs() > 0.1, "{diverged:?}");
}

#[test]
fn a_jump_of_the_wave_generator_is_named_where_it_happens() {
    for mesh in [MeshSize::By8x3, MeshSize::By36x4] {
        let build = Build::Reference { mesh, longest_step: None };
        // Within one row: too much for the links; and so much that no number is left within the row.
        for angle in [100.0, 1e4] {
            check(run(build, angle, 0.0).unwrap_err(), mesh.nodes(), 2.0049, 2.0051);
        }
        assert_eq!(run(build, 0.2, 0.0), Ok(100));
    }
}

#[test]
fn a_load_that_no_cup_carries_is_named_when_the_links_give_in() {
    for mesh in [MeshSize::By8x3, MeshSize::By36x4] {
        let build = Build::Reference { mesh, longest_step: None };
        check(run(build, 0.0, -1e5).unwrap_err(), mesh.nodes(), 2.005, 2.0099);
    }
}

#[test]
fn the_real_time_build_has_no_links_and_ends_at_its_range() {
    assert_eq!(run(Build::RealTime, 1e4, -1e5), Ok(100));
}

#[test]
fn the_plant_names_the_period() {
    let mut plant = Plant::build(&firmware_gear_params(&GearFile::default_gear()).unwrap()).unwrap();
    for _ in 0..10 {
        plant.step(0.1, -50.0).unwrap();
        plant.step_blocked(-50.0).unwrap();
    }
    let mut blocked = (0..100).map(|_| plant.step_blocked(-1e6));
    let diverged = blocked.find_map(Result::err).expect("the load is beyond any cup");
    check(diverged, (36, 4), 0.0020, 0.0120);
}

/// A controller that asks for what no motor has.
struct Runaway;

impl Controller for Runaway {
    type Error = RunError;

    fn step(&mut self, _input: &Input<f32>) -> Result<Output<f32>, RunError> {
        Ok(Output { motor_torque: 1e9, ..Output::default() })
    }
}

#[test]
fn a_closed_loop_ends_with_one_line() {
    let run = closed_loop::run(&GearFile::default_gear(), Scenario::S2, 0, &mut Runaway, |_| ());
    let line = run.unwrap_err().to_string();
    assert!(line.starts_with("diverged at 0.00") && line.contains("node (i, j) = ("), "{line}");
    assert!(line.ends_with("allowed: 0.1 either way") && !line.contains('\n'), "{line}");
}
