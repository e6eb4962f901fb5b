//! The jog's setpoints: smooth, bounded, consistent derivatives, and they arrive.

use strainwave::Angle;
use strainwave::compensator::Setpoint;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_app::jog::{FARTHEST, Jog, LIMITS, Planner};

const PERIOD: f32 = CONTROL_PERIOD as f32;
const ORIGIN: Angle<f32> = Angle::from_counts(987_654_321);

/// Both ends of a jog that holds its origin.
struct Joint(&'static Jog, Planner);

fn jog() -> Joint {
    let jog = Box::leak(Box::new(Jog::new()));
    assert_eq!(jog.step(), None);
    jog.hold(ORIGIN);
    Joint(jog, Planner::new(jog).expect("limits that moves can be planned with"))
}

fn offset(setpoint: &Setpoint<f32>) -> f64 {
    setpoint.position.to_radians() - ORIGIN.to_radians()
}

fn run(Joint(jog, planner): &mut Joint, target: f32, periods: usize) -> Vec<Setpoint<f32>> {
    let step = |_| {
        planner.plan(target);
        jog.step().expect("it holds")
    };
    (0..periods).map(step).collect()
}

#[test]
fn without_a_new_target_it_holds_its_origin() {
    for setpoint in run(&mut jog(), 0.0, 100) {
        assert_eq!(setpoint, Setpoint { position: ORIGIN, ..Setpoint::default() });
    }
}

#[test]
fn it_arrives_and_stays() {
    for target in [1e-3_f32, -0.01, 0.3, -1.2] {
        let setpoints = run(&mut jog(), target, 60_000);
        let end = setpoints.last().expect("there are some");
        assert!((offset(end) - f64::from(target)).abs() < 1e-6, "{target}: {end:?}");
        assert_eq!((end.velocity, end.acceleration, end.jerk, end.snap), (0.0, 0.0, 0.0, 0.0));
    }
}

#[test]
fn limits_are_kept_and_used() {
    let setpoints = run(&mut jog(), 1.0, 60_000);
    let peak = |of: fn(&Setpoint<f32>) -> f32| setpoints.iter().map(|s| of(s).abs()).fold(0.0, f32::max);
    for (peak, limit) in [
        (peak(|s| s.velocity), LIMITS.velocity),
        (peak(|s| s.acceleration), LIMITS.acceleration),
        (peak(|s| s.jerk), LIMITS.jerk),
        (peak(|s| s.snap), LIMITS.snap),
    ] {
        assert!(peak <= limit && peak > 0.99 * limit, "{peak} of {limit}");
    }
}

#[test]
fn each_derivative_is_the_difference_of_the_one_below() {
    let setpoints = run(&mut jog(), 0.4, 20_000);
    // Over 10 ms: from one period to the next the differences of f32 are mostly rounding. Where the snap steps within
    // that time h, the slopes are off by as much as snap*h^2/12 and snap*h/4.
    let (stride, time) = (100, 100.0 * f64::from(PERIOD));
    let corner = f64::from(LIMITS.snap) * time;
    for pieces in setpoints.windows(stride + 1).filter(|pieces| pieces.iter().all(|s| s.velocity != 0.0)) {
        let middle = &pieces[stride / 2];
        let rate = |f: fn(&Setpoint<f32>) -> f64| (f(&pieces[stride]) - f(&pieces[0])) / time;
        assert!((rate(offset) - f64::from(middle.velocity)).abs() < 1e-4, "{middle:?}");
        assert!(
            (rate(|s| s.velocity.into()) - f64::from(middle.acceleration)).abs()
                < 5e-4 + corner * time / 12.0,
            "{middle:?}"
        );
        assert!(
            (rate(|s| s.acceleration.into()) - f64::from(middle.jerk)).abs() < 1e-2 + corner / 4.0,
            "{middle:?}"
        );
    }
}

#[test]
fn a_target_that_moves_is_taken_up_after_the_move() {
    let mut jog = jog();
    let under_way = run(&mut jog, 0.01, 1_000);
    assert!(offset(under_way.last().expect("some")) < 0.01);
    let rest = run(&mut jog, -0.02, 10_000);
    let farthest = rest.iter().map(offset).fold(f64::MIN, f64::max);
    assert!((farthest - 0.01).abs() < 1e-6, "{farthest}");
    assert!((offset(rest.last().expect("some")) + 0.02).abs() < 1e-6);
}

#[test]
fn no_target_takes_it_out_of_bounds() {
    for target in [f32::MAX, f32::INFINITY, f32::NAN, f32::NEG_INFINITY] {
        let mut jog = jog();
        for setpoint in run(&mut jog, target, 70_000) {
            assert!(offset(&setpoint).abs() <= f64::from(FARTHEST) + 5e-6, "{target}");
            assert!(setpoint.velocity.is_finite() && setpoint.jerk.is_finite());
        }
        let home = run(&mut jog, 0.0, 70_000);
        assert!(offset(home.last().expect("some")).abs() < 1e-6, "{target}");
    }
}
