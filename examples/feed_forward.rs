//! Feed a move forward: for a planned move of the output, where the motor has to be and with what torque.
//!
//! The motor's angle contains the wind-up, the hysteresis and the kinematic error in advance; the torque contains the
//! inertia, the friction of both sides and what comes back through the gear. No feedback, no plant.

use strainwave::compensator::CompensationGains;
use strainwave::compensator::reference::feed_forward::{FeedForward, FeedForwardState, ModelCorrection};
use strainwave::compensator::schedule::{PLAN_TO_MODELS, SLOW_PERIODS};
use strainwave::compensator::{RealTimeFlexspline, RealTimeGear};
use strainwave::trajectory::TrajectoryParams;
use strainwave::{Angle, Error};

mod joint {
    include!("joint/hd25_100.rs"); // generated from gears/hd25-100.toml
}
use joint::JOINT;

fn main() -> Result<(), Error> {
    let flexspline = RealTimeFlexspline::build(&JOINT.gear.flexspline, JOINT.gear.rated_torque)?;
    let gear: RealTimeGear<f32> = JOINT.gear.build(flexspline, JOINT.dt)?;
    let feed_forward = FeedForward::build(&JOINT.gear, JOINT.dt)?;
    let mut state = FeedForwardState::default();
    let nominal = ModelCorrection::default(); // nothing learnt: the model as the gear file has it

    let limits = TrajectoryParams { velocity: 2.5, acceleration: 30.0, jerk: 1500.0, snap: 2e5 };
    let way = limits.build(JOINT.dt)?.plan(Angle::default(), Angle::from_radians(0.5))?;
    println!("0.5 rad in {:.3} s", way.periods() as f32 * JOINT.dt);
    println!(
        "time [s]  output [rad]  speed [rad/s]  motor ahead of N*output [urad at the output]  motor torque [N m]"
    );
    for period in (0..=way.periods() + SLOW_PERIODS).step_by(SLOW_PERIODS as usize) {
        let setpoint = way.at(period);
        let demand = feed_forward.step(&gear, &mut state, &setpoint, &CompensationGains::ALL, &nominal);
        if (period / SLOW_PERIODS).is_multiple_of(20) {
            println!(
                "{:8.3} {:13.4} {:14.3} {:45.1} {:19.3}",
                period as f32 * JOINT.dt,
                setpoint.position.minus(Angle::default()),
                setpoint.velocity,
                demand.link_offset * 1e6,
                demand.torque
            );
        }
        // Two control periods later line and hysteresis have their slot, six later friction and kinematic error.
        feed_forward.step_torsion(&gear, &mut state, &nominal.factors);
        let turned = demand.motor.velocity * PLAN_TO_MODELS as f32 * JOINT.dt;
        feed_forward.step_models(&gear, &mut state, demand.motor.angle.plus(turned), &nominal.factors);
    }
    Ok(())
}
