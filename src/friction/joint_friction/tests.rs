//! Steady sliding, presliding, work and precision of the gear's friction.

use super::params::LEAST_LEVEL;
use super::*;
use crate::compensator::schedule::CONTROL_PERIOD;
use crate::error::Error;
use crate::friction::FrictionParams;
use crate::friction::load_dependence::LoadFactors;
use crate::friction::lubricated_contact::LubricatedContactParams;
use crate::friction::ripple::RippleParams;
use crate::friction::tests::contact;
use proptest::prelude::*;
use std::vec::Vec;

fn wave_generator<R: Real>(order: Order) -> JointFrictionParams<R> {
    JointFrictionParams::symmetric(order, contact(), R::lit(0.02), R::lit(0.3))
}

/// Everything differs with direction, load and angle.
fn everything<R: Real>(order: Order) -> JointFrictionParams<R> {
    let harmonics = |mean, a, b| Harmonics {
        mean: R::lit(mean),
        cosines: [a, -0.5 * a].map(R::lit),
        sines: [b, 0.2 * b].map(R::lit),
    };
    JointFrictionParams {
        backward: LubricatedContactParams {
            coulomb: R::lit(0.05),
            static_level: R::lit(0.06),
            stribeck_velocity: R::lit(3.0),
            viscous: R::lit(2e-4),
            ..contact()
        },
        load: LoadFactors { driving: R::lit(0.08), driven: R::lit(0.15) },
        ripple: RippleParams { forward: harmonics(1.0, 0.2, 0.1), backward: harmonics(2.0, -0.5, 0.3) },
        ..wave_generator(order)
    }
}

fn force_after(params: &JointFrictionParams<f64>, slips: &[Slip<f64>]) -> f64 {
    let (model, mut state) = (params.build().unwrap(), JointFrictionState::default());
    slips.iter().map(|slip| model.step(&mut state, slip).force).last().unwrap_or_default()
}

#[test]
fn steady_sliding_lies_on_the_level_of_speed_direction_load_and_angle() {
    for order in [Order::One, Order::Two] {
        let params = everything::<f64>(order);
        for (velocity, load, revolution) in
            [(-20.0f64, 0.0, 0.0), (-0.3, 0.4, 0.1), (0.3, 0.4, 0.7), (5.0, -0.2, 0.4)]
        {
            let heading = Heading::of_phase((revolution * 4_294_967_296.0) as u32);
            let slip = Slip { wave_generator: heading, ..Slip::new(velocity, 0.1).under(0.0, load) };
            let angle = revolution * std::f64::consts::TAU;
            let (contact, harmonics) = match velocity < 0.0 {
                true => (&params.backward, &params.ripple.backward),
                false => (&params.forward, &params.ripple.forward),
            };
            let ripple = 1.0
                + (0..2)
                    .map(|k| {
                        let (sine, cosine) = ((k + 1) as f64 * angle).sin_cos();
                        (harmonics.cosines[k] * cosine + harmonics.sines[k] * sine) / harmonics.mean
                    })
                    .sum::<f64>();
            let stribeck = (contact.static_level - contact.coulomb)
                * (-velocity.abs() / contact.stribeck_velocity).exp();
            let factor = if velocity * load >= 0.0 { 0.08 } else { 0.15 };
            let level = (contact.coulomb + stribeck) * ripple + factor * f64::abs(load);
            let expected = level * velocity.signum() + contact.viscous * velocity;
            let force = force_after(&params, &[slip; 200]);
            assert!(
                (force - expected).abs() < 1e-8 * expected.abs(),
                "{velocity} {load}: {force} {expected}"
            );
        }
    }
}

/// The same presliding at any level, from the same stiffness.
#[test]
fn the_level_stretches_presliding() {
    let plain = LubricatedContactParams { static_level: 0.05, coulomb: 0.05, viscous: 0.0, ..contact() };
    let params = JointFrictionParams::symmetric(Order::Two, plain, 0.02, 0.3);
    let heavy = JointFrictionParams { load: LoadFactors { driving: 0.1, driven: 0.1 }, ..params };
    // A load of 0.5 N m doubles the level: twice the force at twice the path.
    for path in [1e-4, 5e-3, 0.02, 0.1] {
        let once = force_after(&params, &[Slip::new(path, 1.0)]);
        let twice = force_after(&heavy, &[Slip::new(2.0 * path, 1.0).under(0.0, 0.5)]);
        assert!((twice - 2.0 * once).abs() < 1e-9, "{path}: {once} {twice}");
    }
}

