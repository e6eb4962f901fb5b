//! Tuning link: reads a joint and tunes it at run time, over any transport of bytes.
//!
//! ```text
//! frame    COBS( version | id | message | CRC-32 of these ) | 0x00
//! ```
//!
//! A [`Request`] is answered by a [`Reply`] with its id, 1 to 255; readings of a stream have the id 0. Messages are those of postcard, all of whose
//! integers here are of fixed width: little-endian, f32 as 4 bytes. The checksum is CRC-32/ISO-HDLC, little-endian. A frame with another
//! checksum is dropped without an answer; one of another [`VERSION`] is answered by [`Refusal::Version`] and does nothing, whatever its message.
//!
//! A joint serves one request at a time, outside of its control interrupt ([`link`]). Nothing that comes over the link switches a drive on
//! but [`Request::Reset`], which leads from Safe to Ready. Gains that are set are tried: [`trial`]. The host's side is in `client`, with the feature of
//! that name.

#[cfg(any(test, feature = "client"))]
pub mod client;
pub mod frame;
pub mod link;
mod message;
pub mod reading;
pub mod trial;

pub use link::{Answer, Joint, Order, TuningLink};
pub use message::{Hello, Refusal, Reply, Request, StoreState};
pub use reading::{QUANTITIES, Reading};
pub use trial::{Function, Trial};

/// Version of frames and messages.
pub const VERSION: u8 = 1;
