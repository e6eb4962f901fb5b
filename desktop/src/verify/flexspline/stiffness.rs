//! The mesh, settled under torsion, against the stiffness of the gear file.
//!
//! K1 is the torque at a torsion of 10 urad over that torsion; the line is walked as in [`worst_off_line`].

use strainwave::Error;
use strainwave::flexspline::FlexsplineParams;

use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::settled::Settled;
use crate::verify::bounds;
use crate::verify::largest;

/// Torsion small enough for K1 alone (rad).
const SMALL: f64 = 1e-5;
/// An ellipse that stands between two nodes of every mesh here, so that no symmetry hides an error (rad).
const BETWEEN_NODES: f64 = 0.3;
/// Steps in which a mesh settles; twice as many change K1 by less than 1e-8 of it, 72 x 8 too.
const SETTLING: usize = 20_000;
/// Steps from one point of the line to the next; twice as many change none by 1e-7 of the rated torque.
const FROM_POINT_TO_POINT: usize = 4000;
/// Points of the line between zero and rated torque.
const POINTS: i32 = 20;

pub(super) fn measure(file: &GearFile) -> Result<Vec<Figure>, Error> {
    let params = &gear_params(file).flexspline;
    let rated = file.gear.rated_torque;
    Ok(vec![
        bounds::figure("flexspline.8x3.k1", off_k1::<8, 3>(params)?),
        bounds::figure("flexspline.12x3.k1", off_k1::<12, 3>(params)?),
        bounds::figure("flexspline.16x4.k1", off_k1::<16, 4>(params)?),
        bounds::figure("flexspline.36x4.k1", off_k1::<36, 4>(params)?),
        bounds::figure("flexspline.72x8.k1", off_k1::<72, 8>(params)?),
        bounds::figure("flexspline.8x3.line", worst_off_line::<8, 3>(params, rated)?),
        bounds::figure("flexspline.36x4.line", worst_off_line::<36, 4>(params, rated)?),
    ])
}

/// Relative error of the small-torsion stiffness.
pub(super) fn off_k1<const N: usize, const M: usize>(params: &FlexsplineParams<f64>) -> Result<f64, Error> {
    let stiffness = Settled::<N, M>::build(params, SETTLING)?.torque(SMALL, BETWEEN_NODES) / SMALL;
    Ok((stiffness / params.line.stiffness[0] - 1.0).abs())
}

/// Largest distance from the line up to `rated` torque, either sign and both knees, as a fraction of it.
fn worst_off_line<const N: usize, const M: usize>(
    params: &FlexsplineParams<f64>,
    rated: f64,
) -> Result<f64, Error> {
    let line = params.line.build()?;
    worst_off::<N, M>(params, rated, |torsion| line.torque(torsion))
}

/// The same from any law, at the torsions of the line.
pub(super) fn worst_off<const N: usize, const M: usize>(
    params: &FlexsplineParams<f64>,
    rated: f64,
    law: impl Fn(f64) -> f64,
) -> Result<f64, Error> {
    let line = params.line.build()?;
    let mut mesh = Settled::<N, M>::build(params, FROM_POINT_TO_POINT)?;
    let grid = (-POINTS..=POINTS).map(|k| rated * f64::from(k) / f64::from(POINTS));
    let knees = params.line.knee_torque.into_iter().flat_map(|knee| [-knee, knee]);
    let mut torques: Vec<f64> = grid.chain(knees.filter(|knee| knee.abs() < rated)).collect();
    torques.sort_unstable_by(f64::total_cmp);
    let torsions = torques.into_iter().map(|torque| line.torsion(torque));
    let difference = torsions.map(|torsion| mesh.torque(torsion, BETWEEN_NODES) - law(torsion));
    Ok(largest(difference) / rated)
}
