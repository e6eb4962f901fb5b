//! Measures an image against its budget.

use std::collections::BTreeMap;
use std::path::Path;

use strainwave_desktop::Figure;
use strainwave_desktop::verify::bounds;

use super::count::{count, count_program};
use super::error::Failure;
use super::{Block, Budget, ElementaryFunction, Error, ImageSizes, LITERAL_MESH};
use crate::any_input::AnyInput;
use crate::artifact::{CONTROL_STEP, CallGraph, Image, Sizes, StackBound, Violation, proofs};
use crate::counting::Counts;

/// Costs of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The compiler that built it.
    pub compiler: String,
    /// Its core; only one of them has cycles.
    pub core: String,
    /// Its size.
    pub sizes: Sizes,
    /// The deepest that its stack can get.
    pub stack: StackBound,
    /// Panics in it.
    pub panics: Vec<Violation>,
    /// Parts of an allocator in it.
    pub allocators: Vec<Violation>,
    /// Double precision in what its control step reaches.
    pub doubles: Vec<Violation>,
    /// Counts of the control step, its parts and the literal mesh, in the budget's order; empty when nothing was run.
    pub counts: Vec<(String, Counts)>,
    /// Most cycles of any path through the code of the control step and its parts, by name, where the code shows a bound.
    pub any_path: BTreeMap<String, u64>,
    /// Worst case of the control step on any input, where it was searched for.
    pub any_input: Option<AnyInput>,
    /// Elementary functions of several libraries, where they were counted.
    pub elementary_functions: Vec<ElementaryFunction>,
    /// The deepest stack that a run has seen, in bytes.
    pub stack_mark: Option<u32>,
}

/// Result of a workload: the deepest stack that the firmware reports, if it does, in bytes.
pub type Workload = Result<Option<u32>, Failure>;

/// Judges the image at `elf` without running it.
///
/// # Errors
/// [`Error::Image`] when the image is none, or its stack has no bound.
pub fn inspect(budget: &Budget, elf: &Path) -> Result<Measurement, Error> {
    examine(budget, &Image::read(elf)?)
}

/// Judges the image at `elf`, and counts it while `workload` runs it in the emulator, once or several times;
/// what `workload` is given goes to the emulator's command line.
///
/// The image of a board that cannot be emulated is judged without running it.
///
/// # Errors
/// As [`inspect`]; [`Error::Workload`]; [`Error::Counting`]; [`Error::NotCalled`] for a block that the workload
/// leaves out.
pub fn measure(
    budget: &Budget,
    elf: &Path,
    workload: impl FnOnce(&[String]) -> Workload,
) -> Result<Measurement, Error> {
    let image = Image::read(elf)?;
    let mut measured = examine(budget, &image)?;
    if budget.emulated {
        let blocks: Vec<_> = budget.blocks().collect();
        measured.counts = count(&image, &blocks, |arguments| {
            measured.stack_mark = workload(arguments)?;
            Ok(())
        })?;
    }
    Ok(measured)
}

impl Measurement {
    /// Adds what `blocks` of a program cost that runs by itself, and ends well.
    ///
    /// # Errors
    /// [`Error::Image`]; [`Error::Workload`] when the program does not end well; [`Error::Counting`];
    /// [`Error::NotCalled`].
    pub fn add_program(&mut self, elf: &Path, blocks: &[(&str, &Block)]) -> Result<(), Error> {
        self.counts.extend(count_program(&Image::read(elf)?, blocks)?);
        Ok(())
    }

    /// Adds what `blocks` of the image at `elf` cost while `workload` runs it, which is given arguments for the emulator.
    ///
    /// # Errors
    /// [`Error::Image`]; [`Error::Workload`]; [`Error::Counting`]; [`Error::NotCalled`].
    pub fn add_workload(
        &mut self,
        elf: &Path,
        blocks: &[(&str, &Block)],
        workload: impl FnOnce(&[String]) -> Result<(), Failure>,
    ) -> Result<(), Error> {
        self.counts.extend(count(&Image::read(elf)?, blocks, workload)?);
        Ok(())
    }
}

fn examine(budget: &Budget, image: &Image) -> Result<Measurement, Error> {
    let handlers = image.vectors()?;
    let graph = CallGraph::of(image, &handlers, &budget.indirect_call)?;
    let control_step = image.find(&budget.control_step.symbol)?;
    Ok(Measurement {
        compiler: image.compiler().to_owned(),
        core: image.core().to_owned(),
        sizes: Sizes::of(image),
        stack: StackBound::of(image, &graph)?,
        panics: proofs::panics(image.symbols(), &graph, &handlers),
        allocators: proofs::allocators(image.symbols(), &graph, &handlers),
        doubles: proofs::doubles(&graph, &control_step),
        counts: Vec::new(),
        any_path: any_path(budget, image)?,
        any_input: None,
        elementary_functions: Vec::new(),
        stack_mark: None,
    })
}

fn any_path(budget: &Budget, image: &Image) -> Result<BTreeMap<String, u64>, Error> {
    let mut found = BTreeMap::new();
    if !image.has_cycle_model() {
        return Ok(found);
    }
    for (name, block) in budget.blocks() {
        found.extend(block.worst_case(image)?.map(|cycles| (name.to_owned(), cycles)));
    }
    Ok(found)
}

