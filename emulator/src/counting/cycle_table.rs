//! Cycles of a Cortex-M4F with zero wait states, at the pessimistic end.
//!
//! Every range of the manual is taken at its upper end: a pipeline refill takes [`REFILL`] = 3 cycles, a
//! division 12, no load or store overlaps its neighbour. Three stalls are added where the code can have
//! them, a cycle each: a result of the floating-point unit that the next instruction uses, an address that
//! the instruction before computes, and a constant loaded from beside the code. Instructions whose cost the
//! manual leaves to the surroundings (barriers, `wfi`) and those that a Cortex-M4F does not have (f64) have
//! no row: counting one is an error that names it.
//!
//! This is a model. It was not compared with silicon; flash wait states, bus contention and a debugger
//! make a real part slower, overlapping loads faster.
//!
//! Reference: Cortex-M4 Technical Reference Manual r0p1 (Arm 100166), table 3-1 "Processor instruction set
//! summary" and 3-2 for the DSP instructions, section "Load/store timings", table 7-1 "FPU instruction set"
//! with its remarks. One row reads more than its table says: a table branch takes "at least six cycles".

use std::collections::HashMap;
use std::sync::LazyLock;

use capstone::AccessType;
use capstone::arch::arm::ArmInsn::{self, *};
use capstone::arch::arm::{ArmOperand, ArmOperandType, ArmReg};

use crate::artifact::disassembly::{Flow, Instruction, PC, SP};

/// Cycles to refill the pipeline after a taken branch; the manual's P, 1 to 3.
pub const REFILL: u32 = 3;

/// How a row gives the cost of its instructions.
#[derive(Clone, Copy, Debug)]
enum Cost {
    /// That many cycles.
    Fixed(u32),
    /// 1 + N: one more than the words that it moves.
    OnePlusWords,
    /// A store: one cycle when its address is register plus constant, which the write buffer hides; two
    /// when it is the sum of two registers.
    Store,
    /// The fixed cost, and one more when a core register takes part.
    WithCore(u32),
}

use Cost::{Fixed, OnePlusWords, Store, WithCore};

/// Instructions of one cost, beside the row of the manual.
struct Row {
    instructions: &'static [ArmInsn],
    cost: Cost,
    #[cfg_attr(not(test), expect(dead_code, reason = "documents the row; the tests print it"))]
    source: &'static str,
}

const fn row(instructions: &'static [ArmInsn], cost: Cost, source: &'static str) -> Row {
    Row { instructions, cost, source }
}

