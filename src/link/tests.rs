//! Laws of the link, then its limits, then its errors.

use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::angle::Angle;
use crate::error::Error;

const DT: f64 = 1e-4;

fn params<const K: usize>() -> LinkParams<f64, K> {
    params_of()
}

fn params_of<R: Real, const K: usize>() -> LinkParams<R, K> {
    LinkParams {
        length: R::lit(0.6),
        bending_stiffness: R::lit(90.0),
        linear_density: R::lit(0.5),
        thickness: R::lit(5e-3),
        payload_mass: R::lit(0.4),
        payload_inertia: R::lit(4e-4),
        damping: [R::ZERO; K],
        gravity: R::lit(9.81),
        patch: Some(Span { start: R::lit(0.03), end: R::lit(0.09) }),
    }
}

fn at(angle: f64, velocity: f64, acceleration: f64) -> LinkInput<f64> {
    let joint = Motion { angle: Angle::from_radians(angle), velocity };
    LinkInput { joint, acceleration, ..LinkInput::default() }
}

/// A swing of the joint that starts at rest.
fn swing(t: f64) -> LinkInput<f64> {
    let (a, w) = (0.4, 9.0);
    let (s, c) = (w * t).sin_cos();
    at(a * (1.0 - c), a * w * s, a * w * w * c)
}

#[test]
fn a_free_link_keeps_its_energy() {
    let link = params::<2>().build(DT).unwrap();
    let held = at(0.0, 0.0, 0.0);
    let mut state = link.settled(&LinkInput { tip_force: 20.0, ..held });
    // The force goes within the first step.
    link.step(&mut state, &held);
    let start = link.energy(&state, &held.joint);
    for _ in 0..1_000_000 {
        link.step(&mut state, &held);
    }
    assert!((link.energy(&state, &held.joint) / start - 1.0).abs() < 1e-9);
}

/// Power at the joint and at the tip, over a motion with gravity and a tip force, by trapezoids.
#[test]
fn power_at_both_ports_is_the_change_of_the_energy() {
    for (dt, most) in [(1e-4, 2e-5), (2.5e-5, 1.5e-6)] {
        let link = params::<3>().build(dt).unwrap();
        let force = |t: f64| 3.0 * (1.0 - (17.0 * t).cos());
        let input = |k: u32| LinkInput { tip_force: force(f64::from(k) * dt), ..swing(f64::from(k) * dt) };
        let mut state = link.settled(&input(0));
        let start = link.energy(&state, &input(0).joint);
        let power = |output: &LinkOutput<f64>, input: &LinkInput<f64>| {
            output.torque * input.joint.velocity + input.tip_force * output.tip_velocity
        };
        let (mut work, mut gross, mut before) = (0.0, 0.0, power(&link.peek(&state, &input(0)), &input(0)));
        let steps = (1.0 / dt) as u32;
        for k in 1..=steps {
            let now = power(&link.step(&mut state, &input(k)), &input(k));
            work += 0.5 * dt * (before + now);
            gross += 0.5 * dt * (before + now).abs();
            before = now;
        }
        let change = link.energy(&state, &input(steps).joint) - start;
        assert!((work - change).abs() < most * gross, "{dt}: {work} {change} of {gross}");
    }
}

#[test]
fn damping_takes_energy_and_only_that() {
    let link = LinkParams { damping: [0.02, 0.05], ..params::<2>() }.build(DT).unwrap();
    let held = at(0.3, 0.0, 0.0);
    let mut state = link.settled(&LinkInput { tip_force: 20.0, couple: 1.0, ..held });
    link.step(&mut state, &held);
    let mut last = link.energy(&state, &held.joint);
    for _ in 0..100_000 {
        link.step(&mut state, &held);
        let energy = link.energy(&state, &held.joint);
        assert!(energy <= last + 1e-13);
        last = energy;
    }
    assert!((last - link.energy(&link.settled(&held), &held.joint)).abs() < 1e-9);
}

