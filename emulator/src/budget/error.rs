//! Why a budget cannot be judged.

use std::path::PathBuf;

use crate::{artifact, counting};

/// Why a workload failed.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// A budget that cannot be judged, in one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The budget file cannot be read or written.
    #[error("{}: {source}", file.display())]
    File {
        /// The budget file.
        file: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The budget file says something else than a budget.
    #[error("{}: {what}", file.display())]
    Content {
        /// The budget file.
        file: PathBuf,
        /// Its fault.
        what: String,
    },
    /// The image cannot be judged.
    #[error(transparent)]
    Image(#[from] artifact::Error),
    /// Nothing was counted.
    #[error(transparent)]
    Counting(#[from] counting::Error),
    /// The workload failed.
    #[error(transparent)]
    Workload(Failure),
    /// A block was never executed.
    #[error("block {block}: the workload never calls {symbol}, allowed: at least once")]
    NotCalled {
        /// The block.
        block: String,
        /// Its function.
        symbol: String,
    },
}
