//! A peripheral of words that takes halfwords: those of this chip do (ST RM0090, 21.4 and 30.6), the emulator's take words alone.
//!
//! A halfword is written as a word, as the peripheral bus does it.

use std::sync::{Arc, OnceLock};

use rsemu::core::device::{Device, DeviceClass, PropertySpec, RealizeCtx, ResetKind};
use rsemu::core::error::{BusError, Result};
use rsemu::core::props::{Props, ValueKind};
use rsemu::core::space::{AccessConstraints, AddressSpace, MemAttrs, MemOps, MemResult, Region, RegionRef};
use rsemu::core::value::{Endian, Width};
use rsemu::machine::realize::{BindCtx, Instance};
use rsemu::machine::validate::{ClassSchema, PropSchema};

/// Class of these objects in a machine's description.
pub static CLASS: DeviceClass = DeviceClass {
    name: "strainwave.halfwords",
    version: 1,
    summary: "halfwords for a peripheral of words",
    properties: &[
        PropertySpec { name: "at", kind: ValueKind::Uint, required: true, summary: "its address" },
        PropertySpec { name: "size", kind: ValueKind::Uint, required: true, summary: "its bytes" },
    ],
    construct: |props| Ok(Box::new(Halfwords::new(props)?)),
};

/// What a description may say of them.
pub fn schema() -> ClassSchema {
    ClassSchema::new(CLASS.name)
        .prop(PropSchema::new("at", ValueKind::Uint).required())
        .prop(PropSchema::new("size", ValueKind::Uint).required())
        .region("")
}

/// Such a peripheral.
#[derive(Debug)]
pub struct Halfwords {
    port: Arc<Port>,
    size: u64,
}

impl Halfwords {
    /// Of its properties.
    pub fn new(props: &Props) -> Result<Self> {
        let mut reader = props.reader();
        let at = reader.require_addr("at")?;
        let size = reader.require_size("size")?;
        reader.finish()?;
        Ok(Self { port: Arc::new(Port { at, words: OnceLock::new() }), size })
    }
}

impl Device for Halfwords {
    fn class(&self) -> &'static DeviceClass {
        &CLASS
    }

    fn realize(&self, _context: &mut RealizeCtx<'_>) -> Result<()> {
        Ok(())
    }

    fn reset(&self, _kind: ResetKind) {}

    fn region(&self, name: &str) -> Option<RegionRef> {
        let port = || Region::io(CLASS.name, self.size, self.port.clone());
        name.is_empty().then(|| Arc::new(port()))
    }
}

impl Instance for Halfwords {
    fn bind(&self, context: &BindCtx<'_>) -> Result<()> {
        if let Some(space) = context.space() {
            let _: &Arc<AddressSpace> = self.port.words.get_or_init(|| space.clone());
        }
        Ok(())
    }
}

/// Its accesses, passed on in words.
#[derive(Debug)]
struct Port {
    at: u64,
    words: OnceLock<Arc<AddressSpace>>,
}

impl Port {
    fn words(&self) -> MemResult<&AddressSpace> {
        self.words.get().map(AsRef::as_ref).ok_or(BusError::Unassigned)
    }
}

impl MemOps for Port {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        let word = self.words()?.read(self.at + (offset & !3), Width::U32, attributes)?;
        let from = word.to_le_bytes();
        bytes.copy_from_slice(&from[(offset & 3) as usize..][..bytes.len()]);
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        let mut word = [0; 8];
        word[(offset & 3) as usize..][..bytes.len()].copy_from_slice(bytes);
        self.words()?.write(self.at + (offset & !3), Width::U32, u64::from_le_bytes(word), attributes)
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::word(Width::U32, Endian::Little).with_widths(Width::U16, Width::U32)
    }
}
