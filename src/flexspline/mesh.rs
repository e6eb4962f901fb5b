//! The mass-spring shell of eq. (6), literal: n nodes around, m along the axis, 16 links a node.
//!
//! ```text
//! m_ij * ddq_ij = F_ij - k * sum (L - L0) * l - mu * sum dL/dt * l        l = unit vector along the link
//! ```
//!
//! Cartesian coordinates in m, z along the axis. Links that would leave the axis ends do not exist.
//! Each link is visited once and its force given to both its nodes, so momentum is kept to rounding.
//!
//! Slice 0 is the toothed rim: it turns as one by its own angle psi (inertia of its nodes), pressed by
//! the wave generator into the inextensional ellipse, radial w0*cos(2b), tangential -(w0/2)*sin(2b),
//! b = angle from the wave generator's major axis. The tooth contact (`contact_line`, with its dashpot)
//! drives it towards r*theta_wg + e. Slice m-1 is rigid with the output flange. Every torque is the
//! virtual work of the link forces on the nodes that its angle moves:
//!
//! ```text
//! J_rim * ddpsi = contact(delta) + c*ddelta + sum F . dp/dpsi,   delta = r*theta_wg + e - psi
//! flange  = sum F . dp/dtheta_fs,     ellipse = sum F . dp/dtheta_wg
//! ```
//!
//! Discretisation: semi-implicit (symplectic) Euler, velocities first; the contact's dashpot implicit,
//! because it is stiff against the rim's small inertia. Stable while dt < 2/omega_max;
//! [`Mesh::stable_step`] bounds omega_max by Gershgorin's circles, so it errs on the safe side.

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::flexspline::calibration::{DIRECTIONS, FlexsplineParams, link_geometry, unit_stiffness};
use crate::flexspline::slice::{Nodes, Slice, between, segments, sum, turned_by, virtual_work};
use crate::flexspline::stiffness_line::StiffnessLine;
use crate::flexspline::{Ends, Flexspline, Reaction};
use crate::real::Real;

/// Steps that settle a mesh at its stable step from round to elliptic; a test bounds the torque that is left.
const RELAXATION_STEPS: usize = 4000;

/// Newton steps for 1/L: a strain e starts with a relative error e, each step makes 1.5*e^2 of it, so
/// three leave 1e-16 at 1 % and 1e-9 at 10 %.
const NEWTON_STEPS: usize = 3;

/// One of the 8 link directions.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Direction<R> {
    around: i32,
    along: usize,
    rest_length: R,
}

/// The n x m mesh with its tooth contact, stepped by a fixed dt.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<R, const N: usize, const M: usize> {
    directions: [Direction<R>; 8],
    /// k and mu of eq. (6).
    link_stiffness: R,
    link_damping: R,
    contact: StiffnessLine<R>,
    contact_damping: R,
    radius: R,
    ellipse: R,
    spacing: R,
    /// Cosine and sine of each node's angle, and of twice that angle.
    node: [(R, R); N],
    node_twice: [(R, R); N],
    node_mass: R,
    rim_inertia: R,
    dt: R,
    dt_over_mass: R,
    dt_over_rim_inertia: R,
    rim_implicit: R,
}

/// Positions and velocities of the nodes, and the rim's own motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshState<R, const N: usize, const M: usize> {
    position: [Slice<R, N>; M],
    velocity: [Slice<R, N>; M],
    rim: Angle<R>,
    rim_rate: R,
}

impl<R: Real, const N: usize, const M: usize> MeshState<R, N, M> {
    /// Takes all velocities away; answers with the kinetic energy that is left, 0 (J).
    fn stop(&mut self) -> R {
        self.velocity = [Slice::ZERO; M];
        self.rim_rate = R::ZERO;
        R::ZERO
    }
}

/// Positions of the rim nodes and their partial derivatives by the two angles that move them.
struct RimShape<R, const N: usize> {
    position: Slice<R, N>,
    by_rim: Slice<R, N>,
    by_wave_generator: Slice<R, N>,
}

