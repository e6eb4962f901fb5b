//! Both spans of the belt as chains of masses, springs and dampers; axial stretching alone.
//!
//! ```text
//! d_j  = sigma*(x_j - x_(j-1)),   x_0 = 0,   x_(N+1) = travel,   j = 1..N+1       elongation of a link beyond assembly
//! T_j  = max(0, F0 + k*d_j + c*dd_j)  where F0 + k*d_j > 0,  else 0               tension: a slack link never pushes
//! m * dv_i = sigma*(T_(i+1) - T_i),   dx_i = v_i - v_0,   i = 1..N                nodes
//! k = (N + 1)*EA/L,   c = T_d*k,   m = rho*L/(N + 1)
//! ```
//!
//! N nodes a span, counted from the output's pulley to the motor's; half a link's mass at each end moves with the pulley. x_i is the
//! displacement of a node along the belt, in the direction in which the belt runs when the motor turns forwards, beyond that of
//! the belt on the output's pulley; travel is that of the belt on the motor's pulley beyond it, v_0 and v_(N+1) the speeds of both.
//! sigma is +1 in the forward span, which the motor pulls when it turns forwards, -1 in the backward span.
//!
//! Sign: tension is positive. Units: x, d, L (m); v (m/s); T, F0 and EA (N); rho (kg/m); T_d, c/k (s).
//!
//! Discretisation: semi-implicit Euler with the step dt, speeds first; a step moves the nodes by the speeds of the step before
//! and then accelerates them, so that both pulleys are where their motion says. By Gershgorin's circles no mode is faster than
//! w^2 = 4*k/M, M the smaller of m and the output's mass at the belt: stable for dt^2 + 2*T_d*dt < M/k ([`SpanParams::stable_step`]). The
//! belt does not move through the nodes: what that leaves out is of the order of its speed over that of sound in it, 1e-2 at most.
//!
//! Without a node (N = 0) the chain is the real-time reduction: each span one damped spring, without mass of its own,
//! the tension the same at both ends. Its mass moves with the pulleys, half with each.
//!
//! Reference: W. Thomson, M. Dahleh, "Theory of Vibration with Applications", 5th ed. (1998), chapters on lumped chains.

use core::array::from_fn;

use crate::error::{Error, require};
use crate::real::Real;

/// A displacement (m) and a speed (m/s) of a node beyond these count as these.
const LIMIT: f64 = 1e6;

/// One span; both are alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanParams<R> {
    /// L, free length between the pulleys (m); 1e-3..=100.
    pub length: R,
    /// EA, force over strain of the belt (N); 1..=1e9.
    pub stiffness: R,
    /// rho, mass over length of the belt (kg/m); 1e-5..=100.
    pub mass: R,
    /// F0, tension of the span at rest, without torque (N); 0..=1e6.
    pub pretension: R,
    /// T_d, damping over stiffness of the belt (s); 0..=1.
    pub damping_time: R,
}

impl<R: Real> SpanParams<R> {
    /// Checks the span alone.
    pub(super) fn check(&self) -> Result<(), Error> {
        let within = |value: R, least: f64, most: f64| (R::lit(least)..=R::lit(most)).contains(&value);
        require(within(self.length, 1e-3, 100.0), "length")?;
        require(within(self.stiffness, 1.0, 1e9), "stiffness")?;
        require(within(self.mass, 1e-5, 100.0), "mass")?;
        require(within(self.pretension, 0.0, 1e6), "pretension")?;
        require(within(self.damping_time, 0.0, 1.0), "damping_time")
    }

    /// Stiffness of the span, EA/L (N/m).
    pub fn span_stiffness(&self) -> R {
        self.stiffness / self.length
    }

    /// rho*L/(N + 1), of a link of a chain of `nodes` N (kg). Of each of the four ends of both spans half of it moves with a
    /// pulley.
    pub fn link_mass(&self, nodes: usize) -> R {
        self.mass * self.length / Self::links(nodes)
    }

    /// Every longer step of a chain of `nodes` N may be unstable (s). `output_mass` (kg) is the inertia that moves with the
    /// output's pulley over the square of its radius. Accuracy takes shorter ones.
    pub fn stable_step(&self, nodes: usize, output_mass: R) -> R {
        let lightest = if nodes == 0 { output_mass } else { output_mass.min(self.link_mass(nodes)) };
        let square = lightest / (Self::links(nodes) * self.span_stiffness());
        // The root of dt^2 + 2*T_d*dt = square, without a difference of equal numbers.
        square / ((self.damping_time * self.damping_time + square).sqrt() + self.damping_time)
    }

