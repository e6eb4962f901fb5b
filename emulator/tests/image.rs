//! The real image: what its budget promises can be shown of it, and its counts agree with QEMU's own log.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use strainwave::compensator::{CompensationGains, Input, Sensors};
use strainwave_app::frame::encode_input;
use strainwave_app::literal_mesh::PERIODS;
use strainwave_emulator::artifact::{CONTROL_STEP, CallGraph, Image, proofs};
use strainwave_emulator::budget::{self, Budget, LiteralMesh};
use strainwave_emulator::counting::{Counting, Outcome};
use strainwave_emulator::{Machine, firmware, setup};

const BOARD: &str = "mps2-an386";

/// The image of a board, unless the machine has no compiler for it: a test installs none.
fn image(board: &str) -> Option<PathBuf> {
    let target = firmware::target(board).expect("the board has a target");
    if setup::present_compiler(&setup::ThisHost, &target).is_none() {
        println!("skipped: no cross target");
        return None;
    }
    Some(firmware::build(board, None).expect("the board builds").elf)
}

/// The image of the board that the emulator has, unless there is no emulator.
fn runnable() -> Option<PathBuf> {
    if setup::present_emulator(&setup::ThisHost).is_none() {
        println!("skipped: no emulator");
        return None;
    }
    image(BOARD)
}

#[test]
fn every_boards_image_is_within_its_budget_without_panic_allocator_or_doubles() {
    for board in firmware::boards().expect("the boards are there") {
        let Some(elf) = image(&board) else { return };
        let budget = Budget::read(&board).expect("the budget is sound");
        let measured = budget::inspect(&budget, &elf).expect("the image can be judged");
        let figures = measured.figures(&budget);
        assert!(figures.iter().all(|f| f.holds), "{}", measured.table(&budget));
        assert!(figures.iter().filter(|f| f.bound.is_some()).count() >= 6, "{}", measured.table(&budget));
    }
}

/// The function is of a gear or its compensator, and only a `build` needs it.
fn computes(symbol: &str) -> bool {
    let modules = ["compensator", "gear", "friction", "flexspline", "hysteresis", "kinematic_error"];
    modules.iter().any(|name| symbol.starts_with(&format!("strainwave::{name}::")))
        && ["build", "weights", "condense", "settled", "rounded"].iter().any(|name| symbol.contains(name))
}

/// Nothing of a compensator is computed on the target: neither the parameters' `build` nor what it alone calls, should it have
/// been inlined, nor the double precision that it computes in.
#[test]
fn no_boards_image_builds_a_compensator() {
    for board in firmware::boards().expect("the boards are there") {
        let Some(elf) = image(&board) else { return };
        let image = Image::read(&elf).expect("is readable");
        assert!(image.find(CONTROL_STEP).is_ok());
        let found: Vec<_> = image.symbols().iter().filter(|symbol| computes(symbol)).collect();
        assert!(found.is_empty(), "{board}: {found:?}");
        let graph = CallGraph::of(&image, &image.vectors().expect("has vectors"), &[]).expect("is closed");
        let everything: Vec<_> = (0..graph.nodes().len()).collect();
        assert_eq!(proofs::doubles(&graph, &everything), [], "{board}");
    }
}

#[test]
fn the_way_from_the_interrupt_to_the_control_step_is_found() {
    let Some(elf) = image(BOARD) else { return };
    let image = Image::read(&elf).expect("is readable");
    let handlers = image.vectors().expect("has vectors");
    let graph = CallGraph::of(&image, &handlers, &[]).expect("is closed");
    let step = image.find("control_step").expect("is linked")[0];
    let path = graph.path(&handlers, step).expect("is called from a handler");
    assert!(path[0].ends_with("control_interrupt") && path.len() >= 2, "{path:?}");
    assert_eq!(graph.path(&handlers[..1], step), None, "the thread does not call it");
    let error = image.find("control_stepp").expect_err("is not there").to_string();
    assert!(error.starts_with("no function control_stepp in the image"), "{error}");
}

