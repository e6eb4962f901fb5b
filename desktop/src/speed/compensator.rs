//! The control step and its observer, the motor-side cascade, and a control period of the reference plant.
//!
//! The control step and the cascade read what the compensator has read in scenario S2, so that every slot of the schedule
//! counts as often as it runs. The observer's motor moves under a load.

use std::f64::consts::TAU;
use std::hint::black_box;

use strainwave::Angle;
use strainwave::compensator::estimate::observer::{GearCorrection, Measurement};
use strainwave::compensator::schedule::OBSERVER_PERIODS;
use strainwave::compensator::{Faults, Input, JointParams, Output, RealTimeFlexspline, RealTimeGear};

use super::{Error, Kernel, floor};
use crate::bench::baseline::Baseline;
use crate::bench::controller::Controller;
use crate::bench::controller::HostCompensator;
use crate::bench::scenario::Scenario;
use crate::bench::{Bench, Conditions};
use crate::design::joint::{firmware_gear_params, joint_params};
use crate::io::gear_file::GearFile;
use crate::plant::Plant;
use crate::plant::divergence::RunError;

/// Control periods of a pass.
const PERIODS: usize = 4096;
/// Periods of the observer in a pass, and the speed of its motor (rad/s) and its torque (N m).
const OBSERVER_STEPS: usize = 1024;
const SPEED: f32 = 20.0;
const TORQUE: f32 = 0.3;
/// Largest torque of the plant's motor (N m), and by what its phase advances in a control period: 10 Hz.
const SWINGING: f64 = 0.5;
const SWING: f64 = TAU * 1e-3;
/// The rival of the compensator's step.
const CASCADE: &str = "cascade.step";

pub(super) fn kernels(file: &GearFile) -> Result<Vec<Kernel>, Error> {
    let joint = joint_params::<f32>(file).map_err(RunError::from)?;
    let inputs = inputs(file, &joint)?;
    Ok(vec![
        observer(&joint).map_err(RunError::from)?,
        cascade(Baseline::b0(file).map_err(RunError::from)?, inputs.clone()),
        control(&joint, inputs).map_err(RunError::from)?,
        plant(file).map_err(RunError::from)?,
    ])
}

fn observer(joint: &JointParams<f32>) -> Result<Kernel, strainwave::Error> {
    let params = &joint.gear;
    let flexspline = RealTimeFlexspline::build(&params.flexspline, params.rated_torque)?;
    let gear: RealTimeGear<f32> = params.build(flexspline, joint.dt)?;
    let observer = joint.observer.build(params, &joint.limits, &joint.tolerances, joint.dt)?;
    let period = OBSERVER_PERIODS as f32 * joint.dt;
    let mut state = observer.rest();
    let mut motor = Angle::from_radians(0.0);
    Ok(Kernel::new("observer.step", floor::NAME, OBSERVER_STEPS, move || {
        for _ in 0..OBSERVER_STEPS {
            motor = motor.plus(period * SPEED);
            let measured = Measurement {
                motor,
                motor_speed: SPEED,
                reads_output: false,
                period,
                motor_torque: TORQUE,
                output_torque: None,
            };
            let mut faults = Faults::NONE;
            observer.step(&gear, &mut state, &measured, &GearCorrection::default(), false, &mut faults);
            black_box(&state);
        }
    }))
}

fn control(joint: &JointParams<f32>, inputs: Vec<Input<f32>>) -> Result<Kernel, strainwave::Error> {
    let model = joint.build()?;
    Ok(Kernel::new("compensator.control", CASCADE, inputs.len(), move || {
        let mut state = model.rest();
        for input in &inputs {
            black_box(model.control(&mut state, input));
        }
    }))
}

fn cascade(baseline: Baseline, inputs: Vec<Input<f32>>) -> Kernel {
    Kernel::new(CASCADE, floor::NAME, inputs.len(), move || {
        let mut baseline = baseline.clone();
        for input in &inputs {
            black_box(baseline.step(input));
        }
    })
}

/// A control period of the plant with the reference mesh, whose motor swings.
fn plant(file: &GearFile) -> Result<Kernel, strainwave::Error> {
    let mut plant = Plant::build(&firmware_gear_params(file)?)?;
    let mut phase = 0.0;
    Ok(Kernel::new("plant.period_36x4", floor::NAME, 1, move || {
        phase = (phase + SWING) % TAU;
        black_box(plant.step(SWINGING * phase.sin(), 0.0).is_ok());
    }))
}

/// A controller that keeps what it reads.
struct Kept {
    compensator: HostCompensator,
    inputs: Vec<Input<f32>>,
}

impl Controller for Kept {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        self.inputs.push(*input);
        Ok(self.compensator.step(input))
    }
}

/// Inputs of the compensator in the middle of S2.
fn inputs(file: &GearFile, joint: &JointParams<f32>) -> Result<Vec<Input<f32>>, RunError> {
    let mut kept = Kept { compensator: HostCompensator::build(joint)?, inputs: Vec::new() };
    Bench::condensed(file, &Conditions::of(file, 0))?.go(&Scenario::S2, &mut kept, |_, _, _, _| ())?;
    kept.inputs.truncate(PERIODS);
    Ok(kept.inputs)
}
