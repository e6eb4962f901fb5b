//! `new`: a joint's gear file from catalogue data.

use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use strainwave_desktop::catalogue::{Model, NewJoint, commented};
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::io::file;
use strainwave_desktop::io::gear_file::KEYS;
use strainwave_desktop::{BadInput, Figure};

use crate::figures::{Figures, FiguresArguments};
use crate::files;

/// Write the gear file of a new joint from catalogue data, every key with its meaning, unit and origin as a comment
///
/// Values are catalogue figures of the size and ratio, or follow from those of the nearest size: torque and stiffness with its
/// third power, inertia with its fifth. The comments tell which, and what is only a rule of thumb. `strainwave check`
/// tells whether the file is right after values were replaced.
#[derive(Args)]
pub struct Arguments {
    /// Size of the gear, its pitch diameter in tenths of an inch; 8 to 100
    #[arg(long, value_name = "SIZE", allow_hyphen_values = true,
          value_parser = value_parser!(u32).range(i64::from(*commented::SIZES.start())..=i64::from(*commented::SIZES.end())))]
    size: u32,
    /// Ratio N; 30 to 160
    #[arg(long, value_name = "N", allow_hyphen_values = true,
          value_parser = value_parser!(i32).range(i64::from(*commented::RATIOS.start())..=i64::from(*commented::RATIOS.end())))]
    ratio: i32,
    /// Inertia of the output with everything attached to it (kg m^2); 2*N^2 times the rotor's when left out
    #[arg(long, value_name = "KG_M2", allow_hyphen_values = true)]
    load: Option<f64>,
    /// Gear file to write, complete or not at all; - for the standard output
    #[arg(long, value_name = "JOINT.toml")]
    output: PathBuf,
    /// Replace a file that holds other values: they are lost
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    figures: FiguresArguments,
}

/// Derives, checks and writes.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[("--output", Some(&arguments.output)), ("--json", json)])?;
    let model = Model { size: arguments.size, ratio: arguments.ratio };
    let joint = NewJoint { model, load: arguments.load };
    require_load(&joint)?;
    files::require_writable(json)?;
    let text = joint.text();
    if !arguments.force {
        require_nothing_lost(&arguments.output, &text)?;
    }
    file::write(&arguments.output, |out| Ok(out.write_all(text.as_bytes())?))?;
    Ok(Figures::beside(&arguments.output, figures(&joint), &arguments.figures))
}

/// Refuses a file that holds something else: who has put values of their own into it would lose them by the same command again.
fn require_nothing_lost(output: &Path, text: &str) -> Result<(), BadInput> {
    let differs = output.is_file() && std::fs::read(output).is_ok_and(|held| held != text.as_bytes());
    if differs {
        Err(BadInput::new(output, "is there already, with other values; --force replaces it"))
    } else {
        Ok(())
    }
}

/// The gear file could be read again, and a compensator built from it; without a load of the user's it always can.
fn require_load(joint: &NewJoint) -> Result<(), BadInput> {
    let (Some(load), gear) = (joint.load, joint.gear()) else { return Ok(()) };
    let refuse = |allowed: String| {
        Err(BadInput::message(format_args!("--load {load} is out of range; allowed: {allowed}")))
    };
    let key =
        KEYS.iter().find(|key| key.path == "inertia.flexspline_kg_m2").expect("the key is in the table");
    let least = gear.least_flexspline_inertia();
    if !key.allowed.holds(load) {
        return refuse(key.allowed.to_string());
    }
    if load <= least {
        return refuse(format!("above 4*dt^2*K3 = {least:.3e} kg m^2"));
    }
    gear.check()?;
    buildable(&gear).map_err(|why| BadInput::message(format_args!("--load {load}: {why}")))
}

fn figures(joint: &NewJoint) -> Vec<Figure> {
    let gear = joint.gear();
    vec![
        Figure::reported("new.rated_torque", gear.gear.rated_torque, "N m"),
        Figure::reported("new.stiffness.k1", gear.stiffness.k1, "N m/rad"),
        Figure::reported("new.inertia.flexspline", gear.inertia.flexspline, "kg m^2"),
        Figure::reported("new.motor.peak_torque", gear.motor.peak_torque, "N m"),
    ]
}
