//! The flexspline as the mass-spring shell of eq. (6), driven at the rim and held by the flange.
//!
//! The nodes between are those of [`Shell`]. Slice 0 is the toothed rim: it rotates as one by its own angle
//! psi (inertia of its nodes), pressed by the wave generator into the inextensional ellipse, radial
//! w0*cos(2b), tangential -(w0/2)*sin(2b), b = angle from the wave generator's major axis. The tooth contact
//! (`contact_line`, with its dashpot) drives it towards r*theta_wg + e. Slice m-1 is rigid with the output
//! flange. Every torque is the virtual work of the link forces on the nodes that its angle moves:
//!
//! ```text
//! J_rim * ddpsi = contact(delta) + c*ddelta + sum F . dp/dpsi,   delta = r*theta_wg + e - psi
//! flange  = sum F . dp/dtheta_fs,     ellipse = sum F . dp/dtheta_wg
//! ```
//!
//! With [`Hardening::Bends`] the rim is where the drive is, the dashpot lies across the whole flexspline, and the bend links
//! harden from the assembled shape (`shell/assembled.rs`).
//!
//! Discretisation: the shell's; the contact's dashpot implicit, because it is stiff against the rim's
//! small inertia. Stable while dt < 2/omega_max, see [`Mesh::stable_step`].

#[cfg(test)]
mod tests;

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::flexspline::calibration::{FlexsplineParams, Hardening};
use crate::flexspline::shell::assembled::Assembled;
use crate::flexspline::shell::ring::Ring;
use crate::flexspline::shell::{
    Bend, Shell, ShellParams, ShellState, Slice, Strained, UnitVectors, check_nodes, close, sum, unit_vectors,
};
use crate::flexspline::spectrum;
use crate::flexspline::stiffness_line::StiffnessLine;
use crate::flexspline::{Ends, Flexspline, Reaction};
use crate::real::Real;

/// Steps that settle a mesh at its stable step from round to elliptic; a test bounds the torque that is left.
const RELAXATION_STEPS: usize = 4000;
/// Angles of the wave generator, between one node and the next, at which the assembled shape is taken.
const SHAPES: i32 = 4;

/// The n x m mesh with its tooth contact, stepped by a fixed dt.
///
/// Held at one end and turned at the other, the settled mesh has the catalogue's stiffness K1, and so has its reduction,
/// which needs no steps:
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::Angle;
/// use strainwave::flexspline::{Ends, Flexspline, Mesh, Reduced};
///
/// let params = JOINT.gear.flexspline;
/// let mesh = Mesh::<f32, 8, 3>::build(&params, 0.9 * Mesh::<f32, 8, 3>::stable_step(&params))?;
/// let reduced = Reduced::<f32, 8, 3>::build(&params, JOINT.gear.rated_torque)?;
/// let torsion = 3e-4; // rad; below the first knee
/// let ends = Ends { drive: Angle::from_radians(torsion), ..Ends::default() };
/// let mut state = mesh.rest();
/// mesh.relax(&mut state, &ends, 4000);
/// let torque = mesh.step(&mut state, &ends).flange; // N m
/// let [k1, ..] = params.line.stiffness;
/// assert!((torque / torsion / k1 - 1.0).abs() < 0.01, "{torque}");
/// assert!((torque - reduced.torque(torsion, 0.0)).abs() < 0.01 * JOINT.gear.rated_torque);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<R, const N: usize, const M: usize> {
    shell: Shell<R, N, M>,
    /// None: the rim is where the drive is.
    contact: Option<StiffnessLine<R>>,
    contact_damping: R,
    radius: R,
    ellipse: R,
    /// Cosine and sine of twice each node's angle.
    twice: UnitVectors<R, N>,
    rim_inertia: R,
    dt: R,
    dt_over_rim_inertia: R,
    rim_implicit: R,
}

/// Positions and velocities of the nodes, and the rim's own motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshState<R, const N: usize, const M: usize> {
    shell: ShellState<R, N, M>,
    rim: Angle<R>,
    rim_rate: R,
}

impl<R: Real, const N: usize, const M: usize> MeshState<R, N, M> {
    /// The nodes.
    pub fn shell(&self) -> &ShellState<R, N, M> {
        &self.shell
    }

