//! Ctrl-C, SIGTERM and SIGHUP: no emulator and no folder is left behind, and one line is printed.
//!
//! A signal that whoever started us had ignored stays ignored: `nohup` means it, and so does a script
//! that starts us in the background.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::{process, scratch};

/// Offset by a shell on the number of the signal that ended a program.
const SHELL_OFFSET: i32 = 128;

static ENDING: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt kills the emulators, removes their folders and exits with 128 + the signal.
pub fn end_in_order() {
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let expected = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| !ignored(&status, *signal));
        // Without a handler the kernel still ends the emulators.
        let Ok(mut signals) = Signals::new(expected) else { return };
        std::thread::spawn(move || signals.forever().next().map(end));
    });
}

fn end(signal: i32) {
    ENDING.store(true, Ordering::SeqCst);
    process::kill_all();
    scratch::remove_all();
    // Not `eprintln`: it panics when the terminal has gone, which is what SIGHUP tells.
    let _ = writeln!(io::stderr(), "error: interrupted");
    std::process::exit(SHELL_OFFSET + signal);
}

/// Whether the kernel's account of a process says that it ignores a signal.
fn ignored(status: &str, signal: i32) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

/// Returns at once, except from a program that an interrupt is ending: its errors only follow from that.
pub fn hold_if_ending() {
    while ENDING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// A lock whose data stay whole when a holder panics.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ignored_signal_is_seen_in_the_mask() {
        let status = "Name:\tx\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000000003\n";
        assert!(ignored(status, SIGHUP) && ignored(status, SIGINT));
        assert!(!ignored(status, SIGTERM) && !ignored("", SIGTERM));
    }
}