/// Pieces of motion (velocity, duration, load, revolution of the wave generator) that end where they began.
fn closed_motion() -> impl Strategy<Value = Vec<(f64, f64, f64, u32)>> {
    let piece = (-30.0..30.0f64, 1e-5..0.02f64, -1.0..1.0f64, any::<u32>());
    prop::collection::vec(piece, 1..30).prop_map(|mut pieces| {
        let travelled: f64 = pieces.iter().map(|(velocity, duration, ..)| velocity * duration).sum();
        pieces.push((-travelled / 0.01, 0.01, 0.3, 0));
        pieces
    })
}

/// Work lost, in steps short against eps.
fn work(params: &JointFrictionParams<f64>, pieces: &[(f64, f64, f64, u32)]) -> f64 {
    let (model, mut state) = (params.build().unwrap(), JointFrictionState::default());
    let mut total = 0.0;
    for &(velocity, duration, load, phase) in pieces {
        let steps = (velocity.abs() * duration / (params.presliding * 0.002)).ceil().max(1.0);
        let slip = Slip {
            wave_generator: Heading::of_phase(phase),
            ..Slip::new(velocity, duration / steps).under(0.0, load)
        };
        for _ in 0..steps as usize {
            let before = state.presliding.force();
            model.step(&mut state, &slip);
            let mean = 0.5 * (before + state.presliding.force()) + params.forward.viscous * velocity;
            total += mean * slip.displacement();
        }
    }
    total
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_closed_motion_gains_work_whatever_the_level_does(pieces in closed_motion(), two: bool) {
        let params = everything(if two { Order::Two } else { Order::One });
        prop_assert!(work(&params, &pieces) >= -1e-10);
    }

    #[test]
    fn f32_follows_f64(slips in prop::collection::vec((-300.0..300.0f32, -1.0..1.0f32, any::<u32>()), 1..400)) {
        let (single, double) = (everything::<f32>(Order::Two), everything::<f64>(Order::Two));
        let (single, double) = (single.build().unwrap(), double.build().unwrap());
        let (mut a, mut b) = (JointFrictionState::default(), JointFrictionState::default());
        for (velocity, load, phase) in slips {
            let slip = Slip { wave_generator: Heading::of_phase(phase), ..Slip::new(velocity, CONTROL_PERIOD as f32).under(0.0, load) };
            let exact = Slip {
                wave_generator: Heading::of_phase(phase),
                ..Slip::new(f64::from(velocity), CONTROL_PERIOD).under(0.0, f64::from(load))
            };
            let (force, exact) = (single.step(&mut a, &slip).force, double.step(&mut b, &exact).force);
            prop_assert!((f64::from(force) - exact).abs() < 3e-6 * 0.2, "{force} {exact}");
        }
    }
}

/// The number in the header: 1.107 Fs for eta = 0.3.
#[test]
fn break_away_from_rest_passes_the_static_level_by_the_peak() {
    let place = 0.02 * 0.3 / 0.7 * (1.0 / 0.09f64).ln();
    let exact = (1.0 - (-place / 0.006).exp()) / 0.7 - 0.3 / 0.7 * (1.0 - (-place / 0.02).exp());
    let (model, mut state) = (wave_generator(Order::Two).build().unwrap(), JointFrictionState::default());
    let slowly = Slip::new(place / 10_000.0, 1.0);
    let forces: Vec<f64> = (0..20_000).map(|_| model.step(&mut state, &slowly).force / 0.05).collect();
    let peak = forces.iter().copied().fold(0.0, f64::max);
    assert!((peak - exact).abs() < 1e-6, "{peak} {exact}");
    assert!((peak - 1.107).abs() < 5e-4);
    assert!(forces.last().is_some_and(|last| *last < peak));
}

