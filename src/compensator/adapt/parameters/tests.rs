//! Convergence to the joint's factors, projection, and no drift without excitation.

use std::vec::Vec;

use super::*;
use crate::compensator::schedule::CONTROL_PERIOD;
use proptest::prelude::*;

const N: f64 = -100.0;
const INERTIA: f64 = 1.2;

fn params() -> AdaptationParams<f64> {
    AdaptationParams {
        bounds: Factors {
            inertia: 0.4,
            input_friction: 0.25,
            output_friction: 0.25,
            compliance: 0.125,
            presliding: 0.9,
            presliding_stiffness: 0.9,
        },
        rates: Factors {
            inertia: 13.5,
            input_friction: 0.4,
            output_friction: 0.1,
            compliance: 20.0,
            presliding: 1.0,
            presliding_stiffness: 1.0,
        },
        levels: Factors {
            inertia: 67.0,
            input_friction: 3.5,
            output_friction: 1.0,
            compliance: 1.3e-3,
            presliding: 4.5,
            presliding_stiffness: 4.5,
        },
        dead_zone: 0.067,
        filter_corner: 200.0,
        bias_corner: 2.0,
        flexing_rate: 0.4,
        flexing_level: 0.1,
        flexing_speed: 10.0,
    }
}

fn adaptation() -> Adaptation<f64> {
    params().build(N, INERTIA, 157.0, CONTROL_PERIOD).unwrap()
}

/// A joint of these factors whose friction is Coulomb's, in a motion of two tones; d_0 is a load of 5 N m.
struct Joint {
    truth: Factors<f64>,
    observed: [Delayed<f64>; 6],
    sees_output: bool,
    time: f64,
}

impl Joint {
    fn new(truth: Factors<f64>, sees_output: bool) -> Self {
        Self { truth, observed: [Delayed::default(); 6], sees_output, time: 0.0 }
    }

    /// Regressors, and residuals of an observer whose model has the `applied` factors.
    fn period(&mut self, applied: &Factors<f64>) -> (Excitation<f64>, Observed<f64>) {
        self.time += CONTROL_PERIOD;
        let (slow, fast) = (2.0 * self.time, 11.0 * self.time);
        let velocity = slow.cos() + 0.6 * fast.cos();
        let excitation = Excitation {
            velocity,
            acceleration: -20.0 * slow.sin() - 30.0 * fast.sin(),
            jerk: 0.0,
            snap: 80.0 * slow.sin() + 3630.0 * fast.sin(),
            input_friction: 0.035 * (N * velocity).signum(),
            output_friction: velocity.signum() * (1.0 - 0.9 * (-velocity.abs()).exp()),
            presliding: 0.03 * (5.0 * self.time).sin(),
            stiffness: 0.03 * (7.0 * self.time).sin(),
        };
        let error = |truth: f64, applied: f64| truth - applied;
        let (filter, compliance) = (adaptation().filter, adaptation().flexibility);
        let load = INERTIA * self.truth.inertia;
        let parts = [
            -INERTIA * excitation.acceleration * error(self.truth.inertia, applied.inertia),
            -N * excitation.input_friction * error(self.truth.input_friction, applied.input_friction),
            -excitation.output_friction * error(self.truth.output_friction, applied.output_friction),
            load * load * compliance * excitation.snap * error(self.truth.compliance, applied.compliance),
            -N * excitation.presliding * error(self.truth.presliding, applied.presliding),
            -N * excitation.stiffness * error(self.truth.presliding_stiffness, applied.presliding_stiffness),
        ];
        let mut parts = self.observed.iter_mut().zip(parts).map(|(low, part)| low.step(part, filter));
        let residual: [f64; 6] = std::array::from_fn(|_| parts.next().unwrap());
        let torsion = 1e-3 * slow.sin();
        let innovation = (applied.compliance - self.truth.compliance) * torsion;
        // Error of the encoders' zero, as a torque: 0.3 N m.
        let observed = Observed {
            external_torque: 5.0 + residual.iter().sum::<f64>(),
            torsion,
            output_innovation: self.sees_output.then_some(innovation),
            stiffness_torque: 0.3 - residual[1] - residual[4] - residual[5] - innovation / compliance,
        };
        (excitation, observed)
    }
}

