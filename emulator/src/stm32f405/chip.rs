//! The chip with the board around it, booted with an image.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use object::Endianness;
use object::elf::PT_LOAD;
use object::read::elf::{ElfFile32, ProgramHeader};
use rsemu::core::clock::GlobalTime;
use rsemu::core::space::{AddressSpace, MemAttrs};
use rsemu::core::value::Width;
use rsemu::host::chardev::{CharPort, ports};
use rsemu::machine::{self, Machine, catalog};

use crate::stm32f405::encoder::{self, Encoder, Magnet};
use crate::stm32f405::halfwords::{self, Halfwords};
use crate::telemetry;

const DESCRIPTION: &str = include_str!("stm32f405.machine");

/// Begin and size of the flash.
const FLASH: u32 = 0x0800_0000;
const FLASH_BYTES: usize = 1 << 20;
/// Begin and end of the memory that the stack has to itself.
const STACK: [u64; 2] = [0x1000_0000, 0x1001_0000];
/// What the stack is filled with before the start.
const FILL: u32 = 0x5a5a_5a5a;
/// Control register of TIM2, and in it that the timer runs.
const TIMER_CONTROL: u64 = 0x4000_0000;
const TIMER_RUNS: u32 = 1;
/// Data of the DAC's first channel, 12 bits.
const DAC_DATA: u64 = 0x4000_7408;
/// Output data of port B, and in it the drive's enable.
const PORT_B_OUTPUT: u64 = 0x4002_0414;
const ENABLE: u32 = 1;
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
    #[error("emulated STM32F405: {0}")]
    Emulator(#[from] rsemu::Error),
    /// An address that nothing answers at.
    #[error("emulated STM32F405: nothing answers at {0:#010x}")]
    Bus(u64),
    /// Its telemetry.
    #[error(transparent)]
    Telemetry(#[from] telemetry::Error),
    /// The image does not get as far as to start its control.
    #[error("emulated STM32F405: the control did not start: {said}")]
    NotStarted {
        /// Its last telemetry.
        said: String,
    },
}

/// The emulated chip.
pub struct Chip {
    machine: Machine,
    memory: Arc<AddressSpace>,
    magnet: Arc<Magnet>,
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
    pub fn boot(elf: &Path) -> Result<Self, Error> {
        Self::with_flash(flash(elf)?, elf)
    }

    fn with_flash(flash: Vec<u8>, elf: &Path) -> Result<Self, Error> {
        let mut options = catalog::build_options()?;
        let mut registry = catalog::registry()?;
        let magnet = Arc::<Magnet>::default();
        let shown = magnet.clone();
        options
            .bindings
            .bind(encoder::CLASS.name, move |props| Ok(Arc::new(Encoder::new(props, shown.clone())?)))?;
        options.bindings.bind(halfwords::CLASS.name, |props| Ok(Arc::new(Halfwords::new(props)?)))?;
        for (class, schema) in
            [(&encoder::CLASS, encoder::schema()), (&halfwords::CLASS, halfwords::schema())]
        {
            registry.add(class)?;
            options.classes.insert(schema);
        }
        options.realize.media.insert("firmware", flash);
        options.realize.scheduler.quantum = time(QUANTUM);
        let serial = ports::open(&options.realize.hosts, "usart1")?;
        let machine = machine::build("stm32f405", DESCRIPTION, &registry, &options)?;
        let memory = machine.space("mem").cloned().ok_or(Error::Bus(0))?;
        let chip = Self { machine, memory, magnet, serial, elf: elf.to_owned(), sent: Vec::new() };
        for address in (STACK[0]..STACK[1]).step_by(4) {
            chip.write(address, FILL)?;
        }
        Ok(chip)
    }

    /// What its motor encoder sees.
    pub fn magnet(&self) -> &Magnet {
        &self.magnet
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
        Ok(self.read(TIMER_CONTROL)? & TIMER_RUNS != 0)
    }

    /// Stops the control's timer, as a fault of the chip would.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn stop_timer(&self) -> Result<(), Error> {
        self.write(TIMER_CONTROL, 0)
    }

    /// What the drive is told: the code of the torque, 2048 for none, and that it is enabled.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn drive(&self) -> Result<(u32, bool), Error> {
        Ok((self.read(DAC_DATA)?, self.read(PORT_B_OUTPUT)? & ENABLE != 0))
    }

    /// An operator presses a key.
    pub fn press(&self, key: u8) {
        self.serial.feed(&[key]);
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
        for address in (STACK[0]..STACK[1]).step_by(4) {
            if self.read(address)? != FILL {
                return Ok(STACK[1] - address);
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

/// The flash with the image's segments where they are loaded.
fn flash(elf: &Path) -> Result<Vec<u8>, Error> {
    let wrong = |why: String| Error::Image { image: elf.to_owned(), why };
    let bytes = std::fs::read(elf).map_err(|error| wrong(error.to_string()))?;
    let file = ElfFile32::<Endianness>::parse(&*bytes).map_err(|error| wrong(error.to_string()))?;
    let mut flash = vec![0xff; FLASH_BYTES];
    for segment in file.elf_program_headers() {
        let order = file.endian();
        let data = segment.data(order, &*bytes).map_err(|()| wrong("a segment is beyond its end".into()))?;
        if segment.p_type(order) != PT_LOAD || data.is_empty() {
            continue;
        }
        let begin = segment.p_paddr(order).checked_sub(FLASH).map(|begin| begin as usize);
        let place = begin.and_then(|begin| flash.get_mut(begin..)?.get_mut(..data.len()));
        place.ok_or_else(|| wrong("a segment is not in the flash".into()))?.copy_from_slice(data);
    }
    Ok(flash)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chip that runs `code` from its reset vector on.
    fn chip(code: &[u16]) -> Chip {
        let mut flash = vec![0xff; FLASH_BYTES];
        let vectors = [0x1001_0000_u32, FLASH + 9];
        for (place, word) in flash.chunks_exact_mut(4).zip(vectors) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        for (place, half) in flash[8..].chunks_exact_mut(2).zip(code) {
            place.copy_from_slice(&half.to_le_bytes());
        }
        Chip::with_flash(flash, Path::new("none")).unwrap()
    }

    #[test]
    fn it_runs_what_is_in_its_flash() {
        // push {r0, r1}; b .
        let mut chip = chip(&[0xb403, 0xe7fe]);
        assert_eq!(chip.stack().unwrap(), 0);
        chip.run(Duration::from_micros(100)).unwrap();
        assert_eq!(chip.stack().unwrap(), 8);
        assert!(!chip.controls().unwrap());
        assert_eq!(chip.drive().unwrap(), (0, false));
    }

    #[test]
    fn a_file_that_is_no_image_is_refused_by_name() {
        let error = Chip::boot(Path::new(file!())).err().unwrap().to_string();
        assert!(error.contains("chip.rs"), "{error}");
        let error = Chip::boot(Path::new("nowhere.elf")).err().unwrap().to_string();
        assert!(error.starts_with("nowhere.elf"), "{error}");
    }
}
