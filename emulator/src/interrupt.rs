//! Ctrl-C, SIGTERM and SIGHUP: no emulator and no folder is left behind, and one line is printed.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use crate::{process, scratch};

/// What a shell reports of a program that Ctrl-C ended: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

static ENDING: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt kills the emulators, removes their folders and exits with 130.
pub fn end_in_order() {
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        // A program that has its own handler keeps it: the kernel still ends the emulators.
        let _ = ctrlc::try_set_handler(|| {
            ENDING.store(true, Ordering::SeqCst);
            process::kill_all();
            scratch::remove_all();
            // Not `eprintln`: it panics when the terminal has gone, which is what SIGHUP tells.
            let _ = writeln!(io::stderr(), "error: interrupted");
            std::process::exit(INTERRUPTED);
        });
    });
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
