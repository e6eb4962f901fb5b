//! The gear as a two-port, open loop: wave-generator motion and load in, output motion and torques out.
//!
//! ```text
//! in:  theta_wg(t) or omega_wg(t), tau_load(t)
//! out: theta_fs, omega_fs, tau_wg = J_wg*d2theta_wg + tau_fric_in + (r + de/dtheta_wg)*tau_t,  phi, tau_t
//! ```
//!
//! Units and signs as in [`strainwave::gear`]; tau_load is the external torque ON the flexspline.
//!
//! The run starts without torsion, theta_fs = r*theta_wg + e, and with both ends in the same motion:
//! an input that starts at speed starts a gear that runs. For [`RUN_IN`] before the first stamp both
//! ends are led at that speed, so that the mesh moves with them and friction is that of the motion;
//! the hysteresis starts without memory.
//!
//! Discretisation: a row every 0.1 ms from the first stamp of the input. The real-time build takes one
//! step for it, the reference build as many micro-steps as its mesh needs. Between the input's
//! stamps the load is linear; for the wave generator see `trajectory.rs`. A row holds the values at
//! its instant. After each, the mesh's most strained link is checked: a run that diverges ends there.
//!
//! The models start at the zero angle. A wave generator that is run in from theta_0 is therefore
//! counted from there: theta_fs gets r*theta_0 added back, and a term of order k of the kinematic error has
//! its phase advanced by k*theta_0 (k*(1 - r)*theta_0 relative to the flexspline), as has order k of the ripple of
//! friction, and the ellipse stands at (1 - r)*theta_0 on the flexspline.

mod gauge;
pub(crate) mod trajectory;

use std::f64::consts::TAU;
use std::num::NonZeroUsize;

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY, MESH, RealTimeFlexspline};
use strainwave::flexspline::{FlexsplineParams, Mesh, NodeForce};
use strainwave::friction::{
    AnyFrictionParams, FrictionModel, FrictionParams, Harmonics, JointFrictionOfOrder, JointFrictionParams,
};
use strainwave::gear::{Applied, Gear, GearParams, GearState, Motion, Torques};
use strainwave::{Angle, Error, Real};

use crate::design::joint::gear_params;
use crate::io::gear_file::{GearFile, Harmonic};
use crate::io::log::{Drive, Instant, OpenLoop, OpenLoopRow};
use crate::plant::divergence::{Diverged, RunError, may_go_on};
use crate::plant::mesh_size::{MeshSize, OnMesh};
use crate::plant::{LEVELS, MEMORY, Reference};
pub use gauge::Gauge;
use gauge::{EndForces, Gauged, Turned};
use trajectory::Trajectory;

/// Time of the run-in before the start (s): several times the mesh's transient.
pub const RUN_IN: f64 = 20.0 * CONTROL_PERIOD;

/// Which build of the models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Build {
    /// f64, literal eq. (6), micro-steps.
    Reference {
        /// Nodes of the mesh.
        mesh: MeshSize,
        /// Longest micro-step (s); a fraction of the stable one when there is none.
        longest_step: Option<f64>,
    },
    /// f32, condensed mesh, one step per 0.1 ms: the code of the joint controller, where the observer steps it by 0.2 ms.
    RealTime,
}

impl Build {
    /// The reference build that the plant has.
    pub const REFERENCE: Self = Self::Reference { mesh: MeshSize::DEFAULT, longest_step: None };

    /// Nodes of its mesh around and along the axis.
    pub fn nodes(self) -> (usize, usize) {
        match self {
            Self::Reference { mesh, .. } => mesh.nodes(),
            Self::RealTime => MESH,
        }
    }
}

/// The rows of a run, computed one by one, up to one that fails.
pub type Rows<'a> = Box<dyn ExactSizeIterator<Item = Result<OpenLoopRow, RunError>> + 'a>;

/// What is measured on the flexspline of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured<'a> {
    /// Strain gauges, in every row.
    pub gauges: &'a [Gauge],
    /// Forces on the flexspline's ends, in every so many rows from the first; a real-time build has none.
    pub forces_every: Option<NonZeroUsize>,
}

/// Runs the gear of a file open loop, with the strains of some gauges.
///
/// # Errors
/// As [`run_measured`].
pub fn run<'a>(
    file: &GearFile,
    input: &'a OpenLoop,
    build: Build,
    gauges: &'a [Gauge],
) -> Result<Rows<'a>, Error> {
    run_measured(file, input, build, Measured { gauges, ..Measured::default() })
}

