//! Parameters of the PDOs, and the identifiers of SYNC and EMCY: all fixed.
//!
//! Masters that configure PDOs when they start write what is there already, often between disabling and enabling:
//!
//! ```text
//! 0x1400.., 0x1800..  1  identifier | bit 31   disabled       0x1600.., 0x1a00..  0  0      disabled
//!                     1  identifier            enabled                            0  count  enabled
//! ```
//!
//! Both succeed, without effect: a PDO that the master leaves disabled is exchanged none the less. Disabling is for pre-operational only,
//! where no PDO is exchanged.
//!
//! Reference: CiA 301, section "Process data object".

use super::nmt::Nmt;
use super::sdo::{Abort, Value};
use super::{Node, RPDO1, RPDO2, TPDO1, TPDO2};

/// Bit 30 of a TPDO's identifier: remote frames get no answer.
const NO_RTR: u32 = 1 << 30;

/// Bit 31 of a PDO's identifier: the PDO is not exchanged.
const DISABLED: u32 = 1 << 31;

/// Transmission type: with every SYNC.
const SYNCHRONOUS: u8 = 1;

impl Node {
    /// The value of one of its parameters, by index and subindex.
    pub(super) fn pdo_parameter(&self, object: (u16, u8)) -> Option<Value> {
        Some(match object {
            (0x1400 | 0x1401 | 0x1800 | 0x1801, 0) => 2_u8.into(),
            (0x1400, 1) => self.identifier(RPDO1).into(),
            (0x1401, 1) => self.identifier(RPDO2).into(),
            (0x1800, 1) => (self.identifier(TPDO1) | NO_RTR).into(),
            (0x1801, 1) => (self.identifier(TPDO2) | NO_RTR).into(),
            (0x1400 | 0x1401 | 0x1800 | 0x1801, 2) => SYNCHRONOUS.into(),
            (0x1600 | 0x1a00, 0) => 3_u8.into(),
            (0x1601 | 0x1a01, 0) => 2_u8.into(),
            // Index, subindex and bits of what is mapped.
            (0x1600, 1) => 0x6040_0010_u32.into(),
            (0x1600, 2) => 0x6060_0008_u32.into(),
            (0x1600, 3) => 0x607a_0020_u32.into(),
            (0x1601, 1) => 0x60ff_0020_u32.into(),
            (0x1601, 2) => 0x6071_0010_u32.into(),
            (0x1a00, 1) => 0x6041_0010_u32.into(),
            (0x1a00, 2) => 0x6061_0008_u32.into(),
            (0x1a00, 3) => 0x6064_0020_u32.into(),
            (0x1a01, 1) => 0x606c_0020_u32.into(),
            (0x1a01, 2) => 0x6077_0010_u32.into(),
            _ => return None,
        })
    }

    /// Whether an object is written with the value that it has, only.
    pub(super) const fn fixed(object: (u16, u8)) -> bool {
        matches!(
            object,
            (0x1005 | 0x1014, 0)
                | (0x1400 | 0x1401 | 0x1800 | 0x1801, 1 | 2)
                | (0x1600 | 0x1601 | 0x1a00 | 0x1a01, _)
        )
    }

    /// A write to a fixed object: refused unless it leaves the value, or disables for a while.
    pub(super) fn confirm(&self, object: (u16, u8), value: Value) -> Result<(), Abort> {
        let present = self.object(object)?;
        if value == present {
            return Ok(());
        }
        let disabled = match object {
            (0x1400 | 0x1401 | 0x1800 | 0x1801, 1) => present.bits() | DISABLED,
            (0x1600 | 0x1601 | 0x1a00 | 0x1a01, 0) => 0,
            _ => return Err(Abort::Range),
        };
        if value.bits() != disabled {
            Err(Abort::Range)
        } else if self.nmt != Nmt::PreOperational {
            Err(Abort::State)
        } else {
            Ok(())
        }
    }
}
