//! Why the control step has elementary functions of its own: compared with micromath's over the same ranges.
//!
//! Sine and cosine stand in the kinematic error, whose amplitudes are up to 1e-3 rad: an error of 1e-3 is
//! all of the 1 urad that torsion has to be resolved to. 1 - e^-x stands in the Stribeck level and in
//! presliding, where x is the path of one control period over eps, down to nothing: friction in f32 has
//! to follow f64 within the bound `friction.f32`.

use micromath::F32Ext;
use strainwave::Real;
use strainwave::real::{ONE_MINUS_EXP_NEG_ERROR, RADIANS_PER_COUNT, SIN_COS_ERROR};
use strainwave_desktop::verify::bounds;

const LARGEST_KINEMATIC_ERROR: f64 = 1e-3;
const TORSION_RESOLUTION: f64 = 1e-6;

fn friction_bound() -> f64 {
    bounds::find("friction.f32").expect("the table has it").value
}

/// Largest relative error over x = 1e-6 to 80, evenly in the logarithm.
fn worst(of: impl Fn(f32) -> f32, exact: impl Fn(f64) -> f64) -> f64 {
    let points = 200_000;
    let (least, greatest) = (1e-6f64.ln(), 80f64.ln());
    (0..=points)
        .map(|k| (least + (greatest - least) * f64::from(k) / f64::from(points)).exp() as f32)
        .map(|x| (f64::from(of(x)) / exact(f64::from(x)) - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Largest absolute error of a sine over a revolution.
fn worst_sine(sine: impl Fn(u32) -> f32) -> f64 {
    (0..1 << 20)
        .map(|k: u32| k.wrapping_mul(4099))
        .map(|phase| (f64::from(sine(phase)) - radians(phase).sin()).abs())
        .fold(0.0, f64::max)
}

fn radians(phase: u32) -> f64 {
    f64::from(phase.cast_signed()) * RADIANS_PER_COUNT
}

#[test]
fn sine() {
    let ours = worst_sine(|phase| f32::sin_cos_phase(phase).0);
    let theirs = worst_sine(|phase| F32Ext::sin(radians(phase) as f32));
    println!("sine: ours {ours:.1e}, micromath {theirs:.1e}");
    assert!(ours <= SIN_COS_ERROR);
    assert!(ours * LARGEST_KINEMATIC_ERROR < 1e-3 * TORSION_RESOLUTION);
    assert!(theirs * LARGEST_KINEMATIC_ERROR > TORSION_RESOLUTION, "{theirs:e}: it would do now");
}

#[test]
fn share_of_the_presliding_path() {
    let ours = worst(Real::one_minus_exp_neg, |x| -(-x).exp_m1());
    let theirs = worst(|x| 1.0 - F32Ext::exp(-x), |x| -(-x).exp_m1());
    println!("1 - e^-x: ours {ours:.1e}, micromath {theirs:.1e}");
    assert!(ours <= ONE_MINUS_EXP_NEG_ERROR && ours < friction_bound());
    assert!(theirs > 100.0 * friction_bound(), "{theirs:e}: it would do now");
}
