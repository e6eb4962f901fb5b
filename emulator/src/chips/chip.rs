//! The chip with the board around it, booted with an image.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use object::Endianness;
use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ElfSymbol32, ProgramHeader};
use object::{Object, ObjectSymbol};
use rsemu::core::clock::GlobalTime;
use rsemu::core::space::{AddressSpace, MemAttrs};
use rsemu::core::value::Width;
use rsemu::cpu::arm::v7m::{self, ArmV7m};
use rsemu::host::chardev::{CharPort, ports};
use rsemu::machine::{self, Machine, catalog};

use crate::artifact::symbol;
use crate::chips::cpu::Core;
use crate::chips::encoder::{self, Encoder, Magnet};
use crate::chips::model::{Model, Timer};
use crate::chips::rp2350::{blocks, sio, spi, watchdog};
use crate::chips::spi_master;
use crate::chips::stm32::g4_fdcan::{self, CanBus, Fdcan};
use crate::chips::stm32::halfwords::{self, Halfwords};
use crate::chips::stm32::{f4_dma, h7_flash, h7_pwr, h7_rcc, h7_spi};
use crate::chips::system_reset::{self, SystemReset};
use crate::telemetry;

/// What an erased byte of the flash reads.
const ERASED: u8 = 0xff;
/// What the stack is filled with before the start.
const FILL: u32 = 0x5a5a_5a5a;
/// The joint's constants in RAM.
const CONSTANTS: &str = "strainwave_controller::joint::WORDS";
/// Control register of TIM2.
const TIM2_CONTROL: u64 = 0x4000_0000;
/// In the control register of either timer: it runs.
const TIMER_RUNS: u32 = 1;
/// Longest time between two looks at the clock of what is serial: less than a character's.
const QUANTUM: Duration = Duration::from_micros(10);

