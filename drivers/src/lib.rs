//! embedded-hal drivers of the joint's sensors.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod as5047p;

pub use as5047p::As5047p;
