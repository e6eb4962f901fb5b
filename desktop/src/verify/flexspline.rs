//! The mesh, settled under torsion, against the catalogue's line.

use strainwave::Angle;
use strainwave::flexspline::{Ends, Flexspline, FlexsplineParams, Mesh};

use crate::bounds;
use crate::figure::Figure;
use crate::gear_file::GearFile;
use crate::joint::gear_params;

/// Steps in which a mesh settles; twice as many change its torque by less than 1e-9.
const SETTLING: usize = 20_000;
/// Torsion small enough for K1 alone (rad).
const SMALL: f64 = 1e-5;

pub(super) fn measure() -> Vec<Figure> {
    let file = GearFile::default_gear();
    let params = gear_params::<f64>(&file).flexspline;
    let rated = file.gear.rated_torque;
    let coarse = off_catalogue::<8, 3>(&params, rated);
    let reference = off_catalogue::<36, 4>(&params, rated);
    vec![
        bounds::figure("flexspline.8x3.k1", coarse.0),
        bounds::figure("flexspline.36x4.k1", reference.0),
        bounds::figure("flexspline.8x3.line", coarse.1),
        bounds::figure("flexspline.36x4.line", reference.1),
    ]
}

/// Relative error of K1, and the largest distance from the line up to rated torque as a share of it.
fn off_catalogue<const N: usize, const M: usize>(params: &FlexsplineParams<f64>, rated: f64) -> (f64, f64) {
    let stable = Mesh::<f64, N, M>::stable_step(params);
    let mesh = Mesh::<f64, N, M>::build(params, 0.7 * stable).expect("the default gear can be built");
    let line = params.line.build().expect("the default gear has a line");
    let stiffness = settled_torque(&mesh, SMALL) / SMALL;
    let largest = line.torsion(rated);
    let worst = (1..=4)
        .map(|k| largest * f64::from(k) / 4.0)
        .map(|torsion| (settled_torque(&mesh, torsion) - line.torque(torsion)).abs() / rated)
        .fold(0.0, f64::max);
    ((stiffness / params.line.stiffness[0] - 1.0).abs(), worst)
}

fn settled_torque<const N: usize, const M: usize>(mesh: &Mesh<f64, N, M>, torsion: f64) -> f64 {
    // An ellipse that stands between two nodes, so that no symmetry of the ring hides an error.
    let ends = Ends {
        drive: Angle::from_radians(torsion),
        wave_generator: Angle::from_radians(0.3),
        ..Ends::default()
    };
    let mut state = mesh.rest();
    mesh.relax(&mut state, &ends, SETTLING);
    mesh.step(&mut state, &ends).flange
}
