//! The gear as a two-port: laws that hold for both builds, and how far the builds are apart.

use std::path::Path;

use proptest::prelude::*;
use strainwave::friction::ModelName;
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::firmware_gear_params;
use strainwave_desktop::io::gear_file::{Backward, DEFAULT, Friction};
use strainwave_desktop::io::log::{OpenLoop, OpenLoopRow};
use strainwave_desktop::plant::Plant;
use strainwave_desktop::plant::two_port::{self, Build};

const BUILDS: [Build; 2] = [Build::REFERENCE, Build::RealTime];

/// A run over rows (t, wave generator, load), the wave generator's column being `drive`.
fn run(
    gear: &GearFile,
    drive: &str,
    rows: impl Iterator<Item = (f64, f64, f64)>,
    build: Build,
) -> Vec<OpenLoopRow> {
    let mut text = format!("t_s,{drive},tau_load_nm\n");
    rows.for_each(|(time, wave_generator, load)| text += &format!("{time},{wave_generator},{load}\n"));
    let input = OpenLoop::parse(Path::new("in.csv"), text.as_bytes()).unwrap();
    two_port::run(gear, &input, build, &[]).unwrap().collect::<Result<_, _>>().unwrap()
}

fn times(duration: f64) -> impl Iterator<Item = f64> {
    let rows = (duration * 1e3).round() as i32;
    (0..=rows).map(|k| f64::from(k) * 1e-3)
}

#[test]
fn at_rest_nothing_happens() {
    let gear = GearFile::default_gear();
    for build in BUILDS {
        for start in [0.0, -2.5, 1e6] {
            let rows = run(&gear, "theta_wg_rad", times(0.02).map(|t| (t, start, 0.0)), build);
            assert_eq!(rows.len(), 201);
            for row in rows {
                assert!(row.output_velocity.abs() < 1e-5, "{build:?} {start} {row:?}");
                assert!(
                    row.torsion.abs() < 1e-7 && row.transmitted_torque.abs() < 0.01,
                    "{build:?} {start} {row:?}"
                );
                // Apart from the kinematic error the output stands at r*theta_wg.
                assert!((row.output_position + start / 100.0).abs() < 1.3e-4, "{build:?} {start} {row:?}");
            }
        }
    }
}

/// With the wave generator held, the load ends up in the flexspline but for the output's friction.
#[test]
fn a_load_winds_the_gear_up_along_the_catalogues_line() {
    let gear = GearFile::default_gear();
    let load = |t: f64| -50.0 * (t / 0.3).min(1.0);
    for build in BUILDS {
        let rows = run(&gear, "theta_wg_rad", times(0.6).map(|t| (t, 0.0, load(t))), build);
        let last = rows.last().unwrap();
        let friction = gear.friction.output.static_level.unwrap();
        assert!((last.transmitted_torque - 50.0).abs() < 1.2 * friction, "{build:?} {last:?}");
        let torsion = 14.0 / 3.1e4 + 34.0 / 5.0e4 + 2.0 / 5.7e4;
        assert!(
            (last.torsion - torsion).abs() < 0.5 * gear.hysteresis.width() + friction / 3e4,
            "{build:?} {last:?}"
        );
        assert!((last.output_position + last.torsion).abs() < 1e-6, "the output gives way to the load");
        // tau_wg holds r*tau_t, and friction stays within its level.
        let reflected = -last.transmitted_torque / 100.0;
        assert!(
            (last.input_torque - reflected).abs() < gear.friction.input.static_level.unwrap(),
            "{build:?} {last:?}"
        );
    }
}

#[test]
fn an_input_that_starts_at_speed_starts_a_gear_that_runs() {
    let mut gear = GearFile::default_gear();
    gear.kinematic_error.wave_generator.clear();
    for build in BUILDS {
        let by_speed = run(&gear, "omega_wg_rad_s", times(0.1).map(|t| (t, 50.0, 0.0)), build);
        let by_angle = run(&gear, "theta_wg_rad", times(0.1).map(|t| (t, 50.0 * t, 0.0)), build);
        for (speed, angle) in by_speed.iter().zip(&by_angle) {
            assert!((speed.output_velocity + 0.5).abs() < 0.02, "{build:?} {speed:?}");
            assert!(
                (speed.output_position - angle.output_position).abs() < 1e-9,
                "{build:?} {speed:?} {angle:?}"
            );
            assert!((speed.input_torque - angle.input_torque).abs() < 1e-3, "{build:?} {speed:?} {angle:?}");
        }
    }
}

