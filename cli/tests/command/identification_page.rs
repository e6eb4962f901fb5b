//! `identify --report` through the real command, on the example logs: what the page has, and that it is there where the
//! gear file is not.

use std::path::Path;

use crate::bench::{Answer, Bench};

/// A folder with the example logs.
fn bench() -> Bench {
    let bench = Bench::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/logs");
    for name in ["my-joint.toml", "held.csv", "moving.csv"] {
        bench.write(name, std::fs::read(folder.join(name)).unwrap());
    }
    bench
}

/// The page, which asks for nothing outside it and has every figure of the run as the table prints it.
fn page(bench: &Bench, name: &str, answer: &Answer) -> String {
    let page = std::fs::read_to_string(bench.path(name)).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>"));
    for outside in ["src=", "<script", "<link", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("prefers-color-scheme: dark") && page.contains("@media print"));
    let figures = bench.figures("out.json");
    for figure in &figures {
        let name = figure["name"].as_str().unwrap();
        let printed = answer.output.lines().find(|line| line.split_whitespace().next() == Some(name));
        let value = printed.and_then(|line| line.split_whitespace().nth(1)).unwrap();
        assert!(page.contains(&format!("<td>{name}</td><td>{value}</td>")), "{name} {value}");
    }
    assert!(figures.len() > 5 && page.contains("\ntrained\n"));
    page
}

/// Everything that stands in the cells of a row of the page's table of parameters.
fn cells(page: &str, parameter: &str) -> Vec<String> {
    let start = page.find(&format!("<td>{parameter}</td>")).unwrap_or_else(|| panic!("{parameter}"));
    let row = page[start..].split("</tr>").next().unwrap();
    row.split("<td>").skip(1).map(|cell| cell.trim_end_matches("</td>").to_owned()).collect()
}

/// The ends of its interval.
fn interval(page: &str, parameter: &str) -> [f64; 2] {
    let cell = &cells(page, parameter)[4];
    let (low, high) = cell.split_once(" to ").unwrap_or_else(|| panic!("{parameter}: {cell}"));
    [low, high].map(|end| end.parse().unwrap())
}

#[test]
fn the_page_of_a_held_log_has_the_stiffness_with_its_interval() {
    let bench = bench();
    let words =
        "identify held.csv --gear my-joint.toml --output new.toml --report pages/held.html --json out.json";
    let answer = bench.run(words);
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.contains("report: pages/held.html"));
    let page = page(&bench, "pages/held.html", &answer);
    assert!(page.contains("Stiffness and hysteresis from held.csv. new.toml: written."));
    let cells = cells(&page, "stiffness.k1_nm_per_rad");
    let value = |cell: usize| cells[cell].parse::<f64>().unwrap();
    let [low, high] = interval(&page, "stiffness.k1_nm_per_rad");
    // The joint of these logs is softer than its catalogue by a tenth; the gear file has what the page says.
    assert!(low < value(3) && value(3) < high && high < value(2), "{cells:?}");
    let written = strainwave_desktop::GearFile::read(&bench.path("new.toml")).unwrap();
    assert!((written.stiffness.k1 / value(3) - 1.0).abs() < 1e-3, "{cells:?}");
    assert!(self::cells(&page, "hysteresis.weights_nm, sum")[4].contains(" to "));
    assert!(
        page.contains("aria-label=\"Correlations\"")
            && page.contains("torsion less that of the identified line")
    );
}

#[test]
fn the_page_of_a_moving_log_has_orders_and_friction() {
    let bench = bench();
    let words = "identify moving.csv --moving --gear my-joint.toml --output new.toml --report moving.html --json out.json";
    let answer = bench.run(words);
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    let page = page(&bench, "moving.html", &answer);
    assert!(page.contains("Input friction and kinematic error from moving.csv. new.toml: written."));
    let [low, high] = interval(&page, "kinematic_error.flexspline, order 2: amplitude");
    assert!(low < 1.3e-4 && 1.3e-4 < high && high - low < 1e-4, "{low} {high}");
    let [low, high] = interval(&page, "friction.input.coulomb_nm");
    let coulomb = strainwave_desktop::GearFile::read(&bench.path("new.toml")).unwrap().friction.input.coulomb;
    assert!((low..high).contains(&coulomb.unwrap()), "{low} {high}");
    assert_eq!(page.matches("aria-label=\"Correlations\"").count(), 2);
    assert!(page.contains("friction, identified") && page.contains("order [1/turn]"));
    assert!(
        page.contains("<li>stiffness: not identified, a moving joint's log does not tell it from the load;")
    );
}

