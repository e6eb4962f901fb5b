//! Bad input through the real command: exit code 2, one line that names the thing, nothing written.

use crate::bench::{Bench, GEAR, INPUT, LOG};

const SIM: &str = "sim --gear g.toml --input in.csv --output out.csv --json out.json";

#[test]
fn bad_gear_files_are_refused_by_key() {
    let bench = Bench::new();
    for (from, to, expected) in [
        (
            "ratio = 100",
            "ratio = 0",
            "g.toml: gear.ratio = 0 is out of range; allowed: a whole number from 30 to 320",
        ),
        (
            "ratio = 100",
            "ratio = 100.5",
            "g.toml: gear.ratio = 100.5 is a number with a fraction; allowed: a whole",
        ),
        ("ratio = 100\n", "", "g.toml: missing key gear.ratio; allowed: a whole number from 30 to 320"),
        (
            "ratio = 100",
            "ratoi = 100",
            "g.toml: unknown key gear.ratoi = 100; the nearest known key is gear.ratio",
        ),
        (
            "k2_nm_per_rad = 5.0e4",
            "k2_nm_per_rad = -1",
            "g.toml: stiffness.k2_nm_per_rad = -1 is out of range",
        ),
        (
            "k2_nm_per_rad = 5.0e4",
            "k2_nm_per_rad = nan",
            "g.toml: stiffness.k2_nm_per_rad = nan is out of range",
        ),
        (
            "k2_nm_per_rad = 5.0e4",
            "k2_nm_per_rad = inf",
            "g.toml: stiffness.k2_nm_per_rad = inf is out of range",
        ),
        (
            "k2_nm_per_rad = 5.0e4",
            "k2_nm_per_rad = 2e4",
            "g.toml: stiffness.k2_nm_per_rad = 20000 is out of range",
        ),
        (
            "k1_nm_per_rad = 3.1e4",
            "k1_nm_per_rad = 0",
            "g.toml: stiffness.k1_nm_per_rad = 0 is out of range; allowed: a number from 1 to",
        ),
        (
            "t2_nm = 48.0",
            "t2_nm = 14.0",
            "g.toml: stiffness.t2_nm = 14 is out of range; allowed: more than stiffness.t1_nm = 14",
        ),
        (
            "t2_nm = 48.0",
            "t2_nm = 9.0",
            "g.toml: stiffness.t2_nm = 9 is out of range; allowed: more than stiffness.t1_nm = 14",
        ),
        (
            "length_m = 0.037",
            "length_m = 0",
            "g.toml: flexspline.length_m = 0 is out of range; allowed: a number from 0.002 to 1 m",
        ),
        (
            "wall_m = 0.40e-3",
            "wall_m = -0.40e-3",
            "g.toml: flexspline.wall_m = -0.0004 is out of range; allowed: a number from 1e-5 to 0.01 m",
        ),
        (
            "wall_m = 0.40e-3",
            "wall_m = \"thin\"",
            "g.toml: flexspline.wall_m = \"thin\" is text; allowed: a number",
        ),
        (
            "output_torque = false",
            "output_torque = 0",
            "g.toml: sensors.output_torque = 0 is a whole number; allowed: true",
        ),
        (
            "model = \"bliman_sorine_2\"",
            "model = \"lugree\"",
            "g.toml: friction.input.model = \"lugree\" is out of range; allowed: \"coulomb\" or \"viscous\" or",
        ),
        (
            "model = \"bliman_sorine_2\"",
            "model = \"karnopp\"",
            "g.toml: missing key friction.input.dead_band_rad_per_s, which friction.input.model = \"karnopp\" needs; \
             allowed: a number from 1e-9 to 10000 rad/s",
        ),
        (
            "coulomb_nm = 0.035",
            "coulomb_nm = -0.035",
            "g.toml: friction.input.coulomb_nm = -0.035 is out of range; allowed: a number from 0 to 1000 N m",
        ),
        (
            "coulomb_nm = 0.035",
            "coulomb_nm = 0.06",
            "g.toml: friction.input.static_nm = 0.05 is out of range; allowed: at least friction.input.coulomb_nm = 0.06",
        ),
        (
            "stribeck_rad_per_s = 2.0",
            "stribeck_rad_per_s = 0",
            "g.toml: friction.input.stribeck_rad_per_s = 0 is out of range; allowed: a number from 1e-9 to",
        ),
        (
            "presliding_ratio = 0.3",
            "presliding_ratio = 1.5",
            "g.toml: friction.input.presliding_ratio = 1.5 is out of range; allowed: a number from 0.01 to 0.99",
        ),
        (
            "presliding_ratio = 0.3",
            "presliding_ratio = 0.3\nload_driven = -0.1",
            "g.toml: friction.input.load_driven = -0.1 is out of range; allowed: a number from 0 to 10",
        ),
        (
            "presliding_ratio = 0.3",
            "presliding_ratio = 0.3\nripple_sines = [0.7, 0.7]",
            "g.toml: friction.input.ripple_cosines is out of range; allowed: with ripple_sines amplitudes",
        ),
        (
            "presliding_ratio = 0.3",
            "presliding_ratio = 0.3\nripple_sines = [0.1, 0.1, 0.1]",
            "g.toml: friction.input.ripple_sines has 3 entries; allowed: a list of 1 to 2 numbers from -0.99 to 0.99",
        ),
        (
            "model = \"bliman_sorine_2\"",
            "model = \"state_space\"\nstate_space = [{ a_per_rad = [1.0], b_per_rad = 1, c_nm = 1 }]",
            "g.toml: friction.input.state_space is out of range; allowed: 1 to 4 states",
        ),
        (GEAR, "", "g.toml: missing key gear.name; allowed: text of 1 to 80 characters"),
        (GEAR, "gear: {ratio: 100}", "g.toml: line 1: not TOML: "),
        (GEAR, INPUT, "g.toml: line 1: not TOML: "),
    ] {
        assert!(GEAR.contains(from));
        bench.write("g.toml", GEAR.replacen(from, to, 1));
        let line = bench.refused(SIM);
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
    bench.write("g.toml", b"\xff\xfe");
    assert_eq!(bench.refused(SIM), "error: g.toml: line 1: not TOML: not UTF-8 text");
}

#[test]
fn bad_inputs_are_refused_by_row_and_column() {
    let bench = Bench::new();
    for (from, to, expected) in [
        (INPUT, "", "in.csv: empty file"),
        (INPUT, "t_s,theta_wg_rad,tau_load_nm\n", "in.csv: no rows after the header"),
        ("0.1,-50", ",-50", "in.csv: row 3, column theta_wg_rad: no value (a gap)"),
        ("0.1,-50", "0.1,nan", "in.csv: row 3, column tau_load_nm: \"nan\" is out of range"),
        ("0.1,-50", "0.1,inf", "in.csv: row 3, column tau_load_nm: \"inf\" is out of range"),
        ("0.1,-50", "0.1,heavy", "in.csv: row 3, column tau_load_nm: \"heavy\" is not a number"),
        ("0.1,-50", "0.1,-50,1", "in.csv: row 3, column 4: \"1\" has no name in the header"),
        ("0.1,-50\n", "0.1,-50\n\n", "in.csv: row 4: empty (a gap)"),
        (
            "0.002",
            "-0.002",
            "in.csv: row 4, column t_s: time -0.002 does not come after 0.001, the row before",
        ),
        ("0.002", "0.102", "in.csv: row 4, column t_s: a gap of 0.101000 s before this row"),
        (
            "tau_load_nm",
            "tau_load",
            "in.csv: row 1, column \"tau_load\": unknown; known columns are t_s, theta_wg_rad",
        ),
        (",tau_load_nm", "", "in.csv: row 1, column tau_load_nm: missing"),
        (
            "theta_wg_rad,",
            "theta_wg_rad,omega_wg_rad_s,",
            "in.csv: row 1, column omega_wg_rad_s: only one of",
        ),
    ] {
        assert!(INPUT.contains(from));
        bench.write("in.csv", INPUT.replacen(from, to, 1));
        let line = bench.refused(SIM);
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("folder")).unwrap();
    bench.write("log.csv", LOG);
    for (words, expected) in [
        (SIM.replace("g.toml", "none.toml"), "none.toml: cannot be read: No such file"),
        (SIM.replace("g.toml", "folder"), "folder: cannot be read: it is a folder"),
        (SIM.replace("in.csv", "none.csv"), "none.csv: cannot be read: No such file"),
        (SIM.replace("in.csv", "folder"), "folder: cannot be read: it is a folder"),
        (SIM.replace("out.csv", "none/out.csv"), "none/out.csv: cannot be written: there is no folder none"),
        (SIM.replace("out.csv", "folder"), "folder: cannot be written: it is a folder"),
        (
            SIM.replace("out.json", "none/out.json"),
            "none/out.json: cannot be written: there is no folder none",
        ),
        ("pil --gear none.toml".into(), "none.toml: cannot be read: No such file"),
        ("pil --gear g.toml --replay none.csv".into(), "none.csv: cannot be read: No such file"),
        ("pil --gear g.toml --replay in.csv".into(), "in.csv: row 1, column \"theta_wg_rad\": unknown"),
        ("pil --json none/out.json".into(), "none/out.json: cannot be written: there is no folder none"),
        (
            "pil --gear g.toml --replay log.csv --json none/out.json".into(),
            "none/out.json: cannot be written: there is no folder none",
        ),
        ("pil --json folder".into(), "folder: cannot be written: it is a folder"),
        ("pil --keep folder".into(), "folder: cannot be written: it is a folder"),
        ("pil --keep none/kept.toml".into(), "none/kept.toml: cannot be written: there is no folder none"),
        (
            "pil --gear g.toml --keep in.csv/g.toml".into(),
            "in.csv/g.toml: cannot be written: there is no folder in.csv",
        ),
        ("pil --plots in.csv".into(), "in.csv: is a file; a folder is needed"),
        ("pil --plots in.csv/out".into(), "in.csv/out: cannot be written: there is no folder in.csv"),
        ("report --json none/out.json".into(), "none/out.json: cannot be written: there is no folder none"),
        ("report --gear none.toml".into(), "none.toml: cannot be read: No such file"),
        ("report --gear in.csv".into(), "in.csv: line 1: not TOML"),
        ("report --output folder".into(), "folder: cannot be written: it is a folder"),
        ("report --output in.csv/report.html".into(), "in.csv: is a file; a folder is needed"),
        ("budget --json none/out.json".into(), "none/out.json: cannot be written: there is no folder none"),
        ("verify --json none/out.json".into(), "none/out.json: cannot be written: there is no folder none"),
    ] {
        let line = bench.refused(&words);
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
}

#[test]
fn meshes_steps_and_gauges_that_there_are_not_are_refused_by_value() {
    let bench = Bench::new();
    let sizes = "8x3, 12x3, 16x4, 24x4, 36x4, 36x6, 48x6, 72x8";
    let mesh = |value: &str| format!("invalid value '{value}' for '--mesh <NxM>'");
    let gauge = |value: &str| format!("invalid value '{value}' for '--gauge <I,J,AROUND,ALONG>'");
    let stable = "is out of range; allowed: from 1e-9 s to below";
    for (words, expected) in [
        ("--mesh 3x4", format!("{}: n = 3 is out of range; allowed: 4 nodes around or more", mesh("3x4"))),
        ("--mesh -8x4", format!("{}: n = -8 is out of range; allowed: 4 nodes", mesh("-8x4"))),
        ("--mesh 8x1", format!("{}: m = 1 is out of range; allowed: 2 nodes along the axis", mesh("8x1"))),
        ("--mesh 37x4", format!("{}: not compiled in; allowed: {sizes}", mesh("37x4"))),
        ("--mesh fine", format!("{}: not NxM; allowed: {sizes}", mesh("fine"))),
        (
            "--step 1e-5",
            format!("--step 1e-5 {stable} 1.976e-6 s, the stable step of the 36x4 mesh of g.toml"),
        ),
        (
            "--step 5.2e-6 --mesh 8x3",
            format!("--step 5.2e-6 {stable} 5.116e-6 s, the stable step of the 8x3"),
        ),
        ("--step 0", format!("--step 0e0 {stable}")),
        ("--step -1e-6", format!("--step -1e-6 {stable}")),
        ("--step nan", format!("--step NaN {stable}")),
        ("--step inf", format!("--step inf {stable}")),
        ("--step 1e-300", format!("--step 1e-300 {stable}")),
        ("--step short", "invalid value 'short' for '--step <SECONDS>'".into()),
        ("--build realtime --mesh 8x3", "--mesh 8x3 is for --build reference".into()),
        ("--build realtime --step 1e-6", "--step 1e-6 is for --build reference".into()),
        ("--gauge 36,0,1,1", "--gauge 36,0,1,1: i = 36 is out of range; allowed: 0 to 35 on the 36x4".into()),
        ("--gauge 0,4,1,0", "--gauge 0,4,1,0: j = 4 is out of range; allowed: 0 to 3 on the 36x4".into()),
        ("--gauge 0,3,0,1", "--gauge 0,3,0,1: j + along = 4 is out of range; allowed: 0 to 3".into()),
        (
            "--build realtime --gauge 8,0,1,1",
            "--gauge 8,0,1,1: i = 8 is out of range; allowed: 0 to 7".into(),
        ),
        ("--gauge -1,0,1,1", format!("{}: I = -1 is out of range; allowed: 0 or more", gauge("-1,0,1,1"))),
        ("--gauge 0,0,3,0", format!("{}: direction 3,0 is out of range; allowed", gauge("0,0,3,0"))),
        ("--gauge 0,0", format!("{}: not I,J,AROUND,ALONG; allowed: four whole", gauge("0,0"))),
        ("--gauge 0,0,1,1 --gauge 0,0,1,1", "--gauge 0,0,1,1: stands there twice".into()),
    ] {
        let line = bench.refused(&format!("{SIM} {words}"));
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
}

#[test]
fn a_run_that_diverges_names_time_and_node_and_writes_nothing() {
    let bench = Bench::new();
    let words = format!("{SIM} --mesh 8x3 --gauge 0,0,1,1");
    for (rows, time) in [
        // A hundred radians from one row to the next, and a load that no cup carries.
        ("0,0,0\n0.001,0,0\n0.0011,100,0\n0.002,100,0\n", "0.0011"),
        ("0,0,0\n0.001,0,0\n0.0011,1e6,0\n0.002,1e6,0\n", "0.0010"),
        ("0,0,0\n0.001,0,-1e6\n0.002,0,-1e6\n0.02,0,-1e6\n", "0.00"),
    ] {
        bench.write("in.csv", format!("t_s,theta_wg_rad,tau_load_nm\n{rows}"));
        let line = bench.refused(&words);
        assert!(line.starts_with(&format!("error: out.csv: not written: diverged at {time}")), "{line}");
        assert!(
            line.contains(" s: a link of node (i, j) = (") && line.ends_with("allowed: 0.1 either way"),
            "{line}"
        );
    }
    // What was written before stays.
    bench.write("out.csv", "earlier");
    bench.refused(&words);
    assert_eq!(bench.files()[&bench.path("out.csv")], b"earlier");
}

#[test]
fn logs_that_cannot_be_replayed_are_refused_before_anything_is_built() {
    let bench = Bench::new();
    let replay = "pil --gear g.toml --replay log.csv --json out.json";
    for (from, to, expected) in [
        (
            ",theta_out_rad",
            ",tau_out_nm",
            "log.csv: column theta_out_rad is missing; a replay compares with it",
        ),
        (LOG, "", "log.csv: empty file"),
        ("tau_motor_nm", "current_a", "log.csv: row 1, column \"current_a\": unknown"),
        ("0.004,", "0.004,x", "log.csv: row 3, column theta_motor_rad: \"x0.0\" is not a number"),
        ("0.004,", "0.004,nan", "log.csv: row 3, column theta_motor_rad: \"nan0.0\" is not a number"),
        ("0.004,", "0,", "log.csv: row 3, column t_s: time 0 does not come after 0, the row before"),
        ("0.092,", "9,", "log.csv: row 25, column t_s: a gap of 8.912000 s before this row"),
    ] {
        assert!(LOG.contains(from));
        bench.write("log.csv", LOG.replacen(from, to, 1));
        let line = bench.refused(replay);
        assert!(line.starts_with(&format!("error: {expected}")), "{line}\n{expected}");
    }
    bench.write("log.csv", LOG);
    bench.write("g.toml", GEAR.replacen("ratio = 100", "ratio = 0", 1));
    let line = bench.refused(replay);
    assert!(line.starts_with("error: g.toml: gear.ratio = 0 is out of range"), "{line}");
}

#[test]
fn boards_that_are_not_there_or_cannot_be_run_are_refused_by_name() {
    let bench = Bench::new();
    let unknown = "unknown, the boards are mps2-an386, mps2-an500, mps2-an505, mps3-an547, nucleo-g474re, nucleo-h743zi, pico2, stm32f405";
    for (words, expected) in [
        ("pil --board nucleo", format!("board nucleo: {unknown}")),
        ("pil --board ../boards/app", format!("board ../boards/app: {unknown}")),
        ("budget --board nucleo", format!("board nucleo: {unknown}")),
        (
            "pil --board stm32f405",
            "board stm32f405: the emulator has no such machine, the boards that it has are mps2-an386, mps2-an500, mps2-an505, mps3-an547"
                .into(),
        ),
    ] {
        assert_eq!(bench.refused(words), format!("error: {expected}"));
    }
}

#[test]
fn a_friction_model_that_the_firmware_does_not_have_is_refused_by_pil() {
    let bench = Bench::new();
    bench.write("g.toml", GEAR.replacen("\"bliman_sorine_2\"", "\"lugre\"", 1));
    bench.write("log.csv", LOG);
    for words in ["pil --gear g.toml", "pil --gear g.toml --replay log.csv --json out.json"] {
        assert_eq!(
            bench.refused(words),
            "error: g.toml: friction.input.model = \"lugre\" is not in the firmware; allowed there: \"bliman_sorine_1\" \
             or \"bliman_sorine_2\""
        );
    }
}

#[test]
fn a_missing_emulator_with_no_way_to_fetch_it_is_one_line() {
    let bench = Bench::new();
    let nothing = bench.path("nothing");
    std::fs::create_dir(&nothing).unwrap();
    for words in ["pil", "pil --scenario all --json out.json"] {
        let mut command = bench.command(words);
        let line = bench.refuses(words, command.env("PATH", &nothing).env("STRAINWAVE_CACHE", &nothing));
        let expected = "error: no qemu-system-arm 7.2 or newer on PATH: there is no apt-get to fetch it with; install it: ";
        assert!(line.starts_with(expected), "{line}");
        for manager in ["dnf install", "pacman -S", "brew install", "zypper install"] {
            assert!(line.contains(manager), "{line}");
        }
    }
}

#[test]
fn one_file_in_two_places_is_refused() {
    let bench = Bench::new();
    for (from, to) in
        [("out.csv", "in.csv"), ("out.csv", "./g.toml"), ("out.json", "out.csv"), ("in.csv", "g.toml")]
    {
        let line = bench.refused(&SIM.replace(from, to));
        assert!(line.ends_with("are the same file"), "{line}");
    }
    let line = bench.refused("pil --keep kept.toml --json ./kept.toml");
    assert!(line.ends_with("kept.toml: --json and --keep are the same file"), "{line}");
}

#[test]
fn mistakes_on_the_command_line_are_one_line_too() {
    let bench = Bench::new();
    for (words, expected) in [
        ("", "error: no subcommand was given"),
        ("simulate", "error: unrecognized subcommand 'simulate'"),
        ("sim --gear g.toml", "error: the following required arguments were not provided: --input <IN.csv>"),
        ("sim --gears g.toml", "error: unexpected argument '--gears' found"),
        ("sim --gear", "error: a value is required for '--gear <G.toml>' but none was supplied"),
        ("verify everything", "error: invalid value 'everything' for '[PART]'"),
        ("verify robustness --row nothing", "error: invalid value 'nothing' for '--row <NAME>'"),
        ("pil --scenario S9", "error: invalid value 'S9' for '--scenario <S1..S6|all>'"),
        ("pil --seed -1", "error: unexpected argument '-1' found"),
        ("pil --seed many", "error: invalid value 'many' for '--seed <SEED>'"),
        ("pil --replay in.csv", "error: the following required arguments were not provided: --gear <G.toml>"),
        (
            "pil --gear g.toml --replay in.csv --keep kept.toml",
            "error: the argument '--replay <LOG.csv>' cannot be used with '--keep <KEPT.toml>'",
        ),
        (
            "pil --scenario all --keep kept.toml",
            "error: --keep with --scenario all: what is learnt is of one plant;",
        ),
        (
            "pil --scenario S4 --sensors both --keep kept.toml",
            "error: --keep with --scenario S4 --sensors both: there the kinematic error",
        ),
        (&format!("{SIM} --build fast"), "error: invalid value 'fast' for '--build <BUILD>'"),
    ] {
        let line = bench.refused(words);
        assert!(line.starts_with(expected), "{line}\n{expected}");
    }
}

#[test]
fn a_refused_run_keeps_the_output_of_an_earlier_one() {
    let bench = Bench::new();
    assert_eq!(bench.run(&format!("{SIM} --build realtime")).code, Some(0));
    bench.write("in.csv", INPUT.replace("0.2,", "x,"));
    bench.refused(SIM);
    assert!(bench.files().keys().any(|path| path.ends_with("out.csv")));
}