/// Whole revolutions change nothing but the output's place; part of a revolution changes the kinematic error's
/// phase, as moving there first does.
#[test]
fn where_the_wave_generator_starts_is_only_a_phase() {
    let gear = GearFile::default_gear();
    let motion = |start: f64| times(0.1).map(move |t| (t, start + 20.0 * t, -10.0));
    for build in BUILDS {
        let from_zero = run(&gear, "theta_wg_rad", motion(0.0), build);
        let turned = run(&gear, "theta_wg_rad", motion(1000.0 * std::f64::consts::TAU), build);
        for (zero, turned) in from_zero.iter().zip(&turned) {
            let moved = turned.output_position - zero.output_position;
            assert!((moved + 10.0 * std::f64::consts::TAU).abs() < 1e-8, "{build:?} {zero:?} {turned:?}");
            assert!((turned.torsion - zero.torsion).abs() < 1e-8, "{build:?} {zero:?} {turned:?}");
        }
        let e = |theta: f64| 1e-4 * (2.0 * theta).sin() + 2e-5 * (4.0 * theta).sin();
        let first = &run(&gear, "theta_wg_rad", motion(0.7), build)[0];
        assert!((first.output_position - (-0.007 + e(0.7))).abs() < 1e-9, "{build:?} {first:?}");
    }
}

/// A gear that runs from the first row on shows its level: of the direction, of the angle that it starts at.
#[test]
fn friction_follows_direction_and_angle_from_any_start() {
    let mut gear = GearFile::default_gear();
    let mut frictionless = gear.clone();
    frictionless.friction.input =
        Friction { model: ModelName::Viscous, viscous: Some(0.0), ..gear.friction.input.clone() };
    let side = &mut gear.friction.input;
    side.presliding = Some(2e-3);
    side.ripple_cosines = Some(vec![0.3, 0.1]);
    side.backward = Some(Backward {
        coulomb: Some(0.06),
        static_level: Some(0.06),
        ripple_sines: Some(vec![0.4]),
        ..Backward::default()
    });
    for build in BUILDS {
        for start in [0.0f64, 0.7, 3.0, -2.0] {
            // Without the ellipse's reaction, which the mesh has besides.
            let torque = |speed: f64| {
                let [with, without] = [&gear, &frictionless].map(|gear| {
                    let motion = times(0.01).map(|t| (t, start + speed * t, 0.0));
                    run(gear, "theta_wg_rad", motion, build)[0].input_torque
                });
                with - without
            };
            let even = 1.0 + 0.3 * start.cos() + 0.1 * (2.0 * start).cos();
            let forwards = (0.035 + 0.015 * (-25.0f64).exp()) * even + 1.2e-4 * 50.0;
            let backwards = 0.06 * (even + 0.4 * start.sin()) + 1.2e-4 * 50.0;
            let (there, back) = (torque(50.0), torque(-50.0));
            assert!((there - forwards).abs() < 2e-4, "{build:?} {start}: {there} {forwards}");
            assert!((back + backwards).abs() < 2e-4, "{build:?} {start}: {back} {backwards}");
        }
    }
}

#[test]
fn both_arrangements_turn_the_right_way() {
    let lara8 = include_bytes!("../../gears/lara8-j5.toml");
    let gear = GearFile::parse(Path::new("lara8-j5.toml"), lara8).unwrap();
    for build in BUILDS {
        let rows = run(&gear, "omega_wg_rad_s", times(0.05).map(|t| (t, 101.0, 0.0)), build);
        assert!((rows.last().unwrap().output_velocity - 1.0).abs() < 0.1, "{build:?} {:?}", rows.last());
    }
}

/// The default gear with `factors` on its numbers, one after the other, when that is still a gear.
fn scaled(factors: &[f64]) -> Option<GearFile> {
    let mut factors = factors.iter();
    let (gear, _baselines) = DEFAULT.split_once("\n[baselines").unwrap_or((DEFAULT, ""));
    let lines = gear.lines().map(|line| match line.split_once(" = ") {
        Some((key, value)) if value.parse::<f64>().is_ok() && value.contains(['.', 'e']) => {
            let factor = factors.next().expect("a factor for every number");
            format!("{key} = {:e}", value.parse::<f64>().unwrap() * factor)
        }
        _ => line.to_owned(),
    });
    let text = lines.collect::<Vec<_>>().join("\n");
    GearFile::parse(Path::new("g.toml"), text.as_bytes()).ok()
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 100_000, ..ProptestConfig::with_cases(100) })]

    /// A gear file that passes the checks is a gear: it is built, and its output is finite.
    #[test]
    fn every_accepted_gear_runs(powers in prop::collection::vec(prop_oneof![Just(0.0), -1.0..1.0f64], 60)) {
        let factors: Vec<f64> = powers.iter().map(|power| 10f64.powf(*power)).collect();
        let gear = scaled(&factors);
        prop_assume!(gear.is_some());
        let gear = gear.unwrap();
        prop_assert!(Plant::build(&firmware_gear_params(&gear).unwrap()).is_ok());
        let input = times(0.02).map(|t| (t, 300.0 * t, -100.0));
        let rows = run(&gear, "theta_wg_rad", input, Build::RealTime);
        for row in rows {
            prop_assert!(row.torsion.is_finite() && row.output_velocity.is_finite(), "{row:?}");
            prop_assert!(row.input_torque.is_finite() && row.transmitted_torque.is_finite(), "{row:?}");
        }
    }
}
