//! A board's budget: what its image may cost, as data beside the board.
//!
//! `boards/BOARD/budget.toml` is a golden file: [`Budget::overwrite`] writes what was measured plus the
//! stated headroom, so that a change of cost is a reviewed change of a line. Units: instructions, cycles and
//! bytes. The bounds hold for the compiler that the file names; another one gives slightly different counts.
//!
//! A bound that has become ten times too loose no longer guards anything, and fails like one that is
//! exceeded.

mod count;
mod elementary_functions;
mod error;
mod literal_mesh;
mod measurement;
mod overwrite;
mod table;
mod torque_gauges;
mod worst_case;

pub use elementary_functions::{ElementaryFunction, ElementaryFunctions, LIBRARIES, Library};
pub use error::{Error, Failure};
pub use literal_mesh::LiteralMesh;
pub use measurement::{Measurement, Workload, inspect, measure};
pub use torque_gauges::TorqueGauges;
pub use worst_case::WorstCase;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use strainwave_desktop::Figure;

use crate::artifact::{CONTROL_STEP, IndirectCall};
use crate::firmware::{self, Program};

/// The function whose cost is bounded, and its bounds.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Path of the function; `*` stands for any one segment.
    pub symbol: String,
    /// Most instructions of a call, what it calls included.
    pub instructions: Option<u64>,
    /// Most cycles of a call, by the model of [`crate::counting::cycle_table`].
    pub cycles: Option<u64>,
    /// The bounds are requirements, not measurements: they are never overwritten.
    #[serde(default)]
    pub fixed: bool,
}

/// Bounds or targets of the image, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageSizes {
    /// Flash.
    pub flash: Option<u64>,
    /// RAM without stack.
    pub ram: Option<u64>,
    /// Stack: the two below.
    pub stack: Option<u64>,
    /// Stack outside of handlers: start-up and idle loop.
    pub thread_stack: Option<u64>,
    /// Stack of all handlers on top of each other, with their exception frames.
    pub interrupt_stack: Option<u64>,
}

impl ImageSizes {
    /// Each with its name.
    pub fn named(&self) -> [(&'static str, Option<u64>); 5] {
        [
            ("flash", self.flash),
            ("ram", self.ram),
            ("stack", self.stack),
            ("thread_stack", self.thread_stack),
            ("interrupt_stack", self.interrupt_stack),
        ]
    }
}

/// Bounds of the control step on any input; never overwritten.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnyInputBounds {
    /// Most cycles of a call, by the model of [`crate::counting::cycle_table`].
    pub cycles: u64,
    /// Target, where it is missed: the table reports it.
    #[serde(alias = "asked")]
    pub target: Option<u64>,
}

/// A board's budget.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// The board; its folder's name.
    #[serde(skip)]
    pub board: String,
    #[serde(skip)]
    file: PathBuf,
    #[serde(skip)]
    program: Program,
    /// The compiler that the bounds were measured with.
    pub compiler: String,
    /// Margin of a bound above the measured value, relative to it, 0 to 1.
    pub headroom: f64,
    /// Whether the board can be run in the emulator; otherwise only its image is judged.
    pub emulated: bool,
    /// Of a board that is not emulated: the one with the same core on which the cycles of its control step are counted.
    pub counted_on: Option<String>,
    /// Bounds of the image.
    #[serde(default)]
    pub image: ImageSizes,
    /// Bounds of the image that serves the tuning link, of a board that is flashed with one.
    pub served_image: Option<ImageSizes>,
    /// Bounds of the image that is a node on CAN, of a board that is flashed with one.
    pub can_image: Option<ImageSizes>,
    /// Bounds of the same whose drive is an ODrive, of a board that is flashed with one.
    pub odrive_image: Option<ImageSizes>,
    /// The image's targets; never overwritten. The table reports those that are missed.
    #[serde(default)]
    pub image_target: ImageSizes,
    /// The control step.
    pub control_step: Block,
    /// Its parts, by name.
    #[serde(default)]
    pub blocks: BTreeMap<String, Block>,
    /// The literal mesh, whose reduction one of them is.
    pub literal_mesh: Option<LiteralMesh>,
    /// The strain gauges' torque, in S8.
    pub torque_gauges: Option<TorqueGauges>,
    /// Workload beyond the scenarios.
    pub worst_case: Option<WorstCase>,
    /// The control step on any input.
    pub any_input: Option<AnyInputBounds>,
    /// The elementary functions of several libraries.
    pub elementary_functions: Option<ElementaryFunctions>,
    /// Targets of calls through pointers.
    #[serde(default)]
    pub indirect_call: Vec<IndirectCall>,
}

/// A bound is stale when it is more than this many times the value.
const STALE: f64 = 10.0;

impl Budget {
    /// Reads the budget of a board.
    ///
    /// # Errors
    /// [`Error::File`], or [`Error::Content`] with the line.
    pub fn read(board: &str) -> Result<Self, Error> {
        Self::read_file(board, &firmware::folder().join(board).join("budget.toml"))
    }