    /// Takes all velocities away; answers with the kinetic energy that is left, 0 (J).
    fn stop(&mut self) -> R {
        self.shell.stop();
        self.rim_rate = R::ZERO;
        R::ZERO
    }
}

/// Displacement of an end slice's nodes in x and y per unit of an angle (m/rad), by entry.
type Displacement<R, const N: usize> = [[R; N]; 2];

/// Displacements of the rim nodes by the two angles that move them, and of the flange's by its own.
struct EndShapes<R, const N: usize> {
    by_rim: Displacement<R, N>,
    by_wave_generator: Displacement<R, N>,
    by_flange: Displacement<R, N>,
}

/// 1 for the slices between rim and flange, 0 for these.
fn inner<R: Real, const M: usize>() -> [R; M] {
    core::array::from_fn(|j| if j == 0 || j == M - 1 { R::ZERO } else { R::ONE })
}

/// Inertia of the rim, which has half the mass of an inner slice (kg m^2).
fn rim_inertia<R: Real>(shell: &ShellParams<R>, n: usize, m: usize) -> R {
    let radius = shell.cup.radius;
    R::lit(0.5) * R::from_i32(n as i32) * shell.node_mass(n, m) * radius * radius
}

impl<R: Real, const N: usize, const M: usize> Mesh<R, N, M> {
    /// Largest stable time step of this mesh (s).
    ///
    /// Of a positive matrix the largest eigenvalue is at most the sum of those of its diagonal blocks: the
    /// inner slices, and the rim, which rotates as one between its links and the tooth contact.
    pub fn stable_step(params: &FlexsplineParams<R>) -> R {
        let shell = params.shell::<M>(N);
        let contact = match params.hardening {
            Hardening::Contact => params.contact_line().stiffness.into_iter().fold(R::ZERO, R::max),
            Hardening::Bends => R::ZERO,
        };
        let contact = contact / rim_inertia(&shell, N, M) * shell.node_mass(N, M) / shell.link_stiffness;
        let links =
            spectrum::largest(&params.cup, N, inner::<R, M>()) + spectrum::of_rim::<R, M>(&params.cup, N);
        shell.step_below(links + contact, N, M)
    }

    /// A harmonic around the ring of the round, unloaded shape with rim and flange held: the symmetric matrix, over
    /// slices and components (radial, tangential, axial), whose eigenvalues are the squares of the natural angular
    /// frequencies (1/s^2), besides 0 for what is held. In harmonic 0 the tangential part is torsion.
    pub fn harmonic(params: &FlexsplineParams<R>, order: usize) -> spectrum::Matrix<R, M> {
        let shell = params.shell::<M>(N);
        let stiffness_over_mass = (shell.link_stiffness / shell.node_mass(N, M)).sqrt();
        spectrum::harmonic(&params.cup, N, order, inner().map(|free: R| free * stiffness_over_mass))
    }

    /// Calibrates the links (see [`super::calibration`]) for a time step dt (s).
    ///
    /// # Errors
    /// As [`FlexsplineParams::check`] and [`Shell::build`]; `dt` not below [`Mesh::stable_step`].
    pub fn build(params: &FlexsplineParams<R>, dt: R) -> Result<Self, Error> {
        check_nodes(N, M)?;
        params.check()?;
        let shell_params = params.shell::<M>(N);
        require(dt < Self::stable_step(params), "dt")?;
        let mesh = Self {
            shell: Shell::build(&shell_params, dt)?,
            contact: Some(params.contact_line().build()?),
            contact_damping: params.contact_damping(),
            radius: params.cup.radius,
            ellipse: params.cup.ellipse,
            twice: unit_vectors(2),
            rim_inertia: rim_inertia(&shell_params, N, M),
            dt,
            dt_over_rim_inertia: R::ZERO,
            rim_implicit: R::ZERO,
        };
        let mesh = mesh.with_step(dt);
        match params.hardening {
            Hardening::Contact => Ok(mesh),
            Hardening::Bends => mesh.hardening(params, &shell_params),
        }
    }