/// V = e' Gamma^-1 e/2.
fn lyapunov(adaptation: &Adaptation<f64>, state: &AdaptationState<f64>, truth: &Factors<f64>) -> f64 {
    let (now, truth, gains) = (state.factors.all(), truth.all(), adaptation.gains.all());
    [0, 1, 2, 4, 5].into_iter().map(|k| (now[k] - truth[k]).powi(2) / gains[k]).sum()
}

/// Without noise, hence with a narrow dead zone; output friction as fast as input friction.
fn patient() -> AdaptationParams<f64> {
    let mut params = AdaptationParams { dead_zone: 1e-3, ..params() };
    params.rates.output_friction = 0.4;
    params
}

fn after(
    seconds: f64,
    params: &AdaptationParams<f64>,
    truth: Factors<f64>,
    mut joint: Joint,
    learns: bool,
) -> (AdaptationState<f64>, Vec<f64>) {
    let adaptation = params.build(N, INERTIA, 157.0, CONTROL_PERIOD).unwrap();
    let (mut state, mut levels) = (AdaptationState::default(), Vec::new());
    for k in 0..(seconds / CONTROL_PERIOD) as usize {
        let (excitation, observed) = joint.period(&state.factors);
        adaptation.step(&mut state, &excitation, &observed, learns);
        if k % 10_000 == 9_999 {
            levels.push(lyapunov(&adaptation, &state, &truth));
        }
    }
    (state, levels)
}

const TRUTH: Factors<f64> = Factors {
    inertia: 0.75,
    input_friction: 1.15,
    output_friction: 0.85,
    compliance: 1.08,
    presliding: 0.3,
    presliding_stiffness: 1.4,
};

#[test]
fn it_finds_the_joint_and_the_error_only_falls() {
    let (state, levels) = after(400.0, &patient(), TRUTH, Joint::new(TRUTH, true), true);
    let found = state.factors.all();
    for (k, (found, truth)) in found.iter().zip(TRUTH.all()).enumerate() {
        assert!((found - truth).abs() < [0.005, 0.03, 0.06, 1e-6, 0.01, 0.01][k], "{k}: {found} of {truth}");
    }
    assert!((state.bias - 5.0).abs() < 0.2, "{}", state.bias);
    // From second to second, once the load is found.
    for pair in levels.windows(2).skip(2) {
        assert!(pair[1] <= pair[0] * (1.0 + 1e-3), "{levels:?}");
    }
}

/// A joint that slides at one speed in both directions: both frictions are Coulomb's, and only their sum is observable
/// at the output.
#[test]
fn an_output_encoder_tells_the_two_frictions_apart() {
    let truth = Factors { input_friction: 1.1, output_friction: 0.8, ..Factors::default() };
    let learnt = |sees_output: bool| {
        let adaptation = AdaptationParams { dead_zone: 0.0, ..patient() }
            .build(N, INERTIA, 157.0, CONTROL_PERIOD)
            .unwrap();
        let (mut state, n) = (AdaptationState::<f64>::default(), N.abs());
        for k in 0..200_000 {
            let (forward, applied): (f64, _) = (if k / 5000 % 2 == 0 { 1.0 } else { -1.0 }, *state.factors());
            let excitation = Excitation {
                velocity: forward,
                input_friction: -0.035 * forward,
                output_friction: forward,
                ..Excitation::default()
            };
            let of_input = -n * 0.035 * forward * (truth.input_friction - applied.input_friction);
            let of_output = -forward * (truth.output_friction - applied.output_friction);
            let observed = Observed {
                external_torque: of_input + of_output,
                output_innovation: sees_output.then_some(0.0),
                stiffness_torque: -of_input,
                ..Observed::default()
            };
            adaptation.step(&mut state, &excitation, &observed, true);
        }
        [
            state.factors.input_friction - truth.input_friction,
            state.factors.output_friction - truth.output_friction,
        ]
    };
    let [input, output] = learnt(true);
    assert!(input.abs() < 0.002 && output.abs() < 0.01, "{input} {output}");
    let [input, output] = learnt(false);
    assert!((3.5 * input + output).abs() < 0.01 && output > 0.1, "{input} {output}");
}

#[test]
fn without_an_output_encoder_flexing_shows_the_compliance() {
    let truth = Factors { compliance: TRUTH.compliance, ..Factors::default() };
    let found =
        |params: &AdaptationParams<f64>| after(60.0, params, truth, Joint::new(truth, false), true).0.factors;
    let learnt = found(&AdaptationParams { dead_zone: 0.0, ..patient() });
    assert!((learnt.compliance - truth.compliance).abs() < 0.01, "{learnt:?}");
    assert!((learnt.inertia - 1.0).abs() < 2e-3, "{learnt:?}");
    // Not where every motion is too fast for it.
    let fast = found(&AdaptationParams { dead_zone: 0.0, flexing_speed: 0.0, ..patient() });
    assert_eq!(fast.compliance, 1.0);
}

