//! Object dictionary: what SDOs read and write.
//!
//! Reference: CiA 301, section "Object dictionary", and CiA 402-2, each object by its index.

use super::demand::{Mode, SUPPORTED_MODES};
use super::heartbeat::{Consumer, Producer};
use super::nmt::Nmt;
use super::period::Period;
use super::sdo::{Abort, Value};
use super::{EMCY, Node, SYNC};

/// Counts of one revolution of the output.
const COUNTS: u32 = 1 << 26;

/// A servo drive (bit 17) by CiA 402.
const DEVICE_TYPE: u32 = 0x0002_0192;

const INDICES: [u16; 30] = [
    0x1000, 0x1001, 0x1005, 0x1014, 0x1016, 0x1017, 0x1018, 0x1400, 0x1401, 0x1600, 0x1601, 0x1800, 0x1801,
    0x1a00, 0x1a01, 0x603f, 0x6040, 0x6041, 0x6060, 0x6061, 0x6064, 0x606c, 0x6071, 0x6076, 0x6077, 0x607a,
    0x608f, 0x60c2, 0x60ff, 0x6502,
];

impl Node {
    pub(super) fn writable(object: (u16, u8)) -> bool {
        Self::fixed(object) || matches!(object, (0x1016, 1) | (0x1017, 0) | (0x6060, 0) | (0x60c2, 1 | 2))
    }

    /// The value of an object, by index and subindex.
    pub(super) fn object(&self, object: (u16, u8)) -> Result<Value, Abort> {
        let missing = if INDICES.contains(&object.0) { Abort::NoSubindex } else { Abort::NoObject };
        self.communication(object)
            .or_else(|| self.pdo_parameter(object))
            .or_else(|| self.profile(object))
            .ok_or(missing)
    }

    fn communication(&self, object: (u16, u8)) -> Option<Value> {
        let [product, revision, serial] = self.params.identity;
        Some(match object {
            (0x1000, 0) => DEVICE_TYPE.into(),
            (0x1001, 0) => error_register(self.machine.error()).into(),
            (0x1005, 0) => u32::from(SYNC).into(),
            (0x1014, 0) => self.identifier(EMCY).into(),
            (0x1016, 0) => 1_u8.into(),
            (0x1016, 1) => self.consumer.value().into(),
            (0x1017, 0) => self.producer.time().into(),
            (0x1018, 0) => 4_u8.into(),
            (0x1018, 1) => 0_u32.into(),
            (0x1018, 2) => product.into(),
            (0x1018, 3) => revision.into(),
            (0x1018, 4) => serial.into(),
            _ => return None,
        })
    }

    fn profile(&self, object: (u16, u8)) -> Option<Value> {
        Some(match object {
            (0x603f, 0) => self.machine.error().into(),
            (0x6040, 0) => self.machine.controlword().into(),
            (0x6041, 0) => self.statusword().into(),
            (0x6060 | 0x6061, 0) => self.demand.display().into(),
            (0x6064, 0) => self.actual.position.into(),
            (0x606c, 0) => self.actual.velocity.into(),
            (0x6071, 0) => self.demand.torque.into(),
            (0x6076, 0) => ((self.params.rated_torque * 1000.0) as u32).into(),
            (0x6077, 0) => self.actual_torque().into(),
            (0x607a, 0) => self.demand.position.into(),
            (0x608f | 0x60c2, 0) => 2_u8.into(),
            (0x608f, 1) => COUNTS.into(),
            (0x608f, 2) => 1_u32.into(),
            (0x60c2, 1) => self.period.value().into(),
            (0x60c2, 2) => self.period.index().into(),
            (0x60ff, 0) => self.demand.velocity.into(),
            (0x6502, 0) => SUPPORTED_MODES.into(),
            _ => return None,
        })
    }

    pub(super) fn identifier(&self, function: u16) -> u32 {
        (function | self.node).into()
    }

    /// Writes a writable object with a value of its size.
    pub(super) fn set_object(&mut self, object: (u16, u8), value: Value) -> Result<(), Abort> {
        let data = value.bits();
        let byte = data as u8;
        match object {
            _ if Self::fixed(object) => self.confirm(object, value)?,
            (0x1016, 1) => self.consumer = Consumer::new(data, self.params.node).ok_or(Abort::Range)?,
            (0x1017, 0) => self.producer = Producer::new(data as u16),
            (0x6060, 0) => {
                self.demand.mode = Some(Mode::of(byte.cast_signed()).ok_or(Abort::Range)?);
            }
            (0x60c2, 1) => self.set_period(byte, self.period.index())?,
            (0x60c2, 2) => self.set_period(self.period.value(), byte.cast_signed())?,
            _ => return Err(Abort::ReadOnly),
        }
        Ok(())
    }

    fn set_period(&mut self, value: u8, index: i8) -> Result<(), Abort> {
        if self.nmt != Nmt::PreOperational {
            return Err(Abort::State);
        }
        let period = Period::new(value, index, self.params.rate).ok_or(Abort::Range)?;
        // Else each SYNC that is late would be a loss of the bus.
        if period.periods().saturating_mul(2) > self.params.timeout {
            return Err(Abort::Range);
        }
        self.period = period;
        Ok(())
    }
}

/// Object 0x1001 by the kind of an error code, CiA 301, section "Emergency object".
pub(super) const fn error_register(code: u16) -> u8 {
    let kind = match code >> 8 {
        0x20..0x30 => 1 << 1,
        0x30..0x40 => 1 << 2,
        0x40..0x50 => 1 << 3,
        // The last is the SYNC's.
        0x81 | 0x82 | 0x87 => 1 << 4,
        0xff => 1 << 7,
        _ => 0,
    };
    // Bit 0 is that of any error.
    if code == 0 { 0 } else { kind | 1 }
}
