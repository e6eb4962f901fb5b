//! What `identify` tells of its verdict: the line on standard error, and the figure.

use std::path::Path;

use strainwave_desktop::Figure;
use strainwave_desktop::identify::Verdict;

use crate::figures::complain;

/// Tells what speaks against the file.
pub fn complain_of(output: &Path, verdict: &Verdict) {
    if *verdict != Verdict::Written {
        complain(format_args!("{}: {verdict}", output.display()));
    }
}

/// The figure that tells whether the file was written.
pub fn was_written(verdict: &Verdict) -> Figure {
    Figure::at_least("identify.written", f64::from(u8::from(verdict.is_written())), "1", 1.0)
}
