//! A progress bar for work that takes longer than a second, on a terminal only.

use std::sync::LazyLock;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

const PATIENCE: Duration = Duration::from_secs(1);

/// The bars that are shown, a line each.
static SHOWN: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// Progress of a piece of work.
pub struct Progress {
    bar: ProgressBar,
    started: Instant,
    shown: bool,
}

impl Progress {
    /// Work of `total` steps, called `what` beside the bar.
    pub fn new(total: u64, what: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden()).with_message(what);
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent:>3} % {eta}");
        Self {
            bar: bar.with_style(style.expect("the template is tested")),
            started: Instant::now(),
            shown: false,
        }
    }

    /// `done` steps are behind us.
    pub fn set(&mut self, done: u64) {
        self.bar.set_position(done);
        if !self.shown && self.started.elapsed() > PATIENCE {
            // Draws nothing when the error stream is no terminal.
            SHOWN.add(self.bar.clone());
            self.shown = true;
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        SHOWN.remove(&self.bar);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_work_shows_nothing_and_long_work_a_bar() {
        let mut progress = Progress::new(10, "work");
        progress.set(3);
        assert!(!progress.shown);
        progress.started = Instant::now().checked_sub(2 * PATIENCE).unwrap();
        progress.set(4);
        assert!(progress.shown);
        assert_eq!(progress.bar.position(), 4);
    }
}
