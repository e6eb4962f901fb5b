//! The chain against scipy's integration of the same masses, springs and dampers (`desktop/oracle/belt/chain.py`).
//!
//! The example without friction and pitch error, [`NODES`] nodes a span. The motor turns by [`ANGLE`] within [`TURN`], from rest to rest; a
//! load of -4 N m comes on, and from [`TAUT`] on one of 45 N m, under which the forward span goes slack, is caught and goes slack again.
//!
//! Semi-implicit Euler is of first order: its error falls with the step. While both spans are taut the runs of two steps, one half of the
//! other, are therefore extrapolated to a step of 0 too, which leaves an error of second order.

use std::f64::consts::{FRAC_PI_2, TAU};

use strainwave::Angle;
use strainwave::belt::{Belt, BeltTorques};
use strainwave::friction::Viscous;
use strainwave::gear::Motion;

use super::plain;
use crate::design::belt::belt_params;
use crate::io::belt_file::BeltFile;
use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

/// Written by the oracle: time (s), angle of the output (rad), tensions of both spans at the output (N), torque on the motor (N m).
const CHAIN: &str = include_str!("../../../oracle/belt/chain.csv");

/// Nodes of a span.
const NODES: usize = 4;
/// Turn of the motor (rad) and its time (s).
const ANGLE: f64 = 3.0;
const TURN: f64 = 0.1;
/// Loads (N m), when each begins to rise, and how long it does (s).
const LOADS: [f64; 2] = [-4.0, 45.0];
const STARTS: [f64; 2] = [0.02, TAUT];
const RISE: f64 = 0.02;
/// Until then both spans are taut (s).
const TAUT: f64 = 0.12;
/// Between rows of the oracle (s).
const EVERY: f64 = 5e-4;
/// Steps between two rows.
const STEPS: usize = 2000;

/// A row of the oracle, and what is there of ours: angle, two tensions, torque.
type Row = [f64; 4];

pub(super) fn measure() -> Vec<Figure> {
    let expected = rows();
    let [ours, finer] = [STEPS, 2 * STEPS].map(|steps| run(steps, expected.len()));
    let extrapolated: Vec<Row> = ours.iter().zip(&finer).map(|(one, other)| zero_step(one, other)).collect();
    let taut = (TAUT / EVERY).round() as usize;
    let pretension = BeltFile::example().belt.pretension;
    let angles =
        |ours: &[Row]| difference(ours, &expected, &[0]) / largest(expected.iter().map(|row| row[0]));
    let forces = |ours: &[Row], from: usize, to: usize| {
        difference(&ours[from..to], &expected[from..to], &[1, 2]) / pretension
    };
    let torque = largest(expected.iter().map(|row| row[3]));
    let all = expected.len();
    vec![
        bounds::figure("belt.chain.scipy.angle", angles(&ours)),
        bounds::figure("belt.chain.scipy.forces", forces(&ours, 0, taut)),
        bounds::figure("belt.chain.scipy.forces.slack", forces(&ours, taut, all)),
        bounds::figure("belt.chain.scipy.torque", difference(&ours, &expected, &[3]) / torque),
        bounds::figure("belt.chain.scipy.extrapolated", forces(&extrapolated, 0, taut)),
    ]
}

/// Largest difference in these columns.
fn difference(ours: &[Row], expected: &[Row], columns: &[usize]) -> f64 {
    let pairs = ours.iter().zip(expected);
    largest(pairs.flat_map(|(ours, theirs)| columns.iter().map(move |k| ours[*k] - theirs[*k])))
}

/// What two runs tell of one with a step of 0, the error being of first order.
fn zero_step(coarse: &Row, fine: &Row) -> Row {
    [0, 1, 2, 3].map(|k| 2.0 * fine[k] - coarse[k])
}

/// Rows of the oracle without their times, the grid of which is tested.
fn rows() -> Vec<Row> {
    let mut reader = csv::Reader::from_reader(CHAIN.as_bytes());
    let rows = reader.deserialize().map(|row| row.expect("the oracle's table is tested"));
    rows.map(|[_, angle, forward, backward, torque]: [f64; 5]| [angle, forward, backward, torque]).collect()
}

/// So many rows with this number of steps between two of them.
fn run(steps: usize, rows: usize) -> Vec<Row> {
    let dt = EVERY / steps as f64;
    let damping_time = belt_params::<f64>(&BeltFile::example()).span.damping_time;
    let belt: Belt<f64, Viscous<f64>, NODES> =
        plain(damping_time, 0.0).build(dt).expect("the example is in range");
    let (mut state, mut output) = (belt.rest(), Motion::default());
    let mut found = Vec::with_capacity(rows);
    for step in 0.. {
        let time = step as f64 * dt;
        let angle = output.angle.to_radians();
        let torques = belt.step(&mut state, &mut output, &motor(time), load(time));
        if step % steps == 0 {
            found.push(row(angle, &torques));
            if found.len() == rows {
                break;
            }
        }
    }
    found
}

fn row(angle: f64, torques: &BeltTorques<f64>) -> Row {
    [angle, torques.forward, torques.backward, torques.motor]
}

fn motor(time: f64) -> Motion<f64> {
    let x = (time / TURN).min(1.0);
    Motion {
        angle: Angle::from_radians_f64(ANGLE * (x - (TAU * x).sin() / TAU)),
        velocity: ANGLE / TURN * (1.0 - (TAU * x).cos()),
    }
}

fn load(time: f64) -> f64 {
    let risen = |start: f64| (FRAC_PI_2 * ((time - start) / RISE).clamp(0.0, 1.0)).sin().powi(2);
    LOADS[0] * risen(STARTS[0]) + (LOADS[1] - LOADS[0]) * risen(STARTS[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chain_moves_as_scipys() {
        for figure in measure() {
            assert!(figure.holds, "{figure:?}");
        }
    }

    #[test]
    fn the_table_has_a_row_each_half_millisecond_and_a_span_that_goes_slack() {
        let times: Vec<f64> =
            CHAIN.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
        assert!(times.iter().enumerate().all(|(k, time)| (time - k as f64 * EVERY).abs() < 1e-9));
        let rows = rows();
        let slack = |row: &Row| row[1].min(row[2]) == 0.0;
        let taut = (TAUT / EVERY).round() as usize;
        assert!(!rows[..taut].iter().any(slack) && rows[taut..].iter().any(slack));
        assert!(rows[taut..].windows(2).filter(|pair| slack(&pair[0]) && !slack(&pair[1])).count() > 1);
    }
}
