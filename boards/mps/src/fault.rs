//! End of the image.

use core::ffi::CStr;
use cortex_m_rt::exception;
use cortex_m_semihosting::{debug, syscall1};

/// The run ended as it should.
pub fn succeed() -> ! {
    exit(debug::EXIT_SUCCESS)
}

/// Something is wrong, and the telemetry says what.
pub fn fail() -> ! {
    exit(debug::EXIT_FAILURE)
}

/// Something is wrong amid anything: it is said on the emulator's console.
// Inlined: its frame would be on the stack once for each handler that calls it.
#[inline(always)]
pub fn fail_because(why: &CStr) -> ! {
    // SAFETY: SYS_WRITE0 takes the address of a string that ends with a zero byte.
    unsafe { syscall1!(WRITE0, why.as_ptr()) };
    fail()
}

fn exit(status: debug::ExitStatus) -> ! {
    debug::exit(status);
    // A debugger may let the image go on.
    loop {
        cortex_m::asm::wfi();
    }
}

/// The watchdog.
#[exception]
unsafe fn NonMaskableInt() {
    fail_because(c"watchdog: the control missed its periods\n")
}

#[exception(trampoline = false)]
unsafe fn HardFault() -> ! {
    fail_because(c"hard fault\n")
}

#[exception]
unsafe fn DefaultHandler(_number: i16) {
    fail_because(c"interrupt without a handler\n")
}
