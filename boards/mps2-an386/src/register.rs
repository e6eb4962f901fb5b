//! One 32-bit peripheral register.

/// A register at a fixed address.
pub struct Register(*mut u32);

// SAFETY: an access is a single volatile word; what a register does with it is up to its owner module.
unsafe impl Sync for Register {}

impl Register {
    /// The register at `address`.
    ///
    /// # Safety
    /// A readable and writable 32-bit register of this board must live there.
    pub const unsafe fn at(address: usize) -> Self {
        Self(address as *mut u32)
    }

    pub fn read(&self) -> u32 {
        // SAFETY: `at` was promised a register.
        unsafe { self.0.read_volatile() }
    }

    pub fn write(&self, value: u32) {
        // SAFETY: `at` was promised a register.
        unsafe { self.0.write_volatile(value) }
    }
}