/// A moving joint, for `periods` control periods: 8 rad/s with an encoder of 19 bits.
fn run(elf: &Path, periods: u32, arguments: &[String]) {
    let mut machine = Machine::boot(elf, arguments).expect("boots");
    for period in 0..periods {
        let sensors = Sensors { motor_encoder: period * 70, motor_torque: 0.1, ..Sensors::default() };
        let gains = CompensationGains { friction: 0.8, ..CompensationGains::ALL };
        let input = Input { sensors, gains: gains.into(), ..Input::default() };
        machine.exchange(&encode_input(&input)).expect("answers");
    }
    machine.finish().expect("ends");
}

fn counted(image: &Image, tracked: &[usize], periods: u32, more: &[String]) -> Outcome {
    let counting = Counting::prepare(image, tracked).expect("the plugin builds");
    run(image.path(), periods, &[&counting.arguments()[..], more].concat());
    counting.results(image).expect("the counts are there")
}

#[test]
fn counts_are_repeatable_to_the_instruction() {
    let Some(elf) = runnable() else { return };
    let image = Image::read(&elf).expect("is readable");
    let budget = Budget::read(BOARD).expect("the budget is sound");
    let tracked: Vec<usize> =
        budget.blocks().flat_map(|(_, block)| image.find(&block.symbol).expect("is linked")).collect();
    let once = counted(&image, &tracked, 100, &[]);
    assert_eq!(once.counts, counted(&image, &tracked, 100, &[]).counts);
    let step = once.counts[0].expect("was called");
    assert_eq!(step.calls, 100);
    for (part, function) in once.counts.iter().zip(&tracked).skip(1) {
        let part = part.unwrap_or_else(|| panic!("{} was called", image.functions()[*function].name()));
        assert!(
            part.instructions.max < step.instructions.max
                && part.cycles.map(|c| c.max) < step.cycles.map(|c| c.max)
        );
        assert!(part.cycles.is_some_and(|cycles| part.instructions.min <= cycles.min));
    }
}

/// The counted control period of the literal mesh, and the figures of the board's budget that it has.
#[test]
fn the_literal_mesh_costs_hundreds_of_times_its_reduction() {
    let Some(control) = runnable() else { return };
    let mut budget = Budget::read(BOARD).expect("the budget is sound");
    let mesh = budget.literal_mesh.clone().expect("the board has a literal mesh");
    let elf = firmware::build_program(BOARD, &mesh.program).expect("the program builds").elf;
    let mut measured = budget::inspect(&budget, &control).expect("the image can be judged");
    let image = Image::read(&control).expect("is readable");
    let reduced = image.find(&budget.blocks[&mesh.reduced].symbol).expect("is linked");
    let reduced = counted(&image, &reduced, 100, &[]).counts[0].expect("was called");
    measured.counts = vec![(mesh.reduced.clone(), reduced)];
    mesh.measure(&elf, &mut measured).expect("the mesh agrees with its reduction");

    let (name, period) = &measured.counts[1];
    assert_eq!((name.as_str(), period.calls), (budget::LITERAL_MESH, u64::from(PERIODS)));
    // Two dozen nodes of 10 links, some ten micro-steps: no shortcut is that cheap.
    assert!(period.instructions.min > 100_000 && period.instructions.max < 10_000_000, "{period:?}");
    let figures = measured.figures(&budget);
    let missed: Vec<_> = figures.iter().filter(|f| !f.holds).collect();
    assert!(missed.is_empty(), "{missed:?}");

    budget.literal_mesh = Some(LiteralMesh { at_least: 1_000_000, ..mesh });
    let figures = measured.figures(&budget);
    let missed: Vec<_> = figures.iter().filter(|f| !f.holds).map(|f| f.name.as_str()).collect();
    assert_eq!(missed, ["budget.mps2-an386.literal_over_reduced"]);
}