    /// The same mesh without a contact spring, its bend links hardening from the assembled shape.
    fn hardening(mut self, params: &FlexsplineParams<R>, shell: &ShellParams<R>) -> Result<Self, Error> {
        require(M > 2, "m")?;
        require(shell.bend.hardening > R::ZERO, "stiffness")?;
        (self.contact, self.contact_damping, self.rim_inertia) = (None, params.damping(), R::ZERO);
        let linear = ShellParams { bend: Bend::LINEAR, ..*shell };
        let soft = Self { shell: Shell::build(&linear, self.dt)?, ..self.clone() };
        let mut assembled = Assembled::ROUND;
        for k in 0..SHAPES {
            let wave_generator = Angle::from_turn_fraction(k, SHAPES * N as i32);
            let ends = Ends { wave_generator, ..Ends::default() };
            let twice = soft.twice_from_axis(Angle::default(), &ends);
            let state = soft.rest_at(wave_generator);
            let entries = twice.map(|ring| *ring.entries());
            self.shell.add_assembled(&mut assembled, SHAPES, soft.placed(&state, &ends).shell(), &entries);
        }
        self.shell = self.shell.hardening_from(assembled);
        Ok(self)
    }

    /// Cosine and sine of twice each node's angle from the major axis.
    #[inline(always)]
    fn twice_from_axis(&self, rim: Angle<R>, ends: &Ends<R>) -> [Ring<R, N>; 2] {
        let twice = twice_between(rim, ends.wave_generator).sin_cos();
        let mut rings = [Ring::ZERO; 2];
        let [cosine, sine] = rings.each_mut().map(Ring::entries_mut);
        for i in 0..N {
            (cosine[i], sine[i]) = turned_by(&self.twice, i, twice);
        }
        for ring in &mut rings {
            ring.close();
        }
        rings
    }

    /// The rim at the drive, where no contact spring lies between them.
    #[inline(always)]
    fn lead_rim(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>) {
        if self.contact.is_none() {
            (state.rim, state.rim_rate) = (ends.drive, ends.drive_rate);
        }
    }

    /// The same mesh, stepped by dt.
    fn with_step(&self, dt: R) -> Self {
        let dt_over_rim_inertia = dt / self.rim_inertia;
        Self {
            shell: self.shell.with_step(dt),
            dt,
            dt_over_rim_inertia,
            rim_implicit: R::ONE / (R::ONE + dt_over_rim_inertia * self.contact_damping),
            ..self.clone()
        }
    }

    /// The shell, for the strains of its links.
    pub fn shell(&self) -> &Shell<R, N, M> {
        &self.shell
    }

    /// The assembled shape without torsion, both ends at the zero angle: round slices, the rim pressed into its
    /// ellipse by a wave generator at this angle, the nodes settled.
    pub fn rest_at(&self, wave_generator: Angle<R>) -> MeshState<R, N, M> {
        let mut state = MeshState { shell: self.shell.round(), rim: Angle::default(), rim_rate: R::ZERO };
        self.relax(&mut state, &Ends { wave_generator, ..Ends::default() }, RELAXATION_STEPS);
        state
    }

    /// Lets the nodes settle with the ends held: `steps` steps of dt/2, all motion stopped whenever the kinetic
    /// energy has peaked (dynamic relaxation with kinetic damping, P. Cundall, 1976).
    ///
    /// After a stop the nodes set out with a whole step's velocity where the scheme has half of it: stopped every
    /// time, x' = (1 - (omega*dt)^2)*x, which would grow beyond omega*dt = sqrt(2). Hence dt/2.
    pub fn relax(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>, steps: usize) {
        self.relax_by(state, steps, |slowed, state| {
            slowed.step(state, ends);
        });
    }

    /// As [`Self::relax`], each step of the slowed mesh taken by `step`.
    pub fn relax_by(
        &self,
        state: &mut MeshState<R, N, M>,
        steps: usize,
        step: impl Fn(&Self, &mut MeshState<R, N, M>),
    ) {
        let slowed = self.with_step(R::lit(0.5) * self.dt);
        let mut last = R::ZERO;
        for _ in 0..steps {
            step(&slowed, state);
            let kinetic = self.kinetic_energy(state);
            last = if kinetic < last { state.stop() } else { kinetic };
        }
        state.stop();
    }

