//! Rigid links in a row, one revolute joint each.
//!
//! ```text
//! (M(q) + diag(J_c))*ddq + h(q, dq) = tau          h: centrifugal, Coriolis and gravity torques
//! A_i = Rot_z(q_i) * Trans_z(d_i) * Trans_x(a_i) * Rot_x(alpha_i)
//! ```
//!
//! A_i leads from the frame of link i-1's end to that of link i's: z is the axis of the joint. What follows Rot_z may be any
//! [`Pose`]; that of Denavit and Hartenberg has the length a of the link, its offset d along the axis, and the twist alpha to the
//! next axis. Centre and inertia of a link are in the frame at its joint that turns with it. J_c turns with the joint's flange alone. Sign: tau on the link, against the
//! link before. Units: rad, m, kg, kg m^2, N m, m/s^2.
//!
//! Forward dynamics by the articulated-body algorithm, inverse dynamics by recursive Newton-Euler (crate phyz-rigid, f64).
//! [`Chain::rigid_step`] is a classical Runge-Kutta step of fourth order, for an arm without gears.
//!
//! Reference: R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008.

use phyz_math::{DVec, Mat3, SpatialInertia, SpatialTransform, SpatialTransformExt, Vec3};
use phyz_model::{Model, ModelBuilder, State};
use phyz_rigid::{aba, forward_kinematics, kinetic_energy, rnea, total_energy};
use strainwave::Error;

/// A frame as another one sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Its unit vectors x, y, z in coordinates of the other, a row each.
    pub axes: [[f64; 3]; 3],
    /// Its origin there (m).
    pub place: [f64; 3],
}

impl Pose {
    /// Trans_z(d)*Trans_x(a)*Rot_x(alpha), with a and d in m and alpha in rad.
    pub fn denavit_hartenberg([length, offset]: [f64; 2], twist: f64) -> Self {
        let (sine, cosine) = twist.sin_cos();
        Self {
            axes: [[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]],
            place: [length, 0.0, offset],
        }
    }

    fn is_finite(&self) -> bool {
        self.axes.iter().chain([&self.place]).flatten().all(|number| number.is_finite())
    }
}

/// One link and its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The next joint, or the tip, in the frame at this joint.
    pub end: Pose,
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass (m).
    pub centre: [f64; 3],
    /// I_xx, I_yy, I_zz about the centre, axes parallel to the frame's (kg m^2).
    pub inertia: [f64; 3],
    /// I_xy, I_xz, I_yz, the elements of the tensor (kg m^2).
    pub products: [f64; 3],
    /// J_c (kg m^2).
    pub flange: f64,
}

impl Link {
    /// Mass and inertia times `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let [inertia, products] =
            [self.inertia, self.products].map(|elements| elements.map(|element| factor * element));
        Self { mass: factor * self.mass, inertia, products, ..self }
    }

    /// # Errors
    /// [`Error::OutOfRange`] `end` or `centre` if not finite, `mass` unless positive, `inertia` unless its principal moments are
    /// positive and none exceeds the sum of the others, `flange` if negative.
    fn check(&self) -> Result<(), Error> {
        let require = |holds: bool, name| if holds { Ok(()) } else { Err(Error::OutOfRange(name)) };
        require(self.end.is_finite(), "end")?;
        require(self.mass.is_finite() && self.mass > 0.0, "mass")?;
        require(self.centre.iter().all(|place| place.is_finite()), "centre")?;
        require(is_inertia(self.principal_moments()), "inertia")?;
        require(self.flange.is_finite() && self.flange >= 0.0, "flange")
    }

    /// Principal moments of the inertia about the centre (kg m^2).
    pub fn principal_moments(&self) -> [f64; 3] {
        if self.products == [0.0; 3] {
            return self.inertia;
        }
        let ([xx, yy, zz], [xy, xz, yz]) = (self.inertia, self.products);
        nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigenvalues().into()
    }

    /// From coordinates of this joint's frame to those of the next.
    pub(super) fn end(&self) -> SpatialTransform {
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = self.end.axes;
        SpatialTransform::new(Mat3::new(xx, xy, xz, yx, yy, yz, zx, zy, zz), self.tip())
    }

    pub(super) fn tip(&self) -> Vec3 {
        let [x, y, z] = self.end.place;
        Vec3::new(x, y, z)
    }

    pub(super) fn spatial_inertia(&self) -> SpatialInertia {
        let [x, y, z] = self.centre;
        let ([xx, yy, zz], [xy, xz, yz]) = (self.inertia, self.products);
        let tensor = Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        SpatialInertia::new(self.mass, Vec3::new(x, y, z), tensor)
    }
}