/// Nine functions, each with its own cost; ours without double precision, libm's sine with it.
#[test]
fn the_elementary_functions_of_every_library_are_counted() {
    if runnable().is_none() {
        return;
    }
    let budget = Budget::read(BOARD).expect("the budget is sound");
    let functions = budget.elementary_functions.expect("the board has the program");
    let elf = firmware::build_program(BOARD, &functions.program).expect("the program builds").elf;
    let measured = functions.measure(&elf).expect("ours and libm's agree");
    assert_eq!(measured.len(), 9);
    let cycles = |name: &str, library: &str| {
        let found = measured.iter().find(|function| (function.name, function.origin) == (name, library));
        found.and_then(|function| function.counts.cycles).expect("it was counted").max
    };
    for name in ["sine_cosine", "square_root_or_zero", "one_minus_exp_neg"] {
        let [ours, theirs] = ["ours", "libm"].map(|library| cycles(name, library));
        assert!(ours > 10 && ours < theirs, "{name}: {ours}, libm {theirs}");
    }
    assert!(cycles("sine_cosine", "libm") > 10 * cycles("sine_cosine", "ours"));
    assert!(measured.iter().all(|function| function.code > 10 && function.error < 0.1), "{measured:?}");
}

/// QEMU's own log of every instruction executed, as its switches are called in this version.
fn log_switches(log: &Path, ranges: &str) -> Vec<String> {
    let version = setup::present_emulator(&setup::ThisHost).map(|found| found.version).unwrap_or_default();
    let old = ["7.", "8.0."].iter().any(|v| version.contains(&format!("version {v}")));
    let single: &[&str] = if old { &["-singlestep"] } else { &["-accel", "tcg,one-insn-per-tb=on"] };
    let log = log.display().to_string();
    let rest = ["-d", "exec,nochain", "-dfilter", ranges, "-D", &log];
    single.iter().chain(&rest).map(|s| (*s).to_owned()).collect()
}

/// The instructions of each call of `start`, from the addresses executed: a call ends where its caller goes on.
fn calls(addresses: &[u32], start: u32, next: &HashMap<u32, u32>) -> Vec<u64> {
    let mut calls = Vec::new();
    let mut open: Option<(u32, u64)> = None;
    for pair in addresses.windows(2) {
        if let Some((back, count)) = open.as_mut() {
            if pair[1] == *back {
                calls.push(*count);
                open = None;
            } else {
                *count += 1;
            }
        } else if pair[1] == start {
            open = Some((next[&pair[0]], 1));
        }
    }
    calls
}

#[test]
fn counts_agree_with_the_emulators_own_log() {
    const PERIODS: u32 = 10;
    let Some(elf) = runnable() else { return };
    let image = Image::read(&elf).expect("is readable");
    let handlers = image.vectors().expect("has vectors");
    let graph = CallGraph::of(&image, &handlers, &[]).expect("is closed");
    let step = image.find("control_step").expect("is linked");
    // Only the step, what it calls and who calls it: a log of the whole run takes gigabytes.
    let callers = (0..graph.nodes().len()).filter(|k| graph.callees(*k).any(|c| c == step[0]));
    let logged = graph.reachable(&step).into_iter().chain(callers).map(|k| &image.functions()[k]);
    let ranges: Vec<String> = logged.map(|f| format!("{:#x}+{:#x}", f.address, f.size)).collect();
    let folder = tempfile::tempdir().expect("a temporary directory");
    let log = folder.path().join("log.txt");
    let outcome = counted(&image, &step, PERIODS, &log_switches(&log, &ranges.join(",")));

    let text = std::fs::read_to_string(log).expect("the log is there");
    // `Trace 0: 0x7f97fc000100 [00800408/000000c0/00000110/ff020201] Reset`: the second is the address.
    let address = |line: &str| u32::from_str_radix(line.split_once('[')?.1.split('/').nth(1)?, 16).ok();
    let addresses: Vec<u32> = text.lines().filter(|l| l.starts_with("Trace")).filter_map(address).collect();
    let next = image.instructions().iter().map(|i| (i.address, i.next())).collect();
    let logged = calls(&addresses, image.functions()[step[0]].address, &next);

    let counts = outcome.counts[0].expect("was called");
    assert_eq!((logged.len(), counts.calls), (PERIODS as usize, u64::from(PERIODS)));
    assert_eq!(logged.iter().max(), Some(&counts.instructions.max));
    assert_eq!(logged.iter().min(), Some(&counts.instructions.min));
    let mean = logged.iter().sum::<u64>() as f64 / f64::from(PERIODS);
    assert_eq!(mean, counts.instructions.mean);
}