    /// [`Flexspline::step`], compiled with the instructions of its caller.
    #[inline(always)]
    pub fn step_inlined(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>) -> Reaction<R> {
        let shapes = self.place_ends(state, ends);
        let mut force = [[Ring::ZERO; 3]; M];
        let (link_loss, turned) = self.pull(state, ends, &mut force);
        self.shell.advance(&mut state.shell, &force, 1..M - 1);
        let links = virtual_work(&force[0], &shapes.by_rim) + turned;
        let [contact, beside, contact_loss] = self.advance_rim(state, ends, links);
        Reaction {
            torsion: ends.drive.minus(ends.flange),
            contact,
            flange: virtual_work(&force[M - 1], &shapes.by_flange) + beside,
            ellipse: virtual_work(&force[0], &shapes.by_wave_generator) - turned,
            loss: link_loss + contact_loss,
            saturated: false,
        }
    }

    /// The same with both ends where `ends` has them: a step leaves them where it found them.
    pub fn placed(&self, state: &MeshState<R, N, M>, ends: &Ends<R>) -> MeshState<R, N, M> {
        let mut placed = *state;
        self.place_ends(&mut placed, ends);
        placed
    }

    /// Sets the end slices to their angles.
    #[inline(always)]
    fn place_ends(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>) -> EndShapes<R, N> {
        self.lead_rim(state, ends);
        let (by_rim, by_wave_generator) = self.place_rim(state, ends);
        EndShapes { by_rim, by_wave_generator, by_flange: self.place_flange(&mut state.shell, ends) }
    }

    /// The rim pressed into the ellipse: p = (R + w0*c)*e_r - (w0/2)*s*e_t, with c, s = cos, sin(2b).
    #[inline(always)]
    fn place_rim(
        &self,
        state: &mut MeshState<R, N, M>,
        ends: &Ends<R>,
    ) -> (Displacement<R, N>, Displacement<R, N>) {
        let rotation = state.rim.sin_cos();
        let twice = twice_between(state.rim, ends.wave_generator).sin_cos();
        let (mut by_rim, mut by_wave_generator) = ([[R::ZERO; N]; 2], [[R::ZERO; N]; 2]);
        let [x, y, _] = state.shell.position[0].each_mut().map(|axis| axis.entries_mut());
        for i in 0..N {
            let (cosine, sine) = turned_by(self.shell.angles(), i, rotation);
            let (c, s) = turned_by(&self.twice, i, twice);
            let (c, s) = (self.ellipse * c, self.ellipse * s);
            let place = |radial: R, tangential: R| {
                (radial * cosine - tangential * sine, radial * sine + tangential * cosine)
            };
            (x[i], y[i]) = place(self.radius + c, R::lit(-0.5) * s);
            (by_rim[0][i], by_rim[1][i]) = place(R::lit(-1.5) * s, self.radius);
            (by_wave_generator[0][i], by_wave_generator[1][i]) = place(R::lit(2.0) * s, c);
        }
        close(&mut state.shell.position[0]);
        let rates = [(&by_rim, state.rim_rate), (&by_wave_generator, ends.wave_generator_rate)];
        move_with(&mut state.shell.velocity[0], rates);
        (by_rim, by_wave_generator)
    }

    /// The flange, round and rigid.
    #[inline(always)]
    fn place_flange(&self, shell: &mut ShellState<R, N, M>, ends: &Ends<R>) -> Displacement<R, N> {
        let rotation = ends.flange.sin_cos();
        let mut by_flange = [[R::ZERO; N]; 2];
        let [x, y, _] = shell.position[M - 1].each_mut().map(|axis| axis.entries_mut());
        for i in 0..N {
            let (cosine, sine) = turned_by(self.shell.angles(), i, rotation);
            (x[i], y[i]) = (self.radius * cosine, self.radius * sine);
            (by_flange[0][i], by_flange[1][i]) = (-y[i], x[i]);
        }
        close(&mut shell.position[M - 1]);
        move_with(&mut shell.velocity[M - 1], [(&by_flange, ends.flange_rate)]);
        by_flange
    }

    /// Moves the rim by one step, the dashpot implicit; answers with the contact's torque, that which passes it by to the flange,
    /// and the loss.
    #[inline(always)]
    fn advance_rim(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>, links: R) -> [R; 3] {
        let Some(contact) = &self.contact else {
            let slip = ends.drive_rate - ends.flange_rate;
            let dashpot = self.contact_damping * slip;
            return [dashpot - links, dashpot, dashpot * slip];
        };
        let elastic = contact.torque(ends.drive.minus(state.rim));
        let driven = links + elastic + self.contact_damping * ends.drive_rate;
        state.rim_rate = (state.rim_rate + self.dt_over_rim_inertia * driven) * self.rim_implicit;
        state.rim = state.rim.plus(self.dt * state.rim_rate);
        let slip = ends.drive_rate - state.rim_rate;
        [elastic + self.contact_damping * slip, R::ZERO, self.contact_damping * slip * slip]
    }

