//! Exact instruction counts of the firmware's functions, and cycles by a model.
//!
//! A QEMU plugin follows every instruction that the emulated microcontroller executes and sums them up per
//! call of the tracked functions, callees included, exception handlers on top of them not. The counts are
//! repeatable to the instruction. Cycles are the sum of [`cycle_table`]'s costs: a model at its
//! pessimistic end, not a measurement on silicon.
//!
//! ```text
//! image -> plan -> QEMU with the plugin, driven by the caller -> result
//! ```

pub mod cycle_table;
mod error;
pub mod flash_accelerator;
pub mod path;
mod plan;
mod plugin;
mod result;
pub mod worst_path;

pub use error::Error;
pub use result::{Counts, Outcome, Spread, merge};

use std::path::{Path, PathBuf};

use crate::artifact::Image;
use crate::scratch::Scratch;
use crate::setup;

/// A run to be counted: from its preparation to its result.
#[derive(Debug)]
pub struct Counting {
    plugin: PathBuf,
    folder: Scratch,
}

impl Counting {
    /// Builds the plugin and writes the plan for the functions of `image` with these indices.
    ///
    /// # Errors
    /// [`Error::Setup`] without an emulator, [`Error::PluginBuild`].
    pub fn prepare(image: &Image, tracked: &[usize]) -> Result<Self, Error> {
        let plugin = plugin::build(&setup::this_emulator()?.version)?;
        let text = plan::plan(image, tracked)?;
        let folder = Scratch::new("counting")?;
        std::fs::write(folder.path().join(PLAN), text)?;
        std::fs::create_dir(folder.path().join(RESULTS))?;
        Ok(Self { plugin, folder })
    }

    /// Additional arguments of QEMU.
    pub fn arguments(&self) -> [String; 2] {
        let escaped = |path: &Path| path.display().to_string().replace(',', ",,");
        let file = |name| escaped(&self.folder.path().join(name));
        let option = format!("{},plan={},out={}", escaped(&self.plugin), file(PLAN), file(RESULTS));
        ["-plugin".to_owned(), option]
    }

    /// The same, for a result that has the cycles of every call of the first tracked function.
    pub fn arguments_for_calls(&self) -> [String; 2] {
        let [option, plugin] = self.arguments();
        [option, plugin + ",calls=yes"]
    }

    /// The same, for a result that has the instructions of one call of the first tracked function, the first being 0.
    pub fn arguments_for_path(&self, call: usize) -> [String; 2] {
        let [option, plugin] = self.arguments();
        [option, format!("{plugin},path={call}")]
    }

    /// The results of every emulator that was started with the arguments and has ended by itself since they were last asked
    /// for.
    ///
    /// # Errors
    /// [`Error::NoResult`], or what kept the plugin from counting: [`Error::NoCost`], [`Error::NotInImage`],
    /// [`Error::LostTrack`].
    pub fn results(&self, image: &Image) -> Result<Outcome, Error> {
        let mut outcome: Option<Outcome> = None;
        for file in std::fs::read_dir(self.folder.path().join(RESULTS))? {
            let path = file?.path();
            let text = std::fs::read_to_string(&path)?;
            std::fs::remove_file(&path)?;
            let one = result::parse(&text).ok_or(Error::NoResult)?;
            outcome = Some(outcome.map_or_else(|| one.clone(), |all| all.and(&one)));
        }
        let outcome = outcome.ok_or(Error::NoResult)?;
        match &outcome.anomaly {
            Some(anomaly) => Err(explain(image, anomaly)),
            None if image.has_cycle_model() => Ok(outcome),
            None => Ok(outcome.without_cycles()),
        }
    }
}

const PLAN: &str = "plan.txt";
const RESULTS: &str = "results";

/// Names the function and the instruction that the plugin could not count.
fn explain(image: &Image, anomaly: &str) -> Error {
    let mut words = anomaly.split(' ');
    let kind = words.next().unwrap_or("");
    let address = words.next().and_then(|w| u32::from_str_radix(w.trim_start_matches("0x"), 16).ok());
    let function = address.and_then(|a| image.function_at(a)).map(|k| image.functions()[k].name().to_owned());
    let function = function.unwrap_or_else(|| "code that is not in the image".to_owned());
    let instruction = image.instructions().iter().find(|i| Some(i.address) == address);
    match (kind, instruction, address) {
        ("uncosted", Some(i), _) => Error::NoCost { function, address: i.address, text: i.text.clone() },
        ("uncosted", None, Some(address)) => Error::NotInImage { address },
        _ => Error::LostTrack { function, what: anomaly.to_owned() },
    }
}
