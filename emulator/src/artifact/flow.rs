//! One function's stack depth and calls, from its code.
//!
//! Every path through the function is followed with what its registers are known to hold: a constant, a
//! distance below the stack pointer at entry, or nothing. Where paths meet, the deeper stack is kept and
//! other registers that disagree are forgotten. A call or jump through a register is resolved when the
//! register holds a constant; otherwise it must be named in the budget, with a reason. A stack pointer that
//! is no longer known is refused.

use std::collections::BTreeMap;

use capstone::arch::arm::{ArmOperandType, ArmReg, ArmShift};
use serde::{Deserialize, Serialize};

use super::disassembly::{Flow, Instruction, LR, PC, SP};
use super::image::{Function, Image};
use super::{Error, symbol};

/// Where a call through a pointer can go; the image does not tell, so a person has to.
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

/// What a function's code does.
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

/// What a register is known to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Value {
    Unknown,
    Constant(u32),
    /// So many bytes below the stack pointer at entry, at most.
    Below(u32),
}

/// More stack than any microcontroller of this class has: a path that gets here pushes in a loop.
const DEPTH_MAX: u32 = 1 << 20;

#[derive(Clone, Debug, PartialEq, Eq)]
struct State {
    values: [Value; 16],
}

/// r0-r12, sp, lr, pc as 0-15.
fn number(register: u32) -> Option<usize> {
    match register {
        SP => Some(13),
        LR => Some(14),
        PC => Some(15),
        _ => register.checked_sub(ArmReg::ARM_REG_R0).map(|n| n as usize).filter(|n| *n < 13),
    }
}

impl State {
    fn at_entry() -> Self {
        let mut values = [Value::Unknown; 16];
        values[13] = Value::Below(0);
        Self { values }
    }

    fn get(&self, register: Option<u32>) -> Value {
        register.and_then(number).map_or(Value::Unknown, |n| self.values[n])
    }

    fn set(&mut self, register: u32, value: Value) {
        if let Some(n) = number(register) {
            self.values[n] = value;
        }
    }

    fn depth(&self) -> Option<u32> {
        match self.values[13] {
            Value::Below(depth) if depth < DEPTH_MAX => Some(depth),
            _ => None,
        }
    }

    /// The stack pointer goes down by `bytes`.
    fn push(&mut self, bytes: i32) {
        self.values[13] = offset(self.values[13], bytes.wrapping_neg());
    }

    fn join(&mut self, other: &Self) {
        for (n, (own, others)) in self.values.iter_mut().zip(&other.values).enumerate() {
            *own = match (*own, *others) {
                (a, b) if a == b => a,
                (Value::Below(a), Value::Below(b)) if n == 13 => Value::Below(a.max(b)),
                _ => Value::Unknown,
            };
        }
    }

    /// The procedure call standard (AAPCS32) leaves these to the callee.
    fn forget_scratch_registers(&mut self) {
        for n in [0, 1, 2, 3, 12, 14] {
            self.values[n] = Value::Unknown;
        }
    }
}

