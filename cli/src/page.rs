//! The page of figures that a subcommand renews.

use std::path::PathBuf;

use clap::Args;
use strainwave_desktop::io::file;
use strainwave_desktop::report::figures_page;
use strainwave_desktop::{BadInput, Figure};

use crate::figures::say;
use crate::files;

/// Longest page that is read (bytes).
const LONGEST: u64 = 10_000_000;

/// Option of the subcommands whose figures stand in the table of bounds.
#[derive(Args)]
pub struct PageArguments {
    /// Also renew this page of figures, such as docs/src/figures.md: the rows that are measured now, between its markers
    ///
    /// Rows that are not measured now keep their values. A page that is missing is made.
    #[arg(long, value_name = "FILE.md")]
    pub markdown: Option<PathBuf>,
}

impl PageArguments {
    /// Refuses a page that could not be renewed at the end.
    pub fn require_renewable(&self) -> Result<(), BadInput> {
        files::require_writable(self.markdown.as_deref())?;
        self.renewed(&[]).map(|_| ())
    }

    /// Renews the page.
    pub fn renew(&self, measured: &[Figure]) -> Result<(), BadInput> {
        if let (Some(path), Some(page)) = (&self.markdown, self.renewed(measured)?) {
            file::write(path, |out| Ok(out.write_all(page.as_bytes())?))?;
            say(format_args!("figures: {}", path.display()));
        }
        Ok(())
    }

    fn renewed(&self, measured: &[Figure]) -> Result<Option<String>, BadInput> {
        let Some(path) = &self.markdown else { return Ok(None) };
        let page = if path.exists() {
            String::from_utf8(file::read(path, LONGEST)?).map_err(|error| BadInput::new(path, error))?
        } else {
            figures_page::empty()
        };
        figures_page::renewed(&page, measured).map(Some).map_err(|why| BadInput::new(path, why))
    }
}
