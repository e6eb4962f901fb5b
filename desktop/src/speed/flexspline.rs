//! The flexspline: torque of the real-time law, the literal mesh of the same size over one control period beside it, and a
//! step of the reference mesh for each of its links.

use std::hint::black_box;

use strainwave::compensator::RealTimeFlexspline;
use strainwave::flexspline::{Ends, Flexspline, FlexsplineParams, Mesh, Shell};
use strainwave::{Error, Real};

use super::{Kernel, floor};
use crate::design::joint::gear_params;
use crate::io::gear_file::GearFile;
use crate::plant::vectorised::Vectorised;
use crate::plant::{NODES, STEP_SHARE};
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// The rival of the literal mesh.
const REDUCED: &str = "flexspline.reduced_8x3";
/// The rival of single precision.
const DOUBLE: &str = "flexspline.link_36x4_f64";
/// Torsions of a pass of the real-time law.
const TORSIONS: usize = 1024;
/// Largest of them (rad): beyond both knees of the default gear's line.
const LARGEST: f64 = 2e-3;
/// Steps of a pass of the reference mesh.
const STEPS: usize = 100;
/// Speed at which all turns, so that no node rests (rad/s).
const RATE: f64 = 10.0;

pub(super) fn kernels(file: &GearFile) -> Result<Vec<Kernel>, Error> {
    let single = gear_params::<f32>(file);
    let double = gear_params::<f64>(file);
    Ok(vec![
        reduced(RealTimeFlexspline::build(&single.flexspline, single.rated_torque)?),
        literal(&single.flexspline)?,
        link(DOUBLE, floor::NAME, &double.flexspline)?,
        link("flexspline.link_36x4_f32", DOUBLE, &single.flexspline)?,
    ])
}

fn reduced(model: RealTimeFlexspline<f32>) -> Kernel {
    let torsion = |k: usize| LARGEST * (2.0 * k as f64 / TORSIONS as f64 - 1.0);
    let torsions: Vec<f32> = (0..TORSIONS).map(|k| torsion(k) as f32).collect();
    Kernel::new(REDUCED, floor::NAME, TORSIONS, move || {
        for torsion in &torsions {
            black_box(model.torque(*torsion, 0.0));
        }
    })
}

/// A control period of the coarsest mesh, in as many steps as it needs.
fn literal(params: &FlexsplineParams<f32>) -> Result<Kernel, Error> {
    let stable = STEP_SHARE * f64::from(Mesh::<f32, 8, 3>::stable_step(params));
    let steps = (CONTROL_PERIOD / stable) as usize + 1;
    let mut turning = Turning::<f32, 8, 3>::build(params, (CONTROL_PERIOD / steps as f64) as f32)?;
    Ok(Kernel::new("flexspline.literal_8x3", REDUCED, 1, move || turning.step(steps)))
}

fn link<R: Real>(
    name: &'static str,
    rival: &'static str,
    params: &FlexsplineParams<R>,
) -> Result<Kernel, Error> {
    const N: usize = NODES.0;
    const M: usize = NODES.1;
    let dt = R::lit(STEP_SHARE) * Mesh::<R, N, M>::stable_step(params);
    let mut turning = Turning::<R, N, M>::build(params, dt)?;
    Ok(Kernel::new(name, rival, STEPS * Shell::<R, N, M>::links(), move || turning.step(STEPS)))
}

/// A mesh that turns as a whole.
struct Turning<R: Real, const N: usize, const M: usize> {
    mesh: Vectorised<Mesh<R, N, M>>,
    state: <Mesh<R, N, M> as Flexspline<R>>::State,
    ends: Ends<R>,
    dt: R,
}

impl<R: Real, const N: usize, const M: usize> Turning<R, N, M> {
    fn build(params: &FlexsplineParams<R>, dt: R) -> Result<Self, Error> {
        let mesh = Vectorised::new(Mesh::build(params, dt)?);
        let (state, rate) = (mesh.rest(), R::lit(RATE));
        let ends = Ends { drive_rate: rate, flange_rate: rate, wave_generator_rate: rate, ..Ends::default() };
        Ok(Self { mesh, state, ends, dt })
    }

    fn step(&mut self, steps: usize) {
        for _ in 0..steps {
            let ends = &mut self.ends;
            ends.drive = ends.drive.plus(self.dt * ends.drive_rate);
            (ends.flange, ends.wave_generator) = (ends.drive, ends.drive);
            black_box(self.mesh.step(&mut self.state, ends));
        }
    }
}
