//! Shows how far a download is: a bar on a terminal, a line now and then elsewhere.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A download shorter than this shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);

/// Between two lines where there is no terminal.
const INTERVAL: Duration = Duration::from_secs(10);

/// A download that another program makes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Download {
    /// The folder that it fills.
    pub folder: PathBuf,
    /// Size of the folder when it is complete (bytes).
    pub total: u64,
}

impl Download {
    /// Starts to show it.
    pub fn show(&self) -> Progress<'_> {
        let bar = ProgressBar::with_draw_target(Some(self.total), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("[{bar:40}] {bytes} of {total_bytes} {eta}");
        let bar = bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Progress { download: self, bar, started: Instant::now(), shown: false, lines: 0 }
    }
}

/// A download that is being shown.
pub struct Progress<'a> {
    download: &'a Download,
    bar: ProgressBar,
    started: Instant,
    shown: bool,
    lines: u32,
}

impl Progress<'_> {
    /// Shows how far it is now.
    pub fn update(&mut self) {
        let elapsed = self.started.elapsed();
        if elapsed < PATIENCE {
            return;
        }
        let done = size(&self.download.folder);
        if !self.shown {
            // Draws nothing when the error stream is no terminal.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.shown = true;
        }
        self.bar.set_position(done.min(self.download.total));
        if self.bar.is_hidden() && elapsed > INTERVAL * (self.lines + 1) {
            self.lines += 1;
            eprintln!("{} of {}", megabytes(done), megabytes(self.download.total));
        }
    }
}

impl Drop for Progress<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A size for people.
pub fn megabytes(bytes: u64) -> String {
    format!("{} MB", bytes.div_ceil(1_000_000))
}

/// Bytes in the files of a folder and of the folders in it; what cannot be read counts nothing.
pub fn size(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| match entry.metadata() {
            Ok(metadata) if metadata.is_dir() => size(&entry.path()),
            Ok(metadata) => metadata.len(),
            Err(_) => 0,
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_counts_folders_within() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("partial")).unwrap();
        fs::write(folder.path().join("a.deb"), [0; 300]).unwrap();
        fs::write(folder.path().join("partial/b.deb"), [0; 40]).unwrap();
        assert_eq!(size(folder.path()), 340);
        assert_eq!(size(&folder.path().join("none")), 0);
        assert_eq!(
            (megabytes(0), megabytes(1), megabytes(32_800_001)),
            ("0 MB".into(), "1 MB".into(), "33 MB".into())
        );
    }

    #[test]
    fn a_short_download_shows_nothing() {
        let download = Download { folder: "none".into(), total: 10 };
        let mut progress = download.show();
        progress.update();
        assert!(!progress.shown);
        progress.started = Instant::now().checked_sub(2 * PATIENCE).unwrap();
        progress.update();
        assert!(progress.shown);
    }
}
