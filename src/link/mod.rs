//! Arm link: a flexible beam, clamped at the joint, with a payload at its tip.
//!
//! ```text
//! mu*d2(x*theta + w)/dt2 + EI*w'''' = loads,   w(0) = w'(0) = 0          Euler-Bernoulli, at the tip mass M and inertia J
//! w(x, t) = sum_i phi_i(x)*q_i(t) + (loads at rest on the modes that are left out)
//! d2q_i + 2*zeta_i*omega_i*dq_i + omega_i^2*q_i = -c_i*alpha + phi_i(L)*F - s_i*g*cos(theta) + p_i*T
//! torque = I*alpha + sum_i c_i*d2q_i - L*F + g*(S*cos(theta) - sin(theta)*sum_i s_i*q_i)
//! c_i = integral of mu*x*phi_i + M*L*phi_i(L) + J*phi_i'(L) = EI*phi_i''(0)/omega_i^2
//! s_i = integral of mu*phi_i + M*phi_i(L) = -EI*phi_i'''(0)/omega_i^2       p_i = phi_i'(end) - phi_i'(start)
//! I = mu*L^3/3 + M*L^2 + J          S = mu*L^2/2 + M*L          modes of unit mass, integral of mu*phi_i^2 + ... = 1
//! ```
//!
//! One c_i drives the mode and loads the joint, so that the power at joint and tip is the change of the energy plus what
//! damping takes. Eigenvalues and shapes are the exact ones of the beam with its payload (`eigenvalue.rs`, `mode_shape.rs`).
//! The modes that are left out follow their loads at rest: the deflection under a steady load is exact for any number of modes.
//!
//! Signs: theta from the horizontal, alpha its acceleration, w and F upwards where the link is horizontal, across it always. `torque` is
//! what the joint must supply; the link turns the joint by its negative, which is tau_load of [`crate::gear`]. T is a couple that a
//! patch between `start` and `end` applies: it bends the tip upwards. Strain is that of the upper face, +thickness/2.
//! Units: m, kg, s, N, rad; q (m kg^1/2).
//!
//! Left out: shear and rotary inertia of the beam, shortening, and stiffening by the centrifugal force, of a size of
//! (velocity/omega_1)^2 in the first mode's frequency.
//!
//! Discretisation: every mode by its exact transition for loads that are linear between two samples (`oscillator.rs`): no dt is
//! unstable. A dt of a quarter of the highest mode's period or more is refused: of such a mode the samples show too little.
//!
//! L. Meirovitch, "Analytical methods in vibrations", 1967, chapters 5 and 7; J.-N. Juang, L. Horta, "Effects of
//! atmosphere on slewing control of a flexible structure", Journal of Guidance, Control and Dynamics 10 (1987).

mod eigenvalue;
mod mode_shape;
mod oscillator;
mod params;
mod static_shape;
#[cfg(test)]
mod tests;

use crate::gear::Motion;
use crate::real::Real;
use oscillator::Oscillator;
pub use params::{LinkParams, MOST_MODES, Span};

/// Loads: acceleration of the joint, force at the tip, weight, couple of the patch.
const LOADS: usize = 4;
/// Largest load of each kind; one beyond it counts as this.
const LOAD_LIMITS: [f64; LOADS] = [1e6, 1e6, 1e3, 1e6];
/// Largest speed of the joint (rad/s), alike.
const VELOCITY_LIMIT: f64 = 1e5;

/// The beam in f64, which `build` computes in.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Beam {
    length: f64,
    /// EI.
    stiffness: f64,
    /// mu.
    density: f64,
    thickness: f64,
    mass: f64,
    inertia: f64,
    patch: Option<[f64; 2]>,
}

/// What is read from a shape of the link: linear in modes and loads.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reading<R, const K: usize> {
    modes: [R; K],
    /// Of the modes that are left out.
    loads: [R; LOADS],
}

/// A strain gauge on the upper face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauge<R, const K: usize>(Reading<R, K>);

