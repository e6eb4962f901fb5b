//! defmt over USART1, from thread mode only: see [`strainwave_app::logger`].

use crate::serial;
use strainwave_app::logger::Frames;

static FRAMES: Frames = Frames::new();

#[defmt::global_logger]
struct Logger;

// SAFETY: `Frames` discards whatever does not come from the one thread, so calls cannot interleave.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        FRAMES.start(serial::send);
    }

    unsafe fn flush() {}

    unsafe fn release() {
        FRAMES.end(serial::send);
    }

    unsafe fn write(bytes: &[u8]) {
        FRAMES.write(bytes, serial::send);
    }
}