    /// Reads the budget of `board` from `file`.
    ///
    /// # Errors
    /// As [`Budget::read`].
    pub fn read_file(board: &str, file: &Path) -> Result<Self, Error> {
        let text =
            std::fs::read_to_string(file).map_err(|source| Error::File { file: file.to_owned(), source })?;
        let bad = |what: String| Error::Content { file: file.to_owned(), what };
        let budget: Self = toml::from_str(&text).map_err(|error| bad(one_line(&text, &error)))?;
        if !(0.0..=1.0).contains(&budget.headroom) {
            return Err(bad(format!("headroom = {}, allowed: 0 to 1", budget.headroom)));
        }
        if let Some(other) = budget.counted_on.as_ref().filter(|_| budget.emulated) {
            return Err(bad(format!("counted_on = \"{other}\", allowed: with emulated = false")));
        }
        let twice =
            |worst: &WorstCase| worst.blocks.keys().find(|name| budget.blocks.contains_key(*name)).cloned();
        if let Some(name) = budget.worst_case.as_ref().and_then(twice) {
            return Err(bad(format!("worst_case.blocks.{name}, allowed: a name that is not among [blocks]")));
        }
        if let Some(what) = budget.literal_mesh.as_ref().and_then(|mesh| mesh.fault(&budget.blocks)) {
            return Err(bad(what));
        }
        Ok(Self { board: board.to_owned(), file: file.to_owned(), ..budget })
    }

    /// The same for another of its programs, if the board is flashed with it. Its targets are those of the first.
    pub fn of(&self, program: Program) -> Option<Self> {
        let image = match program {
            Program::Control => Some(self.image),
            Program::Served => self.served_image,
            Program::Commanded { .. } => self.can_image,
            Program::BeforeOdrive { .. } => self.odrive_image,
        };
        Some(Self { image: image?, program, ..self.clone() })
    }

    /// The program that is judged.
    pub fn program(&self) -> Program {
        self.program
    }

    /// The control step, and its parts, by name.
    pub fn blocks(&self) -> impl Iterator<Item = (&str, &Block)> {
        let parts = self.blocks.iter().map(|(name, block)| (name.as_str(), block));
        std::iter::once((CONTROL_STEP, &self.control_step)).chain(parts)
    }

    /// The same, and what is in images of its own: the literal mesh, and what is driven through its worst case.
    pub fn rows(&self) -> impl Iterator<Item = (&str, &Block)> {
        let mesh = self.literal_mesh.iter().map(|mesh| (LITERAL_MESH, &mesh.period));
        let gauges = self.torque_gauges.iter().map(|gauges| (TORQUE_GAUGES, &gauges.step));
        self.blocks().chain(mesh).chain(gauges).chain(self.worst_case.iter().flat_map(WorstCase::rows))
    }

    /// Name of a figure of the image.
    fn of_image(&self, name: &str) -> String {
        format!("{}{name}", self.program.prefix())
    }

    fn figure(&self, name: &str, measured: f64, unit: &str, bound: Option<u64>) -> Figure {
        let name = format!("budget.{}.{name}", self.board);
        let Some(bound) = bound else { return Figure::reported(name, measured, unit) };
        let figure = Figure::bounded(name, measured, unit, bound as f64);
        Figure { holds: figure.holds && bound as f64 <= STALE * measured, ..figure }
    }
}

/// The boards that can be run in the emulator.
///
/// # Errors
/// As [`Budget::read`], and when the folder of the boards cannot be read.
pub fn emulated_boards() -> Result<Vec<String>, Error> {
    let folder = |source| Error::File { file: firmware::folder(), source };
    let mut emulated = Vec::new();
    for board in firmware::boards().map_err(folder)? {
        if Budget::read(&board)?.emulated {
            emulated.push(board);
        }
    }
    Ok(emulated)
}

/// The name of the strain gauges' step beside the blocks.
pub const TORQUE_GAUGES: &str = "torque_gauges";
/// The name of the literal mesh's control period beside the blocks.
pub const LITERAL_MESH: &str = "literal_mesh";

