//! `flash`: what is refused before anything is built, and what reaches the chip. probe-rs is a script that notes its arguments.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;

use strainwave_emulator::budget::Budget;
use strainwave_emulator::firmware;
use strainwave_emulator::setup::{self, ThisHost};

use crate::bench::{Answer, Bench, GEAR};

/// The real board.
const BOARD: &str = "stm32f405";

/// Notes its arguments, a line each time.
const NOTES: &str = "#!/bin/sh\necho \"$@\" >> calls\n";
/// Notes them, too, and has another chip in front of it.
const OTHER_CHIP: &str = "#!/bin/sh\necho \"$@\" >> calls\necho ' WARN slow' >&2\n\
    printf 'Error: Connecting to the chip was unsuccessful.\\n\\nCaused by:\\n    0: The part is another.\\n' >&2\nexit 1\n";
const NO_PROBE: &str = "#!/bin/sh\necho 'Error: No connected probes were found.' >&2\nexit 1\n";

/// The machine builds this board's images: a test installs no compiler.
fn builds(board: &str) -> bool {
    let target = firmware::target(board).unwrap();
    let present = setup::present_compiler(&ThisHost, &target).is_some();
    if !present {
        println!("skipped: no cross target");
    }
    present
}

/// The command on a machine with this probe-rs and without a fetched emulator: what is counted in it is another test's.
fn with_probe(bench: &Bench, words: &str, script: &str) -> Command {
    let bin = bench.path("bin");
    fs::create_dir_all(&bin).unwrap();
    fs::write(bin.join("probe-rs"), script).unwrap();
    fs::set_permissions(bin.join("probe-rs"), fs::Permissions::from_mode(0o755)).unwrap();
    let path = std::env::join_paths(
        [bin].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    );
    let mut command = bench.command(words);
    command.env("PATH", path.unwrap()).env("STRAINWAVE_CACHE", bench.path("no-cache"));
    command
}

fn flashed(bench: &Bench, words: &str, script: &str) -> Answer {
    Bench::answer(&mut with_probe(bench, words, script))
}

/// What the script has noted since it was last asked.
fn calls(bench: &Bench) -> Vec<String> {
    let text = fs::read_to_string(bench.path("calls")).unwrap_or_default();
    let _ = fs::remove_file(bench.path("calls"));
    text.lines().map(str::to_owned).collect()
}

#[test]
fn what_is_wrong_with_a_gear_file_is_told_as_by_check() {
    let bench = Bench::new();
    for (from, to) in [("ratio = 100", "ratio = 0"), ("k1_nm_per_rad = 3.1e4", "k1_nm_per_rad = 3.0")] {
        assert!(GEAR.contains(from));
        bench.write(
            "bad.toml",
            GEAR.replacen(from, to, 1).replacen("coulomb_nm = 0.035", "coulomb_nm = -1", 1),
        );
        let [check, flash] =
            ["check bad.toml", "flash bad.toml --board stm32f405"].map(|words| bench.run(words));
        assert_eq!((flash.code, flash.output.as_str()), (Some(2), ""), "{}", flash.error);
        assert!(
            flash.error.lines().count() > 0 && flash.error == check.error,
            "{}{}",
            flash.error,
            check.error
        );
    }
    bench.write("g.toml", GEAR.replacen("\"bliman_sorine_2\"", "\"lugre\"", 1));
    let line = bench.refused("flash g.toml --board stm32f405");
    assert!(
        line.starts_with("error: g.toml: friction.input.model = \"lugre\" is not in the firmware"),
        "{line}"
    );
}

