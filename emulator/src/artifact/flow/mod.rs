//! One function's stack depth and calls, from its code.
//!
//! Every path through the function is followed with what its registers are known to hold: a constant, a
//! distance below the stack pointer at entry, or nothing. Where paths meet, the deeper stack is kept and
//! other registers that disagree are forgotten. A call or jump through a register is resolved when the
//! register holds a constant; otherwise it must be named in the budget, with a reason. A stack pointer that
//! is no longer known is refused.

mod effect;
mod state;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use self::state::{DEPTH_MAX, State, Value};
use super::disassembly::{Flow, Instruction};
use super::image::{Function, Image};
use super::{Error, symbol};

/// Targets of a call through a pointer, stated by a person: the image does not contain them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndirectCall {
    /// The function that makes the call.
    pub within: String,
    /// The functions that it can call.
    pub targets: Vec<String>,
    /// Why it needs a pointer, and why it can call no other function.
    pub reason: String,
}

/// A call, with the caller's stack at that moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// The called function, by its index.
    pub callee: usize,
    /// The caller's stack, in bytes.
    pub depth: u32,
}

/// Summary of a function's code.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Its own deepest stack, in bytes.
    pub depth: u32,
    /// Its calls, tail calls included, each callee once with the deepest stack.
    pub calls: Vec<Call>,
    /// Its first f64 instruction, written out.
    pub doubles: Option<String>,
}

/// Follows the function with this index.
pub fn summarise(image: &Image, function: usize, indirect: &[IndirectCall]) -> Result<Summary, Error> {
    let code = image.code(&image.functions()[function]);
    let mut walk = Walk {
        image,
        function: &image.functions()[function],
        indirect,
        states: BTreeMap::new(),
        waiting: Vec::new(),
        calls: BTreeMap::new(),
        depth: 0,
        starts_the_stack: image.vectors()?.first() == Some(&function),
    };
    walk.arrive(walk.function.address, &State::at_entry());
    while let Some(address) = walk.waiting.pop() {
        walk.visit(address)?;
    }
    Ok(Summary {
        depth: walk.depth,
        calls: walk.calls.iter().map(|(callee, depth)| Call { callee: *callee, depth: *depth }).collect(),
        doubles: code.iter().find(|i| i.text.contains(".f64")).map(|i| i.text.clone()),
    })
}

struct Walk<'i> {
    image: &'i Image,
    function: &'i Function,
    indirect: &'i [IndirectCall],
    states: BTreeMap<u32, State>,
    waiting: Vec<u32>,
    calls: BTreeMap<usize, u32>,
    depth: u32,
    starts_the_stack: bool,
}

