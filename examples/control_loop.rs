//! One joint's whole control loop on the host: encoder count and torque in, torque command out, every 0.1 ms.
//!
//! The output moves by 0.2 rad, back and forth again, once with the motor-side cascade alone and once with the
//! compensator. The plant has 20 % more friction than the controller's model of it.

use strainwave::compensator::{CompensationGains, Directions, Input, RealTimeGear, Sensors};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, Motion};
use strainwave::trajectory::TrajectoryParams;
use strainwave::{Angle, Error};

mod joint {
    include!("joint/hd25_100.rs"); // generated from gears/hd25-100.toml
}
use joint::JOINT;
const STEPS: u16 = 5; // of the plant in a control period

/// Output error in every control period (rad).
fn run(gains: Directions<f32>) -> Result<Vec<f32>, Error> {
    let (compensator, mut params, step) = (JOINT.build()?, JOINT.gear, JOINT.dt / f32::from(STEPS));
    params.input_friction.scale(1.2);
    params.output_friction.scale(1.2);
    let flexspline = Reduced::build(&params.flexspline, params.rated_torque)?;
    let plant: RealTimeGear<f32> = params.build(flexspline, step)?;
    let (mut state, mut memory) = (compensator.rest(), plant.rest());
    let (mut motor, mut output) = (Motion::default(), Motion::default());
    let limits =
        TrajectoryParams { velocity: 1.0, acceleration: 10.0, jerk: 200.0, snap: 2e4 }.build(JOINT.dt)?;
    let (here, there) = (Angle::default(), Angle::from_radians(0.2));
    let (mut torque, mut errors) = (0.0, Vec::new());
    for way in [limits.plan(here, there)?, limits.plan(there, here)?, limits.plan(here, there)?] {
        for setpoint in (0..way.periods()).map(|period| way.at(period)) {
            errors.push(output.angle.minus(setpoint.position));
            let motor_encoder = motor.angle.phase() >> (32 - JOINT.motor_encoder_bits);
            let sensors = Sensors { motor_encoder, motor_torque: torque, ..Sensors::default() };
            let input = Input { sensors, command: setpoint.into(), gains, ..Input::default() };
            torque = compensator.control(&mut state, &input).motor_torque;
            for _ in 0..STEPS {
                let inside =
                    plant.torques(&mut memory, &motor, &output, Applied { motor: torque, load: 0.0 });
                output.advance(plant.flange_acceleration(&inside, 0.0), step);
                motor.advance((torque - inside.wave_generator) / params.wave_generator_inertia, step);
            }
        }
    }
    Ok(errors)
}

fn main() -> Result<(), Error> {
    let cascade = run(CompensationGains { feedback: 1.0, ..CompensationGains::default() }.into())?;
    let compensated = run(CompensationGains::ALL.into())?;
    println!("time [s]   error of the output [urad]: cascade alone   compensated");
    for (k, (alone, with)) in cascade.iter().zip(&compensated).enumerate().step_by(500) {
        println!("{:8.2} {:42.1} {:13.1}", k as f32 * JOINT.dt, alone * 1e6, with * 1e6);
    }
    let rms = |e: &[f32]| 1e6 * (e.iter().map(|e| e * e).sum::<f32>() / e.len() as f32).sqrt();
    println!("rms {:47.1} {:13.1}", rms(&cascade), rms(&compensated));
    Ok(())
}
