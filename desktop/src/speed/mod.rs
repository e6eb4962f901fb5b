//! Speed of the main kernels on this machine, one thread: each beside a rival that is timed in the same rounds.
//!
//! ```text
//! time  = (end - start)/calls          of one batch of calls (s)
//! ratio = time/time of the rival       of the same round
//! ```
//!
//! A round times one batch of every kernel, one after the other, so that what slows the machine down slows kernel and
//! rival alike and leaves most of the ratio as it is. Median and quartiles over the rounds are reported; nothing is
//! judged, because they do not repeat exactly. `floor.rs` has the rival of kernels that have no other.

mod compensator;
mod flexspline;
mod floor;
mod friction;
mod hysteresis;
mod robot;
mod spread;

pub use spread::Spread;

use std::time::Instant;

use crate::io::gear_file::GearFile;
use crate::plant::divergence::RunError;

/// Shortest batch (s): thousands of ticks of the clock, and short enough to be seldom interrupted.
const SHORTEST_BATCH: f64 = 1e-4;
/// Most passes of a batch.
const MOST_PASSES: u32 = 1 << 20;

/// Why nothing could be measured.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A model that cannot be built, or a run that failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A clock that does not move while a kernel runs.
    #[error("{0}: {MOST_PASSES} passes take no time by this machine's clock")]
    Clock(&'static str),
}

/// A piece of code that is timed.
struct Kernel {
    name: &'static str,
    rival: &'static str,
    /// Calls of a pass.
    calls: usize,
    pass: Box<dyn FnMut()>,
}

impl Kernel {
    fn new(name: &'static str, rival: &'static str, calls: usize, pass: impl FnMut() + 'static) -> Self {
        Self { name, rival, calls, pass: Box::new(pass) }
    }

    /// Time of some passes (s).
    fn time(&mut self, passes: u32) -> f64 {
        let started = Instant::now();
        for _ in 0..passes {
            (self.pass)();
        }
        started.elapsed().as_secs_f64()
    }

    /// Passes of the shortest batch.
    fn passes(&mut self) -> Result<u32, Error> {
        let mut counts = (0..).map(|k| 1 << k).take_while(|passes| *passes <= MOST_PASSES);
        counts.find(|passes| self.time(*passes) >= SHORTEST_BATCH).ok_or(Error::Clock(self.name))
    }
}

/// Speed of a kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct Speed {
    /// The kernel.
    pub name: &'static str,
    /// The kernel that it is compared with.
    pub rival: &'static str,
    /// Time of a call (s).
    pub time: Spread,
    /// The same over that of the rival.
    pub ratio: Spread,
}

/// Speed of every kernel, over so many rounds.
///
/// # Errors
/// A model of the gear that cannot be built, or a clock that is too coarse.
pub fn measure(file: &GearFile, rounds: usize, progress: impl FnMut(f64)) -> Result<Vec<Speed>, Error> {
    let kernels = [
        vec![floor::kernel()],
        friction::kernels(file).map_err(RunError::from)?,
        hysteresis::kernels().map_err(RunError::from)?,
        flexspline::kernels(file).map_err(RunError::from)?,
        compensator::kernels(file)?,
        robot::kernels()?,
    ];
    race(kernels.into_iter().flatten().collect(), rounds, progress)
}

fn race(mut kernels: Vec<Kernel>, rounds: usize, mut progress: impl FnMut(f64)) -> Result<Vec<Speed>, Error> {
    let passes = kernels.iter_mut().map(Kernel::passes).collect::<Result<Vec<_>, _>>()?;
    let mut times = vec![Vec::with_capacity(rounds); kernels.len()];
    for round in 0..rounds {
        progress(round as f64 / rounds as f64);
        for ((kernel, passes), times) in kernels.iter_mut().zip(&passes).zip(&mut times) {
            times.push(kernel.time(*passes) / (kernel.calls as f64 * f64::from(*passes)));
        }
    }
    Ok(kernels
        .iter()
        .zip(&times)
        .map(|(kernel, own)| speed(kernel, own, rival(kernel, &kernels, &times)))
        .collect())
}

/// Times of a kernel's rival.
fn rival<'t>(kernel: &Kernel, kernels: &[Kernel], times: &'t [Vec<f64>]) -> &'t [f64] {
    let place = kernels.iter().position(|other| other.name == kernel.rival);
    &times[place.expect("a rival is one of the kernels")]
}

fn speed(kernel: &Kernel, own: &[f64], rival: &[f64]) -> Speed {
    let ratios = own.iter().zip(rival).map(|(own, rival)| own / rival);
    Speed {
        name: kernel.name,
        rival: kernel.rival,
        time: Spread::of(own),
        ratio: Spread::of(&ratios.collect::<Vec<_>>()),
    }
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;

    use super::*;

    fn sums(name: &'static str, rival: &'static str, calls: usize, terms: u32) -> Kernel {
        Kernel::new(name, rival, calls, move || {
            for _ in 0..calls {
                black_box((0..terms).fold(0, |sum, k| black_box(sum ^ k)));
            }
        })
    }

    #[test]
    fn a_kernel_that_does_fifty_times_as_much_is_seen_to_be_slower_and_the_rival_is_one() {
        let found = race(vec![sums("a", "a", 100, 10), sums("b", "a", 10, 500)], 9, |_| ()).unwrap();
        assert_eq!((found[0].ratio.lower_quartile, found[0].ratio.upper_quartile), (1.0, 1.0));
        assert!(found[1].ratio.median > 5.0, "{found:?}");
        assert!(found.iter().all(|speed| speed.time.lower_quartile > 0.0), "{found:?}");
    }

    #[test]
    fn every_kernel_of_the_default_gear_is_timed() {
        let found = measure(&GearFile::default_gear(), 1, |_| ()).unwrap();
        assert!(found.iter().all(|speed| speed.time.median > 0.0 && speed.ratio.median > 0.0), "{found:?}");
    }
}
