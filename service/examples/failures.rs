//! Power that fails in every step of 10^4 writes of the store, and 10^7 malformed frames on the tuning link: what they led to.
//!
//! Arguments: writes and frames, when others than these are wanted. Exit code 1 when anything was led to that must not be.

use std::process::ExitCode;
use std::thread;

use strainwave_service::simulation::cuts::{Cuts, cut_everywhere};
use strainwave_service::simulation::frames::{Malformed, send};

const WRITES: u64 = 10_000;
const FRAMES: u64 = 10_000_000;
/// Runs of either kind, one after the other on as many threads as there are processors.
const RUNS: u64 = 100;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse());
    let mut next = |default| arguments.next().unwrap_or(Ok(default));
    let (Ok(writes), Ok(frames)) = (next(WRITES), next(FRAMES)) else {
        eprintln!("error: failures [WRITES [FRAMES]]: whole numbers are needed");
        return ExitCode::from(2);
    };
    let cuts = each_run(|seed| cut_everywhere(writes.div_ceil(RUNS) as u32, seed))
        .into_iter()
        .fold(Cuts::default(), Cuts::and);
    let malformed = each_run(|seed| send(frames.div_ceil(RUNS), seed))
        .into_iter()
        .fold(Malformed::default(), Malformed::and);
    println!("cuts of the power        {:>10}  in {} writes", cuts.cuts, writes.div_ceil(RUNS) * RUNS);
    println!("neither old nor new      {:>10}  allowed 0", cuts.neither);
    println!("not writable again       {:>10}  allowed 0", cuts.stuck);
    println!("malformed frames         {:>10}  no panic", malformed.frames);
    println!("accepted out of range    {:>10}  allowed 0", malformed.out_of_range);
    println!(
        "sound requests unserved  {:>10}  of {}, allowed 0",
        malformed.unserved,
        malformed.served + malformed.unserved
    );
    let holds = cuts.neither + cuts.stuck + malformed.out_of_range + malformed.unserved == 0;
    if holds { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The result of each run, by its seed.
fn each_run<T: Send>(run: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let threads = thread::available_parallelism().map_or(1, usize::from) as u64;
    thread::scope(|scope| {
        let share = |first: u64| (first..RUNS).step_by(threads as usize);
        let started: Vec<_> = (0..threads)
            .map(|first| {
                scope.spawn({
                    let run = &run;
                    move || share(first).map(run).collect::<Vec<_>>()
                })
            })
            .collect();
        started.into_iter().flat_map(|thread| thread.join().expect("no run panics")).collect()
    })
}
