//! The f32 elementary functions of the control step, ours beside micromath's and libm's: told, not bounded.
//!
//! Cycles of one call are counted in an image of their own, with a symbol for each. Errors are the host's build's, whose f32 has
//! the same bits, over what the control step uses: any phase; square roots of any size (their error repeats with each
//! factor of 4); 1 - e^-x from x = 1e-6, a path of one control period in presliding, to 80.

use std::path::Path;

use serde::Deserialize;
use strainwave::elementary::{libm, micromath, ours};
use strainwave::real::RADIANS_PER_COUNT;
use strainwave_desktop::Figure;

use super::count::count_program;
use super::{Block, Error};
use crate::artifact::{CallGraph, Image};
use crate::counting::Counts;

/// The functions, by name.
const NAMES: [&str; 3] = ["sine_cosine", "square_root_or_zero", "one_minus_exp_neg"];

/// Where the counted functions stand.
const MODULE: &str = "strainwave_app::elementary_functions";

/// The program that calls them.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementaryFunctions {
    /// The board's program; it ends by itself, well only when ours and libm's agree.
    pub program: String,
}

/// The functions of one library.
#[derive(Clone, Copy, Debug)]
pub struct Library {
    /// Its name.
    pub name: &'static str,
    /// Sine and cosine of a phase of 2^32 counts a revolution.
    pub sine_cosine: fn(u32) -> (f32, f32),
    /// Square root.
    pub square_root_or_zero: fn(f32) -> f32,
    /// 1 - e^-x.
    pub one_minus_exp_neg: fn(f32) -> f32,
    /// Bytes of the tables that they read, in the same order.
    tables: [usize; 3],
}

/// The libraries.
pub const LIBRARIES: [Library; 3] = [
    Library {
        name: "ours",
        sine_cosine: ours::sine_cosine,
        square_root_or_zero: ours::square_root_or_zero,
        one_minus_exp_neg: ours::one_minus_exp_neg,
        tables: [ours::SINE_COSINE_TABLE, 0, ours::ONE_MINUS_EXP_NEG_TABLE],
    },
    Library {
        name: "micromath",
        sine_cosine: micromath::sine_cosine,
        square_root_or_zero: micromath::square_root_or_zero,
        one_minus_exp_neg: micromath::one_minus_exp_neg,
        tables: [0; 3],
    },
    Library {
        name: "libm",
        sine_cosine: libm::sine_cosine,
        square_root_or_zero: libm::square_root_or_zero,
        one_minus_exp_neg: libm::one_minus_exp_neg,
        tables: [0; 3],
    },
];

/// One function of one library.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementaryFunction {
    /// The function.
    pub name: &'static str,
    /// The library that it is from.
    pub origin: &'static str,
    /// Cost of a call.
    pub counts: Counts,
    /// Bytes of its code and of all that it calls; constants between the code count, those elsewhere do not.
    pub code: u32,
    /// Bytes of the tables that it reads.
    pub table: u32,
    /// Largest error: absolute of sine and cosine, relative of the others.
    pub error: f64,
}

impl ElementaryFunctions {
    /// Runs the program at `elf`, and measures each function of each library.
    ///
    /// # Errors
    /// As [`super::Measurement::add_program`].
    pub fn measure(&self, elf: &Path) -> Result<Vec<ElementaryFunction>, Error> {
        let image = Image::read(elf)?;
        let mut found = Vec::new();
        for (place, name) in NAMES.into_iter().enumerate() {
            for library in &LIBRARIES {
                let symbol = format!("{MODULE}::{}::{name}", library.name);
                let code = code(&image, &symbol)?;
                let block = Block { symbol, instructions: None, cycles: None, fixed: false };
                let counts = count_program(&image, &[(name, &block)])?;
                let Some((_, counts)) = counts.into_iter().next() else { continue };
                let (table, error) = (library.tables[place] as u32, library.errors()[place]);
                found.push(ElementaryFunction { name, origin: library.name, counts, code, table, error });
            }
        }
        Ok(found)
    }
}

/// Bytes of a function's code, with all that it calls.
fn code(image: &Image, symbol: &str) -> Result<u32, Error> {
    let roots = image.find(symbol)?;
    let graph = CallGraph::of(image, &roots, &[])?;
    Ok(graph.reachable(&roots).into_iter().map(|function| image.functions()[function].size).sum())
}

impl ElementaryFunction {
    /// Its figures on a board.
    pub fn figures(&self, board: &str) -> Vec<Figure> {
        let name = |what: &str| format!("budget.{board}.elementary.{}.{}.{what}", self.name, self.origin);
        let cycles = self.counts.cycles.map(|cycles| cycles.max as f64);
        let cycles = cycles.map(|max| Figure::reported(name("cycles_max"), max, "cycle"));
        let bytes = [("code", self.code), ("table", self.table)]
            .map(|(what, bytes)| Figure::reported(name(what), f64::from(bytes), "byte"));
        cycles.into_iter().chain(bytes).chain([Figure::reported(name("error"), self.error, "1")]).collect()
    }
}

impl Library {
    /// Largest errors: absolute of sine and cosine, relative of square root and 1 - e^-x.
    pub fn errors(&self) -> [f64; 3] {
        [
            self.sine_cosine_error(),
            relative_error(self.square_root_or_zero, f64::sqrt),
            relative_error(self.one_minus_exp_neg, |x| -(-x).exp_m1()),
        ]
    }

    /// Over a million phases of a revolution.
    fn sine_cosine_error(&self) -> f64 {
        (0..1 << 20)
            .map(|k: u32| k.wrapping_mul(4099))
            .map(|phase| {
                let (exact, found) =
                    (f64::from(phase.cast_signed()) * RADIANS_PER_COUNT, (self.sine_cosine)(phase));
                (f64::from(found.0) - exact.sin()).abs().max((f64::from(found.1) - exact.cos()).abs())
            })
            .fold(0.0, f64::max)
    }
}

/// Over x = 1e-6 to 80, evenly in the logarithm.
fn relative_error(of: fn(f32) -> f32, exact: fn(f64) -> f64) -> f64 {
    let points = 200_000;
    let (least, most) = (1e-6f64.ln(), 80f64.ln());
    (0..=points)
        .map(|k| (least + (most - least) * f64::from(k) / f64::from(points)).exp() as f32)
        .map(|x| (f64::from(of(x)) / exact(f64::from(x)) - 1.0).abs())
        .fold(0.0, f64::max)
}