/// A link with `K` modes, stepped by a fixed dt.
///
/// A tip force bends it as the textbook says, and turning it fast makes it swing:
///
/// ```
/// use strainwave::gear::Motion;
/// use strainwave::link::{LinkInput, LinkParams};
///
/// let params = LinkParams {
///     length: 0.5, bending_stiffness: 60.0, linear_density: 0.4, thickness: 4e-3,
///     payload_mass: 0.2, payload_inertia: 1e-4, damping: [0.01, 0.01], gravity: 0.0, patch: None,
/// };
/// let link = params.build(1e-4_f64)?;
/// let pulled = LinkInput { tip_force: 3.0, ..LinkInput::default() };
/// let deflection = link.peek(&link.settled(&pulled), &pulled).deflection;
/// assert!((deflection - 3.0 * 0.5_f64.powi(3) / (3.0 * 60.0)).abs() < 1e-12);
///
/// let (mut state, mut joint, mut most) = (link.settled(&LinkInput::default()), Motion::default(), 0.0_f64);
/// for k in 0..2000 {
///     let acceleration = if k < 1000 { 8.0 } else { -8.0 }; // rad/s^2, from rest to rest
///     let output = link.step(&mut state, &LinkInput { joint, acceleration, ..LinkInput::default() });
///     joint.advance(acceleration, 1e-4);
///     most = most.max(output.deflection.abs());
/// }
/// assert!(most > 2e-3); // m, against the motion
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link<R, const K: usize> {
    modes: [Oscillator<R>; K],
    /// Modal load per load: -c_i, phi_i(L), -s_i, p_i.
    coupling: [[R; LOADS]; K],
    deflection: Reading<R, K>,
    rotation: Reading<R, K>,
    length: R,
    gravity: R,
    /// I.
    inertia: R,
    /// S.
    moment: R,
}

/// Motion of the modes, and the last loads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkState<R, const K: usize> {
    /// q and dq.
    modes: [[R; 2]; K],
    loads: [R; LOADS],
}

impl<R: Real, const K: usize> Default for LinkState<R, K> {
    /// At rest, straight, without load.
    fn default() -> Self {
        Self { modes: [[R::ZERO; 2]; K], loads: [R::ZERO; LOADS] }
    }
}

/// What acts on a link at a sample; linear up to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkInput<R> {
    /// Angle of the joint from the horizontal, and its speed (rad/s).
    pub joint: Motion<R>,
    /// Acceleration of the joint (rad/s^2); at most 1e6 counts.
    pub acceleration: R,
    /// External force on the tip, across the link, forwards (N); at most 1e6 counts.
    pub tip_force: R,
    /// Couple of the patch (N m); at most 1e6 counts.
    pub couple: R,
}

/// A link at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkOutput<R> {
    /// w at the tip, across the link (m).
    pub deflection: R,
    /// Tip in the plane of the joint: along the horizontal, upwards (m).
    pub tip: [R; 2],
    /// Speed of the tip across the link (m/s), of the modes that are not left out.
    pub tip_velocity: R,
    /// Rate of that speed (m/s^2), of the same modes.
    pub tip_acceleration: R,
    /// Torque that the joint must supply (N m).
    pub torque: R,
    /// Slope of the link at the end of the patch less that at its start (rad).
    pub rotation: R,
}

impl<R: Real, const K: usize> Reading<R, K> {
    fn of(&self, state: &LinkState<R, K>) -> R {
        let modes = self.modes.iter().zip(&state.modes).fold(R::ZERO, |sum, (of, mode)| sum + *of * mode[0]);
        product(&self.loads, &state.loads) + modes
    }
}

fn product<R: Real>(a: &[R; LOADS], b: &[R; LOADS]) -> R {
    a.iter().zip(b).fold(R::ZERO, |sum, (a, b)| sum + *a * *b)
}

impl<R: Real, const K: usize> Link<R, K> {
    /// Natural frequencies of the modes with the joint held (rad/s).
    pub fn frequencies(&self) -> [R; K] {
        self.modes.map(|mode| mode.omega)
    }

    /// Coefficients c_i that couple each mode with the joint (m kg^1/2).
    pub fn joint_coupling(&self) -> [R; K] {
        self.coupling.map(|of_load| -of_load[0])
    }

    /// I: the inertia of the link that does not bend, with its payload (kg m^2).
    pub fn rigid_inertia(&self) -> R {
        self.inertia
    }

