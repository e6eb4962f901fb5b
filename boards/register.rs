//! One 32-bit peripheral register.

/// A register at a fixed address.
pub struct Register(*mut u32);

impl Register {
    /// The register `offset` bytes behind `base`.
    ///
    /// # Safety
    /// A readable and writable 32-bit register must live there.
    pub const unsafe fn at(base: usize, offset: usize) -> Self {
        Self((base + offset) as *mut u32)
    }

    /// Its value.
    pub fn read(&self) -> u32 {
        // SAFETY: `at` was promised a register.
        unsafe { self.0.read_volatile() }
    }

    /// Writes it.
    pub fn write(&self, value: u32) {
        // SAFETY: `at` was promised a register.
        unsafe { self.0.write_volatile(value) }
    }
}
