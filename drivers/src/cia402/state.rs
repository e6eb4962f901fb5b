//! States of a drive, the statusword that tells each, and the commands of a controlword.
//!
//! ```text
//!                          statusword             command             controlword
//! not ready                x0xx 0000              shutdown            x110   0x06
//! switch on disabled       x1xx 0000              switch on           0111   0x07, from operation enabled: disable operation
//! ready to switch on       x01x 0001              enable operation    1111   0x0f
//! switched on              x01x 0011              disable voltage     xx0x   0x00
//! operation enabled        x01x 0111              quick stop          x01x   0x02
//! quick stop active        x00x 0111              fault reset         rising edge of bit 7
//! fault reaction active    x0xx 1111
//! fault                    x0xx 1000
//! ```
//!
//! Reference: CiA 402-2 (IEC 61800-7-201), sections "Finite state automaton", "Controlword" and "Statusword"; CiA 301 for the NMT state.

/// Controlword "shutdown".
pub(super) const SHUTDOWN: u16 = 0x06;
/// Controlword "switch on".
pub(super) const SWITCH_ON: u16 = 0x07;
/// Controlword "enable operation".
pub(super) const ENABLE_OPERATION: u16 = 0x0f;
/// Controlword "disable voltage".
pub(super) const DISABLE_VOLTAGE: u16 = 0x00;
/// Bit of the controlword whose rising edge resets a fault.
pub(super) const FAULT_RESET: u16 = 0x80;

/// NMT state of a node that exchanges PDOs.
pub(super) const OPERATIONAL: u8 = 5;

/// State of the drive by its statusword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It starts.
    NotReady,
    /// Waits for shutdown.
    SwitchOnDisabled,
    /// Waits for switch on.
    ReadyToSwitchOn,
    /// Waits for enable operation.
    SwitchedOn,
    /// It follows its target.
    OperationEnabled,
    /// It stops.
    QuickStopActive,
    /// It stops for a fault.
    FaultReactionActive,
    /// It has stopped for a fault.
    Fault,
}

impl State {
    /// The state that a statusword tells.
    pub const fn of(statusword: u16) -> Self {
        match (statusword & 0x4f, statusword & 0x6f) {
            (0x40, _) => Self::SwitchOnDisabled,
            (_, 0x21) => Self::ReadyToSwitchOn,
            (_, 0x23) => Self::SwitchedOn,
            (_, 0x27) => Self::OperationEnabled,
            (_, 0x07) => Self::QuickStopActive,
            (0x0f, _) => Self::FaultReactionActive,
            (0x08, _) => Self::Fault,
            // 0x00, and what no drive may send.
            _ => Self::NotReady,
        }
    }

    /// Bits 0 to 3, 5 and 6 of the statusword that tells this state.
    pub const fn statusword(self) -> u16 {
        match self {
            Self::NotReady => 0x00,
            Self::SwitchOnDisabled => 0x40,
            Self::ReadyToSwitchOn => 0x21,
            Self::SwitchedOn => 0x23,
            Self::OperationEnabled => 0x27,
            Self::QuickStopActive => 0x07,
            Self::FaultReactionActive => 0x0f,
            Self::Fault => 0x08,
        }
    }
}

/// Command by bits 0 to 3 of a controlword: each of their combinations is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    Shutdown,
    /// From operation enabled: disable operation.
    SwitchOn,
    EnableOperation,
    DisableVoltage,
    QuickStop,
}

impl Command {
    pub(super) const fn of(controlword: u16) -> Self {
        match controlword & 0x0f {
            0x0f => Self::EnableOperation,
            0x07 => Self::SwitchOn,
            0x06 | 0x0e => Self::Shutdown,
            0x02 | 0x03 | 0x0a | 0x0b => Self::QuickStop,
            _ => Self::DisableVoltage,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statuswords_are_those_of_the_standard() {
        // Bits beyond the mask as drives set them: voltage enabled, remote.
        let words = [
            (0x0000, State::NotReady),
            (0x0250, State::SwitchOnDisabled),
            (0x0231, State::ReadyToSwitchOn),
            (0x0233, State::SwitchedOn),
            (0x0237, State::OperationEnabled),
            (0x1237, State::OperationEnabled),
            (0x0217, State::QuickStopActive),
            (0x021f, State::FaultReactionActive),
            (0x0218, State::Fault),
        ];
        for (word, state) in words {
            assert_eq!(State::of(word), state, "{word:#06x}");
            assert_eq!(State::of(state.statusword() | 0x0210), state, "{word:#06x}");
        }
    }

    #[test]
    fn commands_are_those_of_the_standard() {
        // Mask, bits, command: the standard's table with "x" for what the mask leaves out.
        let table = [
            (0x07, 0x06, Command::Shutdown),
            (0x0f, 0x07, Command::SwitchOn),
            (0x0f, 0x0f, Command::EnableOperation),
            (0x02, 0x00, Command::DisableVoltage),
            (0x06, 0x02, Command::QuickStop),
        ];
        for word in 0..=u16::MAX {
            let rows: std::vec::Vec<_> = table.iter().filter(|row| word & row.0 == row.1).collect();
            let [row] = rows[..] else { panic!("{word:#06x}: {rows:?}") };
            assert_eq!(Command::of(word), row.2, "{word:#06x}");
        }
    }
}
