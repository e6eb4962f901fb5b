//! Why a reading is refused: one list for all encoders, so that a board names what it finds in one line.

use core::fmt;

/// A frame that is no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Every bit is 0: nobody drives the data line, or it is shorted to ground.
    StuckLow,
    /// Every bit is 1: nobody drives the data line, or it is shorted to the supply.
    StuckHigh,
    /// Wrong parity: the frame was disturbed on its way.
    Parity,
    /// Wrong CRC: the frame was disturbed on its way.
    Checksum,
    /// The frame does not begin as the protocol has it, or ends too early.
    Framing,
    /// Another encoder of the same bus has answered.
    OtherEncoder,
    /// The encoder refused a command with the wrong number of clock edges.
    CommandFraming,
    /// The encoder refused a command that it does not have.
    InvalidCommand,
    /// The encoder refused a command of wrong parity.
    CommandParity,
    /// The encoder has set its error bit.
    EncoderError,
    /// The encoder has restarted since the last reading.
    Restarted,
    /// The encoder has not finished starting, or has not passed its index.
    NotReady,
    /// The encoder reports its angle as invalid.
    InvalidAngle,
    /// The magnet's field is too strong.
    FieldTooStrong,
    /// The magnet's field is too weak, or there is no magnet.
    FieldTooWeak,
    /// Faster than the encoder can follow.
    Overspeed,
    /// The encoder's supply is too low.
    Undervoltage,
    /// The encoder is configured otherwise than the driver assumes.
    Configuration,
    /// Counts were lost or gained between two passes of the index.
    LostCounts,
}

impl Fault {
    /// What is wrong, in words.
    pub const fn reason(self) -> &'static str {
        match self {
            Self::StuckLow => "data line stuck low",
            Self::StuckHigh => "data line stuck high",
            Self::Parity => "wrong parity",
            Self::Checksum => "wrong CRC",
            Self::Framing => "no frame",
            Self::OtherEncoder => "reply of another encoder",
            Self::CommandFraming => "command refused: number of clock edges",
            Self::InvalidCommand => "command refused: unknown",
            Self::CommandParity => "command refused: wrong parity",
            Self::EncoderError => "error bit set",
            Self::Restarted => "encoder has restarted",
            Self::NotReady => "encoder not ready",
            Self::InvalidAngle => "angle invalid",
            Self::FieldTooStrong => "field too strong",
            Self::FieldTooWeak => "field too weak",
            Self::Overspeed => "too fast",
            Self::Undervoltage => "supply too low",
            Self::Configuration => "configured otherwise",
            Self::LostCounts => "counts lost",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.reason())
    }
}

impl core::error::Error for Fault {}

/// Why an encoder gave no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// The bus worked; the frame is refused.
    Fault(Fault),
}

impl<E> Error<E> {
    /// What is wrong, in words.
    pub const fn reason(&self) -> &'static str {
        match self {
            Self::Bus(_) => "bus failed",
            Self::Fault(fault) => fault.reason(),
        }
    }
}

impl<E> From<Fault> for Error<E> {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl<E: fmt::Debug> fmt::Display for Error<E> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(formatter, "encoder: bus failed: {error:?}"),
            Self::Fault(fault) => write!(formatter, "encoder: {fault}"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for Error<E> {}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn errors_read_as_one_line() {
        let bus = Error::Bus(embedded_hal::spi::ErrorKind::Overrun);
        assert_eq!(bus.to_string(), "encoder: bus failed: Overrun");
        assert_eq!(bus.reason(), "bus failed");
        let fault = Error::<()>::from(Fault::Checksum);
        assert_eq!(fault.to_string(), "encoder: wrong CRC");
        assert_eq!(fault.reason(), Fault::Checksum.to_string());
    }
}