/// `value + added`.
fn offset(value: Value, added: i32) -> Value {
    match value {
        Value::Constant(c) => Value::Constant(c.wrapping_add_signed(added)),
        // Above the stack pointer at entry is the caller's: nothing that this function may rely on.
        Value::Below(depth) => {
            u32::try_from(i64::from(depth) - i64::from(added)).map_or(Value::Unknown, Value::Below)
        }
        Value::Unknown => Value::Unknown,
    }
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
        let after = self.execute(instruction, &before);
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

    /// What `bx r`, `mov pc, r` and `ldr pc, [pc, #x]` jump to.
    fn pointer(&self, instruction: &Instruction, before: &State) -> Value {
        if instruction.name == "ldr" {
            return self.literal(instruction);
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

    /// `tbb [pc, r]` and `tbh`: the table of half distances stands behind the instruction.
    fn table(&mut self, instruction: &Instruction, size: u32, state: &State) -> Result<(), Error> {
        let base = instruction.next();
        let entries = self.image.constants_at(base);
        if instruction.memory().map(|m| m.0) != Some(PC) || entries.is_empty() {
            return Err(self.lost_control(instruction));
        }
        for entry in entries.chunks_exact(size as usize) {
            let half = entry.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte));
            // What fills up the table to an even size points at no instruction.
            if self.instruction(base + 2 * half).is_some() {
                self.arrive(base + 2 * half, state);
            }
        }
        Ok(())
    }

    /// The constant that `ldr r, [pc, #x]` loads.
    fn literal(&self, instruction: &Instruction) -> Value {
        match instruction.memory() {
            Some((PC, None, displacement)) => {
                let base = (instruction.address + 4) & !3;
                let word = self.image.constant(base.wrapping_add_signed(displacement));
                word.map_or(Value::Unknown, Value::Constant)
            }
            _ => Value::Unknown,
        }
    }

    /// The registers behind `instruction`.
    fn execute(&self, instruction: &Instruction, before: &State) -> State {
        let mut after = before.clone();
        forget_written(instruction, &mut after);
        let destination = instruction.register(0).unwrap_or(0);
        match instruction.name.as_str() {
            "push" | "vpush" => after.push(register_bytes(instruction)),
            "pop" | "vpop" => after.push(-register_bytes(instruction)),
            "add" => after.set(destination, sum(instruction, before, 1)),
            "sub" => after.set(destination, sum(instruction, before, -1)),
            "mov" => after.set(destination, moved(instruction, before)),
            "movt" => after.set(destination, high_half(instruction, before)),
            "bfc" => after.set(destination, aligned(instruction, before)),
            "ldr" => after.set(destination, self.literal(instruction)),
            "msr" if instruction.text.contains("sp,") => {
                after.values[13] = if self.starts_the_stack { Value::Below(0) } else { Value::Unknown };
            }
            _ => {}
        }
        if instruction.writeback && instruction.memory().is_some_and(|m| m.0 == SP) {
            after.values[13] = before.values[13];
            after.push(-indexed_by(instruction));
        }
        after
    }
}

/// Every register that the instruction may write is unknown; the stack pointer is left to `execute`, for
/// the instructions that write it without naming it as an operand.
fn forget_written(instruction: &Instruction, after: &mut State) {
    for operand in &instruction.operands {
        let register = match operand.op_type {
            ArmOperandType::Reg(register) => u32::from(register.0),
            _ => continue,
        };
        if operand.access.is_none_or(capstone::AccessType::is_writable) {
            after.set(register, Value::Unknown);
        }
    }
    if let Some((base, ..)) = instruction.memory().filter(|_| instruction.writeback) {
        after.set(base, Value::Unknown);
    }
}

/// What a register list takes in memory, in bytes.
fn register_bytes(instruction: &Instruction) -> i32 {
    let double = ArmReg::ARM_REG_D0..=ArmReg::ARM_REG_D31;
    instruction.registers().map(|r| if double.contains(&r) { 8 } else { 4 }).sum()
}

/// How far `[sp, #x]!` or `[sp], #x` moves the stack pointer, in bytes.
fn indexed_by(instruction: &Instruction) -> i32 {
    let after = instruction.operands.len().checked_sub(1).and_then(|last| instruction.immediate(last));
    after.unwrap_or_else(|| instruction.memory().map_or(0, |m| m.2))
}

/// `add d, n, m` with sign 1, `sub d, n, m` with sign -1, and the forms without `n`.
fn sum(instruction: &Instruction, before: &State, sign: i32) -> Value {
    let last = instruction.operands.len().saturating_sub(1);
    let first = before.get(instruction.register(last.saturating_sub(1)));
    let second = match instruction.immediate(last) {
        Some(value) => Value::Constant(value.cast_unsigned()),
        None => before.get(instruction.register(last)),
    };
    let shifted = instruction.operands.iter().any(|o| o.shift != ArmShift::Invalid);
    match (first, second) {
        (_, Value::Constant(c)) if !shifted => offset(first, c.cast_signed().wrapping_mul(sign)),
        (Value::Constant(c), _) if !shifted && sign > 0 => offset(second, c.cast_signed()),
        _ => Value::Unknown,
    }
}