/// Link constant k that gives an n x m mesh the stiffness of the cup (N/m).
fn link_stiffness<R: Real, const M: usize>(params: &FlexsplineParams<R>, n: usize) -> R {
    params.cup.stiffness() / unit_stiffness::<R, M>(&params.cup, n)
}

/// Mass of an inner node; the end slices carry half of it (kg).
fn node_mass<R: Real>(params: &FlexsplineParams<R>, n: usize, m: usize) -> R {
    params.cup.mass() / R::from_i32((n * (m - 1)) as i32)
}

/// mu of eq. (6): gives the tube's first torsion mode the joint's damping ratio (N s/m).
fn link_damping<R: Real>(params: &FlexsplineParams<R>, k: R) -> R {
    R::lit(2.0) * params.damping_ratio / params.cup.torsion_frequency() * k
}

impl<R: Real, const N: usize, const M: usize> Mesh<R, N, M> {
    /// Largest stable time step of this mesh (s).
    ///
    /// A node's row of the stiffness matrix has the sum of its 16 links' constants on the diagonal and
    /// at most as much beside it: omega_max^2 <= 2*16*k/m (Gershgorin). Damping of ratio z at omega_max
    /// shortens the step of the semi-implicit scheme to 2*(sqrt(1 + z^2) - z)/omega_max. The rim turns
    /// as one: its links and the contact act on N half nodes.
    pub fn stable_step(params: &FlexsplineParams<R>) -> R {
        let k = link_stiffness::<R, M>(params, N);
        let mass = node_mass(params, N, M);
        let node = (R::lit(32.0) * k / mass).sqrt();
        let contact = params.contact_line().stiffness[2];
        let rim_inertia = R::lit(0.5) * R::from_i32(N as i32) * mass * params.cup.radius * params.cup.radius;
        let rim = node + (contact / rim_inertia).sqrt();
        let omega = node.max(rim);
        let ratio = R::lit(0.5) * omega * link_damping(params, k) / k;
        R::lit(2.0) * ((R::ONE + ratio * ratio).sqrt() - ratio) / omega
    }

    /// Calibrates the links (see [`super::calibration`]) for a time step dt (s).
    ///
    /// # Errors
    /// As [`FlexsplineParams::check`]; `n` below 5 or above 1000, `m` below 3 or above 1000;
    /// `dt` not positive or not below [`Mesh::stable_step`].
    pub fn build(params: &FlexsplineParams<R>, dt: R) -> Result<Self, Error> {
        params.check()?;
        require((5..=1000).contains(&N), "n")?;
        require((3..=1000).contains(&M), "m")?;
        require(dt > R::ZERO && dt < Self::stable_step(params), "dt")?;
        let cup = &params.cup;
        let spacing = cup.length / R::from_i32(M as i32 - 1);
        let k = link_stiffness::<R, M>(params, N);
        let mass = node_mass(params, N, M);
        let rim_inertia = R::lit(0.5) * R::from_i32(N as i32) * mass * cup.radius * cup.radius;
        let contact_damping = params.contact_damping();
        Ok(Self {
            directions: DIRECTIONS.map(|(around, along)| Direction {
                around,
                along,
                rest_length: link_geometry(cup, N, spacing, around, along).0,
            }),
            link_stiffness: k,
            link_damping: link_damping(params, k),
            contact: params.contact_line().build()?,
            contact_damping,
            radius: cup.radius,
            ellipse: cup.ellipse,
            spacing,
            node: core::array::from_fn(|i| {
                let (sine, cosine) = Angle::from_turn_fraction(i as i32, N as i32).sin_cos();
                (cosine, sine)
            }),
            node_twice: core::array::from_fn(|i| {
                let (sine, cosine) = Angle::from_turn_fraction(2 * i as i32, N as i32).sin_cos();
                (cosine, sine)
            }),
            node_mass: mass,
            rim_inertia,
            dt,
            dt_over_mass: dt / mass,
            dt_over_rim_inertia: dt / rim_inertia,
            rim_implicit: R::ONE / (R::ONE + dt * contact_damping / rim_inertia),
        })
    }

