//! Known values of the registers at one place of a function.

use capstone::arch::arm::ArmReg;

use super::super::disassembly::{LR, PC, SP};

/// Known value of a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Value {
    Unknown,
    Constant(u32),
    /// So many bytes below the stack pointer at entry, at most.
    Below(u32),
}

/// More stack than any microcontroller of this class has: a path that gets here pushes in a loop.
pub(super) const DEPTH_MAX: u32 = 1 << 20;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct State {
    pub(super) values: [Value; 16],
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
    pub(super) fn at_entry() -> Self {
        let mut values = [Value::Unknown; 16];
        values[13] = Value::Below(0);
        Self { values }
    }

    pub(super) fn get(&self, register: Option<u32>) -> Value {
        register.and_then(number).map_or(Value::Unknown, |n| self.values[n])
    }

    pub(super) fn set(&mut self, register: u32, value: Value) {
        if let Some(n) = number(register) {
            self.values[n] = value;
        }
    }

    pub(super) fn depth(&self) -> Option<u32> {
        match self.values[13] {
            Value::Below(depth) if depth < DEPTH_MAX => Some(depth),
            _ => None,
        }
    }

    /// The stack pointer goes down by `bytes`.
    pub(super) fn push(&mut self, bytes: i32) {
        self.values[13] = offset(self.values[13], bytes.wrapping_neg());
    }

    pub(super) fn join(&mut self, other: &Self) {
        for (n, (own, others)) in self.values.iter_mut().zip(&other.values).enumerate() {
            *own = match (*own, *others) {
                (a, b) if a == b => a,
                (Value::Below(a), Value::Below(b)) if n == 13 => Value::Below(a.max(b)),
                _ => Value::Unknown,
            };
        }
    }

    /// The procedure call standard (AAPCS32) leaves these to the callee.
    pub(super) fn forget_scratch_registers(&mut self) {
        for n in [0, 1, 2, 3, 12, 14] {
            self.values[n] = Value::Unknown;
        }
    }
}

/// `value + added`.
pub(super) fn offset(value: Value, added: i32) -> Value {
    match value {
        Value::Constant(c) => Value::Constant(c.wrapping_add_signed(added)),
        // Above the stack pointer at entry is the caller's: nothing that this function may rely on.
        Value::Below(depth) => {
            u32::try_from(i64::from(depth) - i64::from(added)).map_or(Value::Unknown, Value::Below)
        }
        Value::Unknown => Value::Unknown,
    }
}
