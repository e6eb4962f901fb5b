//! The measured gears: beside the project, never in it.

use std::path::PathBuf;

/// Folder of the data when `STRAINWAVE_DATA` is not set: beside the project's folder.
const BESIDE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data");

/// The file of that relative path, when the data are there.
pub fn find(relative: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("STRAINWAVE_DATA").map_or_else(|| BESIDE.into(), PathBuf::from);
    Some(folder.join(relative)).filter(|path| path.is_file())
}
