//! What serves a joint beside its control: none of it runs in the control interrupt.
//!
//! | module | what is in it |
//! | --- | --- |
//! | [`store`] | words that survive power loss, in two areas of NOR flash |
//! | `simulation` | flash whose power fails, lines that garble: on the host, with the feature of that name |
//! | [`tuning`] | the link that reads a joint and tunes it at run time, over any byte transport; its host's side with the feature `client` |
//!
//! `no_std`, no allocation; no function panics on any bytes that flash or transport hand over.
#![no_std]

#[cfg(any(test, feature = "client", feature = "simulation"))]
extern crate std;

#[cfg(any(test, feature = "simulation"))]
pub mod simulation;
pub mod store;
pub mod tuning;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// CRC-32 of records and frames. Bit by bit: a table would take 1 kB.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
