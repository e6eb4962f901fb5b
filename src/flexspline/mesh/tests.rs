use super::*;
use crate::flexspline::calibration::tests::SIZE_25;

/// Torque on the flange with the ends held at a torsion, after settling.
fn settled_torque<const N: usize, const M: usize>(torsion: f64, wave_generator: f64) -> f64 {
    let dt = 0.7 * Mesh::<f64, N, M>::stable_step(&SIZE_25);
    let mesh = Mesh::<f64, N, M>::build(&SIZE_25, dt).unwrap();
    let ends = Ends {
        drive: Angle::from_radians(torsion),
        wave_generator: Angle::from_radians(wave_generator),
        ..Ends::default()
    };
    let mut state = mesh.rest();
    mesh.relax(&mut state, &ends, 20_000);
    mesh.step(&mut state, &ends).flange
}

#[test]
fn small_torsion_stiffness_is_k1_whatever_the_mesh() {
    for torque in [settled_torque::<8, 3>(1e-5, 0.0), settled_torque::<36, 4>(1e-5, 0.0)] {
        let stiffness = torque / 1e-5;
        assert!((stiffness / 3.1e4 - 1.0).abs() < 1e-4, "{stiffness}");
    }
}

/// Bend links that are up to 2.5 times as stiff where the ellipse strains them leave K1 where it was.
#[test]
fn hardening_bend_links_are_calibrated_where_the_ellipse_holds_them() {
    fn stiffness<const N: usize, const M: usize>(params: &FlexsplineParams<f64>) -> f64 {
        let dt = 0.9 * Mesh::<f64, N, M>::stable_step(params);
        let mesh = Mesh::<f64, N, M>::build(params, dt).unwrap();
        let ends = Ends { drive: Angle::from_radians(1e-5), ..Ends::default() };
        let mut state = mesh.rest();
        mesh.relax(&mut state, &ends, 20_000);
        mesh.step(&mut state, &ends).flange / 1e-5
    }
    let hard = FlexsplineParams { bend: Bend { hardening: 1e5, saturation: 4e-3 }, ..SIZE_25 };
    for stiffness in [stiffness::<8, 3>(&hard), stiffness::<36, 4>(&hard)] {
        assert!((stiffness / 3.1e4 - 1.0).abs() < 5e-3, "{stiffness}");
    }
}

#[test]
fn torque_follows_the_catalogue_up_to_rated() {
    let line = SIZE_25.line.build().unwrap();
    for torsion in [3e-4, 6e-4, 9e-4, 1.2e-3, -1.4e-3] {
        for torque in [settled_torque::<8, 3>(torsion, 0.3), settled_torque::<12, 4>(torsion, 0.3)] {
            assert!((torque - line.torque(torsion)).abs() < 1e-3 * 67.0, "{torque} at {torsion}");
        }
    }
}

/// A coarse ring must not cog: the torque is the same wherever the ellipse stands.
#[test]
fn torque_does_not_depend_on_the_wave_generators_angle() {
    let torque = |angle| settled_torque::<8, 3>(1e-3, angle);
    for angle in [0.05, 0.2, 0.4, 1.0] {
        let ratio = torque(angle) / torque(0.0);
        assert!((ratio - 1.0).abs() < 1e-5, "{ratio} at {angle}");
    }
}

#[test]
fn the_assembled_shape_has_settled() {
    let mesh = Mesh::<f64, 36, 4>::build(&SIZE_25, 0.7 * Mesh::<f64, 36, 4>::stable_step(&SIZE_25)).unwrap();
    let reaction = mesh.step(&mut mesh.rest(), &Ends::default());
    assert!(reaction.flange.abs() < 1e-6 && reaction.ellipse.abs() < 1e-6, "{reaction:?}");
}