/// Moments that a body can have: positive, none larger than the sum of the others.
pub fn is_inertia(moments: [f64; 3]) -> bool {
    let sum: f64 = moments.iter().sum();
    moments.iter().all(|moment| *moment > 0.0 && 2.0 * moment <= sum * (1.0 + 1e-9)) && sum.is_finite()
}

/// The links of an arm.
#[derive(Clone, Debug)]
pub struct Chain {
    model: Model,
    last: Link,
}

/// Angles, speeds and torques of its joints.
#[derive(Clone, Debug)]
pub struct ChainState(State);

impl ChainState {
    /// Sets the angle (rad) and speed (rad/s) of a joint.
    pub fn set(&mut self, joint: usize, [angle, velocity]: [f64; 2]) {
        self.0.q.as_mut_slice()[joint] = angle;
        self.0.v.as_mut_slice()[joint] = velocity;
    }

    /// Sets all angles (rad), and then all speeds (rad/s).
    fn put(&mut self, values: &[f64]) {
        let (angles, velocities) = values.split_at(values.len() / 2);
        self.0.q.as_mut_slice().copy_from_slice(angles);
        self.0.v.as_mut_slice().copy_from_slice(velocities);
    }

    /// Angles of the joints (rad).
    pub fn angles(&self) -> &[f64] {
        self.0.q.as_slice()
    }

    /// Speeds of the joints (rad/s).
    pub fn velocities(&self) -> &[f64] {
        self.0.v.as_slice()
    }
}

impl Chain {
    /// Links from the base to the tip under gravity (m/s^2), in the frame of the base.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `links` of no link, or with the name of what is out of range in a link.
    pub fn build(links: &[Link], [x, y, z]: [f64; 3]) -> Result<Self, Error> {
        links.iter().try_for_each(Link::check)?;
        let last = *links.last().ok_or(Error::OutOfRange("links"))?;
        let mut builder = ModelBuilder::new().gravity(Vec3::new(x, y, z));
        let mut pose = SpatialTransform::identity();
        for (parent, link) in (-1..).zip(links) {
            builder = builder.add_revolute_body("", parent, pose, link.spatial_inertia());
            pose = link.end();
        }
        let mut model = builder.build();
        for (joint, link) in model.joints.iter_mut().zip(links) {
            joint.armature = link.flange;
        }
        Ok(Self { model, last })
    }

    /// Every joint at rest at the angle 0.
    pub fn rest(&self) -> ChainState {
        ChainState(self.model.default_state())
    }

    /// Accelerations of the joints (rad/s^2) under these torques (N m).
    pub fn accelerations(&self, state: &mut ChainState, torques: &[f64]) -> Vec<f64> {
        state.0.ctrl.as_mut_slice().copy_from_slice(torques);
        aba(&self.model, &state.0).as_slice().to_vec()
    }

    /// Torques (N m) that these accelerations (rad/s^2) need; without J_c.
    pub fn torques(&self, state: &ChainState, accelerations: &[f64]) -> Vec<f64> {
        rnea(&self.model, &state.0, &DVec::from_slice(accelerations)).as_slice().to_vec()
    }

    /// Torques that hold the links against gravity (N m).
    pub fn holding_torques(&self, state: &ChainState) -> Vec<f64> {
        let mut held = state.clone();
        held.0.v.as_mut_slice().fill(0.0);
        self.torques(&held, &vec![0.0; state.angles().len()])
    }