    /// Number of links.
    pub fn links() -> usize {
        DIRECTIONS.iter().map(|(_, along)| N * (M - along)).sum()
    }

    /// Lets the nodes settle with the ends held: `steps` steps, all motion stopped whenever the kinetic
    /// energy has peaked (dynamic relaxation with kinetic damping, P. Cundall, 1976).
    pub fn relax(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>, steps: usize) {
        let mut last = R::ZERO;
        for _ in 0..steps {
            self.step(state, ends);
            let kinetic = self.kinetic_energy(state);
            last = if kinetic < last { state.stop() } else { kinetic };
        }
        state.stop();
    }

    /// Radial unit vectors of a slice that has turned by `angle`.
    fn radial(&self, angle: Angle<R>) -> [(R, R); N] {
        turned_by(&self.node, angle.sin_cos())
    }

    /// Nodes of a round, rigid slice at `height`, and their derivative by its angle.
    fn round_slice(&self, angle: Angle<R>, height: R) -> (Slice<R, N>, Slice<R, N>) {
        let mut position = Slice::ZERO;
        let mut derivative = Slice::ZERO;
        for (i, (cosine, sine)) in self.radial(angle).into_iter().enumerate() {
            position.x[i] = self.radius * cosine;
            position.y[i] = self.radius * sine;
            position.z[i] = height;
            derivative.x[i] = -position.y[i];
            derivative.y[i] = position.x[i];
        }
        (position, derivative)
    }

    /// The rim pressed into the ellipse: p = (R + w0*c)*e_r - (w0/2)*s*e_t, with c, s = cos, sin(2b).
    fn rim_shape(&self, rim: Angle<R>, wave_generator: Angle<R>) -> RimShape<R, N> {
        let from_axis = Angle {
            counts: rim.counts.wrapping_sub(wave_generator.counts).wrapping_mul(2),
            rest: R::lit(2.0) * (rim.rest - wave_generator.rest),
        };
        let ellipse = turned_by(&self.node_twice, from_axis.sin_cos());
        let mut shape =
            RimShape { position: Slice::ZERO, by_rim: Slice::ZERO, by_wave_generator: Slice::ZERO };
        for (i, ((cosine, sine), (c, s))) in self.radial(rim).into_iter().zip(ellipse).enumerate() {
            let (radial, tangential) = (self.radius + self.ellipse * c, R::lit(-0.5) * self.ellipse * s);
            let place = |slice: &mut Slice<R, N>, radial: R, tangential: R| {
                slice.x[i] = radial * cosine - tangential * sine;
                slice.y[i] = radial * sine + tangential * cosine;
            };
            place(&mut shape.position, radial, tangential);
            place(&mut shape.by_rim, R::lit(-1.5) * self.ellipse * s, self.radius);
            place(&mut shape.by_wave_generator, R::lit(2.0) * self.ellipse * s, self.ellipse * c);
        }
        shape
    }

    /// Puts the end slices where their angles say.
    fn place_ends(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>) -> (RimShape<R, N>, Slice<R, N>) {
        let rim = self.rim_shape(state.rim, ends.wave_generator);
        state.position[0] = rim.position;
        state.velocity[0] = Slice::ZERO;
        state.velocity[0].add(&rim.by_rim, state.rim_rate);
        state.velocity[0].add(&rim.by_wave_generator, ends.wave_generator_rate);
        let (position, by_flange) = self.round_slice(ends.flange, self.spacing * R::from_i32(M as i32 - 1));
        state.position[M - 1] = position;
        state.velocity[M - 1] = Slice::ZERO;
        state.velocity[M - 1].add(&by_flange, ends.flange_rate);
        (rim, by_flange)
    }

