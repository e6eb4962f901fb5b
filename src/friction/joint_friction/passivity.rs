//! Passivity of the varying level: three forms of it, of which one cannot generate work.

use super::*;
use crate::friction::FrictionParams;
use crate::friction::lubricated_contact::LubricatedContactParams;
use crate::friction::tests::contact;

/// Forces by the path, a step at a time, at a level and +-displacement.
type Form = fn(&mut f64, f64, f64) -> f64;

const FORMS: [Form; 3] = [
    // The product: z, and F = g*z.
    |z, level, step| {
        *z += (step.abs() / 0.02).one_minus_exp_neg() * (step.signum() - *z);
        level * *z
    },
    // The level as the target.
    |force, level, step| {
        *force += (step.abs() / 0.02).one_minus_exp_neg() * (level * step.signum() - *force);
        *force
    },
    // The level as the target, and the distance shorter with it.
    |force, level, step| {
        *force += (step.abs() * 0.05 / (0.02 * level)).one_minus_exp_neg() * (level * step.signum() - *force);
        *force
    },
];

/// Mean force, over Fc, that drives strokes of a tenth of eps, at one level up to the middle of each
/// and at the other from there: above zero, the form gives work.
fn gain(form: Form, levels: [f64; 2]) -> f64 {
    const CUTS: usize = 500;
    let (length, mut state, mut given) = (0.1 * 0.02, 0.0, 0.0);
    form(&mut state, levels[1], 0.5 * length);
    for k in 0..400 {
        let step = length / (2 * CUTS) as f64 * if k % 2 == 0 { -1.0 } else { 1.0 };
        for level in levels {
            let mut before = form(&mut state.clone(), level, 0.0 * step);
            for _ in 0..CUTS {
                let after = form(&mut state, level, step);
                given -= if k < 200 { 0.0 } else { 0.5 * (before + after) * step };
                before = after;
            }
        }
    }
    given / (200.0 * length * 0.035)
}

/// Work of the three forms, at Fs/Fc = 10/7.
#[test]
fn only_the_form_of_constant_stiffness_never_gives_work() {
    let (slow, fast) = (0.05, 0.035);
    let both = |form| [gain(form, [slow, fast]), gain(form, [fast, slow])];
    let [product, target, passive] = FORMS.map(both);
    assert!(product[0] > 1e-3 && product[1] < 0.0, "{product:?}");
    assert!(target[0] < 0.0 && target[1] > 1e-3, "{target:?}");
    assert!(passive[0] < 0.0 && passive[1] < 0.0, "{passive:?}");
}

/// The third form is this file's model.
#[test]
fn order_1_is_the_form_of_constant_stiffness() {
    let contact = LubricatedContactParams { viscous: 0.0, ..contact() };
    let model = JointFrictionParams::symmetric(Order::One, contact, 0.02, 0.3).build().unwrap();
    let (mut state, mut force) = (JointFrictionState::default(), 0.0);
    for k in 0..20_000 {
        let slip = Slip::new(10.0 * (f64::from(k) * 0.003).sin() + 0.1, 1e-4);
        let level = 0.035 + 0.015 * (-slip.velocity.abs() / 2.0).exp();
        let expected = FORMS[2](&mut force, level, slip.displacement());
        assert!((model.step(&mut state, &slip).force - expected).abs() < 1e-9);
    }
}
