//! The built compensator as source text with its words: Rust for the boards here, C for any other firmware.

use std::fmt::Write as _;

use strainwave::Error;
use strainwave::compensator::words::WORDS;

use crate::design::joint::joint_params;
use crate::io::gear_file::GearFile;

/// Words in a line of source text.
const IN_LINE: usize = 8;

/// Ends the first line of a joint whose motor drives a belt.
pub const WITH_BELT: &str = "with a belt, for the cargo feature `belt`";

/// A joint's built compensator, to be written as source text.
pub struct Export {
    gear: String,
    belt: bool,
    words: [u32; WORDS],
}

impl Export {
    /// Builds the compensator of a gear file.
    ///
    /// # Errors
    /// As [`joint_params`] and [`strainwave::compensator::JointParams::build`].
    pub fn of(file: &GearFile) -> Result<Self, Error> {
        let (gear, belt) = (file.gear.name.clone(), file.belt.is_some());
        Ok(Self { gear, belt, words: joint_params(file)?.build()?.to_words() })
    }

    /// Rust source: `GEAR`, the gear's name, and `WORDS`.
    pub fn rust(&self) -> String {
        format!(
            "// {}\n\n\
             /// Name of the gear.\n\
             pub const GEAR: &str = {:?};\n\n\
             /// Its compensator, for `Compensator::from_words`.\n\
             #[rustfmt::skip]\n\
             pub static WORDS: [u32; {WORDS}] = [\n{}];\n",
            self.heading(),
            self.gear,
            self.lines(),
        )
    }

    /// C header: `STRAINWAVE_GEAR`, the gear's name, `STRAINWAVE_WORDS`, `STRAINWAVE_LAYOUT`, `STRAINWAVE_CRC32` and the array
    /// `strainwave_words`, which begins with layout, number of the words after the checksum, and checksum.
    pub fn c(&self) -> String {
        let [layout, _, checksum, ..] = self.words;
        format!(
            "/* {} */\n\
             #ifndef STRAINWAVE_JOINT_H\n#define STRAINWAVE_JOINT_H\n\n\
             #include <stdint.h>\n\n\
             #define STRAINWAVE_GEAR {}\n\
             #define STRAINWAVE_WORDS {WORDS}\n\
             #define STRAINWAVE_LAYOUT {layout:#010x}u\n\
             #define STRAINWAVE_CRC32 {checksum:#010x}u\n\n\
             static const uint32_t strainwave_words[STRAINWAVE_WORDS] = {{\n{}}};\n\n\
             #endif\n",
            self.heading().replace("*/", "* /"),
            c_string(&self.gear),
            self.lines(),
        )
    }

    /// Of what gear the words are, and how they were generated; one line.
    fn heading(&self) -> String {
        let [layout, _, checksum, ..] = self.words;
        let belt = if self.belt { format!("; {WITH_BELT}") } else { String::new() };
        format!(
            "Compensator of the gear {:?}, built by `strainwave export` {}, layout {layout:#010x}, CRC-32 {checksum:#010x}; \
             do not edit{belt}.",
            self.gear,
            env!("CARGO_PKG_VERSION"),
        )
    }

    fn lines(&self) -> String {
        let mut text = String::new();
        for words in self.words.chunks(IN_LINE) {
            let words: Vec<_> = words.iter().map(|word| format!("{word:#010x},")).collect();
            let _ = writeln!(text, "    {}", words.join(" "));
        }
        text
    }
}

/// A C string literal: all that is not plain ASCII as octal escapes of its bytes, which end after three digits.
fn c_string(text: &str) -> String {
    let plain = |byte: u8| matches!(byte, b' '..=b'~') && !matches!(byte, b'"' | b'\\' | b'?');
    let escaped = |byte: u8| if plain(byte) { char::from(byte).to_string() } else { format!("\\{byte:03o}") };
    format!("\"{}\"", text.bytes().map(escaped).collect::<String>())
}
