//! Effect of one instruction on the registers.

use capstone::arch::arm::{ArmOperandType, ArmReg, ArmShift};

use super::super::disassembly::{Instruction, PC, SP};
use super::super::image::Image;
use super::state::{State, Value, offset};

/// The registers behind `instruction`; only the function that starts the stack may set its pointer.
pub(super) fn execute(
    image: &Image,
    starts_the_stack: bool,
    instruction: &Instruction,
    before: &State,
) -> State {
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
        "ldr" => after.set(destination, literal(image, instruction)),
        "msr" if instruction.text.contains("sp,") => {
            after.values[13] = if starts_the_stack { Value::Below(0) } else { Value::Unknown };
        }
        _ => {}
    }
    if instruction.writeback && instruction.memory().is_some_and(|m| m.0 == SP) {
        after.values[13] = before.values[13];
        after.push(-indexed_by(instruction));
    }
    after
}

/// The constant that `ldr r, [pc, #x]` loads.
pub(super) fn literal(image: &Image, instruction: &Instruction) -> Value {
    match instruction.memory() {
        Some((PC, None, displacement)) => {
            let base = (instruction.address + 4) & !3;
            let word = image.constant(base.wrapping_add_signed(displacement));
            word.map_or(Value::Unknown, Value::Constant)
        }
        _ => Value::Unknown,
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

/// Size of a register list in memory, in bytes.
fn register_bytes(instruction: &Instruction) -> i32 {
    let double = ArmReg::ARM_REG_D0..=ArmReg::ARM_REG_D31;
    instruction.registers().map(|r| if double.contains(&r) { 8 } else { 4 }).sum()
}

/// Change of the stack pointer by `[sp, #x]!` or `[sp], #x`, in bytes.
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
