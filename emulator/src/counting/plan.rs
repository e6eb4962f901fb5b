//! Input of the plugin: every instruction with its cost, the tracked functions, the handlers.

use std::fmt::Write as _;

use super::cycle_table::{REFILL, cycles};
use crate::artifact::disassembly::{Flow, Instruction};
use crate::artifact::{Error, Image};

/// The plan for `image`, without cycles where the model is not of its core, in the format that the plugin reads; `tracked` are functions by their index.
pub fn plan(image: &Image, tracked: &[usize]) -> Result<String, Error> {
    let mut text = format!("refill {REFILL}\n");
    for function in tracked.iter().map(|k| &image.functions()[*k]) {
        line(&mut text, format_args!("tracked {:x} {}", function.address, function.size));
    }
    for (position, handler) in image.vectors()?.into_iter().enumerate() {
        let kind = if position == 0 { "reset" } else { "handler" };
        line(&mut text, format_args!("{kind} {:x}", image.functions()[handler].address));
    }
    let code = image.instructions();
    for (k, instruction) in code.iter().enumerate() {
        let before = k.checked_sub(1).map(|b| &code[b]).filter(|b| b.next() == instruction.address);
        let cost = if image.has_cycle_model() { cycles(instruction, before) } else { Some(0) };
        let cost = cost.map_or_else(|| "?".to_owned(), |c| c.to_string());
        let (address, size, flow) = (instruction.address, instruction.size, flow(instruction));
        line(&mut text, format_args!("insn {address:x} {size} {cost} {flow}"));
    }
    Ok(text)
}

fn line(text: &mut String, arguments: std::fmt::Arguments) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{arguments}");
}

/// The plugin's letter for how control leaves; a capital when it may also go on.
fn flow(instruction: &Instruction) -> char {
    let (letter, falls_through) = match instruction.flow() {
        Flow::Straight | Flow::Trap => return '-',
        Flow::Call(_) | Flow::CallIndirect => ('c', instruction.conditional),
        Flow::Return => ('r', instruction.conditional),
        Flow::Branch(_) | Flow::Table(_) | Flow::Indirect => ('b', instruction.may_fall_through()),
    };
    if falls_through { letter.to_ascii_uppercase() } else { letter }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_is_in_the_plan() {
        // reset at 0: bl 6; b 0. f at 6: cbz r0, c; vmul s3, s0, s0; c: it ne; bxne lr; dmb; bx lr
        let code = [
            0x00, 0xf0, 0x01, 0xf8, 0xfc, 0xe7, 0x08, 0xb1, 0x60, 0xee, 0x00, 0x1a, 0x18, 0xbf, 0x70, 0x47,
            0xbf, 0xf3, 0x5f, 0x8f, 0x70, 0x47,
        ];
        let image = Image::of_code(&code, &[("reset", 0, 6), ("f", 6, 16)], &[]).unwrap();
        let expected = "refill 3\ntracked 6 16\nreset 0\ninsn 0 4 4 c\ninsn 4 2 4 b\ninsn 6 2 1 B\n\
            insn 8 4 1 -\ninsn c 2 1 -\ninsn e 2 1 R\ninsn 10 4 ? -\ninsn 14 2 4 r\n";
        assert_eq!(plan(&image, &[1]).unwrap(), expected);
    }
}