/// The table. A transfer of control adds [`REFILL`] to its row.
static ROWS: &[Row] = &[
    row(&[ARM_INS_MOV, ARM_INS_MOVT, ARM_INS_MVN], Fixed(1), "3-1 move: 1"),
    row(&[ARM_INS_ADD, ARM_INS_ADC, ARM_INS_ADR], Fixed(1), "3-1 add: 1"),
    row(&[ARM_INS_SUB, ARM_INS_SBC, ARM_INS_RSB], Fixed(1), "3-1 subtract: 1"),
    row(&[ARM_INS_MUL, ARM_INS_MLA, ARM_INS_MLS], Fixed(1), "3-1 multiply: 1"),
    row(
        &[ARM_INS_SMULL, ARM_INS_UMULL, ARM_INS_SMLAL, ARM_INS_UMLAL, ARM_INS_UMAAL],
        Fixed(1),
        "3-1 multiply, long: 1",
    ),
    row(
        &[ARM_INS_SMMUL, ARM_INS_SMMULR, ARM_INS_SMMLA, ARM_INS_SMMLAR, ARM_INS_SMMLS],
        Fixed(1),
        "3-2 multiply, most significant word: 1",
    ),
    row(
        &[
            ARM_INS_SMULBB,
            ARM_INS_SMULBT,
            ARM_INS_SMULTB,
            ARM_INS_SMULTT,
            ARM_INS_SMLABB,
            ARM_INS_SMLABT,
            ARM_INS_SMLATB,
            ARM_INS_SMLATT,
            ARM_INS_SMULWB,
            ARM_INS_SMULWT,
        ],
        Fixed(1),
        "3-2 multiply, half words: 1",
    ),
    row(&[ARM_INS_SDIV, ARM_INS_UDIV], Fixed(12), "3-1 divide: 2 to 12"),
    row(&[ARM_INS_SSAT, ARM_INS_USAT, ARM_INS_QADD, ARM_INS_QSUB], Fixed(1), "3-1 and 3-2 saturate: 1"),
    row(&[ARM_INS_CMP, ARM_INS_CMN, ARM_INS_TST, ARM_INS_TEQ], Fixed(1), "3-1 compare, logical test: 1"),
    row(&[ARM_INS_AND, ARM_INS_ORR, ARM_INS_EOR, ARM_INS_ORN, ARM_INS_BIC], Fixed(1), "3-1 logical: 1"),
    row(&[ARM_INS_LSL, ARM_INS_LSR, ARM_INS_ASR, ARM_INS_ROR, ARM_INS_RRX], Fixed(1), "3-1 shift, rotate: 1"),
    row(
        &[ARM_INS_CLZ, ARM_INS_RBIT, ARM_INS_REV, ARM_INS_REV16, ARM_INS_REVSH],
        Fixed(1),
        "3-1 count, reverse: 1",
    ),
    row(
        &[
            ARM_INS_SXTB,
            ARM_INS_SXTH,
            ARM_INS_UXTB,
            ARM_INS_UXTH,
            ARM_INS_SXTAB,
            ARM_INS_SXTAH,
            ARM_INS_UXTAB,
            ARM_INS_UXTAH,
        ],
        Fixed(1),
        "3-1 extend: 1",
    ),
    row(
        &[ARM_INS_UBFX, ARM_INS_SBFX, ARM_INS_BFI, ARM_INS_BFC, ARM_INS_PKHBT, ARM_INS_PKHTB],
        Fixed(1),
        "3-1 bit field, 3-2 pack: 1",
    ),
    row(&[ARM_INS_SEL, ARM_INS_IT], Fixed(1), "3-2 select: 1; 3-1 if then else: 1, 0 when folded"),
    row(
        &[ARM_INS_LDR, ARM_INS_LDRB, ARM_INS_LDRH, ARM_INS_LDRSB, ARM_INS_LDRSH, ARM_INS_LDREX],
        Fixed(2),
        "3-1 load: 2, 1 when it overlaps the one before",
    ),
    row(
        &[ARM_INS_STR, ARM_INS_STRB, ARM_INS_STRH],
        Store,
        "Load/store timings: register plus constant 1; 3-1 store: 2",
    ),
    row(&[ARM_INS_STREX], Fixed(2), "3-1 store exclusive: 2"),
    row(
        &[
            ARM_INS_LDRD,
            ARM_INS_STRD,
            ARM_INS_LDM,
            ARM_INS_LDMDB,
            ARM_INS_STM,
            ARM_INS_STMDB,
            ARM_INS_PUSH,
            ARM_INS_POP,
        ],
        OnePlusWords,
        "3-1 load, store, push, pop of several: 1 + N",
    ),
    row(
        &[ARM_INS_B, ARM_INS_BL, ARM_INS_BX, ARM_INS_BLX, ARM_INS_CBZ, ARM_INS_CBNZ],
        Fixed(1),
        "3-1 branch: 1 or 1 + P",
    ),
    row(&[ARM_INS_TBB, ARM_INS_TBH], Fixed(3), "Load/store timings: table branch: 2 + 1 + P"),
    row(
        &[ARM_INS_CPS, ARM_INS_MRS, ARM_INS_MSR],
        Fixed(2),
        "3-1 state change, move from or to special register: 1 or 2",
    ),
    row(
        &[ARM_INS_VADD, ARM_INS_VSUB, ARM_INS_VMUL, ARM_INS_VNMUL, ARM_INS_VABS, ARM_INS_VNEG],
        Fixed(1),
        "7-1 add, subtract, multiply, absolute, negate: 1",
    ),
    row(
        &[ARM_INS_VCMP, ARM_INS_VCMPE, ARM_INS_VCVT, ARM_INS_VCVTR, ARM_INS_VCVTB, ARM_INS_VCVTT],
        Fixed(1),
        "7-1 compare, convert: 1",
    ),
    row(
        &[
            ARM_INS_VMLA,
            ARM_INS_VMLS,
            ARM_INS_VNMLA,
            ARM_INS_VNMLS,
            ARM_INS_VFMA,
            ARM_INS_VFMS,
            ARM_INS_VFNMA,
            ARM_INS_VFNMS,
        ],
        Fixed(3),
        "7-1 multiply then accumulate, fused or not: 3",
    ),
    row(&[ARM_INS_VDIV, ARM_INS_VSQRT], Fixed(14), "7-1 divide, square root: 14"),
    row(
        &[ARM_INS_VMOV, ARM_INS_FCONSTS],
        WithCore(1),
        "7-1 move: 1, two registers 2; the core's taken as 2 always",
    ),
    row(&[ARM_INS_VMRS, ARM_INS_FMSTAT, ARM_INS_VMSR], Fixed(1), "7-1 move from or to FPSCR: 1"),
    row(
        &[
            ARM_INS_VLDR,
            ARM_INS_VSTR,
            ARM_INS_VLDMIA,
            ARM_INS_VLDMDB,
            ARM_INS_VSTMIA,
            ARM_INS_VSTMDB,
            ARM_INS_VPUSH,
            ARM_INS_VPOP,
        ],
        OnePlusWords,
        "7-1 load, store, push, pop: 1 + N, 1 + 2 N for doubles",
    ),
];