    /// Forces of the links; answers with the power lost in them (W), and the torque of the hardening on the rim (N m).
    #[inline(always)]
    fn pull(&self, state: &MeshState<R, N, M>, ends: &Ends<R>, force: &mut [Slice<R, N>; M]) -> (R, R) {
        if self.contact.is_some() {
            return (self.shell.pull(&state.shell, force), R::ZERO);
        }
        let twice = self.twice_from_axis(state.rim, ends);
        self.shell.pull_assembled(&state.shell, &twice, force)
    }

    /// Kinetic energy of the free nodes and the rim (J); the flange's belongs to J_fs.
    fn kinetic_energy(&self, state: &MeshState<R, N, M>) -> R {
        let rim = R::lit(0.5) * self.rim_inertia * state.rim_rate * state.rim_rate;
        self.shell.kinetic_energy(&state.shell, 1..M - 1) + rim
    }
}

/// Twice the angle from the major axis to the rim's zero.
#[inline(always)]
fn twice_between<R: Real>(rim: Angle<R>, wave_generator: Angle<R>) -> Angle<R> {
    Angle {
        counts: rim.counts.wrapping_sub(wave_generator.counts).wrapping_mul(2),
        rest: R::lit(2.0) * (rim.rest - wave_generator.rest),
    }
}

/// Cosine and sine of a node's angle plus the angle whose sine and cosine are given.
#[inline(always)]
fn turned_by<R: Real, const N: usize>(
    [c, s]: &UnitVectors<R, N>,
    entry: usize,
    (sine, cosine): (R, R),
) -> (R, R) {
    (c[entry] * cosine - s[entry] * sine, s[entry] * cosine + c[entry] * sine)
}

/// Velocities of a slice that moves with some angles, each with its rate (rad/s).
#[inline(always)]
fn move_with<R: Real, const N: usize, const K: usize>(
    velocity: &mut Slice<R, N>,
    rates: [(&Displacement<R, N>, R); K],
) {
    for (axis, velocity) in velocity.iter_mut().take(2).enumerate() {
        let entries = velocity.entries_mut();
        for i in 0..N {
            entries[i] = rates.iter().fold(R::ZERO, |sum, (by, rate)| sum + by[axis][i] * *rate);
        }
    }
    close(velocity);
}

/// Sum of force times displacement per unit of the angle that moves the slice: a torque (N m).
#[inline(always)]
fn virtual_work<R: Real, const N: usize>(force: &Slice<R, N>, by: &Displacement<R, N>) -> R {
    let [x, y, _] = force.each_ref().map(Ring::entries);
    let work: [R; N] = core::array::from_fn(|i| x[i] * by[0][i] + y[i] * by[1][i]);
    sum(&work)
}

impl<R: Real, const N: usize, const M: usize> Flexspline<R> for Mesh<R, N, M> {
    type State = MeshState<R, N, M>;

    fn rest(&self) -> Self::State {
        self.rest_at(Angle::default())
    }

    /// Compiled once for each size, not where it is called: [`Mesh::step_inlined`] is compiled there.
    #[inline(never)]
    fn step(&self, state: &mut Self::State, ends: &Ends<R>) -> Reaction<R> {
        self.step_inlined(state, ends)
    }

    fn energy(&self, state: &Self::State, ends: &Ends<R>) -> R {
        let placed = self.placed(state, ends);
        let hardening = match &self.contact {
            Some(contact) => contact.energy(ends.drive.minus(placed.rim)),
            None => self.shell.hardening_energy(&placed.shell, &self.twice_from_axis(placed.rim, ends)),
        };
        self.shell.elastic_energy(&placed.shell) + self.kinetic_energy(&placed) + hardening
    }

    fn largest_strain(&self, state: &Self::State) -> Option<Strained<R>> {
        Some(self.shell.largest_strain(&state.shell))
    }
}
