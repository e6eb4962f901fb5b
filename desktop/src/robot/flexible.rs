//! Links in a row of which some bend: assumed modes, coupled with all joints and all other links.
//!
//! ```text
//! (T'*M*T + diag(J_c))*d2u + T'*h = (tau, -omega_k^2*eta_k - 2*zeta_k*omega_k*deta_k)       u = (q, eta),  x = T*u
//! w(x_p, t) = sum_k phi_k(x_p)*eta_k(t)                    at the points x_p of the beam, and at its end with the slope w'
//! ```
//!
//! A link that bends is a uniform beam along x of its joint's frame, clamped there, that bends about the joint's axis z
//! ([`strainwave::link`]). Its mass lies in the `POINTS` points of Gauss and Legendre, each of which moves along y; its end moves along y and
//! turns about z, and bears the payload and the next joint. M and h are those of all these bodies at once (crate phyz-rigid), where
//! they are in the bent arm; T takes their coordinates from angles q and modes eta. So the modes feel every joint's motion and gravity, and the
//! links behind a bent one stand where it leads, at any posture.
//!
//! phi_k are the modes of the beam with its payload and the mass of all links behind it at its end: in a robot they are assumed shapes, of a single link
//! the exact ones. Neglected: bending about y, twist, shear, rotary inertia, the shortening of a bent beam and so its stiffening by
//! centrifugal force, and the modes that are left out. Units: m, kg, s, rad; eta (m kg^1/2).
//!
//! Discretisation: semi-implicit Euler, speeds first, with the step of the joints. It is stable up to omega*dt = 2 of the fastest mode
//! of the arm with its joints free; a quarter of that mode's period or more is refused ([`FlexibleChain::longest_step`]).
//!
//! Reference: A. De Luca, W. Book, "Robots with flexible elements", Springer Handbook of Robotics, chapter 11.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{DMatrix, DVector};
use phyz_math::{DVec, Mat3, SpatialInertia, SpatialTransform, Vec3};
use phyz_model::{Model, ModelBuilder, State};
use phyz_rigid::{crba, rnea, total_energy};
use strainwave::Error;
use strainwave::link::MOST_MODES;

use super::beam::Beam;
use super::chain::Link;

/// Points that hold a beam's mass.
const POINTS: usize = 10;

/// A mode of a beam: its number in u, and the spring and the damper on it.
#[derive(Clone, Copy, Debug)]
struct Mode {
    /// omega_k^2, 2*zeta_k*omega_k.
    stiffness: f64,
    damping: f64,
}

/// The links of an arm.
#[derive(Clone, Debug)]
pub struct FlexibleChain {
    model: Model,
    /// T, a row each coordinate of the bodies and a column each angle and mode.
    shape: DMatrix<f64>,
    joints: usize,
    modes: Vec<Mode>,
    /// Tip in the frame of the last body.
    tip: Vec3,
}

/// Angles of the joints and modes, their rates, and what damping has taken.
#[derive(Clone, Debug, PartialEq)]
pub struct FlexibleState {
    /// q, then eta.
    pub position: Vec<f64>,
    /// Their rates.
    pub velocity: Vec<f64>,
    /// Energy that the modes' damping has taken since the start (J).
    pub lost: f64,
}

/// Bodies of an arm under construction.
struct Tree {
    builder: ModelBuilder,
    /// Entries of T that are not 0: row, column, value.
    entries: Vec<(usize, usize, f64)>,
    bodies: usize,
    /// Coordinates of u so far; angles come first.
    modes: Vec<Mode>,
    joints: usize,
}

fn nothing() -> SpatialInertia {
    SpatialInertia::new(0.0, Vec3::zeros(), Mat3::zero())
}

fn along_x(x: f64) -> SpatialTransform {
    SpatialTransform::new(Mat3::identity(), Vec3::new(x, 0.0, 0.0))
}

impl Tree {
    fn revolute(&mut self, parent: i32, pose: SpatialTransform, inertia: SpatialInertia) -> usize {
        self.take(|builder| builder.add_revolute_body("", parent, pose, inertia))
    }

    fn along_y(&mut self, parent: i32, pose: SpatialTransform, inertia: SpatialInertia) -> usize {
        let y = Vec3::new(0.0, 1.0, 0.0);
        self.take(|builder| builder.add_prismatic_body("", parent, pose, y, inertia))
    }

