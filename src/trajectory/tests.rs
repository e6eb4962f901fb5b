//! Laws of the moves.

use super::*;
use crate::compensator::Setpoint;
use crate::compensator::schedule::CONTROL_PERIOD;
use crate::real::RADIANS_PER_COUNT;
use proptest::prelude::*;
use std::vec::Vec;

/// A limit that nothing reaches.
const NONE: f64 = 1e12;

fn limits<R: Real>([velocity, acceleration, jerk, snap]: [f64; 4]) -> TrajectoryParams<R> {
    let [velocity, acceleration, jerk, snap] = [velocity, acceleration, jerk, snap].map(R::lit);
    TrajectoryParams { velocity, acceleration, jerk, snap }
}

fn plan<R: Real>(of: [f64; 4], distance: f64) -> Move<R> {
    let start = Angle::from_counts(987_654_321_012);
    limits(of).build(R::lit(CONTROL_PERIOD)).unwrap().plan(start, start.plus(R::lit(distance))).unwrap()
}

fn setpoints<R: Real>(planned: &Move<R>) -> Vec<Setpoint<R>> {
    (0..=planned.periods()).map(|k| planned.at(k)).collect()
}

fn derivatives<R: Real>(setpoint: &Setpoint<R>) -> [f64; 4] {
    let Setpoint { velocity, acceleration, jerk, snap, .. } = *setpoint;
    [velocity, acceleration, jerk, snap].map(Real::to_f64)
}

/// Limits of joints from a heavy arm's to a finger's, orders of magnitude apart, so that each may be the one to bind.
fn any_limits() -> impl Strategy<Value = [f64; 4]> {
    let decades = |from: f64, to: f64| (from..to).prop_map(|power: f64| 10f64.powf(power));
    (decades(-1.0, 1.0), decades(0.0, 2.5), decades(1.0, 4.0), decades(2.0, 6.0))
        .prop_map(|(v, a, j, s)| [v, a, j, s])
}

fn any_distance() -> impl Strategy<Value = f64> {
    (-5.0..0.4, any::<bool>()).prop_map(|(power, back)| if back { -1.0 } else { 1.0 } * 10f64.powf(power))
}

/// Defects of a step of constant snap: position of the next setpoint, then each derivative, less the predicted one.
fn defects(pair: &[Setpoint<f64>]) -> [f64; 4] {
    let (now, next) = (derivatives(&pair[0]), derivatives(&pair[1]));
    let [v, a, j, s] = now;
    let path = CONTROL_PERIOD
        * (v + CONTROL_PERIOD / 2.0 * (a + CONTROL_PERIOD / 3.0 * (j + CONTROL_PERIOD / 4.0 * s)));
    [
        pair[1].position.minus(pair[0].position) - path,
        next[0] - v - CONTROL_PERIOD * (a + CONTROL_PERIOD / 2.0 * (j + CONTROL_PERIOD / 3.0 * s)),
        next[1] - a - CONTROL_PERIOD * (j + CONTROL_PERIOD / 2.0 * s),
        next[2] - j - CONTROL_PERIOD * s,
    ]
}

fn assert_integrals(setpoints: &[Setpoint<f64>], of: [f64; 4]) -> Result<(), TestCaseError> {
    for pair in setpoints.windows(2) {
        let [x, v, a, j] = defects(pair);
        prop_assert!(x.abs() <= 1e-13, "position {x:e} at {pair:?}");
        for (defect, limit) in [v, a, j].into_iter().zip(of) {
            prop_assert!(defect.abs() <= 1e-12 * limit, "{defect:e} of {limit:e} at {pair:?}");
        }
    }
    Ok(())
}