static BY_NUMBER: LazyLock<HashMap<u32, Cost>> = LazyLock::new(|| {
    ROWS.iter().flat_map(|row| row.instructions.iter().map(|i| (*i as u32, row.cost))).collect()
});

/// The cost of `instruction`, executed right behind `before`; `None` when the table has no row for it.
///
/// A conditional transfer of control costs this when it is not taken, and [`REFILL`] more when it is.
pub fn cycles(instruction: &Instruction, before: Option<&Instruction>) -> Option<u32> {
    if instruction.text.contains(".f64") {
        return None;
    }
    let own = match BY_NUMBER.get(&instruction.id) {
        Some(Fixed(cycles)) => *cycles,
        Some(OnePlusWords) => 1 + words(instruction),
        Some(Store) => store(instruction),
        Some(WithCore(cycles)) => cycles + u32::from(instruction.registers().any(is_core)),
        // `nop` shares its number with `wfi`, `wfe` and `sev`.
        None if instruction.text.trim_end_matches(".w") == "nop" => 1,
        None => return None,
    };
    let stalls = [
        before.is_some_and(|b| waits_for_result(instruction, b)),
        before.is_some_and(|b| waits_for_address(instruction, b)),
        instruction.memory().is_some_and(|(base, ..)| base == PC) && !is_table_branch(instruction),
    ];
    let refill = if always_leaves(instruction) { REFILL } else { 0 };
    Some(own + stalls.into_iter().map(u32::from).sum::<u32>() + refill)
}

/// It goes elsewhere whenever it is executed.
fn always_leaves(instruction: &Instruction) -> bool {
    !instruction.conditional
        && instruction.flow() != Flow::Straight
        && !instruction.is(ARM_INS_CBZ)
        && !instruction.is(ARM_INS_CBNZ)
}

fn store(instruction: &Instruction) -> u32 {
    if instruction.memory().is_some_and(|(_, index, _)| index.is_some()) { 2 } else { 1 }
}

/// Words of the registers that it moves; the base register of a list is not one of them.
fn words(instruction: &Instruction) -> u32 {
    let base = usize::from(is_any(&LISTS, instruction));
    instruction.registers().skip(base).map(|r| if is_double(r) { 2 } else { 1 }).sum()
}

fn is_double(register: u32) -> bool {
    (ArmReg::ARM_REG_D0..=ArmReg::ARM_REG_D31).contains(&register)
}

fn is_single(register: u32) -> bool {
    (ArmReg::ARM_REG_S0..=ArmReg::ARM_REG_S31).contains(&register)
}

fn is_core(register: u32) -> bool {
    !is_double(register) && !is_single(register) && register != PC
}

