//! Runs by controller.

use strainwave_desktop::bench::closed_loop::Run;
pub use strainwave_desktop::report::controller::Controller;
use strainwave_emulator::pil::TrialRun;

/// Runs of every baseline and of the compensator, the compensator's last: it is drawn on top.
pub fn controllers<'a>(run: &'a TrialRun<'_>) -> impl Iterator<Item = (Controller, &'a Run)> {
    let baselines = run.baselines.iter().enumerate();
    let baselines = baselines.map(|(place, (_, run))| (Controller::Baseline(place), run));
    baselines.chain([(compensator(run), &run.target.run)])
}

/// The compensator with the sensors of a run.
pub fn compensator(run: &TrialRun<'_>) -> Controller {
    Controller::Compensator(run.trial.conditions.sensors)
}
