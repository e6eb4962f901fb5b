//! Start of the clocks.

/// Polls: about 100 ms at the 16 MHz, 25 ms at the 64 MHz that a chip starts with.
const POLLS: u32 = 200_000;

/// Whether a crystal or what runs from it gets ready in time.
pub fn starts(ready: impl Fn() -> bool) -> bool {
    (0..POLLS).any(|_| ready())
}
