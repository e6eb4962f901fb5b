//! A linked firmware image: its sections, functions, decoded code and exception vectors.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use object::elf::{PT_LOAD, SHF_ALLOC, SHF_EXECINSTR, SHT_NOBITS};
use object::read::elf::{ElfFile32, ProgramHeader, SectionHeader};
use object::{Architecture, Endianness, Object, ObjectSection, ObjectSymbol, SymbolKind};

use super::Error;
use super::disassembly::{Instruction, PC, disassemble};
use super::symbol;
use crate::counting::cycle_table;

/// A function, by its first instruction.
#[derive(Clone, Debug)]
pub struct Function {
    /// The paths of every symbol that names it, without hashes and type arguments.
    pub paths: Vec<String>,
    /// Its first instruction.
    pub address: u32,
    /// Its size in bytes, with the constants behind its code.
    pub size: u32,
}

impl Function {
    /// Its first name.
    pub fn name(&self) -> &str {
        self.paths.first().map_or("?", String::as_str)
    }

    fn holds(&self, address: u32) -> bool {
        address.wrapping_sub(self.address) < self.size
    }
}

/// A section that takes room in the microcontroller.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its name.
    pub name: String,
    /// Address at run time.
    pub address: u32,
    /// Its size in bytes.
    pub size: u32,
    /// Load address of its content; `None` when it has none.
    pub load: Option<u32>,
    data: Vec<u8>,
    code: bool,
    writable: bool,
}

/// A linked firmware image.
#[derive(Clone, Debug)]
pub struct Image {
    path: PathBuf,
    sections: Vec<Section>,
    functions: Vec<Function>,
    symbols: Vec<String>,
    instructions: Vec<Instruction>,
    data: Vec<Range<u32>>,
    compiler: Option<String>,
    core: Option<String>,
    machine: Option<String>,
}