#[test]
fn what_cannot_be_flashed_is_one_line() {
    let bench = Bench::new();
    bench.write("b.toml", "compiler = \"rustc 1\"\n");
    bench.write("late.toml", GEAR.replace("delay_periods = 2", "delay_periods = 4"));
    for (words, expected) in [
        (
            "flash g.toml --board nucleo",
            "board nucleo: unknown, the boards are mps2-an386, mps2-an500, mps2-an505, mps3-an547, nucleo-g474re, nucleo-h743zi, pico2, stm32f405",
        ),
        ("flash none.toml --board stm32f405", "none.toml: cannot be read: No such file"),
        ("flash g.toml", "the following required arguments were not provided: --board <BOARD>"),
        (
            "flash g.toml --board mps2-an386 --served",
            "--served: mps2-an386 is not flashed with a tuning link: no [served_image] in its budget, allowed: nucleo-g474re, nucleo-h743zi",
        ),
        (
            "flash g.toml --board stm32f405 --can 5",
            "--can: stm32f405 is not flashed as a node on CAN: no [can_image] in its budget, allowed: nucleo-g474re",
        ),
        ("flash g.toml --board nucleo-g474re --can 0", "invalid value '0' for '--can <NODE>'"),
        (
            "flash g.toml --board nucleo-g474re --can 5 --served",
            "the argument '--can <NODE>' cannot be used with '--served'",
        ),
        (
            "flash g.toml --board nucleo-g474re --drive odrive:0",
            "the following required arguments were not provided: --can <NODE>",
        ),
        (
            "flash g.toml --board nucleo-g474re --can 5 --drive odrive:63",
            "invalid value 'odrive:63' for '--drive <odrive:NODE>': allowed: odrive:0 to odrive:62",
        ),
        (
            "flash g.toml --board nucleo-g474re --can 5 --drive moteus:1",
            "invalid value 'moteus:1' for '--drive <odrive:NODE>': allowed: odrive:0 to odrive:62",
        ),
        (
            "flash late.toml --board stm32f405 --can 5 --drive odrive:0",
            "--drive: stm32f405 is not flashed with a drive on a second CAN bus: no [odrive_image] in its budget, allowed: nucleo-g474re",
        ),
        (
            "flash g.toml --board nucleo-g474re --can 5 --drive odrive:0",
            "g.toml: drive.delay_periods = 2, allowed with --drive: from 4 to 20",
        ),
        ("flash g.toml --board stm32f405 --budget none.toml", "none.toml: No such file"),
        ("flash g.toml --board stm32f405 --budget b.toml", "b.toml: line 1: missing field `headroom`"),
        ("flash g.toml --board stm32f405 --json g.toml", "g.toml: --json and GEAR.toml are the same file"),
        (
            "flash g.toml --board stm32f405 --json none/a",
            "none/a: cannot be written: there is no folder none",
        ),
    ] {
        let line = bench.refused(words);
        assert!(line.starts_with("error: ") && line.contains(expected), "{line}\n{expected}");
    }
}

#[test]
fn a_missing_probe_rs_is_told_before_anything_is_built() {
    let bench = Bench::new();
    let nothing = bench.path("nothing");
    fs::create_dir(&nothing).unwrap();
    let words = "flash g.toml --board stm32f405 --json out.json";
    let line = bench.refuses(words, bench.command(words).env("PATH", nothing));
    assert_eq!(
        line,
        "error: no probe-rs on PATH, which flashes this board's chip; install it: `cargo install probe-rs-tools --locked`"
    );
}

#[test]
fn the_image_of_the_gear_is_written_to_the_boards_chip_and_started() {
    if !builds(BOARD) {
        return;
    }
    let bench = Bench::new();
    let words = "flash g.toml --board stm32f405 --json out.json";
    let answer = flashed(&bench, words, NOTES);
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    let [download, reset] = &calls(&bench)[..] else { panic!("{}", answer.output) };
    let image = download.strip_prefix("download --chip STM32F405RG --verify ").expect("the chip is its own");
    assert_eq!(reset, "reset --chip STM32F405RG");
    assert_eq!(fs::read(image).unwrap()[..4], *b"\x7fELF");
    assert!(Path::new(image).starts_with(firmware::folder().join("target/images")), "{image}");
    assert!(answer.output.contains("not judged: ") && answer.output.contains("hd25-100 is on STM32F405RG"));
    let figures = bench.figures("out.json");
    for name in ["flash", "ram", "stack", "panics", "doubles"] {
        let name = format!("budget.{BOARD}.{name}");
        let figure = figures.iter().find(|figure| figure["name"] == *name).expect("it is judged");
        assert!(figure["bound"].is_number() && figure["holds"] == true, "{figure}");
    }

    // Another gear is another image; a dry run shows it, and needs no probe-rs.
    bench.write("g.toml", GEAR.replacen("coulomb_nm = 0.035", "coulomb_nm = 0.03", 1));
    let answer = Bench::answer(
        bench.command(&format!("{words} --dry-run")).env("STRAINWAVE_CACHE", bench.path("no-cache")),
    );
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(!answer.output.contains(image), "{}", answer.output);
    assert!(answer.output.ends_with("\nprobe-rs reset --chip STM32F405RG\n"), "{}", answer.output);
    assert!(calls(&bench).is_empty());
}

#[test]
fn the_image_with_the_tuning_link_is_judged_by_its_own_bounds() {
    if !builds(BOARD) {
        return;
    }
    let bench = Bench::new();
    let words = "flash g.toml --board stm32f405 --served --dry-run --json out.json";
    let answer = Bench::answer(bench.command(words).env("STRAINWAVE_CACHE", bench.path("no-cache")));
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.contains("/strainwave-stm32f405-served-"), "{}", answer.output);
    assert!(answer.output.ends_with("\nprobe-rs reset --chip STM32F405RG\n"), "{}", answer.output);
    let figures = bench.figures("out.json");
    let flash = figures.iter().find(|figure| figure["name"] == "budget.stm32f405.served_flash");
    let bound = Budget::read(BOARD).unwrap().served_image.unwrap().flash;
    assert!(
        flash.is_some_and(|flash| flash["bound"].as_f64() == bound.map(|bound| bound as f64)),
        "{flash:?}"
    );
}