#[test]
fn a_stiffening_is_the_inverse_of_the_compliance() {
    for compliance in [0.875, 0.95, 1.0, 1.1, 1.125] {
        let factors = Factors { compliance, ..Factors::<f64>::default() };
        assert!((1.0 + factors.stiffening() - 1.0 / compliance).abs() < 2.3e-3, "{compliance}");
    }
}

#[test]
fn it_holds_when_switched_off_at_rest_and_under_a_load_beyond_its_bounds() {
    let (state, _) = after(1.0, &patient(), TRUTH, Joint::new(TRUTH, true), false);
    assert_eq!(state.factors, Factors::default());
    let mut state = AdaptationState::default();
    let load = Observed { external_torque: 40.0, ..Observed::default() };
    let moving =
        Excitation { acceleration: 3.0, input_friction: 0.03, output_friction: 1.0, ..Excitation::default() };
    for excitation in [Excitation::default(), moving] {
        for _ in 0..1000 {
            adaptation().step(&mut state, &excitation, &load, true);
        }
        assert_eq!(state.factors, Factors::default());
    }
}

#[test]
fn a_residual_within_the_dead_zone_is_not_learnt() {
    let mut state = AdaptationState::default();
    let noise = Observed { external_torque: 0.06, ..Observed::default() };
    let moving = Excitation {
        acceleration: 30.0,
        input_friction: 0.03,
        output_friction: 1.0,
        ..Excitation::default()
    };
    for _ in 0..1000 {
        adaptation().step(&mut state, &moving, &noise, true);
    }
    assert_eq!(state.factors, Factors::default());
}

#[test]
fn it_starts_from_what_is_stored_within_its_bounds() {
    let stored = Factors {
        inertia: 3.0,
        input_friction: f64::NAN,
        output_friction: 0.9,
        compliance: 0.0,
        presliding: -1.0,
        ..Factors::default()
    };
    let state = adaptation().starting_from(&stored);
    let expected = Factors {
        inertia: 1.4,
        input_friction: 1.0,
        output_friction: 0.9,
        compliance: 0.875,
        presliding: 1.0 - 0.9,
        ..Factors::default()
    };
    assert_eq!(*state.factors(), expected);
}

#[test]
fn a_parameter_out_of_range_is_named() {
    let build = |params: AdaptationParams<f64>| params.build(N, INERTIA, 157.0, CONTROL_PERIOD).unwrap_err();
    let mut fast = params();
    fast.rates.inertia = 4000.0;
    assert_eq!(build(fast), Error::OutOfRange("adaptation_rates"));
    let mut wide = params();
    wide.bounds.compliance = 1.0;
    assert_eq!(build(wide), Error::OutOfRange("adaptation_bounds"));
    let named = AdaptationParams { dead_zone: -1.0, ..params() };
    assert_eq!(build(named), Error::OutOfRange("dead_zone"));
    let none = AdaptationParams { flexing_level: 0.0, ..params() };
    assert_eq!(build(none), Error::OutOfRange("flexing_level"));
}

proptest! {
    /// Whatever is observed, the factors stay in their box.
    #[test]
    fn the_projection_holds(torques in prop::collection::vec(-200.0..200.0f64, 9), steps in 1..2000usize) {
        let (adaptation, mut state) = (adaptation(), AdaptationState::default());
        for k in 0..steps {
            let at = |place: usize| torques[(k / 50 + place) % torques.len()];
            let excitation = Excitation {
                velocity: 0.1 * at(6),
                acceleration: at(0),
                jerk: 1e4 * at(8),
                snap: 1e4 * at(7),
                input_friction: 0.001 * at(1),
                output_friction: at(2),
                presliding: 0.001 * at(4),
                stiffness: 0.001 * at(6),
            };
            let observed = Observed {
                external_torque: at(3),
                torsion: 1e-4 * at(4),
                output_innovation: (at(8) > 0.0).then_some(1e-4 * at(5)),
                stiffness_torque: at(6),
            };
            adaptation.step(&mut state, &excitation, &observed, true);
        }
        prop_assert_eq!(state.factors, state.factors.within(&adaptation.bounds));
    }
}
