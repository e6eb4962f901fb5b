//! No panic is reachable: both handlers call a function that is defined nowhere, so that an image with a
//! panic in it does not link.

unsafe extern "C" {
    fn strainwave_a_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_info: &core::panic::PanicInfo) -> ! {
    // SAFETY: never linked.
    unsafe { strainwave_a_panic_is_reachable() }
}

/// defmt's own would call `core::panic!`.
#[defmt::panic_handler]
fn logged_panic() -> ! {
    // SAFETY: never linked.
    unsafe { strainwave_a_panic_is_reachable() }
}