#[test]
fn an_image_that_misses_its_budget_is_not_flashed() {
    if !builds(BOARD) {
        return;
    }
    let bench = Bench::new();
    let own = fs::read_to_string(firmware::folder().join(BOARD).join("budget.toml")).unwrap();
    let row = own.lines().find(|line| line.starts_with("flash = ")).unwrap();
    bench.write("tight.toml", own.replacen(row, "flash = 20000", 1));
    let words = "flash g.toml --board stm32f405 --budget tight.toml --json out.json";
    let answer = flashed(&bench, words, NOTES);
    assert_eq!(answer.code, Some(1), "{}", answer.error);
    let lines: Vec<_> = answer.error.lines().collect();
    assert!(lines[0].starts_with("missed: budget.stm32f405.flash is "), "{}", answer.error);
    assert!(
        lines[0].ends_with(" byte, bound 20000")
            && lines[1] == "not flashed; --force flashes it nevertheless"
    );
    assert_eq!((lines.len(), calls(&bench).len()), (2, 0), "{}", answer.error);
    let missed = bench.figures("out.json").into_iter().filter(|figure| figure["holds"] == false).count();
    assert_eq!(missed, 1);

    let answer = flashed(&bench, &format!("{words} --force"), NOTES);
    assert_eq!((answer.code, calls(&bench).len()), (Some(1), 2), "{}", answer.error);
}

#[test]
fn what_probe_rs_refuses_is_one_line() {
    if !builds(BOARD) {
        return;
    }
    let bench = Bench::new();
    for (script, expected, count) in [
        (
            OTHER_CHIP,
            "`probe-rs download` failed: Connecting to the chip was unsuccessful. Caused by: 0: The part is another.",
            1,
        ),
        (
            NO_PROBE,
            "no debug probe is connected (No connected probes were found.); connect the board's: `probe-rs list` shows it",
            0,
        ),
    ] {
        let answer = flashed(&bench, "flash g.toml --board stm32f405 --json out.json", script);
        assert_eq!((answer.code, answer.error), (Some(2), format!("error: {expected}\n")));
        assert_eq!(calls(&bench).len(), count, "it is not started");
        assert!(!bench.path("out.json").exists());
    }
}

#[test]
fn an_emulated_board_controls_the_joint_for_a_second() {
    if setup::present_emulator(&ThisHost).is_none() || !builds("mps2-an386") {
        println!("skipped: no emulator or cross target");
        return;
    }
    let bench = Bench::new();
    let answer = bench.run("flash g.toml --board mps2-an386 --json out.json");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    let figures = bench.figures("out.json");
    let value = |name: &str| {
        let found = figures.iter().find(|figure| figure["name"] == *name);
        found.unwrap_or_else(|| panic!("{name}: {}", answer.output))["value"].as_f64().unwrap()
    };
    assert_eq!(value("flash.mps2-an386.active"), 10_000.0);
    assert_eq!(value("flash.mps2-an386.faults"), 0.0);
    assert_eq!(value("flash.mps2-an386.steps_unlike_host"), 0.0);
    assert!(value("flash.mps2-an386.error.max") < 0.01);
    let cycles = figures.iter().find(|figure| figure["name"] == "budget.mps2-an386.control_step.cycles_max");
    assert!(cycles.is_some_and(|figure| figure["bound"].is_number()), "{}", answer.output);
}

/// Its cycles are those of the emulated board with the same core.
#[test]
fn the_control_step_of_a_real_board_is_counted_on_another() {
    if setup::present_emulator(&ThisHost).is_none() || !builds(BOARD) {
        println!("skipped: no emulator or cross target");
        return;
    }
    let bench = Bench::new();
    let answer = bench.run("flash g.toml --board stm32f405 --dry-run --json out.json");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.contains("in S1, S3, S5, on mps2-an386\n"), "{}", answer.output);
    let figures = bench.figures("out.json");
    let cycles = figures.iter().find(|figure| figure["name"] == "budget.stm32f405.control_step.cycles_max");
    let cycles = cycles.unwrap_or_else(|| panic!("{}", answer.output));
    assert!(cycles["value"].as_f64() > Some(500.0), "{cycles}");
    let bound = Budget::read(BOARD).unwrap().control_step.cycles.unwrap();
    assert_eq!(cycles["bound"].as_f64(), Some(bound as f64), "{cycles}");
}
