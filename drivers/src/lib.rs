//! embedded-hal drivers of the joint's sensors, and of drives behind a bus: [`cia402`], [`moteus`], [`odrive`]; the joint itself as a node on a
//! bus: [`cia402::node`].
//!
//! Every encoder has a file that opens with its frame, its timing and the datasheet; what a board sees of it is
//! [`Encoder`]. `docs/src/add-sensor.md` compares them.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod as5047p;
pub mod biss_c;
mod bus;
pub mod cia402;
pub mod drive;
pub mod encoder;
pub mod fault;
pub mod ma732;
pub mod moteus;
pub mod mt6835;
pub mod odrive;
pub mod quadrature;
#[cfg(test)]
mod testing;
pub mod tle5012b;

pub use as5047p::As5047p;
pub use biss_c::BissC;
pub use encoder::{Encoder, OneFrame, Scaled, SpiEncoder};
pub use fault::{Error, Fault};
pub use ma732::Ma732;
pub use mt6835::Mt6835;
pub use quadrature::Quadrature;
pub use tle5012b::Tle5012b;