    /// Inertia that a joint feels with all others free (kg m^2).
    pub fn free_inertia(&self, state: &ChainState, joint: usize) -> f64 {
        let mut torques = self.holding_torques(state);
        let mut held = state.clone();
        held.0.v.as_mut_slice().fill(0.0);
        torques[joint] += 1.0;
        1.0 / self.accelerations(&mut held, &torques)[joint]
    }

    /// Kinetic energy, with that of J_c (J).
    pub fn kinetic_energy(&self, state: &ChainState) -> f64 {
        kinetic_energy(&self.model, &state.0)
    }

    /// Kinetic and potential energy, with that of J_c (J).
    pub fn energy(&self, state: &ChainState) -> f64 {
        total_energy(&self.model, &state.0)
    }

    /// Place of the tip in the frame of the base (m).
    pub fn tip(&self, state: &ChainState) -> [f64; 3] {
        place_on_last(&self.model, &state.0, self.last.tip())
    }

    /// Moves an arm without gears and torques on by `dt` (s).
    pub fn rigid_step(&self, state: &mut ChainState, dt: f64) {
        let free = vec![0.0; state.angles().len()];
        let start = [state.angles(), state.velocities()].concat();
        let mut slope = vec![0.0; start.len()];
        let mut sum = start.clone();
        for (ahead, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let at: Vec<_> =
                start.iter().zip(&slope).map(|(start, slope)| start + ahead * dt * slope).collect();
            state.put(&at);
            let accelerations = self.accelerations(state, &free);
            slope = [state.velocities(), &accelerations].concat();
            sum.iter_mut().zip(&slope).for_each(|(sum, slope)| *sum += dt * weight / 6.0 * slope);
        }
        state.put(&sum);
    }
}