    fn take(&mut self, add: impl FnOnce(ModelBuilder) -> ModelBuilder) -> usize {
        self.builder = add(std::mem::take(&mut self.builder));
        self.bodies += 1;
        self.bodies - 1
    }

    /// The beam on the body of its joint; answers with the body at its end.
    fn beam(&mut self, beam: &Beam, behind: f64, joint: usize) -> Result<usize, Error> {
        let shapes = beam.bearing(behind);
        let built = shapes.build(0.5 * shapes.longest_step()?)?;
        let first = self.joints + self.modes.len();
        let kept = 0..beam.modes;
        self.modes.extend(kept.clone().map(|k| {
            let omega = built.frequencies()[k];
            Mode { stiffness: omega * omega, damping: 2.0 * shapes.damping[k] * omega }
        }));
        let (length, mass) = (shapes.length, shapes.length * shapes.linear_density);
        for (place, weight) in gauss_legendre() {
            let point = SpatialInertia::new(weight * mass, Vec3::zeros(), Mat3::zero());
            let body = self.along_y(joint as i32, along_x(place * length), point);
            let at = shapes.mode_shapes(place * length)?;
            self.entries.extend(kept.clone().map(|k| (body, first + k, at[k][0])));
        }
        let at = shapes.mode_shapes(length)?;
        let end = self.along_y(joint as i32, along_x(length), nothing());
        let payload = beam.params.payload_inertia;
        let payload = Mat3::from_diagonal(&Vec3::new(payload, payload, payload));
        let payload = SpatialInertia::new(beam.params.payload_mass, Vec3::zeros(), payload);
        let turned = self.revolute(end as i32, along_x(0.0), payload);
        self.entries.extend(kept.clone().map(|k| (end, first + k, at[k][0])));
        self.entries.extend(kept.map(|k| (turned, first + k, at[k][1])));
        Ok(turned)
    }
}

