//! Thumb-2 machine code of a Cortex-M with FPv4-SP, decoded by capstone into what the analyses ask for.

use capstone::arch::arm::{ArchExtraMode, ArchMode, ArmCC, ArmOperand, ArmOperandType, ArmReg};
use capstone::prelude::*;

use super::Error;

/// One decoded instruction.
#[derive(Clone, Debug)]
pub struct Instruction {
    /// Its address.
    pub address: u32,
    /// Its size in bytes, 2 or 4.
    pub size: u32,
    /// Its mnemonic without condition and width, as capstone groups them: `sub` for `subw` and `subs.w`.
    pub name: String,
    /// As an assembler would write it.
    pub text: String,
    /// It is executed under a condition, its own or that of an IT block.
    pub conditional: bool,
    /// The base register of its memory operand is changed.
    pub writeback: bool,
    /// Its operands, in the assembler's order.
    pub operands: Vec<ArmOperand>,
}

/// Control flow out of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// On to the next address.
    Straight,
    /// To a fixed address.
    Branch(u32),
    /// To an address from the table behind the instruction, whose entries have this many bytes.
    Table(u32),
    /// To an address that a register holds, or that comes from memory.
    Indirect,
    /// Into the function at a fixed address, and back.
    Call(u32),
    /// Into the function whose address a register holds, and back.
    CallIndirect,
    /// To the caller, or out of an exception.
    Return,
    /// Nowhere: `udf`.
    Trap,
}

impl Instruction {
    /// The address behind it.
    pub fn next(&self) -> u32 {
        self.address.wrapping_add(self.size)
    }

    /// The register that is operand number `index`.
    pub fn register(&self, index: usize) -> Option<u32> {
        register_of(self.operands.get(index)?)
    }

    /// The integer that is operand number `index`.
    pub fn immediate(&self, index: usize) -> Option<i32> {
        match self.operands.get(index)?.op_type {
            ArmOperandType::Imm(value) => Some(value),
            _ => None,
        }
    }

    /// Base register, index register and displacement of the memory operand.
    pub fn memory(&self) -> Option<(u32, Option<u32>, i32)> {
        self.operands.iter().find_map(|operand| match operand.op_type {
            ArmOperandType::Mem(memory) => {
                let index = u32::from(memory.index().0);
                Some((u32::from(memory.base().0), (index != 0).then_some(index), memory.disp()))
            }
            _ => None,
        })
    }

    /// The registers among its operands.
    pub fn registers(&self) -> impl Iterator<Item = u32> {
        self.operands.iter().filter_map(register_of)
    }

    /// Control flow out of it.
    pub fn flow(&self) -> Flow {
        let target =
            |index| self.immediate(index).map_or(Flow::Indirect, |a| Flow::Branch(a.cast_unsigned()));
        let to_pc = self.register(0) == Some(PC);
        match self.name.as_str() {
            "b" => target(0),
            "cbz" | "cbnz" => target(1),
            "bl" | "blx" => self.immediate(0).map_or(Flow::CallIndirect, |a| Flow::Call(a.cast_unsigned())),
            "bx" if self.register(0) == Some(LR) => Flow::Return,
            "mov" if to_pc && self.register(1) == Some(LR) => Flow::Return,
            "pop" | "ldm" if self.registers().any(|r| r == PC) => Flow::Return,
            "ldr" if to_pc && self.pops() => Flow::Return,
            "tbb" => Flow::Table(1),
            "tbh" => Flow::Table(2),
            "udf" => Flow::Trap,
            "bx" => Flow::Indirect,
            _ if to_pc => Flow::Indirect,
            _ => Flow::Straight,
        }
    }

    /// Whether control may also go on to the next address.
    pub fn may_fall_through(&self) -> bool {
        let tests = self.conditional || matches!(self.name.as_str(), "cbz" | "cbnz");
        tests || matches!(self.flow(), Flow::Straight | Flow::Call(_) | Flow::CallIndirect)
    }

    fn pops(&self) -> bool {
        self.writeback && self.memory().is_some_and(|(base, ..)| base == SP)
    }
}

/// The program counter.
pub const PC: u32 = ArmReg::ARM_REG_PC;
/// The link register.
pub const LR: u32 = ArmReg::ARM_REG_LR;
/// The stack pointer.
pub const SP: u32 = ArmReg::ARM_REG_SP;

fn register_of(operand: &ArmOperand) -> Option<u32> {
    match operand.op_type {
        ArmOperandType::Reg(register) => Some(u32::from(register.0)),
        _ => None,
    }
}

