//! Plots of the torsion's vibration over frequency.

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_desktop::bench::closed_loop::Run;
use strainwave_desktop::bench::task::Task;
use strainwave_desktop::report::plot::Panel;
use strainwave_desktop::verify::judge::{Judge, spectrum, vibration};
use strainwave_emulator::pil::TrialRun;

use super::controllers;

/// Highest frequency of a spectrum (Hz): some times that of the torsion mode.
const HIGHEST: f64 = 200.0;

/// Control periods at the end of a run whose spectrum is shown where the joint does not come to rest: 0.5 s.
const LAST: usize = 5000;

/// Spectrum of every controller's vibration; none of a joint that is held.
pub fn panels(run: &TrialRun<'_>) -> Vec<Panel> {
    if run.trial.motion.blocked() { Vec::new() } else { panel(run).into_iter().collect() }
}

fn panel(run: &TrialRun<'_>) -> Option<Panel> {
    let part = if run.trial.motion.rests().is_empty() { "over the last 0.5 s" } else { "over the last rest" };
    let panel = Panel::new("frequency", "Hz", "vibration of the torsion", "urad").titled(part);
    controllers(run).try_fold(panel, |panel, (controller, of)| {
        let (frequency, amplitude): (Vec<_>, Vec<_>) =
            spectrum(&last_vibration(run, of)?, CONTROL_PERIOD, HIGHEST)
                .into_iter()
                .map(|(f, a)| (f, a * 1e6))
                .unzip();
        Some(panel.with(controller.series(&frequency, &amplitude)))
    })
}

/// Vibration over the last rest, or in a motion without rests at the end.
fn last_vibration(run: &TrialRun<'_>, of: &Run) -> Option<Vec<f64>> {
    let judge = Judge::new(run.trial.motion, &run.plant, &of.trace);
    judge.last_vibration().or_else(|| {
        let rows = judge.judged();
        Some(vibration(&rows[rows.len().saturating_sub(LAST)..], judge.natural_period().ok()?))
    })
}
