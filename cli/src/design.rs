//! `design`: gains, poles and margins of a joint.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::design::cascade_rule::{CascadeGains, Required, cascade};
use strainwave_desktop::design::joint;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::design::judge::Unstable;
use strainwave_desktop::design::level_rule::{self, Allowed, Miss};
use strainwave_desktop::design::levels::Levels;
use strainwave_desktop::design::parts::Parts;
use strainwave_desktop::design::rules;
use strainwave_desktop::design::sweep::{Measured, sweep};
use strainwave_desktop::io::file;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::report::design::{Poles, Report, place};
use strainwave_desktop::{BadInput, GearFile};

use crate::figures::{Figures, FiguresArguments, columns, say};
use crate::files;
use crate::page::PageArguments;
use crate::progress::Progress;

/// Frequencies at which |L| is measured (Hz).
const FREQUENCIES: [u32; 8] = [5, 10, 20, 40, 60, 80, 120, 200];

/// Unstable corners that are named.
const UNSTABLE: usize = 5;

/// Print the gains that follow from a gear file, and the margins of each loop over the box that its joint may lie in
///
/// Linear analysis at the motor's torque command and at the disturbance path, with the motor's encoder alone and with
/// both. Each margin stands with its bound and the corner of the box where it is worst; below them the closed loop's
/// poles and the corners that are not stable. The exit code is 1 when a margin is missed.
#[derive(Args)]
pub struct Arguments {
    /// The gear file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    /// Gains of the cascade: those of the file's [feedback], or the stiffest that have margins over the box
    #[arg(long, value_enum, default_value = "file")]
    cascade: Source,
    /// Phase margin that the rule's cascade has beyond its bound (degrees), for the functions on top of it
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = reserve)]
    reserve: f64,
    /// Functions on top of the cascade: as they are, none, or as much of each as has margins
    #[arg(long, value_enum, default_value = "file")]
    functions: Functions,
    /// Also measure |L| in the loop of the real code and print it next to the linear one
    #[arg(long)]
    sweep: bool,
    /// Also write the joint's parameters as Rust source, for programs that build the compensator themselves: those that the gear
    /// file gives, whatever --cascade and --functions are
    #[arg(long, value_name = "JOINT.rs")]
    joint: Option<PathBuf>,
    #[command(flatten)]
    page: PageArguments,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Source of the cascade's gains.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Source {
    /// The gear file
    File,
    /// The rule
    Rule,
}

/// Which functions there are on top of the cascade.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Functions {
    /// All of them, as the firmware has them
    File,
    /// None
    None,
    /// Those that have margins
    Rule,
}

fn reserve(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|degrees| (0.0..=40.0).contains(degrees));
    found.ok_or_else(|| "allowed: a number from 0 to 40".into())
}

fn cascade_of(arguments: &Arguments, file: &GearFile) -> Result<Option<CascadeGains>, BadInput> {
    if arguments.cascade == Source::File {
        return Ok(None);
    }
    let required = Required { phase: Required::BOUNDS.phase + arguments.reserve, ..Required::BOUNDS };
    let missing = || BadInput::new(&arguments.gear, "no cascade has these margins over the box");
    cascade(file, &required).map(Some).ok_or_else(missing)
}

fn levels(functions: Functions, file: &GearFile, parts: &Parts) -> Allowed {
    let all = |levels| Allowed { levels, misses: Default::default() };
    match functions {
        Functions::File => all(Levels::FULL),
        Functions::None => all(Levels::NONE),
        Functions::Rule => {
            let mut progress = Progress::new(1000, "levels");
            level_rule::levels(file, parts, |fraction| progress.set((fraction * 1e3) as u64))
        }
    }
}

