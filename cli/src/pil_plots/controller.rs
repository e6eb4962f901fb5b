//! Pens of the controllers, the same in every plot.

use strainwave_desktop::bench::closed_loop::Run;
use strainwave_desktop::report::plot::{Colour, Series};
use strainwave_emulator::pil::TrialRun;

/// Controller of a run in a plot.
#[derive(Clone, Copy)]
pub enum Controller {
    /// A baseline, by its place among the baselines.
    Baseline(usize),
    /// The compensator.
    Compensator,
}

impl Controller {
    /// Curve of this controller with its name, colour and stroke.
    pub fn series(self, x: &[f64], y: &[f64]) -> Series {
        match self {
            Self::Baseline(0) => Series::broad("B0: cascade alone", x, y).coloured(Colour::SkyBlue),
            Self::Baseline(1) => Series::dashed("B1: rigid joint", x, y).coloured(Colour::Vermilion),
            Self::Baseline(2) => Series::dotted("B2: stored error, wind-up", x, y).coloured(Colour::Green),
            Self::Baseline(_) => Series::dash_dotted("B3: output encoder", x, y).coloured(Colour::Purple),
            Self::Compensator => Series::line("compensated", x, y).coloured(Colour::Blue),
        }
    }
}

/// Runs of every baseline and of the compensator, the compensator's last: it is drawn on top.
pub fn controllers<'a>(run: &'a TrialRun<'_>) -> impl Iterator<Item = (Controller, &'a Run)> {
    let baselines = run.baselines.iter().enumerate();
    let baselines = baselines.map(|(place, (_, run))| (Controller::Baseline(place), run));
    baselines.chain([(Controller::Compensator, &run.target.run)])
}
