//! The mesh with this processor's vector instructions: bit for bit the mesh without them, in motion and settling.

use strainwave::Angle;
use strainwave::flexspline::{Ends, Flexspline, Mesh};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::gear_params;
use strainwave_desktop::plant::vectorised::Vectorised;

/// Angles 1 mrad apart, the ends in motion.
fn ends() -> Ends<f64> {
    let (drive, wave_generator) = (Angle::from_radians(1e-3), Angle::from_radians(0.3));
    Ends { drive, wave_generator, drive_rate: 1.0, wave_generator_rate: -100.0, ..Ends::default() }
}

fn same_bits<const N: usize, const M: usize>() {
    let params = gear_params::<f64>(&GearFile::default_gear()).flexspline;
    let mesh = Mesh::<f64, N, M>::build(&params, 0.7 * Mesh::<f64, N, M>::stable_step(&params)).unwrap();
    let vectorised = Vectorised::new(mesh.clone());
    let (mut own, ends) = (mesh.rest(), ends());
    let mut other = own;
    for _ in 0..200 {
        assert_eq!(mesh.step(&mut own, &ends), vectorised.step(&mut other, &ends));
    }
    assert_eq!(own, other);
    mesh.relax(&mut own, &ends, 200);
    vectorised.relax(&mut other, &ends, 200);
    assert_eq!(own, other);
    assert_ne!(own, mesh.rest(), "it has moved");
}

#[test]
fn a_coarse_mesh() {
    same_bits::<8, 3>();
}

#[test]
fn the_plants_mesh() {
    same_bits::<36, 4>();
}
