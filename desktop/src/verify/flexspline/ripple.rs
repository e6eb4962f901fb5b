//! False ripple of the literal 8 x 3 mesh: what its torques vary by over one revolution of the wave generator at rated torsion,
//! the kinematic error being off. Nothing in the physics does that: it is the nodes passing under the ellipse.
//!
//! ```text
//! ripple   = (largest tau_t - smallest tau_t)/tau_rated
//! reaction = max |torque on the wave generator from rotating the ellipse|
//! ```
//!
//! The mesh settles angle by angle. The condensed law has neither: it does not know the wave generator's angle.

use std::f64::consts::TAU;

use strainwave::Error;
use strainwave::flexspline::Reaction;

use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::settled::Settled;
use crate::verify::bounds;
use crate::verify::largest;

/// Angles of the revolution at which the mesh settles: its n nodes and they share no divisor.
const ANGLES: u32 = 97;
/// Steps in which it settles from one to the next.
const SETTLING: usize = 4000;

pub(super) fn measure(file: &GearFile) -> Result<Vec<Figure>, Error> {
    named(file, ["flexspline.8x3.ripple", "flexspline.8x3.ellipse_reaction"])
}

/// Ripple and reaction of a gear, by these names.
pub(super) fn named(file: &GearFile, names: [&'static str; 2]) -> Result<Vec<Figure>, Error> {
    let reactions = revolution(file)?;
    let torques: Vec<f64> = reactions.iter().map(|reaction| reaction.flange).collect();
    let reaction = largest(reactions.iter().map(|reaction| reaction.ellipse));
    Ok(vec![
        bounds::figure(names[0], ripple(&torques) / file.gear.rated_torque),
        bounds::figure(names[1], reaction),
    ])
}

/// From the least to the greatest, all of one sign.
fn ripple(torques: &[f64]) -> f64 {
    let most = largest(torques.iter().copied());
    largest(torques.iter().map(|torque| most - torque.abs()))
}

/// Torques of the mesh, angle by angle.
fn revolution(file: &GearFile) -> Result<Vec<Reaction<f64>>, Error> {
    let params = gear_params(file).flexspline;
    let torsion = params.line.build()?.torsion(file.gear.rated_torque);
    let mut mesh = Settled::<8, 3>::build(&params, SETTLING)?;
    Ok((0..ANGLES).map(|k| mesh.reaction(torsion, TAU * f64::from(k) / f64::from(ANGLES))).collect())
}
