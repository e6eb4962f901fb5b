//! Work that friction gives over closed random motion, for every registered model with presliding that cannot give any by
//! construction.
//!
//! A trajectory: strokes at a speed each, the last one back to the start, from rest. The work of a stroke
//! is the integral of F over its pieces by Gauss's rule; because the models step exactly for any length, F
//! at each node is one step from the start of the piece. Smooth models: pieces of at most eps/4, six nodes,
//! 1e-17 of quadrature. Models with kinks: strokes of whole dyadic units on which all kinks lie, a piece a
//! unit, in which F is straight.
//!
//! The figures are the largest gain of a trajectory as a fraction of level times path: rounding.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::friction::any::closed_motions;
use strainwave::friction::{ClosedMotionTest, ForceOverPath, FrictionModel, Slip};
use strainwave::{Error, Heading, Real};

use crate::io::figure::Figure;
use crate::verify::bounds;
use crate::verify::largest;

/// Trajectories of each model: above 10^6 in all, in either precision.
const TRAJECTORIES: usize = 112_000;
/// Strokes before the one that closes the path.
const STROKES: usize = 4;
/// Level (N) and presliding length (m); what the kinks lie on is a power of two.
const LEVEL: f64 = 1.0;
const EPS: f64 = 0.015_625;
/// Kinks of the models that have some lie on multiples of this (m).
const UNIT: f64 = EPS / 8.0;

/// Nodes and weights of Gauss's rule on 0..=1: six nodes, exact to order 11.
const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_423_975, 0.085_662_246_189_585_18),
    (0.169_395_306_766_867_76, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_56, 0.233_956_967_286_345_52),
    (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
    (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_18),
];

pub(super) fn measure() -> Vec<Figure> {
    vec![
        bounds::figure("friction.work.f64", worst_of_all::<f64>()),
        bounds::figure("friction.work.f32", worst_of_all::<f32>()),
    ]
}

/// One way of a trajectory.
#[derive(Clone, Copy)]
struct Stroke {
    /// Its sign is the direction (m).
    way: f64,
    /// (m/s).
    speed: f64,
    /// Further inputs of the gear's block: load (N) and phase of the wave generator.
    load: f64,
    phase: u32,
}

impl Stroke {
    fn random(way: f64, random: &mut ChaCha8Rng) -> Self {
        Self {
            way,
            speed: speed(random),
            load: LEVEL * random.random_range(-1.0..1.0),
            phase: random.random(),
        }
    }
}

/// Largest work given by a registered model that is built not to give any.
struct Worst(f64);

impl<R: Real> ClosedMotionTest<R> for Worst {
    fn run<M: FrictionModel<R>>(&mut self, model: Result<M, Error>, force: ForceOverPath) {
        let strokes = match force {
            ForceOverPath::Smooth => smooth,
            ForceOverPath::Straight => on_units,
        };
        self.0 = largest([self.0, worst(&model.expect("its parameters are in range"), strokes)]);
    }
}

fn worst_of_all<R: Real>() -> f64 {
    let mut all = Worst(0.0);
    closed_motions::<R>(LEVEL, EPS, &mut all);
    all.0
}

/// Strokes from 1e-6 to 1 eps, from far below vs to far above it.
fn smooth(random: &mut ChaCha8Rng) -> [Stroke; STROKES] {
    let scale = EPS * 10f64.powf(random.random_range(-6.0..0.0));
    std::array::from_fn(|_| Stroke::random(scale * random.random_range(-1.0..1.0), random))
}

fn on_units(random: &mut ChaCha8Rng) -> [Stroke; STROKES] {
    std::array::from_fn(|_| Stroke::random(UNIT * f64::from(random.random_range(-12..=12i32)), random))
}

/// A power of two, so that a piece of a unit takes a time without rounding; no piece takes a second.
fn speed(random: &mut ChaCha8Rng) -> f64 {
    f64::from(random.random_range(-7..=3i32)).exp2()
}