/// Why the image was not run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The image.
    #[error("{}: {why}", image.display())]
    Image {
        /// The image.
        image: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The emulator.
    #[error("emulated chip: {0}")]
    Emulator(#[from] rsemu::Error),
    /// An address that nothing answers at.
    #[error("emulated chip: nothing answers at {0:#010x}")]
    Bus(u64),
    /// Its telemetry.
    #[error(transparent)]
    Telemetry(#[from] telemetry::Error),
    /// The image does not get as far as to start its control.
    #[error("emulated chip: the control did not start: {said}")]
    NotStarted {
        /// Its last telemetry.
        said: String,
    },
}

/// The emulated chip.
pub struct Chip {
    model: &'static Model,
    machine: Machine,
    core: Arc<ArmV7m>,
    memory: Arc<AddressSpace>,
    magnet: Arc<Magnet>,
    buses: [Arc<CanBus>; 2],
    serial: Arc<CharPort>,
    elf: PathBuf,
    /// What it has sent.
    sent: Vec<u8>,
}

impl Chip {
    /// The chip in reset, the image in its flash.
    ///
    /// # Errors
    /// [`Error::Image`] for a file that is no image for its flash.
    pub fn boot(model: &'static Model, elf: &Path) -> Result<Self, Error> {
        Self::with_flash(model, flash(model, elf)?, elf)
    }

    /// The same with what a store held before, if anything.
    ///
    /// # Errors
    /// As [`Self::boot`]; for an image that is where the store is.
    pub fn boot_with_store(model: &'static Model, elf: &Path, kept: Option<&[u8]>) -> Result<Self, Error> {
        let mut flash = flash(model, elf)?;
        let offset = |address: u32| (address - model.flash.0) as usize;
        if let (Some((begin, size)), Some(kept)) = (model.store, kept) {
            let place = flash.get_mut(offset(begin)..).and_then(|rest| rest.get_mut(..size));
            let place = place.filter(|place| place.iter().all(|byte| *byte == ERASED));
            let why = || String::from("it is where the store is");
            let place = place.ok_or_else(|| Error::Image { image: elf.to_owned(), why: why() })?;
            place.iter_mut().zip(kept).for_each(|(place, byte)| *place = *byte);
        }
        Self::with_flash(model, flash, elf)
    }

    fn with_flash(model: &'static Model, flash: Vec<u8>, elf: &Path) -> Result<Self, Error> {
        let mut options = catalog::build_options()?;
        let mut registry = catalog::registry()?;
        let magnet = Arc::<Magnet>::default();
        let shown = magnet.clone();
        options
            .bindings
            .bind(encoder::CLASS.name, move |props| Ok(Arc::new(Encoder::new(props, shown.clone())?)))?;
        let buses = <[Arc<CanBus>; 2]>::default();
        let wired = buses.clone();
        options.bindings.bind(g4_fdcan::CLASS.name, move |props| Ok(Arc::new(Fdcan::new(props, &wired)?)))?;
        options.bindings.bind(f4_dma::CLASS.name, |_| Ok(Arc::new(f4_dma::Stream::default())))?;
        options.bindings.bind(halfwords::CLASS.name, |props| Ok(Arc::new(Halfwords::new(props)?)))?;
        options.bindings.bind(h7_flash::CLASS.name, |props| Ok(Arc::new(h7_flash::Flash::new(props)?)))?;
        options.bindings.bind(h7_rcc::CLASS.name, |_| Ok(Arc::new(h7_rcc::new())))?;
        options.bindings.bind(h7_pwr::CLASS.name, |_| Ok(Arc::new(h7_pwr::new())))?;
        options.bindings.bind(h7_spi::CLASS.name, |props| Ok(Arc::new(h7_spi::new(props)?)))?;
        options.bindings.bind(blocks::CLASS.name, |props| Ok(Arc::new(blocks::new(props)?)))?;
        options.bindings.bind(sio::CLASS.name, |_| Ok(Arc::new(sio::Sio::default())))?;
        options.bindings.bind(spi::CLASS.name, |props| Ok(Arc::new(spi::new(props)?)))?;
        options.bindings.bind(system_reset::CLASS.name, |_| Ok(Arc::new(SystemReset::default())))?;
        options.bindings.bind(watchdog::CLASS.name, |_| Ok(Arc::new(watchdog::Watchdog::default())))?;
        let core = Arc::<OnceLock<Arc<ArmV7m>>>::default();
        let built = core.clone();
        options.bindings.replace(v7m::CLASS.name, move |props| {
            let core = Arc::new(Core::from_props(props)?);
            built.get_or_init(|| core.inner().clone());
            Ok(core)
        });
        for (class, schema) in [
            (&encoder::CLASS, encoder::schema()),
            (&f4_dma::CLASS, f4_dma::schema()),
            (&g4_fdcan::CLASS, g4_fdcan::schema()),
            (&halfwords::CLASS, halfwords::schema()),
            (&h7_flash::CLASS, h7_flash::schema()),
            (&h7_rcc::CLASS, h7_rcc::schema()),
            (&h7_pwr::CLASS, h7_pwr::schema()),
            (&h7_spi::CLASS, spi_master::schema(&h7_spi::CLASS)),
            (&blocks::CLASS, blocks::schema()),
            (&sio::CLASS, sio::schema()),
            (&spi::CLASS, spi_master::schema(&spi::CLASS)),
            (&system_reset::CLASS, system_reset::schema()),
            (&watchdog::CLASS, watchdog::schema()),
        ] {
            registry.add(class)?;
            options.classes.insert(schema);
        }
        options.realize.media.insert("firmware", flash);
        options.realize.scheduler.quantum = time(QUANTUM);
        let serial = ports::open(&options.realize.hosts, model.serial)?;
        let machine = machine::build(model.board, model.description, &registry, &options)?;
        let memory = machine.space("mem").cloned().ok_or(Error::Bus(0))?;
        let core = core.get().cloned().ok_or(Error::Bus(0))?;
        let chip = Self {
            model,
            machine,
            core,
            memory,
            magnet,
            buses,
            serial,
            elf: elf.to_owned(),
            sent: Vec::new(),
        };
        for address in model.stack().step_by(4) {
            chip.write(address, FILL)?;
        }
        Ok(chip)
    }

    /// What its motor encoder sees.
    pub fn magnet(&self) -> &Magnet {
        &self.magnet
    }

    /// The CAN bus that it is at. A chip without one hears and sends nothing.
    pub fn bus(&self) -> &CanBus {
        let [bus, _] = &self.buses;
        bus
    }

    /// Its second one, of its drive.
    pub fn second_bus(&self) -> &CanBus {
        let [_, bus] = &self.buses;
        bus
    }

    /// Lets it run.
    ///
    /// # Errors
    /// [`Error::Emulator`].
    pub fn run(&mut self, span: Duration) -> Result<(), Error> {
        self.machine.run_for(time(span))?;
        self.sent.extend(self.serial.drain());
        Ok(())
    }

    /// The control's timer runs.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn controls(&self) -> Result<bool, Error> {
        let control = match self.model.timer {
            Timer::Tim2 => self.read(TIM2_CONTROL)?,
            Timer::SysTick => self.core.with_sys(|core| core.syst_csr),
        };
        Ok(control & TIMER_RUNS != 0)
    }

    /// Stops the control's timer, as a fault of the chip would.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn stop_timer(&self) -> Result<(), Error> {
        match self.model.timer {
            Timer::Tim2 => self.write(TIM2_CONTROL, 0)?,
            Timer::SysTick => self.core.with_sys(|core| core.syst_csr = 0),
        }
        Ok(())
    }

    /// Changes the least significant bit of a word of the joint's constants in RAM, at this share of them, 0 to 1.
    ///
    /// # Errors
    /// [`Error::Image`] for an image whose constants are in flash, [`Error::Bus`].
    pub fn change_constant(&self, share: f64) -> Result<(), Error> {
        let Range { start, end } = constants(&self.elf)?;
        let word = start + ((end - start) as f64 * share) as u64 / 4 * 4;
        self.write(word, self.read(word)? ^ 1)
    }

    /// What the drive is told: the code of the torque, 2048 for none, and that it is enabled.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn drive(&self) -> Result<(u32, bool), Error> {
        let ((torque, lowest), (port, enable)) = (self.model.torque, self.model.enable);
        Ok((self.read(torque)? >> lowest, self.read(port)? & enable != 0))
    }

    /// An operator presses a key.
    pub fn press(&self, key: u8) {
        self.hears(&[key]);
    }

    /// Bytes that come at its serial port.
    pub fn hears(&self, bytes: &[u8]) {
        self.serial.feed(bytes);
    }

    /// What it has sent since this was last called.
    pub fn said(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.sent)
    }

    /// What its store holds.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn store(&self) -> Result<Vec<u8>, Error> {
        let (begin, size) = self.model.store.unwrap_or_default();
        let words = (u64::from(begin)..).step_by(4).take(size / 4);
        let words =
            words.map(|address| self.read(address).map(u32::to_le_bytes)).collect::<Result<Vec<_>, _>>()?;
        Ok(words.concat())
    }

    /// Every line of telemetry so far.
    ///
    /// # Errors
    /// [`Error::Telemetry`].
    pub fn telemetry(&self) -> Result<Vec<String>, Error> {
        Ok(telemetry::decode(&self.elf, &self.sent)?)
    }

    /// Most bytes of stack in use at once so far.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn stack(&self) -> Result<u64, Error> {
        for address in self.model.stack().step_by(4) {
            if self.read(address)? != FILL {
                return Ok(self.model.stack().end - address);
            }
        }
        Ok(0)
    }

    fn read(&self, address: u64) -> Result<u32, Error> {
        let word = self.memory.read(address, Width::U32, MemAttrs::DEBUG);
        word.map(|word| word as u32).map_err(|_| Error::Bus(address))
    }

    fn write(&self, address: u64, word: u32) -> Result<(), Error> {
        let written = self.memory.write(address, Width::U32, word.into(), MemAttrs::DEFAULT);
        written.map_err(|_| Error::Bus(address))
    }
}

