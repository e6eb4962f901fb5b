//! Flash and RAM that the image takes, without stack.
//!
//! A section with content takes flash. One without content (`.bss`, `.uninit`), or whose content the
//! start-up code copies elsewhere (`.data`, code in RAM), takes RAM; the latter counts in both.

use super::image::{Image, Section};

/// Flash and RAM of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Flash, in bytes.
    pub flash: u32,
    /// RAM without stack, in bytes.
    pub ram: u32,
}

impl Sizes {
    /// The sizes of `image`.
    pub fn of(image: &Image) -> Self {
        let sum = |takes: fn(&&Section) -> bool| image.sections().iter().filter(takes).map(|s| s.size).sum();
        Self { flash: sum(|s| s.load.is_some()), ram: sum(|s| s.load != Some(s.address)) }
    }
}