    /// Sum of the 16 links' forces on every node (N), and the power lost in the links (W).
    fn link_forces(&self, state: &MeshState<R, N, M>) -> ([Slice<R, N>; M], R) {
        let mut force = [Slice::ZERO; M];
        let mut loss = [R::ZERO; N];
        for direction in &self.directions {
            for near in 0..M - direction.along {
                let far = near + direction.along;
                let mut pull = Slice::ZERO;
                for [here, there] in segments(N, direction.around) {
                    self.pull_of_links(
                        direction.rest_length,
                        Nodes::of(&state.position[near], &state.velocity[near], &here),
                        Nodes::of(&state.position[far], &state.velocity[far], &there),
                        [&mut pull.x[here.clone()], &mut pull.y[here.clone()], &mut pull.z[here.clone()]],
                        &mut loss[here],
                    );
                }
                force[near].add(&pull, R::ONE);
                force[far].take_turned(&pull, direction.around);
            }
        }
        (force, sum(&loss))
    }

    /// Pull of a row of parallel links on their near nodes: (k*(L - L0) + mu*dL/dt) along the link.
    ///
    /// 1/L by Newton's iteration from 1/L0, which a compiler turns into vector code on every target,
    /// unlike a square root and a division.
    #[inline(always)]
    fn pull_of_links(
        &self,
        rest_length: R,
        near: Nodes<'_, R>,
        far: Nodes<'_, R>,
        [pull_x, pull_y, pull_z]: [&mut [R]; 3],
        loss: &mut [R],
    ) {
        let inverse_rest_length = R::ONE / rest_length;
        let count = loss.len();
        let (near, far) = (near.first(count), far.first(count));
        let (pull_x, pull_y, pull_z) = (&mut pull_x[..count], &mut pull_y[..count], &mut pull_z[..count]);
        for i in 0..count {
            let [dx, dy, dz] = between(near.position, far.position, i);
            let [dvx, dvy, dvz] = between(near.velocity, far.velocity, i);
            let square = dx * dx + dy * dy + dz * dz;
            let mut inverse = inverse_rest_length;
            for _ in 0..NEWTON_STEPS {
                inverse *= R::lit(1.5) - R::lit(0.5) * square * inverse * inverse;
            }
            let rate = (dx * dvx + dy * dvy + dz * dvz) * inverse;
            let tension = self.link_stiffness * (square * inverse - rest_length) + self.link_damping * rate;
            let pull_per_length = tension * inverse;
            pull_x[i] = pull_per_length * dx;
            pull_y[i] = pull_per_length * dy;
            pull_z[i] = pull_per_length * dz;
            loss[i] += self.link_damping * rate * rate;
        }
    }

    /// Moves the free nodes by one step.
    fn advance_nodes(&self, state: &mut MeshState<R, N, M>, force: &[Slice<R, N>; M]) {
        let MeshState { position, velocity, .. } = state;
        let nodes = position.iter_mut().zip(velocity).zip(force);
        for ((position, velocity), force) in nodes.take(M - 1).skip(1) {
            velocity.add(force, self.dt_over_mass);
            position.add(velocity, self.dt);
        }
    }

    /// Moves the rim by one step, the dashpot implicit; answers with the contact's torque and loss.
    fn advance_rim(&self, state: &mut MeshState<R, N, M>, ends: &Ends<R>, links: R) -> (R, R) {
        let elastic = self.contact.torque(ends.drive.minus(state.rim));
        let driven = links + elastic + self.contact_damping * ends.drive_rate;
        state.rim_rate = (state.rim_rate + self.dt_over_rim_inertia * driven) * self.rim_implicit;
        state.rim = state.rim.plus(self.dt * state.rim_rate);
        let slip = ends.drive_rate - state.rim_rate;
        (elastic + self.contact_damping * slip, self.contact_damping * slip * slip)
    }

    /// Elastic energy of all links (J).
    fn link_energy(&self, state: &MeshState<R, N, M>) -> R {
        let mut energy = R::ZERO;
        for direction in &self.directions {
            for near in 0..M - direction.along {
                let a = &state.position[near];
                let b = &state.position[near + direction.along];
                for [here, there] in segments(N, direction.around) {
                    for (i, k) in here.zip(there) {
                        let (dx, dy, dz) = (b.x[k] - a.x[i], b.y[k] - a.y[i], b.z[k] - a.z[i]);
                        let stretch = (dx * dx + dy * dy + dz * dz).sqrt() - direction.rest_length;
                        energy += R::lit(0.5) * self.link_stiffness * stretch * stretch;
                    }
                }
            }
        }
        energy
    }