    /// Change of the torque with the acceleration of the same sample (kg m^2): what a joint turns at once. The torque of a step is that of
    /// the same step of a copy without acceleration, and this times the acceleration, but for the weight of the bending.
    pub fn immediate_inertia(&self) -> R {
        let follows = self.modes.iter().zip(&self.coupling);
        follows.fold(self.inertia, |sum, (mode, of_load)| sum - of_load[0] * of_load[0] * mode.response())
    }

    /// At rest under a load that stays: the acceleration counts as the load that it is.
    pub fn settled(&self, input: &LinkInput<R>) -> LinkState<R, K> {
        let loads = self.loads(input, &[R::ZERO; LOADS]);
        let at_rest = |k: usize| [product(&self.coupling[k], &loads) / self.modes[k].stiffness, R::ZERO];
        LinkState { modes: core::array::from_fn(at_rest), loads }
    }

    /// Moves the link from the last sample to this one, and answers with it there.
    pub fn step(&self, state: &mut LinkState<R, K>, input: &LinkInput<R>) -> LinkOutput<R> {
        let loads = self.loads(input, &state.loads);
        for ((mode, of_load), at) in self.modes.iter().zip(&self.coupling).zip(&mut state.modes) {
            *at = mode.step(*at, product(of_load, &state.loads), product(of_load, &loads));
        }
        state.loads = loads;
        self.output(state, input)
    }

    /// A link in this state, not moved on.
    pub fn peek(&self, state: &LinkState<R, K>, input: &LinkInput<R>) -> LinkOutput<R> {
        self.output(&LinkState { loads: self.loads(input, &state.loads), ..*state }, input)
    }

    /// Strain at a gauge after the last step, without unit; positive when the upper face is longer.
    pub fn strain(&self, state: &LinkState<R, K>, gauge: &Gauge<R, K>) -> R {
        gauge.0.of(state)
    }

    /// Kinetic, elastic and potential energy (J) for this motion of the joint; of the modes that are left out, none.
    pub fn energy(&self, state: &LinkState<R, K>, joint: &Motion<R>) -> R {
        let (sine, cosine) = joint.angle.sin_cos();
        let (half, v) = (R::lit(0.5), joint.velocity);
        let rigid = half * self.inertia * v * v + self.gravity * self.moment * sine;
        let modes = self.modes.iter().zip(&self.coupling).zip(&state.modes);
        modes.fold(rigid, |sum, ((mode, of_load), [q, dq])| {
            let bending = half * (*dq * *dq + mode.stiffness * *q * *q);
            sum + bending - v * of_load[0] * *dq - self.gravity * cosine * of_load[2] * *q
        })
    }

    /// The loads of an input; what is not a number stays as it was.
    fn loads(&self, input: &LinkInput<R>, before: &[R; LOADS]) -> [R; LOADS] {
        let weight = self.gravity * input.joint.angle.sin_cos().1;
        let given = [input.acceleration, input.tip_force, weight, input.couple];
        core::array::from_fn(|k| given[k].finite_or(before[k]).limit(R::lit(LOAD_LIMITS[k])))
    }

    fn output(&self, state: &LinkState<R, K>, input: &LinkInput<R>) -> LinkOutput<R> {
        let (sine, cosine) = input.joint.angle.sin_cos();
        let (sine, cosine) = (sine.finite_or(R::ZERO), cosine.finite_or(R::ONE));
        let deflection = self.deflection.of(state);
        let velocity = input.joint.velocity.finite_or(R::ZERO).limit(R::lit(VELOCITY_LIMIT));
        let [acceleration, tip_force, weight, _] = state.loads;
        let mut torque = self.inertia * acceleration - self.length * tip_force + self.moment * weight;
        let mut tip_velocity = self.length * velocity;
        let mut tip_acceleration = self.length * acceleration;
        for ((mode, of_load), at) in self.modes.iter().zip(&self.coupling).zip(&state.modes) {
            torque += self.gravity * sine * of_load[2] * at[0];
            let mode_acceleration = mode.acceleration(*at, product(of_load, &state.loads));
            torque += -of_load[0] * mode_acceleration;
            tip_velocity += of_load[1] * at[1];
            tip_acceleration += of_load[1] * mode_acceleration;
        }
        LinkOutput {
            deflection,
            tip: [self.length * cosine - deflection * sine, self.length * sine + deflection * cosine],
            tip_velocity,
            tip_acceleration,
            torque,
            rotation: self.rotation.of(state),
        }
    }
}
