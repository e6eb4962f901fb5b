//! `check`: everything that is wrong with a gear, belt, link, robot or sensor file.

use std::path::{Path, PathBuf};

use clap::Args;
use strainwave_desktop::design::buildable::use_of;
use strainwave_desktop::design::wave_generator::series_belt;
use strainwave_desktop::io::belt_file::Geometry;
use strainwave_desktop::io::keyed_file::FileKind;
use strainwave_desktop::plant::belt::require_real_time;
use strainwave_desktop::robot::RobotFile;
use strainwave_desktop::{BadInput, BeltFile, GearFile, LinkFile, SensorFile};

use crate::figures::{Figures, FiguresArguments, complain, say};
use crate::files;

/// Tell everything that is wrong with a gear, belt, link, robot or sensor file, a line each with key, value and range
///
/// Unknown keys with the nearest known one, missing keys, types, ranges, conditions between keys, and whether the firmware's
/// compensator can be built. Conditions between keys are checked where those keys are right by themselves. Exit code 0
/// and one line when nothing is wrong, else 2. A file with a table [belt] and none [gear] is a belt file; of it the geometry is told. A file with a
/// table [link] is a link file, one with a table [robot] a robot file, whose gear files are read too, one with a table [sensor_set] a sensor file.
#[derive(Args)]
pub struct Arguments {
    /// Gear, belt, link, robot or sensor file
    #[arg(value_name = "GEAR.toml")]
    gear: PathBuf,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Reads and checks.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[("GEAR.toml", Some(&arguments.gear)), ("--json", json)])?;
    files::require_writable(json)?;
    let path = &arguments.gear;
    let use_of = match FileKind::at(path) {
        FileKind::Gear => limit(&faultless(path)?, path)?,
        FileKind::Belt => belt(path)?,
        FileKind::Link => link(path)?,
        FileKind::Robot => robot(path)?,
        FileKind::Sensor => sensors(path)?,
    };
    say(format_args!("{}: ok{use_of}", path.display()));
    Ok(Figures::silent(Vec::new(), &arguments.figures))
}

/// A gear file with nothing wrong in it; of another all faults are told.
pub fn faultless(path: &Path) -> Result<GearFile, BadInput> {
    GearFile::faultless(path).map_err(all_but_last)
}

/// What a belt file that is right describes, and what limits its use.
fn belt(path: &Path) -> Result<String, BadInput> {
    let file = BeltFile::faultless(path).map_err(all_but_last)?;
    let geometry = file.geometry().expect("the file is checked");
    let limit = require_real_time(&file)
        .err()
        .map_or_else(String::new, |why| format!("; only --build reference: {why}"));
    let pulleys = [file.motor_pulley.teeth, file.output_pulley.teeth];
    Ok(format!(", {}{limit}", lies(&geometry, pulleys)))
}

/// How a belt lies on pulleys of so many teeth.
fn lies(geometry: &Geometry, [motor, output]: [u32; 2]) -> String {
    let [motor, output] =
        [(motor, 0), (output, 1)].map(|(teeth, index)| geometry.teeth_in_mesh(teeth, index));
    format!("centre distance {:.4} m, {motor:.1} and {output:.1} teeth in mesh", geometry.centre_distance)
}

/// How the belt in front of a gear lies, if there is one, and whether the motor can make a span go slack.
fn driving_belt(gear: &GearFile) -> String {
    let (Some(belt), Some(series)) = (&gear.belt, series_belt(gear)) else { return String::new() };
    let geometry = belt.geometry().expect("the file is checked");
    let slack = series.slack_torque * belt.ratio();
    let lies = lies(&geometry, belt.pulley_teeth());
    if gear.motor.peak_torque <= slack {
        return format!(", {lies}");
    }
    format!(", {lies}; a span goes slack at {slack:.3} N m of the motor, below motor.peak_torque_nm")
}

/// What is odd about a link file that is right.
fn link(path: &Path) -> Result<String, BadInput> {
    let file = LinkFile::faultless(path).map_err(all_but_last)?;
    Ok(file.warning().map_or_else(String::new, |warning| format!("; {warning}")))
}

/// What a robot file that is right describes.
fn robot(path: &Path) -> Result<String, BadInput> {
    let robot = RobotFile::faultless(path).map_err(all_but_last)?;
    Ok(format!(", joints: {}", robot.joints.len()))
}

/// What a sensor file that is right describes.
fn sensors(path: &Path) -> Result<String, BadInput> {
    let file = SensorFile::faultless(path).map_err(all_but_last)?;
    Ok(format!(", sensors: {}", file.names().join(", ")))
}

/// Tells all faults but the last one, which ends the command.
fn all_but_last(mut faults: Vec<BadInput>) -> BadInput {
    let last = faults.pop().expect("a refusal has a reason");
    faults.iter().for_each(|fault| complain(format_args!("error: {fault}")));
    last
}

/// What limits the use of a file that is right.
fn limit(gear: &GearFile, path: &Path) -> Result<String, BadInput> {
    let limit = use_of(gear).map_err(|why| BadInput::new(path, why))?;
    let limit = limit.map_or_else(String::new, |why| format!(", for simulation only: {why}"));
    Ok(driving_belt(gear) + &limit)
}