    /// Kinetic energy of the free nodes and the rim (J); the flange's belongs to J_fs.
    fn kinetic_energy(&self, state: &MeshState<R, N, M>) -> R {
        let nodes = state.velocity[1..M - 1]
            .iter()
            .flat_map(|slice| slice.x.iter().chain(&slice.y).chain(&slice.z))
            .fold(R::ZERO, |sum, v| sum + *v * *v);
        R::lit(0.5) * (self.node_mass * nodes + self.rim_inertia * state.rim_rate * state.rim_rate)
    }
}

impl<R: Real, const N: usize, const M: usize> Flexspline<R> for Mesh<R, N, M> {
    type State = MeshState<R, N, M>;

    /// The assembled shape: round slices, the rim pressed into its ellipse, the nodes settled.
    fn rest(&self) -> Self::State {
        let position = core::array::from_fn(|j| {
            self.round_slice(Angle::default(), self.spacing * R::from_i32(j as i32)).0
        });
        let mut state =
            MeshState { position, velocity: [Slice::ZERO; M], rim: Angle::default(), rim_rate: R::ZERO };
        self.relax(&mut state, &Ends::default(), RELAXATION_STEPS);
        state
    }

    fn step(&self, state: &mut Self::State, ends: &Ends<R>) -> Reaction<R> {
        let (rim, by_flange) = self.place_ends(state, ends);
        let (force, link_loss) = self.link_forces(state);
        self.advance_nodes(state, &force);
        let links = virtual_work(&force[0], &rim.by_rim);
        let (contact, contact_loss) = self.advance_rim(state, ends, links);
        Reaction {
            contact,
            flange: virtual_work(&force[M - 1], &by_flange),
            ellipse: virtual_work(&force[0], &rim.by_wave_generator),
            loss: link_loss + contact_loss,
            saturated: false,
        }
    }