/// A place on the last body, in the frame of the base (m).
pub(super) fn place_on_last(model: &Model, state: &State, on_last: Vec3) -> [f64; 3] {
    let (poses, _) = forward_kinematics(model, state);
    let place = poses.last().map_or(Vec3::zeros(), |pose| pose.body_to_world_point(on_last));
    [place.x, place.y, place.z]
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAVITY: f64 = 9.806_65;

    fn link(length: f64) -> Link {
        twisted([length, 0.0], 0.0)
    }

    fn twisted(along: [f64; 2], twist: f64) -> Link {
        Link {
            end: Pose::denavit_hartenberg(along, twist),
            mass: 3.0,
            centre: [0.2, 0.0, 0.0],
            inertia: [0.01, 0.05, 0.05],
            products: [0.0; 3],
            flange: 0.0,
        }
    }

    fn arm() -> Chain {
        Chain::build(&[link(0.4), link(0.3)], [0.0, -GRAVITY, 0.0]).unwrap()
    }

    fn state(chain: &Chain, motions: &[[f64; 2]]) -> ChainState {
        let mut state = chain.rest();
        motions.iter().enumerate().for_each(|(joint, motion)| state.set(joint, *motion));
        state
    }

    /// The textbook's arm of two links.
    #[test]
    fn two_links_have_their_closed_form() {
        let (chain, [q1, q2], [v1, v2], [a1, a2]) = (arm(), [0.3, 0.7], [1.1, -0.8], [2.0, -3.0]);
        let (m, c, i, l) = (3.0, 0.2, 0.05, 0.4);
        let m22 = i + m * c * c;
        let m12 = m22 + m * l * c * f64::cos(q2);
        let m11 = 2.0 * m22 + m * l * l + 2.0 * m * l * c * f64::cos(q2);
        let k = m * l * c * f64::sin(q2);
        let outer = m * GRAVITY * c * f64::cos(q1 + q2);
        let inner = m * GRAVITY * (c + l) * f64::cos(q1);
        let expected = [
            m11 * a1 + m12 * a2 - k * (2.0 * v1 * v2 + v2 * v2) + inner + outer,
            m12 * a1 + m22 * a2 + k * v1 * v1 + outer,
        ];
        let found = chain.torques(&state(&chain, &[[q1, v1], [q2, v2]]), &[a1, a2]);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
        let free = chain.free_inertia(&state(&chain, &[[q1, v1], [q2, v2]]), 0);
        assert!((free - (m11 - m12 * m12 / m22)).abs() < 1e-12, "{free}");
    }

    #[test]
    fn forward_dynamics_is_the_inverse_of_inverse_dynamics() {
        let links = [twisted([0.4, 0.1], 1.2), twisted([0.3, 0.0], -0.7), link(0.2)];
        let chain = Chain::build(&links, [1.0, -2.0, -9.0]).unwrap();
        let mut state = state(&chain, &[[0.3, 1.0], [-0.8, 0.5], [1.5, -2.0]]);
        let asked = [3.0, -1.0, 0.5];
        let torques = chain.torques(&state, &asked);
        let found = chain.accelerations(&mut state, &torques);
        assert!(found.iter().zip(asked).all(|(a, b)| (a - b).abs() < 1e-10), "{found:?}");
    }

    /// What turns with the flange alone adds to the joint's own inertia.
    #[test]
    fn the_flange_adds_to_the_diagonal() {
        let with = Chain::build(&[Link { flange: 0.3, ..link(0.4) }], [0.0; 3]).unwrap();
        let bare = Chain::build(&[link(0.4)], [0.0; 3]).unwrap();
        let inertia = |chain: &Chain| chain.free_inertia(&chain.rest(), 0);
        assert!((inertia(&with) - inertia(&bare) - 0.3).abs() < 1e-12);
    }

    #[test]
    fn the_tip_is_where_the_links_lead() {
        let chain = arm();
        let [x, y, z] = chain.tip(&state(&chain, &[[0.3, 0.0], [0.7, 0.0]]));
        let (expected_x, expected_y) =
            (0.4 * 0.3f64.cos() + 0.3 * 1f64.cos(), 0.4 * 0.3f64.sin() + 0.3 * 1f64.sin());
        assert!((x - expected_x).abs() < 1e-15 && (y - expected_y).abs() < 1e-15 && z == 0.0);
        // A quarter of twist leads the second link out of the plane.
        let bent = Chain::build(&[twisted([0.4, 0.0], std::f64::consts::FRAC_PI_2), link(0.3)], [0.0; 3]);
        let chain = bent.unwrap();
        let [x, y, z] = chain.tip(&state(&chain, &[[0.0, 0.0], [std::f64::consts::FRAC_PI_2, 0.0]]));
        assert!((x - 0.4).abs() < 1e-12 && y.abs() < 1e-12 && (z - 0.3).abs() < 1e-12, "{x} {y} {z}");
    }

    /// Of fourth order: half the step, a sixteenth of the error.
    #[test]
    fn the_rigid_arm_keeps_its_energy() {
        let chain = arm();
        let lost = |dt: f64| {
            let mut state = state(&chain, &[[-0.35, 0.0], [1.1, 0.0]]);
            let before = chain.energy(&state);
            (0..(1.0 / dt).round() as u32).for_each(|_| chain.rigid_step(&mut state, dt));
            (chain.energy(&state) - before).abs()
        };
        let (coarse, fine) = (lost(1e-2), lost(5e-3));
        assert!(coarse < 1e-2 && fine < 0.1 * coarse, "{coarse} J, {fine} J");
    }

    #[test]
    fn what_no_body_can_have_is_refused_by_name() {
        let refused = |link: Link| Chain::build(&[link], [0.0; 3]).unwrap_err();
        assert_eq!(refused(Link { mass: 0.0, ..link(0.4) }), Error::OutOfRange("mass"));
        assert_eq!(refused(Link { inertia: [0.1, 0.01, 0.01], ..link(0.4) }), Error::OutOfRange("inertia"));
        assert_eq!(refused(link(f64::NAN)), Error::OutOfRange("end"));
        // Each element is one of a body, the tensor is not: its least principal moment is below 0.
        assert_eq!(refused(Link { products: [0.0, 0.0, 0.06], ..link(0.4) }), Error::OutOfRange("inertia"));
        assert_eq!(refused(Link { flange: -1.0, ..link(0.4) }), Error::OutOfRange("flange"));
        assert_eq!(Chain::build(&[], [0.0; 3]).unwrap_err(), Error::OutOfRange("links"));
    }
}