/// Decodes `code`, which stands at `address` and holds instructions only.
pub fn disassemble(code: &[u8], address: u32) -> Result<Vec<Instruction>, Error> {
    let engine = Capstone::new()
        .arm()
        .mode(ArchMode::Thumb)
        .extra_mode([ArchExtraMode::MClass].into_iter())
        .detail(true)
        .build()?;
    let decoded = engine.disasm_all(code, u64::from(address))?;
    let instructions =
        decoded.iter().map(|i| instruction(&engine, i)).collect::<Result<Vec<_>, capstone::Error>>()?;
    let end = instructions.last().map_or(address, Instruction::next);
    match code.get((end - address) as usize..) {
        Some(rest @ [_, ..]) => {
            Err(Error::NotDecoded { address: end, bytes: rest.iter().take(4).copied().collect() })
        }
        _ => Ok(instructions),
    }
}

fn instruction(engine: &Capstone, decoded: &capstone::Insn) -> Result<Instruction, capstone::Error> {
    let detail = engine.insn_detail(decoded)?;
    let architecture = detail.arch_detail();
    let arm = architecture.arm().ok_or(capstone::Error::UnsupportedArch)?;
    let name = engine.insn_name(decoded.id()).unwrap_or_default();
    let (mnemonic, operands) = (decoded.mnemonic().unwrap_or(""), decoded.op_str().unwrap_or(""));
    Ok(Instruction {
        address: decoded.address() as u32,
        size: decoded.len() as u32,
        text: format!("{mnemonic} {operands}").trim_end().to_owned(),
        conditional: !matches!(arm.cc(), ArmCC::ARM_CC_AL | ArmCC::ARM_CC_INVALID) && name != "it",
        name,
        writeback: arm.writeback(),
        operands: arm.operands().collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flows(code: &[u8]) -> Vec<(Flow, bool)> {
        let decoded = disassemble(code, 0x1000).unwrap();
        decoded.iter().map(|i| (i.flow(), i.may_fall_through())).collect()
    }

    #[test]
    fn every_way_out_of_a_function_is_known() {
        let returns = [
            &[0x70, 0x47][..],         // bx lr
            &[0xf0, 0xbd],             // pop {r4-r7, pc}
            &[0xbd, 0xe8, 0xf0, 0x8f], // pop.w {r4-r11, pc}
            &[0x5d, 0xf8, 0x04, 0xfb], // ldr pc, [sp], #4
            &[0xf7, 0x46],             // mov pc, lr
        ];
        for code in returns {
            assert_eq!(flows(code), [(Flow::Return, false)], "{code:x?}");
        }
        assert_eq!(flows(&[0x18, 0x47]), [(Flow::Indirect, false)]); // bx r3
        assert_eq!(flows(&[0xdf, 0xf8, 0x08, 0xf0]), [(Flow::Indirect, false)]); // ldr.w pc, [pc, #8]
        assert_eq!(flows(&[0x9f, 0x46]), [(Flow::Indirect, false)]); // mov pc, r3
        assert_eq!(flows(&[0x00, 0xde]), [(Flow::Trap, false)]); // udf
    }

    #[test]
    fn calls_and_branches_have_their_targets() {
        assert_eq!(flows(&[0xff, 0xf7, 0xfe, 0xff]), [(Flow::Call(0x1000), true)]); // bl .
        assert_eq!(flows(&[0x98, 0x47]), [(Flow::CallIndirect, true)]); // blx r3
        assert_eq!(flows(&[0xfe, 0xe7]), [(Flow::Branch(0x1000), false)]); // b .
        assert_eq!(flows(&[0xfe, 0xd0]), [(Flow::Branch(0x1000), true)]); // beq .
        assert_eq!(flows(&[0x08, 0xb1]), [(Flow::Branch(0x1006), true)]); // cbz r0, .+6
        assert_eq!(flows(&[0xdf, 0xe8, 0x00, 0xf0]), [(Flow::Table(1), false)]); // tbb [pc, r0]
    }

    #[test]
    fn an_it_block_makes_its_instructions_conditional() {
        // it ne; bxne lr; it le; pople {r4, pc}
        let code = [0x18, 0xbf, 0x70, 0x47, 0xd8, 0xbf, 0x10, 0xbd];
        let expected =
            [(Flow::Straight, true), (Flow::Return, true), (Flow::Straight, true), (Flow::Return, true)];
        assert_eq!(flows(&code), expected);
    }

    #[test]
    fn bytes_that_are_no_instruction_are_named() {
        let error = disassemble(&[0x00, 0xbf, 0xff, 0xff, 0xff, 0xff], 0x1000).unwrap_err();
        assert_eq!(error.to_string(), "no instruction at 0x1002: ff ff ff ff");
    }
}
