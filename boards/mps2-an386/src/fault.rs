//! How the image ends when something is wrong.

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::{debug, syscall1};

/// Ends the emulator.
pub fn exit(status: debug::ExitStatus) -> ! {
    debug::exit(status);
    // A debugger may let the image go on.
    loop {
        cortex_m::asm::wfi();
    }
}

/// Says why on the emulator's console, then ends it: the logger may be amid a frame.
fn fail(why: &core::ffi::CStr) -> ! {
    // SAFETY: SYS_WRITE0 takes the address of a string that ends with a zero byte.
    unsafe { syscall1!(WRITE0, why.as_ptr()) };
    exit(debug::EXIT_FAILURE)
}

/// The watchdog.
#[exception]
unsafe fn NonMaskableInt() {
    fail(c"watchdog: the control missed its periods\n")
}

#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    fail(c"hard fault\n")
}

#[exception]
unsafe fn DefaultHandler(_number: i16) {
    fail(c"interrupt without a handler\n")
}

unsafe extern "C" {
    /// Defined nowhere: an image in which a panic can be reached does not link.
    fn strainwave_a_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_info: &core::panic::PanicInfo) -> ! {
    // SAFETY: never linked.
    unsafe { strainwave_a_panic_is_reachable() }
}

/// defmt's own would call `core::panic!`, and older linkers keep it even when nothing uses it.
#[defmt::panic_handler]
fn logged_panic() -> ! {
    // SAFETY: never linked.
    unsafe { strainwave_a_panic_is_reachable() }
}