    fn links(nodes: usize) -> R {
        R::from_i32(nodes as i32 + 1)
    }

    /// A chain of `N` nodes a span whose step is `dt` (s).
    pub(super) fn build<const N: usize>(&self, output_mass: R, dt: R) -> Result<Chain<R, N>, Error> {
        self.check()?;
        require(dt.is_positive() && dt < self.stable_step(N, output_mass), "dt")?;
        let stiffness = Self::links(N) * self.span_stiffness();
        Ok(Chain {
            pretension: self.pretension,
            stiffness,
            damping: self.damping_time * stiffness,
            dt,
            dt_over_mass: dt / self.link_mass(N),
        })
    }
}

/// Motion of the belt on both pulleys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeltEnds<R> {
    /// Travel at the motor's pulley less that at the output's (m).
    pub travel: R,
    /// Speed at the motor's pulley (m/s).
    pub motor_speed: R,
    /// Speed at the output's pulley (m/s).
    pub output_speed: R,
}

/// Tensions of a span at its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tension<R> {
    /// At the motor's pulley (N).
    pub motor: R,
    /// At the output's pulley (N).
    pub output: R,
    /// A link of the span is slack.
    pub slack: bool,
}

/// What the chain does to both pulleys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeltReaction<R> {
    /// Span that the motor pulls when it turns forwards.
    pub forward: Tension<R>,
    /// Span that it pulls when it turns backwards.
    pub backward: Tension<R>,
    /// Power that the dampers take, never negative (W).
    pub loss: R,
}

/// Nodes of a span, the first beside the output's pulley.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanState<R, const N: usize> {
    /// x_i before the last step's motion (m).
    pub displacement: [R; N],
    /// v_i (m/s).
    pub velocity: [R; N],
}

/// Nodes of both spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainState<R, const N: usize> {
    /// Of the forward span.
    pub forward: SpanState<R, N>,
    /// Of the backward span.
    pub backward: SpanState<R, N>,
}

impl<R: Real, const N: usize> ChainState<R, N> {
    /// Every link as at assembly, the belt running at `speed` (m/s).
    pub fn running(speed: R) -> Self {
        let span = SpanState { displacement: [R::ZERO; N], velocity: [speed.limit(R::lit(LIMIT)); N] };
        Self { forward: span, backward: span }
    }
}

/// Both spans, built for a step dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain<R, const N: usize> {
    pretension: R,
    /// k (N/m).
    stiffness: R,
    /// c (N s/m).
    damping: R,
    dt: R,
    /// dt/m (s/kg).
    dt_over_mass: R,
}

/// Tension of a link, and the power that its damper takes.
struct Link<R> {
    tension: R,
    loss: R,
}

impl<R: Real, const N: usize> Chain<R, N> {
    /// One step dt: the tensions for the motion of both ends.
    pub fn step(&self, state: &mut ChainState<R, N>, ends: &BeltEnds<R>) -> BeltReaction<R> {
        let limit = R::lit(LIMIT);
        let ends = BeltEnds {
            travel: ends.travel.limit(limit),
            motor_speed: ends.motor_speed.limit(limit),
            output_speed: ends.output_speed.limit(limit),
        };
        let (forward, forward_loss) = self.span(&mut state.forward, &ends, R::ONE);
        let (backward, backward_loss) = self.span(&mut state.backward, &ends, -R::ONE);
        BeltReaction { forward, backward, loss: forward_loss + backward_loss }
    }

    /// The same of the span with the sign sigma.
    fn span(&self, span: &mut SpanState<R, N>, ends: &BeltEnds<R>, sigma: R) -> (Tension<R>, R) {
        span.displacement = self.moved(span, ends);
        let mut at = (R::ZERO, ends.output_speed);
        let (mut output, mut behind, mut loss) = (R::ZERO, R::ZERO, R::ZERO);
        let mut slack = false;
        for j in 0..=N {
            let inside = j < N;
            let next = if inside {
                (span.displacement[j], span.velocity[j])
            } else {
                (ends.travel, ends.motor_speed)
            };
            let link = self.link(sigma * (next.0 - at.0), sigma * (next.1 - at.1));
            if j == 0 {
                output = link.tension;
            } else {
                // The node behind this link.
                let velocity = &mut span.velocity[j - 1];
                let change = sigma * (link.tension - behind) * self.dt_over_mass;
                *velocity = (*velocity + change).limit(R::lit(LIMIT));
            }
            loss += link.loss;
            slack |= link.tension <= R::ZERO;
            (behind, at) = (link.tension, next);
        }
        (Tension { motor: behind, output, slack }, loss)
    }