/// Chapter 7: a data-processing instruction takes one cycle longer when its result is used at once.
fn waits_for_result(instruction: &Instruction, before: &Instruction) -> bool {
    let computes = [
        ARM_INS_VADD,
        ARM_INS_VSUB,
        ARM_INS_VMUL,
        ARM_INS_VNMUL,
        ARM_INS_VABS,
        ARM_INS_VNEG,
        ARM_INS_VCVT,
        ARM_INS_VCVTR,
        ARM_INS_VCVTB,
        ARM_INS_VCVTT,
        ARM_INS_VMLA,
        ARM_INS_VMLS,
        ARM_INS_VNMLA,
        ARM_INS_VNMLS,
        ARM_INS_VFMA,
        ARM_INS_VFMS,
        ARM_INS_VFNMA,
        ARM_INS_VFNMS,
        ARM_INS_VDIV,
        ARM_INS_VSQRT,
    ];
    let compares = [ARM_INS_VCMP, ARM_INS_VCMPE];
    let reads_flags = [ARM_INS_VMRS, ARM_INS_FMSTAT];
    if is_any(&compares, before) {
        return is_any(&reads_flags, instruction);
    }
    let Some(result) = before.register(0).filter(|_| is_any(&computes, before)) else {
        return false;
    };
    float_sources(instruction).any(|source| overlap(source, result))
}

/// "Load/store timings": there is no forwarding from a data-processing instruction to an address.
fn waits_for_address(instruction: &Instruction, before: &Instruction) -> bool {
    let computes = before.memory().is_none() && !moves_a_list(before);
    let base = match instruction.memory() {
        Some((base, index, _)) => [Some(base), index],
        None if is_any(&STACK, instruction) => [Some(SP), None],
        None if is_any(&LISTS, instruction) => [instruction.register(0), None],
        None => return false,
    };
    computes && base.into_iter().flatten().any(|register| writes(before, register))
}

fn writes(instruction: &Instruction, register: u32) -> bool {
    instruction.operands.iter().any(|operand| {
        matches!(operand.op_type, ArmOperandType::Reg(r) if u32::from(r.0) == register)
            && operand.access.is_none_or(AccessType::is_writable)
    })
}

fn is_any(list: &[ArmInsn], instruction: &Instruction) -> bool {
    list.iter().any(|id| instruction.is(*id))
}

fn is_table_branch(instruction: &Instruction) -> bool {
    is_any(&[ARM_INS_TBB, ARM_INS_TBH], instruction)
}

/// A list of registers behind a base register.
const LISTS: [ArmInsn; 8] = [
    ARM_INS_LDM,
    ARM_INS_LDMDB,
    ARM_INS_STM,
    ARM_INS_STMDB,
    ARM_INS_VLDMIA,
    ARM_INS_VLDMDB,
    ARM_INS_VSTMIA,
    ARM_INS_VSTMDB,
];

/// A list of registers on the stack.
const STACK: [ArmInsn; 4] = [ARM_INS_PUSH, ARM_INS_POP, ARM_INS_VPUSH, ARM_INS_VPOP];

fn moves_a_list(instruction: &Instruction) -> bool {
    is_any(&LISTS, instruction) || is_any(&STACK, instruction)
}

/// The floating-point registers that an instruction may read; one whose access is not known counts as read.
fn float_sources(instruction: &Instruction) -> impl Iterator<Item = u32> {
    let reads = |o: &&ArmOperand| o.access.is_none_or(AccessType::is_readable);
    let register = |o: &ArmOperand| match o.op_type {
        ArmOperandType::Reg(r) => Some(u32::from(r.0)),
        _ => None,
    };
    instruction.operands.iter().filter(reads).filter_map(register).filter(|r| is_single(*r) || is_double(*r))
}

