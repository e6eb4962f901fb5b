//! The belt gear as a two-port, open loop: motor motion and load in, output motion, torques and span forces out.
//!
//! ```text
//! in:  theta_motor(t) or omega_motor(t), tau_load(t)
//! out: theta_out, omega_out, tau_motor = J_1*d2theta_motor + tau_fric_motor + (ds_1/dtheta_motor)*(F_forward - F_backward), phi, tau_t,
//!      F_forward, F_backward at the output's pulley
//! ```
//!
//! Units and signs as in [`strainwave::belt`]. The run starts without torsion and with both pulleys and the belt in the same motion;
//! for [`RUN_IN`] before the first stamp friction is led at that speed.
//!
//! Discretisation: a row every 0.1 ms from the first stamp of the input. The real-time build takes one step for it with massless
//! spans, the reference build [`NODES`] nodes a span and as many steps as [`STEP_SHARE`] of the chain's stable step takes. Between the
//! input's stamps the load is linear; the motor moves as a wave generator's file does ([`crate::plant::two_port`]). A row holds the values
//! at its instant.

use strainwave::belt::{Belt, BeltParams, BeltState, BeltTorques};
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::{AnyFriction, AnyFrictionParams, AnyFrictionState};
use strainwave::gear::{Applied, Motion};
use strainwave::{Angle, Error, Real};

use crate::design::belt::belt_params;
use crate::io::belt_file::BeltFile;
use crate::io::log::{BeltRow, Drive, Instant, OpenLoop};
use crate::plant::two_port::RUN_IN;
use crate::plant::two_port::trajectory::Trajectory;

/// Nodes of either span in the reference build.
pub const NODES: usize = 16;
/// Longest step of the reference build as a fraction of the chain's stable one.
pub const STEP_SHARE: f64 = 0.5;

/// Which build of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeltBuild {
    /// f64, [`NODES`] nodes a span, many steps a row.
    Reference,
    /// f32, massless spans, one step a row.
    RealTime,
}

/// The rows of a run, computed one by one.
pub type BeltRows<'a> = Box<dyn ExactSizeIterator<Item = BeltRow> + 'a>;

/// Runs the belt gear of a file open loop.
///
/// # Errors
/// As [`BeltParams::build`]: of a checked file `dt`, where the step of the real-time build is too long for it.
pub fn run<'a>(file: &BeltFile, input: &'a OpenLoop, build: BeltBuild) -> Result<BeltRows<'a>, Error> {
    match build {
        BeltBuild::Reference => {
            let params = belt_params::<f64>(file);
            let steps = reference_steps(&params);
            rows::<f64, NODES>(&params, steps, input)
        }
        BeltBuild::RealTime => rows::<f32, 0>(&belt_params(file), 1, input),
    }
}

/// The real-time build can step the belt gear of a checked file.
///
/// # Errors
/// One line that names the key at fault, its value and what is allowed.
pub fn require_real_time(file: &BeltFile) -> Result<(), String> {
    let params = belt_params::<f64>(file);
    let bound = params.stable_step(0);
    if CONTROL_PERIOD < bound {
        return Ok(());
    }
    Err(format!(
        "output_pulley.inertia_kg_m2 = {:e} is too light on this belt for the real-time build: its step dt = {CONTROL_PERIOD} s; \
         allowed: below {bound:.3e} s, dt^2 + 2*T_d*dt < J/(r^2*EA/L)",
        file.output_pulley.inertia
    ))
}

/// Steps of the reference build in a control period.
pub fn reference_steps<P>(params: &BeltParams<f64, P>) -> usize {
    (CONTROL_PERIOD / (STEP_SHARE * params.stable_step(NODES))).ceil() as usize
}

fn rows<'a, R: Real, const N: usize>(
    params: &BeltParams<R, AnyFrictionParams<R>>,
    steps: usize,
    input: &'a OpenLoop,
) -> Result<BeltRows<'a>, Error> {
    let dt = CONTROL_PERIOD / steps as f64;
    let mut run = Run::new(params.build::<N>(R::lit(dt))?, dt, steps, input);
    let instants = input.time.resampled(CONTROL_PERIOD);
    Ok(Box::new(instants.map(move |instant| run.row(instant))))
}

/// A run of a belt gear through its inputs.
struct Run<'a, R: Real, const N: usize> {
    belt: Belt<R, AnyFriction<R>, N>,
    state: BeltState<R, AnyFrictionState<R>, N>,
    output: Motion<R>,
    dt: f64,
    steps: usize,
    trajectory: Trajectory,
    /// Angle of the motor at the first stamp (rad).
    start: f64,
    input: &'a OpenLoop,
}

impl<'a, R: Real, const N: usize> Run<'a, R, N> {
    fn new(belt: Belt<R, AnyFriction<R>, N>, dt: f64, steps: usize, input: &'a OpenLoop) -> Self {
        let start = match &input.drive {
            Drive::Position(position) => position[0],
            Drive::Velocity(_) => 0.0,
        };
        let trajectory = Trajectory::new(input.time.stamps(), &input.drive);
        let state = belt.running(R::lit(trajectory.at(0.0).velocity));
        let mut run = Self { belt, state, output: Motion::default(), dt, steps, trajectory, start, input };
        run.run_in();
        run
    }

    fn run_in(&mut self) {
        let count = (RUN_IN / self.dt).round() as usize;
        for step in (1..=count).rev() {
            let motor = self.motor(-(step as f64) * self.dt);
            let output = self.without_torsion(&motor);
            self.belt.torques(&mut self.state, &motor, &output, Applied::default());
        }
        self.output = self.without_torsion(&self.motor(0.0));
    }

    /// The output's motion without torsion.
    fn without_torsion(&self, motor: &Motion<R>) -> Motion<R> {
        let ratio = self.belt.ratio();
        let angle = Angle::from_radians_f64(motor.angle.to_radians() * ratio.to_f64());
        let mut output = Motion { angle, velocity: R::ZERO };
        // The pitch error of the output depends little on its own angle: each turn leaves a thousandth.
        for _ in 0..4 {
            output.angle = output.angle.plus(self.belt.torsion(motor, &output));
        }
        output.velocity = ratio * motor.velocity;
        output
    }

    fn motor(&self, elapsed: f64) -> Motion<R> {
        let sample = self.trajectory.at(elapsed);
        Motion {
            angle: Angle::from_radians_f64(self.start + sample.angle),
            velocity: R::lit(sample.velocity),
        }
    }

    /// The row of an instant, and the way to the next.
    fn row(&mut self, instant: Instant) -> BeltRow {
        let output = self.output;
        let first = self.step(instant.elapsed);
        for done in 1..self.steps {
            self.step(instant.elapsed + done as f64 * self.dt);
        }
        let acceleration = self.trajectory.at(instant.elapsed).acceleration;
        BeltRow {
            time: self.input.time.stamps()[0] + instant.elapsed,
            output_position: output.angle.to_radians(),
            output_velocity: output.velocity.to_f64(),
            motor_torque: self.belt.motor_inertia().to_f64() * acceleration + first.motor.to_f64(),
            torsion: first.torsion.to_f64(),
            transmitted_torque: first.transmitted.to_f64(),
            forward_force: first.forward.to_f64(),
            backward_force: first.backward.to_f64(),
        }
    }

    fn step(&mut self, elapsed: f64) -> BeltTorques<R> {
        let motor = self.motor(elapsed);
        let load = R::lit(self.input.time.at(elapsed).of(&self.input.load_torque));
        self.belt.step(&mut self.state, &mut self.output, &motor, load)
    }
}
