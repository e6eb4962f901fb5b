//! The free shell against an engine that shares no code with it: MuJoCo's positions, stored in `desktop/oracle`.

use strainwave_desktop::verify::flexspline::oracle::Problem;

/// Target of the largest distance (m); the table of bounds holds a tighter one.
const TARGET: f64 = 1e-12;

#[test]
fn the_free_shell_moves_as_mujocos_at_every_stored_step() {
    let distances = Problem::stored().distances();
    assert_eq!(distances.keys().copied().collect::<Vec<_>>(), [10, 100, 1000]);
    for (step, distance) in distances {
        assert!(distance <= TARGET, "{distance:e} m after {step} steps");
    }
}

/// Sensitivity of the oracle.
#[test]
fn either_link_constant_off_by_1e_8_of_itself_shows() {
    let mut stiffer = Problem::stored();
    stiffer.shell.link_stiffness_n_per_m *= 1.0 + 1e-8;
    let mut stickier = Problem::stored();
    stickier.shell.link_damping_n_s_per_m *= 1.0 + 1e-8;
    for problem in [stiffer, stickier] {
        assert!(problem.distances()[&1000] > TARGET);
    }
}
