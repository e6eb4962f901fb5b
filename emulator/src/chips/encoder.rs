//! Model of the encoder on the board: a MagnTek MT6835 on SPI (datasheet Rev. 1.3, "SPI interface").
//!
//! ```text
//! 1010 aaaaaaaaaaaa  then bytes from register a on, the data of the first after 16 bits; 0x003: angle and status, CRC
//! 0011 aaaaaaaaaaaa  then the byte of register a
//! ```

use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use rsemu::bus::spi::{BitOrder, ChipSelect, Format, Mode, SpiBus, SpiSlave, buses};
use rsemu::core::device::{Device, DeviceClass, PropertySpec, RealizeCtx, ResetKind, SinkPin};
use rsemu::core::error::Result;
use rsemu::core::props::{Props, ValueKind};
use rsemu::core::wire::{Level, WireId, WireSink};
use rsemu::machine::realize::Instance;
use rsemu::machine::validate::{ClassSchema, PortDir, PropSchema};

use crate::lock::locked;

/// Resolution of a reading: 2^BITS counts a revolution.
pub const BITS: u32 = 21;
/// Command of a burst from a register on, and of one register.
const BURST: u8 = 0b1010;
/// The first register of the angle.
const ANGLE: u16 = 0x003;
/// What every other register holds: neither all zeros nor all ones.
const OTHER: u8 = 0x05;
/// x^8 + x^2 + x + 1 without its first term.
const POLYNOMIAL: u8 = 0b111;

/// Class of the encoder in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.mt6835",
    version: 1,
    summary: "MT6835 magnetic encoder",
    properties: &[PropertySpec { name: "bus", kind: ValueKind::Str, required: true, summary: "its SPI bus" }],
    construct: |props| Ok(Box::new(Encoder::new(props, Arc::default())?)),
};

/// What a description may say of it.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name)
        .prop(PropSchema::new("bus", ValueKind::Str).required())
        .port("select", PortDir::In)
}

/// What the magnet shows, and whether the encoder answers.
#[derive(Debug, Default)]
pub struct Magnet {
    count: AtomicU32,
    silent: AtomicBool,
    readings: AtomicU32,
}

impl Magnet {
    /// Puts it to a count of 2^BITS a revolution.
    pub fn put(&self, count: u32) {
        self.count.store(count, Ordering::Relaxed);
    }

    /// From now on nobody drives the data line: the encoder has lost its supply.
    pub fn fail(&self) {
        self.answers(false);
    }

    /// Whether the encoder has its supply.
    pub fn answers(&self, answers: bool) {
        self.silent.store(!answers, Ordering::Relaxed);
    }

    /// Angles that were asked for.
    pub fn readings(&self) -> u32 {
        self.readings.load(Ordering::Relaxed)
    }
}

/// The encoder on its bus.
#[derive(Debug)]
pub struct Encoder {
    // A wire does not keep what it ends at.
    select: Arc<Select>,
}

impl Encoder {
    /// Of its properties, on the motor's magnet.
    pub fn new(props: &Props, magnet: Arc<Magnet>) -> Result<Self> {
        let mut reader = props.reader();
        let bus = buses::attach(props, reader.require_str("bus")?)?;
        reader.finish()?;
        bus.attach(ChipSelect(0), Arc::new(Frame { magnet, sent: Mutex::default() }))?;
        Ok(Self { select: Arc::new(Select(bus)) })
    }
}

impl Device for Encoder {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {}

    fn sink(&self, port: &str, _sources: &[WireId]) -> Option<SinkPin> {
        (port == "select").then(|| SinkPin { sink: self.select.clone(), line: 0 })
    }
}

impl Instance for Encoder {}

/// The select line, low for the time of a frame.
#[derive(Debug)]
struct Select(Arc<SpiBus>);

impl WireSink for Select {
    fn set_level(&self, _source: WireId, _line: u32, level: Level) {
        self.0.select((!level.is_high()).then_some(ChipSelect(0)));
    }
}

/// The frame that is under way.
#[derive(Debug)]
struct Frame {
    magnet: Arc<Magnet>,
    /// Bytes that came, and what follows the command.
    sent: Mutex<(Vec<u8>, [u8; 4])>,
}

impl SpiSlave for Frame {
    fn format(&self) -> Format {
        Format::new(Mode::Mode3, 8, BitOrder::MsbFirst)
    }

    fn select(&self, _selected: bool) {
        *locked(&self.sent) = Default::default();
    }

    fn transfer(&self, byte: u32) -> u32 {
        if self.magnet.silent.load(Ordering::Relaxed) {
            return 0xff;
        }
        let (sent, answer) = &mut *locked(&self.sent);
        let reply = sent.len().checked_sub(2).and_then(|at| answer.get(at)).copied().unwrap_or(0);
        sent.push(byte as u8);
        if let [high, low] = sent[..] {
            *answer = self.answer(high >> 4, u16::from_be_bytes([high & 0x0f, low]));
        }
        reply.into()
    }
}

impl Frame {
    fn answer(&self, command: u8, register: u16) -> [u8; 4] {
        if (command, register) != (BURST, ANGLE) {
            return [OTHER; 4];
        }
        self.magnet.readings.fetch_add(1, Ordering::Relaxed);
        let [_, high, middle, low] = (self.magnet.count.load(Ordering::Relaxed) << 3).to_be_bytes();
        [high, middle, low, checksum(&[high, middle, low])]
    }
}

/// Remainder of the bytes, most significant bit first. By the datasheet and not by the driver's library: a model that shares it would
/// share a mistake in its choice.
fn checksum(bytes: &[u8]) -> u8 {
    let shifted = |rest: u8| (rest << 1) ^ if rest >> 7 == 1 { POLYNOMIAL } else { 0 };
    bytes.iter().fold(0, |rest, byte| (0..8).fold(rest ^ byte, |rest, _| shifted(rest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Check value of the CRC-8 of the SMBus.
    #[test]
    fn the_checksum_is_the_datasheet_s() {
        assert_eq!(checksum(b"123456789"), 0xf4);
    }

    fn exchange(frame: &Frame, sent: &[u8]) -> Vec<u32> {
        frame.select(true);
        sent.iter().map(|byte| frame.transfer((*byte).into())).collect()
    }

    #[test]
    fn a_burst_tells_the_angle() {
        let frame = Frame { magnet: Arc::default(), sent: Mutex::default() };
        frame.magnet.put(0x15_5aa3);
        let told = exchange(&frame, &[0xa0, 0x03, 0, 0, 0, 0]);
        // 1 0101 0101 1010 1010 0011, then three bits of a status that is fine.
        assert_eq!(told[2..5], [0xaa, 0xd5, 0x18]);
        assert_eq!(told[5], u32::from(checksum(&[0xaa, 0xd5, 0x18])));
        assert_eq!(frame.magnet.readings(), 1);
    }

    #[test]
    fn one_register_is_no_reading() {
        let frame = Frame { magnet: Arc::default(), sent: Mutex::default() };
        assert_eq!(exchange(&frame, &[0x30, 0x11, 0])[2], u32::from(OTHER));
        assert_eq!(frame.magnet.readings(), 0);
    }

    #[test]
    fn without_supply_the_line_is_high() {
        let frame = Frame { magnet: Arc::default(), sent: Mutex::default() };
        frame.magnet.fail();
        assert_eq!(exchange(&frame, &[0xa0, 0x03, 0, 0]), [0xff; 4]);
    }
}
