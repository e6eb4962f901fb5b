//! Functions of a few instructions, as their bytes.

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
