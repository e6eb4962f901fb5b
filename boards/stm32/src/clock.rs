//! Start of the clocks.

/// Polls at the 16 MHz that a chip starts with: about 100 ms.
const POLLS: u32 = 200_000;

/// Whether a crystal or what runs from it gets ready in time.
pub fn starts(ready: impl Fn() -> bool) -> bool {
    (0..POLLS).any(|_| ready())
}