impl Image {
    /// Reads and decodes the image at `path`.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::NotAnImage`] or [`Error::NotDecoded`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = std::fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        let wrong = |what: &str| Error::NotAnImage { path: path.to_owned(), what: what.to_owned() };
        let file = ElfFile32::<Endianness>::parse(&*bytes).map_err(|error| wrong(&error.to_string()))?;
        if file.architecture() != Architecture::Arm {
            return Err(wrong("not for ARM"));
        }
        let sections = sections(&file).map_err(|error| wrong(&error.to_string()))?;
        let ranges = Ranges::of(&file, &sections);
        if ranges.code.is_empty() {
            return Err(wrong("no $t symbols that mark its code"));
        }
        let functions = functions(&file, &sections);
        let mut image = Self {
            path: path.to_owned(),
            symbols: file.symbols().filter_map(|s| s.name().ok()).map(symbol::path).collect(),
            compiler: compiler(&file),
            core: named(&file, "strainwave_core_"),
            machine: named(&file, "strainwave_machine_"),
            instructions: Vec::new(),
            data: ranges.data,
            sections,
            functions,
        };
        image.instructions = image.decode(&ranges.code)?;
        Ok(image)
    }

    /// An image of code that stands at address 0, for tests: functions as (path, address, size),
    /// constants as (start, end).
    #[cfg(test)]
    pub fn of_code(code: &[u8], functions: &[(&str, u32, u32)], data: &[(u32, u32)]) -> Result<Self, Error> {
        let size = code.len() as u32;
        let text = Section {
            name: ".text".into(),
            address: 0,
            size,
            load: Some(0),
            data: code.to_vec(),
            code: true,
            writable: false,
        };
        let reset = (functions[0].1 | 1).to_le_bytes();
        let table = Section {
            name: ".vector_table".into(),
            address: 0x1000,
            size: 8,
            load: Some(0x1000),
            data: [[0; 4], reset].concat(),
            code: false,
            writable: false,
        };
        let named = |(path, address, size): &(&str, u32, u32)| Function {
            paths: vec![(*path).into()],
            address: *address,
            size: *size,
        };
        let mut image = Self {
            path: "test".into(),
            sections: vec![text, table],
            functions: functions.iter().map(named).collect(),
            symbols: Vec::new(),
            instructions: Vec::new(),
            data: data.iter().map(|(start, end)| *start..*end).collect(),
            compiler: None,
            core: Some(cycle_table::CORE.to_owned()),
            machine: None,
        };
        let starts = std::iter::once(0).chain(data.iter().map(|d| d.1));
        let ends = data.iter().map(|d| d.0).chain([size]);
        image.instructions = image.decode(&starts.zip(ends).map(|(a, b)| a..b).collect::<Vec<_>>())?;
        Ok(image)
    }

    /// The file it was read from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The compiler that the image says it was built with.
    pub fn compiler(&self) -> &str {
        self.compiler.as_deref().unwrap_or("unknown")
    }

    /// The core that the image says it is for.
    pub fn core(&self) -> &str {
        self.core.as_deref().unwrap_or("unknown")
    }

    /// The emulator's machine that the image says it is for.
    pub fn machine(&self) -> Option<&str> {
        self.machine.as_deref()
    }

    /// The model of cycles is of its core.
    pub fn has_cycle_model(&self) -> bool {
        self.core() == cycle_table::CORE
    }

    /// The sections that take room in the microcontroller.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Every function, by address.
    pub fn functions(&self) -> &[Function] {
        &self.functions
    }

    /// The path of every symbol.
    pub fn symbols(&self) -> &[String] {
        &self.symbols
    }

    /// Every instruction, by address.
    pub fn instructions(&self) -> &[Instruction] {
        &self.instructions
    }

    /// The code of a function.
    pub fn code(&self, function: &Function) -> &[Instruction] {
        let place = |address| self.instructions.partition_point(|i| i.address < address);
        &self.instructions[place(function.address)..place(function.address + function.size)]
    }

    /// The function that an address belongs to, by its index.
    pub fn function_at(&self, address: u32) -> Option<usize> {
        let after = self.functions.partition_point(|f| f.address <= address);
        (0..after).rev().find(|index| self.functions[*index].holds(address))
    }

    /// The functions that `pattern` names, by their index.
    ///
    /// # Errors
    /// [`Error::NoFunction`].
    pub fn find(&self, pattern: &str) -> Result<Vec<usize>, Error> {
        let named = |f: &Function| f.paths.iter().any(|path| symbol::matches(pattern, path));
        let found: Vec<usize> = (0..self.functions.len()).filter(|k| named(&self.functions[*k])).collect();
        if found.is_empty() {
            return Err(Error::NoFunction { pattern: pattern.to_owned(), nearest: self.nearest(pattern) });
        }
        Ok(found)
    }

    /// Targets of `tbb [pc, r]` and `tbh [pc, r, lsl #1]`, whose table of half distances, `size` bytes each, is
    /// behind the instruction; `None` where there is no such table.
    pub fn table_targets(&self, instruction: &Instruction, size: u32) -> Option<Vec<u32>> {
        let base = instruction.next();
        let entries = self.constants_at(base);
        if instruction.memory().map(|m| m.0) != Some(PC) || entries.is_empty() {
            return None;
        }
        let target =
            |entry: &[u8]| base + 2 * entry.iter().rev().fold(0, |v, byte| v << 8 | u32::from(*byte));
        Some(entries.chunks_exact(size as usize).map(target).collect())
    }

    fn nearest(&self, pattern: &str) -> String {
        let expected: Vec<&str> = pattern.rsplit("::").collect();
        let alike = |path: &&String| path.rsplit("::").zip(&expected).take_while(|(a, b)| a == *b).count();
        let paths = self.functions.iter().flat_map(|f| &f.paths);
        paths.max_by_key(alike).filter(|path| alike(path) > 0).map_or_else(|| "none".to_owned(), Clone::clone)
    }

    /// The constants that stand between the code from `address` on.
    pub fn constants_at(&self, address: u32) -> &[u8] {
        let end = self.data.iter().find(|range| range.contains(&address)).map_or(address, |range| range.end);
        self.bytes(address, end - address).unwrap_or(&[])
    }

    /// A word that cannot change at run time.
    pub fn constant(&self, address: u32) -> Option<u32> {
        let writable = |s: &&Section| s.writable && s.load.is_none_or(|load| load != s.address);
        if self.sections.iter().filter(writable).any(|s| address.wrapping_sub(s.address) < s.size) {
            return None;
        }
        self.bytes(address, 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes)
    }

    fn bytes(&self, address: u32, size: u32) -> Option<&[u8]> {
        self.sections.iter().find_map(|section| {
            let start = address.checked_sub(section.address)? as usize;
            section.data.get(start..start + size as usize)
        })
    }

    /// The functions in the vector table, by their index: the reset handler, then every other handler once.
    ///
    /// # Errors
    /// [`Error::Vector`], or [`Error::NotAnImage`] without a vector table.
    pub fn vectors(&self) -> Result<Vec<usize>, Error> {
        let table = self.sections.iter().find(|s| s.name == ".vector_table");
        let words = table.map_or(&[][..], |s| &s.data).chunks_exact(4);
        let mut handlers = Vec::new();
        for (number, word) in words.enumerate().skip(1) {
            let address = u32::from_le_bytes(word.try_into().unwrap_or_default());
            if address == 0 {
                continue;
            }
            let start = address & !1;
            let function = self.functions.binary_search_by_key(&start, |f| f.address);
            let function = function.map_err(|_| Error::Vector { number, address })?;
            if !handlers.contains(&function) {
                handlers.push(function);
            }
        }
        if handlers.is_empty() {
            let what = "no section .vector_table".to_owned();
            return Err(Error::NotAnImage { path: self.path.clone(), what });
        }
        Ok(handlers)
    }

    fn decode(&self, code: &[Range<u32>]) -> Result<Vec<Instruction>, Error> {
        let mut instructions = BTreeMap::new();
        for function in &self.functions {
            for range in code {
                let start = range.start.max(function.address);
                let end = range.end.min(function.address + function.size);
                if let Some(bytes) = end.checked_sub(start).and_then(|size| self.bytes(start, size)) {
                    instructions.extend(disassemble(bytes, start)?.into_iter().map(|i| (i.address, i)));
                }
            }
        }
        Ok(instructions.into_values().collect())
    }
}

