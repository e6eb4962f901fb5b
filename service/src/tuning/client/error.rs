//! Why a client gives up.

use std::io;
use std::time::Duration;

use crate::tuning::{Refusal, VERSION};

/// Why a request was not carried out.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The transport failed, or the other end has closed it.
    #[error("the connection failed: {0}")]
    Port(#[from] io::Error),
    /// No sound reply has come.
    #[error(
        "no answer to {request:?}, sent {tries} times with {} s each: no joint with a tuning link is there, or it has another baud rate",
        within.as_secs_f32()
    )]
    NoAnswer {
        /// Name of the request.
        request: &'static str,
        /// How often it was sent.
        tries: u32,
        /// Time that the joint had for each.
        within: Duration,
    },
    /// The joint's firmware has another version of the link.
    #[error("the joint has version {joint} of the tuning link, this program has version {VERSION}")]
    Version {
        /// Of the joint.
        joint: u8,
    },
    /// The joint has refused the request.
    #[error("the joint has refused {request:?}: {}", why.reason())]
    Refused {
        /// Name of the request.
        request: &'static str,
        /// Why.
        why: Refusal,
    },
    /// The joint has answered with a reply that belongs to another request.
    #[error("the joint has answered {request:?} with the reply to another request")]
    Unexpected {
        /// Name of the request.
        request: &'static str,
    },
    /// The joint tries other gains than those that were set.
    #[error("the joint has gone back to its own gains: it was restarted, or has heard nothing for 1 s")]
    Lost,
}
