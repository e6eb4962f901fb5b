//! False ripple: what the torque of a flexspline varies by over one revolution of the wave generator at constant torsion, the
//! kinematic error being off. Nothing in the physics does that: it would be the nodes passing under the ellipse.
//!
//! ```text
//! ripple = (largest tau_t - smallest tau_t)/tau_rated
//! ```
//!
//! Real time (f32) through the whole gear, wave generator and flange turning together; the condensed law does not know
//! the wave generator's angle, so what is left is the rounding of the torsion. The literal 8 x 3 mesh settled, angle by
//! angle.

use std::f64::consts::TAU;

use strainwave::compensator::RealTimeGear;
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, GearParams, Motion};
use strainwave::kinematic_error::KinematicErrorParams;
use strainwave::{Angle, Error};

use crate::design::joint::firmware_gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::settled::Settled;
use crate::verify::bounds;
use crate::verify::largest;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Steps of the revolution in real time.
const STEPS: u32 = 10_000;
/// Angles of the revolution at which the mesh settles: its n nodes and they share no divisor.
const ANGLES: u32 = 97;
/// Steps in which it settles from one to the next.
const SETTLING: usize = 4000;

pub(super) fn measure(file: &GearFile) -> Result<Vec<Figure>, Error> {
    let params = firmware_gear_params::<f64>(file)?;
    let torsion = params.flexspline.line.build()?.torsion(params.rated_torque);
    let literal = ripple(&settled(&params, torsion)?) / params.rated_torque;
    let real_time = ripple(&turning(file, torsion)?) / params.rated_torque;
    Ok(vec![
        bounds::figure("flexspline.8x3.ripple", literal),
        bounds::figure("flexspline.real_time.ripple", real_time),
    ])
}

/// From the least to the greatest, all of one sign.
fn ripple(torques: &[f64]) -> f64 {
    let most = largest(torques.iter().copied());
    largest(torques.iter().map(|torque| most - torque.abs()))
}

/// Torques of the literal mesh.
fn settled(params: &GearParams<f64>, torsion: f64) -> Result<Vec<f64>, Error> {
    let mut mesh = Settled::<8, 3>::build(&params.flexspline, SETTLING)?;
    Ok((0..ANGLES).map(|k| mesh.torque(torsion, TAU * f64::from(k) / f64::from(ANGLES))).collect())
}

/// Torques of the real-time gear.
fn turning(file: &GearFile, torsion: f64) -> Result<Vec<f64>, Error> {
    let params =
        GearParams { kinematic_error: KinematicErrorParams::default(), ..firmware_gear_params::<f32>(file)? };
    let flexspline = Reduced::build(&params.flexspline, params.rated_torque)?;
    let gear: RealTimeGear<f32> = params.build(flexspline, CONTROL_PERIOD as f32)?;
    let mut state = gear.rest();
    let step = TAU / f64::from(STEPS);
    let velocity = (step / CONTROL_PERIOD) as f32;
    Ok((0..=STEPS)
        .map(|k| {
            let wave_generator = Motion { angle: Angle::from_radians_f64(step * f64::from(k)), velocity };
            let behind = gear.drive(wave_generator.angle).plus(-torsion as f32);
            let flange = Motion { angle: behind, velocity: gear.ratio().value::<f32>() * velocity };
            f64::from(gear.torques(&mut state, &wave_generator, &flange, Applied::default()).transmitted)
        })
        .collect())
}