/// The moving log without its output angle: friction alone, nothing that is not a number, and no picture of an output.
#[test]
fn a_moving_log_without_an_output_encoder_shows_friction() {
    let bench = bench();
    let log = String::from_utf8(bench.files()[&bench.path("moving.csv")].clone()).unwrap();
    let first = |line: &str| format!("{}\n", line.split(',').take(3).collect::<Vec<_>>().join(","));
    bench.write("log.csv", log.lines().map(first).collect::<String>());
    let words = "identify log.csv --moving --gear my-joint.toml --output new.toml";
    let plotted = bench.run(&format!("{words} --plot new.svg"));
    assert_eq!(plotted.error, "error: log.csv: column theta_out_rad is missing; --plot shows it\n");
    assert!(!bench.path("new.toml").exists());
    let answer = bench.run(&format!("{words} --report new.html --json out.json"));
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    let page = std::fs::read_to_string(bench.path("new.html")).unwrap();
    assert!(page.contains("friction, identified") && !page.contains("output angle [mrad]"));
    assert!(!page.contains("NaN") && !answer.output.contains("NaN"), "{}", answer.output);
}

/// The held log as input and output: the torsion over the torque.
#[test]
fn the_page_of_an_operator_has_its_loops() {
    let bench = bench();
    let log = String::from_utf8(bench.files()[&bench.path("held.csv")].clone()).unwrap();
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{},{}\n", cells[4], -cells[3])
    };
    bench.write("log.csv", format!("u,y\n{}", log.lines().skip(1).map(row).collect::<String>()));
    let words = "identify --operator log.csv --output op.toml --levels 6 --smoothing 1e-6 --report op.html --json out.json";
    let answer = bench.run(words);
    assert!(answer.code.is_some_and(|code| code <= 1), "{}", answer.error);
    let page = page(&bench, "op.html", &answer);
    assert!(page.contains("A Preisach operator from log.csv.") && page.contains("There are no intervals"));
    assert_eq!(cells(&page, "operator.slope")[4], "-");
    assert!(page.contains("log.csv: y over u."));
}

/// In the first half of the log the joint is twice as soft, in the second it is not.
#[test]
fn a_refused_gear_file_has_a_page_that_tells_why() {
    let bench = bench();
    let log = String::from_utf8(bench.files()[&bench.path("held.csv")].clone()).unwrap();
    let lines: Vec<&str> = log.lines().collect();
    let softer = |(row, line): (usize, &&str)| {
        let cells: Vec<&str> = line.split(',').collect();
        let factor = if row < lines.len() / 2 { 2.0 } else { 1.0 };
        let output = factor * cells[3].parse::<f64>().unwrap();
        format!("{},{},{},{output},{}\n", cells[0], cells[1], cells[2], cells[4])
    };
    let rows: String = lines[1..].iter().enumerate().map(softer).collect();
    bench.write("log.csv", format!("{}\n{rows}", lines[0]));
    let answer = bench.run(
        "identify log.csv --gear my-joint.toml --output new.toml --levels 6 --smoothing 1e-4 --report new.html --json out.json",
    );
    assert_eq!(answer.code, Some(1), "{}", answer.output);
    assert!(!bench.path("new.toml").exists());
    let page = page(&bench, "new.html", &answer);
    // The same words in the line on the error stream.
    let told = answer.error.trim().strip_prefix("new.toml: not written: ").unwrap();
    let (why, helps) = told.split_once("; what helps is ").unwrap();
    assert!(
        page.contains("<p class=\"refused\">") && page.contains(&format!("not written: {why}")),
        "{told}"
    );
    assert!(page.contains(&format!("<li>Not written: {why}. What helps is {helps}.</li>")), "{told}");
}

#[test]
fn a_page_that_could_not_be_written_is_refused_before_the_work() {
    let bench = bench();
    let words = "identify held.csv --gear my-joint.toml --output new.toml --report";
    for (path, expected) in [
        ("held.csv", "held.csv: --report and LOG.csv are the same file"),
        ("new.toml", "new.toml: --report and --output are the same file"),
        ("my-joint.toml/a.html", "my-joint.toml: is a file; a folder is needed"),
        ("-", "--report - is not possible; allowed: a file"),
    ] {
        let line = bench.refused(&format!("{words} {path}"));
        assert!(line.starts_with("error: ") && line.ends_with(expected), "{line}");
    }
}
