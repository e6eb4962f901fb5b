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
use capstone::arch::arm::{ArmOperand, ArmOperandType, ArmReg};

use crate::artifact::disassembly::{Flow, Instruction, PC, SP};

/// The core whose cycles these are.
pub const CORE: &str = "Cortex-M4F";

/// Cycles to refill the pipeline after a taken branch; the manual's P, 1 to 3.
pub const REFILL: u32 = 3;

/// Cost rule of a row's instructions.
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

/// Instructions of one cost, and the row of the manual that says so.
type Row = (&'static str, Cost, &'static str);

/// The table. A transfer of control adds [`REFILL`] to its row.
#[rustfmt::skip]
static ROWS: &[Row] = &[
    ("mov movt mvn",                          Fixed(1),     "3-1 move: 1"),
    ("add adc adr",                           Fixed(1),     "3-1 add: 1"),
    ("sub sbc rsb",                           Fixed(1),     "3-1 subtract: 1"),
    ("mul mla mls",                           Fixed(1),     "3-1 multiply: 1"),
    ("smull umull smlal umlal umaal",         Fixed(1),     "3-1 multiply, long: 1"),
    ("smmul smmulr smmla smmlar smmls",       Fixed(1),     "3-2 multiply, most significant word: 1"),
    ("smulbb smulbt smultb smultt",           Fixed(1),     "3-2 multiply, half words: 1"),
    ("smlabb smlabt smlatb smlatt",           Fixed(1),     "3-2 multiply and accumulate, half words: 1"),
    ("smulwb smulwt",                         Fixed(1),     "3-2 multiply, word by half word: 1"),
    ("sdiv udiv",                             Fixed(12),    "3-1 divide: 2 to 12"),
    ("ssat usat qadd qsub",                   Fixed(1),     "3-1 and 3-2 saturate: 1"),
    ("cmp cmn tst teq",                       Fixed(1),     "3-1 compare, test: 1"),
    ("and orr eor orn bic",                   Fixed(1),     "3-1 logical: 1"),
    ("lsl lsr asr ror rrx",                   Fixed(1),     "3-1 shift, rotate: 1"),
    ("clz rbit rev rev16 revsh",              Fixed(1),     "3-1 count, reverse: 1"),
    ("sxtb sxth uxtb uxth",                   Fixed(1),     "3-1 extend: 1"),
    ("sxtab sxtah uxtab uxtah",               Fixed(1),     "3-2 extend and add: 1"),
    ("ubfx sbfx bfi bfc pkhbt pkhtb",         Fixed(1),     "3-1 bit field, 3-2 pack: 1"),
    ("sel it",                                Fixed(1),     "3-2 select: 1; 3-1 if then else: 1, folded 0"),
    ("ldr ldrb ldrh ldrsb ldrsh ldrex",       Fixed(2),     "3-1 load: 2, overlapping 1"),
    ("str strb strh",                         Store,        "Load/store timings: 1; 3-1 store: 2"),
    ("strex",                                 Fixed(2),     "3-1 store exclusive: 2"),
    ("ldrd strd push pop",                    OnePlusWords, "3-1 load, store, push, pop of several: 1 + N"),
    ("ldm ldmdb stm stmdb",                   OnePlusWords, "3-1 load, store of several: 1 + N"),
    ("b bl bx blx cbz cbnz",                  Fixed(1),     "3-1 branch: 1 or 1 + P"),
    ("tbb tbh",                               Fixed(3),     "Load/store timings: table branch: 2 + 1 + P"),
    ("cps mrs msr",                           Fixed(2),     "3-1 state change, special register: 1 or 2"),
    ("vadd vsub vmul vnmul vabs vneg",        Fixed(1),     "7-1 add, multiply, absolute, negate: 1"),
    ("vcmp vcmpe vcvt vcvtr vcvtb vcvtt",     Fixed(1),     "7-1 compare, convert: 1"),
    ("vmla vmls vnmla vnmls",                 Fixed(3),     "7-1 multiply then accumulate: 3"),
    ("vfma vfms vfnma vfnms",                 Fixed(3),     "7-1 fused multiply and accumulate: 3"),
    ("vdiv vsqrt",                            Fixed(14),    "7-1 divide, square root: 14"),
    ("vmov fconsts",                          WithCore(1),  "7-1 move: 1, of two 2; with the core always 2"),
    ("vmrs fmstat vmsr",                      Fixed(1),     "7-1 move from or to FPSCR: 1"),
    ("vldr vstr vpush vpop",                  OnePlusWords, "7-1 load, store: 1 + N, doubles 1 + 2 N"),
    ("vldmia vldmdb vstmia vstmdb",           OnePlusWords, "7-1 load, store of several: 1 + N, 1 + 2 N"),
];