/// Trapezoids of the acceleration are the change of the speed; hanging still it is 0.
#[test]
fn the_tip_accelerates_as_its_speed_changes() {
    let link = params::<2>().build(DT).unwrap();
    let held = at(0.3, 0.0, 0.0);
    let hanging = link.peek(&link.settled(&held), &held).tip_acceleration;
    assert!(hanging.abs() < 1e-9, "{hanging}");
    let (mut state, mut last) = (LinkState::default(), LinkOutput::default());
    let (mut joint, mut most) = (Motion::default(), 0.0_f64);
    for k in 0..2000 {
        let acceleration = 20.0 * (1e-3 * f64::from(k) * 30.0).sin();
        let now = link.step(&mut state, &LinkInput { joint, acceleration, ..LinkInput::default() });
        let rise = 0.5 * DT * (now.tip_acceleration + last.tip_acceleration);
        if k > 0 {
            let missing: f64 = now.tip_velocity - last.tip_velocity - rise;
            most = most.max(now.tip_velocity.abs());
            assert!(missing.abs() < 1e-5, "{k}: {missing}");
        }
        last = now;
        joint.velocity += 0.5 * DT * (acceleration + 20.0 * (1e-3 * f64::from(k + 1) * 30.0).sin());
        joint.angle = joint.angle.plus(DT * joint.velocity);
    }
    assert!(most > 0.05, "{most}");
}

/// An acceleration bends the link by as much as bending accelerates the joint: each c_i is there twice.
#[test]
fn joint_and_modes_are_coupled_by_the_same_coefficients() {
    let link = LinkParams { gravity: 0.0, ..params::<4>() }.build(1e-5).unwrap();
    let coupling = link.joint_coupling();
    for (k, c) in coupling.into_iter().enumerate() {
        let mut state = LinkState::default();
        state.modes[k] = [1e-3, 0.0];
        let torque = link.peek(&state, &LinkInput::default()).torque;
        assert!((torque / (-c * link.modes[k].stiffness * 1e-3) - 1.0).abs() < 1e-12);
        let settled = link.settled(&at(0.0, 0.0, 1.0));
        assert!((settled.modes[k][0] * link.modes[k].stiffness / -c - 1.0).abs() < 1e-12);
    }
    // Together all modes are the whole inertia.
    let shares: Vec<f64> = coupling.iter().map(|c| c * c / link.rigid_inertia()).collect();
    assert!(shares.iter().sum::<f64>() < 1.0 && shares.iter().sum::<f64>() > 0.999, "{shares:?}");
}

/// Tip and patch: force and deflection, couple and rotation, reciprocal whatever the modes.
#[test]
fn a_couple_lifts_the_tip_as_a_force_turns_the_patch() {
    let link = LinkParams { gravity: 0.0, ..params::<1>() }.build(DT).unwrap();
    let settled = |input: LinkInput<f64>| link.peek(&link.settled(&input), &input);
    let pulled = settled(LinkInput { tip_force: 1.0, ..LinkInput::default() });
    let bent = settled(LinkInput { couple: 1.0, ..LinkInput::default() });
    assert!((bent.deflection / pulled.rotation - 1.0).abs() < 1e-12);
    // T*(end - start)*(L - middle)/EI
    assert!((bent.deflection / (0.06 * 0.54 / 90.0) - 1.0).abs() < 1e-12);
    assert!(bent.torque.abs() < 1e-12);
}

