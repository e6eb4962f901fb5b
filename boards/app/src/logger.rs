//! The part of a defmt logger that is the same on every board: framing, and who may log.
//!
//! Only thread mode logs: start-up and the idle loop. A logger that could be used from interrupts too
//! would have to mask them while a frame goes out, a whole millisecond on a UART, and the
//! control interrupt would jitter by that much. So no critical section is taken here; a frame that an
//! interrupt or a fault tries to log is discarded.

use core::cell::UnsafeCell;
use defmt::Encoder;

/// The frame that is being sent.
pub struct Frames(UnsafeCell<Encoder>);

// SAFETY: the encoder is only reached through `encode`, which refuses everything but thread mode;
// there is one thread, and `Encoder` calls nothing but the `put` it is given.
unsafe impl Sync for Frames {}

impl Frames {
    /// No frame yet.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        Self(UnsafeCell::new(Encoder::new()))
    }

    /// Starts a frame; `put` sends bytes.
    pub fn start(&self, put: fn(&[u8])) {
        self.encode(|encoder| encoder.start_frame(put));
    }

    /// Adds to the frame.
    pub fn write(&self, bytes: &[u8], put: fn(&[u8])) {
        self.encode(|encoder| encoder.write(bytes, put));
    }

    /// Ends the frame.
    pub fn end(&self, put: fn(&[u8])) {
        self.encode(|encoder| encoder.end_frame(put));
    }

    fn encode(&self, action: impl FnOnce(&mut Encoder)) {
        if in_thread_mode() {
            // SAFETY: thread mode is one thread, and `action` is one of the three above, which do not
            // come back here: this is the only reference.
            action(unsafe { &mut *self.0.get() });
        }
    }
}

/// No exception is active: VECTACTIVE of the interrupt control and state register is zero.
fn in_thread_mode() -> bool {
    // SAFETY: reading this register of the system control block has no side effect.
    let state = unsafe { (*cortex_m::peripheral::SCB::PTR).icsr.read() };
    state & 0x1ff == 0
}

/// The board's defmt logger: frames go out through `$put`, a `fn(&[u8])`, from thread mode only.
#[macro_export]
macro_rules! global_logger {
    ($put:path) => {
        static FRAMES: $crate::logger::Frames = $crate::logger::Frames::new();

        #[defmt::global_logger]
        struct Logger;

        // SAFETY: `Frames` discards whatever does not come from the one thread, so calls cannot interleave.
        unsafe impl defmt::Logger for Logger {
            fn acquire() {
                FRAMES.start($put);
            }

            unsafe fn flush() {}

            unsafe fn release() {
                FRAMES.end($put);
            }

            unsafe fn write(bytes: &[u8]) {
                FRAMES.write(bytes, $put);
            }
        }
    };
}