fn sections(file: &ElfFile32<Endianness>) -> object::Result<Vec<Section>> {
    let endian = file.endian();
    let mut sections = Vec::new();
    for section in file.sections() {
        let header = section.elf_section_header();
        let flags = header.sh_flags(endian);
        if flags & SHF_ALLOC == 0 || header.sh_size(endian) == 0 {
            continue;
        }
        let empty = header.sh_type(endian) == SHT_NOBITS;
        sections.push(Section {
            name: section.name()?.to_owned(),
            address: header.sh_addr(endian),
            size: header.sh_size(endian),
            load: if empty { None } else { Some(load_address(file, header.sh_addr(endian))) },
            data: if empty { Vec::new() } else { section.data()?.to_vec() },
            code: flags & SHF_EXECINSTR != 0,
            writable: flags & object::elf::SHF_WRITE != 0,
        });
    }
    Ok(sections)
}

/// Address that the start-up code copies a section from: the physical address of its segment.
fn load_address(file: &ElfFile32<Endianness>, address: u32) -> u32 {
    let endian = file.endian();
    let holds = |p: &&object::elf::ProgramHeader32<Endianness>| {
        p.p_type(endian) == PT_LOAD && address.wrapping_sub(p.p_vaddr(endian)) < p.p_memsz(endian)
    };
    let segment = file.elf_program_headers().iter().find(holds);
    segment.map_or(address, |p| p.p_paddr(endian).wrapping_add(address - p.p_vaddr(endian)))
}

/// The mapping symbols of the ARM ELF specification: `$t` begins Thumb code, `$d` constants.
struct Ranges {
    code: Vec<Range<u32>>,
    data: Vec<Range<u32>>,
}

impl Ranges {
    fn of(file: &ElfFile32<Endianness>, sections: &[Section]) -> Self {
        let mut ranges = Self { code: Vec::new(), data: Vec::new() };
        for section in sections.iter().filter(|s| s.code) {
            let end = section.address + section.size;
            let mut marks = marks(file, section.address..end);
            marks.push((end, false));
            for pair in marks.windows(2) {
                let list = if pair[0].1 { &mut ranges.code } else { &mut ranges.data };
                list.push(pair[0].0..pair[1].0);
            }
        }
        ranges
    }
}

/// Address and "is code" of the mapping symbols, in order.
fn marks(file: &ElfFile32<Endianness>, within: Range<u32>) -> Vec<(u32, bool)> {
    let is = |name: &str, mark: &str| name == mark || name.starts_with(&format!("{mark}."));
    let mark = |name: &str| if is(name, "$t") { Some(true) } else { is(name, "$d").then_some(false) };
    let mut marks: Vec<(u32, bool)> = file
        .symbols()
        .filter_map(|s| Some((s.address() as u32, mark(s.name().ok()?)?)))
        .filter(|(address, _)| within.contains(address))
        .collect();
    marks.sort_unstable();
    marks.dedup();
    marks
}

fn functions(file: &ElfFile32<Endianness>, sections: &[Section]) -> Vec<Function> {
    let mut found: BTreeMap<u32, Function> = BTreeMap::new();
    for symbol in file.symbols().filter(|s| s.kind() == SymbolKind::Text && s.is_definition()) {
        let Ok(name) = symbol.name() else { continue };
        if name.is_empty() || name.starts_with('$') {
            continue;
        }
        let address = symbol.address() as u32 & !1;
        let function = Function { paths: Vec::new(), address, size: 0 };
        let function = found.entry(address).or_insert(function);
        function.size = function.size.max(symbol.size() as u32);
        function.paths.push(symbol::path(name));
    }
    let mut functions: Vec<Function> = found.into_values().collect();
    let starts: Vec<u32> = functions.iter().map(|f| f.address).skip(1).chain([u32::MAX]).collect();
    for (function, next) in functions.iter_mut().zip(starts).filter(|(f, _)| f.size == 0) {
        let section = sections.iter().find(|s| function.address.wrapping_sub(s.address) < s.size);
        // Assembly without `.size`: up to what comes next.
        function.size = section.map_or(0, |s| (s.address + s.size).min(next) - function.address);
    }
    functions
}

/// The name that a symbol begins with `prefix` to tell; it has `_` for `-`.
fn named(file: &ElfFile32<Endianness>, prefix: &str) -> Option<String> {
    let names = file.symbols().filter_map(|symbol| symbol.name().ok());
    names.filter_map(|name| name.strip_prefix(prefix)).next().map(|name| name.replace('_', "-"))
}

/// The linker keeps the compilers' version strings in `.comment`.
fn compiler(file: &ElfFile32<Endianness>) -> Option<String> {
    let comment = file.section_by_name(".comment")?.data().ok()?;
    let text = String::from_utf8_lossy(comment);
    let version = text.split('\0').find_map(|line| line.strip_prefix("rustc version "))?;
    Some(format!("rustc {version}"))
}
