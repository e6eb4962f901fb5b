//! `bench`: how fast this machine runs the main kernels.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, value_parser};
use strainwave_desktop::identify::learn_gear;
use strainwave_desktop::io::log::MeasuredLog;
use strainwave_desktop::speed::{self, Speed, Spread};
use strainwave_desktop::{BadInput, Figure, GearFile};

use crate::figures::{Figures, FiguresArguments, columns, say};
use crate::identify::TRAINING;
use crate::progress::Progress;

/// Rounds of a measurement: some seconds.
const ROUNDS: u64 = 500;
/// Nanoseconds of a second.
const NANOSECONDS: f64 = 1e9;

/// Measure how fast this machine runs the main kernels, each beside a rival
///
/// Every round times a batch of each kernel, one after the other, on one thread; `ratio` is a kernel's time over that of its
/// rival in the same round. `floor` is a first-order lag, the least that a model with a state does in a step. Median and
/// quartiles over the rounds are printed. Nothing is judged, because times do not repeat exactly: the exit code is 0 when
/// everything was measured. Cost on the target is counted instead, by `budget`.
#[derive(Args)]
pub struct Arguments {
    /// Rounds over which median and quartiles are taken
    #[arg(long, value_name = "COUNT", default_value_t = ROUNDS, value_parser = value_parser!(u64).range(1..=1_000_000))]
    rounds: u64,
    /// A moving joint's log that is identified once, too, on one thread; a line tells how long that took
    #[arg(long, value_name = "LOG.csv")]
    identify: Option<PathBuf>,
    /// The gear file that its identification starts from; the default gear when left out
    #[arg(long, value_name = "GEAR.toml", requires = "identify")]
    gear: Option<PathBuf>,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Measures, and prints a line a kernel.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    crate::files::require_writable(arguments.figures.json.as_deref())?;
    let identified = arguments.identify.as_deref();
    let identified = identified.map(|log| Identified::read(log, arguments.gear.as_deref())).transpose()?;
    let mut progress = Progress::new(1000, "rounds");
    let fraction = |fraction: f64| progress.set((fraction * 1e3) as u64);
    let found = speed::measure(&GearFile::default_gear(), arguments.rounds as usize, fraction);
    drop(progress);
    let found = found.map_err(BadInput::message)?;
    say(format_args!("{}", columns(&table(&found))));
    let mut figures: Vec<_> = found.iter().flat_map(figures).collect();
    if let Some(log) = identified {
        figures.extend(log.figures()?);
    }
    Ok(Figures::silent(figures, &arguments.figures))
}

/// A log that is identified, and the gear that this starts from.
struct Identified<'a> {
    path: &'a Path,
    gear: GearFile,
    log: MeasuredLog,
}

impl<'a> Identified<'a> {
    fn read(path: &'a Path, gear: Option<&Path>) -> Result<Self, BadInput> {
        let gear = gear.map_or_else(|| Ok(GearFile::default_gear()), GearFile::read)?;
        Ok(Self { path, gear, log: MeasuredLog::read(path)? })
    }

    /// Time of one identification by the clock.
    fn figures(&self) -> Result<[Figure; 3], BadInput> {
        let stamps = self.log.time.stamps();
        let (rows, duration) = (stamps.len(), stamps.last().unwrap_or(&0.0) - stamps.first().unwrap_or(&0.0));
        let mut progress = Progress::new(1000, "identifying");
        let started = Instant::now();
        learn_gear(&self.gear, &self.log, TRAINING, |fraction| progress.set((fraction * 1e3) as u64))
            .map_err(|why| BadInput::new(self.path, why))?;
        let time = started.elapsed().as_secs_f64();
        drop(progress);
        say(format_args!(
            "identification of {rows} rows, {duration:.1} s, of which {TRAINING} trains: {time:.1} s"
        ));
        Ok([
            Figure::reported("bench.identify.rows", rows as f64, "1"),
            Figure::reported("bench.identify.duration", duration, "s"),
            Figure::reported("bench.identify.time", time, "s"),
        ])
    }
}

fn table(found: &[Speed]) -> Vec<Vec<String>> {
    let header =
        ["kernel", "ns a call", "quartiles", "over", "ratio", "quartiles"].map(String::from).to_vec();
    std::iter::once(header).chain(found.iter().map(row)).collect()
}

fn row(speed: &Speed) -> Vec<String> {
    let time = speed.time.times(NANOSECONDS);
    let rival = speed.rival.to_owned();
    [vec![speed.name.to_owned()], cells(&time), vec![rival], cells(&speed.ratio)].concat()
}

/// Median, and both quartiles.
fn cells(spread: &Spread) -> Vec<String> {
    let Spread { lower_quartile, median, upper_quartile } = spread;
    vec![format!("{median:.2}"), format!("{lower_quartile:.2} to {upper_quartile:.2}")]
}

fn figures(speed: &Speed) -> impl Iterator<Item = Figure> {
    let name = speed.name;
    [("time", speed.time.times(NANOSECONDS), "ns"), ("ratio", speed.ratio, "1")].into_iter().flat_map(
        move |(what, spread, unit)| {
            let figure = |of: &str, value| Figure::reported(format!("bench.{name}.{what}.{of}"), value, unit);
            [
                figure("lower_quartile", spread.lower_quartile),
                figure("median", spread.median),
                figure("upper_quartile", spread.upper_quartile),
            ]
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kernel_has_one_line_and_six_figures() {
        let spread = |median| Spread { lower_quartile: 0.5 * median, median, upper_quartile: 2.0 * median };
        let speed = Speed { name: "a.b", rival: "c", time: spread(4e-9), ratio: spread(3.0) };
        assert_eq!(row(&speed), ["a.b", "4.00", "2.00 to 8.00", "c", "3.00", "1.50 to 6.00"]);
        let names: Vec<_> = figures(&speed).map(|figure| figure.name).collect();
        assert_eq!((names.len(), names[4].as_str()), (6, "bench.a.b.ratio.median"));
        assert!(figures(&speed).all(|figure| figure.holds && figure.bound.is_none()));
    }
}
