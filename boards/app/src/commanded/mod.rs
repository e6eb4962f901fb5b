//! A joint that a controller commands over CAN, as a node by CiA 402 ([`strainwave_drivers::cia402::node`]).
//!
//! ```text
//! bus -> BusNode::poll, below the control's priority  -> Exchange -> Commanded::input, in the control interrupt
//! bus <- the same                                     <- Exchange <- Commanded::report
//! drive behind it <- the same                         <- Exchange <- Commanded::report, with the torque
//! ```
//!
//! The bus is polled once after each control interrupt: the period behind a SYNC takes its target, and that period's values answer it. Positions are
//! interpolated ([`strainwave::trajectory::Cyclic`]): the joint follows two cycles of the bus behind.
//!
//! | file | what is in it |
//! | --- | --- |
//! | `bus_node` | the node with its bus |
//! | `drive` | a drive behind the node |
//! | `error_code` | faults as error codes of CiA 301 and CiA 402 |
//! | `exchange` | between both interrupts |
//! | `frame` | a frame of classic CAN |
//! | `odrive` | an ODrive on a bus of its own |
//! | `source` | the joint's end |
//! | `targets` | what the joint follows |

mod bus_node;
mod drive;
mod error_code;
mod exchange;
mod frame;
mod odrive;
mod source;
mod targets;

pub use bus_node::{BusNode, node};
pub use drive::{Drive, DriveFault, DriveReport, Wired};
pub use exchange::Exchange;
pub use frame::Frame;
pub use odrive::{ODRIVE, Odrive};
pub use source::Commanded;
pub use strainwave_drivers::cia402::node::Wanted;

/// The joint's number on the bus, 1 to 127: that of the build.
pub const NODE: u8 = match u8::from_str_radix(env!("STRAINWAVE_NODE_NUMBER"), 10) {
    Ok(number) => number,
    Err(_) => panic!("the build script has checked it"),
};