#[test]
fn steady_loads_bend_it_as_the_closed_forms_say() {
    fn deflections<const K: usize>() {
        let params = params::<K>();
        let link = params.build(1e-6).unwrap();
        let settled = |input: LinkInput<f64>| link.peek(&link.settled(&input), &input).deflection;
        let (l, ei) = (params.length, params.bending_stiffness);
        let weight = -9.81 * (0.5 * l.powi(4) / 8.0 + 0.4 * l.powi(3) / 3.0) / ei;
        assert!((settled(at(0.0, 0.0, 0.0)) / weight - 1.0).abs() < 1e-11);
        let pulled = settled(LinkInput { tip_force: 7.0, ..at(0.0, 0.0, 0.0) }) - weight;
        assert!((pulled / (7.0 * l.powi(3) / (3.0 * ei)) - 1.0).abs() < 1e-10);
        // Strain under the weight and a force, at the clamp and half way.
        let input = LinkInput { tip_force: 7.0, ..at(0.0, 0.0, 0.0) };
        for x in [0.0, 0.5 * l, l] {
            let moment = 7.0 * (l - x) - 9.81 * (0.25 * (l - x) * (l - x) + 0.4 * (l - x));
            let strain = link.strain(&link.settled(&input), &params.gauge(x).unwrap());
            assert!((strain + 2.5e-3 * moment / ei).abs() < 1e-13, "{K} {x}: {strain}");
        }
    }
    deflections::<1>();
    deflections::<2>();
    deflections::<6>();
}

/// The stiffer the link the more it is a rigid body.
#[test]
fn a_stiff_link_is_a_rigid_one() {
    let off = |stiffness: f64| {
        let params = LinkParams { bending_stiffness: stiffness, ..params::<2>() };
        let link = params.build(1e-6).unwrap();
        let mut state = link.settled(&swing(0.0));
        let mut worst = 0.0f64;
        for k in 1..200_000 {
            let input = swing(f64::from(k) * 1e-6);
            let output = link.step(&mut state, &input);
            let (sine, cosine) = input.joint.angle.sin_cos();
            let rigid = link.inertia * input.acceleration + 9.81 * link.moment * cosine;
            worst = worst.max((output.torque / rigid - 1.0).abs());
            let straight =
                ((output.tip[0] - 0.6 * cosine).powi(2) + (output.tip[1] - 0.6 * sine).powi(2)).sqrt();
            worst = worst.max(straight / 0.6);
        }
        worst
    };
    let [soft, stiff] = [1e4, 1e6].map(off);
    assert!(stiff < 1e-4 && stiff < 0.02 * soft, "{soft} {stiff}");
}

/// Joint and link turn each other; nothing turns both.
#[test]
fn a_free_joint_keeps_its_angular_momentum() {
    let link = LinkParams { gravity: 0.0, ..params::<2>() }.build(DT).unwrap();
    let inertia = 0.05;
    let pull = LinkInput { tip_force: 30.0, ..LinkInput::default() };
    let mut state = link.settled(&pull);
    let mut joint = Motion::default();
    let (mut least, mut most, mut acceleration) = (0.0f64, 0.0f64, 0.0);
    link.step(&mut state, &LinkInput::default());
    let momentum = |state: &LinkState<f64, 2>, joint: &Motion<f64>| {
        let bending: f64 = link.joint_coupling().iter().zip(&state.modes).map(|(c, mode)| c * mode[1]).sum();
        (inertia + link.inertia) * joint.velocity + bending
    };
    let mut start = None;
    for _ in 0..20_000 {
        let mut free = state;
        let unmoved = link.step(&mut free, &LinkInput { joint, ..LinkInput::default() });
        let next = -unmoved.torque / (inertia + link.immediate_inertia());
        let output = link.step(&mut state, &LinkInput { joint, acceleration: next, ..LinkInput::default() });
        assert!((output.torque + inertia * next).abs() < 1e-9 * (1.0 + output.torque.abs()));
        joint.velocity += 0.5 * DT * (acceleration + next);
        acceleration = next;
        (least, most) = (least.min(joint.velocity), most.max(joint.velocity));
        // The joint was held up to the first of these steps.
        let (now, size) = (momentum(&state, &joint), inertia * (most - least));
        let start = *start.get_or_insert(now);
        assert!((now - start).abs() < 1e-2 * size, "{now} {start} {size}");
    }
    assert!(most - least > 0.5, "{least} {most}");
}

