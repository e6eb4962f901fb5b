//! Makes a bare machine ready: a compiler for a board's target, and QEMU.
//!
//! Installed programs are used; missing ones are fetched, and announced before, without changing the
//! system: `rustup target add`, or Debian packages that are unpacked in the user's cache folder.
//!
//! ```text
//! compiler, emulator -> package_set: lock, fetch, unpack, rename
//!                         -> apt: resolve, download, check      -> unpack: files, links, starters
//! ```
//!
//! The decisions ask a [`Host`], so that the tests can play any machine.

mod apt;
mod cache;
mod compiler;
mod download;
mod emulator;
mod error;
mod host;
mod needed;
mod package_set;
mod unpack;
mod version;

pub use compiler::{Compiler, compiler, present_compiler};
pub use download::Download;
pub use emulator::{Emulator, emulator, present_emulator, this_emulator};
pub use error::{Error, Unfetched};
pub use host::{Host, Job, ThisHost};
pub use needed::{EMULATOR, OLDEST_COMPILER, OLDEST_EMULATOR};

#[cfg(test)]
mod tests;
