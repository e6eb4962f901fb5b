//! The mesh of eq. (6) as this controller would have to step it, literally: what its reduction saves.
//!
//! ```text
//! phi(t) = phi_end*(3 u^2 - 2 u^3),   u = t/T,   theta_fs = 0,   theta_wg = phi/r
//! ```
//!
//! The output is held; the motor winds the flexspline up over both knees of its stiffness line, stops and
//! holds it. Within a control period the ends move evenly. The mesh takes as many micro-steps in it as keep
//! each below [`STEP_SHARE`] of the stable one, like the desktop's plant. In the end its torque must be
//! the [`RealTimeFlexspline`]'s: what is counted is a mesh that works. Torsion in rad, torque in N m, positive when the
//! drive is ahead of the flange.

use strainwave::compensator::{JointParams, RealTimeFlexspline};
use strainwave::flexspline::{Ends, Flexspline, FlexsplineParams, Mesh};
use strainwave::{Angle, Error, Ratio};

/// Parameters of the default gear.
pub mod default_gear {
    include!("../../../examples/joint/hd25_100.rs");
}

/// The coarsest mesh that is calibrated: 8 nodes around, 3 along the axis.
type CoarseMesh = Mesh<f32, 8, 3>;

/// Largest micro-step as a fraction of the mesh's stable step.
pub const STEP_SHARE: f32 = 0.95;

/// Control periods of the whole run.
pub const PERIODS: u32 = 50;

/// Of these, those of the motion. In the rest the contact and the links come to rest, whose time constants are
/// some control periods.
const RISE: u32 = 30;

/// Torque at the end, in torques of the second knee.
const WIND_UP: f32 = 1.25;

/// Largest difference of the mesh to its reduction in the end, relative to the torque.
pub const AGREEMENT: f32 = 1e-3;

/// Torques on the held output at the end of the wind-up (N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindUp {
    /// By the mesh.
    pub literal: f32,
    /// By its reduction.
    pub reduced: f32,
}

impl WindUp {
    /// The two are one flexspline; NaN is none.
    pub fn agrees(&self) -> bool {
        (self.literal - self.reduced).abs() <= AGREEMENT * self.reduced
    }
}

/// Winds the joint's flexspline up, control period by control period.
///
/// # Errors
/// [`Error::OutOfRange`] with the name of a constant that the joint's file has wrong.
pub fn wind_up(joint: &JointParams<f32>) -> Result<WindUp, Error> {
    let params = &joint.gear.flexspline;
    let ratio = Ratio::one_over(joint.gear.ratio)?;
    let reduced = RealTimeFlexspline::build(params, joint.gear.rated_torque)?;
    let torsion = reduced.torsion(WIND_UP * params.line.knee_torque[1]);
    let mut mesh = LiteralMesh::build(params, joint.dt)?;
    let mut ends = Ends::default();
    let mut literal = 0.0;
    for period in 0..PERIODS {
        let next = torsion * fraction(period + 1);
        ends.drive_rate = (next - ends.drive.minus(ends.flange)) / joint.dt;
        ends.wave_generator_rate = ends.drive_rate * ratio.n() as f32;
        literal = mesh.period(&ends);
        ends.drive = Angle::from_radians(next);
        ends.wave_generator = ratio.to_motor(ends.drive);
    }
    Ok(WindUp { literal, reduced: reduced.torque(ends.drive.minus(ends.flange), 0.0) })
}

/// Fraction of the torsion after so many periods.
fn fraction(periods: u32) -> f32 {
    let u = (periods as f32 / RISE as f32).min(1.0);
    u * u * (3.0 - 2.0 * u)
}

/// A mesh and the micro-steps that it takes in a control period.
struct LiteralMesh {
    mesh: CoarseMesh,
    state: <CoarseMesh as Flexspline<f32>>::State,
    /// Micro-step (s).
    dt: f32,
    steps: u32,
}

impl LiteralMesh {
    /// At rest; `period` is the control period (s).
    fn build(params: &FlexsplineParams<f32>, period: f32) -> Result<Self, Error> {
        params.check()?;
        let steps = (period / (STEP_SHARE * CoarseMesh::stable_step(params))) as u32 + 1;
        let dt = period / steps as f32;
        let mesh = CoarseMesh::build(params, dt)?;
        let state = mesh.rest();
        Ok(Self { mesh, state, dt, steps })
    }

    /// One control period from `ends` on: the torque on the flange (N m).
    #[inline(never)] // The budget counts it by its symbol.
    fn period(&mut self, ends: &Ends<f32>) -> f32 {
        let mut ends = *ends;
        let mut torque = 0.0;
        for _ in 0..self.steps {
            torque = self.mesh.step(&mut self.state, &ends).flange;
            ends.drive = ends.drive.plus(self.dt * ends.drive_rate);
            ends.wave_generator = ends.wave_generator.plus(self.dt * ends.wave_generator_rate);
        }
        torque
    }
}