static BY_NAME: LazyLock<HashMap<&str, Cost>> = LazyLock::new(|| {
    ROWS.iter().flat_map(|(names, cost, _)| names.split(' ').map(|name| (name, *cost))).collect()
});

/// The cost of `instruction`, executed right behind `before`; `None` when the table has no row for it.
///
/// A conditional transfer of control costs this when it is not taken, and [`REFILL`] more when it is.
pub fn cycles(instruction: &Instruction, before: Option<&Instruction>) -> Option<u32> {
    if instruction.text.contains(".f64") {
        return None;
    }
    let own = match BY_NAME.get(instruction.name.as_str()) {
        Some(Fixed(cycles)) => *cycles,
        Some(OnePlusWords) => 1 + words(instruction),
        Some(Store) => store(instruction),
        Some(WithCore(cycles)) => cycles + u32::from(instruction.registers().any(is_core)),
        // `nop` shares its name, `hint`, with `wfi`, `wfe` and `sev`.
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
    let tests = instruction.conditional || matches!(instruction.name.as_str(), "cbz" | "cbnz");
    !tests && instruction.flow() != Flow::Straight
}

fn store(instruction: &Instruction) -> u32 {
    if instruction.memory().is_some_and(|(_, index, _)| index.is_some()) { 2 } else { 1 }
}

/// Words of the registers that it moves; the base register of a list is not one of them.
fn words(instruction: &Instruction) -> u32 {
    let base = usize::from(is_list(instruction));
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
    if matches!(before.name.as_str(), "vcmp" | "vcmpe") {
        return matches!(instruction.name.as_str(), "vmrs" | "fmstat");
    }
    let Some(result) = before.register(0).filter(|_| computes(before)) else {
        return false;
    };
    float_sources(instruction).any(|source| overlap(source, result))
}

fn computes(instruction: &Instruction) -> bool {
    let moves = ["vmov", "vmrs", "vmsr", "vldr", "vstr", "vpush", "vpop"];
    instruction.name.starts_with('v')
        && !moves.contains(&instruction.name.as_str())
        && !moves_a_list(instruction)
}

/// "Load/store timings": there is no forwarding from a data-processing instruction to an address.
fn waits_for_address(instruction: &Instruction, before: &Instruction) -> bool {
    let computes = before.memory().is_none() && !moves_a_list(before);
    let base = match instruction.memory() {
        Some((base, index, _)) => [Some(base), index],
        None if is_stack(instruction) => [Some(SP), None],
        None if is_list(instruction) => [instruction.register(0), None],
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

/// Its row includes what the load of its distance takes.
fn is_table_branch(instruction: &Instruction) -> bool {
    matches!(instruction.flow(), Flow::Table(_))
}

/// A list of registers behind a base register.
fn is_list(instruction: &Instruction) -> bool {
    let names = ["ldm", "ldmdb", "stm", "stmdb", "vldmia", "vldmdb", "vstmia", "vstmdb"];
    names.contains(&instruction.name.as_str())
}

/// A list of registers on the stack.
fn is_stack(instruction: &Instruction) -> bool {
    matches!(instruction.name.as_str(), "push" | "pop" | "vpush" | "vpop")
}

fn moves_a_list(instruction: &Instruction) -> bool {
    is_list(instruction) || is_stack(instruction)
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
        let names = ROWS.iter().flat_map(|(names, ..)| names.split(' ')).count();
        assert_eq!(names, BY_NAME.len());
        assert!(ROWS.iter().all(|(_, _, source)| source.contains(": ")));
    }
}