fn one_line(text: &str, error: &toml::de::Error) -> String {
    let line = error.span().map(|span| text[..span.start].matches('\n').count() + 1);
    let message = error.message().lines().next().unwrap_or("");
    line.map_or_else(|| message.to_owned(), |line| format!("line {line}: {message}"))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::artifact::{Sizes, StackBound, stack::Chain};
    use crate::counting::{Counts, Spread, cycle_table};

    pub const FILE: &str = "# A board.\ncompiler = \"rustc 1\"\nheadroom = 0.1 # a tenth\nemulated = true\n\n\
        [control_step]\nsymbol = \"control_step\"\ncycles = 10 # by the model\n\n\
        [blocks.observer]\nsymbol = \"a::Observer::step\"\n\n\
        [literal_mesh]\nprogram = \"mesh\"\nreduced = \"observer\"\nat_least = 300 # times\n\n\
        [literal_mesh.period]\nsymbol = \"a::Mesh::period\"\n";

    fn read(text: &str) -> Result<Budget, Error> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("budget.toml");
        std::fs::write(&file, text).unwrap();
        Budget::read_file("b", &file)
    }

    fn refusal(text: &str) -> String {
        read(text).unwrap_err().to_string().rsplit("budget.toml: ").next().unwrap().to_owned()
    }

    fn counts(max: u64) -> Counts {
        let spread = |max: u64| Spread { min: 1, max, mean: 2.0 };
        Counts { calls: 3, instructions: spread(max), cycles: Some(spread(2 * max)) }
    }

    pub fn budget() -> Budget {
        read(FILE).unwrap()
    }

    pub fn measurement() -> Measurement {
        let chain = Chain { depth: 100, path: vec!["Reset".to_owned()] };
        Measurement {
            compiler: "rustc 2".to_owned(),
            core: cycle_table::CORE.to_owned(),
            sizes: Sizes { flash: 1000, ram: 200 },
            stack: StackBound { total: 300, thread: chain, handlers: Vec::new() },
            panics: Vec::new(),
            allocators: Vec::new(),
            doubles: Vec::new(),
            any_path: BTreeMap::new(),
            any_input: None,
            counts: [(CONTROL_STEP, 500), ("observer", 40), (LITERAL_MESH, 12_352)]
                .map(|(name, max)| (name.to_owned(), counts(max)))
                .to_vec(),
            elementary_functions: Vec::new(),
            stack_mark: None,
        }
    }

    #[test]
    fn what_is_wrong_with_a_budget_is_named() {
        assert!(read(FILE).is_ok());
        let unknown = refusal(&FILE.replace("cycles = 10", "cyclse = 10"));
        assert!(unknown.starts_with("line 8: unknown field `cyclse`"), "{unknown}");
        assert!(
            refusal(&FILE.replace("headroom = 0.1", "headroom = 1.5"))
                .starts_with("headroom = 1.5, allowed: 0 to 1")
        );
        let missing = refusal(&FILE.replace("emulated = true\n", ""));
        assert!(missing.contains("missing field `emulated`"), "{missing}");
        assert!(refusal(&FILE.replace("cycles = 10", "cycles = -1")).starts_with("line 8: "));
        assert_eq!(
            refusal(&format!("counted_on = \"c\"\n{FILE}")),
            "counted_on = \"c\", allowed: with emulated = false"
        );
        assert_eq!(
            refusal(&FILE.replace("reduced = \"observer\"", "reduced = \"x\"")),
            "literal_mesh.reduced = \"x\", allowed: a name among [blocks]"
        );
    }

    #[test]
    fn a_bound_fails_when_it_is_exceeded_and_when_it_guards_nothing() {
        let budget = read(FILE).unwrap();
        let holds = |bound| budget.figure("x", 100.0, "1", Some(bound)).holds;
        assert!(holds(100) && holds(1000));
        assert!(!holds(99) && !holds(1001));
        assert!(budget.figure("x", 100.0, "1", None).holds);
    }

    #[test]
    fn a_literal_mesh_that_is_not_dear_enough_misses_its_floor() {
        let ratio = |floor: &str| {
            let budget = read(&FILE.replace("at_least = 300", &format!("at_least = {floor}"))).unwrap();
            let figures = measurement().figures(&budget);
            figures.into_iter().find(|f| f.name == "budget.b.literal_over_reduced").unwrap()
        };
        // 12 352 instructions over 40, rounded down.
        let (kept, missed) = (ratio("308"), ratio("309"));
        assert_eq!((kept.value, kept.bound, kept.at_least, kept.holds), (308.0, Some(308.0), true, true));
        assert_eq!((missed.value, missed.bound, missed.holds), (308.0, Some(309.0), false));
        let not_run = Measurement { counts: Vec::new(), ..measurement() };
        assert!(!not_run.figures(&budget()).iter().any(|f| f.name.contains("literal")));
    }

    #[test]
    fn every_figure_has_its_stable_name() {
        let measured = Measurement { stack_mark: Some(250), ..measurement() };
        let figures = measured.figures(&read(FILE).unwrap());
        let names: Vec<&str> = figures.iter().map(|f| f.name.as_str()).collect();
        let expected = [
            "budget.b.control_step.instructions_max",
            "budget.b.control_step.instructions_mean",
            "budget.b.control_step.cycles_max",
            "budget.b.control_step.cycles_mean",
            "budget.b.observer.instructions_max",
            "budget.b.observer.instructions_mean",
            "budget.b.observer.cycles_max",
            "budget.b.observer.cycles_mean",
            "budget.b.literal_mesh.instructions_max",
            "budget.b.literal_mesh.instructions_mean",
            "budget.b.literal_mesh.cycles_max",
            "budget.b.literal_mesh.cycles_mean",
            "budget.b.literal_over_reduced",
            "budget.b.flash",
            "budget.b.ram",
            "budget.b.stack",
            "budget.b.thread_stack",
            "budget.b.interrupt_stack",
            "budget.b.stack_mark",
            "budget.b.panics",
            "budget.b.allocators",
            "budget.b.doubles",
        ];
        assert_eq!(names, expected);
        let cycles = &figures[2];
        assert_eq!((cycles.value, cycles.bound, cycles.holds), (1000.0, Some(10.0), false));
    }
}
