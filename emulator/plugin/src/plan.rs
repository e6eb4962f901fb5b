//! Plan of the counting: the instructions of the image with their cost, and the symbols to report.
//!
//! One line each, fields separated by one space, addresses in hexadecimal:
//!
//! | line | meaning |
//! | --- | --- |
//! | `refill P` | cycles that a taken branch adds, for branches whose direction is known at run time only |
//! | `tracked START SIZE` | a function to report, in the order of the results |
//! | `handler START` | the first instruction of an exception handler |
//! | `reset START` | the first instruction after a reset |
//! | `insn ADDRESS SIZE CYCLES FLOW` | `CYCLES` is `?` when the cost is not known |
//!
//! `FLOW` is `-` straight on, `b` a branch, `c` a call, `r` a return; the capital letter when the
//! instruction is conditional.

use std::collections::HashMap;

/// Control flow out of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// On to the next address.
    Straight,
    /// To another place of the same activation.
    Branch,
    /// Into a function that comes back behind this instruction.
    Call,
    /// Back to the caller, or out of an exception.
    Return,
}

/// One instruction of the image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// Its address.
    pub address: u32,
    /// The address behind it.
    pub next: u32,
    /// Its cost; for a conditional branch the cost when not taken.
    pub cycles: Option<u32>,
    /// Control flow out of it.
    pub flow: Flow,
    /// Whether control may also go on to `next`.
    pub conditional: bool,
    /// It is the first of an exception handler.
    pub handler: bool,
    /// It is the first after a reset.
    pub reset: bool,
    /// The tracked function that starts here.
    pub entry: Option<usize>,
}

/// A function to report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracked {
    /// Its first instruction.
    pub start: u32,
    /// Its size in bytes.
    pub size: u32,
}

/// Input of the plugin.
#[derive(Debug, Default)]
pub struct Plan {
    /// Cycles that a taken conditional branch adds.
    pub refill: u32,
    /// The functions to report.
    pub tracked: Vec<Tracked>,
    /// Every instruction of the image.
    pub instructions: HashMap<u32, Instruction>,
}

impl Plan {
    /// Reads a plan; the error names the line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut plan = Self::default();
        let mut marks = Vec::new();
        for (number, line) in text.lines().enumerate() {
            plan.line(line, &mut marks).ok_or_else(|| format!("plan line {}: \"{line}\"", number + 1))?;
        }
        for (address, reset) in marks {
            plan.mark(address, reset).ok_or_else(|| format!("plan: no instruction at {address:#x}"))?;
        }
        for (index, tracked) in plan.tracked.iter().enumerate() {
            let first = plan.instructions.get_mut(&tracked.start);
            first.ok_or_else(|| format!("plan: no instruction at {:#x}", tracked.start))?.entry = Some(index);
        }
        Ok(plan)
    }

    fn line(&mut self, line: &str, marks: &mut Vec<(u32, bool)>) -> Option<()> {
        let fields: Vec<&str> = line.split(' ').collect();
        match fields[..] {
            ["refill", cycles] => self.refill = cycles.parse().ok()?,
            ["tracked", start, size] => {
                self.tracked.push(Tracked { start: hex(start)?, size: size.parse().ok()? });
            }
            ["handler", address] => marks.push((hex(address)?, false)),
            ["reset", address] => marks.push((hex(address)?, true)),
            ["insn", address, size, cycles, flow] => {
                let instruction = instruction(hex(address)?, size.parse().ok()?, cycles, flow)?;
                self.instructions.insert(instruction.address, instruction);
            }
            _ => return None,
        }
        Some(())
    }

    fn mark(&mut self, address: u32, reset: bool) -> Option<()> {
        let instruction = self.instructions.get_mut(&address)?;
        instruction.reset |= reset;
        instruction.handler |= !reset;
        Some(())
    }
}

fn hex(field: &str) -> Option<u32> {
    u32::from_str_radix(field, 16).ok()
}

fn instruction(address: u32, size: u32, cycles: &str, flow: &str) -> Option<Instruction> {
    let cycles = if cycles == "?" { None } else { Some(cycles.parse().ok()?) };
    let (flow, conditional) = match flow {
        "-" => (Flow::Straight, false),
        "b" => (Flow::Branch, false),
        "B" => (Flow::Branch, true),
        "c" => (Flow::Call, false),
        "C" => (Flow::Call, true),
        "r" => (Flow::Return, false),
        "R" => (Flow::Return, true),
        _ => return None,
    };
    let next = address.checked_add(size)?;
    Some(Instruction { address, next, cycles, flow, conditional, handler: false, reset: false, entry: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_every_kind_of_line() {
        let text =
            "refill 3\ntracked 10 4\nhandler 20\nreset 12\ninsn 10 2 1 -\ninsn 12 2 ? R\ninsn 20 4 14 b";
        let plan = Plan::parse(text).unwrap();
        assert_eq!((plan.refill, plan.tracked[0]), (3, Tracked { start: 0x10, size: 4 }));
        assert_eq!(plan.instructions[&0x10].entry, Some(0));
        let last = &plan.instructions[&0x12];
        assert_eq!((last.cycles, last.flow, last.conditional, last.reset), (None, Flow::Return, true, true));
        let handler = &plan.instructions[&0x20];
        assert_eq!((handler.next, handler.cycles, handler.handler), (0x24, Some(14), true));
    }

    #[test]
    fn names_what_it_cannot_read() {
        assert_eq!(
            Plan::parse("insn 10 2 1 -\ninsn 12 2 1 x").unwrap_err(),
            "plan line 2: \"insn 12 2 1 x\""
        );
        assert_eq!(Plan::parse("tracked 10 4").unwrap_err(), "plan: no instruction at 0x10");
    }
}
