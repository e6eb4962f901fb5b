//! Laws that every friction model obeys.

use super::*;
use proptest::prelude::*;
use std::fmt::Debug;
use std::vec::Vec;

/// The default gear's wave generator.
pub(super) fn contact<R: Real>() -> LubricatedContactParams<R> {
    LubricatedContactParams {
        coulomb: R::lit(0.035),
        static_level: R::lit(0.05),
        stribeck_velocity: R::lit(2.0),
        stribeck_exponent: R::ONE,
        viscous: R::lit(1.2e-4),
    }
}

/// Parameters of a registered model at the ends of what it can be built from, and of each of its forms.
pub(super) trait Extremes<R: Real>: Registered<R> {
    fn extremes() -> Vec<Self>;
}

/// Task that is run with each model.
trait Task<R: Real> {
    fn run<M: FrictionModel<R, State: Debug + PartialEq>>(&self, name: &str, model: &M);
}

fn for_every_model<R: Real>(task: &impl Task<R>) {
    macro_rules! run {
        ($($name:ident = $word:literal, $params:ty, $what:literal;)*) => {
            $(for params in <$params as Extremes<R>>::extremes() {
                task.run($word, &params.build().unwrap());
            })*
        };
    }
    friction_models!(run);
    // The presliding of the gear's block alone has no name in the registry.
    let [f1, f2, eps, eta] = [1.5, 0.5, 1e-9, 0.3].map(R::lit);
    task.run("bliman-sorine", &BlimanSorine::order_2(f1, f2, eps, eta).unwrap());
}

struct AnyBits(Vec<[u32; 5]>);

impl Task<f32> for AnyBits {
    fn run<M: FrictionModel<f32, State: Debug + PartialEq>>(&self, name: &str, model: &M) {
        let mut state = M::State::default();
        for bits in &self.0 {
            let wave_generator = Heading::of_phase(bits[4]);
            let [velocity, applied, duration, load, _] = bits.map(f32::from_bits);
            let slip = Slip { wave_generator, ..Slip::new(velocity, duration).under(applied, load) };
            let before = state.clone();
            let friction = model.step(&mut state, &slip);
            assert!(friction.force.is_finite(), "{name}: {friction:?} {before:?} {slip:?}");
            // What a model does not read may be anything.
            assert!(friction.held || velocity.is_finite(), "{name}");
            assert!(
                !friction.held || ![velocity, applied, load].iter().all(|number| number.is_finite()),
                "{name}"
            );
            if friction.held {
                assert_eq!(before, state, "{name}");
                assert_eq!(friction.force, model.force(&before), "{name}");
            }
        }
    }
}

/// Any bits, the usual numbers, and the ends.
fn wild() -> impl Strategy<Value = u32> {
    prop_oneof![
        any::<u32>(),
        (-10.0..10.0f32).prop_map(f32::to_bits),
        prop::sample::select(std::vec![
            0.0,
            -0.0,
            1e-45,
            f32::MAX,
            f32::MIN,
            f32::INFINITY,
            f32::NAN,
            1e-4,
            1.0
        ])
        .prop_map(f32::to_bits),
    ]
}

proptest! {
    #[test]
    fn any_bits_leave_a_finite_force_and_non_finite_ones_hold_it(
        bits in prop::collection::vec(prop::array::uniform5(wild()), 1..60),
    ) {
        for_every_model(&AnyBits(bits));
    }
}

/// The force after a mirrored motion is opposite.
struct Odd(Vec<f64>);

impl Task<f64> for Odd {
    fn run<M: FrictionModel<f64, State: Debug + PartialEq>>(&self, name: &str, model: &M) {
        let (mut there, mut mirrored) = (M::State::default(), M::State::default());
        for &velocity in &self.0 {
            let slip = Slip::new(velocity, 1e-3).under(0.02 * velocity, 0.1);
            let image = Slip { velocity: -velocity, applied: -slip.applied, load: -slip.load, ..slip };
            let (one, two) = (model.step(&mut there, &slip).force, model.step(&mut mirrored, &image).force);
            // The bonds' tensions are added up in the other order.
            assert!((one + two).abs() <= 1e-12 * one.abs().max(1.0), "{name}: {one} {two}");
        }
    }
}

proptest! {
    #[test]
    fn a_mirrored_motion_has_the_mirrored_force(velocities in prop::collection::vec(-3.0..3.0f64, 1..50)) {
        for_every_model(&Odd(velocities));
    }
}

/// A step of no time and no motion changes nothing but what static friction holds.
struct Nothing;

impl Task<f64> for Nothing {
    fn run<M: FrictionModel<f64, State: Debug + PartialEq>>(&self, name: &str, model: &M) {
        let mut state = M::State::default();
        let nothing = model.step(&mut state, &Slip::default());
        assert!(nothing.force.abs() < 1e-15 && !nothing.held, "{name}");
    }
}

#[test]
fn no_motion_from_rest_has_no_friction() {
    for_every_model(&Nothing);
}
