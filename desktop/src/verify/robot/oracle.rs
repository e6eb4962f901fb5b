//! The rigid arm: its energy, and MuJoCo's swing and inverse dynamics (`desktop/oracle/robot/mujoco_robot.py`).

use std::path::Path;

use crate::io::figure::Figure;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::robot::RobotFile;
use crate::robot::chain::{Chain, ChainState};
use crate::verify::bounds;
use crate::verify::largest;

const SWING: &str = include_str!("../../../oracle/robot/swing.csv");
const TORQUES: &str = include_str!("../../../oracle/robot/chain.csv");
const SPATIAL: &str = include_str!("../../../oracle/robot/chain.toml");

/// Step of the rigid arm (s), the oracle's.
const STEP: f64 = 1e-4;
/// Swing over which the energy is kept (s).
const DURATION: f64 = 10.0;

pub(super) fn figures() -> Result<Vec<Figure>, BadInput> {
    let arm = RobotFile::example();
    let gear = |_: &str| Ok(GearFile::default_gear());
    let spatial = RobotFile::parse(Path::new("chain.toml"), SPATIAL.as_bytes(), gear)?;
    Ok(vec![
        bounds::figure("robot.rigid.energy", energy(&arm)?),
        bounds::figure("robot.rigid.swing", swing(&arm)?),
        bounds::figure("robot.rigid.torques", torques(&spatial)?),
    ])
}

/// The links of a robot, at rest in its start.
fn rigid(robot: &RobotFile) -> Result<(Chain, ChainState), BadInput> {
    let links: Vec<_> = robot.joints.iter().map(|joint| joint.link).collect();
    let chain = Chain::build(&links, robot.gravity).map_err(BadInput::message)?;
    let mut state = chain.rest();
    robot.joints.iter().enumerate().for_each(|(index, joint)| state.set(index, [joint.start, 0.0]));
    Ok((chain, state))
}

fn energy(robot: &RobotFile) -> Result<f64, BadInput> {
    let (chain, mut state) = rigid(robot)?;
    let start = chain.energy(&state);
    let (mut kinetic, mut change) = (0.0f64, Vec::new());
    for _ in 0..(DURATION / STEP).round() as u32 {
        chain.rigid_step(&mut state, STEP);
        change.push(chain.energy(&state) - start);
        kinetic = kinetic.max(chain.kinetic_energy(&state));
    }
    Ok(largest(change) / kinetic)
}

fn swing(robot: &RobotFile) -> Result<f64, BadInput> {
    let (chain, mut state) = rigid(robot)?;
    let (mut off, mut now) = (Vec::new(), 0.0);
    for row in rows("swing.csv", SWING)? {
        for _ in 0..((row[0] - now) / STEP).round() as u32 {
            chain.rigid_step(&mut state, STEP);
        }
        now = row[0];
        off.extend(state.angles().iter().zip(&row[1..]).map(|(ours, theirs)| ours - theirs));
    }
    Ok(largest(off))
}

fn torques(robot: &RobotFile) -> Result<f64, BadInput> {
    let (chain, mut state) = rigid(robot)?;
    let (mut off, mut size, n) = (Vec::new(), 0.0f64, robot.joints.len());
    for row in rows("chain.csv", TORQUES)? {
        (0..n).for_each(|joint| state.set(joint, [row[joint], row[n + joint]]));
        let (asked, theirs) = row[2 * n..].split_at(n);
        let ours = chain.torques(&state, asked);
        off.extend(ours.iter().zip(theirs).map(|(ours, theirs)| ours - theirs));
        size = theirs.iter().fold(size, |size, torque| size.max(torque.abs()));
    }
    Ok(largest(off) / size)
}

/// Numbers of a table of the oracle.
fn rows(name: &str, text: &str) -> Result<Vec<Vec<f64>>, BadInput> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows = reader.deserialize().collect::<Result<Vec<Vec<f64>>, _>>();
    rows.map_err(|error| BadInput::new(Path::new(name), error))
}