/// Twisted at once and left to ring, just below the bound; well above it the same motion diverges.
#[test]
fn the_stable_step_is_stable_and_not_much_too_short() {
    fn rings<const N: usize, const M: usize>(fraction: f64) -> bool {
        let bound = Mesh::<f64, N, M>::stable_step(&SIZE_25);
        let mut mesh = Mesh::<f64, N, M>::build(&SIZE_25, 0.9 * bound).unwrap();
        let mut state = mesh.rest();
        mesh = mesh.with_step(fraction * bound);
        let ends = Ends { drive: Angle::from_radians(1e-3), ..Ends::default() };
        for _ in 0..20_000 {
            mesh.step(&mut state, &ends);
        }
        mesh.largest_strain(&state).unwrap().is_valid()
    }
    assert!(rings::<8, 3>(0.99) && rings::<36, 4>(0.99) && rings::<5, 2>(0.99));
    assert!(!rings::<8, 3>(1.5) && !rings::<36, 4>(1.2));
}

#[test]
fn action_is_reaction() {
    let mesh = Mesh::<f64, 8, 3>::build(&SIZE_25, 1e-6).unwrap();
    let ends = Ends { drive: Angle::from_radians(1e-3), ..Ends::default() };
    let mut state = mesh.rest();
    for _ in 0..50 {
        mesh.step(&mut state, &ends);
        let mut force = [[Ring::ZERO; 3]; 3];
        mesh.shell.pull(&state.shell, &mut force);
        let largest =
            force.iter().flat_map(|slice| *slice[0].entries()).fold(0.0, |m: f64, f| m.max(f.abs()));
        for axis in 0..3 {
            let total: f64 = force.iter().flat_map(|slice| *slice[axis].entries()).sum();
            assert!(total.abs() < 1e-12 * largest, "{total} N left over of {largest} N");
        }
    }
}

/// The flange rings on the mesh at sqrt(K1/J) and loses by the gear file's damping ratio.
#[test]
fn the_torsion_mode_has_its_frequency_and_damping() {
    let dt = 0.7 * Mesh::<f64, 8, 3>::stable_step(&SIZE_25);
    let mesh = Mesh::<f64, 8, 3>::build(&SIZE_25, dt).unwrap();
    let mut state = mesh.rest();
    let mut flange = crate::gear::Motion { angle: Angle::from_radians(1e-4), velocity: 0.0 };
    mesh.relax(&mut state, &Ends { flange: flange.angle, ..Ends::default() }, 5000);
    let (mut crossings, mut peaks) = (std::vec![], std::vec![]);
    for k in 0..(0.25 / dt) as i32 {
        let ends = Ends { flange: flange.angle, flange_rate: flange.velocity, ..Ends::default() };
        let before = (flange.angle.to_radians(), flange.velocity);
        flange.advance(mesh.step(&mut state, &ends).flange / SIZE_25.inertia, dt);
        if before.0 < 0.0 && flange.angle.to_radians() >= 0.0 {
            crossings.push(f64::from(k) * dt);
        }
        if before.1 > 0.0 && flange.velocity <= 0.0 {
            peaks.push(flange.angle.to_radians());
        }
    }
    let periods = crossings.len() - 1;
    let omega = core::f64::consts::TAU * periods as f64 / (crossings[periods] - crossings[0]);
    let expected = (3.1e4f64 / 1.2).sqrt();
    assert!((omega / expected - 1.0).abs() < 1e-3, "{omega} against {expected} rad/s");
    let decrement = (peaks[0] / peaks[peaks.len() - 1]).ln() / (peaks.len() - 1) as f64;
    let ratio = decrement / core::f64::consts::TAU;
    assert!((ratio / 0.02 - 1.0).abs() < 0.02, "damping ratio {ratio}");
}

#[test]
fn what_would_not_be_stable_is_refused_by_name() {
    let dt = Mesh::<f64, 8, 3>::stable_step(&SIZE_25);
    assert_eq!(Mesh::<f64, 8, 3>::build(&SIZE_25, dt).err(), Some(Error::OutOfRange("dt")));
    assert_eq!(Mesh::<f64, 3, 3>::build(&SIZE_25, 1e-7).err(), Some(Error::OutOfRange("n")));
    assert_eq!(Mesh::<f64, 8, 1>::build(&SIZE_25, 1e-7).err(), Some(Error::OutOfRange("m")));
}
