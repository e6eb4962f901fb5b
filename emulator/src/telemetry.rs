//! The firmware's telemetry: the UART's bytes, decoded with the strings that the ELF file keeps.

use defmt_decoder::{DecodeError, Table};
use std::path::Path;

/// Bytes that the decoder receives at once.
const RECEIVED: usize = 1024;

/// Why telemetry could not be read.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The image could not be read.
    #[error("{path}: {error}")]
    Image {
        /// The image.
        path: String,
        /// Error of reading it.
        error: std::io::Error,
    },
    /// The image has no strings for its telemetry, or of another version.
    #[error("{path}: {reason}, an image that logs with defmt is needed")]
    NoTable {
        /// The image.
        path: String,
        /// Fault of its table.
        reason: String,
    },
}

/// The lines that an image logged, in order. A damaged frame becomes a line that says so.
///
/// # Errors
/// [`Error`] when the image is not one that logs.
pub fn decode(elf: &Path, bytes: &[u8]) -> Result<Vec<String>, Error> {
    let table = table(elf)?;
    let mut decoder = table.new_stream_decoder();
    let mut lines = Vec::new();
    // With each frame the decoder moves all that it has received: the time for a long run would grow with its square.
    for received in bytes.chunks(RECEIVED) {
        decoder.received(received);
        loop {
            match decoder.decode() {
                Ok(frame) => lines.push(frame.display_message().to_string()),
                Err(DecodeError::UnexpectedEof) => break,
                Err(DecodeError::Malformed) => lines.push("(damaged telemetry frame)".into()),
            }
        }
    }
    Ok(lines)
}

fn table(elf: &Path) -> Result<Table, Error> {
    let path = || elf.display().to_string();
    let image = std::fs::read(elf).map_err(|error| Error::Image { path: path(), error })?;
    match Table::parse(&image) {
        Ok(Some(table)) => Ok(table),
        Ok(None) => Err(Error::NoTable { path: path(), reason: "it has no .defmt section".into() }),
        Err(error) => {
            let reason = error.to_string().lines().next().unwrap_or_default().to_owned();
            Err(Error::NoTable { path: path(), reason })
        }
    }
}