#[test]
fn f32_follows_f64() {
    let single = LinkParams { damping: [0.01; 2], ..params_of::<f32, 2>() };
    let double = LinkParams { damping: [0.01; 2], ..params::<2>() };
    let (single, double) = (single.build(1e-4).unwrap(), double.build(DT).unwrap());
    let (mut a, mut b) = (LinkState::default(), LinkState::default());
    for k in 0..30_000 {
        let input = swing(f64::from(k) * DT);
        let angle = Angle::from_counts(input.joint.angle.counts);
        let joint = Motion { angle, velocity: input.joint.velocity as f32 };
        let acceleration = input.acceleration as f32;
        let found = single.step(&mut a, &LinkInput { joint, acceleration, ..LinkInput::default() });
        let exact = double.step(&mut b, &input);
        let off = [f64::from(found.torque) - exact.torque, f64::from(found.deflection) - exact.deflection];
        assert!(off[0].abs() < 1e-3 && off[1].abs() < 1e-6, "{k} {off:?} {exact:?}");
    }
}

proptest! {
    #[test]
    fn any_input_bits_give_finite_outputs(bits in prop::collection::vec(any::<[u32; 6]>(), 1..200)) {
        let params = params_of::<f32, 3>();
        let (link, mut state) = (params.build(1e-4).unwrap(), LinkState::default());
        let gauge = params.gauge(0.1).unwrap();
        for bits in bits {
            let [rest, velocity, acceleration, tip_force, couple, _] = bits.map(f32::from_bits);
            let joint = Motion { angle: Angle { counts: i64::from(bits[5]), rest }, velocity };
            let output = link.step(&mut state, &LinkInput { joint, acceleration, tip_force, couple });
            let LinkOutput { deflection, tip, tip_velocity, tip_acceleration, torque, rotation } = output;
            let strain = link.strain(&state, &gauge);
            let all =
                [deflection, tip[0], tip[1], tip_velocity, tip_acceleration, torque, rotation, strain];
            prop_assert!(all.iter().all(|number| number.is_finite()), "{output:?}");
        }
    }
}

#[test]
fn a_parameter_out_of_range_is_named() {
    type Change = fn(&mut LinkParams<f64, 2>);
    let cases: [(&str, Change); 9] = [
        ("length", |p| p.length = 0.0),
        ("bending_stiffness", |p| p.bending_stiffness = f64::NAN),
        ("linear_density", |p| p.linear_density = -1.0),
        ("thickness", |p| p.thickness = 1.0),
        ("payload_mass", |p| p.payload_mass = 301.0),
        ("payload_inertia", |p| p.payload_inertia = -1e-9),
        ("damping", |p| p.damping[1] = 1.0),
        ("gravity", |p| p.gravity = -9.81),
        ("patch", |p| p.patch = Some(Span { start: 0.1, end: 0.1 })),
    ];
    for (name, change) in cases {
        let mut changed = params::<2>();
        change(&mut changed);
        assert_eq!(changed.build(DT).err(), Some(Error::OutOfRange(name)));
        assert_eq!(changed.longest_step().err(), Some(Error::OutOfRange(name)));
    }
    assert_eq!(params::<2>().gauge(0.61).err(), Some(Error::OutOfRange("place")));
    assert_eq!(params::<9>().build(1e-9).err(), Some(Error::OutOfRange("modes")));
}

/// Four samples to the highest mode's period.
#[test]
fn a_step_that_does_not_show_the_highest_mode_is_refused() {
    let longest = params::<2>().longest_step().unwrap();
    let fastest = params::<2>().build(DT).unwrap().frequencies()[1];
    assert!((longest * fastest / core::f64::consts::FRAC_PI_2 - 1.0).abs() < 1e-14);
    assert_eq!(params::<2>().build(longest).err(), Some(Error::OutOfRange("dt")));
    assert!(params::<2>().build(0.999 * longest).is_ok());
    assert_eq!(params::<2>().build(0.0).err(), Some(Error::OutOfRange("dt")));
}
