//! Vectors of an image that enables no interrupt.

unsafe extern "C" {
    fn DefaultHandler();
}

// SAFETY: this section and name are cortex-m-rt's contract for a device's vectors. No interrupt is enabled.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 1] = [DefaultHandler];