/// Runs the gear of a file open loop, with what is measured on its flexspline.
///
/// # Errors
/// As [`GearParams::build`] and [`Reference::build`].
pub fn run_measured<'a>(
    file: &GearFile,
    input: &'a OpenLoop,
    build: Build,
    measured: Measured<'a>,
) -> Result<Rows<'a>, Error> {
    let trajectory = Trajectory::new(input.time.stamps(), &input.drive);
    let first = match &input.drive {
        Drive::Position(position) => position[0],
        Drive::Velocity(_) => 0.0,
    };
    let start = first + trajectory.at(-RUN_IN).angle;
    let r: f64 = file.gear.signed_ratio().value();
    let inputs = Inputs {
        trajectory,
        log: input,
        start,
        ellipse: wrapped((1.0 - r) * start),
        measured,
        wave_generator_inertia: file.inertia.wave_generator,
    };
    match build {
        Build::Reference { mesh, longest_step } => {
            mesh.run(ReferenceRun { params: counted_from(file, start), longest_step, inputs })
        }
        Build::RealTime => {
            let params = counted_from::<f32>(file, start);
            let model = RealTimeFlexspline::build(&params.flexspline, params.rated_torque)?;
            rows::<_, _, _, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>(&params, model, CONTROL_PERIOD, 1, inputs)
        }
    }
}

/// Largest stable step of the reference mesh of a gear (s).
pub fn stable_step(file: &GearFile, mesh: MeshSize) -> f64 {
    struct StableStep(FlexsplineParams<f64>);

    impl OnMesh for StableStep {
        type Output = f64;

        fn run<const N: usize, const M: usize>(self) -> f64 {
            Mesh::<f64, N, M>::stable_step(&self.0)
        }
    }

    mesh.run(StableStep(gear_params(file).flexspline))
}

/// A run of the reference build, its mesh of any size.
struct ReferenceRun<'a> {
    params: GearParams<f64, AnyFrictionParams<f64>>,
    longest_step: Option<f64>,
    inputs: Inputs<'a>,
}

impl<'a> OnMesh for ReferenceRun<'a> {
    type Output = Result<Rows<'a>, Error>;

    fn run<const N: usize, const M: usize>(self) -> Self::Output {
        let Reference { mesh, dt, steps } =
            Reference::<N, M>::build(&self.params.flexspline, self.longest_step)?;
        rows::<_, _, _, LEVELS, MEMORY>(&self.params, mesh, dt, steps, self.inputs)
    }
}

/// The gear of a file, its wave-generator angle counted from `start` (rad).
fn counted_from<R: Real>(file: &GearFile, start: f64) -> GearParams<R, AnyFrictionParams<R>> {
    let mut counted = file.clone();
    let advance = |terms: &mut [Harmonic], angle: f64| {
        for term in terms {
            term.phase = wrapped(term.phase + f64::from(term.order) * angle);
        }
    };
    let r: f64 = file.gear.signed_ratio().value();
    advance(&mut counted.kinematic_error.wave_generator, start);
    advance(&mut counted.kinematic_error.flexspline, (1.0 - r) * start);
    let mut params = gear_params(&counted);
    for side in [&mut params.input_friction, &mut params.output_friction] {
        if let AnyFrictionParams::BlimanSorine1(JointFrictionOfOrder(JointFrictionParams {
            ripple, ..
        }))
        | AnyFrictionParams::BlimanSorine2(JointFrictionOfOrder(JointFrictionParams {
            ripple, ..
        })) = side
        {
            advance_ripple(&mut ripple.forward, start);
            advance_ripple(&mut ripple.backward, start);
        }
    }
    params
}

/// a*cos(k*x) + b*sin(k*x) at x + `angle` (rad), of every order k.
fn advance_ripple<R: Real, const K: usize>(harmonics: &mut Harmonics<R, K>, angle: f64) {
    for (index, (a, b)) in harmonics.cosines.iter_mut().zip(&mut harmonics.sines).enumerate() {
        let (sine, cosine) = ((index + 1) as f64 * angle).sin_cos();
        let (at_zero, quarter_on) = (a.to_f64(), b.to_f64());
        *a = R::lit(at_zero * cosine + quarter_on * sine);
        *b = R::lit(quarter_on * cosine - at_zero * sine);
    }
}

/// Within half a revolution either way (rad).
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The rows of a gear around `model`, in `steps` steps of `dt` (s) each.
fn rows<'a, R: Real, F: Gauged<R> + 'a, P: FrictionParams<R>, const L: usize, const MEMORY: usize>(
    params: &GearParams<R, P>,
    model: F,
    dt: f64,
    steps: usize,
    inputs: Inputs<'a>,
) -> Result<Rows<'a>, Error> {
    let flexspline = Turned { model, zero: Angle::from_radians_f64(-inputs.ellipse) };
    let gear: Gear<R, _, _, L, MEMORY> = params.build(flexspline, R::lit(dt))?;
    let mut simulation = Simulation::new(gear, dt, steps, inputs);
    let instants = simulation.inputs.log.time.resampled(CONTROL_PERIOD);
    Ok(Box::new(instants.map(move |instant| simulation.row(instant))))
}

/// Inputs of a gear, over the time since the first stamp.
struct Inputs<'a> {
    trajectory: Trajectory,
    log: &'a OpenLoop,
    /// Start of the run-in, and zero of the wave generator (rad).
    start: f64,
    /// Angle of its major axis on the flexspline then (rad).
    ellipse: f64,
    measured: Measured<'a>,
    wave_generator_inertia: f64,
}

