//! The lockstep link: sensors and command travel through two host FIFOs, by semihosting.
//!
//! A blocking read stops the guest and, under `-icount`, its clock too: the plant on the host and
//! the firmware stay in step however slow either is. The host ends a run by closing its end.

use core::ffi::CStr;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m_semihosting::{nr, syscall};
use strainwave_app::frame;
use strainwave_app::{Input, Output};

static ENDED: AtomicBool = AtomicBool::new(false);
static FAILED: AtomicBool = AtomicBool::new(false);

/// The link is closed, or spoke another frame.
pub fn ended() -> bool {
    ENDED.load(Ordering::Relaxed)
}

/// The link ended for another reason than that the host closed it.
pub fn failed() -> bool {
    FAILED.load(Ordering::Relaxed)
}

fn fail() {
    FAILED.store(true, Ordering::Relaxed);
    ENDED.store(true, Ordering::Relaxed);
}

/// The two FIFOs, in the emulator's working directory.
pub struct Link {
    sensors: usize,
    command: usize,
}

impl Link {
    /// Opens both; `None` when the host has not made them.
    pub fn open() -> Option<Self> {
        let sensors = open(c"sensors.fifo", nr::open::R_BINARY)?;
        let command = open(c"command.fifo", nr::open::W_TRUNC_BINARY)?;
        Some(Self { sensors, command })
    }

    /// Waits for a frame; false when the host closed its end before the frame was whole.
    pub fn read(&self, bytes: &mut [u8]) -> bool {
        // SAFETY: the block names `bytes` and its length; the host writes no further.
        let missing = unsafe { syscall!(READ, self.sensors, bytes.as_mut_ptr(), bytes.len()) };
        missing == 0
    }

    /// Sends a frame; whether all of it went.
    pub fn write(&self, bytes: &[u8]) -> bool {
        // SAFETY: the block names `bytes` and its length; the host only reads them.
        let missing = unsafe { syscall!(WRITE, self.command, bytes.as_ptr(), bytes.len()) };
        missing == 0
    }

    /// Reads the next input; false when there is none any more. A function of its own: its frame is not on the stack while the
    /// control step's is.
    #[inline(never)]
    pub fn input(&self, input: &mut Input<f32>) -> bool {
        if ended() {
            return false;
        }
        let mut bytes = [0; frame::INPUT_BYTES];
        if !self.read(&mut bytes) {
            ENDED.store(true, Ordering::Relaxed);
            return false;
        }
        let valid = frame::read_input(&bytes, input);
        if !valid {
            fail();
        }
        valid
    }

    /// Sends an output.
    pub fn report(&self, output: &mut Output<f32>) {
        let mut bytes = [0; frame::OUTPUT_BYTES];
        frame::write_output(&mut bytes, output);
        if !self.write(&bytes) {
            fail();
        }
    }
}

fn open(name: &CStr, mode: usize) -> Option<usize> {
    // SAFETY: the block names a string, its length without the zero, and a mode.
    let handle = unsafe { syscall!(OPEN, name.as_ptr(), mode, name.count_bytes()) };
    (handle != usize::MAX).then_some(handle)
}