fn assert_bounds<R: Real>(setpoints: &[Setpoint<R>], of: [f64; 4]) -> Result<(), TestCaseError> {
    for setpoint in setpoints {
        for (value, limit) in derivatives(setpoint).into_iter().zip(of) {
            prop_assert!(value.abs() <= R::lit(limit).to_f64(), "{value} of {limit}: {setpoint:?}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn each_derivative_is_the_integral_of_the_next(of in any_limits(), distance in any_distance()) {
        assert_integrals(&setpoints(&plan::<f64>(of, distance)), of)?;
    }

    #[test]
    fn no_limit_is_exceeded(of in any_limits(), distance in any_distance()) {
        assert_bounds(&setpoints(&plan::<f64>(of, distance)), of)?;
        assert_bounds(&setpoints(&plan::<f32>(of, distance)), of)?;
    }

    /// Time-reversed, the move from the target equals that from the start.
    #[test]
    fn the_second_half_mirrors_the_first(of in any_limits(), distance in any_distance()) {
        let planned = plan::<f32>(of, distance);
        let points = setpoints(&planned);
        for (out, back) in points.iter().zip(points.iter().rev()) {
            let mirrored = Setpoint { acceleration: -back.acceleration, snap: out.snap, ..*back };
            for ((out, back), limit) in derivatives(out).into_iter().zip(derivatives(&mirrored)).zip(of) {
                prop_assert!((out - back).abs() <= SEAM * limit, "{out} {back}");
            }
            let [to, from] = [out.position.minus(planned.at(0).position), planned.end().minus(back.position)];
            prop_assert!((to - from).abs() <= SEAM as f32 * distance.abs() as f32, "{to} {from}");
        }
    }

    #[test]
    fn it_starts_at_the_start_and_arrives_at_the_target(of in any_limits(), start: i64, distance in -4e8..4e8f64) {
        let (start, target) = (Angle::<f32>::from_counts(start), Angle::from_counts(start.wrapping_add(distance as i64)));
        let planned = limits(of).build(CONTROL_PERIOD as f32).unwrap().plan(start, target).unwrap();
        let mut state = MoveState::default();
        prop_assert_eq!(planned.step(&mut state).position, start);
        while !planned.done(&state) {
            planned.step(&mut state);
        }
        for _ in 0..3 {
            prop_assert_eq!(planned.step(&mut state), Setpoint { position: target, ..Setpoint::default() });
        }
    }

    /// The f32 move against the exact one of the same widths.
    #[test]
    fn f32_is_as_exact_as_stated(of in any_limits(), distance in any_distance()) {
        let short = plan::<f32>(of, distance);
        let [start, end] = [short.at(0).position, short.end()].map(|a| Angle { counts: a.counts, rest: f64::from(a.rest) });
        let exact = Move::over(start, end, short.widths, f64::from(CONTROL_PERIOD as f32)).unwrap();
        for k in 0..=short.periods() {
            let (short, exact) = (short.at(k), exact.at(k));
            let position = Angle { counts: short.position.counts, rest: f64::from(short.position.rest) };
            let error = position.minus(exact.position).abs();
            prop_assert!(error <= SEAM * distance.abs() + 2.0 * RADIANS_PER_COUNT, "{error:e} of {distance}");
            for ((short, exact), limit) in derivatives(&short).into_iter().zip(derivatives(&exact)).zip(of) {
                prop_assert!((short - exact).abs() <= SEAM * limit, "{short} {exact}");
            }
        }
    }

    /// Any other widths that keep the limits and whose levels are reached take longer.
    #[test]
    fn no_other_profile_is_shorter(
        of in any_limits(),
        distance in any_distance(),
        [s, j, a] in prop::array::uniform3(0.5..2.0f64),
    ) {
        let best = plan::<f64>(of, distance);
        let [v_max, a_max, j_max, s_max] = of;
        let Widths { snap, jerk, acceleration, .. } = best.widths;
        let t_s = s * f64::from(snap) * CONTROL_PERIOD;
        let t_j = (j * f64::from(jerk) * CONTROL_PERIOD).max(t_s);
        let t_a = (a * f64::from(acceleration) * CONTROL_PERIOD).max(t_s + t_j);
        // The least T_v at which distance, speed and every level keep their limits.
        let t_v = [v_max, a_max * t_a, j_max * t_a * t_j, s_max * t_a * t_j * t_s]
            .map(|limit| distance.abs() / limit)
            .into_iter()
            .fold(t_a + t_j + t_s, f64::max);
        let other = t_v + t_a + t_j + t_s;
        let rounding = 15.0 * CONTROL_PERIOD + 1e-6 * other;
        prop_assert!(f64::from(best.periods()) * CONTROL_PERIOD <= other + rounding, "{best:?}: {other}");
    }

    #[test]
    fn a_stop_keeps_the_course_so_far_and_every_law(
        of in any_limits(),
        distance in any_distance(),
        fraction in 0.0..1.0f64,
    ) {
        let planned = plan::<f64>(of, distance);
        let mut state = MoveState::default();
        let before = (fraction * f64::from(planned.periods())) as u32;
        for _ in 0..before {
            planned.step(&mut state);
        }
        let stopped = planned.stop(&state);
        prop_assert!(stopped.periods() <= planned.periods());
        prop_assert!(stopped.periods() <= 8 * before);
        for k in 0..before {
            let (found, expected) = (stopped.at(k), planned.at(k));
            prop_assert!(found.position.minus(expected.position).abs() <= 1e-14);
            prop_assert_eq!(derivatives(&found), derivatives(&expected));
        }
        let points = setpoints(&stopped);
        assert_integrals(&points, of)?;
        assert_bounds(&points, of)?;
        let end = derivatives(points.last().unwrap());
        prop_assert_eq!(end, [0.0; 4]);
    }

    #[test]
    fn planning_is_total(words: [u32; 9], start: i64, target: i64, elapsed: u32, near: bool) {
        let f = |k: usize| f32::from_bits(words[k]);
        let params = TrajectoryParams { velocity: f(0), acceleration: f(1), jerk: f(2), snap: f(3) };
        for (params, dt) in [(params, f(4)), (params, 1e-4), (limits([1.0, 10.0, 100.0, 1e3]), f(4))] {
            let Ok(trajectory) = params.build(dt) else { continue };
            let start = Angle { counts: start, rest: f(5) };
            let counts = if near { start.counts.wrapping_add(i64::from(words[7])) } else { target };
            let target = Angle { counts, rest: f(6) };
            let Ok(planned) = trajectory.plan(start, target) else { continue };
            for k in [0, 1, elapsed % (planned.periods() + 1), elapsed] {
                let stopped = planned.stop(&MoveState { elapsed: elapsed.min(planned.periods()) });
                for setpoint in [planned.at(k), stopped.at(k)] {
                    prop_assert!(derivatives(&setpoint).into_iter().all(f64::is_finite), "{setpoint:?}");
                    prop_assert!(setpoint.position.rest.abs() <= 3.0, "{setpoint:?}");
                }
            }
        }
    }
}

/// With a single limit the time is known in closed form; whole periods add at most 15.
#[test]
fn the_time_is_the_known_one() {
    let all = [0.5, 2.0, 20.0, 400.0];
    for distance in [1e-3, 0.02, 0.7] {
        let limited_by = |k: usize| {
            let mut of = [NONE; 4];
            of[k] = all[k];
            f64::from(plan::<f64>(of, distance).periods()) * CONTROL_PERIOD
        };
        let known = [
            distance / all[0],
            2.0 * (distance / all[1]).sqrt(),
            (32.0 * distance / all[2]).cbrt(),
            (512.0 * distance / all[3]).powf(0.25),
        ];
        for (k, known) in known.into_iter().enumerate() {
            let time = limited_by(k);
            assert!(
                time >= known && time <= known * (1.0 + 1e-6) + 15.0 * CONTROL_PERIOD,
                "{k}: {time} {known}"
            );
        }
    }
    // Every level reached: each limit adds the time to reach it.
    let time = f64::from(plan::<f64>(all, 0.7).periods()) * CONTROL_PERIOD;
    let known = 0.7 / 0.5 + 0.5 / 2.0 + 2.0 / 20.0 + 20.0 / 400.0;
    assert!(time >= known && time <= known * (1.0 + 1e-6) + 4.0 * CONTROL_PERIOD, "{time} {known}");
}

#[test]
fn rest_is_rest() {
    let at = Angle::<f32>::from_counts(42);
    let planned = limits([0.5, 2.0, 20.0, 400.0]).build(1e-4).unwrap().rest(at);
    let mut state = MoveState::default();
    assert!(planned.done(&state));
    assert_eq!(planned.step(&mut state), Setpoint { position: at, ..Setpoint::default() });
    let planned = plan::<f32>([0.5, 2.0, 20.0, 400.0], 0.0);
    assert!(setpoints(&planned).iter().all(|setpoint| *setpoint == planned.at(0)));
}

/// At full speed for a thousand revolutions an f32 position still moves by the same step.
#[test]
fn a_long_way_does_not_lose_resolution() {
    let start = Angle::<f32>::from_counts(1 << 50);
    let target = Angle::from_counts((1 << 50) + (1000 << 32));
    let planned = limits([20.0, 500.0, 1e4, 1e6]).build(1e-4).unwrap().plan(start, target).unwrap();
    let (first, middle) = (planned.widths.ramp() + 1, planned.periods() / 2);
    for k in (first..first + 100).chain(middle..middle + 100) {
        let step = planned.at(k + 1).position.minus(planned.at(k).position);
        assert!(
            (f64::from(step) - 20.0 * CONTROL_PERIOD).abs() < 1e-5 * 20.0 * CONTROL_PERIOD,
            "{k}: {step}"
        );
    }
}

#[test]
fn what_no_move_can_be_planned_with_is_named() {
    let of = [0.5, 2.0, 20.0, 400.0];
    for (k, name) in ["velocity", "acceleration", "jerk", "snap"].into_iter().enumerate() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut of = of;
            of[k] = bad;
            assert_eq!(limits::<f64>(of).build(CONTROL_PERIOD), Err(Error::OutOfRange(name)));
        }
    }
    for dt in [0.0, -1e-4, 9e-7, 1.1, f64::NAN] {
        assert_eq!(limits::<f64>(of).build(dt), Err(Error::OutOfRange("dt")));
    }
    let to = |of: [f64; 4], target: Angle<f64>| {
        limits(of).build(CONTROL_PERIOD).unwrap().plan(Angle::default(), target).err()
    };
    let distance = Some(Error::OutOfRange("distance"));
    let near = Angle::from_radians(1.0);
    assert_eq!(to(of, near), None);
    assert_eq!(to(of, Angle::from_counts(i64::MAX)), distance);
    assert_eq!(to(of, Angle::from_counts(1 << 46)), distance);
    // 1 rad at 0.1 mrad/s is no day's work for 2^24 periods of 0.1 ms.
    assert_eq!(to([1e-4, 2.0, 20.0, 400.0], near), distance);
    assert_eq!(to([0.5, 2.0, 20.0, 1e-12], near), distance);
    // 10 rad/s after 5 s: 25 rad until then.
    assert_eq!(to([10.0, 2.0, 20.0, 400.0], Angle::from_counts(100 << 32)), distance);
}