    /// Displacements at this step, after the way since the last one.
    fn moved(&self, span: &SpanState<R, N>, ends: &BeltEnds<R>) -> [R; N] {
        from_fn(|i| {
            let way = self.dt * (span.velocity[i] - ends.output_speed);
            (span.displacement[i] + way).limit(R::lit(LIMIT))
        })
    }

    #[inline(always)]
    fn link(&self, elongation: R, rate: R) -> Link<R> {
        let elastic = self.pretension + self.stiffness * elongation;
        let taut = elastic > R::ZERO;
        let tension = if taut { (elastic + self.damping * rate).max(R::ZERO) } else { R::ZERO };
        Link { tension, loss: (tension - elastic.max(R::ZERO)) * rate }
    }

    /// Energy of the springs, 0 when slack, and of the nodes' motion, both at the next step with these `ends` (J): the speeds of a
    /// state are those between its displacements.
    pub fn energy(&self, state: &ChainState<R, N>, ends: &BeltEnds<R>) -> R {
        let mut next = *state;
        self.step(&mut next, ends);
        let spans = [(&state.forward, &next.forward, R::ONE), (&state.backward, &next.backward, -R::ONE)];
        spans.into_iter().fold(R::ZERO, |sum, (before, after, sigma)| {
            sum + self.elastic_energy(&after.displacement, ends.travel, sigma)
                + self.kinetic_energy(before, after)
        })
    }

    fn elastic_energy(&self, displacement: &[R; N], travel: R, sigma: R) -> R {
        let mut sum = R::ZERO;
        let mut behind = R::ZERO;
        for at in displacement.iter().copied().chain([travel]) {
            let elastic = (self.pretension + self.stiffness * sigma * (at - behind)).max(R::ZERO);
            sum += elastic * elastic;
            behind = at;
        }
        sum / (R::lit(2.0) * self.stiffness)
    }

