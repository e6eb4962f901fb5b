//! The real-time gear, 8 x 3 in f32 every 0.1 ms, against the reference, 36 x 4 in f64: torque through the flexspline.
//!
//! The default joint runs S1, S3 and S6 on the plant that its controller knows, under the cascade B0 (S6: brake). The
//! speed of its wave generator and its load, row by row, then drive both builds of the two-port. As a fraction of rated
//! torque.

use std::thread;

use strainwave::flexspline::{Flexspline, Reduced};

use crate::bench::baseline::Baseline;
use crate::bench::closed_loop;
use crate::bench::scenario::Scenario;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;
use crate::plant::two_port::{self, Build};
use crate::verify::bounds;
use crate::verify::largest;

/// Seed of the plant that the controller knows.
const NOMINAL: u64 = 0;
/// Scenarios, with their figures' names: rms and largest.
type Scenarios = [(Scenario, &'static str, &'static str); 3];

const SCENARIOS: Scenarios = [
    (Scenario::S1, "flexspline.real_time.s1.rms", "flexspline.real_time.s1.max"),
    (Scenario::S3, "flexspline.real_time.s3.rms", "flexspline.real_time.s3.max"),
    (Scenario::S6, "flexspline.real_time.s6.rms", "flexspline.real_time.s6.max"),
];

/// The flexspline of the real-time gear.
type RealTime = Reduced<f32, 8, 3>;

pub(super) fn measure(file: &GearFile) -> Result<Vec<Figure>, RunError> {
    let size = size_of::<RealTime>() + size_of::<<RealTime as Flexspline<f32>>::State>();
    let mut figures = vec![bounds::figure("flexspline.real_time.size", size as f64)];
    figures.extend(over(SCENARIOS, file)?);
    Ok(figures)
}

/// The differences of a gear's builds over scenarios.
pub(super) fn over(scenarios: Scenarios, file: &GearFile) -> Result<Vec<Figure>, RunError> {
    let mut figures = Vec::new();
    let runs: Vec<_> = thread::scope(|scope| {
        let runs = scenarios.map(|(scenario, _, _)| scope.spawn(move || Difference::over(scenario, file)));
        runs.into_iter()
            .map(|run| run.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    for ((_, rms, max), difference) in scenarios.into_iter().zip(runs) {
        let difference = difference?;
        figures.push(bounds::figure(rms, difference.rms));
        figures.push(bounds::figure(max, difference.max));
    }
    Ok(figures)
}

/// Of the transmitted torques of both builds, as a fraction of rated torque.
struct Difference {
    rms: f64,
    max: f64,
}

impl Difference {
    fn over(scenario: Scenario, file: &GearFile) -> Result<Self, RunError> {
        let record = closed_loop::record(file, scenario, NOMINAL, &mut Baseline::b0(file)?)?;
        let reference = two_port::run(file, &record, Build::REFERENCE, &[])?;
        let real_time = two_port::run(file, &record, Build::RealTime, &[])?;
        let difference: Vec<f64> = reference
            .zip(real_time)
            .map(|(a, b)| Ok((a?.transmitted_torque - b?.transmitted_torque) / file.gear.rated_torque))
            .collect::<Result<_, RunError>>()?;
        let squares: f64 = difference.iter().map(|difference| difference * difference).sum();
        Ok(Self { rms: (squares / difference.len() as f64).sqrt(), max: largest(difference) })
    }
}
