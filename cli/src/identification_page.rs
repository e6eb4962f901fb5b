//! The page that `identify` writes of what it found.

use std::path::{Path, PathBuf};

use clap::Args;
use strainwave_desktop::identify::{NotIdentified, Verdict};
use strainwave_desktop::io::file;
use strainwave_desktop::report::identification::Outcome;
use strainwave_desktop::{BadInput, Figure};

use crate::figures::tell;
use crate::files;

/// Option of `identify`.
#[derive(Args)]
pub struct IdentificationPageArguments {
    /// Also write one self-contained HTML page of what was identified, its folder made when missing
    ///
    /// Measured and predicted over each log with the part that trained marked, spectrum of what is missed, loops or friction
    /// over speed, a table of parameters with intervals, their correlations, and what to measure next. It is written also where the
    /// other file is not: then it tells why.
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

/// What the command tells beside the result.
pub struct Told<'a> {
    /// Logs, those that trained first.
    pub logs: Vec<&'a Path>,
    /// File for what was identified.
    pub output: &'a Path,
    pub verdict: &'a Verdict,
    /// A line about what was identified.
    pub described: Option<&'a str>,
    /// What was not.
    pub not_identified: &'a [NotIdentified],
    pub figures: &'a [Figure],
}

impl IdentificationPageArguments {
    /// The page, if one is asked for.
    pub fn path(&self) -> Option<&Path> {
        self.report.as_deref()
    }

    /// Refuses a page that could not be written at the end.
    pub fn require_writable(&self) -> Result<(), BadInput> {
        match self.path() {
            Some(path) if file::is_stream(path) => {
                Err(BadInput::message("--report - is not possible; allowed: a file"))
            }
            Some(path) => files::require_page(path),
            None => Ok(()),
        }
    }

    /// Draws and writes the page, if one is asked for.
    pub fn write(&self, told: &Told, draw: impl FnOnce(&Outcome) -> String) -> Result<(), BadInput> {
        let Some(path) = self.path() else { return Ok(()) };
        let logs: Vec<_> = told.logs.iter().map(|log| log.display().to_string()).collect();
        let html = draw(&Outcome {
            logs: &logs,
            output: &told.output.display().to_string(),
            verdict: told.verdict,
            described: told.described,
            not_identified: told.not_identified,
            figures: told.figures,
        });
        files::write_page(path, &html)?;
        tell(told.output, format_args!("report: {}", path.display()));
        Ok(())
    }
}