    /// With the mean of the speeds before and after a step.
    fn kinetic_energy(&self, before: &SpanState<R, N>, after: &SpanState<R, N>) -> R {
        let speeds = before.velocity.iter().zip(&after.velocity);
        let squares = speeds.fold(R::ZERO, |sum, (a, b)| sum + (*a + *b) * (*a + *b));
        // m/2 of the square of the mean.
        squares * self.dt / (R::lit(8.0) * self.dt_over_mass)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SPAN: SpanParams<f64> =
        SpanParams { length: 0.3, stiffness: 2.8e5, mass: 0.05, pretension: 200.0, damping_time: 0.0 };

    fn chain<const N: usize>(damping_time: f64) -> Chain<f64, N> {
        let span = SpanParams { damping_time, ..SPAN };
        span.build(100.0, 0.9 * span.stable_step(N, 100.0)).unwrap()
    }

    /// A state of small random displacements and speeds.
    fn shaken(seed: &[f64]) -> ChainState<f64, 5> {
        let span = |at: usize| SpanState {
            displacement: from_fn(|i| 1e-6 * seed[at + i]),
            velocity: from_fn(|i| 0.01 * seed[at + 5 + i]),
        };
        ChainState { forward: span(0), backward: span(10) }
    }

    #[test]
    fn the_spans_pull_against_each_other() {
        let k = SPAN.span_stiffness();
        for travel in [0.0, 1e-5, -1e-4] {
            let ends = BeltEnds { travel, ..BeltEnds::default() };
            let reaction = chain::<0>(0.0).step(&mut ChainState::running(0.0), &ends);
            assert!((reaction.forward.output - (200.0 + k * travel)).abs() < 1e-9);
            assert!((reaction.backward.output - (200.0 - k * travel)).abs() < 1e-9);
            assert_eq!(reaction.forward.output, reaction.forward.motor);
        }
    }

    #[test]
    fn a_slack_span_never_pushes_however_it_moves() {
        let model = chain::<0>(1e-3);
        for (travel, motor_speed) in [(1e-3, 0.0), (1e-3, -3.0), (1e-4, 100.0)] {
            let ends = BeltEnds { travel, motor_speed, output_speed: 0.0 };
            let backward = model.step(&mut ChainState::running(0.0), &ends).backward;
            assert!(backward.output == 0.0 && backward.slack);
        }
    }

    proptest! {
        /// A mirror image of the motion loads the other span alike.
        #[test]
        fn the_spans_are_mirror_images(seed in prop::collection::vec(-1.0..1.0f64, 20), travel in -2e-3..2e-3f64, speed in -1.0..1.0f64) {
            let model = chain::<5>(1e-6);
            let state = shaken(&seed);
            let minus = |span: SpanState<f64, 5>| SpanState {
                displacement: span.displacement.map(|x| -x),
                velocity: span.velocity.map(|v| -v),
            };
            let (mut here, mut there) =
                (state, ChainState { forward: minus(state.backward), backward: minus(state.forward) });
            for _ in 0..100 {
                let ends = BeltEnds { travel, motor_speed: speed, output_speed: 0.3 * speed };
                let mirrored = BeltEnds { travel: -travel, motor_speed: -speed, output_speed: -0.3 * speed };
                let (one, other) = (model.step(&mut here, &ends), model.step(&mut there, &mirrored));
                prop_assert_eq!(one.forward, other.backward);
                prop_assert_eq!(one.backward, other.forward);
            }
        }

        /// Between ends that stand still every motion loses energy, and none without damping.
        #[test]
        fn dampers_take_energy_and_springs_none(seed in prop::collection::vec(-1.0..1.0f64, 20)) {
            let ends = BeltEnds::default();
            for damping_time in [0.0, 1e-7] {
                let span = SpanParams { damping_time, ..SPAN };
                let model: Chain<f64, 5> = span.build(100.0, 0.02 * span.stable_step(5, 100.0)).unwrap();
                let mut state = shaken(&seed);
                let start = model.energy(&state, &ends);
                let brought = start - model.energy(&ChainState::running(0.0), &ends);
                let mut lost = 0.0;
                for _ in 0..10_000 {
                    let loss = model.step(&mut state, &ends).loss;
                    prop_assert!(loss >= 0.0);
                    lost += loss * model.dt;
                }
                let end = model.energy(&state, &ends);
                prop_assert!((end + lost - start).abs() < 1e-3 * brought + 0.03 * lost, "{start} {end} {lost}");
            }
        }

        /// Just below the bound of the step every motion stays bounded, slack or taut.
        #[test]
        fn the_bound_of_the_step_holds(seed in prop::collection::vec(-1.0..1.0f64, 20), damping in 0usize..3) {
            let span = SpanParams { damping_time: [0.0, 1e-6, 1e-4][damping], ..SPAN };
            let model: Chain<f64, 5> = span.build(100.0, 0.999 * span.stable_step(5, 100.0)).unwrap();
            let mut state = shaken(&seed);
            for _ in 0..20_000 {
                model.step(&mut state, &BeltEnds::default());
            }
            let moved = state.forward.displacement.iter().chain(&state.backward.displacement);
            prop_assert!(moved.copied().fold(0.0, |a: f64, b| a.max(b.abs())) < 1e-4);
        }
    }

    #[test]
    fn beyond_the_bound_the_fastest_mode_grows() {
        let mut model = chain::<5>(0.0);
        let bound = SPAN.stable_step(5, 100.0);
        // The fastest mode of five nodes is slower than that of infinitely many, which the bound covers.
        model.dt = bound / (5.0 * core::f64::consts::PI / 12.0).sin() * 1.001;
        model.dt_over_mass = model.dt / SPAN.link_mass(5);
        let mut state = ChainState::running(0.0);
        state.forward.displacement = from_fn(|i| if i % 2 == 0 { 1e-9 } else { -1e-9 });
        for _ in 0..2000 {
            model.step(&mut state, &BeltEnds::default());
        }
        assert!(state.forward.displacement[2].abs() > 1e-6);
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let named = |span: SpanParams<f64>, dt: f64| span.build::<5>(100.0, dt).map(|_| ()).unwrap_err();
        let bound = SPAN.stable_step(5, 100.0);
        assert_eq!(named(SPAN, bound), Error::OutOfRange("dt"));
        assert_eq!(named(SPAN, 0.0), Error::OutOfRange("dt"));
        assert_eq!(named(SpanParams { pretension: -1.0, ..SPAN }, 1e-9), Error::OutOfRange("pretension"));
        assert_eq!(named(SpanParams { length: 0.0, ..SPAN }, 1e-9), Error::OutOfRange("length"));
        assert_eq!(named(SpanParams { stiffness: f64::NAN, ..SPAN }, 1e-9), Error::OutOfRange("stiffness"));
        assert_eq!(named(SpanParams { mass: 0.0, ..SPAN }, 1e-9), Error::OutOfRange("mass"));
        assert_eq!(
            named(SpanParams { damping_time: -1e-9, ..SPAN }, 1e-9),
            Error::OutOfRange("damping_time")
        );
    }
}
