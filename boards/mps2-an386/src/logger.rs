//! defmt over UART 0, from thread mode only: see [`strainwave_app::logger`].

use crate::uart;
use strainwave_app::logger::Frames;

static FRAMES: Frames = Frames::new();

#[defmt::global_logger]
struct Logger;

// SAFETY: `Frames` discards whatever does not come from the one thread, so calls cannot interleave.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        FRAMES.start(uart::send);
    }

    unsafe fn flush() {}

    unsafe fn release() {
        FRAMES.end(uart::send);
    }

    unsafe fn write(bytes: &[u8]) {
        FRAMES.write(bytes, uart::send);
    }
}