/// Whether two of s0-s31 and d0-d15 share a word.
fn overlap(a: u32, b: u32) -> bool {
    let span = |r: u32| match is_double(r) {
        true => (2 * (r - ArmReg::ARM_REG_D0), 2),
        false => (r - ArmReg::ARM_REG_S0, 1),
    };
    let ((a, a_words), (b, b_words)) = (span(a), span(b));
    a < b + b_words && b < a + a_words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::artifact::disassembly::disassemble;

    /// The cost of each instruction of a straight piece of code.
    fn costs(code: &[u8]) -> Vec<Option<u32>> {
        let decoded = disassemble(code, 0x1000).unwrap();
        (0..decoded.len()).map(|k| cycles(&decoded[k], k.checked_sub(1).map(|b| &decoded[b]))).collect()
    }

    fn cost(code: &[u8]) -> Option<u32> {
        let all = costs(code);
        assert_eq!(all.len(), 1);
        all[0]
    }

    #[test]
    fn integer_instructions() {
        assert_eq!(cost(&[0x08, 0x44]), Some(1)); // add r0, r1
        assert_eq!(cost(&[0x40, 0xf2, 0xd2, 0x40]), Some(1)); // movw r0, #0x4d2
        assert_eq!(cost(&[0x01, 0xfb, 0x02, 0x30]), Some(1)); // mla r0, r1, r2, r3
        assert_eq!(cost(&[0x91, 0xfb, 0xf2, 0xf0]), Some(12)); // sdiv r0, r1, r2
        assert_eq!(cost(&[0x00, 0xbf]), Some(1)); // nop
        assert_eq!(cost(&[0xaf, 0xf3, 0x00, 0x80]), Some(1)); // nop.w
    }

    #[test]
    fn loads_and_stores() {
        assert_eq!(cost(&[0x08, 0x68]), Some(2)); // ldr r0, [r1]
        assert_eq!(cost(&[0x08, 0x60]), Some(1)); // str r0, [r1]
        assert_eq!(cost(&[0x88, 0x50]), Some(2)); // str r0, [r1, r2]
        assert_eq!(cost(&[0xd2, 0xe9, 0x00, 0x01]), Some(3)); // ldrd r0, r1, [r2]
        assert_eq!(cost(&[0x90, 0xe8, 0x0e, 0x00]), Some(4)); // ldm.w r0, {r1, r2, r3}
        assert_eq!(cost(&[0x0e, 0xc0]), Some(4)); // stm r0!, {r1, r2, r3}
        assert_eq!(cost(&[0xf0, 0xb5]), Some(6)); // push {r4-r7, lr}
    }

    #[test]
    fn transfers_of_control() {
        assert_eq!(cost(&[0xfe, 0xe7]), Some(4)); // b .
        assert_eq!(cost(&[0xfe, 0xd0]), Some(1)); // beq .
        assert_eq!(cost(&[0x08, 0xb1]), Some(1)); // cbz r0, .+6
        assert_eq!(cost(&[0xff, 0xf7, 0xfe, 0xff]), Some(4)); // bl .
        assert_eq!(cost(&[0x70, 0x47]), Some(4)); // bx lr
        assert_eq!(cost(&[0xf0, 0xbd]), Some(9)); // pop {r4-r7, pc}
        assert_eq!(cost(&[0x5d, 0xf8, 0x04, 0xfb]), Some(5)); // ldr pc, [sp], #4
        assert_eq!(cost(&[0xdf, 0xe8, 0x00, 0xf0]), Some(6)); // tbb [pc, r0]
        assert_eq!(costs(&[0x18, 0xbf, 0x70, 0x47]), [Some(1), Some(1)]); // it ne; bxne lr
    }

    #[test]
    fn floating_point_instructions() {
        assert_eq!(cost(&[0x30, 0xee, 0x81, 0x0a]), Some(1)); // vadd.f32 s0, s1, s2
        assert_eq!(cost(&[0xe0, 0xee, 0x00, 0x1a]), Some(3)); // vfma.f32 s3, s0, s0
        assert_eq!(cost(&[0xc0, 0xee, 0x20, 0x1a]), Some(14)); // vdiv.f32 s3, s0, s1
        assert_eq!(cost(&[0xf1, 0xee, 0xc0, 0x1a]), Some(14)); // vsqrt.f32 s3, s0
        assert_eq!(cost(&[0x00, 0xee, 0x10, 0x0a]), Some(2)); // vmov s0, r0
        assert_eq!(cost(&[0xb0, 0xee, 0x60, 0x0a]), Some(1)); // vmov.f32 s0, s1
        assert_eq!(cost(&[0x90, 0xed, 0x00, 0x0a]), Some(2)); // vldr s0, [r0]
        assert_eq!(cost(&[0x90, 0xed, 0x00, 0x0b]), Some(3)); // vldr d0, [r0]
        assert_eq!(cost(&[0x90, 0xec, 0x04, 0x0a]), Some(5)); // vldmia r0, {s0-s3}
        assert_eq!(cost(&[0x2d, 0xed, 0x08, 0x8b]), Some(9)); // vpush {d8-d11}
    }

    #[test]
    fn a_result_that_is_used_at_once_stalls() {
        // vmul.f32 s3, s0, s0; then vadd of s3, and of other registers
        assert_eq!(costs(&[0x60, 0xee, 0x00, 0x1a, 0x31, 0xee, 0x81, 0x0a]), [Some(1), Some(2)]);
        assert_eq!(costs(&[0x60, 0xee, 0x00, 0x1a, 0x30, 0xee, 0x00, 0x0a]), [Some(1), Some(1)]);
        // vcmp.f32 s3, s0; vmrs apsr_nzcv, fpscr
        assert_eq!(costs(&[0xf4, 0xee, 0x40, 0x1a, 0xf1, 0xee, 0x10, 0xfa]), [Some(1), Some(2)]);
        // vadd.f32 s0, s1, s2; vstr d0, [r0, #4]: d0 is s0 and s1
        assert_eq!(costs(&[0x30, 0xee, 0x81, 0x0a, 0x80, 0xed, 0x01, 0x0b]), [Some(1), Some(4)]);
        // vldr s0, [r0]; vadd.f32 s0, s0, s0: a load's two cycles already include it
        assert_eq!(costs(&[0x90, 0xed, 0x00, 0x0a, 0x30, 0xee, 0x00, 0x0a]), [Some(2), Some(1)]);
    }

    #[test]
    fn an_address_that_was_just_computed_stalls() {
        // adds r1, #4; ldr r0, [r1]; and ldr r0, [r2]
        assert_eq!(costs(&[0x04, 0x31, 0x08, 0x68]), [Some(1), Some(3)]);
        assert_eq!(costs(&[0x04, 0x31, 0x10, 0x68]), [Some(1), Some(2)]);
        // adds r2, #4; str r0, [r1, r2]
        assert_eq!(costs(&[0x04, 0x32, 0x88, 0x50]), [Some(1), Some(3)]);
        // add sp, #16; pop {r4-r7, pc}
        assert_eq!(costs(&[0x04, 0xb0, 0xf0, 0xbd]), [Some(1), Some(10)]);
        // adds r0, #4; ldm.w r0, {r1, r2, r3}; a load is no data processing: ldr r1, [r1]; ldr r0, [r1]
        assert_eq!(costs(&[0x04, 0x30, 0x90, 0xe8, 0x0e, 0x00]), [Some(1), Some(5)]);
        assert_eq!(costs(&[0x09, 0x68, 0x08, 0x68]), [Some(2), Some(2)]);
    }

    #[test]
    fn a_constant_from_beside_the_code_contends_with_the_fetch() {
        assert_eq!(cost(&[0x02, 0x48]), Some(3)); // ldr r0, [pc, #8]
        assert_eq!(cost(&[0x9f, 0xed, 0x02, 0x0a]), Some(3)); // vldr s0, [pc, #8]
    }

    #[test]
    fn what_the_manual_does_not_cost_has_no_cost() {
        assert_eq!(cost(&[0xbf, 0xf3, 0x5f, 0x8f]), None); // dmb
        assert_eq!(cost(&[0x30, 0xbf]), None); // wfi
        assert_eq!(cost(&[0x00, 0xde]), None); // udf
        assert_eq!(cost(&[0x31, 0xee, 0x02, 0x0b]), None); // vadd.f64 d0, d1, d2
    }

    #[test]
    fn every_instruction_has_one_row_and_every_row_a_source() {
        let all: Vec<u32> = ROWS.iter().flat_map(|row| row.instructions).map(|i| *i as u32).collect();
        assert_eq!(all.len(), BY_NUMBER.len());
        assert!(ROWS.iter().all(|row| row.source.contains(':')));
    }
}