/// Analyses and judges.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[
        ("GEAR.toml", Some(&arguments.gear)),
        ("--joint", arguments.joint.as_deref()),
        ("--markdown", arguments.page.markdown.as_deref()),
        ("--json", json),
    ])?;
    let file = GearFile::read(&arguments.gear)?;
    buildable(&file).map_err(|why| BadInput::new(&arguments.gear, why))?;
    for path in [arguments.joint.as_deref(), json] {
        files::require_writable(path)?;
    }
    arguments.page.require_renewable()?;
    if let Some(path) = &arguments.joint {
        write_joint(&file, path)?;
    }
    let mut parts = rules::parts(&file).map_err(BadInput::message)?;
    let rule = cascade_of(arguments, &file)?;
    parts.feedback = rule.map_or(parts.feedback, |gains| gains.params(&file));
    let allowed = levels(arguments.functions, &file, &parts);
    let mut progress = Progress::new(1000, "margins");
    let report =
        Report::of(&file, &parts, rule, allowed.levels, |fraction| progress.set((fraction * 1e3) as u64));
    drop(progress);
    print(&report, &allowed);
    if arguments.sweep {
        print_sweep(&file)?;
    }
    let figures = report.figures();
    arguments.page.renew(&figures)?;
    Ok(Figures::new(figures, &arguments.figures))
}

/// Rust source that firmware includes.
fn write_joint(gear: &GearFile, path: &Path) -> Result<(), BadInput> {
    let params = joint_params(gear).map_err(BadInput::message)?;
    params.build().map_err(BadInput::message)?;
    let source = joint::source(&params, &gear.gear.name);
    file::write(path, |out| Ok(out.write_all(source.as_bytes())?))?;
    say(format_args!("joint: {}\n", path.display()));
    Ok(())
}

fn table<const N: usize>(header: [&str; N], rows: Vec<[String; N]>) {
    let rows = std::iter::once(header.map(String::from)).chain(rows);
    say(format_args!("{}\n", columns(&rows.map(|row| row.to_vec()).collect::<Vec<_>>())));
}

/// Each function with its level, and of one that is off what it misses at the least level.
fn functions(allowed: &Allowed) -> Vec<[String; 5]> {
    let shown = |level: f64| if level == 0.0 { "off".to_owned() } else { format!("{level}") };
    let row = |((name, level), miss): ((&str, f64), &Option<Miss>)| {
        let [what, value, at] = match miss {
            Some(miss) => [miss.what.clone(), format!("{:.3}", miss.value), place(&miss.at)],
            None => [(); 3].map(|()| "-".to_owned()),
        };
        [name.to_owned(), shown(level), what, value, at]
    };
    allowed.levels.named().zip(&allowed.misses).map(row).collect()
}

fn print(report: &Report, allowed: &Allowed) {
    table(["gain", "value", "unit", "rule"], report.gains());
    table(["function", "level", "misses at 1/4", "value", "worst corner"], functions(allowed));
    table(["loop", "margin", "value", "bound", "worst corner"], report.margins());
    say(format_args!("poles of the nominal joint, frequency/damping ratio:"));
    for Poles { set, mode, modes } in &report.poles {
        let modes: Vec<_> =
            modes.iter().map(|(w, damping)| format!("{:.1} Hz/{damping:.2}", w / TAU)).collect();
        say(format_args!("  {} {mode:?}: {}", set.name(), modes.join(", ")));
    }
    say(format_args!("\nunstable corners: {}", report.unstable.len()));
    for Unstable { variant, corner, growth } in report.unstable.iter().take(UNSTABLE) {
        let path = if variant.passes { "path_on" } else { "path_off" };
        let growth = growth.map_or_else(|| "?".into(), |growth| format!("{growth:.3}"));
        let (set, place) = (variant.set.name(), place(&Some((*variant, *corner))));
        say(format_args!("  {set} {path} {place}: grows by {growth} 1/s"));
    }
    for name in report.missed() {
        say(format_args!("misses its bound: {name}"));
    }
    say(format_args!(""));
}

fn print_sweep(file: &GearFile) -> Result<(), BadInput> {
    let mut rows = Vec::new();
    for set in SensorSet::ALL {
        for Measured { frequency, measured, linear } in
            sweep(file, set, &FREQUENCIES).map_err(BadInput::message)?
        {
            rows.push([
                set.name().into(),
                format!("{frequency:.0}"),
                format!("{measured:.3}"),
                format!("{linear:.3}"),
            ]);
        }
    }
    table(["set", "frequency [Hz]", "|L| measured [dB]", "|L| linear [dB]"], rows);
    Ok(())
}
