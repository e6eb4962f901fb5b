//! Network management: the state of the node on the bus, and the commands of the master.
//!
//! Reference: CiA 301, section "Network management".

use crate::cia402::state::OPERATIONAL;

/// Where the node is after its boot-up, by the value of a heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Nmt {
    /// Neither SDO nor PDO.
    Stopped = 4,
    Operational = OPERATIONAL,
    /// SDO, no PDO.
    PreOperational = 0x7f,
}

/// What the master wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    Enter(Nmt),
    /// Reset of the node or of its communication: here the same, as all settings are those of the communication.
    Reset,
}

impl Command {
    pub(super) const fn of(command: u8) -> Option<Self> {
        match command {
            1 => Some(Self::Enter(Nmt::Operational)),
            2 => Some(Self::Enter(Nmt::Stopped)),
            0x80 => Some(Self::Enter(Nmt::PreOperational)),
            0x81 | 0x82 => Some(Self::Reset),
            _ => None,
        }
    }
}
