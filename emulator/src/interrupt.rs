//! Ctrl-C, SIGTERM and SIGHUP: no emulator and no folder is left behind, and one line is printed.
//!
//! A signal that whoever started us had ignored stays ignored: `nohup` means it, and so does a script
//! that starts us in the background.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::lock::locked;

/// Offset by a shell on the number of the signal that ended a program.
const SHELL_OFFSET: i32 = 128;

static ENDING: AtomicBool = AtomicBool::new(false);

/// The first interrupt is to set the flag, and has.
static STOPPABLE: AtomicBool = AtomicBool::new(false);
static STOPPED: AtomicBool = AtomicBool::new(false);

/// Actions of an interrupt before the end, the last one first.
static CLEAN_UPS: Mutex<Vec<fn()>> = Mutex::new(Vec::new());

/// From now on an interrupt does this too, before what was asked for earlier, and exits with 128 + the signal.
pub fn clean_up_with(clean_up: fn()) {
    locked(&CLEAN_UPS).push(clean_up);
    end_in_order();
}

/// From now on an interrupt cleans up and exits with 128 + the signal.
pub fn end_in_order() {
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let expected = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| !ignored(&status, *signal));
        // Without a handler the kernel still ends the emulators.
        let Ok(mut signals) = Signals::new(expected) else { return };
        std::thread::spawn(move || signals.forever().find(|_| !stops()).map(end));
    });
}

/// From now on the first interrupt only sets the flag that is given: work that goes on until it is interrupted ends in order, with what it
/// has. Another interrupt ends the program.
pub fn first_stops() -> &'static AtomicBool {
    STOPPABLE.store(true, Ordering::SeqCst);
    end_in_order();
    &STOPPED
}

/// This interrupt is the first of a program that stops at it.
fn stops() -> bool {
    STOPPABLE.load(Ordering::SeqCst) && !STOPPED.swap(true, Ordering::SeqCst)
}

fn end(signal: i32) {
    ENDING.store(true, Ordering::SeqCst);
    let clean_ups = locked(&CLEAN_UPS).clone();
    clean_ups.iter().rev().for_each(|clean_up| clean_up());
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The only test here that asks for it: the flags are the program's.
    #[test]
    fn the_first_interrupt_of_work_without_an_end_only_stops_it() {
        assert!(!stops());
        let stopped = first_stops();
        assert!(!stopped.load(Ordering::SeqCst));
        assert!(stops() && stopped.load(Ordering::SeqCst));
        assert!(!stops());
    }

    #[test]
    fn an_ignored_signal_is_seen_in_the_mask() {
        let status = "Name:\tx\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000000003\n";
        assert!(ignored(status, SIGHUP) && ignored(status, SIGINT));
        assert!(!ignored(status, SIGTERM) && !ignored("", SIGTERM));
    }
}