#[test]
fn no_level_at_all_gives_no_force_to_speak_of_and_one_that_vanishes_with_speed_fades() {
    let none = LubricatedContactParams { coulomb: 0.0, static_level: 0.0, viscous: 0.0, ..contact() };
    let params = JointFrictionParams::symmetric(Order::Two, none, 0.02, 0.3);
    assert!(force_after(&params, &[Slip::new(3.0, CONTROL_PERIOD)]) < 1.2 * LEAST_LEVEL);
    let fading = LubricatedContactParams { static_level: 0.05, ..none };
    let params = JointFrictionParams::symmetric(Order::Two, fading, 0.02, 0.3);
    let faded = force_after(&params, &[Slip::new(0.1, 0.01), Slip::new(1e9, CONTROL_PERIOD)]);
    assert!((faded - LEAST_LEVEL).abs() < 1e-16, "{faded}");
}

#[test]
fn a_parameter_out_of_range_is_named() {
    let name = |change: fn(&mut JointFrictionParams<f64>)| {
        let mut changed = everything(Order::Two);
        change(&mut changed);
        changed.build().unwrap_err()
    };
    assert_eq!(name(|p| p.presliding = 0.0), Error::OutOfRange("presliding"));
    assert_eq!(name(|p| p.presliding_ratio = 1.0), Error::OutOfRange("presliding_ratio"));
    assert_eq!(name(|p| p.forward.coulomb = f64::NAN), Error::OutOfRange("coulomb"));
    assert_eq!(name(|p| p.backward.static_level = 0.01), Error::OutOfRange("static_level"));
    assert_eq!(name(|p| p.load.driven = -0.1), Error::OutOfRange("load.driven"));
    assert_eq!(name(|p| p.ripple.backward.mean = 0.1), Error::OutOfRange("backward"));
}

/// Torques along a motion there and back, of a model whose presliding has this fraction of order 2 and stiffening.
fn there_and_back(params: &JointFrictionParams<f64>, order_two: f64, stiffening: f64) -> Vec<f64> {
    let (model, mut state) = (params.build().unwrap(), JointFrictionState::default());
    model.shape(&mut state, order_two, stiffening);
    let velocity = |k: u32| 30.0 * (f64::from(k) * 2e-3).sin();
    (0..10_000).map(|k| model.step(&mut state, &Slip::new(velocity(k), CONTROL_PERIOD)).force).collect()
}

fn close(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-12)
}

/// Without order 2 it is that of order 1; stiffer, that of a shorter distance; and either slides alike.
#[test]
fn presliding_is_shaped() {
    let two = wave_generator::<f64>(Order::Two);
    let one = wave_generator::<f64>(Order::One);
    assert!(close(&there_and_back(&two, 0.0, 0.0), &there_and_back(&one, 1.0, 0.0)));
    assert!(close(&there_and_back(&one, 0.3, 0.0), &there_and_back(&one, 1.0, 0.0)));
    let shorter = JointFrictionParams { presliding: two.presliding / 1.625, ..two };
    assert!(close(&there_and_back(&two, 1.0, 0.5), &there_and_back(&shorter, 1.0, 0.0)));
    let (model, mut state) = (two.build().unwrap(), JointFrictionState::default());
    let slid = |state: &mut JointFrictionState<f64>| model.step(state, &Slip::new(20.0, 1.0)).force;
    let before = slid(&mut state);
    model.shape(&mut state, 0.2, 0.5);
    assert!((slid(&mut state) - before).abs() < 1e-12 && model.shaped(&state).abs() < 1e-12);
}

proptest! {
    /// No closed motion from rest gains work, whatever the shape.
    #[test]
    fn a_shaped_presliding_is_dissipative(
        order_two in 0.01..1.9f64,
        stiffening in -0.9..0.9f64,
        velocities in prop::collection::vec(-30.0..30.0f64, 200),
    ) {
        let (model, mut state) =
            (wave_generator::<f64>(Order::Two).build().unwrap(), JointFrictionState::default());
        model.shape(&mut state, order_two, stiffening);
        let mut work = 0.0;
        for velocity in velocities {
            // In short steps: the mean of the torques at both ends is the mean along it.
            for _ in 0..50 {
                let before = model.presliding(&state);
                model.step(&mut state, &Slip::new(velocity, 2e-5));
                work += 0.5 * (before + model.presliding(&state)) * velocity * 2e-5;
            }
            prop_assert!(work > -1e-9, "{work}");
        }
    }
}
