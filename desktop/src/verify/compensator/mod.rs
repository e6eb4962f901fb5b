//! The compensator against the baselines, on plants that it does not know.
//!
//! Every sample of the box (friction of either side +-20 %, stiffness +-10 %, load inertia +-30 %) is one plant with its
//! noise. B0 and B1 run S1 to S5 on it from rest; the compensator first works for 10 s
//! ([`crate::bench::working_motion`]), once with the motor's sensors alone and once with an output encoder too, and goes into
//! each scenario from there. Metrics are those of [`crate::verify::judge`]; a claim is the worst ratio over 20 samples, each with
//! four realisations of its noise, and names sample and noise. The plant is the condensed one ([`crate::plant::Plant::condensed`]).
//!
//! With both encoders the ripple of S4 is that of a compensator without the stored kinematic error, which has learnt it
//! while it worked.
//!
//! The whole box is gone through by 1000 samples with the noise of all sensors doubled, of which fewer, the first ones, have rows of their
//! own; there a run is
//!
//! - unstable when it diverges, when its motor torque is at the limit for more than 10 ms of the judged part, or when
//!   the torsion's vibration over the last fifth of the run is more than three times B0's and more than 10 urad;
//! - worse than B0 when the rms of its output error is more than 1 % larger than B0's in the same scenario.

mod angle;
mod claims;
mod performance;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use crate::bench::Conditions;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;
use crate::plant::two_port::Build;
use crate::verify::Measured;
use crate::verify::step_response::StepResponse;
pub use claims::{CLAIMS, Claim, Claimed, Reference, worst_draw, worst_samples};
pub(crate) use performance::worked;
pub use performance::{Compared, Performance, Rivals};

/// Samples that every claim is judged on.
pub const SAMPLES: u64 = 20;
/// Noises on each of them.
pub const NOISES: u32 = 4;
/// Samples of the whole box.
pub const BOX_SAMPLES: u64 = 1000;
/// The first of them, which are gone through where all parts of the project are measured.
pub const FIRST_BOX_SAMPLES: u64 = 100;
/// Factor on the noise in the box.
const BOX_NOISE: f64 = 2.0;

/// Figures without a run: angles.
pub fn measure() -> Measured {
    angle::measure().into()
}

/// What the claims are judged on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Plants.
    pub samples: u64,
    /// Noises on each of them.
    pub noises: u32,
    /// Plants of the box.
    pub box_samples: u64,
}

/// Judged claims.
pub struct Judgement {
    /// Every figure.
    pub figures: Vec<Figure>,
    /// What each claim was judged on.
    pub samples: Vec<Compared>,
}

/// Every claim; `progress` is called with the fraction done.
///
/// # Errors
/// A gear that no compensator can be built for, or a baseline that diverges.
pub fn against_baselines(
    file: &GearFile,
    request: &Request,
    mut progress: impl FnMut(f64),
) -> Result<Judgement, RunError> {
    let (rivals, rated) = (Rivals::build(file)?, file.gear.rated_torque);
    let of = |seed| Conditions::of(file, seed);
    let claimed = (1..=request.samples)
        .flat_map(|seed| (0..request.noises).map(move |realisation| Conditions { realisation, ..of(seed) }));
    let boxed = (1..=request.box_samples).map(|seed| Conditions { noise: BOX_NOISE, ..of(seed) });
    let all: Vec<_> = claimed.chain(boxed).collect();
    let compare = |conditions: &Conditions| {
        if conditions.noise == BOX_NOISE {
            rivals.compare(file, conditions)
        } else {
            rivals.compare_learning(file, conditions)
        }
    };
    let compared = each(&all, compare, &mut progress).into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut samples = compared;
    let boxed = samples.split_off(all.iter().filter(|conditions| conditions.noise != BOX_NOISE).count());
    let mut figures = StepResponse::of(file, Build::REFERENCE)?.figures();
    let claims =
        SensorSet::ALL.into_iter().flat_map(|sensors| CLAIMS.iter().map(move |claim| (sensors, claim)));
    figures.extend(claims.map(|(sensors, claim)| claim.figure(sensors, &samples, rated)));
    if !boxed.is_empty() {
        let rows = if request.box_samples < BOX_SAMPLES { &claims::BOX_SAMPLE } else { &claims::BOX };
        let in_the_box = |sensors| claims::in_the_box(rows, sensors, &boxed);
        figures.extend(SensorSet::ALL.into_iter().flat_map(in_the_box));
    }
    Ok(Judgement { figures, samples })
}

/// Does the same work for every item on all processors; `progress` is called with the fraction done.
pub fn each<I: Sync, T: Send>(
    items: &[I],
    work: impl Fn(&I) -> T + Sync,
    progress: &mut impl FnMut(f64),
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let mut done: Vec<Option<T>> = items.iter().map(|_| None).collect();
    thread::scope(|scope| {
        let (send, results) = mpsc::channel();
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            let (send, next, work) = (send.clone(), &next, &work);
            scope.spawn(move || {
                while let Some((place, item)) = next_of(items, next) {
                    if send.send((place, work(item))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        for (count, (place, result)) in results.into_iter().enumerate() {
            done[place] = Some(result);
            progress((count + 1) as f64 / items.len() as f64);
        }
    });
    done.into_iter().flatten().collect()
}

fn next_of<'a, I>(items: &'a [I], next: &AtomicUsize) -> Option<(usize, &'a I)> {
    let place = next.fetch_add(1, Ordering::Relaxed);
    items.get(place).map(|item| (place, item))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_worked_on_once_and_in_its_place() {
        let items: Vec<u64> = (0..100).collect();
        let mut fractions = Vec::new();
        let squares = each(&items, |item| item * item, &mut |fraction| fractions.push(fraction));
        assert_eq!(squares, items.iter().map(|item| item * item).collect::<Vec<_>>());
        assert!(fractions.is_sorted() && fractions.len() == 100 && fractions[99] == 1.0);
    }
}