/// Places from 0 to 1 and weights of Gauss and Legendre's rule.
fn gauss_legendre() -> [(f64, f64); POINTS] {
    std::array::from_fn(|k| {
        let n = POINTS as f64;
        let mut x = (PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for degree in 2..=POINTS {
                let degree = degree as f64;
                (before, value) =
                    (value, ((2.0 * degree - 1.0) * x * value - (degree - 1.0) * before) / degree);
            }
            slope = n * (before - x * value) / (1.0 - x * x);
            x -= value / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

impl FlexibleChain {
    /// Links from the base to the tip under gravity (m/s^2) in the frame of the base; a beam stands in the place of its link.
    ///
    /// # Errors
    /// As [`strainwave::link::LinkParams::build`], but for `dt`; `modes` unless 1..=8; `links` of no link or one without its beam's place.
    pub fn build(links: &[Link], beams: &[Option<Beam>], [x, y, z]: [f64; 3]) -> Result<Self, Error> {
        if links.is_empty() || links.len() != beams.len() {
            return Err(Error::OutOfRange("links"));
        }
        if beams.iter().flatten().any(|beam| !(1..=MOST_MODES).contains(&beam.modes)) {
            return Err(Error::OutOfRange("modes"));
        }
        let builder = ModelBuilder::new().gravity(Vec3::new(x, y, z));
        let mut tree =
            Tree { builder, entries: Vec::new(), bodies: 0, modes: Vec::new(), joints: links.len() };
        let (mut parent, mut pose, mut flanges) = (-1, SpatialTransform::identity(), Vec::new());
        let mut tip = Vec3::zeros();
        for (index, (link, beam)) in links.iter().zip(beams).enumerate() {
            let rigid = if beam.is_some() { nothing() } else { link.spatial_inertia() };
            let body = tree.revolute(parent, pose, rigid);
            tree.entries.push((body, index, 1.0));
            flanges.push((body, link.flange));
            parent = body as i32;
            (pose, tip) = (link.end(), link.tip());
            if let Some(beam) = beam {
                let behind = links[index + 1..].iter().map(|link| link.mass).sum();
                parent = tree.beam(beam, behind, body)? as i32;
                pose.pos = Vec3::zeros();
                tip = Vec3::zeros();
            }
        }
        let mut shape = DMatrix::zeros(tree.bodies, links.len() + tree.modes.len());
        tree.entries.iter().for_each(|(row, column, value)| shape[(*row, *column)] = *value);
        let mut model = tree.builder.build();
        flanges.iter().for_each(|(body, flange)| model.joints[*body].armature = *flange);
        Ok(Self { model, shape, joints: links.len(), modes: tree.modes, tip })
    }

    /// At rest at these angles (rad), as it hangs there with its joints held.
    pub fn settled(&self, angles: &[f64]) -> FlexibleState {
        let count = self.joints + self.modes.len();
        let mut state = FlexibleState { position: vec![0.0; count], velocity: vec![0.0; count], lost: 0.0 };
        state.position[..self.joints].copy_from_slice(angles);
        // The weight depends little on how far the arm is bent: each turn leaves a small part.
        for _ in 0..30 {
            let weight = self.bias(&state);
            for (k, mode) in self.modes.iter().enumerate() {
                state.position[self.joints + k] = -weight[self.joints + k] / mode.stiffness;
            }
        }
        state
    }

    /// The bodies where a state has them.
    fn bodies(&self, state: &FlexibleState) -> State {
        let mut bodies = self.model.default_state();
        let of = |values: &[f64]| &self.shape * DVector::from_row_slice(values);
        bodies.q.as_mut_slice().copy_from_slice(of(&state.position).as_slice());
        bodies.v.as_mut_slice().copy_from_slice(of(&state.velocity).as_slice());
        bodies
    }

    /// T'*h.
    fn bias(&self, state: &FlexibleState) -> DVector<f64> {
        let none = DVec::from_slice(&vec![0.0; self.model.nv]);
        let forces = rnea(&self.model, &self.bodies(state), &none);
        self.shape.tr_mul(&DVector::from_row_slice(forces.as_slice()))
    }

    /// T'*M*T, with J_c.
    fn mass(&self, state: &FlexibleState) -> DMatrix<f64> {
        let mass = crba(&self.model, &self.bodies(state));
        let mass = DMatrix::from_fn(self.model.nv, self.model.nv, |row, column| mass[(row, column)]);
        self.shape.tr_mul(&(mass * &self.shape))
    }

    /// Torques that hold the joints where they are, the links at rest as bent as they are (N m).
    pub fn holding_torques(&self, state: &FlexibleState) -> Vec<f64> {
        let held = FlexibleState { velocity: vec![0.0; state.velocity.len()], ..state.clone() };
        self.bias(&held).as_slice()[..self.joints].to_vec()
    }

    /// Accelerations of the joints (rad/s^2) under these torques (N m), and of the modes.
    fn accelerations(&self, state: &FlexibleState, torques: &[f64]) -> DVector<f64> {
        let mut forces = -self.bias(state);
        torques.iter().enumerate().for_each(|(joint, torque)| forces[joint] += torque);
        for (k, mode) in (self.joints..).zip(&self.modes) {
            forces[k] -= mode.stiffness * state.position[k] + mode.damping * state.velocity[k];
        }
        // Positive definite: every joint and mode moves some mass.
        self.mass(state).cholesky().map_or_else(|| forces.map(|_| f64::NAN), |factor| factor.solve(&forces))
    }

    /// Moves the modes on by `dt` (s), and answers with the accelerations of the joints (rad/s^2); who moves the joints sets them with
    /// [`FlexibleState::set`].
    pub fn step(&self, state: &mut FlexibleState, torques: &[f64], dt: f64) -> Vec<f64> {
        let accelerations = self.accelerations(state, torques);
        for (k, mode) in (self.joints..).zip(&self.modes) {
            let before = state.velocity[k];
            state.velocity[k] += dt * accelerations[k];
            state.position[k] += dt * state.velocity[k];
            state.lost += dt * mode.damping * before * 0.5 * (before + state.velocity[k]);
        }
        accelerations.as_slice()[..self.joints].to_vec()
    }

    /// Natural frequencies of the modes of the arm with its joints free, in a state (rad/s), the fastest last.
    pub fn frequencies(&self, state: &FlexibleState) -> Vec<f64> {
        let Some(factor) = self.mass(state).cholesky() else { return vec![f64::INFINITY] };
        let mut stiffness = DMatrix::zeros(state.position.len(), state.position.len());
        (self.joints..).zip(&self.modes).for_each(|(k, mode)| stiffness[(k, k)] = mode.stiffness);
        let root = factor.l();
        let half = root.solve_lower_triangular(&stiffness).unwrap_or_default();
        let whole = root.solve_lower_triangular(&half.transpose()).unwrap_or_default();
        let mut found: Vec<f64> =
            whole.symmetric_eigenvalues().iter().map(|square| square.max(0.0).sqrt()).collect();
        found.sort_by(f64::total_cmp);
        found.split_off(self.joints)
    }

    /// Step that is refused, with every longer one, in a state (s): a quarter of the fastest mode's period.
    pub fn longest_step(&self, state: &FlexibleState) -> f64 {
        FRAC_PI_2 / self.frequencies(state).last().copied().unwrap_or_default()
    }

    /// Kinetic, elastic and potential energy (J).
    pub fn energy(&self, state: &FlexibleState) -> f64 {
        let elastic =
            (self.joints..).zip(&self.modes).map(|(k, mode)| mode.stiffness * state.position[k].powi(2));
        0.5 * elastic.sum::<f64>() + total_energy(&self.model, &self.bodies(state))
    }

    /// Place of the tip in the frame of the base (m).
    pub fn tip(&self, state: &FlexibleState) -> [f64; 3] {
        super::chain::place_on_last(&self.model, &self.bodies(state), self.tip)
    }
}

impl FlexibleState {
    /// Sets the angle (rad) and speed (rad/s) of a joint.
    pub fn set(&mut self, joint: usize, [angle, velocity]: [f64; 2]) {
        self.position[joint] = angle;
        self.velocity[joint] = velocity;
    }
}

#[cfg(test)]
mod tests {
    use strainwave::Angle;
    use strainwave::gear::Motion;
    use strainwave::link::{LinkInput, LinkParams};

    use super::*;
    use crate::robot::chain::Chain;

    const GRAVITY: [f64; 3] = [0.0, -9.806_65, 0.0];

    fn beam(stiffness: f64) -> Beam {
        let params = LinkParams {
            length: 0.4,
            bending_stiffness: stiffness,
            linear_density: 3.0,
            thickness: 0.02,
            payload_mass: 1.0,
            payload_inertia: 2e-3,
            damping: [0.0; MOST_MODES],
            gravity: 0.0,
            patch: None,
        };
        Beam { params, modes: 2, twist: 0.0 }
    }

    /// So many beams under gravity, all alike.
    fn arm(count: usize, beam: Beam, gravity: [f64; 3]) -> FlexibleChain {
        FlexibleChain::build(&vec![beam.straight(); count], &vec![Some(beam); count], gravity).unwrap()
    }

    /// Swings freely from these angles for `time` (s).
    fn swing(chain: &FlexibleChain, state: &mut FlexibleState, dt: f64, time: f64) {
        for _ in 0..(time / dt).round() as usize {
            let accelerations = chain.step(state, &vec![0.0; chain.joints], dt);
            for (joint, acceleration) in accelerations.iter().enumerate() {
                let velocity = state.velocity[joint] + dt * acceleration;
                state.set(joint, [state.position[joint] + dt * velocity, velocity]);
            }
        }
    }

    #[test]
    fn the_points_integrate_polynomials() {
        for power in 0..2 * POINTS as i32 {
            let found: f64 = gauss_legendre().iter().map(|(x, weight)| weight * x.powi(power)).sum();
            assert!((found * f64::from(power + 1) - 1.0).abs() < 1e-13, "{power}: {found}");
        }
    }

    /// The textbook's deflection under the arm's own weight: tip mass and beam.
    #[test]
    fn a_held_link_hangs_as_the_closed_form_says() {
        let chain = arm(1, Beam { modes: 8, ..beam(300.0) }, GRAVITY);
        let [_, y, _] = chain.tip(&chain.settled(&[0.0]));
        let (force, load) = (9.806_65, 3.0 * 9.806_65);
        let expected = -(force * 0.4f64.powi(3) / 3.0 + load * 0.4f64.powi(4) / 8.0) / 300.0;
        assert!((y / expected - 1.0).abs() < 1e-4, "{y}, {expected}");
    }

    /// A single link whose joint moves as told bends as `strainwave::link` has it; loads the joint alike.
    #[test]
    fn a_single_link_is_the_librarys() {
        let beam = beam(300.0);
        let chain = arm(1, beam, [0.0; 3]);
        let dt = 1e-5;
        let params = LinkParams { payload_mass: 1.0, ..beam.params };
        // The library's link with the two modes that are kept.
        let two = LinkParams::<f64, 2> {
            length: params.length,
            bending_stiffness: params.bending_stiffness,
            linear_density: params.linear_density,
            thickness: params.thickness,
            payload_mass: params.payload_mass,
            payload_inertia: params.payload_inertia,
            damping: [0.0; 2],
            gravity: 0.0,
            patch: None,
        };
        let link = two.build(dt).unwrap();
        let (mut state, mut ours) = (link.settled(&LinkInput::default()), chain.settled(&[0.0]));
        let shapes = params.mode_shapes(params.length).unwrap();
        let (mut most, mut apart) = (0.0f64, 0.0f64);
        for step in 0..20_000 {
            // Slow enough in all that no angle and no speed squared matters: the library's link knows none.
            let torque = 0.02 * (40.0 * dt * f64::from(step)).sin();
            let acceleration = chain.step(&mut ours, &[torque], dt)[0];
            let velocity = ours.velocity[0] + dt * acceleration;
            ours.set(0, [ours.position[0] + dt * velocity, velocity]);
            let joint = Motion { angle: Angle::from_radians_f64(0.0), velocity: 0.0 };
            link.step(&mut state, &LinkInput { joint, acceleration, ..LinkInput::default() });
            let bent: f64 = (0..2).map(|k| shapes[k][0] * ours.position[1 + k]).sum();
            // Without the modes that are left out, which the library adds at rest.
            let theirs = {
                let mut still = state;
                link.step(&mut still, &LinkInput { joint, acceleration: 0.0, ..LinkInput::default() })
                    .deflection
            };
            most = most.max(bent.abs());
            apart = apart.max((bent - theirs).abs());
        }
        assert!(most > 1e-6 && apart < 2e-2 * most, "{apart} of {most}");
        let clamped = link.frequencies();
        let free = chain.frequencies(&ours);
        assert!(free[0] > clamped[0] && free[1] > clamped[1], "{free:?} {clamped:?}");
    }

    /// The stiffer, the nearer to the rigid arm: a tenth of the difference for ten times the stiffness.
    #[test]
    fn stiff_links_move_as_rigid_ones() {
        let start = [-0.35, 1.1];
        let links = [beam(1.0).straight(); 2];
        let rigid = Chain::build(&links, GRAVITY).unwrap();
        let mut state = rigid.rest();
        start.iter().enumerate().for_each(|(joint, angle)| state.set(joint, [*angle, 0.0]));
        (0..2000).for_each(|_| rigid.rigid_step(&mut state, 1e-4));
        let asked = rigid.tip(&state);
        let off = |stiffness: f64| {
            let chain = arm(2, beam(stiffness), GRAVITY);
            let mut state = chain.settled(&start);
            swing(&chain, &mut state, 5e-6, 0.2);
            let tip = chain.tip(&state);
            (0..2).map(|k| (tip[k] - asked[k]).powi(2)).sum::<f64>().sqrt()
        };
        let (soft, stiff) = (off(3e3), off(3e4));
        assert!(stiff < 0.2 * soft && stiff < 2e-4, "{soft} m, {stiff} m");
    }

    /// An arm that swings without loss keeps its energy, within what the first-order step leaves; with damping it keeps what is not lost.
    #[test]
    fn the_energy_balance_closes() {
        for damping in [0.0, 0.05] {
            let mut beam = beam(300.0);
            beam.params.damping = [damping; MOST_MODES];
            let chain = arm(2, beam, GRAVITY);
            let off = |dt: f64| {
                let mut state = chain.settled(&[0.2, 0.9]);
                let before = chain.energy(&state);
                swing(&chain, &mut state, dt, 0.3);
                (chain.energy(&state) + state.lost - before).abs()
            };
            let (coarse, fine) = (off(2e-5), off(1e-5));
            // 1 kg and more that falls by some 0.3 m.
            assert!(coarse < 2e-2 && fine < 0.7 * coarse, "{damping}: {coarse} J, {fine} J");
        }
    }
}