fn worst<R: Real>(model: &impl FrictionModel<R>, strokes: fn(&mut ChaCha8Rng) -> [Stroke; STROKES]) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    largest((0..TRAJECTORIES).map(|_| {
        let strokes = strokes(&mut random);
        let back = Stroke::random(-strokes.iter().map(|stroke| stroke.way).sum::<f64>(), &mut random);
        gain(model, strokes.into_iter().chain([back]))
    }))
}

/// Work given, as a fraction of level times path; work lost counts as none.
fn gain<R: Real>(model: &impl FrictionModel<R>, strokes: impl Iterator<Item = Stroke>) -> f64 {
    let mut state = Default::default();
    let (mut lost, mut path) = (0.0, f64::MIN_POSITIVE);
    for stroke in strokes {
        let length = stroke.way.abs();
        let pieces =
            if length % UNIT == 0.0 { length / UNIT } else { (length / (2.0 * UNIT)).ceil().max(1.0) };
        let piece = Stroke { way: stroke.way / pieces, ..stroke };
        for _ in 0..pieces as u32 {
            lost += work(model, &mut state, piece);
        }
        path += length;
    }
    // Not `max`, which would pass over NaN.
    if lost > 0.0 { 0.0 } else { -lost / (LEVEL * path) }
}

/// Work lost over a piece of a stroke, and the state moved to its end.
fn work<R: Real, M: FrictionModel<R>>(model: &M, state: &mut M::State, piece: Stroke) -> f64 {
    let Stroke { way, speed, load, phase } = piece;
    let slip = |fraction: f64| Slip {
        wave_generator: Heading::of_phase(phase),
        ..Slip::new(R::lit(speed.copysign(way)), R::lit(fraction * way.abs() / speed))
            .under(R::ZERO, R::lit(load))
    };
    let mean: f64 = GAUSS
        .iter()
        .map(|&(node, weight)| weight * model.step(&mut state.clone(), &slip(node)).force.to_f64())
        .sum();
    model.step(state, &slip(1.0));
    mean * way
}

#[cfg(test)]
mod tests {
    use super::*;
    use strainwave::friction::bliman_sorine::BlimanSorineState;
    use strainwave::friction::{BlimanSorine, FrictionParams, JointFrictionOfOrder, LubricatedContact};

    /// The product of a level and of a presliding force that knows nothing of it.
    struct Product {
        presliding: BlimanSorine<f64, 1>,
        contact: LubricatedContact<f64>,
    }

    impl FrictionModel<f64> for Product {
        type State = (BlimanSorineState<f64, 1>, f64);

        fn force(&self, state: &Self::State) -> f64 {
            state.1
        }

        fn advance(&self, state: &mut Self::State, slip: &Slip<f64>) {
            self.presliding.advance(&mut state.0, slip);
            state.1 = self.contact.level(slip.velocity) * state.0.force();
        }
    }

    /// Short strokes around rest, slow up to the middle of each and fast from there.
    fn strokes() -> impl Iterator<Item = Stroke> {
        let half = |sign: f64, speed| Stroke { way: sign * 0.05 * EPS, speed, load: 0.0, phase: 0 };
        let pairs = (0..400).flat_map(move |k| {
            let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
            [half(sign, 1.0 / 128.0), half(sign, 8.0)]
        });
        [half(1.0, 8.0)].into_iter().chain(pairs).chain([half(-1.0, 8.0)])
    }

    /// Sensitivity of the measurement: it finds the work by the product of level and presliding force.
    #[test]
    fn a_form_that_gives_work_is_found() {
        let JointFrictionOfOrder(params) = JointFrictionOfOrder::<f64, 1>::varying(LEVEL, EPS);
        let product = Product {
            presliding: BlimanSorine::order_1(1.0, EPS).unwrap(),
            contact: params.forward.build().unwrap(),
        };
        assert!(gain(&product, strokes()) > 1e-3);
        assert_eq!(gain(&params.build().unwrap(), strokes()), 0.0);
    }
}