fn moved(instruction: &Instruction, before: &State) -> Value {
    match instruction.immediate(1) {
        Some(value) => Value::Constant(value.cast_unsigned()),
        None => before.get(instruction.register(1)),
    }
}

fn high_half(instruction: &Instruction, before: &State) -> Value {
    match (before.get(instruction.register(0)), instruction.immediate(1)) {
        (Value::Constant(low), Some(high)) => Value::Constant(low & 0xffff | high.cast_unsigned() << 16),
        _ => Value::Unknown,
    }
}

/// `bfc r, #0, #n` aligns an address down to 2^n bytes.
fn aligned(instruction: &Instruction, before: &State) -> Value {
    match (before.get(instruction.register(0)), instruction.immediate(1), instruction.immediate(2)) {
        (Value::Below(depth), Some(0), Some(bits @ 0..16)) => Value::Below(depth + (1 << bits) - 1),
        _ => Value::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Summaries of functions that follow one another: (path, code).
    fn summaries(functions: &[(&str, &[u8])], indirect: &[IndirectCall]) -> Result<Vec<Summary>, Error> {
        let mut code = Vec::new();
        let mut placed = Vec::new();
        for (path, bytes) in functions {
            placed.push((*path, code.len() as u32, bytes.len() as u32));
            code.extend_from_slice(bytes);
        }
        let image = Image::of_code(&code, &placed, &[])?;
        (0..functions.len()).map(|k| summarise(&image, k, indirect)).collect()
    }

    fn depth(code: &[u8]) -> u32 {
        summaries(&[("f", code)], &[]).unwrap()[0].depth
    }

    const BX_LR: [u8; 2] = [0x70, 0x47];
    const RESET: (&str, &[u8]) = ("reset", &[0xfe, 0xe7]);

    #[test]
    fn every_way_to_take_stack_is_counted() {
        assert_eq!(depth(&BX_LR), 0);
        assert_eq!(depth(&[0xf0, 0xb5, 0xf0, 0xbd]), 20); // push {r4-r7, lr}; pop {r4-r7, pc}
        assert_eq!(depth(&[0x2d, 0xed, 0x08, 0x8b, 0xbd, 0xec, 0x08, 0x8b, 0x70, 0x47]), 32); // vpush {d8-d11}
        assert_eq!(depth(&[0x2d, 0xed, 0x02, 0x8a, 0xbd, 0xec, 0x02, 0x8a, 0x70, 0x47]), 8); // vpush {s16, s17}
        assert_eq!(depth(&[0x4d, 0xf8, 0x08, 0xed, 0x5d, 0xf8, 0x08, 0xfb]), 8); // str lr, [sp, #-8]!
        assert_eq!(depth(&[0x6d, 0xe9, 0x04, 0x01, 0x70, 0x47]), 16); // strd r0, r1, [sp, #-16]!
        assert_eq!(depth(&[0xad, 0xf5, 0x80, 0x6d, 0x70, 0x47]), 1024); // sub.w sp, sp, #1024
        assert_eq!(depth(&[0x84, 0xb0, 0x84, 0xb0, 0x70, 0x47]), 32); // sub sp, #16, twice
    }

    #[test]
    fn a_frame_too_large_for_an_immediate_is_still_a_constant() {
        // movw r12, #0x1388; sub.w sp, sp, r12; bx lr
        assert_eq!(depth(&[0x41, 0xf2, 0x88, 0x3c, 0xad, 0xeb, 0x0c, 0x0d, 0x70, 0x47]), 0x1388);
    }

    #[test]
    fn an_aligned_frame_counts_what_the_alignment_can_take() {
        // mov r4, sp; bfc r4, #0, #3; mov sp, r4; bx lr
        assert_eq!(depth(&[0x6c, 0x46, 0x6f, 0xf3, 0x02, 0x04, 0xa5, 0x46, 0x70, 0x47]), 7);
    }

    #[test]
    fn a_frame_of_unknown_size_is_refused_by_name() {
        let error = summaries(&[("a::f", &[0xad, 0xeb, 0x00, 0x0d, 0x70, 0x47])], &[]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a::f at 0x0: `sub.w sp, sp, r0` moves the stack pointer by an unknown amount, allowed: a constant"
        );
        // push {r4}; b .-2
        let error = summaries(&[("a::f", &[0x10, 0xb4, 0xfd, 0xe7])], &[]).unwrap_err();
        assert!(error.to_string().starts_with("a::f at 0x0: `push {r4}`"), "{error}");
    }

    #[test]
    fn the_deeper_of_two_paths_counts() {
        // cbz r0, 1f; push {r4-r7, lr}; pop {r4-r7, pc}; 1: push {r4, lr}; pop {r4, pc}
        let code = [0x08, 0xb1, 0xf0, 0xb5, 0xf0, 0xbd, 0x10, 0xb5, 0x10, 0xbd];
        assert_eq!(depth(&code), 20);
    }

    #[test]
    fn calls_have_the_depth_at_the_call() {
        // f: push {r4, lr}; bl g; pop.w {r4, lr}; b.w g. g: bx lr
        let f = [0x10, 0xb5, 0x00, 0xf0, 0x04, 0xf8, 0xbd, 0xe8, 0x10, 0x40, 0x00, 0xf0, 0x00, 0xb8];
        let found = summaries(&[("f", &f), ("g", &BX_LR)], &[]).unwrap();
        assert_eq!(found[0].calls, [Call { callee: 1, depth: 8 }]);
        // f: b.w g
        let found = summaries(&[("f", &f[10..]), ("g", &BX_LR)], &[]).unwrap();
        assert_eq!(found[0].calls, [Call { callee: 1, depth: 0 }]);
    }

    #[test]
    fn behind_a_call_that_does_not_come_back_a_function_may_be_padded() {
        // f: bl g; nop. g: b .
        let found = summaries(&[("f", &[0x00, 0xf0, 0x01, 0xf8, 0x00, 0xbf]), RESET], &[]).unwrap();
        assert_eq!(found[0].calls, [Call { callee: 1, depth: 0 }]);
    }

    #[test]
    fn a_call_through_a_constant_is_resolved() {
        // f: movw r3, #11; blx r3; bx lr (padded). g at 10: bx lr
        let f = [0x40, 0xf2, 0x0b, 0x03, 0x98, 0x47, 0x70, 0x47, 0x00, 0xbf];
        let found = summaries(&[("f", &f), ("g", &BX_LR)], &[]).unwrap();
        assert_eq!(found[0].calls, [Call { callee: 1, depth: 0 }]);
    }

    #[test]
    fn a_call_through_a_pointer_is_refused_unless_it_is_explained() {
        let functions = [RESET, ("a::f", &[0x98, 0x47, 0x70, 0x47]), ("a::g", &BX_LR[..])];
        let error = summaries(&functions, &[]).unwrap_err().to_string();
        assert!(error.starts_with("a::f at 0x2: `blx r3` goes where the image does not tell"), "{error}");
        let explained =
            IndirectCall { within: "a::f".into(), targets: vec!["a::g".into()], reason: "a table".into() };
        let found = summaries(&functions, &[explained]).unwrap();
        assert_eq!(found[1].calls, [Call { callee: 2, depth: 0 }]);
    }

    #[test]
    fn a_branch_table_is_followed() {
        // tbb [pc, r0]; 1, 2; bx lr; push {r4, lr}; pop {r4, pc}
        let code = [0xdf, 0xe8, 0x00, 0xf0, 0x01, 0x02, 0x70, 0x47, 0x10, 0xb5, 0x10, 0xbd];
        let image = Image::of_code(&code, &[("f", 0, 12)], &[(4, 6)]).unwrap();
        assert_eq!(summarise(&image, 0, &[]).unwrap().depth, 8);
    }

    #[test]
    fn only_the_reset_handler_may_set_the_stack_pointer() {
        let set = [0x80, 0xf3, 0x08, 0x88, 0x10, 0xb5, 0xfe, 0xe7]; // msr msp, r0; push {r4, lr}; b .
        assert_eq!(depth(&set), 8);
        assert!(matches!(summaries(&[RESET, ("f", &set)], &[]), Err(Error::StackPointer { .. })));
    }
}
