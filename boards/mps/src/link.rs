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

    /// Waits for a frame; `None` when the host closed its end before the frame was whole.
    pub fn read<const K: usize>(&self) -> Option<[u8; K]> {
        let mut bytes = [0u8; K];
        // SAFETY: the block names `bytes` and its length; the host writes no further.
        let missing = unsafe { syscall!(READ, self.sensors, bytes.as_mut_ptr(), K) };
        (missing == 0).then_some(bytes)
    }

    /// Sends a frame; whether all of it went.
    pub fn write(&self, bytes: &[u8]) -> bool {
        // SAFETY: the block names `bytes` and its length; the host only reads them.
        let missing = unsafe { syscall!(WRITE, self.command, bytes.as_ptr(), bytes.len()) };
        missing == 0
    }

    /// The next input; `None` when there is none any more. A function of its own: its frame is not on the stack while the
    /// control step's is.
    #[inline(never)]
    pub fn input(&self) -> Option<Input<f32>> {
        if ended() {
            return None;
        }
        match self.read() {
            Some(bytes) => {
                let input = frame::decode_input(&bytes);
                if input.is_none() {
                    fail();
                }
                input
            }
            None => {
                ENDED.store(true, Ordering::Relaxed);
                None
            }
        }
    }

    /// Sends an output.
    pub fn report(&self, output: &mut Output<f32>) {
        if !self.write(&frame::encode_own_output(output)) {
            fail();
        }
    }
}

fn open(name: &CStr, mode: usize) -> Option<usize> {
    // SAFETY: the block names a string, its length without the zero, and a mode.
    let handle = unsafe { syscall!(OPEN, name.as_ptr(), mode, name.count_bytes()) };
    (handle != usize::MAX).then_some(handle)
}
