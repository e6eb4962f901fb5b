//! Cost of the reference build on this machine, one thread.
//!
//! A step of the 36 x 4 mesh by the clock: the best of many short batches, over its links. A second of plant, S1 under
//! B0: the processor time of the thread, which is the clock's on an idle machine, the best of some runs. Other work on the
//! machine, and another machine, make them slower: they are reported, not judged.

use std::hint::black_box;

use strainwave::flexspline::{Ends, Flexspline, Mesh, Shell};
use strainwave::{Error, Real};

use crate::bench::baseline::Baseline;
use crate::bench::closed_loop;
use crate::bench::scenario::Scenario;
use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;
use crate::plant::vectorised::Vectorised;
use crate::plant::{NODES, STEP_SHARE};
use crate::verify::{Measured, fastest};

/// Batches of steps.
const BATCHES: usize = 5000;
/// Steps of a batch: a tenth of a millisecond, which is seldom interrupted.
const STEPS: usize = 100;
/// Runs of the plant.
const RUNS: usize = 5;

/// The figures of the clock.
///
/// # Errors
/// None with the default gear.
pub fn measure() -> Result<Measured, BadInput> {
    let file = GearFile::default_gear();
    of(&file).map_err(BadInput::message)
}

fn of(file: &GearFile) -> Result<Measured, RunError> {
    Ok(Measured::from(vec![
        Figure::reported("flexspline.36x4.step.f64", step::<f64>(file)?, "ns"),
        Figure::reported("flexspline.36x4.step.f32", step::<f32>(file)?, "ns"),
        Figure::reported("flexspline.36x4.second_of_s1", second_of_plant(file)?, "s"),
    ]))
}

/// Time of a step per link (ns).
fn step<R: Real>(file: &GearFile) -> Result<f64, Error> {
    const N: usize = NODES.0;
    const M: usize = NODES.1;
    let params = &gear_params::<R>(file).flexspline;
    let dt = R::lit(STEP_SHARE) * Mesh::<R, N, M>::stable_step(params);
    let mesh = Vectorised::new(Mesh::<R, N, M>::build(params, dt)?);
    // All turns at one speed, so that no node rests.
    let rate = R::lit(10.0);
    let mut ends = Ends { drive_rate: rate, flange_rate: rate, wave_generator_rate: rate, ..Ends::default() };
    let mut state = mesh.rest();
    let best = fastest(BATCHES, || {
        for _ in 0..STEPS {
            ends.drive = ends.drive.plus(dt * rate);
            (ends.flange, ends.wave_generator) = (ends.drive, ends.drive);
            black_box(mesh.step(&mut state, &ends));
        }
    });
    Ok(best * 1e9 / (STEPS * Shell::<R, N, M>::links()) as f64)
}

/// Seconds that a second of plant takes.
fn second_of_plant(file: &GearFile) -> Result<f64, RunError> {
    let mut best = f64::MAX;
    for _ in 0..RUNS {
        let started = processor_time();
        closed_loop::run(file, Scenario::S1, 0, &mut Baseline::b0(file)?, |_| ())?;
        best = best.min(processor_time() - started);
    }
    Ok(best / Scenario::S1.duration())
}

/// Processor time of this thread (s): the clock's time on an idle machine.
fn processor_time() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
