//! A cost that both the boards' budgets and the table of bounds bound: no budget allows more than the table.

use strainwave_desktop::verify::bounds;
use strainwave_emulator::budget::{self, Block, Budget};

/// Blocks of the control step, and of the worst case, with their rows in the table.
const PARTS: [(&str, &str); 2] =
    [("flexspline", "flexspline.target.cycles"), ("friction", "friction.target.cycles")];
const WORST_CASES: [(&str, &str); 2] = [
    ("hysteresis_forward", "hysteresis.cycles.forward"),
    ("hysteresis_inverse", "hysteresis.cycles.inverse"),
];

fn is_within(block: &Block, row: &str) -> bool {
    block.cycles.is_some_and(|cycles| cycles as f64 <= bounds::find(row).unwrap().value)
}

/// Budgets of the boards whose cycles are counted: the others' cores are not the model's.
fn counted() -> Vec<Budget> {
    let boards = budget::emulated_boards().unwrap().into_iter();
    let budgets = boards.map(|board| Budget::read(&board).unwrap());
    let counted: Vec<_> = budgets.filter(|budget| budget.control_step.cycles.is_some()).collect();
    assert!(!counted.is_empty());
    counted
}

#[test]
fn no_budget_allows_more_cycles_than_the_table() {
    for budget in counted() {
        let board = &budget.board;
        for (name, row) in PARTS {
            assert!(is_within(&budget.blocks[name], row), "{board}: {name}, {row}");
        }
        for (name, row) in WORST_CASES {
            let worst_case = budget.worst_case.as_ref().unwrap();
            assert!(is_within(&worst_case.blocks[name], row), "{board}: {name}, {row}");
        }
    }
}

#[test]
fn no_budget_allows_a_cheaper_literal_mesh_than_the_table() {
    let row = bounds::FLOORS.iter().find(|row| row.name == "flexspline.target.literal_over_reduced").unwrap();
    for budget in counted() {
        let mesh = budget.literal_mesh.unwrap();
        assert!(mesh.at_least as f64 >= row.value, "{}: {}", budget.board, mesh.at_least);
    }
}