impl<'i> Walk<'i> {
    fn instruction(&self, address: u32) -> Option<&'i Instruction> {
        let code = self.image.code(self.function);
        code.binary_search_by_key(&address, |i| i.address).ok().map(|k| &code[k])
    }

    /// Control comes to `address` with `state`.
    fn arrive(&mut self, address: u32, state: &State) {
        let known = self.states.get(&address);
        let mut joined = known.unwrap_or(state).clone();
        joined.join(state);
        if known != Some(&joined) {
            self.states.insert(address, joined);
            self.waiting.push(address);
        }
    }

    fn visit(&mut self, address: u32) -> Result<(), Error> {
        let (Some(instruction), Some(before)) = (self.instruction(address), self.states.get(&address)) else {
            return Ok(());
        };
        let before = before.clone();
        let after = effect::execute(self.image, self.starts_the_stack, instruction, &before);
        self.depth = self.depth.max(after.depth().ok_or_else(|| self.lost_stack(instruction))?);
        self.leave(instruction, &before, &after)?;
        if instruction.may_fall_through() {
            self.fall_through(instruction, &before, after)?;
        }
        Ok(())
    }

    fn lost_stack(&self, instruction: &Instruction) -> Error {
        let (function, text) = (self.function.name().to_owned(), instruction.text.clone());
        Error::StackPointer { function, address: instruction.address, text }
    }

    fn lost_control(&self, instruction: &Instruction) -> Error {
        let (function, text) = (self.function.name().to_owned(), instruction.text.clone());
        Error::Indirect { function, address: instruction.address, text }
    }

    fn fall_through(
        &mut self,
        instruction: &Instruction,
        before: &State,
        mut after: State,
    ) -> Result<(), Error> {
        let called = matches!(instruction.flow(), Flow::Call(_) | Flow::CallIndirect);
        if called {
            after.forget_scratch_registers();
        }
        if instruction.conditional {
            after.join(before);
        }
        let next = instruction.next();
        if self.instruction(next).is_some() {
            self.arrive(next, &after);
        } else if !called && instruction.text != "nop" {
            // Behind a call that ends a function nothing follows, or what aligns the constants there: the callee
            // does not come back.
            self.transfer(instruction, next, &after)?;
        }
        Ok(())
    }

    /// The ways out other than to the next address.
    fn leave(&mut self, instruction: &Instruction, before: &State, after: &State) -> Result<(), Error> {
        match instruction.flow() {
            Flow::Straight | Flow::Return | Flow::Trap => Ok(()),
            Flow::Branch(target) => self.transfer(instruction, target, after),
            Flow::Call(target) => self.call(instruction, target, after),
            Flow::Table(size) => self.table(instruction, size, after),
            Flow::Indirect => match self.pointer(instruction, before) {
                Value::Constant(target) => self.transfer(instruction, target & !1, after),
                _ => self.call_named(instruction, after),
            },
            Flow::CallIndirect => match before.get(instruction.register(0)) {
                Value::Constant(target) => self.call(instruction, target & !1, after),
                _ => self.call_named(instruction, after),
            },
        }
    }

    /// Target of `bx r`, `mov pc, r` and `ldr pc, [pc, #x]`.
    fn pointer(&self, instruction: &Instruction, before: &State) -> Value {
        if instruction.name == "ldr" {
            return effect::literal(self.image, instruction);
        }
        before.get(instruction.registers().last())
    }

    /// A jump stays in the function, or is a tail call.
    fn transfer(&mut self, from: &Instruction, target: u32, state: &State) -> Result<(), Error> {
        if self.instruction(target).is_some() {
            self.arrive(target, state);
            return Ok(());
        }
        self.call(from, target, state)
    }

    fn call(&mut self, from: &Instruction, target: u32, state: &State) -> Result<(), Error> {
        let callee = self.image.function_at(target);
        let callee = callee.filter(|k| self.image.functions()[*k].address == target);
        self.record(callee.ok_or_else(|| self.lost_control(from))?, state);
        Ok(())
    }

    fn record(&mut self, callee: usize, state: &State) {
        let depth = state.depth().unwrap_or(DEPTH_MAX);
        let deepest = self.calls.entry(callee).or_default();
        *deepest = depth.max(*deepest);
    }

    /// A call through a pointer that the budget explains.
    fn call_named(&mut self, from: &Instruction, state: &State) -> Result<(), Error> {
        let here = |i: &&IndirectCall| self.function.paths.iter().any(|p| symbol::matches(&i.within, p));
        let named = self.indirect.iter().find(here).ok_or_else(|| self.lost_control(from))?;
        for target in &named.targets {
            for callee in self.image.find(target)? {
                self.record(callee, state);
            }
        }
        Ok(())
    }

    fn table(&mut self, instruction: &Instruction, size: u32, state: &State) -> Result<(), Error> {
        let targets = self.image.table_targets(instruction, size);
        for target in targets.ok_or_else(|| self.lost_control(instruction))? {
            // What fills up the table to an even size points at no instruction.
            if self.instruction(target).is_some() {
                self.arrive(target, state);
            }
        }
        Ok(())
    }
}