fn time(span: Duration) -> GlobalTime {
    GlobalTime::from_nanos(span.as_nanos() as u64)
}

/// Where the image has the joint's constants while it runs.
fn constants(elf: &Path) -> Result<Range<u64>, Error> {
    let wrong = |why: String| Error::Image { image: elf.to_owned(), why };
    let bytes = std::fs::read(elf).map_err(|error| wrong(error.to_string()))?;
    let file = ElfFile32::<Endianness>::parse(&*bytes).map_err(|error| wrong(error.to_string()))?;
    let named =
        |symbol: &ElfSymbol32<'_, '_>| symbol.name().is_ok_and(|name| symbol::path(name) == CONSTANTS);
    let found = file.symbols().find(named).ok_or_else(|| wrong(format!("no static {CONSTANTS}")))?;
    Ok(found.address()..found.address() + found.size())
}

/// The flash with the image's segments where they are loaded.
fn flash(model: &Model, elf: &Path) -> Result<Vec<u8>, Error> {
    let wrong = |why: String| Error::Image { image: elf.to_owned(), why };
    let bytes = std::fs::read(elf).map_err(|error| wrong(error.to_string()))?;
    let file = ElfFile32::<Endianness>::parse(&*bytes).map_err(|error| wrong(error.to_string()))?;
    let (begin, size) = model.flash;
    let mut flash = vec![ERASED; size];
    for segment in file.elf_program_headers() {
        let order = file.endian();
        let data = segment.data(order, &*bytes).map_err(|()| wrong("a segment is beyond its end".into()))?;
        if segment.p_type(order) != PT_LOAD || data.is_empty() {
            continue;
        }
        let offset = segment.p_paddr(order).checked_sub(begin).map(|offset| offset as usize);
        let place = offset.and_then(|offset| flash.get_mut(offset..)?.get_mut(..data.len()));
        place.ok_or_else(|| wrong("a segment is not in the flash".into()))?.copy_from_slice(data);
    }
    Ok(flash)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chips::can::CanFrame;
    use crate::chips::model::MODELS;

    /// A chip that runs `code` from its reset vector on.
    fn chip(model: &'static Model, code: &[u16]) -> Chip {
        let (begin, size) = model.flash;
        let mut flash = vec![0xff; size];
        let vectors = [model.stack().end as u32, begin + 9];
        for (place, word) in flash.chunks_exact_mut(4).zip(vectors) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        for (place, half) in flash[8..].chunks_exact_mut(2).zip(code) {
            place.copy_from_slice(&half.to_le_bytes());
        }
        Chip::with_flash(model, flash, Path::new("none")).unwrap()
    }

    #[test]
    fn it_runs_what_is_in_its_flash() {
        for model in &MODELS {
            // push {r0, r1}; b .
            let mut chip = chip(model, &[0xb403, 0xe7fe]);
            assert_eq!(chip.stack().unwrap(), 0);
            chip.run(Duration::from_micros(100)).unwrap();
            assert_eq!(chip.stack().unwrap(), 8, "{}", model.board);
            assert!(!chip.controls().unwrap());
            assert_eq!(chip.drive().unwrap(), (0, false));
        }
    }

    /// Interrupts of the core's timer, at every place of an IT block whose condition never holds: nothing of it is executed.
    #[test]
    fn an_interrupt_leaves_a_block_its_condition() {
        const START: [u16; 22] = [
            0x2000, 0x2100, 0x2400, 0x4a08, // r0 = 0, r1 = 0, r4 = 0, r2 = SysTick
            0x239d, 0x015b, 0x3303, 0x6053, // reload 157*32 + 3: longer than a run of the core
            0x6090, 0x2307, 0x6013, // from it on, with interrupts
            0x2800, 0xbf1f, 0x3101, 0x3101, 0x3101, 0x3101, // if r0 != 0: r1 += 1, four times
            0xe7f8, // again
            0x3401, 0x4770, // its handler: r4 += 1
            0xe010, 0xe000,
        ];
        const HANDLER: u32 = 0x64;
        for model in &MODELS {
            let vector = model.flash.0 + HANDLER + 1;
            let mut code = [0; 50];
            code[0] = 0xe01a; // b start
            (code[26], code[27]) = (vector as u16, (vector >> 16) as u16);
            code[28..].copy_from_slice(&START);
            let mut chip = chip(model, &code);
            chip.run(Duration::from_millis(20)).unwrap();
            let registers = chip.core.regs().r;
            assert!(registers[4] > 300, "{}: {} interrupts", model.board, registers[4]);
            assert_eq!(registers[1], 0, "{}", model.board);
        }
    }

    #[test]
    fn a_nucleo_g474re_is_at_its_bus_once_its_clock_is_on() {
        const CLOCKS: u64 = 0x4002_1058;
        const FDCAN: u64 = 0x4000_6400;
        let model = MODELS.iter().find(|model| model.board == "nucleo-g474re").unwrap();
        // b .
        let mut chip = chip(model, &[0xe7fe]);
        assert_eq!(chip.read(FDCAN + 4).unwrap(), 0);
        chip.write(CLOCKS, chip.read(CLOCKS).unwrap() | 1 << 25).unwrap();
        assert_eq!(chip.read(FDCAN + 4).unwrap(), 0x8765_4321);
        // Into the message RAM: of identifier 5, no bytes. On the bus: 1 Mbit/s, no filters, all into FIFO 0.
        for (address, word) in [
            (0x4000_a400 + 0x278, 5 << 18),
            (FDCAN + 0x18, 3),
            (FDCAN + 0x1c, 0x0600_1005),
            (FDCAN + 0x18, 0),
            (FDCAN + 0xcc, 1),
        ] {
            chip.write(address, word).unwrap();
        }
        // It has joined, and its frame is on its way.
        chip.run(Duration::from_micros(50)).unwrap();
        assert_eq!(chip.bus().take(), []);
        chip.bus().put(CanFrame::of(0x123, &[7]).unwrap());
        chip.run(Duration::from_micros(100)).unwrap();
        assert_eq!(chip.bus().take(), [CanFrame::of(5, &[]).unwrap()]);
        let words = [FDCAN + 0x90, 0x4000_a4b0, 0x4000_a4b8].map(|address| chip.read(address).unwrap());
        assert_eq!(words, [1 | 1 << 16, 0x123 << 18, 7]);
        // The second one has its own registers and message RAM.
        let words = [FDCAN + 0x490, 0x4000_a750 + 0xb0, FDCAN + 0x404].map(|at| chip.read(at).unwrap());
        assert_eq!(words, [0, 0, 0x8765_4321]);
        assert_eq!(chip.second_bus().take(), []);
    }

    #[test]
    fn a_file_that_is_no_image_is_refused_by_name() {
        let error = Chip::boot(&MODELS[0], Path::new(file!())).err().unwrap().to_string();
        assert!(error.contains("chip.rs"), "{error}");
        let error = Chip::boot(&MODELS[0], Path::new("nowhere.elf")).err().unwrap().to_string();
        assert!(error.starts_with("nowhere.elf"), "{error}");
    }
}