impl Measurement {
    /// Every figure with its bound in `budget`.
    pub fn figures(&self, budget: &Budget) -> Vec<Figure> {
        let mut figures = Vec::new();
        for (name, counts) in &self.counts {
            let block = self.block(budget, name);
            let max = |what: &str, unit, value: u64, bound| {
                budget.figure(&format!("{name}.{what}_max"), value as f64, unit, bound)
            };
            let mean =
                |what: &str, unit, value| budget.figure(&format!("{name}.{what}_mean"), value, unit, None);
            let (instructions, cycles) = (counts.instructions, counts.cycles);
            let bound = block.and_then(|b| b.instructions);
            figures.push(max("instructions", "instruction", instructions.max, bound));
            figures.push(mean("instructions", "instruction", instructions.mean));
            if let Some(cycles) = cycles {
                figures.push(max("cycles", "cycle", cycles.max, block.and_then(|b| b.cycles)));
                figures.push(mean("cycles", "cycle", cycles.mean));
            }
            let any_path = |cycles: &u64| {
                budget.figure(&format!("{name}.any_path.cycles"), *cycles as f64, "cycle", None)
            };
            figures.extend(self.any_path.get(name).map(any_path));
        }
        figures.extend(self.any_input_figures(budget));
        figures.extend(self.ratio_figure(budget));
        figures.extend(self.image_figures(budget));
        figures.extend(self.elementary_functions.iter().flat_map(|function| function.figures(&budget.board)));
        figures
    }

    /// The control step on any input: exact, like the host's, and bounded.
    fn any_input_figures(&self, budget: &Budget) -> Vec<Figure> {
        let Some(found) = &self.any_input else { return Vec::new() };
        let name = |what: &str| format!("{CONTROL_STEP}.any_input.{what}");
        let full = |what: &str| format!("budget.{}.{}", budget.board, name(what));
        let bound = budget.any_input.map(|bounds| bounds.cycles);
        let unbounded = found.unbounded.values().sum::<u64>();
        let from_flash = |cycles| Figure::reported(full("cycles_from_flash"), cycles as f64, "cycle");
        let mut figures = vec![
            budget
                .figure(&name("cycles"), found.worst.cycles as f64, "cycle", bound)
                .of_seed(found.worst.seed),
            Figure::reported(full("steps"), found.steps as f64, "1"),
            bounds::figure_as(full("steps_unlike_host"), "pil.steps_unlike_host", found.unlike_host as f64),
            Figure::bounded(full("steps_unbounded"), unbounded as f64, "1", 0.0),
        ];
        figures.extend(found.from_flash.map(from_flash));
        figures
    }

    /// Counts of the control step, one of its parts or the literal mesh.
    pub fn counts_of(&self, block: &str) -> Option<&Counts> {
        self.counts.iter().find(|(name, _)| name == block).map(|(_, counts)| counts)
    }

    /// Ratio of the literal mesh's instructions to its reduction's, rounded down.
    pub fn literal_over_reduced(&self, budget: &Budget) -> Option<u64> {
        let most = |block| Some(self.counts_of(block)?.instructions.max);
        Some(most(LITERAL_MESH)? / most(&budget.literal_mesh.as_ref()?.reduced)?)
    }

    fn ratio_figure(&self, budget: &Budget) -> Option<Figure> {
        let name = format!("budget.{}.literal_over_reduced", budget.board);
        let least = budget.literal_mesh.as_ref()?.at_least;
        Some(Figure::at_least(name, self.literal_over_reduced(budget)? as f64, "1", least as f64))
    }

    /// Flash, RAM and stack of the image.
    pub fn image_sizes(&self) -> ImageSizes {
        let bytes = |value: u32| Some(u64::from(value));
        ImageSizes {
            flash: bytes(self.sizes.flash),
            ram: bytes(self.sizes.ram),
            stack: bytes(self.stack.total),
            thread_stack: bytes(self.stack.thread.depth),
            interrupt_stack: bytes(self.stack.total - self.stack.thread.depth),
        }
    }

    fn image_figures(&self, budget: &Budget) -> Vec<Figure> {
        let byte = |name: &str, value: u64, bound| {
            budget.figure(&budget.of_image(name), value as f64, "byte", bound)
        };
        let sizes = self.image_sizes().named().into_iter().zip(budget.image.named());
        let mut figures: Vec<_> =
            sizes.filter_map(|((name, size), (_, bound))| Some(byte(name, size?, bound))).collect();
        // What a run has seen must not be deeper than what no run can exceed.
        let bound = Some(u64::from(self.stack.total));
        figures.extend(self.stack_mark.map(|mark| byte("stack_mark", mark.into(), bound)));
        figures.extend(self.proof_figures(budget));
        figures
    }

    /// Numbers of forbidden symbols in the image: none.
    pub fn proof_figures(&self, budget: &Budget) -> Vec<Figure> {
        let none = |(name, found): (&str, &[Violation])| {
            let name = format!("budget.{}.{}", budget.board, budget.of_image(name));
            Figure::bounded(name, found.len() as f64, "1", 0.0)
        };
        self.proofs().map(none).to_vec()
    }

    fn block<'b>(&self, budget: &'b Budget, name: &str) -> Option<&'b Block> {
        budget.rows().find(|(n, _)| *n == name).map(|(_, block)| block)
    }

    /// Forbidden symbols in the image, by name.
    pub fn proofs(&self) -> [(&'static str, &[Violation]); 3] {
        [("panics", &self.panics), ("allocators", &self.allocators), ("doubles", &self.doubles)]
    }
}
