//! Counts blocks of an image while it runs in the emulator.

use std::time::Duration;

use super::error::Failure;
use super::{Block, Error};
use crate::artifact::Image;
use crate::counting::{Counting, Counts, Outcome, merge};
use crate::machine::{Machine, Options};

/// Longest time of a program on the host, counted: the literal mesh settles first, 10^8 instructions.
const PATIENCE: Duration = Duration::from_secs(120);

/// Counts `blocks` of `image` while `workload` runs it.
pub(super) fn count(
    image: &Image,
    blocks: &[(&str, &Block)],
    workload: impl FnOnce(&[String]) -> Result<(), Failure>,
) -> Result<Vec<(String, Counts)>, Error> {
    let found = blocks.iter().map(|(_, block)| image.find(&block.symbol));
    let functions: Vec<Vec<usize>> = found.collect::<Result<_, _>>()?;
    let counting = Counting::prepare(image, &distinct(&functions))?;
    workload(&counting.arguments()).map_err(Error::Workload)?;
    by_block(blocks, &functions, &counting.results(image)?)
}

/// Counts `blocks` of a program that runs by itself, and ends well.
pub(super) fn count_program(
    image: &Image,
    blocks: &[(&str, &Block)],
) -> Result<Vec<(String, Counts)>, Error> {
    count(image, blocks, |arguments| {
        let options = Options { patience: PATIENCE, arguments: arguments.to_vec(), ..Options::default() };
        Machine::boot_with(image.path(), &options)?.end()?;
        Ok(())
    })
}

/// Every function once: two blocks may name the same one.
fn distinct(functions: &[Vec<usize>]) -> Vec<usize> {
    let mut all = functions.concat();
    all.sort_unstable();
    all.dedup();
    all
}

fn by_block(
    blocks: &[(&str, &Block)],
    functions: &[Vec<usize>],
    outcome: &Outcome,
) -> Result<Vec<(String, Counts)>, Error> {
    let tracked = distinct(functions);
    let of = |function: &usize| outcome.counts[tracked.binary_search(function).ok()?];
    let counted = blocks.iter().zip(functions).map(|((name, block), functions)| {
        let counts = merge(functions.iter().filter_map(of));
        let never = || Error::NotCalled { block: (*name).to_owned(), symbol: block.symbol.clone() };
        Ok(((*name).to_owned(), counts.ok_or_else(never)?))
    });
    counted.collect()
}