    fn energy(&self, state: &Self::State, ends: &Ends<R>) -> R {
        let mut placed = *state;
        self.place_ends(&mut placed, ends);
        let contact = self.contact.energy(ends.drive.minus(placed.rim));
        self.link_energy(&placed) + self.kinetic_energy(&placed) + contact
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;

    /// Torque on the flange with the ends held at a torsion, after settling.
    fn settled_torque<const N: usize, const M: usize>(torsion: f64, wave_generator: f64) -> f64 {
        let dt = 0.7 * Mesh::<f64, N, M>::stable_step(&SIZE_25);
        let mesh = Mesh::<f64, N, M>::build(&SIZE_25, dt).unwrap();
        let ends = Ends {
            drive: Angle::from_radians(torsion),
            wave_generator: Angle::from_radians(wave_generator),
            ..Ends::default()
        };
        let mut state = mesh.rest();
        mesh.relax(&mut state, &ends, 20_000);
        mesh.step(&mut state, &ends).flange
    }

    #[test]
    fn small_torsion_stiffness_is_k1_whatever_the_mesh() {
        for torque in [settled_torque::<8, 3>(1e-5, 0.0), settled_torque::<36, 4>(1e-5, 0.0)] {
            let stiffness = torque / 1e-5;
            assert!((stiffness / 3.1e4 - 1.0).abs() < 1e-4, "{stiffness}");
        }
    }

    #[test]
    fn torque_follows_the_catalogue_up_to_rated() {
        let line = SIZE_25.line.build().unwrap();
        for torsion in [3e-4, 6e-4, 9e-4, 1.2e-3, -1.4e-3] {
            for torque in [settled_torque::<8, 3>(torsion, 0.3), settled_torque::<12, 4>(torsion, 0.3)] {
                assert!((torque - line.torque(torsion)).abs() < 1e-3 * 67.0, "{torque} at {torsion}");
            }
        }
    }

    /// A coarse ring must not cog: the torque is the same wherever the ellipse stands.
    #[test]
    fn torque_does_not_depend_on_the_wave_generators_angle() {
        let torque = |angle| settled_torque::<8, 3>(1e-3, angle);
        for angle in [0.05, 0.2, 0.4, 1.0] {
            let ratio = torque(angle) / torque(0.0);
            assert!((ratio - 1.0).abs() < 1e-5, "{ratio} at {angle}");
        }
    }

    #[test]
    fn the_assembled_shape_has_settled() {
        let mesh =
            Mesh::<f64, 36, 4>::build(&SIZE_25, 0.7 * Mesh::<f64, 36, 4>::stable_step(&SIZE_25)).unwrap();
        let reaction = mesh.step(&mut mesh.rest(), &Ends::default());
        assert!(reaction.flange.abs() < 1e-6 && reaction.ellipse.abs() < 1e-6, "{reaction:?}");
    }

    #[test]
    fn action_is_reaction() {
        let mesh = Mesh::<f64, 8, 3>::build(&SIZE_25, 1e-6).unwrap();
        let ends = Ends { drive: Angle::from_radians(1e-3), ..Ends::default() };
        let mut state = mesh.rest();
        for _ in 0..50 {
            mesh.step(&mut state, &ends);
            let (force, _) = mesh.link_forces(&state);
            let largest = force.iter().flat_map(|slice| slice.x).fold(0.0, |m: f64, f| m.max(f.abs()));
            for axis in [|s: &Slice<f64, 8>| s.x, |s: &Slice<f64, 8>| s.y, |s: &Slice<f64, 8>| s.z] {
                let total: f64 = force.iter().flat_map(axis).sum();
                assert!(total.abs() < 1e-12 * largest, "{total} N left over of {largest} N");
            }
        }
    }

    /// The flange rings on the mesh at sqrt(K1/J) and loses by the gear file's damping ratio.
    #[test]
    fn the_torsion_mode_has_its_frequency_and_damping() {
        let dt = 0.7 * Mesh::<f64, 8, 3>::stable_step(&SIZE_25);
        let mesh = Mesh::<f64, 8, 3>::build(&SIZE_25, dt).unwrap();
        let mut state = mesh.rest();
        let mut flange = crate::gear::Motion { angle: Angle::from_radians(1e-4), velocity: 0.0 };
        mesh.relax(&mut state, &Ends { flange: flange.angle, ..Ends::default() }, 5000);
        let (mut crossings, mut peaks) = (std::vec![], std::vec![]);
        for k in 0..(0.25 / dt) as i32 {
            let ends = Ends { flange: flange.angle, flange_rate: flange.velocity, ..Ends::default() };
            let before = (flange.angle.to_radians(), flange.velocity);
            flange.advance(mesh.step(&mut state, &ends).flange / SIZE_25.inertia, dt);
            if before.0 < 0.0 && flange.angle.to_radians() >= 0.0 {
                crossings.push(f64::from(k) * dt);
            }
            if before.1 > 0.0 && flange.velocity <= 0.0 {
                peaks.push(flange.angle.to_radians());
            }
        }
        let periods = crossings.len() - 1;
        let omega = core::f64::consts::TAU * periods as f64 / (crossings[periods] - crossings[0]);
        let wanted = (3.1e4f64 / 1.2).sqrt();
        assert!((omega / wanted - 1.0).abs() < 1e-3, "{omega} against {wanted} rad/s");
        let decrement = (peaks[0] / peaks[peaks.len() - 1]).ln() / (peaks.len() - 1) as f64;
        let ratio = decrement / core::f64::consts::TAU;
        assert!((ratio / 0.02 - 1.0).abs() < 0.02, "damping ratio {ratio}");
    }

    #[test]
    fn what_would_not_be_stable_is_refused_by_name() {
        let dt = Mesh::<f64, 8, 3>::stable_step(&SIZE_25);
        assert_eq!(Mesh::<f64, 8, 3>::build(&SIZE_25, dt).err(), Some(Error::OutOfRange("dt")));
        assert_eq!(Mesh::<f64, 4, 3>::build(&SIZE_25, 1e-7).err(), Some(Error::OutOfRange("n")));
        assert_eq!(Mesh::<f64, 8, 2>::build(&SIZE_25, 1e-7).err(), Some(Error::OutOfRange("m")));
    }
}
