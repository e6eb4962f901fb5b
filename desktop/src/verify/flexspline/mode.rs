//! The torsion mode, wave generator held, flange let go from a small torsion: real time against reference.
//!
//! Default gear without friction and hysteresis, stepped by [`Gear::step`]: f32 every 0.1 ms, and f64 with the 36 x 4
//! mesh in micro-steps. Frequency from the zero crossings of the torsion, damping ratio zeta from the peaks p between
//! them:
//!
//! ```text
//! f = (crossings - 1)/(2*(t_last - t_first))
//! delta = ln(p_first/p_last)/(peaks - 1),   zeta = delta/sqrt(pi^2 + delta^2)
//! ```
//!
//! A small torsion is a tenth of the first knee's.

use std::f64::consts::PI;

use strainwave::compensator::RealTimeGear;
use strainwave::flexspline::{Flexspline, Reduced};
use strainwave::friction::FrictionModel;
use strainwave::gear::{Applied, Gear, GearParams, Motion};
use strainwave::{Error, Real};

use crate::design::joint::firmware_gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::{NODES, Reference, ReferenceGear};
use crate::verify::bounds;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Torsion at first (rad).
const RELEASED_FROM: f64 = 4e-5;
/// Time for which the flange is held there, for the mesh to settle (s).
const HELD: f64 = 0.02;
/// Time of the ringing (s).
const RINGING: f64 = 0.5;

pub(super) fn measure(file: &GearFile) -> Result<Vec<Figure>, Error> {
    let params: GearParams<f64> = frictionless(firmware_gear_params(file)?);
    let Reference { mesh, dt, .. } = Reference::<{ NODES.0 }, { NODES.1 }>::build(&params.flexspline, None)?;
    let gear: ReferenceGear<_> = params.build(mesh, dt)?;
    let reference = Mode::of(&gear, dt);
    let params: GearParams<f32> = frictionless(firmware_gear_params(file)?);
    let flexspline = Reduced::build(&params.flexspline, params.rated_torque)?;
    let gear: RealTimeGear<f32> = params.build(flexspline, CONTROL_PERIOD as f32)?;
    let real_time = Mode::of(&gear, CONTROL_PERIOD);
    let difference = |of: fn(&Mode) -> f64| (of(&real_time) / of(&reference) - 1.0).abs();
    Ok(vec![
        bounds::figure("flexspline.torsion_mode.frequency", difference(|mode| mode.frequency)),
        bounds::figure("flexspline.torsion_mode.damping_ratio", difference(|mode| mode.damping_ratio)),
    ])
}

fn frictionless<R: Real>(mut params: GearParams<R>) -> GearParams<R> {
    params.hysteresis_width = R::ZERO;
    for friction in [&mut params.input_friction, &mut params.output_friction] {
        friction.scale(R::ZERO);
    }
    params
}

/// Frequency (Hz) and damping ratio.
#[derive(Clone, Copy, Debug)]
struct Mode {
    frequency: f64,
    damping_ratio: f64,
}

impl Mode {
    /// Lets the flange of a gear that is stepped by dt (s) go.
    fn of<R: Real, F: Flexspline<R>, C: FrictionModel<R>, const L: usize, const MEMORY: usize>(
        gear: &Gear<R, F, C, L, MEMORY>,
        dt: f64,
    ) -> Self {
        let mut state = gear.rest();
        let wave_generator = Motion::default();
        // Behind the kinematic error at this angle.
        let drive = gear.drive(wave_generator.angle);
        let mut flange = Motion { angle: drive.plus(R::lit(-RELEASED_FROM)), velocity: R::ZERO };
        for _ in 0..(HELD / dt) as usize {
            gear.torques(&mut state, &wave_generator, &flange, Applied::default());
        }
        let torsions = (0..(RINGING / dt) as usize)
            .map(|_| gear.step(&mut state, &mut flange, &wave_generator, R::ZERO).torsion.to_f64());
        Self::found_in(&torsions.collect::<Vec<_>>(), dt)
    }

    /// From the torsion, sampled every dt (s).
    fn found_in(torsions: &[f64], dt: f64) -> Self {
        let mut crossings = Vec::new();
        let mut peaks = Vec::new();
        let mut peak = 0.0f64;
        for (k, pair) in torsions.windows(2).enumerate() {
            peak = peak.max(pair[0].abs());
            if (pair[0] < 0.0) != (pair[1] < 0.0) {
                crossings.push(dt * (k as f64 + pair[0] / (pair[0] - pair[1])));
                peaks.push(std::mem::take(&mut peak));
            }
        }
        let half_turns = crossings.len() as f64 - 1.0;
        let decrement = (peaks[0] / peaks[peaks.len() - 1]).ln() / half_turns;
        Self {
            frequency: half_turns / (2.0 * (crossings[crossings.len() - 1] - crossings[0])),
            damping_ratio: decrement / (PI * PI + decrement * decrement).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequency_and_damping_of_a_known_ringing_are_found() {
        let (omega, zeta) = (160.0, 0.03);
        let torsion =
            |t: f64| 1e-4 * (-zeta * omega * t).exp() * (omega * (1.0f64 - zeta * zeta).sqrt() * t).cos();
        let samples: Vec<f64> = (0..5000).map(|k| torsion(CONTROL_PERIOD * f64::from(k))).collect();
        let Mode { frequency, damping_ratio } = Mode::found_in(&samples, CONTROL_PERIOD);
        let expected = omega * (1.0 - zeta * zeta).sqrt() / (2.0 * PI);
        assert!((frequency / expected - 1.0).abs() < 1e-6, "{frequency} Hz, expected {expected}");
        assert!((damping_ratio / zeta - 1.0).abs() < 1e-2, "{damping_ratio}");
    }
}
