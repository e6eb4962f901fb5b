//! Observe a log: what the output did and what loaded it, from the motor's angle and torque alone.
//!
//! `cargo run --release --example observe_log -- LOG.csv` reads the columns t_s, theta_motor_rad, tau_motor_nm and, to
//! compare with, theta_out_rad. Without a file it first simulates a log: three moves, and a load of 20 N m half way.

use std::error::Error;
use std::fmt::Write;

use strainwave::Angle;
use strainwave::compensator::{CompensationGains, Directions, Input, RealTimeGear, Sensors, Setpoint};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, Motion};
use strainwave::trajectory::TrajectoryParams;

mod joint {
    include!("joint/hd25_100.rs"); // generated from gears/hd25-100.toml
}
use joint::JOINT;

/// A row of a log: time (s), motor angle (rad), motor torque (N m), output angle (rad).
type Row = [f64; 4];

fn main() -> Result<(), Box<dyn Error>> {
    let text = match std::env::args().nth(1) {
        Some(path) => std::fs::read_to_string(path)?,
        None => simulated()?,
    };
    observe(&read(&text)?)
}

fn read(text: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let place =
        |name| header.iter().position(|column| *column == name).ok_or(format!("column {name} is missing"));
    let places = [place("t_s")?, place("theta_motor_rad")?, place("tau_motor_nm")?, place("theta_out_rad")?];
    let row = |line: &str| -> Result<Row, Box<dyn Error>> {
        let cells = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        Ok(places.map(|place| cells.get(place).copied().unwrap_or(f64::NAN)))
    };
    lines.map(row).collect()
}

/// Feeds the log through the observer and prints what it estimates.
fn observe(log: &[Row]) -> Result<(), Box<dyn Error>> {
    let compensator = JOINT.build()?;
    let ratio = strainwave::Ratio::one_over(JOINT.gear.ratio)?;
    let mut state = compensator.rest();
    let (mut next_line, mut squares, mut count) = (0.0, [0.0; 2], 0.0);
    println!("         output [mrad]   error of its prediction [urad]   external torque on it [N m]");
    println!("time [s]      measured      observer        rigid gear       estimate    std. deviation");
    for pair in log.windows(2) {
        let steps = ((pair[1][0] - pair[0][0]) / f64::from(JOINT.dt)).round();
        for step in 0..steps as u32 {
            let fraction = f64::from(step) / steps;
            let [time, motor, torque, output] =
                std::array::from_fn(|k| pair[0][k] + fraction * (pair[1][k] - pair[0][k]));
            let motor = Angle::<f32>::from_radians_f64(motor);
            let rigid = ratio.apply(motor);
            let input = Input {
                sensors: Sensors {
                    motor_encoder: motor.phase() >> (32 - JOINT.motor_encoder_bits),
                    motor_torque: torque as f32,
                    ..Sensors::default()
                },
                // Nothing is commanded and no function is switched on: the joint is only observed.
                command: Setpoint { position: rigid, ..Setpoint::default() }.into(),
                ..Input::default()
            };
            let estimate = compensator.step(&mut state, &input).estimate;
            let errors = [estimate.output_position, rigid].map(|angle| angle.to_radians() - output);
            squares = [squares[0] + errors[0] * errors[0], squares[1] + errors[1] * errors[1]];
            count += 1.0;
            if time >= next_line {
                println!(
                    "{time:8.2} {:13.2} {:13.1} {:17.1} {:14.2} {:17.2}",
                    output * 1e3,
                    errors[0] * 1e6,
                    errors[1] * 1e6,
                    estimate.external_torque,
                    estimate.deviation.external_torque
                );
                next_line += 0.1;
            }
        }
    }
    let [observer, rigid] = squares.map(|sum: f64| 1e6 * (sum / count).sqrt());
    println!("rms {observer:32.1} {rigid:17.1}");
    Ok(())
}

/// A log of 1 kHz: the joint moves back and forth under its controller, friction and stiffness 10 % off the model's.
fn simulated() -> Result<String, Box<dyn Error>> {
    let (compensator, mut params, step) = (JOINT.build()?, JOINT.gear, JOINT.dt / 5.0);
    params.input_friction.scale(1.1);
    params.output_friction.scale(1.1);
    params.flexspline.line.stiffness = params.flexspline.line.stiffness.map(|k| 0.9 * k);
    let plant: RealTimeGear<f32> =
        params.build(Reduced::build(&params.flexspline, params.rated_torque)?, step)?;
    let (mut state, mut memory) = (compensator.rest(), plant.rest());
    let (mut motor, mut output, mut torque) = (Motion::default(), Motion::default(), 0.0);
    let limits =
        TrajectoryParams { velocity: 0.5, acceleration: 2.0, jerk: 20.0, snap: 400.0 }.build(JOINT.dt)?;
    let (here, there) = (Angle::default(), Angle::from_radians(0.2));
    let ways = [limits.plan(here, there)?, limits.plan(there, here)?, limits.plan(here, there)?];
    let setpoints = ways.iter().flat_map(|way| (0..way.periods()).map(|period| way.at(period)));
    let mut log = String::from("t_s,theta_motor_rad,tau_motor_nm,theta_out_rad\n");
    for (period, setpoint) in setpoints.enumerate() {
        let time = period as f64 * f64::from(JOINT.dt);
        if period % 10 == 0 {
            let angles = [motor.angle, output.angle].map(Angle::to_radians);
            writeln!(log, "{time:.4},{:.8},{torque},{:.9}", angles[0], angles[1])?;
        }
        let motor_encoder = motor.angle.phase() >> (32 - JOINT.motor_encoder_bits);
        let sensors = Sensors { motor_encoder, motor_torque: torque, ..Sensors::default() };
        let gains = Directions::from(CompensationGains::ALL);
        let input = Input { sensors, command: setpoint.into(), gains, ..Input::default() };
        torque = compensator.control(&mut state, &input).motor_torque;
        let load = if time < 1.3 { 0.0 } else { 20.0 };
        for _ in 0..5 {
            let inside = plant.torques(&mut memory, &motor, &output, Applied { motor: torque, load });
            output.advance(plant.flange_acceleration(&inside, load), step);
            motor.advance((torque - inside.wave_generator) / params.wave_generator_inertia, step);
        }
    }
    Ok(log)
}