impl Inputs<'_> {
    fn wave_generator<R: Real>(&self, elapsed: f64) -> Motion<R> {
        let sample = self.trajectory.at(elapsed);
        let angle = sample.angle - self.trajectory.at(-RUN_IN).angle;
        Motion { angle: Angle::from_radians_f64(angle), velocity: R::lit(sample.velocity) }
    }

    fn load<R: Real>(&self, elapsed: f64) -> R {
        R::lit(self.log.time.at(elapsed).of(&self.log.load_torque))
    }
}

/// A run of a gear through its inputs.
struct Simulation<'a, R: Real, F: Gauged<R>, C: FrictionModel<R>, const L: usize, const MEMORY: usize> {
    gear: Gear<R, Turned<R, F>, C, L, MEMORY>,
    state: GearState<R, F::State, C::State, MEMORY>,
    flange: Motion<R>,
    dt: f64,
    /// Steps of dt in a control period.
    steps: usize,
    /// Rows so far.
    rows: usize,
    inputs: Inputs<'a>,
}

impl<'a, R: Real, F: Gauged<R>, C: FrictionModel<R>, const L: usize, const MEMORY: usize>
    Simulation<'a, R, F, C, L, MEMORY>
{
    fn new(gear: Gear<R, Turned<R, F>, C, L, MEMORY>, dt: f64, steps: usize, inputs: Inputs<'a>) -> Self {
        let (state, flange) = (gear.rest(), Motion::default());
        let mut simulation = Self { state, flange, gear, dt, steps, rows: 0, inputs };
        simulation.run_in();
        simulation
    }

    fn run_in(&mut self) {
        let count = (RUN_IN / self.dt).round() as usize;
        for step in (1..=count).rev() {
            let wave_generator = self.inputs.wave_generator(-(step as f64) * self.dt);
            let flange = self.unloaded(&wave_generator);
            self.gear.torques(&mut self.state, &wave_generator, &flange, Applied::default());
        }
        self.flange = self.unloaded(&self.inputs.wave_generator(0.0));
    }

    /// The flange's motion without torsion.
    fn unloaded(&self, wave_generator: &Motion<R>) -> Motion<R> {
        let angle = wave_generator.angle;
        let slope = self.gear.ratio().value::<R>() + self.gear.kinematic_error(angle, angle.heading()).slope;
        Motion { angle: self.gear.drive(angle), velocity: slope * wave_generator.velocity }
    }

    /// The row of an instant, and the way to the next.
    fn row(&mut self, instant: Instant) -> Result<OpenLoopRow, RunError> {
        let start = self.inputs.log.time.stamps()[0];
        let strains = self.strains(instant.elapsed)?;
        let forces = self.forces(instant.elapsed);
        self.rows += 1;
        let flange = self.flange;
        let first = self.step(instant.elapsed);
        let (mut last, mut done) = (first, 1);
        while done < self.steps && may_go_on(&last) {
            last = self.step(instant.elapsed + done as f64 * self.dt);
            done += 1;
        }
        let time = start + instant.elapsed + done as f64 * self.dt;
        Diverged::check(time, self.gear.flexspline(), self.state.flexspline(), &last)?;
        let inputs = &self.inputs;
        let acceleration = inputs.trajectory.at(instant.elapsed).acceleration;
        Ok(OpenLoopRow {
            time: start + instant.elapsed,
            output_position: self.gear.ratio().value::<f64>() * inputs.start + flange.angle.to_radians(),
            output_velocity: flange.velocity.to_f64(),
            input_torque: inputs.wave_generator_inertia * acceleration + first.wave_generator.to_f64(),
            torsion: first.torsion.to_f64(),
            transmitted_torque: first.transmitted.to_f64(),
            shell_torque: first.transmitted.to_f64() - first.hysteresis.to_f64(),
            strains,
            forces,
        })
    }

    /// The gauges' strains before a step.
    fn strains(&self, elapsed: f64) -> Result<Vec<f64>, Error> {
        let ends = self.gear.flexspline_ends(&self.inputs.wave_generator(elapsed), &self.flange);
        let flexspline = self.gear.flexspline();
        let strain = |gauge| flexspline.strain(self.state.flexspline(), &ends, gauge).map(R::to_f64);
        self.inputs.measured.gauges.iter().map(strain).collect()
    }

    /// The forces on the flexspline's ends before a step, of a row that has them (N).
    fn forces(&self, elapsed: f64) -> Option<EndForces<f64>> {
        self.inputs.measured.forces_every.filter(|every| self.rows.is_multiple_of(every.get()))?;
        let ends = self.gear.flexspline_ends(&self.inputs.wave_generator(elapsed), &self.flange);
        let forces = self.gear.flexspline().end_forces(self.state.flexspline(), &ends)?;
        let in_f64 = |force: NodeForce<R>| NodeForce {
            radial: force.radial.to_f64(),
            tangential: force.tangential.to_f64(),
            axial: force.axial.to_f64(),
        };
        Some(forces.map(|end| end.into_iter().map(in_f64).collect()))
    }

    fn step(&mut self, elapsed: f64) -> Torques<R> {
        let (wave_generator, load) = (self.inputs.wave_generator(elapsed), self.inputs.load(elapsed));
        self.gear.step(&mut self.state, &mut self.flange, &wave_generator, load)
    }
}
