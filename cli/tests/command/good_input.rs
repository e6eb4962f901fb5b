//! The command when all is well: outputs, help and exit codes.

use strainwave::friction::{ModelName, Standstill};
use strainwave_desktop::GearFile;
use strainwave_desktop::io::gear_file::{Friction, StateRow};
use strainwave_desktop::plant::STEP_SHARE;
use strainwave_desktop::plant::mesh_size::MeshSize;

use crate::bench::Bench;

const SIM: &str = "sim --gear g.toml --input in.csv --output out.csv --json out.json --build";

const HEADER: &str = "t_s,theta_fs_rad,omega_fs_rad_s,tau_wg_nm,torsion_rad,tau_t_nm";

fn rows(bench: &Bench, header: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(bench.path("out.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(header));
    lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[test]
fn both_builds_write_a_row_every_tenth_of_a_millisecond() {
    let bench = Bench::new();
    for build in ["reference", "realtime"] {
        let answer = bench.run(&format!("{SIM} {build}"));
        assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
        let rows = rows(&bench, HEADER);
        let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
        let expected: Vec<f64> = (0..=20).map(|k| f64::from(k) / 10_000.0).collect();
        assert_eq!(times, expected);
        // The load pulls the output backwards, which winds the flexspline up.
        assert!(rows[20][1] < 0.0 && rows[20][4] > 0.0, "{:?}", rows[20]);
    }
}

/// The mesh and step asked for are run, and each gauge has its column.
#[test]
fn meshes_steps_and_gauges_are_of_choice() {
    let bench = Bench::new();
    let header = format!("{HEADER},strain_0_0_1_1,strain_3_1_-1_-1");
    let gauges = "--gauge 0,0,1,1 --gauge 3,1,-1,-1";
    let mut torsions = Vec::new();
    for options in ["reference --mesh 8x3", "reference --mesh 8x3 --step 1e-6", "reference", "realtime"] {
        let answer = bench.run(&format!("{SIM} {options} {gauges}"));
        assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{options}");
        let rows = rows(&bench, &header);
        assert!(rows.iter().all(|row| row.len() == 8 && row[6..].iter().all(|strain| strain.abs() < 0.01)));
        torsions.push(rows[20][4]);
    }
    for (index, torsion) in torsions.iter().enumerate() {
        assert!((torsion - torsions[0]).abs() < 2e-6, "{torsions:?}");
        assert!(!torsions[..index].contains(torsion), "each build has its own digits: {torsions:?}");
    }
}

/// The default gear with a friction model on both sides, and the keys that one or the other needs besides.
fn gear_with(model: ModelName) -> String {
    let mut gear = GearFile::default_gear();
    for side in [&mut gear.friction.input, &mut gear.friction.output] {
        let rate = 1.0 / side.presliding.unwrap();
        *side = Friction {
            model,
            dead_band: Some(0.02),
            frictional_memory: Some(1e-3),
            dwell: Some(1.0),
            // Without it LuGre is the first order of Bliman and Sorine.
            micro_damping: side.viscous,
            state_space: Some(vec![
                StateRow { a: vec![-rate, rate], b: 2.0 * rate, c: side.coulomb.unwrap() },
                StateRow { a: vec![-rate, -rate], b: 0.0, c: 0.0 },
            ]),
            ..side.clone()
        };
    }
    gear.to_toml()
}

#[test]
fn sim_runs_with_every_friction_model_and_each_is_another() {
    let bench = Bench::new();
    let mut seen: Vec<(&str, Vec<Vec<f64>>)> = Vec::new();
    bench.write("in.csv", "t_s,theta_wg_rad,tau_load_nm\n0,0,0\n0.01,0.1,-5\n0.02,0.1,-5\n0.03,0.099,5\n");
    for model in ModelName::ALL {
        bench.write("g.toml", gear_with(*model));
        for build in ["realtime", "reference"] {
            let answer = bench.run(&format!("{SIM} {build}"));
            assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", model.word());
            let rows = rows(&bench, HEADER);
            assert_eq!(rows.len(), 301);
            assert!(rows.iter().flatten().all(|number| number.is_finite()), "{}", model.word());
            for (name, others) in &seen {
                assert!(*others != rows, "{name} and {} are one", model.word());
            }
            seen.push((model.word(), rows));
        }
        // The builds tell the same.
        let [(_, real_time), (_, reference)] = &seen[seen.len() - 2..] else { unreachable!() };
        for (one, other) in real_time.iter().zip(reference) {
            assert!((one[4] - other[4]).abs() < 2e-6, "{}: {} {}", model.word(), one[4], other[4]);
        }
    }
}

/// Half a newton metre on an output that breaks away at 1 (Coulomb) or 1.3 (static).
#[test]
fn static_friction_holds_at_rest_presliding_gives_way_and_the_rest_slides() {
    let bench = Bench::new();
    bench.write("in.csv", "t_s,theta_wg_rad,tau_load_nm\n0,0,0.5\n0.02,0,0.5\n");
    for model in ModelName::ALL {
        bench.write("g.toml", gear_with(*model));
        let answer = bench.run(&format!("{SIM} realtime"));
        assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", model.word());
        let moved = rows(&bench, HEADER).iter().map(|row| row[1].abs()).fold(0.0, f64::max);
        let name = model.word();
        match model.standstill() {
            Standstill::Static => assert!(moved == 0.0, "{name} held: {moved}"),
            Standstill::Jump => assert!(moved > 0.0, "{name} chatters: {moved}"),
            // The spring of the gear alone.
            Standstill::Free => assert!(moved > 2.5e-5, "{name} let go: {moved}"),
            Standstill::Presliding => assert!(moved > 1e-5 && moved < 2.5e-5, "{name} gave way: {moved}"),
        }
    }
}

#[test]
fn the_report_is_one_page_that_needs_nothing_else() {
    let bench = Bench::new();
    let answer = bench.run("report --json out.json");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    let page = std::fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
    for title in [
        "The mesh",
        "Two links: eq. (1)",
        "Torque over torsion",
        "Strain at a gauge",
        "Mesh sizes",
        "Hysteresis curve",
        "Relay and weights",
        "Level over speed",
        "Presliding: reversals that grow",
        "Stick-slip",
        "Figures with their bounds",
        "The paper's table",
        "Held: stiffness and hysteresis",
        "Moving: friction and kinematic error",
    ] {
        assert!(page.contains(&format!("<h3>{title}")), "{title}");
    }
    let figures = (1..=9).map(|number| format!("fig-{number}"));
    let scenarios = (1..=7).map(|number| format!("s{number}"));
    for anchor in figures.chain(scenarios).chain(["table-1".into(), "picture".into()]) {
        assert_eq!(page.matches(&format!("id=\"{anchor}\"")).count(), 1, "{anchor}");
    }
    for model in ModelName::WORDS {
        assert!(
            page.matches(&format!("\n{model}\n</text>")).count() >= 2,
            "{model} is drawn on both motions"
        );
    }
    // The picture's data and its script stand in the page; the arrows of a diagram name a mark within it.
    assert_eq!(page.matches("<script").count(), 2);
    for outside in [
        "<link",
        "<img",
        "<iframe",
        " src=",
        "@import",
        "fetch(",
        "XMLHttpRequest",
        "importScripts",
        "import(",
    ] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert_eq!(page.matches("url(").count(), page.matches("url(#tip)").count());
    let elsewhere =
        page.matches("http").count() - page.matches("xmlns=\"http://www.w3.org/2000/svg\"").count();
    assert_eq!(elsewhere, 0, "the page names an address");
    let (before, script) = page.split_once("<script").unwrap();
    let drawn = [before, script.rsplit_once("</script>").unwrap().1].concat();
    assert!(drawn.matches("<svg").count() >= 6 && !drawn.contains("NaN") && !drawn.contains("inf"));
    let text = std::fs::read_to_string(bench.path("out.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let figures = json["figures"].as_array().unwrap();
    assert!(!figures.is_empty());
    for figure in figures {
        assert!(page.contains(&format!("<td>{}</td>", figure["name"].as_str().unwrap())), "{figure}");
    }
    let left: Vec<_> = std::fs::read_dir(bench.path("out")).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
}

#[test]
fn figures_are_printed_and_written() {
    let bench = Bench::new();
    let answer = bench.run(&format!("{SIM} realtime"));
    assert!(
        answer
            .output
            .lines()
            .next()
            .unwrap()
            .split_whitespace()
            .eq(["name", "value", "unit", "bound", "holds"])
    );
    let text = std::fs::read_to_string(bench.path("out.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let figures = json["figures"].as_array().unwrap();
    assert_eq!(figures.len() + 1, answer.output.lines().count());
    for (figure, line) in figures.iter().zip(answer.output.lines().skip(1)) {
        let keys: Vec<_> = figure.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(keys, ["bound", "holds", "name", "unit", "value"]);
        assert_eq!(line.split_whitespace().next(), figure["name"].as_str());
        assert!(figure["value"].is_number() && figure["holds"] == true);
    }
    assert_eq!(figures.iter().find(|figure| figure["name"] == "sim.rows").unwrap()["value"], 21.0);
}

#[test]
fn verify_measures_the_part_asked_for() {
    // The one part that neither boots an image nor looks at the clock.
    let answer = Bench::new().run("verify compensator --samples 1 --box 1");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
    let figures: Vec<_> = answer.output.lines().skip(1).collect();
    assert!(!figures.is_empty());
    assert!(
        figures.iter().all(|line| !line.starts_with("friction.") && !line.contains(" NO ")),
        "{figures:?}"
    );
}

#[test]
fn bench_times_every_kernel_and_judges_none() {
    let bench = Bench::new();
    let answer = bench.run("bench --rounds 2 --json out.json");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    let kernels: Vec<_> =
        answer.output.lines().skip(1).filter_map(|line| line.split_whitespace().next()).collect();
    assert!(["floor", "observer.step", "compensator.control"].iter().all(|name| kernels.contains(name)));
    let figures = bench.figures("out.json");
    assert_eq!(figures.len(), 6 * kernels.len());
    assert!(figures.iter().all(|figure| figure["bound"].is_null() && figure["value"].as_f64() > Some(0.0)));
    assert!(bench.refused("bench --rounds 0").contains("0 is not in 1..=1000000"));
    // Before anything is measured.
    let refused = bench.refused("bench --rounds 1000000 --identify none.csv --json none.json");
    assert!(refused.contains("none.csv: cannot be read"), "{refused}");
}

#[test]
fn verify_robustness_has_one_line_a_row() {
    let bench = Bench::new();
    let answer =
        bench.run("verify robustness --row box --row encoder.interpolation --seeds 1 --json out.json");
    let rows: Vec<_> =
        answer.output.lines().filter_map(|line| line.split_whitespace().next()).take(3).collect();
    assert_eq!(rows, ["row", "box", "encoder.interpolation"], "{}", answer.error);
    let text = std::fs::read_to_string(bench.path("out.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let figures = json["figures"].as_array().unwrap();
    for name in ["robustness.box.motor.shakes", "robustness.encoder.interpolation.both.s4.error"] {
        let figure = figures.iter().find(|figure| figure["name"] == name);
        assert!(figure.is_some_and(|figure| figure["bound"].is_number()), "{name}");
    }
    assert_eq!(answer.code == Some(0), figures.iter().all(|figure| figure["holds"] == true));
}

#[test]
fn the_help_of_sim_says_what_there_is() {
    let help = Bench::new().run("sim --help").output;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    let meshes = format!("One of {}.", MeshSize::names());
    let step = format!("(s); {STEP_SHARE} of the mesh's stable step when left out");
    let default = format!("{} when left out", MeshSize::DEFAULT);
    for expected in [meshes, step, default, "strain_I_J_AROUND_ALONG".into(), "diverges".into()] {
        assert!(help.contains(&expected), "{expected}\n{help}");
    }
}

#[test]
fn every_subcommand_has_help() {
    let bench = Bench::new();
    let answer = bench.run("--help");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
    let commands = answer.output.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names: Vec<_> =
        commands.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).collect();
    assert!(["sim", "verify", "report"].iter().all(|name| names.contains(name)), "{names:?}");
    for name in names.into_iter().filter(|name| !name.is_empty() && *name != "help") {
        let answer = bench.run(&format!("{name} --help"));
        assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
        assert!(answer.output.contains("--json <FILE>"), "{name}");
    }
    assert_eq!(bench.run("--version").output, format!("strainwave {}\n", env!("CARGO_PKG_VERSION")));
}

/// A row for each node of both ends at each instant, and nothing where the run cannot have them.
#[test]
fn forces_on_the_flexsplines_ends_are_written_beside_the_output() {
    let bench = Bench::new();
    let run = "sim --gear g.toml --input in.csv --output out.csv --forces f.csv";
    let answer = bench.run(&format!("{run} --mesh 36x6 --forces-every 5e-4"));
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""));
    assert_eq!(rows(&bench, HEADER).len(), 21);
    let text = std::fs::read_to_string(bench.path("f.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("t_s,end,node,radial_n,tangential_n,axial_n"));
    let cells: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(cells.len(), 5 * 2 * 36);
    assert_eq!(cells[0][..3], ["0.0", "rim", "0"]);
    assert_eq!(cells[5 * 72 - 1][..3], ["0.002", "flange", "35"]);
    assert!(cells.iter().all(|row| row[3..].iter().all(|cell| cell.parse::<f64>().unwrap().is_finite())));
    for (options, part) in [
        ("--build realtime", "--forces is for --build reference"),
        ("--forces-every 1.5e-4", "--forces-every 1.5e-4 is out of range; allowed: a multiple of 1e-4 s"),
        ("--forces-every 0", "--forces-every 0e0 is out of range"),
        ("--forces-every nan", "is out of range"),
    ] {
        let line = bench.refused(&format!("{run} {options}"));
        assert!(line.contains(part), "{options}: {line}");
    }
    let line = bench.refused("sim --gear g.toml --input in.csv --output out.csv --forces out.csv");
    assert!(line.contains("--forces and --output are the same file"), "{line}");
}
